//! Measures what a frame costs against the number of clouds and of ellipsoids, for
//! docs/scale.md: `cargo run --release --example scale_report [-- most]`. Rows with more than
//! `most` ellipsoids (all of them: 20000) are left out; with all of them it also writes
//! docs/pictures/scale.svg.
#![allow(clippy::print_stdout, reason = "it reports")]

use std::{error::Error, path::Path, time::Instant};

use nephos::{
    Result,
    export::Picture,
    gpu::Gpu,
    measure::{crowd, heap},
    render::{Counts, Frame, Quality, Renderer, Target},
    scene::Scene,
};
use plotters::{coord::Shift, prelude::*};

type Outcome<T = ()> = std::result::Result<T, Box<dyn Error>>;

const SIZE: [u32; 2] = [320, 180];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Ellipsoids of a cloud of the field.
const EACH: usize = 16;

/// Ellipsoids of the scenes of one cloud.
const HEAPS: [usize; 5] = [8, 64, 512, 4096, 20_000];
/// Clouds of the scenes of many.
const FIELDS: [usize; 4] = [1, 10, 100, 1000];

fn main() -> Outcome {
    let most = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(20_000);
    let gpu = pollster::block_on(Gpu::open(None))?;
    println!("{} at {}x{}, draft\n", gpu.adapter.name, SIZE[0], SIZE[1]);
    println!(
        "| scene | frame ms | first s | record ms | again ms | covered | rays | hits | density | noise | ellipsoids | volume | MiB |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let report = |count: usize, each: usize, name: &str, scene: Scene| -> Result<Option<(f64, Cost)>> {
        if count * each > most {
            return Ok(None);
        }
        let cost = Cost::of(&gpu, &scene, u32::MAX)?;
        cost.print(&format!("{count} {name}"));
        if each == 1 {
            let baked = Cost::of(&gpu, &scene, 1)?;
            baked.print(&format!("{count} {name}, baked"));
            println!("difference of the light: {:.4}", cost.difference(&baked));
        }
        Ok(Some((count as f64, cost)))
    };
    let all = |costs: Vec<Option<(f64, Cost)>>| costs.into_iter().collect::<Option<Vec<_>>>();
    let fields = FIELDS.map(|count| report(count, EACH, "clouds", crowd(count)));
    let fields = all(fields.into_iter().collect::<Result<Vec<_>>>()?);
    let heaps = HEAPS.map(|count| report(count, 1, "ellipsoids", heap(count)));
    let heaps = all(heaps.into_iter().collect::<Result<Vec<_>>>()?);
    let (Some(fields), Some(heaps)) = (fields, heaps) else { return Ok(()) };
    plot(Path::new("docs/pictures/scale.svg"), &fields, &heaps)
}

