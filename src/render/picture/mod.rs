//! The renderer: keeps what outlives a frame, and records a frame's passes.

mod compose;
mod film;
mod meter;
mod pieces;
mod pixels;
mod resolve;
mod target;

use rayon::prelude::*;

use super::{
    Counts, Quality, Settings,
    light::{Inputs, LightStore, Presence},
    march::{Counters, Cover, Draw, MANY, March, Variant, View},
    medium::Media,
    shadow::{ShadowInputs, Shadows, SunMap, may_shade},
    sky::Sky,
};
use crate::{
    Result,
    frame::{CloudFrame, Frame},
    gpu::{self, Gpu, TextureDesc, Timing, view},
    scene::Tone,
};
use compose::Compose;
#[cfg(test)]
pub(crate) use compose::ComposeUniform;
pub use film::Film;
pub use meter::metered_alone;
pub use pieces::Pieces;
pub use pixels::Picture;
pub use resolve::{HeatMap, Resolve, Shown};
#[cfg(test)]
pub(crate) use resolve::{ResolveUniform, uniform as resolve_uniform};
pub use target::{Layers, SceneDepth, Target};

/// Draws frames. Long-lived: keeps the noise volume, sky tables and the light inside the
/// clouds, and redoes only what a frame changed.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    format: wgpu::TextureFormat,
    /// How it draws.
    pub settings: Settings,
    /// Times the passes where the adapter can.
    pub timing: Option<Timing>,
    media: Media,
    lights: LightStore,
    covers: Vec<Cover>,
    redone: u32,
    sky: Sky,
    shadows: Shadows,
    march: March,
    compose: Option<(wgpu::TextureFormat, Compose)>,
    counters: Counters,
}

/// May submit what was recorded so far; says whether to go on.
type Flush<'a> = &'a mut dyn FnMut(&mut wgpu::CommandEncoder) -> bool;

/// Sine of the elevation from which the sun casts shadows: below it they are as long as the air is deep.
const LOWEST_SUN: f64 = 5e-3;

