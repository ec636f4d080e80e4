//! Solved light as the eye sees it.

use glam::{DVec3, Vec4};
use wgpu::TextureView;

use super::{
    Field, FieldPass, Lights,
    levels::{Level, cells, scratch},
};
use crate::{
    frame::CameraUniform,
    gpu::{self, ComputeProgram},
    render::light::{inputs::Inputs, sun::volume},
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

/// Texels of what is found on a level: one a cell, or for layers as `field_tile_place` of `lib/field.wgsl` has them.
fn texels(level: &Level, lights: Lights) -> [u32; 3] {
    let size = level.uniform.size;
    if level.uniform.repeats == 0 {
        return size.to_array();
    }
    let stacked = if lights == Lights::Sun { 4 } else { 3 };
    [size.x + 2, stacked * size.y, size.z + 2]
}

/// What is kept of a solution: the field's buffer, and moments of degree 0 to 3 of what each cell scatters, half floats,
/// by light and cell.
pub(super) struct Kept {
    pub field: wgpu::Buffer,
    pub moments: wgpu::Buffer,
}

impl Kept {
    /// Room for the solution on a level.
    pub fn new(device: &wgpu::Device, level: &Level, lights: Lights) -> Self {
        let size = u64::from(cells(&level.uniform) * lights.count()) * 32;
        Self { field: level.buffer.clone(), moments: scratch(device, "solved moments", size) }
    }
}

/// The solution for one light, or for red, green and blue.
pub(in crate::render::light) struct SolvedLight {
    lights: Lights,
    cells: u32,
    kept: Kept,
    /// What goes to the eye: of the sun to first order in the direction, or red, green and blue.
    pub view: TextureView,
    /// Which eye that is; none yet where that is to be found.
    eye: Option<Vec4>,
    /// What its pass binds, with the buffer of eyes that is in it.
    bound: Option<(wgpu::Buffer, wgpu::BindGroup)>,
}

impl SolvedLight {
    /// What was kept on a level, which no eye has seen yet.
    pub(super) fn new(device: &wgpu::Device, level: &Level, lights: Lights, kept: Kept) -> Self {
        let cells = cells(&level.uniform);
        let texture = volume(device, "solved light", texels(level, lights));
        Self { lights, cells, kept, view: gpu::view(&texture), eye: None, bound: None }
    }

    /// Memory that it takes, bytes.
    pub fn bytes(&self) -> u64 {
        self.kept.moments.size() + 8 * u64::from(self.cells)
    }

    /// Finds what goes to all eyes at once: copies of a layer's cells are seen from everywhere.
    pub(super) fn kept_for_all(
        &mut self,
        programs: &[ComputeProgram; 2],
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        if self.eye.replace(Vec4::ZERO).is_some() {
            return;
        }
        let program = &programs[usize::from(self.lights == Lights::Sun)];
        let buffers = [&self.kept.field, &self.kept.moments].map(|buffer| Some(buffer.as_entire_binding()));
        let view = wgpu::BindingResource::TextureView(&self.view);
        let group = program.bind(device, &[buffers.to_vec(), vec![Some(view)]].concat());
        program.dispatch_over(encoder, &[&group], [self.cells, 1, 1], None);
    }

    /// Whether what goes to `eye` is to be found; then it counts as found.
    fn has_moved(&mut self, eye: Vec4) -> bool {
        self.eye.replace(eye) != Some(eye)
    }

    /// Records the pass that finds what goes to the eye at `offset` in `eyes`.
    fn record(
        &mut self,
        programs: &[ComputeProgram; 2],
        device: &wgpu::Device,
        pass: &mut wgpu::ComputePass<'_>,
        (eyes, offset): (&wgpu::Buffer, u32),
    ) {
        let program = &programs[usize::from(self.lights == Lights::Sun)];
        let known = self.bound.take().filter(|(known, _)| known == eyes);
        let (_, group) = self.bound.insert(known.unwrap_or_else(|| {
            let resources = [
                Some(self.kept.field.as_entire_binding()),
                Some(gpu::one_of::<Vec4>(eyes)),
                Some(self.kept.moments.as_entire_binding()),
                Some(wgpu::BindingResource::TextureView(&self.view)),
            ];
            (eyes.clone(), program.bind(device, &resources))
        }));
        program.record_over_at(pass, (group, offset), [self.cells, 1, 1]);
    }
}

/// The eyes that clouds are seen from in a picture: one pass over all that have moved.
pub(in crate::render::light) struct Eyes(gpu::Shelf);

impl Default for Eyes {
    fn default() -> Self {
        Self(gpu::Shelf::of_places("eyes"))
    }
}

impl Eyes {
    /// Finds the light of `fields` that goes to their eyes ([`eye_of`]), where those have moved.
    pub fn see<'a>(
        &mut self,
        programs: &FieldPass,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs<'_>,
        fields: impl Iterator<Item = (&'a mut Field, Vec4)>,
    ) {
        let device = inputs.device;
        let (mut eyes, mut moved): (Vec<Vec4>, Vec<(usize, &mut SolvedLight)>) = Default::default();
        for (field, eye) in fields {
            let repeats = field.field_box.repeats;
            for light in [&mut field.sun].into_iter().chain(&mut field.sky) {
                if repeats {
                    light.kept_for_all(&programs.tile, device, encoder);
                } else if light.has_moved(eye) {
                    if eyes.last() != Some(&eye) {
                        eyes.push(eye);
                    }
                    moved.push((eyes.len() - 1, light));
                }
            }
        }
        if moved.is_empty() {
            return;
        }
        let buffer = self.0.fill(device, inputs.queue, &eyes);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("moments view"),
            timestamp_writes: inputs.timing.and_then(|timing| timing.compute("moments view")),
        });
        for (number, light) in moved {
            light.record(&programs.view, device, &mut pass, (buffer, gpu::Shelf::offset(number)));
        }
    }
}
