//! `nephos import`: a scene of a volume that another program made.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec3;

use super::{
    numbers::{above_zero, numbers},
    sequence::frames::rate,
    terminal,
};
use crate::{
    Error, Result,
    import::{Choice, Found, Raw, choose, found_in, species_of},
    numbered::stem,
    scene::{Brick, Cloud, Droplets, Endian, Grid, Scene, Sequence, Species, Timeline, Up, Volume},
};

/// Tell what is in a volume's file, and make a scene of it.
///
/// OpenVDB (.vdb), Mitsuba's .vol, output of the weather model WRF (NetCDF), or a brick of floats whose --size you give; one file
/// or a sequence of them, such as "storm.####.vdb".
#[derive(Debug, Args)]
pub struct Import {
    /// Volume: .vdb, .vol, .nc, or floats. Of a sequence the number of a step stands for the hashes of "storm.####.vdb", for
    /// `%04d` or for `$F4`.
    file: PathBuf,
    /// Scene file to write; nothing is written where left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Grid that is drawn; where left out, the only one, or `density`.
    #[arg(long, value_name = "NAME")]
    grid: Option<String>,
    /// A cloud for each kind of water of a weather model: droplets, rain, ice, snow and graupel each scatter as they do.
    #[arg(long, conflicts_with = "grid")]
    kinds: bool,
    /// A cloud of this variable over height, y and x of a NetCDF file, and what it is of: "ql", "qi=ice"; water, rain, ice, snow
    /// or graupel, water where left out. Give it once for each.
    #[arg(long, value_name = "NAME[=SPECIES]", value_parser = field, conflicts_with_all = ["grid", "kinds"])]
    field: Vec<Field>,
    /// Extinction where the grid is 1, per metre; where left out, 1 for values that are extinctions, and that of
    /// droplets for those without a unit.
    #[arg(long, value_name = "PER_METRE", value_parser = above_zero)]
    extinction: Option<f64>,
    /// Metres of the file's unit of length: 0.01 for centimetres.
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = above_zero)]
    scale: f64,
    /// Axis of the file that goes up; where left out, z of NetCDF and y of others.
    #[arg(long, value_name = "AXIS")]
    up: Option<UpAxis>,
    /// Where the file's origin shall be, metres.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    at: Option<[f64; 3]>,
    /// Which of its times, where a file holds several: 0 is the first.
    #[arg(long, value_name = "N", default_value_t = 0)]
    step: u32,
    /// Go through all times of a file that holds several.
    #[arg(long, conflicts_with = "step")]
    times: bool,
    /// Steps of a sequence per second; where left out, 24.
    #[arg(long, value_name = "N", value_parser = rate)]
    fps: Option<f64>,
    /// Voxels along x, y and z of a file that holds nothing but floats, x fastest.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>)]
    size: Option<[f64; 3]>,
    /// Order of the bytes of those floats.
    #[arg(long, value_name = "ORDER", default_value = "little", requires = "size")]
    endian: ByteOrder,
    /// Edges of a voxel of those floats, in the file's unit of length.
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, requires = "size")]
    voxel: Option<[f64; 3]>,
}

/// A variable, and what it is of.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    species: Species,
}

