//! What the picture of the ground is made of beyond the table of the sky, made when a scene first has such ground.

use std::sync::Arc;

use wgpu::{TextureUsages, TextureView};

use super::{
    land, smooth,
    tables::{Fill, SKY_VIEW, Tables, fill_sky_view, table},
};
use crate::{
    frame::{AtmosphereUniform, CameraUniform, GroundSettings, GroundShader, PATTERN_SCALE, SkySettings},
    gpu::{self, Made, TextureDesc, Timing, view},
    scene::{Camera, GroundColors},
    srgb,
};

/// Of what is kept in layers.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Ground that is more than even.
#[derive(Default)]
pub(super) struct GroundPass {
    current: Option<(GroundSettings, wgpu::Buffer)>,
    land: Option<Sampled>,
    water: Option<LowSky>,
    picture: Option<(Arc<GroundColors>, Sampled)>,
    /// What was last bound to draw it, and with which pipeline.
    bound: Option<(wgpu::RenderPipeline, wgpu::BindGroup)>,
}

/// A texture and how it is read.
struct Sampled {
    texture: TextureView,
    sampler: wgpu::Sampler,
}

/// The sky as it is seen from the ground.
struct LowSky {
    table: Sampled,
    fill: Fill,
    /// What it was made of: the air and the height of the sun.
    made: Option<(AtmosphereUniform, f32)>,
}

impl GroundPass {
    /// Brings what this ground reads up to date.
    pub fn prepare(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        (ground, sky): (&GroundSettings, &SkySettings),
        (tables, uniform, linear): (&Tables, &wgpu::Buffer, &wgpu::Sampler),
        timing: Option<&Timing>,
    ) {
        self.write(device, queue, ground);
        match ground.shader {
            GroundShader::Even => {}
            GroundShader::Land => {
                self.land.get_or_insert_with(|| pattern(device, queue));
            }
            GroundShader::Picture => {
                let known = self.picture.as_ref().map(|(colors, _)| colors);
                if let Some(colors) = ground.colors.as_ref().filter(|colors| known != Some(*colors)) {
                    self.picture = Some((colors.clone(), picture(device, queue, colors)));
                    self.bound = None;
                }
            }
            GroundShader::Water => {
                let low = self.water.get_or_insert_with(|| LowSky::new(device, tables, uniform, linear));
                let wanted = Some((sky.uniform.atmosphere, sky.uniform.to_sun.y));
                if low.made != wanted {
                    low.fill.run(encoder, timing);
                    low.made = wanted;
                }
            }
        }
    }

    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, ground: &GroundSettings) {
        match &mut self.current {
            Some((known, _)) if known == ground => {}
            Some((known, buffer)) => {
                Made::one(|made| &mut made.writes);
                queue.write_buffer(buffer, 0, bytemuck::bytes_of(&ground.uniform));
                *known = ground.clone();
            }
            None => {
                self.current = Some((ground.clone(), gpu::uniform_buffer(device, "ground", &ground.uniform)));
            }
        }
    }

    /// Ground as it is even.
    pub fn none(&mut self) {
        (self.current, self.bound) = (None, None);
    }

    /// Which shader draws it.
    pub fn shader(&self) -> GroundShader {
        self.current.as_ref().map_or(GroundShader::Even, |(ground, _)| ground.shader)
    }

    /// What that binds, made anew for another pipeline only: each is of one kind of ground. `None` for even ground.
    pub fn bind(
        &mut self,
        device: &wgpu::Device,
        pipeline: &wgpu::RenderPipeline,
    ) -> Option<wgpu::BindGroup> {
        if let Some((_, group)) = self.bound.as_ref().filter(|(bound, _)| bound == pipeline) {
            return Some(group.clone());
        }
        let resources = self.resources()?.map(Some);
        let group = gpu::bind_group(device, "ground", &pipeline.get_bind_group_layout(1), &resources);
        self.bound = Some((pipeline.clone(), group.clone()));
        Some(group)
    }

    fn resources(&self) -> Option<[wgpu::BindingResource<'_>; 3]> {
        let (ground, buffer) = self.current.as_ref()?;
        let read = match ground.shader {
            GroundShader::Even => None,
            GroundShader::Land => self.land.as_ref(),
            GroundShader::Water => self.water.as_ref().map(|low| &low.table),
            GroundShader::Picture => self.picture.as_ref().map(|(_, sampled)| sampled),
        }?;
        Some([
            buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(&read.texture),
            wgpu::BindingResource::Sampler(&read.sampler),
        ])
    }
}

impl LowSky {
    fn new(device: &wgpu::Device, tables: &Tables, sky: &wgpu::Buffer, linear: &wgpu::Sampler) -> Self {
        let texture = view(&table(device, "sky over water", SKY_VIEW));
        // Of a camera the table takes no more than the height.
        let mut camera = CameraUniform::new(&Camera::default(), 0.0, [1; 2]);
        camera.altitude = 0.0;
        let camera = gpu::uniform_buffer(device, "camera on water", &camera);
        let fill = fill_sky_view(device, [sky, &camera], tables.air(), linear, &texture);
        Self { table: Sampled { texture, sampler: linear.clone() }, fill, made: None }
    }
}

/// The pattern of land.
fn pattern(device: &wgpu::Device, queue: &wgpu::Queue) -> Sampled {
    let byte = |x: f32| (255.0 * (x / PATTERN_SCALE).clamp(0.0, 1.0)).round() as u8;
    let sampler = gpu::linear_repeat_layers(device);
    let size = [land::EDGE, land::EDGE];
    Sampled { texture: layered(device, queue, size, FORMAT, &land::TEXELS, byte), sampler }
}

/// A picture from above.
fn picture(device: &wgpu::Device, queue: &wgpu::Queue, colors: &GroundColors) -> Sampled {
    let layers = smooth::layers(colors.linear(), colors.size(), |x, edge| x.clamp(0, edge - 1));
    let format = FORMAT.add_srgb_suffix();
    let texture = layered(device, queue, colors.size(), format, &layers, srgb::byte);
    Sampled { texture, sampler: gpu::linear_clamp(device) }
}

/// Uploads all layers as one volume.
fn layered(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    size: [usize; 2],
    format: wgpu::TextureFormat,
    texels: &[[f32; 3]],
    byte: impl Fn(f32) -> u8,
) -> TextureView {
    let [width, height] = size.map(|edge| edge as u32);
    let size = [width, height, smooth::LAYERS as u32];
    let desc = TextureDesc { label: "ground", size, mips: 1, format, usage: TextureUsages::empty() };
    let texture = gpu::texture(device, &desc);
    let bytes: Vec<[u8; 4]> = texels.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: Some(height),
    };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&bytes), layout, texture.size());
    view(&texture)
}
