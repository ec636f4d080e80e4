//! A cloud: ellipsoids that share their water, a layer, a mesh, or a volume.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, COORDINATE, Limits};
use super::{
    Bounds, CoverMap, Droplets, Edge, Ellipsoid, Evaporation, Growth, Layer, Life, Mesh, Noise, Volume, union,
};
use crate::Result;

/// Least part of an ellipsoid that is shown of it.
const LEAST_SEEN: f64 = 0.2;
const SHARE: Limits = Limits::new(0.0, 1.0, "");

/// A cloud: the union of its ellipsoids, a layer, the inside of a mesh, or a volume, filled with droplets of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Cloud {
    /// A name for people; it changes nothing in the picture.
    pub name: String,
    /// How it grows, in place of `ellipsoids`; left out where those were made by hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<Growth>,
    /// The shape. At most 65536 ellipsoids in all clouds together; none renders nothing. Left out
    /// where `growth` says how they grow.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ellipsoids: Vec<Ellipsoid>,
    /// A sheet or a deck to the horizon, in place of `ellipsoids` and `growth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<Layer>,
    /// A closed mesh that is its boundary, in place of `ellipsoids`, `growth` and `layer`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Mesh>,
    /// Density that another program made, in place of `ellipsoids`, `growth`, `layer` and `mesh`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<Volume>,
    /// The water of the cloud.
    pub droplets: Droplets,
    /// The edge of every ellipsoid that has none of its own.
    pub edge: Edge,
    /// How softly its ellipsoids run into one another, 0 (each keeps its shape, with creases between them)
    /// to 1 (one smooth body), no unit.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub blend: f64,
    /// Altitude at which vapour condenses, metres: nothing of the cloud is below, and its base is flat. Left out where
    /// its ellipsoids end by themselves; a cloud that grows has that of its `growth.place`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub level: Option<f64>,
    /// How much of the growth of density with height it has, 0 (the same all over) to 1 (as in air that
    /// rises without mixing: extinction grows as the height above the base to the 2/3, and is that of the
    /// droplets at the top), no unit.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub stratification: f64,
    /// Share of its droplets that the rim has lost to dry air, 0 to 1, no unit; deeper than twice the
    /// boundary none are lost.
    #[schemars(range(min = SHARE.min, max = SHARE.max))]
    pub dilution: f64,
    /// Where its edge has turned to wisps.
    #[serde(skip_serializing_if = "Evaporation::is_none")]
    pub evaporation: Evaporation,
    /// The noise that shapes its boundary, and drifts with it; the scene's where left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// When it forms and dissolves; left out where it is there all the time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub life: Option<Life>,
    /// Whether it is left out of pictures, the path traced ones too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
    /// Whether editors leave it alone until it is unlocked; it changes nothing in the picture.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub locked: bool,
}

impl Default for Cloud {
    fn default() -> Self {
        Self {
            name: String::new(),
            growth: None,
            ellipsoids: Vec::new(),
            layer: None,
            mesh: None,
            volume: None,
            droplets: Droplets::default(),
            edge: Edge::default(),
            blend: 0.5,
            level: None,
            stratification: 0.0,
            dilution: 0.0,
            evaporation: Evaporation::default(),
            noise: None,
            life: None,
            hidden: false,
            locked: false,
        }
    }
}

impl Cloud {
    /// What it is called: its name, or its `number` among the clouds.
    pub fn label(&self, number: usize) -> String {
        if self.name.is_empty() { format!("cloud {}", number + 1) } else { self.name.clone() }
    }

    /// The painted map of its layer.
    pub fn map(&self) -> Option<&CoverMap> {
        self.layer.as_ref()?.map.as_ref()
    }

    /// A layer.
    pub fn layered(name: &str, layer: Layer) -> Self {
        Self { name: name.to_owned(), layer: Some(layer), ..Self::default() }
    }

    /// A cloud with a mesh as its boundary.
    pub fn of_mesh(name: &str, mesh: Mesh) -> Self {
        Self { name: name.to_owned(), mesh: Some(mesh), ..Self::default() }
    }

    /// A volume.
    pub fn of_volume(name: &str, volume: Volume) -> Self {
        Self { name: name.to_owned(), volume: Some(volume), ..Self::default() }
    }

