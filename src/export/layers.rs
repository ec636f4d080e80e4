//! Pictures apart, for compositors: light by what it comes from, places, motion, and clouds by their names.

use std::path::Path;

use super::{
    Notes, Picture,
    cryptomatte::{attributes, ranks},
    exr::{Attributes, channels, write_channels},
    places::Places,
};
use crate::{
    Result,
    gpu::Gpu,
    render::{Frame, Layers, LightLayers},
    scene::Movement,
};

/// A kind of layers beside the beauty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LayerKind {
    /// What the beauty is the sum of, and `transmittance.Y`.
    Light,
    /// `depth.Z`: distance from the eye, m; 1e10 where there is no cloud.
    Distance,
    /// `normal.X`, `.Y`, `.Z`: which way the cloud faces in the world, times opacity.
    Normal,
    /// `planar.Z`: the same along the camera's axis, m.
    Depth,
    /// `position.X`, `.Y`, `.Z`: where in the world the cloud is that is seen, m; 0 where there is none.
    Position,
    /// `motion.X`, `.Y`: how far that goes in the picture until the next frame, pixels to the right and up; 0 where
    /// there is no cloud.
    Motion,
    /// `CryptoCloud`: which clouds are in each pixel, and how much of it each one hides.
    Clouds,
}

impl LayerKind {
    /// Those that are written where none are named.
    pub const PLAIN: [Self; 3] = [Self::Light, Self::Distance, Self::Normal];
}

/// What pictures apart are of.
#[derive(Clone, Copy)]
pub struct Layered<'a> {
    /// The light apart; with mattes where clouds are to be apart, too, or go different ways.
    pub layers: &'a Layers,
    /// What they were drawn of.
    pub frame: &'a Frame,
    /// What is seen in the next frame, and how far clouds go until then: for motion.
    pub next: Option<(&'a Frame, &'a Movement)>,
    /// What the clouds are called, in the order of the moment.
    pub names: &'a [String],
    /// Squares of so many rays become a pixel.
    pub reduce: usize,
}

/// Writes the beauty and the layers of [`LayerKind::PLAIN`]: `beauty = sky * transmittance + single + multiple + air`,
/// and the light of the clouds, single + multiple, by what it comes from, `lit.sun`, `lit.sky` (sky and ground, the
/// sun's light in them included) and `lit.NAME`. A `transparent` beauty leaves the sky out and has the clouds' alpha.
/// Where there are lights beside the sun, `light.sun` and `light.NAME` have what each of them gives to the beauty.
/// Squares of `reduce` pixels become one.
///
/// # Errors
/// [`crate::Error::Gpu`] when the device fails, [`crate::Error::File`] when the file
/// can't be written.
pub fn write_layers(path: &Path, gpu: &Gpu, layers: &Layers, transparent: bool, reduce: usize) -> Result<()> {
    let mut list = Vec::new();
    let beauty = light(&mut list, gpu, layers, reduce, transparent, true)?;
    plain_places(&mut list, gpu, layers, reduce, &[LayerKind::Distance, LayerKind::Normal])?;
    write_channels(path, &beauty, list, &Notes::default(), Attributes::new())
}

/// Writes the beauty and layers of these kinds, with notes as attributes.
///
/// # Errors
/// [`crate::Error::Argument`] where there is no such layer of the picture, [`crate::Error::Gpu`] when the device fails,
/// [`crate::Error::File`] when the file can't be written.
pub fn write_layers_of(
    path: &Path,
    gpu: &Gpu,
    of: Layered<'_>,
    kinds: &[LayerKind],
    transparent: bool,
    notes: &Notes,
) -> Result<()> {
    let (layers, reduce) = (of.layers, of.reduce);
    let has = |kind| kinds.contains(&kind);
    let (mut list, mut more) = (Vec::new(), Attributes::new());
    let beauty = light(&mut list, gpu, layers, reduce, transparent, has(LayerKind::Light))?;
    plain_places(&mut list, gpu, layers, reduce, kinds)?;
    if [LayerKind::Depth, LayerKind::Position, LayerKind::Motion].into_iter().any(has) {
        let places = Places::read(gpu, of)?;
        if has(LayerKind::Depth) {
            list.push(("planar.Z".to_owned(), places.depths()?));
        }
        if has(LayerKind::Position) {
            list.extend(named("position", &["X", "Y", "Z"], &places.positions()));
        }
        if has(LayerKind::Motion) {
            list.extend(named("motion", &["X", "Y"], &places.motions(gpu, of)?));
        }
    }
    if has(LayerKind::Clouds) {
        list.extend(ranks(gpu, of)?);
        more.extend(attributes(of.names));
    }
    write_channels(path, &beauty, list, notes, more)
}

