//! Pictures that exports are made of.

use glam::DVec3;

use super::Picture;
use crate::{
    Error, Result,
    gpu::Gpu,
    render::{Film, Frame, Quality, Renderer, Transport},
    scene::Scene,
};

/// Takes pictures in final quality, each pixel the mean of some rays.
pub struct Studio {
    gpu: Gpu,
    renderer: Renderer,
    rays: u32,
}

/// A cloud on its own, layer by layer.
pub struct Shot {
    /// Its light, multiplied by alpha.
    pub color: Picture,
    /// Its mean distance in metres times alpha, in the first channel; alpha in the last.
    pub distance: Picture,
    /// Which way it faces in the world, times alpha.
    pub normal: Picture,
}

impl Studio {
    /// A studio that takes `rays` by `rays` rays a pixel. Clouds alone have neither air nor ground in front of
    /// them: they look the same from any distance, and are whole, as sprites must.
    pub fn new(gpu: &Gpu, rays: u32, among_air_and_ground: bool) -> Self {
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
        renderer.settings.quality = Quality::FINAL;
        (renderer.settings.aerial, renderer.settings.ground) = (among_air_and_ground, among_air_and_ground);
        // Sprites have nothing that a shadow could fall on.
        renderer.settings.shadows = among_air_and_ground;
        Self { gpu: gpu.clone(), renderer, rays }
    }

    /// The device that it works on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Its renderer, for finishing pictures and for another transport.
    pub fn renderer(&mut self) -> &mut Renderer {
        &mut self.renderer
    }

    /// A picture of `scene` by its own camera, before its sky or before nothing.
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn picture(&mut self, scene: &Scene, size: [u32; 2], sky: bool) -> Result<Picture> {
        let film = Film::new(size, self.rays);
        film.take(&self.gpu, &mut self.renderer, &film.frame(scene)?, sky, &mut |_| ())
    }

    /// Share of the sun's light that clouds let through to points of a horizontal square of
    /// `extent` metres around `center`, from 0 to 1: north on top, east to the right, row by row.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] where the sun does not stand above the horizon; or where the
    /// scene is not valid or the device fails.
    pub fn sunlight_on(&mut self, scene: &Scene, center: DVec3, extent: f64, size: u32) -> Result<Vec<f32>> {
        let film = Film::new([size; 2], self.rays);
        let frame = Frame::towards_sun(scene, center, extent, film.rays() * size)?;
        // Opacity is the same in every model of transport: this is the least work.
        let transport = std::mem::replace(&mut self.renderer.settings.transport, Transport::SINGLE);
        let picture = film.take(&self.gpu, &mut self.renderer, &frame, false, &mut |_| ());
        self.renderer.settings.transport = transport;
        Ok(picture?.pixels.iter().map(|pixel| 1.0 - pixel[3]).collect())
    }

    /// Middle and edge, m, of the smallest square at `altitude` that holds the shadows of all clouds,
    /// and a little more.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] where there is no cloud or no sun above the horizon; or where the scene is
    /// not valid.
    pub fn shadows_of(&self, scene: &Scene, altitude: f64) -> Result<(DVec3, f64)> {
        let frame = Frame::towards_sun(scene, DVec3::ZERO, 1.0, 1)?;
        let (low, high) = frame.bounds().ok_or_else(|| {
            Error::Argument(
                "the scene has no cloud that is not hidden: nothing casts a shadow; layers have no end: tell middle and extent of the \
                 square"
                    .to_owned(),
            )
        })?;
        let at = |y: f64| -frame.sun.to_sun * ((y - altitude) / frame.sun.to_sun.y);
        let corners = [low, high].map(|corner| [at(low.y), at(high.y)].map(|shift| corner + shift));
        let [least, most] = [DVec3::min, DVec3::max].map(|pick| corners.into_iter().flatten().reduce(pick));
        let (least, most) = (least.unwrap_or_default(), most.unwrap_or_default());
        let middle = 0.5 * (least + most);
        let extent = 1.02 * (most - least).x.max((most - least).z);
        Ok((DVec3::new(middle.x, altitude, middle.z), extent))
    }

    /// Clouds alone by the scene's own camera, with their distance and the way that they face.
    ///
    /// # Errors
    /// Where the scene is not valid or the device fails.
    pub fn shot(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Shot> {
        let film = Film::new(size, self.rays);
        let layers = self.renderer.render_layers(&self.gpu, &film.frame(scene)?, &mut |_| ())?;
        let read = |texture| film.read(&self.gpu, texture);
        let mut color = read(&layers.sun.single)?;
        let further =
            layers.lights.iter().flat_map(|(_, light)| [&light.single, &light.multiple, &light.air]);
        for layer in [&layers.sun.multiple, &layers.sun.air].into_iter().chain(further) {
            color.add_light(&read(layer)?);
        }
        let color = color.times(layers.unit);
        let mut distance = read(&layers.distance)?;
        distance.pixels.iter_mut().for_each(|pixel| pixel[0] *= 1e3);
        Ok(Shot { color, distance, normal: read(&layers.normal)? })
    }
}