const HDR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl Renderer {
    /// A renderer into textures of `format`, which should hold linear light:
    /// `Rgba16Float` unless there is a reason.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            format,
            settings: Settings::default(),
            timing: None,
            media: Media::new(device, queue),
            lights: LightStore::default(),
            covers: Vec::new(),
            redone: 0,
            sky: Sky::new(device),
            shadows: Shadows::new(device),
            march: March::new(device, queue),
            compose: None,
            counters: Counters::new(device),
        }
    }

    /// Records the passes that draw `frame` into `target`. One frame a submission: the
    /// uniforms of a second one would reach the first. Submit the encoder: what it makes for
    /// later frames counts as made.
    pub fn render(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, target: &Target<'_>) {
        let mut pieces = self.begin_pieces(encoder, frame, target);
        self.draw_pieces(encoder, &mut pieces, u32::MAX);
    }

    /// Records the light of the clouds of `frame` alone, of [`Settings::lights_at_once`] at most: a
    /// picture that follows finds it made.
    pub fn prepare_light(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        self.prepare(encoder, frame, &mut |_| true);
    }

    /// Records the sky alone, over all of `color`: for callers that draw geometry between
    /// sky and clouds. Then give [`Renderer::render`] a target whose `sky` is false.
    pub fn render_sky(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        color: &wgpu::TextureView,
    ) {
        self.prepare(encoder, frame, &mut |_| true);
        self.draw_sky(encoder, color, self.format);
    }

    /// Does the same as [`Renderer::render`] in pieces, each submitted and finished by itself, so that slow
    /// adapters do not run into their driver's time limit; tells the share done.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn render_in_pieces(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        target: &Target<'_>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<()> {
        let mut encoder = self.encoder();
        let pieces = self.begin(&mut encoder, frame, target, &mut |encoder| submit(gpu, encoder));
        self.draw_all(gpu, encoder, pieces, progress)
    }

    /// Draws the light of `frame` apart, in pieces.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn render_layers(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Layers> {
        let mut encoder = self.encoder();
        let (layers, pieces) = self.begin_apart(&mut encoder, frame, &mut |encoder| submit(gpu, encoder));
        self.draw_all(gpu, encoder, pieces, progress)?;
        Ok(layers)
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&Default::default())
    }

    fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(timing) = &self.timing {
            timing.resolve(encoder);
        }
    }

    /// What clouds leave of the sun's light, as it was last prepared: for the caller's own ground and things, so that
    /// they lie in the very shadows that nephos draws. None where nothing casts any: without clouds, without an
    /// atmosphere, at night, or with [`Settings::shadows`] off.
    pub fn sun_map(&self) -> Option<SunMap<'_>> {
        self.shadows.sun_map()
    }

    /// Records the pass that finishes a linear picture for the screen, into 8 bits a channel.
    pub fn compose(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        tone: Tone,
    ) {
        let known = self.compose.take().filter(|(known, _)| *known == format);
        let made = known.unwrap_or_else(|| (format, Compose::new(&self.device, format)));
        let (_, compose) = self.compose.insert(made);
        compose.draw(&self.device, encoder, picture, target, tone);
    }

    /// A texture that can be drawn into, sampled and read back.
    pub fn picture(
        &self,
        label: &str,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        gpu::texture(&self.device, &TextureDesc { label, size: [width, height, 0], mips: 1, format, usage })
    }

    /// Work of the last frame that was drawn while `counting` was on.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn counts(&self, gpu: &Gpu) -> Result<Counts> {
        self.counters.read(gpu)
    }

    /// How many volumes and tables of light this renderer has made so far: a frame that
    /// changes nothing adds none.
    pub fn light_updates(&self) -> u32 {
        self.redone + self.lights.redone
    }

    /// What `shaders/march.wgsl` has been compiled for so far.
    pub fn variants(&self) -> impl Iterator<Item = &Variant> {
        self.march.variants()
    }

    /// How many clouds' volumes of depths this renderer has baked so far: one a shape.
    pub fn volumes_baked(&self) -> u32 {
        self.media.baked
    }

    /// Memory of the volumes of depths, bytes.
    pub fn volume_bytes(&self) -> u64 {
        self.media.bytes()
    }

    /// Memory of the bricks of volumes that were read from files, bytes.
    pub fn brick_bytes(&self) -> u64 {
        self.media.brick_bytes()
    }

    /// Clouds of the last picture that wait for their light: see [`Settings::lights_at_once`].
    pub fn lights_waiting(&self) -> u32 {
        self.lights.waiting
    }

    /// Memory that the light in the clouds takes, bytes: at most twice what 64 clouds of the
    /// largest kind take in this quality and the coarsest light of all that are in the picture.
    pub fn light_bytes(&self) -> u64 {
        self.lights.bytes()
    }

    fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, flush: Flush<'_>) {
        if self.settings.counting {
            self.counters.clear(encoder);
        }
        self.media.begin(self.settings.bake_from);
        self.prepare_sky(encoder, frame);
        self.prepare_lights(encoder, frame, flush);
        self.prepare_shadows(encoder, frame);
    }

    /// Whether clouds cast shadows on anything in a picture of `frame`.
    fn is_shaded(&self, frame: &Frame) -> bool {
        self.settings.shadows && self.sky.has_atmosphere() && frame.sun.to_sun.y > LOWEST_SUN
    }

    fn prepare_shadows(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        if !self.is_shaded(frame) {
            self.shadows.none();
            return;
        }
        let inputs = ShadowInputs {
            device: &self.device,
            queue: &self.queue,
            frame,
            sky: &self.sky,
            aerial: self.settings.aerial,
            timing: self.timing.as_ref(),
        };
        let texels = self.settings.quality.shadow_texels;
        let casters = self.lights.casters(frame);
        self.redone += self.shadows.prepare(&inputs, encoder, casters, texels);
    }

    fn draw_sky(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
    ) {
        self.sky.draw_shaded(&self.device, encoder, (target, format), &self.shadows, self.timing.as_ref());
    }

    fn prepare_sky(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        let timing = self.timing.as_ref();
        let redone = self.sky.prepare(&self.device, &self.queue, encoder, &frame.sky, &frame.camera, timing);
        self.redone += redone.count();
    }

    /// Finds where the clouds are in the picture, and makes the light of those that are.
    fn prepare_lights(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, flush: Flush<'_>) {
        self.media.plan(frame.clouds.iter().map(|cloud| &*cloud.medium));
        // Told before: what is of the device may not go from thread to thread in a browser.
        let baked: Vec<_> = frame.clouds.iter().map(|cloud| self.media.is_baked(&cloud.medium)).collect();
        let cover = |(cloud, &baked): (&CloudFrame, &bool)| {
            let eye = (frame.camera_position - cloud.origin).as_vec3();
            if let Some(layer) = &cloud.medium.layer {
                let bend = 0.5 / frame.sky.uniform.atmosphere.ground_radius;
                return Cover::of_layer(&frame.camera, eye, layer, bend);
            }
            // The index of a volume tells rays where something is.
            let baked = baked || cloud.medium.volume.is_some();
            let many = if baked { usize::MAX } else { MANY };
            let mut cover = Cover::new(&frame.camera, eye, &cloud.medium.ellipsoids, many);
            if baked {
                cover.candidates.clear();
            }
            cover
        };
        self.covers = frame.clouds.par_iter().zip(&baked).map(cover).collect();
        let in_view: Vec<_> = self.covers.iter().map(|cover| !cover.tiles.is_empty()).collect();
        let shaded = self.is_shaded(frame);
        let presence = |(cloud, seen): (&CloudFrame, &bool)| {
            // Under a layer there is no place that it does not shade.
            if *seen || (shaded && cloud.medium.layer.is_some()) {
                Presence::Seen
            } else if shaded && may_shade(frame, cloud) {
                Presence::Shading
            } else {
                Presence::Away
            }
        };
        let presence: Vec<_> = frame.clouds.iter().zip(&in_view).map(presence).collect();
        for (cloud, _) in frame.clouds.iter().zip(&presence).filter(|(_, here)| **here != Presence::Away) {
            self.media.prepare(encoder, &cloud.medium);
        }
        let inputs = Inputs {
            device: &self.device,
            to_sun: frame.sun.to_sun,
            needs: self.settings.transport.0.needs,
            lit_by_sky: self.sky.lights(),
            sky: &self.sky,
            timing: self.timing.as_ref(),
        };
        let Settings { quality, lights_at_once, .. } = &self.settings;
        let media = &self.media;
        self.lights.prepare(encoder, &inputs, media, frame, quality, &presence, *lights_at_once, flush);
    }

    /// The clouds in the picture, far ones first.
    fn draws(
        &mut self,
        frame: &Frame,
        depth: Option<&SceneDepth<'_>>,
        entry: &'static str,
        format: wgpu::TextureFormat,
    ) -> Vec<Draw> {
        let order = far_to_near(frame);
        let (settings, sky, shadows, counters) = (&self.settings, &self.sky, &self.shadows, &self.counters);
        let view = View { frame, settings, depth, sky, shadows, counters, entry, format };
        self.march.prepare(&view, &order, &self.covers, &self.media, &mut self.lights)
    }

    /// Begins a pass over what `targets` hold.
    fn clouds_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        targets: &[wgpu::TextureView],
    ) -> wgpu::RenderPass<'a> {
        let attachments: Vec<_> =
            targets.iter().map(|view| Some(attachment(view, wgpu::LoadOp::Load))).collect();
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clouds"),
            color_attachments: &attachments,
            timestamp_writes: self.timing.as_ref().and_then(|timing| timing.render("clouds")),
            ..Default::default()
        })
    }
}