/// The beauty, which goes into the list; with what it is the sum of, where `apart`.
fn light(
    list: &mut Vec<(String, Vec<f32>)>,
    gpu: &Gpu,
    layers: &Layers,
    reduce: usize,
    transparent: bool,
    apart: bool,
) -> Result<Picture> {
    let read = |texture: &wgpu::Texture| Ok(read(gpu, texture, reduce)?.times(layers.unit));
    let mut all = Apart::read(&layers.sun, read)?;
    let mut own = Vec::new();
    if !layers.lights.is_empty() {
        own.extend(without_alpha(channels("light.sun", &all.beauty(transparent))));
    }
    own.extend(without_alpha(channels("lit.sun", &all.of_sun())));
    own.extend(without_alpha(channels("lit.sky", &all.ambient)));
    for (name, light) in &layers.lights {
        let light = Apart::read(light, read)?;
        own.extend(without_alpha(channels(&format!("light.{name}"), &light.beauty(transparent))));
        own.extend(without_alpha(channels(&format!("lit.{name}"), &light.of_clouds())));
        all.add(&light);
    }
    let beauty = all.beauty(transparent);
    list.extend(channels("", &beauty));
    if apart {
        list.extend(own);
        let again = all.again();
        let shown = [("sky", &all.sky), ("single", &all.single), ("multiple", &again), ("air", &all.air)];
        for (name, layer) in shown {
            list.extend(without_alpha(channels(name, layer)));
        }
        list.push(("transmittance.Y".to_owned(), all.single.pixels.iter().map(|p| 1.0 - p[3]).collect()));
    }
    Ok(beauty)
}

/// Distance and normal, where they are wanted.
fn plain_places(
    list: &mut Vec<(String, Vec<f32>)>,
    gpu: &Gpu,
    layers: &Layers,
    reduce: usize,
    kinds: &[LayerKind],
) -> Result<()> {
    if kinds.contains(&LayerKind::Distance) {
        let distance = read(gpu, &layers.distance, reduce)?;
        list.push((
            "depth.Z".to_owned(),
            distance.pixels.iter().map(|p| metres(p).unwrap_or(NOTHING)).collect(),
        ));
    }
    if kinds.contains(&LayerKind::Normal) {
        let normal = read(gpu, &layers.normal, reduce)?;
        let values: Vec<_> = normal.pixels.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        list.extend(named("normal", &["X", "Y", "Z"], &values));
    }
    Ok(())
}

/// Channels of a layer.
fn named<const N: usize>(layer: &str, names: &[&str; N], values: &[[f32; N]]) -> Vec<(String, Vec<f32>)> {
    let channel =
        |(i, name): (usize, &&str)| (format!("{layer}.{name}"), values.iter().map(|v| v[i]).collect());
    names.iter().enumerate().map(channel).collect()
}

/// Rays become pixels.
pub(super) fn read(gpu: &Gpu, texture: &wgpu::Texture, reduce: usize) -> Result<Picture> {
    Picture::read(gpu, texture).map(|picture| picture.reduced(reduce))
}

/// Depths where there is no cloud, m.
pub(super) const NOTHING: f32 = 1e10;
/// A cloud that hides less is none.
const LEAST: f32 = 1e-3;

/// Distance, m, of a pixel of [`Layers::distance`].
pub(super) fn metres(pixel: &[f32; 4]) -> Option<f32> {
    (pixel[3] > LEAST).then(|| 1e3 * pixel[0] / pixel[3])
}

/// What the light of a picture is made of.
struct Apart {
    sky: Picture,
    single: Picture,
    multiple: Picture,
    ambient: Picture,
    air: Picture,
}

impl Apart {
    fn read(light: &LightLayers, read: impl Fn(&wgpu::Texture) -> Result<Picture>) -> Result<Self> {
        Ok(Self {
            sky: read(&light.sky)?,
            single: read(&light.single)?,
            multiple: read(&light.multiple)?,
            ambient: read(&light.ambient)?,
            air: read(&light.air)?,
        })
    }

    fn add(&mut self, other: &Self) {
        self.sky.add_light(&other.sky);
        self.single.add_light(&other.single);
        self.multiple.add_light(&other.multiple);
        self.ambient.add_light(&other.ambient);
        self.air.add_light(&other.air);
    }

    /// What clouds scatter of the sun's light.
    fn of_sun(&self) -> Picture {
        sum(&self.single, &self.multiple)
    }

    /// What clouds scatter more often, or of the light of the sky.
    fn again(&self) -> Picture {
        sum(&self.multiple, &self.ambient)
    }

    /// All that clouds scatter.
    fn of_clouds(&self) -> Picture {
        sum(&self.single, &self.again())
    }

    /// Put together again: opaque over the sky, or the clouds alone.
    fn beauty(&self, transparent: bool) -> Picture {
        let mut clouds = sum(&self.of_clouds(), &self.air);
        if !transparent {
            clouds.put_over(&self.sky);
        }
        clouds
    }
}

/// The light of both, with the alpha of the first.
fn sum(a: &Picture, b: &Picture) -> Picture {
    let mut sum = a.clone();
    sum.add_light(b);
    sum
}

fn without_alpha(channels: Vec<(String, Vec<f32>)>) -> impl Iterator<Item = (String, Vec<f32>)> {
    channels.into_iter().filter(|(name, _)| !name.ends_with('A'))
}
