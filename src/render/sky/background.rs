//! The pipelines that draw the sky behind everything: one for each kind of sky and target.

use wgpu::TextureFormat;

use crate::{frame::GroundShader, gpu};

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

pub(super) fn background_pipeline(
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
