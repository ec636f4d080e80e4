//! How a game draws clouds into its own frame: its own device, its own linear colour and
//! depth textures, its own geometry first; then the sky and the clouds, cut off where the
//! geometry is. Here the geometry is one tall tower drawn by a shader of a few lines, which lies in
//! the shadows of the clouds, and there is no window: the frame is written to `game.png`.
//!
//!     cargo run --release --example game

use std::path::Path;

use glam::DVec3;
use nephos::{
    Result, export,
    gpu::{self, Gpu},
    render::{Frame, Quality, Renderer, SceneDepth, Target},
    scene::{Preset, Projection, Scene},
};

const SIZE: [u32; 2] = [960, 540];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const NEAR: f32 = 1.0;

/// A tower that fills a strip of the picture, 700 m away. Reversed depth with an infinite
/// far plane: depth = near / distance.
const TOWER: &str = "// @use sun_map
    struct Eye { right: vec4f, up: vec4f, forward: vec4f }
    @group(0) @binding(0) var<uniform> eye: Eye;
    @group(0) @binding(1) var<uniform> map: SunMap;
    @group(0) @binding(2) var lit: texture_2d_array<f32>;
    @group(0) @binding(3) var linear: sampler;

    struct Corner { @builtin(position) position: vec4f, @location(0) point: vec3f }
    @vertex fn vertex(@builtin(vertex_index) i: u32) -> Corner {
        let x = select(0.02, 0.14, (i & 1u) == 1u);
        let y = select(-1.0, 0.5, i > 1u);
        // In metres from the camera, as the map of the sun's light takes it.
        let point = 700.0 * (eye.forward + x * eye.right + y * eye.up).xyz;
        return Corner(vec4f(x, y, 1.0 / 700.0, 1.0), point);
    }
    @fragment fn fragment(corner: Corner) -> @location(0) vec4f {
        let sun = sun_map_light(map, lit, linear, corner.point);
        return vec4f(vec3f(0.02, 0.02, 0.025) + sun * vec3f(0.05, 0.045, 0.04), 1.0);
    }";

/// How the tower's shader sees the camera: half the picture's width and height, and ahead.
fn eye(scene: &Scene) -> [[f32; 4]; 3] {
    let camera = scene.camera();
    let half = match camera.projection {
        Projection::Perspective { vertical_fov_deg } => (0.5 * vertical_fov_deg.to_radians()).tan(),
        _ => unreachable!("the preset has a perspective camera"),
    };
    let wide = half * f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let axes = [wide * DVec3::X, half * DVec3::Y, DVec3::NEG_Z];
    axes.map(|axis| (camera.world_from_camera() * axis).as_vec3().extend(0.0).to_array())
}

fn main() -> Result<()> {
    // What a game has anyway.
    let gpu = pollster::block_on(Gpu::open(None))?;
    let (device, queue) = (&gpu.device, &gpu.queue);
    let tower = tower(device);

    // Once: a renderer, and a scene.
    let mut clouds = Renderer::new(device, queue, COLOR);
    clouds.settings.quality = Quality::PREVIEW;
    let scene: Scene = Preset::Humilis.scene(4);

    // Each frame: a moment of the scene for this picture, ...
    let frame = Frame::new(&scene, SIZE)?;
    let [color, depth, finished] =
        [COLOR, DEPTH, wgpu::TextureFormat::Rgba8Unorm].map(|format| clouds.picture("frame", SIZE, format));
    let [color_view, depth_view, finished_view] =
        [&color, &depth, &finished].map(|texture| texture.create_view(&Default::default()));
    let mut encoder = device.create_command_encoder(&Default::default());

    // ... the sky, ...
    clouds.render_sky(&mut encoder, &frame, &color_view);
    // ... the game's own geometry, ...
    let map = clouds.sun_map().expect("the preset has clouds, air and a sun");
    let eye = gpu::uniform_buffer(device, "eye", &eye(&scene));
    let linear = gpu::linear_clamp(device);
    let resources = [
        eye.as_entire_binding(),
        map.uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(map.lit),
        wgpu::BindingResource::Sampler(&linear),
    ];
    draw(&mut encoder, &tower, &bind(device, &tower, resources), &color_view, &depth_view);
    // ... the clouds, cut off by its depth, and the tone curve.
    let scene_depth = SceneDepth { view: &depth_view, near: NEAR, far: f32::INFINITY, reversed: true };
    let target = Target { color: &color_view, depth: Some(scene_depth), sky: false };
    clouds.render(&mut encoder, &frame, &target);
    clouds.compose(&mut encoder, &color_view, &finished_view, finished.format(), scene.tone());
    queue.submit([encoder.finish()]);
    gpu.finish("drawing the frame")?;

    let bytes = gpu::read_texture(&gpu, &finished, 0)?;
    export::write_png(Path::new("game.png"), SIZE, &bytes, false)
}

fn tower(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("tower"),
        source: wgpu::ShaderSource::Wgsl(gpu::link(TOWER, &[]).into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("tower"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(COLOR.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn bind(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    resources: [wgpu::BindingResource<'_>; 4],
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    let layout = &pipeline.get_bind_group_layout(0);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("tower"), layout, entries: &entries })
}

fn draw(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("tower"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..4, 0..1);
}
