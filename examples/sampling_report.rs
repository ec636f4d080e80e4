//! The report on sampling: `cargo run --release --example sampling_report` prints the numbers of
//! `docs/sampling.md` and draws its plot.
#![allow(clippy::print_stdout, reason = "a report is for reading")]

use std::error::Error;
use std::path::Path;

use nephos::export::Picture;
use nephos::gpu::Gpu;
use nephos::render::{Counts, Film, Quality, Renderer, Transport};
use nephos::scene::{Preset, Projection, Scene};
use plotters::prelude::*;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

const SIZE: [u32; 2] = [96, 54];
/// Part of the preset's picture, across: pixels of a picture four times as wide.
const ZOOM: f64 = 4.0;

const SCENES: [Preset; 5] =
    [Preset::Humilis, Preset::Mediocris, Preset::Fractus, Preset::Congestus, Preset::Kol];

/// Lengths of all steps, over those of a quality.
const LENGTHS: [f32; 4] = [0.5, 0.7, 1.0, 1.5];

/// Density evaluations a ray that hits, and error, of the march before pieces were lit by their
/// ends: draft, preview, final; then with about five samples an ellipsoid, as Kol has it.
const BEFORE: [(f64, f64); 3] = [(20.8, 8.94), (43.7, 2.83), (125.5, 0.92)];
const FIVE: (f64, f64) = (13.4, 10.56);

fn main() -> Outcome {
    let gpu = pollster::block_on(Gpu::open(None))?;
    let scenes = SCENES
        .map(|preset| {
            let scene = scene(preset);
            let (reference, _) = draw(&gpu, &scene, CONVERGED)?;
            Ok((scene, reference))
        })
        .into_iter()
        .collect::<Outcome<Vec<_>>>()?;
    println!("| quality | steps | error | after a 3x3 blur | opacity | density | noise | maps |");
    let mut curves = Vec::new();
    for (name, quality) in Quality::PRESETS {
        let mut curve = Vec::new();
        for length in LENGTHS {
            let row = measure(&gpu, &scenes, scaled(quality, length))?;
            let [error, blurred, opacity, density, noise, maps] = row;
            println!(
                "| {name} | x {length} | {error:.2} % | {blurred:.2} % | {opacity:.2} % | {density:.1} | {noise:.1} | {maps:.1} |"
            );
            curve.push((density, error));
        }
        curves.push((name, curve));
    }
    plot(Path::new("docs/pictures/sampling.svg"), &curves)
}

/// The middle of a preset's picture.
fn scene(preset: Preset) -> Scene {
    let mut scene = preset.scene(1);
    let mut camera = scene.camera();
    if let Projection::Perspective { vertical_fov_deg } = &mut camera.projection {
        let half = (0.5 * vertical_fov_deg.to_radians()).tan() / ZOOM;
        *vertical_fov_deg = 2.0 * half.atan().to_degrees();
    }
    scene.camera = Some(camera);
    scene
}

/// Steps so short that shorter ones change the light by 0.2 %.
const CONVERGED: Quality = Quality {
    first_step: 0.02,
    growth: 1.0,
    longest_step: 0.02,
    opaque: 5e-4,
    lit_at_once: 0.0,
    light_resolution: 256,
    max_steps: 20_000,
    ..Quality::FINAL
};

fn scaled(quality: Quality, length: f32) -> Quality {
    Quality {
        first_step: length * quality.first_step,
        growth: quality.growth.powf(length),
        longest_step: length * quality.longest_step,
        ..quality
    }
}

/// A picture without the sky behind, lit by sun and sky in octaves: light in which each sample
/// towards the sun counts.
fn draw(gpu: &Gpu, scene: &Scene, quality: Quality) -> Outcome<(Picture, Counts)> {
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
    renderer.settings.quality = quality;
    renderer.settings.transport = Transport::OCTAVES;
    renderer.settings.counting = true;
    let film = Film::new(SIZE, 1);
    let picture = film.take(gpu, &mut renderer, &film.frame(scene)?, false, &mut |_| ())?;
    Ok((picture, renderer.counts(gpu)?))
}

/// Means over the scenes: relative RMSE in percent of the light, of the light after a 3x3 blur,
/// and of the opacity; density evaluations, noise reads and map reads a ray that hits.
fn measure(gpu: &Gpu, scenes: &[(Scene, Picture)], quality: Quality) -> Outcome<[f64; 6]> {
    let mut means = [0.0; 6];
    for (scene, reference) in scenes {
        let (picture, counts) = draw(gpu, scene, quality)?;
        let a_ray = |n: u64| n as f64 / counts.rays_hit as f64;
        let row = [
            100.0 * error(&picture.pixels, &reference.pixels, 0..3),
            100.0 * error(&blurred(&picture), &blurred(reference), 0..3),
            100.0 * error(&picture.pixels, &reference.pixels, 3..4),
            a_ray(counts.density_evaluations),
            a_ray(counts.noise_reads),
            a_ray(counts.map_reads),
        ];
        means.iter_mut().zip(row).for_each(|(mean, x)| *mean += x / scenes.len() as f64);
    }
    Ok(means)
}

/// Relative RMSE over some channels.
fn error(found: &[[f32; 4]], exact: &[[f32; 4]], channels: std::ops::Range<usize>) -> f64 {
    let (mut difference, mut whole) = (0.0, 0.0);
    for (found, exact) in found.iter().zip(exact) {
        for channel in channels.clone() {
            difference += f64::from(found[channel] - exact[channel]).powi(2);
            whole += f64::from(exact[channel]).powi(2);
        }
    }
    (difference / whole).sqrt()
}

fn blurred(picture: &Picture) -> Vec<[f32; 4]> {
    let (width, height) = (picture.width as i32, picture.height as i32);
    let around = |i: i32| {
        let near = (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y)));
        near.fold([0.0; 4], |sum, (x, y)| {
            let (x, y) = ((i % width + x).clamp(0, width - 1), (i / width + y).clamp(0, height - 1));
            let pixel = picture.pixels[(y * width + x) as usize];
            [0, 1, 2, 3].map(|c: usize| sum[c] + pixel[c] / 9.0)
        })
    };
    (0..width * height).map(around).collect()
}

fn plot(path: &Path, curves: &[(&str, Vec<(f64, f64)>)]) -> Outcome {
    let root = SVGBackend::new(path, (640, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("Sampling error, mean of five scenes", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d((5.0..200.0).log_scale(), (0.4..30.0).log_scale())?;
    let axes = ("density evaluations a ray", "relative RMSE, %");
    chart.configure_mesh().x_desc(axes.0).y_desc(axes.1).draw()?;
    let colors = [RGBColor(205, 85, 30), RGBColor(20, 140, 90), RGBColor(30, 110, 190)];
    for ((name, curve), color) in curves.iter().zip(colors) {
        let line = LineSeries::new(curve.iter().copied(), color.stroke_width(2)).point_size(3);
        chart
            .draw_series(line)?
            .label(format!("{name}, steps x 0.5 to 1.5"))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
    }
    let gray = RGBColor(110, 110, 116);
    chart
        .draw_series(BEFORE.map(|point| Cross::new(point, 4, gray)))?
        .label("before: draft, preview, final")
        .legend(move |(x, y)| Cross::new((x + 8, y), 4, gray));
    chart
        .draw_series([TriangleMarker::new(FIVE, 6, gray)])?
        .label("five samples an ellipsoid")
        .legend(move |(x, y)| TriangleMarker::new((x + 8, y), 5, gray));
    chart.configure_series_labels().background_style(WHITE).border_style(gray).draw()?;
    root.present()?;
    Ok(())
}
