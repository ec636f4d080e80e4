//! Linking WGSL: an entry point names the library modules it uses in header
//! comments (`// @use density phase`), each module likewise; whole modules are
//! concatenated once, dependencies first. Names are unique across the library,
//! so nothing is renamed, and a line number in a driver's message can be found.

use std::borrow::Cow;

macro_rules! sources {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $folder, $name, ".wgsl")))),*]
    };
}

/// Every module of `shaders/lib`: name and source.
pub const LIBRARY: &[(&str, &str)] = sources!("lib/":
    "air", "atmosphere", "attenuation", "camera", "constants", "density", "eddington", "ellipsoid", "field", "harmonics", "light_box", "noise", "octaves", "path_random", "phase", "random", "slab", "slab_direct", "slab_fit", "slab_functions", "slab_view", "tonemap",
);

/// Every entry point of `shaders`: name and source.
pub const ENTRY_POINTS: &[(&str, &str)] = sources!("":
    "aerial", "clouds", "compose", "ground_light", "mips", "moments_entering", "moments_medium", "moments_scatter", "moments_store", "moments_sweep", "multiple_scattering", "sky", "sky_light", "sky_view",
    "path", "resolve", "sky_volume", "sun_maps", "sun_normals", "transmittance", "voxels",
);

/// The whole source of an entry point, or of any text with `// @use` lines.
///
/// # Panics
/// Where a module that the text uses does not exist: a mistake in the shaders
/// themselves, which a test finds for every entry point.
pub fn link(source: &str) -> String {
    let mut done = Vec::new();
    let mut linked = String::new();
    append(source, &mut done, &mut linked);
    linked
}

fn append<'a>(source: &'a str, done: &mut Vec<&'a str>, linked: &mut String) {
    for name in
        source.lines().filter_map(|line| line.strip_prefix("// @use ")).flat_map(str::split_whitespace)
    {
        if !done.contains(&name) {
            done.push(name);
            append(module(name), done, linked);
        }
    }
    linked.push_str(source);
    linked.push('\n');
}

fn module(name: &str) -> &'static str {
    let found = LIBRARY.iter().find(|(known, _)| *known == name);
    found.map(|(_, source)| *source).unwrap_or_else(|| panic!("no shader module `{name}` in shaders/lib"))
}

/// Parses and validates linked WGSL, without a device. Not in a browser, which does so itself.
///
/// # Errors
/// The parser's or validator's message, with the place in the linked text.
#[cfg(not(target_arch = "wasm32"))]
pub fn validate(linked: &str) -> Result<wgpu::naga::Module, String> {
    use wgpu::naga::{front::wgsl, valid};
    let module = wgsl::parse_str(linked).map_err(|error| error.emit_to_string(linked))?;
    valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(linked))?;
    Ok(module)
}

pub(crate) fn entry_point(name: &str) -> String {
    let found = ENTRY_POINTS.iter().find(|(known, _)| *known == name);
    link(found.map(|(_, source)| *source).unwrap_or_else(|| panic!("no shader `{name}` in shaders")))
}

pub(crate) fn shader_module(device: &wgpu::Device, name: &str) -> wgpu::ShaderModule {
    compile(device, name, entry_point(name))
}

fn compile(device: &wgpu::Device, name: &str, mut linked: String) -> wgpu::ShaderModule {
    if has_slow_uniforms(device) {
        linked = linked.replace("var<uniform>", "var<storage, read>");
    }
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(Cow::Owned(linked)),
    })
}

/// Whether the driver compiles a shader again for every uniform buffer that it is given: Mesa's
/// llvmpipe writes the values that loops and branches ask for into the program, some 10 ms for each
/// draw and dispatch, and keeps all of those programs. Values in storage buffers it leaves alone.
/// [`MOST_BUFFERS`] are needed for that.
fn has_slow_uniforms(device: &wgpu::Device) -> bool {
    device.adapter_info().device_type == wgpu::DeviceType::Cpu
        && device.limits().max_storage_buffers_per_shader_stage >= MOST_BUFFERS
}

/// Buffers of any kind that one stage of a shader may have: as many as `path.wgsl` has, 8 of storage and
/// 4 that are uniform.
pub(super) const MOST_BUFFERS: u32 = 12;

