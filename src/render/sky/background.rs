//! Drawing the sky behind everything: a pipeline for each kind of sky and target, and what it binds.

use wgpu::{TextureFormat, TextureView};

use super::{Shadows, Sky};
use crate::{
    frame::GroundShader,
    gpu::{self, Timing},
};

/// The background's pipeline, of one kind of sky, into one kind of target.
pub(super) struct Background {
    pub kind: BackgroundKind,
    pub format: TextureFormat,
    pub pipeline: wgpu::RenderPipeline,
}

/// What is compiled in.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct BackgroundKind {
    pub atmosphere: bool,
    pub sun_disc: bool,
    /// Whether clouds cast shadows.
    pub shaded: bool,
    /// What the ground is like.
    pub ground: GroundShader,
    /// Whether its light comes on top of what is there.
    pub adds: bool,
}

/// What drawing the sky binds that may change: its pipeline and textures.
pub(super) type Bound = (wgpu::RenderPipeline, [TextureView; 5]);

impl Sky {
    /// Draws what was last prepared over the whole of `target`, with alpha 1 and without shadows.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        target: &TextureView,
        format: TextureFormat,
        timing: Option<&Timing>,
    ) {
        let pipeline = self.background(device, format, self.current);
        let group = self.bind(device, &pipeline, None);
        Self::draw_with(encoder, target, (&pipeline, &group, None, false), timing);
    }

    /// The same with these shadows, over what is there or on top of it.
    pub(in crate::render) fn draw_shaded(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        (target, format): (&TextureView, TextureFormat),
        adds: bool,
        shadows: &Shadows,
        timing: Option<&Timing>,
    ) {
        let shaded = shadows.cast && self.current.atmosphere;
        let ground = self.ground.shader();
        let pipeline =
            self.background(device, format, BackgroundKind { shaded, ground, adds, ..self.current });
        let group = self.bind(device, &pipeline, Some(shadows));
        let ground = self.ground.bind(device, &pipeline);
        Self::draw_with(encoder, target, (&pipeline, &group, ground.as_ref(), adds), timing);
    }

    /// What drawing the sky binds, made anew only where something in it is another one than before.
    fn bind(
        &mut self,
        device: &wgpu::Device,
        pipeline: &wgpu::RenderPipeline,
        shadows: Option<&Shadows>,
    ) -> wgpu::BindGroup {
        let shadows = shadows.unwrap_or(&self.unshaded);
        let (numbers, lit) = shadows.map();
        let textures = [self.transmittance(), self.sky_view(), lit, shadows.air(), self.ground_light()]
            .map(TextureView::clone);
        let wanted = (pipeline.clone(), textures);
        if let Some((_, group)) = self.bound.as_ref().filter(|(bound, _)| *bound == wanted) {
            return group.clone();
        }
        let [transmittance, sky_view, lit, air, ground_light] =
            wanted.1.each_ref().map(wgpu::BindingResource::TextureView);
        let resources = [
            self.sky_uniform.as_entire_binding(),
            self.camera_uniform.as_entire_binding(),
            transmittance,
            sky_view,
            wgpu::BindingResource::Sampler(&self.sampler),
            numbers.as_entire_binding(),
            lit,
            air,
            ground_light,
        ];
        let group = gpu::bind_group(device, "sky", &pipeline.get_bind_group_layout(0), &resources.map(Some));
        self.bound = Some((wanted, group.clone()));
        group
    }

    fn draw_with(
        encoder: &mut wgpu::CommandEncoder,
        target: &TextureView,
        (pipeline, group, ground, adds): (
            &wgpu::RenderPipeline,
            &wgpu::BindGroup,
            Option<&wgpu::BindGroup>,
            bool,
        ),
        timing: Option<&Timing>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("sky"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: if adds { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) },
                    store: wgpu::StoreOp::Store,
                },
            })],
            timestamp_writes: timing.and_then(|timing| timing.render("sky")),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        if let Some(ground) = ground {
            pass.set_bind_group(1, ground, &[]);
        }
        pass.draw(0..3, 0..1);
    }

    /// The pipeline of a kind of background, compiled unless it was wanted before.
    fn background(
        &mut self,
        device: &wgpu::Device,
        format: TextureFormat,
        kind: BackgroundKind,
    ) -> wgpu::RenderPipeline {
        let known = self.backgrounds.iter().find(|known| known.kind == kind && known.format == format);
        if let Some(known) = known {
            return known.pipeline.clone();
        }
        let pipeline = background_pipeline(device, format, kind);
        self.backgrounds.push(Background { kind, format, pipeline: pipeline.clone() });
        pipeline
    }
}

fn background_pipeline(
    device: &wgpu::Device,
    format: TextureFormat,
    kind: BackgroundKind,
) -> wgpu::RenderPipeline {
    let flag = |on: bool| f64::from(u8::from(on));
    let overrides = [
        ("ATMOSPHERE", flag(kind.atmosphere)),
        ("SUN_DISC", flag(kind.sun_disc)),
        ("SHADED", flag(kind.shaded)),
        ("GROUND", flag(kind.ground != GroundShader::Even)),
    ];
    let blend = kind.adds.then_some(gpu::ADDS);
    let target = wgpu::ColorTargetState { blend, ..format.into() };
    gpu::screen_pipeline(device, ("sky", &[kind.ground.role()]), &overrides, target)
}
