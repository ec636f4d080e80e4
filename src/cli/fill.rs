//! `nephos fill`: a cloud in the shape of a mesh, or of points.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::DVec3;

use super::{
    numbers::{above_zero, numbers, seed},
    terminal,
};
use crate::{
    Error, Result,
    import::{Filled, Inside, fill, fill_points, is_of_points, read_mesh, read_points},
    scene::{Cloud, Edge, Ellipsoid, Mesh, Noise, Scene, Volume},
};

/// Thickness of edges where none is told, as shares of an ellipsoid's smallest radius, and of how thick a mesh is.
const EDGE: f64 = 0.35;
const MESH_EDGE: f64 = 0.2;

/// Make a cloud in the shape of a mesh or of points: ellipsoids that fill it, or the mesh itself.
///
/// The mesh must be closed, but for holes that are small beside it; parts may overlap. Metres and Y up are taken for granted, as in glTF.
/// Ellipsoids are a little larger than the mesh, by half the thickness of the edge: noise pushes the
/// cloud's boundary inwards by as much on the average. Points are those of particles or scans; where they have radii (PLY: `radius` or
/// `pscale`, CSV: a fourth column) they are balls.
///
/// With --exact the scene names the mesh, whose surface is where the cloud ends: it goes on needing the file.
#[derive(Debug, Args)]
pub struct Fill {
    /// Mesh: .obj, .gltf or .glb; or points: .ply or .csv.
    file: PathBuf,
    /// Scene file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// The mesh is the cloud's boundary, in place of ellipsoids.
    #[arg(long, conflicts_with_all = ["count", "seed", "points"])]
    exact: bool,
    /// Most ellipsoids.
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=4096))]
    count: u32,
    /// Multiplies the file's coordinates.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = above_zero)]
    scale: f64,
    /// Where the file's origin shall be, metres.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    at: Option<[f64; 3]>,
    /// Thickness of the edge that noise works on, as a share of an ellipsoid's smallest radius: 0.35 where left out. With --exact
    /// as a share of three times the volume of the mesh over its area, which is the radius of a ball: 0.2.
    #[arg(long, value_name = "SHARE", value_parser = above_zero)]
    edge: Option<f64>,
    /// Any whole number: other seeds fill it another way.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Points along the longest edge of the mesh's box at which it is asked what is inside.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(8..=256))]
    points: u32,
}

impl Fill {
    /// Writes the scene.
    ///
    /// # Errors
    /// Where the mesh, the arguments or the file are not good.
    pub fn run(self) -> Result<()> {
        let (scene, told) = match (self.exact, is_of_points(&self.file)) {
            (true, true) => {
                return Err(Error::Argument(format!(
                    "`{}` holds points, which have no surface: leave out --exact, or give a mesh (.obj, .gltf or .glb)",
                    self.file.display()
                )));
            }
            (true, false) => self.mesh_itself()?,
            (false, true) => self.with_ellipsoids(self.points_filled()?),
            (false, false) => self.with_ellipsoids(self.mesh_filled()?),
        };
        scene.validate().map_err(|error| {
            Error::Argument(format!("the cloud would be no valid one: {error}; --scale and --at change it"))
        })?;
        scene.save(&self.output)?;
        terminal::print(&format!("{}: {told}", self.output.display()))?;
        terminal::below_ground(&scene)
    }

    /// A scene with the mesh as a boundary, and what is told of it.
    fn mesh_itself(&self) -> Result<(Scene, String)> {
        let folder = self.output.parent().unwrap_or(Path::new(""));
        let file = Volume::path_from(folder, &self.file);
        let mut mesh = Mesh { file, scale: self.scale, place: self.origin(), ..Mesh::default() };
        mesh.read(folder)?;
        let (count, open, thickness) = match mesh.surface() {
            Some(surface) => (surface.count(), surface.openness(), surface.thickness()),
            None => Default::default(),
        };
        let boundary = self.edge.unwrap_or(MESH_EDGE) * self.scale * thickness;
        let edge = Edge { boundary, ..Edge::default() };
        let cloud = Cloud { mesh: Some(mesh), edge, ..Cloud::default() };
        Ok((self.scene(cloud, boundary), format!("a cloud within {count} triangles\n{}", closed(open))))
    }

    /// A scene with ellipsoids, and what is told of them.
    fn with_ellipsoids(&self, (filled, told): (Filled, String)) -> (Scene, String) {
        let edged = |e: &Ellipsoid| {
            let boundary = self.edge.unwrap_or(EDGE) * e.radii.min_element();
            let edge = Edge { boundary, ..Edge::default() };
            Ellipsoid { radii: e.radii + 0.5 * boundary, edge: Some(edge), ..e.clone() }
        };
        let ellipsoids: Vec<_> = filled.ellipsoids.iter().map(edged).collect();
        let mean = ellipsoids.iter().filter_map(|e| Some(e.edge.as_ref()?.boundary)).sum::<f64>()
            / ellipsoids.len().max(1) as f64;
        let told = format!("{} ellipsoids, {told}", ellipsoids.len());
        (self.scene(Cloud { ellipsoids, ..Cloud::default() }, mean), told)
    }

    fn origin(&self) -> DVec3 {
        self.at.map_or(DVec3::ZERO, DVec3::from)
    }

    /// Ellipsoids in a mesh, and what is told of them.
    fn mesh_filled(&self) -> Result<(Filled, String)> {
        let mut mesh = read_mesh(&self.file)?;
        mesh.positions.iter_mut().for_each(|p| *p = self.scale * *p + self.origin());
        let inside = Inside::new(&mesh, self.points);
        let filled = fill(&inside, self.count as usize, self.seed)?;
        let told =
            format!("{:.0} % overlap with the mesh\n{}", 100.0 * filled.overlap, closed(inside.openness));
        Ok((filled, told))
    }

    /// Ellipsoids where points are, and what is told of them.
    fn points_filled(&self) -> Result<(Filled, String)> {
        let mut points = read_points(&self.file)?;
        for point in &mut points {
            (point.place, point.radius) =
                (self.scale * point.place + self.origin(), self.scale * point.radius);
        }
        let filled = fill_points(&points, self.count as usize, self.seed)?;
        let told = format!("which hold {:.0} % of {} points\n", 100.0 * filled.overlap, points.len());
        Ok((filled, told))
    }

    /// A scene of a cloud whose edges are `boundary` metres thick on average.
    fn scene(&self, cloud: Cloud, boundary: f64) -> Scene {
        let name = self.file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_owned();
        Scene {
            noise: Noise { scale: Some(2.0 * boundary), ..Noise::default() },
            clouds: vec![Cloud { name: name.clone(), ..cloud }],
            name,
            ..Scene::default()
        }
    }
}

/// What is told of a mesh of which a share of the surface is open.
fn closed(open: f64) -> String {
    if open <= 0.0 {
        return String::new();
    }
    format!(
        "The mesh has openings, or faces that look the other way, of {} % of its surface: it was filled as if \
         closed.\n",
        percent(open)
    )
}

/// A share above 0 in percent, to two figures.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let digits = (1.0 - percent.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{percent:.digits$}")
}