/// Threads of a workgroup of linked WGSL along each axis, by its `@workgroup_size`: numbers, constants, and
/// products of them. It is read from the text, for there is no naga in a browser; a test holds it against
/// naga's for every shader.
fn workgroup_size(linked: &str) -> [u32; 3] {
    fn value(linked: &str, text: &str) -> u32 {
        let factor = |text: &str| match text.trim().trim_end_matches('u').parse() {
            Ok(number) => number,
            Err(_) => {
                let begin = format!("const {}: u32 = ", text.trim());
                value(
                    linked,
                    linked.split_once(&begin).and_then(|(_, rest)| rest.split(';').next()).unwrap_or("1"),
                )
            }
        };
        text.split('*').map(factor).product()
    }
    let mut size = [1; 3];
    let sizes = linked.split_once("@workgroup_size(").and_then(|(_, rest)| rest.split(')').next());
    for (axis, text) in size.iter_mut().zip(sizes.unwrap_or("1").split(',')) {
        *axis = value(linked, text);
    }
    size
}

/// A compute shader with one bind group.
pub struct ComputeProgram {
    pipeline: wgpu::ComputePipeline,
    name: &'static str,
    workgroup_size: [u32; 3],
}

impl ComputeProgram {
    /// Compiles entry function `main` of the shader called `name`, with its overrides.
    pub fn new(device: &wgpu::Device, name: &'static str, overrides: &[(&str, f64)]) -> Self {
        Self::from_linked(device, name, entry_point(name), overrides)
    }

    /// The same from text that is not in [`ENTRY_POINTS`]: for tests of single functions.
    pub fn from_source(device: &wgpu::Device, name: &'static str, source: &str) -> Self {
        Self::from_linked(device, name, link(source), &[])
    }

    fn from_linked(
        device: &wgpu::Device,
        name: &'static str,
        linked: String,
        overrides: &[(&str, f64)],
    ) -> Self {
        let workgroup_size = workgroup_size(&linked);
        let module = &compile(device, name, linked);
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: overrides,
                ..Default::default()
            },
            cache: None,
        });
        Self { pipeline, name, workgroup_size }
    }

    /// Workgroups that have at least so many threads along each axis.
    pub fn groups_over(&self, threads: [u32; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| threads[axis].div_ceil(self.workgroup_size[axis]))
    }

    /// Records a dispatch into a pass that is open: dispatches of one pass follow one another,
    /// each seeing what those before it wrote.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, group: &wgpu::BindGroup, groups: [u32; 3]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
    }

    /// A bind group for this program's group 0: entry `i` goes to binding `i`.
    /// Bindings that the shader does not use are left out with `None`.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        resources: &[Option<wgpu::BindingResource<'_>>],
    ) -> wgpu::BindGroup {
        bind_group(device, self.name, &self.pipeline.get_bind_group_layout(0), resources)
    }

    /// Records a dispatch of at least so many threads along each axis.
    pub fn dispatch_over(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        group: &wgpu::BindGroup,
        threads: [u32; 3],
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        self.dispatch(encoder, group, self.groups_over(threads), timestamps);
    }

    /// Records a dispatch of `groups` workgroups.
    pub fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        group: &wgpu::BindGroup,
        groups: [u32; 3],
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.name),
            timestamp_writes: timestamps,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
    }
}

/// A bind group whose entry `i` goes to binding `i`.
pub(crate) fn bind_group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[Option<wgpu::BindingResource<'_>>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .filter_map(|(binding, resource)| {
            Some(wgpu::BindGroupEntry { binding: binding as u32, resource: resource.clone()? })
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// The pipeline of the shader called `name` whose functions `vertex` and `fragment` draw one
/// triangle over all of a target, without blending.
pub(crate) fn screen_pipeline(
    device: &wgpu::Device,
    name: &str,
    overrides: &[(&str, f64)],
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = shader_module(device, name);
    let options = || wgpu::PipelineCompilationOptions { constants: overrides, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: options(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: options(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Records the pass of such a pipeline over all of `target`, which it clears first.
pub(crate) fn draw_screen(
    encoder: &mut wgpu::CommandEncoder,
    name: &str,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    target: &wgpu::TextureView,
) {
    let ops =
        wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    let attachment =
        wgpu::RenderPassColorAttachment { view: target, depth_slice: None, resolve_target: None, ops };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &[Some(attachment)],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workgroup_sizes_are_those_that_naga_reads() {
        let mut compute = 0;
        for (name, _) in ENTRY_POINTS {
            let linked = entry_point(name);
            for point in validate(&linked).unwrap().entry_points {
                if point.stage == wgpu::naga::ShaderStage::Compute {
                    assert_eq!(workgroup_size(&linked), point.workgroup_size, "{name}");
                    compute += 1;
                }
            }
        }
        assert!(compute > 10, "{compute}");
    }
}