fn field(text: &str) -> std::result::Result<Field, String> {
    let (name, species) = text.split_once('=').unwrap_or((text, Species::Water.name()));
    let known = [Species::Water, Species::Rain, Species::Ice, Species::Snow, Species::Graupel];
    let found = known.into_iter().find(|known| known.name() == species);
    match found {
        Some(species) if !name.is_empty() => Ok(Field { name: name.to_owned(), species }),
        _ => Err(format!("give a name and one of {}, such as qi=ice", known.map(Species::name).join(", "))),
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum UpAxis {
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum ByteOrder {
    Little,
    Big,
}

impl Import {
    /// Tells what is there, and writes the scene.
    ///
    /// # Errors
    /// Where the file, the arguments or the scene are not good.
    pub fn run(self) -> Result<()> {
        let brick = self.brick()?;
        let raw = brick.as_ref().map(|brick| Raw {
            size: brick.size,
            big_endian: self.endian == ByteOrder::Big,
            voxel: brick.voxel.into(),
        });
        let (file, steps) = self.volume_in(Path::new(""), brick.as_ref()).first_file(Path::new(""))?;
        let found = found_in(&file, &Choice { grid: None, raw, step: self.step })?;
        terminal::print(&self.told(&found))?;
        if let Some((first, last, count)) = steps {
            terminal::print(&format!("  {count} steps, {first} to {last}; what is told is of {first}\n"))?;
        }
        let Some(output) = &self.output else { return Ok(()) };
        let chosen = match (self.kinds, self.field.is_empty()) {
            (true, _) => self.kinds_of(found)?,
            (false, true) => vec![self.chosen(&found, self.grid.as_deref())?],
            (false, false) => {
                let named = self.field.iter().map(|field| self.chosen(&found, Some(&field.name)));
                named.collect::<Result<Vec<_>>>()?
            }
        };
        let scene = self.scene(output, chosen, brick.as_ref())?;
        scene.save(output)?;
        let volume = scene.clouds[0].volume.as_ref();
        let extinction = volume.map_or(0.0, |volume| volume.extinction);
        terminal::print(&format!(
            "{}: extinction {extinction} a metre where the grid is 1\n",
            output.display()
        ))?;
        terminal::below_ground(&scene)
    }

    fn brick(&self) -> Result<Option<Brick>> {
        let Some(size) = self.size else { return Ok(None) };
        if size.iter().any(|n| n.fract() != 0.0 || !(1.0..=2048.0).contains(n)) {
            let [x, y, z] = size;
            return Err(Error::Argument(format!("--size {x},{y},{z} must be whole numbers from 1 to 2048")));
        }
        let endian = match self.endian {
            ByteOrder::Little => Endian::Little,
            ByteOrder::Big => Endian::Big,
        };
        let size = size.map(|n| n as u32);
        Ok(Some(Brick { size, endian, voxel: self.voxel.unwrap_or([1.0; 3]) }))
    }

    fn chosen(&self, found: &[Found], name: Option<&str>) -> Result<Grid> {
        choose(found.to_vec(), name).map_err(|problem| Error::Format { path: self.file.clone(), problem })
    }

    /// What a grid is of, and the effective radius of its particles, um: as it was said, or as its name tells.
    fn species(&self, grid: &Grid) -> Option<(Species, f64)> {
        let said = self.field.iter().find(|field| field.name == grid.name).map(|field| field.species);
        let known = species_of(&grid.name);
        let usual = |species: Species| {
            known.filter(|(own, _)| *own == species).unwrap_or((species, species.usual_radius_um()))
        };
        said.map(usual).or(known)
    }

    /// A line a grid.
    fn told(&self, found: &[Found]) -> String {
        let mut text = format!("{}:\n", self.file.display());
        for Found { name, kind, grid } in found {
            text += &match grid {
                Ok(grid) => format!("  {name} ({kind}): {}\n", summary(grid, self.scale)),
                Err(problem) => format!("  {name} ({kind}): not drawn; the file {problem}\n"),
            };
        }
        text
    }

    /// The kinds of water that there is some of.
    fn kinds_of(&self, found: Vec<Found>) -> Result<Vec<Grid>> {
        let kinds: Vec<Grid> = found
            .into_iter()
            .filter(|found| species_of(&found.name).is_some())
            .filter_map(|found| found.grid.ok())
            .filter(|grid| grid.count > 0)
            .collect();
        if kinds.is_empty() {
            let problem = "has no kinds of water by WRF's names: leave out --kinds".to_owned();
            return Err(Error::Format { path: self.file.clone(), problem });
        }
        Ok(kinds)
    }

    fn scene(&self, output: &Path, grids: Vec<Grid>, raw: Option<&Brick>) -> Result<Scene> {
        let name = stem(&self.file);
        let clouds = grids.into_iter().map(|grid| {
            let is_alone = !self.kinds && self.field.len() < 2;
            let called = if is_alone { name.clone() } else { grid.name.clone() };
            let species = self.species(&grid);
            let mut cloud = Cloud::of_volume(&called, self.volume(output, &grid, raw)?);
            if let Some((species, effective_radius_um)) = species {
                cloud.droplets = Droplets { species, effective_radius_um, ..Droplets::default() };
            }
            Ok(cloud)
        });
        let clouds = clouds.collect::<Result<Vec<_>>>()?;
        let length = clouds.iter().filter_map(|cloud| cloud.volume.as_ref()).find_map(Volume::length);
        let timeline = length.map(|length| Timeline { length, ..Timeline::default() });
        let scene = Scene { name, clouds, timeline, ..Scene::default() };
        scene.validate().map_err(|error| {
            Error::Argument(format!("the cloud would be no valid one: {error}; --scale and --at change it"))
        })?;
        Ok(scene)
    }

    fn volume(&self, output: &Path, grid: &Grid, raw: Option<&Brick>) -> Result<Volume> {
        let folder = output.parent().unwrap_or(Path::new(""));
        let mut volume = Volume {
            grid: Some(grid.name.clone()).filter(|_| raw.is_none()),
            extinction: self.extinction.unwrap_or_else(|| self.usual_extinction(grid)),
            ..self.volume_in(folder, raw)
        };
        volume.read(folder)?;
        Ok(volume)
    }

    fn usual_extinction(&self, grid: &Grid) -> f64 {
        match self.species(grid) {
            Some((species, _)) if grid.quantity.contains("mass") => Volume::extinction_of_mass(species),
            _ => Volume::usual_extinction(grid),
        }
    }

    /// The volume for a scene in `folder`, but for what its grid tells.
    fn volume_in(&self, folder: &Path, raw: Option<&Brick>) -> Volume {
        let sequence = Sequence { fps: self.fps, ..Sequence::default() };
        Volume {
            file: Volume::path_from(folder, &self.file),
            scale: self.scale,
            up: match self.up {
                Some(UpAxis::Y) => Up::Y,
                Some(UpAxis::Z) => Up::Z,
                None => Volume::usual_up(&self.file),
            },
            step: self.step,
            place: self.at.map_or(DVec3::ZERO, DVec3::from),
            sequence: Some(sequence).filter(|_| self.times || self.fps.is_some()),
            raw: raw.cloned(),
            ..Volume::default()
        }
    }
}

/// What a grid is like.
fn summary(grid: &Grid, scale: f64) -> String {
    let (size, voxel) = (grid.size(), scale * grid.voxel());
    let unit = if grid.quantity.is_empty() { String::new() } else { format!(", {}", grid.quantity) };
    let clamped = match grid.clamped {
        0 => String::new(),
        count => format!(", {count} negative ones taken as 0"),
    };
    format!(
        "{} x {} x {} voxels of {:.4} x {:.4} x {:.4} m, {} not empty, up to {:.4}{unit}{clamped}, {:.1} MiB",
        size.x,
        size.y,
        size.z,
        voxel.x,
        voxel.y,
        voxel.z,
        grid.count,
        grid.most,
        grid.bytes() as f64 / f64::from(1 << 20)
    )
}
