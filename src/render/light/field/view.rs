//! Solved light as the eye sees it.

use glam::{DVec3, Vec4};
use wgpu::TextureView;

use super::{
    Lights,
    levels::{Level, cells, scratch},
};
use crate::{
    frame::CameraUniform,
    gpu::{self, ComputeProgram},
    render::light::sun::volume,
};

/// Where a cloud at `origin` is looked at from, as `lib/field_view.wgsl` takes it: the eye's place in the
/// cloud's frame, m, and 1, or the direction of all light that it gets, and 0.
pub(in crate::render::light) fn eye_of(camera: &CameraUniform, position: DVec3, origin: DVec3) -> Vec4 {
    if camera.projection == CameraUniform::ORTHOGRAPHIC {
        (-camera.forward).extend(0.0)
    } else {
        (position - origin).as_vec3().extend(1.0)
    }
}

/// The solution for one light, or for red, green and blue.
pub(in crate::render::light) struct SolvedLight {
    lights: Lights,
    cells: u32,
    field: wgpu::Buffer,
    /// Moments of degree 0 to 3 of what each cell scatters, half floats, by light and cell.
    pub(super) kept: wgpu::Buffer,
    /// What goes to the eye: of the sun to first order in the direction, or red, green and blue.
    pub view: TextureView,
    /// Which eye that is.
    eye: Option<Vec4>,
}

impl SolvedLight {
    /// Room for the solution on a level.
    pub(super) fn new(device: &wgpu::Device, level: &Level, lights: Lights) -> Self {
        let cells = cells(&level.uniform);
        let texture = volume(device, "solved light", level.uniform.size.to_array());
        Self {
            lights,
            cells,
            field: level.buffer.clone(),
            kept: scratch(device, "solved moments", u64::from(cells * lights.count()) * 32),
            view: gpu::view(&texture),
            eye: None,
        }
    }

    /// Memory that it takes, bytes.
    pub fn bytes(&self) -> u64 {
        self.kept.size() + 8 * u64::from(self.cells)
    }

    pub(super) fn seen_from(
        &mut self,
        programs: &[ComputeProgram; 2],
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        eye: Vec4,
    ) {
        if self.eye == Some(eye) {
            return;
        }
        self.eye = Some(eye);
        let program = &programs[usize::from(self.lights == Lights::Sun)];
        let eye = gpu::uniform_buffer(device, "eye", &eye);
        let group = program.bind(
            device,
            &[
                Some(self.field.as_entire_binding()),
                Some(eye.as_entire_binding()),
                Some(self.kept.as_entire_binding()),
                Some(wgpu::BindingResource::TextureView(&self.view)),
            ],
        );
        program.dispatch_over(encoder, &[&group], [self.cells, 1, 1], None);
    }
}
