//! The renderer: keeps what outlives a frame, and records a frame's passes.

mod blur;
mod compose;
mod draws;
mod film;
mod lamp;
mod matte;
mod meter;
mod pieces;
mod pixels;
mod prepare;
mod resolve;
mod target;

use super::{
    Counts, Quality, Settings,
    march::{Counters, Crossings, Draw, March, Variant, View},
    medium::Media,
    shadow::SunMap,
};
use crate::{
    Result,
    frame::{Frame, LitBy},
    gpu::{self, Gpu, TextureDesc, Timing, view},
    scene::{MAX_LIGHTS, Tone},
};
pub use blur::Blur;
use compose::Compose;
#[cfg(test)]
pub(crate) use compose::ComposeUniform;
use draws::far_to_near;
pub use film::Film;
use lamp::{Lamp, Room, Way};
pub use matte::{Matte, MattePixel};
pub use meter::metered_alone;
use pieces::Apart;
pub use pieces::Pieces;
pub use pixels::Picture;
use prepare::{Covers, Drawn, Prepared};
pub use resolve::{HeatMap, Resolve, Shown};
#[cfg(test)]
pub(crate) use resolve::{ResolveUniform, uniform as resolve_uniform};
pub use target::{Layers, LightLayers, SceneDepth, Target};

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
    covers: Covers,
    crossings: Crossings,
    /// What was last prepared, and drawn.
    prepared: Option<Prepared>,
    drawn: Option<Drawn>,
    /// Where it was drawn into whole, and whether with the sky.
    shown: Option<(wgpu::TextureView, bool)>,
    sun: Lamp,
    /// Lights beside it that shine, by their number in the scene.
    further: [Option<Lamp>; MAX_LIGHTS],
    march: March,
    compose: Option<(wgpu::TextureFormat, Compose)>,
    counters: Counters,
}

/// May submit what was recorded so far; says whether to go on.
type Flush<'a> = &'a mut dyn FnMut(&mut wgpu::CommandEncoder) -> bool;

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
            covers: Covers::default(),
            crossings: Crossings::default(),
            prepared: None,
            drawn: None,
            shown: None,
            sun: Lamp::new(device),
            further: Default::default(),
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
        self.shown = Some((target.color.clone(), target.sky));
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
        self.draw_sky(encoder, frame, color, self.format);
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
        self.draw_apart(gpu, frame, Apart::Light, progress)
    }

    /// The same with a matte of each cloud, [`Layers::mattes`].
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn render_layers_and_mattes(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Layers> {
        self.draw_apart(gpu, frame, Apart::Clouds, progress)
    }

    fn draw_apart(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        apart: Apart,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Layers> {
        let mut encoder = self.encoder();
        let flush: Flush<'_> = &mut |encoder| submit(gpu, encoder);
        let (layers, pieces) = self.begin_apart(&mut encoder, frame, apart, flush);
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
        self.sun.shadows.sun_map()
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
        self.lamps().map(|lamp| lamp.redone + lamp.clouds.redone).sum()
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
        self.lamps().map(|lamp| lamp.clouds.waiting).sum()
    }

    /// Memory that the light in the clouds takes, bytes: for each light at most twice what 64 clouds of the
    /// largest kind take in this quality and the coarsest light of all that are in the picture.
    pub fn light_bytes(&self) -> u64 {
        self.lamps().map(|lamp| lamp.clouds.bytes()).sum()
    }

    /// The sun and the lights beside it.
    fn lamps(&self) -> impl Iterator<Item = &Lamp> {
        [&self.sun].into_iter().chain(self.further.iter().flatten())
    }

    /// The sky in all lights.
    fn draw_sky(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
    ) {
        let timing = self.timing.as_ref();
        self.sun.draw_sky(&self.device, encoder, (target, format), false, timing);
        for light in frame.lights().iter().filter(|light| light.by == LitBy::Sky) {
            if let Some(lamp) = &mut self.further[light.number] {
                lamp.draw_sky(&self.device, encoder, (target, format), true, timing);
            }
        }
    }

    /// Begins a pass over what `targets` hold, and a matte beside them, which may begin with it.
    fn clouds_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        targets: &[wgpu::TextureView],
        matte: Option<(&wgpu::TextureView, bool)>,
    ) -> wgpu::RenderPass<'a> {
        let mut attachments: Vec<_> =
            targets.iter().map(|view| Some(attachment(view, wgpu::LoadOp::Load))).collect();
        attachments.extend(matte.map(|(view, begins)| {
            let load =
                if begins { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
            Some(attachment(view, load))
        }));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clouds"),
            color_attachments: &attachments,
            timestamp_writes: self.timing.as_ref().and_then(|timing| timing.render("clouds")),
            ..Default::default()
        })
    }
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