/// The clouds by number, far ones first. What is beyond a layer, in height, is farther than it, however near it is.
fn far_to_near(frame: &Frame) -> Vec<usize> {
    let eye = frame.camera_position;
    let is_layer = |i: usize| frame.clouds[i].medium.layer.is_some();
    let height = |i: usize| frame.clouds[i].origin.y - eye.y;
    let layers: Vec<usize> = (0..frame.clouds.len()).filter(|&i| is_layer(i)).collect();
    let before = |i: usize, layer: usize| {
        let (far, near) = (height(i), height(layer));
        layer != i && far.signum() == near.signum() && near.abs() < far.abs()
    };
    let layers_before = |i: usize| layers.iter().filter(|&&layer| before(i, layer)).count();
    let distance = |i: usize| (frame.clouds[i].origin - eye).length();
    let mut order: Vec<usize> = (0..frame.clouds.len()).collect();
    order.sort_by(|&a, &b| {
        let beyond = layers_before(b).cmp(&layers_before(a)).then(is_layer(b).cmp(&is_layer(a)));
        beyond.then(distance(b).total_cmp(&distance(a)))
    });
    order
}

/// Submits what was recorded and waits for it: what it alone used is free again, and no
/// submission runs into a driver's time limit. Failures show when the picture is finished; where
/// it is given up, no more light is made.
fn submit(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> bool {
    let full = std::mem::replace(encoder, gpu.device.create_command_encoder(&Default::default()));
    gpu.queue.submit([full.finish()]);
    if let Err(error) = gpu.device.poll(wgpu::PollType::wait_indefinitely()) {
        tracing::error!(%error, "waiting for light");
    }
    !gpu.is_stopped()
}

fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    }
}

fn clear(encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("clear"),
        color_attachments: &[Some(attachment(target, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT)))],
        ..Default::default()
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn may_be_shared<T: Send + Sync>() {}

    /// Engines keep renderers among what their systems share, and frames go from thread to thread.
    #[allow(dead_code, reason = "it is enough that this compiles")]
    const SHARED: () = {
        may_be_shared::<Renderer>();
        may_be_shared::<Pieces>();
        may_be_shared::<Layers>();
        may_be_shared::<Resolve>();
        may_be_shared::<Frame>();
        may_be_shared::<Gpu>();
    };
}