fn plot(path: &Path, fields: &[(f64, Cost)], heaps: &[(f64, Cost)]) -> Outcome {
    let root = SVGBackend::new(path, (940, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let halves = root.split_evenly((1, 2));
    chart(&halves[0], "Many clouds of 16 ellipsoids", "clouds", fields)?;
    chart(&halves[1], "One cloud of many ellipsoids", "ellipsoids", heaps)?;
    root.present()?;
    Ok(())
}

/// One number of a cost.
type Value = fn(&Cost) -> f64;

/// Costs of a covered pixel.
fn chart(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    title: &str,
    what: &str,
    costs: &[(f64, Cost)],
) -> Outcome {
    let last = costs.last().map_or(1.0, |(count, _)| *count);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d((costs[0].0..last).log_scale(), (1.0..10_000.0).log_scale())?;
    chart.configure_mesh().x_desc(what).y_desc("per covered pixel").draw()?;
    let lines: [(&str, Value, RGBColor); 4] = [
        ("microseconds", |cost| 1e3 * cost.again_ms, RGBColor(205, 85, 30)),
        ("ellipsoids asked", |cost| cost.counts.ellipsoids as f64, RGBColor(120, 70, 190)),
        ("density evaluations", |cost| cost.counts.density_evaluations as f64, RGBColor(20, 140, 90)),
        ("rays", |cost| cost.counts.rays as f64, RGBColor(30, 110, 190)),
    ];
    for (name, value, color) in lines {
        let points = costs.iter().map(|(count, cost)| (*count, value(cost) / cost.covered.max(1) as f64));
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
    }
    let gray = RGBColor(110, 110, 116);
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE)
        .border_style(gray)
        .draw()?;
    Ok(())
}

/// What a scene costs.
struct Cost {
    frame_ms: f64,
    first_s: f64,
    record_ms: f64,
    again_ms: f64,
    covered: usize,
    counts: Counts,
    memory: u64,
    picture: Picture,
}

impl Cost {
    /// Of a scene whose clouds of `bake_from` ellipsoids or more have a baked volume of depths.
    fn of(gpu: &Gpu, scene: &Scene, bake_from: u32) -> Result<Self> {
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, FORMAT);
        renderer.settings.quality = Quality::DRAFT;
        renderer.settings.bake_from = bake_from;
        // The optics of the droplets are found once.
        Frame::new(scene, SIZE)?;
        let start = Instant::now();
        let frame = Frame::new(scene, SIZE)?;
        let frame_ms = 1e3 * start.elapsed().as_secs_f64();
        // Compile what the scene needs.
        draw(gpu, &mut renderer, &Frame::new(&crowd(1), SIZE)?)?;
        let (first_s, picture) = draw(gpu, &mut renderer, &frame)?;
        let mut again = Vec::new();
        for _ in 0..5 {
            again.push(draw_again(gpu, &mut renderer, &frame)?);
        }
        let [record_ms, again_ms] = [0, 1].map(|i| median(again.iter().map(|times| 1e3 * times[i])));
        renderer.settings.counting = true;
        draw(gpu, &mut renderer, &frame)?;
        let covered = picture.pixels.iter().filter(|pixel| pixel[3] > 0.5).count();
        let memory = renderer.light_bytes() + renderer.volume_bytes();
        Ok(Self {
            frame_ms,
            first_s,
            record_ms,
            again_ms,
            covered,
            counts: renderer.counts(gpu)?,
            memory,
            picture,
        })
    }

    /// Root of the mean square of the difference of two pictures over the mean of this one.
    fn difference(&self, other: &Self) -> f64 {
        let light = |pixel: &[f32; 4]| f64::from(pixel[0] + pixel[1] + pixel[2]);
        let pairs = self.picture.pixels.iter().zip(&other.picture.pixels);
        let squares: f64 = pairs.map(|(a, b)| (light(a) - light(b)).powi(2)).sum();
        let count = self.covered.max(1) as f64;
        let mean: f64 = self.picture.pixels.iter().map(light).sum::<f64>() / count;
        (squares / count).sqrt() / mean
    }

    fn print(&self, name: &str) {
        let Counts { rays, rays_hit, density_evaluations, noise_reads, .. } = self.counts;
        println!(
            "| {name} | {:.1} | {:.2} | {:.1} | {:.1} | {} | {rays} | {rays_hit} | {density_evaluations} | {noise_reads} | {} | {} | {:.1} |",
            self.frame_ms,
            self.first_s,
            self.record_ms,
            self.again_ms,
            self.covered,
            self.counts.ellipsoids,
            self.counts.volume_reads,
            self.memory as f64 / f64::from(1 << 20),
        );
    }
}

/// Draws the clouds without a sky; seconds, and the picture.
fn draw(gpu: &Gpu, renderer: &mut Renderer, frame: &Frame) -> Result<(f64, Picture)> {
    let texture = renderer.picture("scale", frame.size(), FORMAT);
    let view = texture.create_view(&Default::default());
    let start = Instant::now();
    let target = Target { color: &view, depth: None, sky: false };
    renderer.render_in_pieces(gpu, frame, &target, &mut |_| ())?;
    let seconds = start.elapsed().as_secs_f64();
    Ok((seconds, Picture::read(gpu, &texture)?))
}

/// Draws them once more, in one submission; seconds to record it, and in all.
fn draw_again(gpu: &Gpu, renderer: &mut Renderer, frame: &Frame) -> Result<[f64; 2]> {
    let texture = renderer.picture("scale", frame.size(), FORMAT);
    let view = texture.create_view(&Default::default());
    let start = Instant::now();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.render(&mut encoder, frame, &Target { color: &view, depth: None, sky: false });
    let recorded = start.elapsed().as_secs_f64();
    gpu.queue.submit([encoder.finish()]);
    gpu.finish("drawing clouds")?;
    Ok([recorded, start.elapsed().as_secs_f64()])
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
