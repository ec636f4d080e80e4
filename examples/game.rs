//! How a game draws clouds into its own frame: its own device, its own linear colour and
//! depth textures, its own geometry first; then the sky and the clouds, cut off where the
//! geometry is. Here the geometry is one tall tower drawn by a shader of ten lines, and
//! there is no window: the frame is written to `game.png`.
//!
//!     cargo run --release --example game

use std::path::Path;

use nephos::{
    Result, export,
    gpu::{self, Gpu},
    render::{Frame, Quality, Renderer, SceneDepth, Target},
    scene::{Preset, Scene},
};

const SIZE: [u32; 2] = [960, 540];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const NEAR: f32 = 1.0;

/// A tower that fills a strip of the picture, 700 m away. Reversed depth with an infinite
/// far plane: depth = near / distance.
const TOWER: &str = "
    @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        let x = select(0.02, 0.14, (i & 1u) == 1u);
        let y = select(-1.0, 0.5, i > 1u);
        return vec4f(x, y, 1.0 / 700.0, 1.0);
    }
    @fragment fn fragment() -> @location(0) vec4f { return vec4f(0.02, 0.02, 0.025, 1.0); }";

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
    draw(&mut encoder, &tower, &color_view, &depth_view);
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
        source: wgpu::ShaderSource::Wgsl(TOWER.into()),
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

fn draw(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
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
    pass.draw(0..4, 0..1);
}