    /// A cloud that grows, with its ellipsoids.
    pub fn grown(name: &str, growth: Growth) -> Self {
        let mut cloud = Self { name: name.to_owned(), growth: Some(growth), ..Self::default() };
        cloud.grow();
        cloud
    }

    /// Puts the ellipsoids there that grow, in place of those that are there. Nothing where it has no growth.
    pub fn grow(&mut self) {
        if let Some(growth) = &self.growth {
            self.ellipsoids = growth.ellipsoids();
            self.level = growth.level();
        }
    }

    /// Whether its ellipsoids are those that grow: a hand that changes one makes others of them.
    pub fn is_as_grown(&self) -> bool {
        self.growth.as_ref().is_some_and(|growth| growth.ellipsoids() == self.ellipsoids)
    }

    /// Moves all of it by `offset`, metres, its own noise, too; it grows there.
    pub fn shift(&mut self, offset: DVec3) {
        if let Some(noise) = &mut self.noise {
            noise.offset += offset;
        }
        if let Some(layer) = &mut self.layer {
            layer.shift(offset);
        }
        if let Some(volume) = &mut self.volume {
            volume.place += offset;
        }
        if let Some(mesh) = &mut self.mesh {
            mesh.place += offset;
        }
        match &mut self.growth {
            Some(growth) => {
                growth.place += offset;
                self.grow();
            }
            None => {
                self.ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center += offset);
                self.level = self.level.map(|level| level + offset.y);
            }
        }
    }

    /// Exact axis-aligned bounds of all ellipsoids or the mesh above its level, or of its volume, metres; `None` without any.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds_of(self.ellipsoids.iter()).or_else(|| self.volume.as_ref()?.bounds())
    }

    /// The same of those that pictures show.
    pub fn visible_bounds(&self) -> Option<Bounds> {
        if self.ellipsoids.is_empty() {
            return self.bounds().filter(|_| !self.hidden);
        }
        self.bounds_of(self.visible())
    }

    fn bounds_of<'a>(&self, ellipsoids: impl Iterator<Item = &'a Ellipsoid>) -> Option<Bounds> {
        let mesh = self.mesh.as_ref().and_then(Mesh::bounds);
        let (mut low, high) = ellipsoids.map(Ellipsoid::bounds).chain(mesh).reduce(union)?;
        // All of it may be below.
        low.y = self.level.map_or(low.y, |level| low.y.max(level.min(high.y)));
        Some((low, high))
    }

    /// Whether there is nothing of it.
    pub fn is_empty(&self) -> bool {
        self.ellipsoids.is_empty() && self.layer.is_none() && !self.is_of_file()
    }

    /// Whether its shape is in a file: a mesh or a volume.
    pub fn is_of_file(&self) -> bool {
        self.mesh.is_some() || self.volume.is_some()
    }

    /// A number that differs where what the files of its mesh or volume hold does; `None` where there are none, or they
    /// were not read.
    #[cfg_attr(
        not(any(feature = "cli", feature = "editor")),
        allow(dead_code, reason = "who keeps pictures asks")
    )]
    pub(crate) fn fingerprint(&self) -> Option<u64> {
        match (&self.mesh, &self.volume) {
            (Some(mesh), _) => Some(mesh.surface()?.fingerprint()),
            (_, volume) => volume.as_ref()?.fingerprint(),
        }
    }

    /// The ellipsoids that pictures show.
    pub fn visible(&self) -> impl Iterator<Item = &Ellipsoid> {
        self.ellipsoids.iter().filter(|ellipsoid| !self.hidden && !ellipsoid.hidden)
    }

    /// The edge of `ellipsoid`: its own, or else the cloud's.
    pub fn edge_of<'a>(&'a self, ellipsoid: &'a Ellipsoid) -> &'a Edge {
        ellipsoid.edge.as_ref().unwrap_or(&self.edge)
    }

    /// `ellipsoid` as it is seen on average over the noise: its edge is where half of the boundary lies behind.
    #[must_use]
    pub fn mean_edge(&self, ellipsoid: &Ellipsoid) -> Ellipsoid {
        let depth = 0.5 * self.edge_of(ellipsoid).boundary;
        let least = LEAST_SEEN * ellipsoid.radii;
        Ellipsoid { radii: (ellipsoid.radii - depth).max(least), ..ellipsoid.clone() }
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        let list = at.field("ellipsoids");
        if self.layer.is_some() {
            self.check_layer_alone(at)?;
        }
        if self.volume.is_some() {
            self.check_volume_alone(at)?;
        }
        if self.mesh.is_some() {
            self.check_mesh_alone(at)?;
        }
        for (i, ellipsoid) in self.ellipsoids.iter().enumerate() {
            ellipsoid.check(list.index(i))?;
        }
        self.check_own(at)
    }

    /// Checks what is no ellipsoid.
    pub(super) fn check_own(&self, at: At) -> Result<()> {
        self.droplets.check(at.field("droplets"))?;
        self.edge.check(at.field("edge"))?;
        if let Some(growth) = &self.growth {
            growth.check(at.field("growth"))?;
        }
        if let Some(layer) = &self.layer {
            layer.check(at.field("layer"))?;
        }
        if let Some(volume) = &self.volume {
            volume.check(at.field("volume"))?;
        }
        if let Some(mesh) = &self.mesh {
            mesh.check(at.field("mesh"))?;
        }
        at.field("blend").number(self.blend, SHARE)?;
        if let Some(level) = self.level {
            at.field("level").number(level, COORDINATE)?;
        }
        at.field("stratification").number(self.stratification, SHARE)?;
        at.field("dilution").number(self.dilution, SHARE)?;
        self.evaporation.check(at.field("evaporation"))?;
        if let Some(noise) = &self.noise {
            noise.check(at.field("noise"))?;
        }
        match &self.life {
            Some(life) => life.check(at.field("life")),
            None => Ok(()),
        }
    }

    /// Checks that nothing is told that a layer does not have.
    fn check_layer_alone(&self, at: At) -> Result<()> {
        let others = [
            ("growth", self.growth.is_some(), "leave it out, or make a second cloud that grows"),
            ("ellipsoids", !self.ellipsoids.is_empty(), "leave out one of them, or make two clouds"),
            ("level", self.level.is_some(), "leave it out: the layer's `base` is where it begins"),
            ("life", self.life.is_some(), "leave it out, and animate the layer's `coverage`"),
            ("evaporation", !self.evaporation.is_none(), "leave it out, and raise the edge's `wispiness`"),
            ("mesh", self.mesh.is_some(), "leave out one of them, or make two clouds"),
            ("volume", self.volume.is_some(), "leave out one of them, or make two clouds"),
        ];
        alone(at, ["layer", "layers"], others)
    }

    /// Checks that nothing is told that a volume does not have.
    fn check_volume_alone(&self, at: At) -> Result<()> {
        let both = "leave out one of them, or make two clouds";
        let file = "leave it out: what is in the file is drawn as it is";
        let others = [
            ("growth", self.growth.is_some(), both),
            ("ellipsoids", !self.ellipsoids.is_empty(), both),
            ("mesh", self.mesh.is_some(), both),
            ("level", self.level.is_some(), file),
            ("life", self.life.is_some(), "leave it out, and animate the volume's `extinction`"),
            ("evaporation", !self.evaporation.is_none(), file),
            ("stratification", self.stratification > 0.0, file),
            ("dilution", self.dilution > 0.0, file),
        ];
        alone(at, ["volume", "volumes"], others)
    }

    /// Checks that nothing is told that a mesh does not have.
    fn check_mesh_alone(&self, at: At) -> Result<()> {
        let both = "leave out one of them, or make two clouds";
        let others = [
            ("growth", self.growth.is_some(), both),
            ("ellipsoids", !self.ellipsoids.is_empty(), both),
            ("life", self.life.is_some(), "leave it out, and animate the mesh's `density`"),
            ("evaporation", !self.evaporation.is_none(), "leave it out, and raise the edge's `wispiness`"),
        ];
        alone(at, ["mesh", "meshes"], others)
    }
}

/// Refuses what a cloud of a shape, one and many, does not have: what it is, whether it is there, and the way out.
fn alone<'a>(
    at: At,
    [shape, shapes]: [&str; 2],
    others: impl IntoIterator<Item = (&'a str, bool, &'a str)>,
) -> Result<()> {
    match others.into_iter().find(|(_, is_there, _)| *is_there) {
        Some((name, _, way_out)) => Err(
            at.problem(format!("it has both `{shape}` and `{name}`, which {shapes} do not have: {way_out}"))
        ),
        None => Ok(()),
    }
}
