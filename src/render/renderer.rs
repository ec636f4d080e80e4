//! The renderer: keeps what outlives a frame, and records a frame's passes.

mod pieces;

use std::sync::atomic::Ordering;

use super::{
    Counts, Quality,
    clouds::{CloudsPass, Draw, Seen, Shared},
    compose::Compose,
    frame::{CloudFrame, Frame},
    light::Inputs,
    light_store::LightStore,
    noise,
    sky::Sky,
    sky_settings::SkySettings,
    slab_textures::{SlabTable, SlabTextures},
    stats::Counters,
    target::{Layers, SceneDepth, Target},
    tiles::Cover,
    transport::Transport,
};
use rayon::prelude::*;

use crate::scene::Tone;
use crate::{
    Result,
    gpu::{self, Gpu, TextureDesc, Timing},
};

pub use pieces::Pieces;

/// Draws frames. Long-lived: keeps the noise volume, sky tables and the light inside the
/// clouds, and redoes only what a frame changed.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    format: wgpu::TextureFormat,
    /// How much work a picture gets.
    pub quality: Quality,
    /// How light inside a cloud is found.
    pub transport: Transport,
    /// Where Kol's and Bouthors' slabs take their light from; nothing else asks.
    pub slab_table: SlabTable,
    /// Whether the air between camera and clouds dims them and shines itself; without it the
    /// light is that of the clouds alone, as path traced pictures have it.
    pub aerial: bool,
    /// Clouds whose light is made for one picture, at most; those that wait for their turn keep
    /// what they have, of another moment. For windows in which something moves; no limit where
    /// left alone.
    pub lights_at_once: u32,
    /// Whether to count work; slower.
    pub counting: bool,
    /// Times the passes where the adapter can.
    pub timing: Option<Timing>,
    noise: Option<(u32, wgpu::TextureView)>,
    lights: LightStore,
    covers: Vec<Cover>,
    redone: u32,
    noises: u32,
    sky: Sky,
    clouds: CloudsPass,
    slab: Option<((Transport, SlabTable), SlabTextures)>,
    compose: Option<(wgpu::TextureFormat, Compose)>,
    counters: Counters,
    repeat: wgpu::Sampler,
    clamped: wgpu::Sampler,
    no_depth: wgpu::TextureView,
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
            quality: Quality::default(),
            transport: Transport::default(),
            aerial: true,
            lights_at_once: u32::MAX,
            counting: false,
            timing: None,
            noise: None,
            lights: LightStore::new(device),
            covers: Vec::new(),
            redone: 0,
            noises: 0,
            sky: Sky::new(device),
            clouds: CloudsPass::new(device),
            slab: None,
            slab_table: SlabTable::default(),
            compose: None,
            counters: Counters::new(device),
            repeat: gpu::linear_repeat(device),
            clamped: gpu::linear_clamp(device),
            no_depth: no_depth(device),
        }
    }

    /// Records the passes that draw `frame` into `target`. One frame a submission: the
    /// uniforms of a second one would reach the first. Submit the encoder: what it makes for
    /// later frames counts as made.
    pub fn render(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, target: &Target<'_>) {
        let mut pieces = self.begin_pieces(encoder, frame, target);
        self.draw_pieces(encoder, &mut pieces, u32::MAX);
    }

    /// Records the light of the clouds of `frame` alone, of [`Renderer::lights_at_once`] at most: a
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
        self.prepare_sky(encoder, frame);
        self.sky.draw(&self.device, encoder, color, self.format, self.timing.as_ref());
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

    /// Records the pass that finishes a linear picture for the screen, into 8 bits a channel.
    pub fn compose(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        tone: Tone,
    ) {
        if self.compose.as_ref().is_none_or(|(known, _)| *known != format) {
            self.compose = Some((format, Compose::new(&self.device, format)));
        }
        if let Some((_, compose)) = &self.compose {
            compose.draw(&self.device, encoder, picture, target, tone);
        }
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

    /// How many noise volumes this renderer has made so far: one for each seed after another.
    pub fn noise_updates(&self) -> u32 {
        self.noises
    }

    /// What `shaders/clouds.wgsl` has been compiled for so far: entry functions and their overrides,
    /// which leave out what a scene does not use.
    pub fn variants(&self) -> Vec<(&'static str, Vec<(&'static str, f64)>)> {
        self.clouds.variants().map(|variant| (variant.entry, variant.overrides().to_vec())).collect()
    }

    /// Clouds of the last picture that wait for their light: see [`Renderer::lights_at_once`].
    pub fn lights_waiting(&self) -> u32 {
        self.lights.waiting
    }

    /// Memory that the light in the clouds takes, bytes: at most twice what 64 clouds of the
    /// largest kind take in this quality and the coarsest light of all that are in the picture.
    pub fn light_bytes(&self) -> u64 {
        self.lights.bytes()
    }

    fn prepare(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, flush: Flush<'_>) {
        if self.counting {
            self.counters.clear(encoder);
        }
        self.prepare_sky(encoder, frame);
        if !frame.clouds.is_empty() {
            self.prepare_noise(frame.scene.noise.seed);
        }
        self.prepare_lights(encoder, frame, flush);
        let wanted = (self.transport, self.slab_table);
        if self.slab.as_ref().is_none_or(|(known, _)| *known != wanted) {
            self.slab = Some((wanted, SlabTextures::new(&self.device, &self.queue, wanted.0, wanted.1)));
        }
    }

    fn prepare_sky(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame) {
        let settings = SkySettings::new(&frame.scene, frame.to_sun);
        let redone = self.sky.prepare(
            &self.device,
            &self.queue,
            encoder,
            &settings,
            &frame.camera,
            self.timing.as_ref(),
        );
        self.redone += redone.count();
    }

    fn prepare_noise(&mut self, seed: u32) {
        if self.noise.as_ref().is_none_or(|(known, _)| *known != seed) {
            let volume = noise::upload(&self.device, &self.queue, seed);
            self.noise = Some((seed, view(&volume)));
            self.noises += 1;
        }
    }

    /// Finds where the clouds are in the picture, and makes the light of those that are.
    fn prepare_lights(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame, flush: Flush<'_>) {
        let cover = |cloud: &CloudFrame| {
            Cover::new(&frame.camera, (frame.camera_position - cloud.origin).as_vec3(), &cloud.ellipsoids)
        };
        self.covers = frame.clouds.par_iter().map(cover).collect();
        let Some((seed, noise_volume)) = &self.noise else { return };
        let inputs = Inputs {
            device: &self.device,
            noise_volume,
            repeat: &self.repeat,
            seed: *seed,
            to_sun: frame.to_sun,
            openness: self.transport.needs_openness(self.sky.lights()),
            moments: self.transport == Transport::Moments,
            mapped: self.transport.needs_maps(),
            sunlit: self.transport != Transport::Emitter,
            lit_by_sky: self.sky.lights(),
            sky: &self.sky,
            timing: self.timing.as_ref(),
        };
        let in_view: Vec<_> = self.covers.iter().map(|cover| !cover.tiles.is_empty()).collect();
        let most = self.lights_at_once;
        self.lights.prepare(encoder, &inputs, frame, &self.quality, &in_view, most, flush);
    }

    /// The clouds in the picture, far ones first.
    fn draws(
        &mut self,
        frame: &Frame,
        depth: Option<&SceneDepth<'_>>,
        entry: &'static str,
        format: wgpu::TextureFormat,
    ) -> Vec<Draw> {
        let (Some((_, noise_volume)), Some((_, slab))) = (&self.noise, &self.slab) else { return Vec::new() };
        let shared = Shared {
            device: &self.device,
            queue: &self.queue,
            frame,
            quality: &self.quality,
            transport: self.transport,
            camera: gpu::uniform_buffer(&self.device, "camera", &frame.camera.jittered(self.quality.jitter)),
            noise_volume,
            repeat: &self.repeat,
            clamped: &self.clamped,
            transmittance: self.sky.transmittance(),
            sky_light: self.sky.sky_light(),
            aerial: self.sky.aerial(),
            aerial_range: self.sky.aerial_range(),
            air: self.sky.atmosphere(),
            depth,
            no_depth: &self.no_depth,
            counters: &self.counters,
            counting: self.counting,
            atmosphere: self.sky.has_atmosphere(),
            air_before_clouds: self.aerial,
            lit_by_sky: self.sky.lights(),
            slab,
        };
        let mut order: Vec<usize> = (0..frame.clouds.len()).collect();
        let distance = |i: usize| (frame.clouds[i].origin - frame.camera_position).length();
        order.sort_by(|&a, &b| distance(b).total_cmp(&distance(a)));
        let seen = |i: usize| {
            let (light, cover) = (self.lights.get(i)?, &self.covers[i]);
            (!cover.tiles.is_empty()).then_some(Seen { cloud: &frame.clouds[i], light, cover })
        };
        let seen: Vec<_> = order.into_iter().filter_map(seen).collect();
        self.clouds.prepare(&shared, &seen, entry, format)
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

/// Submits what was recorded and waits for it: what it alone used is free again, and no
/// submission runs into a driver's time limit. Failures show when the picture is finished; where
/// it is given up, no more light is made.
fn submit(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> bool {
    let full = std::mem::replace(encoder, gpu.device.create_command_encoder(&Default::default()));
    gpu.queue.submit([full.finish()]);
    if let Err(error) = gpu.device.poll(wgpu::PollType::wait_indefinitely()) {
        tracing::error!(%error, "waiting for light");
    }
    !gpu::stop_flag().load(Ordering::Relaxed)
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
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

/// Stands in where the caller drew nothing; the shader doesn't read it.
fn no_depth(device: &wgpu::Device) -> wgpu::TextureView {
    let texture = gpu::texture(
        device,
        &TextureDesc {
            label: "no depth",
            size: [1, 1, 0],
            mips: 1,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        },
    );
    view(&texture)
}
