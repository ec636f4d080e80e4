//! How open a cloud is to sky, horizon and ground.

use std::collections::HashMap;

use wgpu::TextureView;

use super::{
    bricks::Bricks,
    inputs::Inputs,
    sun::{BoxKey, volume},
};
use crate::{
    frame::medium::MediumKind,
    gpu::{self, ComputeProgram},
};

/// Optical depth up, down and aside in an upright box.
pub(super) struct Openness {
    pub volume: TextureView,
}

/// The programs by medium, compiled when first needed.
#[derive(Default)]
pub(super) struct OpennessPass(HashMap<MediumKind, ComputeProgram>);

impl OpennessPass {
    pub fn make(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        key: &BoxKey,
    ) -> Openness {
        let device = inputs.device;
        let kind = inputs.media.kind(&key.medium);
        let program = self
            .0
            .entry(kind)
            .or_insert_with(|| ComputeProgram::with_roles(device, "sky_volume", &[kind.role()], &[]));
        let volume = gpu::view(&volume(device, "sky volume", key.voxels));
        let bricks = Bricks::of(&key.light_box, &key.medium, key.voxels);
        let buffers = [
            gpu::uniform_buffer(device, "light box", &key.light_box),
            gpu::storage_buffer(device, "bricks", &bricks.lists),
            gpu::storage_buffer(device, "ellipsoids of bricks", &bricks.candidates),
        ];
        let mut resources: Vec<_> = buffers.iter().map(|buffer| Some(buffer.as_entire_binding())).collect();
        resources.push(Some(wgpu::BindingResource::TextureView(&volume)));
        let group = program.bind(device, &resources);
        let stamps = inputs.timing.and_then(|timing| timing.compute("sky volume"));
        program.dispatch_over(encoder, &[&group, inputs.media.group(&key.medium)], key.voxels, stamps);
        Openness { volume }
    }
}
