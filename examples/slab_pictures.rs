//! Clouds 225, 500 and 900 m thick in a high sun, from its side and from below: the picture
//! of `tables/README.md`.
//!
//! `cargo run --release --example slab_pictures -- tables/plots/thickness.png`

use std::path::PathBuf;

use glam::DVec3;
use nephos::{
    Result,
    export::write_png,
    gpu::Gpu,
    render::{Film, Renderer},
    scene::{Camera, Cloud, Edge, Ellipsoid, Projection, Scene, Sun, SunPosition},
};

const SIZE: [u32; 2] = [320, 180];

fn main() -> Result<()> {
    let output = std::env::args().nth(1).unwrap_or_else(|| "thickness.png".to_owned());
    let gpu = pollster::block_on(Gpu::open(None))?;
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
    let [width, height] = SIZE.map(|n| n as usize);
    let mut sheet = vec![0; 3 * width * 2 * height * 4];
    for (column, thickness) in [225.0, 500.0, 900.0].into_iter().enumerate() {
        for (row, above) in [true, false].into_iter().enumerate() {
            let picture = draw(&gpu, &mut renderer, &scene(thickness, above))?;
            for (y, line) in picture.chunks_exact(4 * width).enumerate() {
                let at = ((row * height + y) * 3 + column) * 4 * width;
                sheet[at..at + 4 * width].copy_from_slice(line);
            }
        }
    }
    write_png(&PathBuf::from(output), [3 * SIZE[0], 2 * SIZE[1]], &sheet, false)
}

/// A heap of the thickness, m, seen from the sun's side or from below.
fn scene(thickness: f64, above: bool) -> Scene {
    let base = 1000.0;
    let lump = |x: f64, z: f64, share: f64| {
        let half = 0.5 * share * thickness;
        Ellipsoid::new(
            DVec3::new(x * thickness, base + half, z * thickness),
            DVec3::new(1.2 * half, half, 1.2 * half),
        )
    };
    let ellipsoids = vec![
        lump(0.0, 0.0, 1.0),
        lump(0.55, 0.1, 0.85),
        lump(-0.5, 0.2, 0.8),
        lump(0.1, -0.55, 0.8),
        lump(-0.1, 0.55, 0.75),
        lump(0.9, -0.1, 0.55),
        lump(-0.9, -0.1, 0.5),
    ];
    let eye = DVec3::new(0.0, if above { 1.6 } else { -2.2 }, if above { 2.6 } else { 2.0 });
    let middle = DVec3::new(0.0, base + 0.5 * thickness, 0.0);
    Scene {
        clouds: vec![Cloud { ellipsoids, edge: Edge { boundary: 60.0, wispiness: 0.2 }, ..Cloud::default() }],
        sun: Sun {
            position: SunPosition::Angles { azimuth_deg: 180.0, elevation_deg: 60.0 },
            ..Sun::default()
        },
        camera: Some(Camera {
            position: middle + thickness * eye,
            target: middle,
            roll_deg: 0.0,
            projection: Projection::Perspective { vertical_fov_deg: 36.0 },
            ..Camera::default()
        }),
        ..Scene::default()
    }
}

/// The finished picture at twice its size each way, averaged: RGBA of 8 bits.
fn draw(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene) -> Result<Vec<u8>> {
    let film = Film::new(SIZE, 2);
    let picture = film.take(gpu, renderer, &film.frame(scene)?, true, &mut |_| ())?;
    picture.finished(gpu, renderer, scene.tone())
}
