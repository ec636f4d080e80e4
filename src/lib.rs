//! Clouds from ellipsoids, fractal noise and Mie scattering, on the GPU.
//!
//! An artist describes a [`scene::Scene`]: ellipsoids, droplets, sun, sky, camera, as a
//! JSON file or in code. [`render::Frame`] is one moment of it as the GPU takes it, and
//! [`render::Renderer`] draws frames into the caller's texture, respecting the caller's
//! depth. A game's camera comes as matrices: [`render::Frame::seen_through`]. [`export`] writes PNG and EXR. [`editor`] is the window in which scenes are made.
//!
//! ```no_run
//! use nephos::{gpu::Gpu, render::{Frame, Renderer, Target}, scene::Preset};
//!
//! # fn main() -> nephos::Result<()> {
//! let gpu = pollster::block_on(Gpu::open(None))?;
//! let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
//! let frame = Frame::new(&Preset::Congestus.scene(7), [960, 540])?;
//! let picture = renderer.picture("clouds", frame.size(), wgpu::TextureFormat::Rgba16Float);
//! let view = picture.create_view(&Default::default());
//! let mut encoder = gpu.device.create_command_encoder(&Default::default());
//! renderer.render(&mut encoder, &frame, &Target { color: &view, depth: None, sky: true });
//! gpu.queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```
//!
//! # The way of the data
//!
//! ```text
//! Scene ──> Frame ──> media ──────────────┐   (once a shape)
//!                 ──> sky tables ─────────┤   (when air, sun or camera changed)
//!                 ──> light in each cloud ┤   (when sun, shape or noise changed)
//!                                         └─> sky ──> march ──> compose
//! ```
//!
//! Each pass knows what it depends on and does nothing when that has not changed.
//!
//! | module | what is in it |
//! | --- | --- |
//! | [`scene`] | what an artist describes: plain, validated data, presets, timeline |
//! | [`frame`] | one moment of it as the GPU takes it: what is there |
//! | [`render`] | the real-time renderer: what light that receives, what is seen of it |
//! | [`mod@reference`] | the path tracer over the same density: truth |
//! | [`optics`], [`tables`] | what droplets do with light, in double precision, and what was made of it |
//! | [`gpu`] | device, linking of shaders, textures, read-back |
//! | `export`, `import`, `measure` | with features of these names: files for others, of others, errors against truth |
//! | `cli`, `editor` | with features of these names: the program and its window |
//!
//! Shaders are linked from modules in `shaders/lib`, pure functions, and from modules that fill a role:
//! what is there (`shaders/medium`), what light it receives (`shaders/light`). ARCHITECTURE.md tells the
//! seams, and where to go to add a model of light, a medium, a species, an export or a pass.
//!
//! # Conventions
//!
//! Metres, Y up, right-handed, north is -Z. Directions point away from the shaded point
//! (`to_sun`). Light is linear RGB in units of the sun's irradiance above the atmosphere,
//! which is 1 unless a scene says otherwise; times 128 000 lux it is photometric (afterwards:
//! half floats end at 65504, and what is brighter is cut there). Phase functions integrate to 1 over the sphere. Angles are radians inside, degrees in files.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(any(feature = "cli", feature = "editor"))]
mod desk;
#[cfg(feature = "editor")]
pub mod editor;
mod error;
#[cfg(feature = "export")]
pub mod export;
mod files;
pub mod frame;
pub mod gpu;
#[cfg(feature = "import")]
pub mod import;
#[cfg(feature = "measure")]
pub mod measure;
mod numbered;
pub mod optics;
pub mod reference;
pub mod render;
pub mod scene;
mod srgb;
pub mod tables;
#[cfg(any(feature = "export", feature = "import"))]
mod vdb;

#[cfg(test)]
mod layouts;

pub use error::{Error, Result};
