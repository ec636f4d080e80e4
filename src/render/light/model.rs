//! What a model of the light inside clouds is.

use std::{
    fmt,
    hash::{Hash, Hasher},
};

use wgpu::TextureView;

use super::CloudLight;
use crate::{Result, frame::medium::SpeciesTextures, gpu::Role};

/// A model of the light inside clouds: one file in `models`, one in `shaders/light`.
pub(in crate::render) struct Model {
    pub name: &'static str,
    /// What it does, with its source: a sentence or two.
    pub about: &'static str,
    /// The module that fills the role `light` of the march, and those that fill roles of its own.
    pub roles: &'static [Role<'static>],
    /// What is prepared in each cloud.
    pub needs: Needs,
    /// Tables that are the same for all clouds.
    pub tables: fn(&wgpu::Device, &wgpu::Queue) -> Result<Vec<TextureView>>,
    /// Textures that its module binds, by binding.
    pub textures: for<'a> fn(&Parts<'a>) -> Vec<(u32, &'a TextureView)>,
}

/// What a model reads of what can be prepared in a cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) struct Needs {
    /// The volume of optical depth to the sun.
    pub sun: bool,
    /// Maps of the cloud as the sun sees it.
    pub maps: bool,
    /// How open the cloud is to sky and ground.
    pub openness: Openness,
    /// Light that is solved for on a grid.
    pub field: bool,
}

/// When a model asks how open a cloud is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Openness {
    Never,
    WhereSkyLights,
    Always,
}

impl Needs {
    /// Nothing.
    pub const NONE: Self = Self { sun: false, maps: false, openness: Openness::Never, field: false };
    /// The sun's volume, and openness where sky and ground give light.
    pub const SUN: Self = Self { sun: true, openness: Openness::WhereSkyLights, ..Self::NONE };
    /// What slabs are fitted to, and how much their sides lose.
    pub const SLABS: Self = Self { maps: true, openness: Openness::Always, ..Self::SUN };

    /// Whether openness is asked for.
    pub fn openness(self, sky_lights: bool) -> bool {
        self.openness == Openness::Always || (self.openness == Openness::WhereSkyLights && sky_lights)
    }
}

/// What a model may bind for a cloud.
pub(in crate::render) struct Parts<'a> {
    pub light: &'a CloudLight,
    pub species: &'a SpeciesTextures,
    #[cfg_attr(not(feature = "slabs"), expect(dead_code, reason = "slabs alone have tables of their own"))]
    pub tables: &'a [TextureView],
    /// One dark voxel, in place of what is not read.
    pub dark: &'a TextureView,
}

impl<'a> Parts<'a> {
    /// Phase functions and optical depth to the sun: bindings 2 and 3 of every model with shadows.
    pub fn sunlight(&self) -> Vec<(u32, &'a TextureView)> {
        let sun = self.light.sun.as_ref().map_or(self.dark, |sun| &sun.volume);
        vec![(2, &self.species.phase), (3, sun)]
    }

    /// The same and openness to the sky, binding 4.
    pub fn openness(&self) -> Vec<(u32, &'a TextureView)> {
        let openness = self.light.openness.as_ref().map_or(self.dark, |openness| &openness.volume);
        let mut list = self.sunlight();
        list.push((4, openness));
        list
    }

    /// The same and maps from the sun, bindings 5 and 6.
    pub fn maps(&self) -> Vec<(u32, &'a TextureView)> {
        let mut list = self.openness();
        let maps = self.light.sun.as_ref().and_then(|sun| sun.maps.as_ref());
        list.extend(maps.into_iter().flat_map(|[depths, normals]| [(5, depths), (6, normals)]));
        list
    }

    /// Tables of the model from binding `first` on, after `before`.
    #[cfg(feature = "slabs")]
    pub fn tables(&self, before: Vec<(u32, &'a TextureView)>, first: u32) -> Vec<(u32, &'a TextureView)> {
        before.into_iter().chain((first..).zip(self.tables)).collect()
    }
}

/// No tables.
pub(super) fn no_tables(_: &wgpu::Device, _: &wgpu::Queue) -> Result<Vec<TextureView>> {
    Ok(Vec::new())
}

/// How light inside a cloud is found: one of the models that there are.
#[derive(Clone, Copy)]
pub struct Transport(pub(in crate::render) &'static Model);

impl Transport {
    /// Its name, as on the command line.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// What it does.
    pub fn about(self) -> &'static str {
        self.0.about
    }

    /// What fills the roles of the march's shader for it.
    pub fn roles(self) -> &'static [Role<'static>] {
        self.0.roles
    }
}

impl PartialEq for Transport {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Transport {}

impl Hash for Transport {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl fmt::Debug for Transport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Transport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
