//! Shaders compiled: modules, compute programs and pipelines over all of a target.

use std::borrow::Cow;

use super::{
    group::{bind_group, layouts},
    link::{Role, entry_point},
    made::Made,
};

/// A shader with its roles filled, and the layouts of its bind groups.
pub(crate) struct Shader {
    pub module: wgpu::ShaderModule,
    /// None where it declares nothing.
    pub groups: Vec<Option<wgpu::BindGroupLayout>>,
    pub layout: wgpu::PipelineLayout,
    /// Names of its overrides.
    overrides: Vec<String>,
}

impl Shader {
    /// The entry point called `name`.
    pub fn new(device: &wgpu::Device, name: &str, roles: &[Role<'_>]) -> Self {
        Self::from_text(device, name, entry_point(name, roles))
    }

    fn from_text(device: &wgpu::Device, name: &str, linked: String) -> Self {
        let linked = adapted(device, linked);
        let groups = layouts(device, name, &linked);
        let layouts: Vec<_> = groups.iter().map(Option::as_ref).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let overrides = linked.lines().filter_map(|line| line.strip_prefix("override "));
        let overrides = overrides.filter_map(|rest| Some(rest.split_once(':')?.0.to_owned())).collect();
        Self { module: module(device, name, linked), groups, layout, overrides }
    }

    /// Of `all`, the overrides that this shader has: a value for another one would be an error.
    pub fn known<'a>(&self, all: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
        all.iter().filter(|(name, _)| self.overrides.iter().any(|known| known == name)).copied().collect()
    }
}

/// Linked WGSL as this device takes it best.
fn adapted(device: &wgpu::Device, linked: String) -> String {
    if has_slow_uniforms(device) { linked.replace("var<uniform>", "var<storage, read>") } else { linked }
}

fn module(device: &wgpu::Device, name: &str, linked: String) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(Cow::Owned(linked));
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
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
pub(crate) fn workgroup_size(linked: &str) -> [u32; 3] {
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

/// A compute shader.
pub struct ComputeProgram {
    pipeline: wgpu::ComputePipeline,
    name: &'static str,
    workgroup_size: [u32; 3],
}

impl ComputeProgram {
    /// Compiles entry function `main` of the shader called `name`, with its overrides.
    pub fn new(device: &wgpu::Device, name: &'static str, overrides: &[(&str, f64)]) -> Self {
        Self::with_roles(device, name, &[], overrides)
    }

    /// The same of a shader that has roles.
    pub fn with_roles(
        device: &wgpu::Device,
        name: &'static str,
        roles: &[Role<'_>],
        overrides: &[(&str, f64)],
    ) -> Self {
        let linked = entry_point(name, roles);
        let workgroup_size = workgroup_size(&linked);
        let Shader { module, layout, .. } = Shader::from_text(device, name, linked);
        let pipeline = compute_pipeline(device, name, &module, Some(&layout), overrides);
        Self { pipeline, name, workgroup_size }
    }

    /// The same from linked text that is not in [`super::ENTRY_POINTS`]: for tests of single functions,
    /// which bind only what those use.
    pub fn from_source(device: &wgpu::Device, name: &'static str, linked: String) -> Self {
        let workgroup_size = workgroup_size(&linked);
        let module = module(device, name, adapted(device, linked));
        Self { pipeline: compute_pipeline(device, name, &module, None, &[]), name, workgroup_size }
    }

    /// Workgroups that have at least so many threads along each axis.
    pub fn groups_over(&self, threads: [u32; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| threads[axis].div_ceil(self.workgroup_size[axis]))
    }

    /// Records a dispatch of at least so many threads along each axis into a pass that is open:
    /// dispatches of one pass follow one another, each seeing what those before it wrote. `groups` are
    /// the program's bind groups from 0 on.
    pub fn record_over(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        groups: &[&wgpu::BindGroup],
        threads: [u32; 3],
    ) {
        self.record(pass, groups, self.groups_over(threads));
    }

    /// The same of a program with one group, in which what moves is at `offset`, bytes.
    pub fn record_over_at(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        (group, offset): (&wgpu::BindGroup, u32),
        threads: [u32; 3],
    ) {
        let [x, y, z] = self.groups_over(threads);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[offset]);
        pass.dispatch_workgroups(x, y, z);
    }

    /// The same of `size` workgroups.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &[&wgpu::BindGroup], size: [u32; 3]) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in (0..).zip(groups) {
            pass.set_bind_group(index, *group, &[]);
        }
        pass.dispatch_workgroups(size[0], size[1], size[2]);
    }

    /// The layout of bind group `group`.
    pub fn layout(&self, group: u32) -> wgpu::BindGroupLayout {
        self.pipeline.get_bind_group_layout(group)
    }

    /// A bind group for this program's group 0: entry `i` goes to binding `i`.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        resources: &[Option<wgpu::BindingResource<'_>>],
    ) -> wgpu::BindGroup {
        bind_group(device, self.name, &self.layout(0), resources)
    }

    /// Records a pass of at least so many threads along each axis.
    pub fn dispatch_over(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        groups: &[&wgpu::BindGroup],
        threads: [u32; 3],
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        self.dispatch(encoder, groups, self.groups_over(threads), timestamps);
    }

    /// Records a pass of `size` workgroups.
    pub fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        groups: &[&wgpu::BindGroup],
        size: [u32; 3],
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.name),
            timestamp_writes: timestamps,
        });
        self.record(&mut pass, groups, size);
    }
}

fn compute_pipeline(
    device: &wgpu::Device,
    name: &str,
    module: &wgpu::ShaderModule,
    layout: Option<&wgpu::PipelineLayout>,
    overrides: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    Made::one(|made| &mut made.pipelines);
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout,
        module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions { constants: overrides, ..Default::default() },
        cache: None,
    })
}

/// What a pipeline draws with: strips of triangles without buffers of vertices.
pub(crate) struct Strips<'a> {
    pub label: &'a str,
    /// Functions of the vertex and of the fragment stage.
    pub entries: [&'a str; 2],
    pub overrides: &'a [(&'a str, f64)],
    pub targets: &'a [Option<wgpu::ColorTargetState>],
}

/// The pipeline of a shader that draws so.
pub(crate) fn strip_pipeline(
    device: &wgpu::Device,
    shader: &Shader,
    strips: &Strips<'_>,
) -> wgpu::RenderPipeline {
    Made::one(|made| &mut made.pipelines);
    let options = || wgpu::PipelineCompilationOptions { constants: strips.overrides, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(strips.label),
        layout: Some(&shader.layout),
        vertex: wgpu::VertexState {
            module: &shader.module,
            entry_point: Some(strips.entries[0]),
            compilation_options: options(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader.module,
            entry_point: Some(strips.entries[1]),
            compilation_options: options(),
            targets: strips.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Light on top of what is there, whose alpha stays.
pub(crate) const ADDS: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

/// The pipeline of the shader called `name` whose functions `vertex` and `fragment` draw one
/// triangle over all of a target: a format alone for one without blending.
pub(crate) fn screen_pipeline(
    device: &wgpu::Device,
    (name, roles): (&str, &[Role<'_>]),
    overrides: &[(&str, f64)],
    target: impl Into<wgpu::ColorTargetState>,
) -> wgpu::RenderPipeline {
    let targets = &[Some(target.into())];
    let strips = Strips { label: name, entries: ["vertex", "fragment"], overrides, targets };
    strip_pipeline(device, &Shader::new(device, name, roles), &strips)
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
