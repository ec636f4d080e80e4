//! How the path tracer draws: its phase functions, and choices that change noise and time but not
//! the mean; errors that are what they say; pictures that are gone on with.
#![cfg(feature = "export")]

use crate::common;

use std::f64::consts::PI;

use common::{
    gpu,
    truth::{
        HG, Measured, assert_agree, chi_square_z, mean, noisy, opacity, sphere, trace, trace_with, traced,
        tracer,
    },
};
use glam::DVec3;
use nephos::{
    gpu::{self, ComputeProgram, ENTRY_POINTS, TextureDesc, read_buffer, storage_buffer},
    optics::phase::{Phase, angle_at},
    reference::{PathOptions, Stop, phase_table},
    scene::{self, Droplets, Scene},
};

/// Bins of the scattering angle, even in the coordinate of [`angle_at`], and of the azimuth.
const BINS: usize = 192;
const AZIMUTHS: usize = 64;

/// Runs the shader's own functions under another `main`, which counts into `tally` and notes values
/// of the phase function at the middles of the bins in `values`.
fn scatterings(droplets: &Droplets, channel: usize) -> (Vec<u32>, Vec<[f32; 4]>) {
    let source = ENTRY_POINTS.iter().find(|(name, _)| *name == "path").unwrap().1;
    let (functions, _) = source.split_once("@compute").unwrap();
    let source = format!(
        "{functions}
        @group(0) @binding(17) var<storage, read_write> tallies: array<atomic<u32>>;
        @group(0) @binding(18) var<storage, read_write> values: array<vec4f>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
            random_state = hash_random(id.x, 0u, 5u);
            let before = normalize(vec3f(0.6, -0.3, 0.5));
            let u = normalize(cross(before, vec3f(0.0, 1.0, 0.0)));
            let v = cross(before, u);
            for (var i = 0u; i < 512u; i++) {{
                let part = select(WIDE, PEAK, draw() < peak_share(0u));
                let after = scattered(0u, part, {channel}u, before);
                let bin = min(u32(phase_coordinate(before, after) * {BINS}.0), {BINS}u - 1u);
                atomicAdd(&tallies[bin], 1u);
                let azimuth = fract(atan2(dot(after, v), dot(after, u)) / (2.0 * PI) + 1.0);
                atomicAdd(&tallies[{BINS}u + min(u32(azimuth * {AZIMUTHS}.0), {AZIMUTHS}u - 1u)], 1u);
            }}
            if id.x < {BINS}u {{
                let x = (f32(id.x) + 0.5) / {BINS}.0;
                let end = min(x, 1.0 - x);
                let angle = select(PI - 2.0 * PI * end * end, 2.0 * PI * end * end, x < 0.5);
                let after = turned(before, angle, 1.0);
                let peak = peak_share(0u);
                values[id.x] =
                    vec4f((1.0 - peak) * phase(0u, WIDE, before, after) + peak * phase(0u, PEAK, before, after), 0.0);
            }}
        }}"
    );
    let device = &gpu().device;
    let program =
        ComputeProgram::from_source(device, "scatterings", gpu::link(&source, &nephos::frame::MEDIA[..1]));
    let table = storage_buffer(device, "phase tables", &phase_table(droplets, true).unwrap());
    let counts = storage_buffer(device, "counts", &[0u32; BINS + AZIMUTHS]);
    let values = storage_buffer(device, "values", &[[0.0f32; 4]; BINS]);
    let mut bindings = vec![None; 19];
    bindings[5] = Some(table.as_entire_binding());
    bindings[17] = Some(counts.as_entire_binding());
    bindings[18] = Some(values.as_entire_binding());
    let group = program.bind(device, &bindings);
    let mut encoder = device.create_command_encoder(&Default::default());
    program.dispatch(&mut encoder, &[&group], [64, 1, 1], None);
    gpu().queue.submit([encoder.finish()]);
    (read_buffer(gpu(), &counts).unwrap(), read_buffer(gpu(), &values).unwrap())
}

/// Share of the light that a phase function scatters into each bin, by Simpson's rule.
fn shares(phase: &Phase, channel: usize) -> Vec<f64> {
    const FINE: usize = 64;
    let ring = |u: f64| {
        let theta = angle_at(u);
        // d theta / d u = 4 pi min(u, 1 - u).
        2.0 * PI * theta.sin() * phase.value(channel, theta) * 4.0 * PI * u.min(1.0 - u)
    };
    let step = 1.0 / (BINS * FINE) as f64;
    let simpson = |u: f64| step / 6.0 * (ring(u) + 4.0 * ring(u + 0.5 * step) + ring(u + step));
    let bin = |i: usize| (0..FINE).map(|k| simpson((i * FINE + k) as f64 * step)).sum();
    (0..BINS).map(bin).collect()
}

fn chi_square(counts: &[u32], shares: &[f64]) -> f64 {
    let n: f64 = counts.iter().map(|&count| f64::from(count)).sum();
    let term = |(count, share): (&u32, &f64)| (f64::from(*count) - n * share).powi(2) / (n * share);
    counts.iter().zip(shares).map(term).sum()
}

#[test]
fn scattered_directions_have_the_distribution_of_the_phase_function() {
    let phases = [
        scene::Phase::Isotropic,
        scene::Phase::HenyeyGreenstein { g: 0.85 },
        scene::Phase::HenyeyGreenstein { g: -0.4 },
        scene::Phase::Mie,
    ];
    for (phase, channel) in phases.into_iter().zip([0, 1, 2, 2]) {
        let droplets = Droplets { phase, ..Droplets::default() };
        let exact = Phase::of(&droplets).unwrap();
        let (counts, values) = scatterings(&droplets, channel);
        let polar = chi_square_z(chi_square(&counts[..BINS], &shares(&exact, channel)), BINS - 1);
        let even = [1.0 / AZIMUTHS as f64; AZIMUTHS];
        let azimuthal = chi_square_z(chi_square(&counts[BINS..], &even), AZIMUTHS - 1);
        eprintln!("{phase:?}: polar {polar:.2}, azimuthal {azimuthal:.2}");
        // Eight tests: by chance one fails in 1000 tries.
        assert!(polar < 3.7 && azimuthal < 3.7, "{phase:?}: polar {polar}, azimuthal {azimuthal}");
        for (i, value) in values.iter().enumerate() {
            for (c, value) in value[..3].iter().enumerate() {
                let wanted = exact.value(c, angle_at((i as f64 + 0.5) / BINS as f64));
                // Angles are good to 3e-5, the table interpolates between 4096.
                let error = (f64::from(*value) / wanted - 1.0).abs();
                assert!(error < 3e-3, "{phase:?}, bin {i}, channel {c}: {value} for {wanted}");
            }
        }
    }
}

/// Bins of the transmittance at which a path is stopped, which is evenly distributed.
const FREE_PATHS: usize = 64;
/// Extinction of the medium, 1/m, and majorants of the cells that paths cross, over it.
const EXTINCTION: f32 = 0.02;
const MAJORANTS: [f32; 8] = [1.0, 3.0, 1.5, 2.0, 1.0, 5.0, 1.2, 2.0];

/// A body of which only the power and the reach are told, at the places that the shader has them.
fn body(source: &str) -> Vec<f32> {
    let module = gpu::validate(&gpu::link(source, &nephos::frame::MEDIA[..1])).unwrap();
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Body")).unwrap().1;
    let wgpu::naga::TypeInner::Struct { members, span } = &found.inner else { panic!("a struct") };
    let mut body = vec![0.0; *span as usize / 4];
    for (name, value) in [("power", 2.0), ("reach", 1e4), ("level", -1e30)] {
        let member = members.iter().find(|member| member.name.as_deref() == Some(name)).unwrap();
        body[member.offset as usize / 4] = value;
    }
    body
}

/// Counts where paths through cells of 50 m are stopped, by the shader's own tracking.
fn free_paths() -> Vec<u32> {
    let source = ENTRY_POINTS.iter().find(|(name, _)| *name == "path").unwrap().1;
    let (functions, _) = source.split_once("@compute").unwrap();
    let source = format!(
        "{functions}
        @group(0) @binding(17) var<storage, read_write> tallies: array<atomic<u32>>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{
            random_state = hash_random(id.x, 0u, 9u);
            for (var i = 0u; i < 128u; i++) {{
                var p = vec3f(10.0, 0.0, 0.0);
                var through = 0.0;
                for (var j = 0u; j < 200u; j++) {{
                    let step = track(p, vec3f(1.0, 0.0, 0.0));
                    p = step.position;
                    if step.outside {{
                        break;
                    }}
                    if step.tentative && draw() < step.matter.extinction / step.majorant {{
                        through = exp(-{EXTINCTION} * (p.x - 10.0));
                        break;
                    }}
                }}
                atomicAdd(&tallies[min(u32(through * {FREE_PATHS}.0), {FREE_PATHS}u - 1u)], 1u);
            }}
        }}"
    );
    let device = &gpu().device;
    let program =
        ComputeProgram::from_source(device, "free paths", gpu::link(&source, &nephos::frame::MEDIA[..1]));
    // Members of `Scene` that tracking reads: corner, edge and number of the first grid's cells.
    let mut scene = [0u32; 80];
    scene[..7].copy_from_slice(
        &[0.0f32, -25.0, -25.0, 50.0].map(f32::to_bits).iter().copied().chain([8, 1, 1]).collect::<Vec<_>>(),
    );
    let cells: Vec<[u32; 4]> = MAJORANTS.map(|share| [0, 1, (share * EXTINCTION).to_bits(), 0]).into();
    // A sphere of 10 km without noise, and a sharp edge far away.
    let axis = |i: usize| std::array::from_fn(|j| if i == j || j == 3 { 1e-4f32 } else { 0.0 });
    let ellipsoid: Vec<f32> = [0, 1, 2]
        .into_iter()
        .flat_map(|i| -> [f32; 4] { axis(i) })
        // Its middle, extinction, boundary, wispiness, core and body, the first.
        .chain([0.0, 0.0, 0.0, EXTINCTION, 0.0, 0.0, 0.0, 0.0])
        .collect();
    let no_noise = gpu::texture(
        device,
        &TextureDesc {
            label: "no noise",
            size: [1, 1, 1],
            mips: 1,
            format: wgpu::TextureFormat::Rg8Snorm,
            usage: wgpu::TextureUsages::COPY_DST,
        },
    )
    .create_view(&Default::default());
    let repeat = gpu::linear_repeat(device);
    let scene = gpu::uniform_buffer(device, "scene", &scene);
    // Nothing is uneven or diluted; lumps join by a power of 2 of depths told in 10 km.
    let bodies = storage_buffer(device, "bodies", &body(&source));
    let ellipsoids = storage_buffer(device, "ellipsoids", &ellipsoid);
    let cells = storage_buffer(device, "cells", &cells);
    let candidates = storage_buffer(device, "candidates", &[0u32]);
    let counts = storage_buffer(device, "counts", &[0u32; FREE_PATHS]);
    let mut bindings = vec![None; 18];
    for (place, buffer) in [(0, &scene), (3, &cells), (4, &candidates), (17, &counts)] {
        bindings[place] = Some(buffer.as_entire_binding());
    }
    let group = program.bind(device, &bindings);
    // The medium.
    let texture = wgpu::BindingResource::TextureView(&no_noise);
    let resources = [
        (0, ellipsoids.as_entire_binding()),
        (1, bodies.as_entire_binding()),
        (2, texture),
        (3, wgpu::BindingResource::Sampler(&repeat)),
    ];
    let entries = resources.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
    let layout = program.layout(1);
    let medium = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    program.dispatch(&mut encoder, &[&group, &medium], [32, 1, 1], None);
    gpu().queue.submit([encoder.finish()]);
    read_buffer(gpu(), &counts).unwrap()
}

#[test]
fn free_paths_are_exponential_whatever_the_majorants_of_the_cells() {
    let z = chi_square_z(chi_square(&free_paths(), &[1.0 / FREE_PATHS as f64; FREE_PATHS]), FREE_PATHS - 1);
    // By chance once in ten thousand seeds.
    assert!(z.abs() < 3.7, "{z}");
}

/// A noisy cloud with some absorption, under sun and sky.
fn lit(phase: &str) -> Scene {
    let mut scene = noisy(phase, 150.0, DVec3::new(0.3, 0.2, 0.9));
    scene.sky = serde_json::from_str(r#"{"uniform": {"radiance": [0.1, 0.1, 0.1]}}"#).unwrap();
    scene.sun.position = scene::SunPosition::Direction(DVec3::new(0.7, 0.5, 0.3));
    scene.clouds[0].droplets.albedo = 0.8;
    scene
}

#[test]
fn choices_of_how_to_trace_do_not_change_the_mean() {
    let light = |options: PathOptions| mean(&trace_with(&lit(HG), [16, 16], 960, &options), 1);
    let usual = light(PathOptions { seed: 1, ..PathOptions::default() });
    let others = [
        ("no direction around the sun", PathOptions { seed: 2, guided: false, ..PathOptions::default() }),
        ("no roulette on faint paths", PathOptions { seed: 3, faint: 0.0, ..PathOptions::default() }),
        ("roulette on all paths", PathOptions { seed: 4, faint: 1e9, ..PathOptions::default() }),
        ("one thread a pixel", PathOptions { seed: 5, lanes: Some(1), ..PathOptions::default() }),
    ];
    assert_agree(&others.map(|(name, options)| (name.to_owned(), light(options), usual)));
}

#[test]
fn colours_agree_with_pictures_of_one_channel() {
    // Mie's channels differ; a phase function for all channels does not: carrying three of them
    // by one path must weigh alike whichever chose it. Droplets of one channel's own come from a
    // picture in which the other two carry no light.
    let mut gray = lit("\"mie\"");
    gray.sun.angular_diameter_deg = 0.0;
    let whole = trace(&gray, [12, 12], 960);
    let alone = |channel: usize| {
        let mut scene = gray.clone();
        scene.sun.irradiance = [0, 1, 2].map(|c| f64::from(u8::from(c == channel)));
        let options = PathOptions { seed: 7, guided: false, ..PathOptions::default() };
        mean(&trace_with(&scene, [12, 12], 960, &options), channel)
    };
    let result = |channel| (format!("channel {channel}"), mean(&whole, channel), alone(channel));
    assert_agree(&[result(0), result(2)]);
}

#[test]
fn any_number_of_samples_has_the_same_mean() {
    // With one sample a pixel, one channel chooses for each; all of them get their turn.
    let light = |samples, side| mean(&trace(&lit("\"mie\""), [side, side], samples), 0);
    let (one, many) = (light(1, 220), light(360, 12));
    // Errors of one sample are not known: those of many, scaled to as many paths.
    let scaled = Measured { error: many.error * (360.0_f64 * 144.0 / (220.0 * 220.0)).sqrt(), ..one };
    assert_agree(&[("one sample".to_owned(), scaled, many)]);
}

#[test]
fn long_paths_keep_the_light_of_a_furnace() {
    // Optical diameter 80: 53 collisions in the mean, hundreds for those that go deep.
    let sky = r#"{"uniform": {"radiance": [1, 1, 1]}}"#;
    let scene = sphere(40.0, "\"isotropic\"", sky, [0.0, 1.0, 0.0], 0.0);
    let options = PathOptions { seed: 1, guided: false, ..PathOptions::default() };
    let mut tracer = tracer(&scene, [12, 12], &options);
    let estimate = traced(&mut tracer, 192);
    let lost = opacity(&estimate) - mean(&estimate, 1).value;
    // All paths weigh 1, but for rounding. Roulette on what is longer than 256 lost 2.7 %.
    assert!(lost.abs() < 1e-4, "{lost}");
}

#[test]
fn standard_errors_are_those_of_pictures_with_other_seeds() {
    for lanes in [1, 8] {
        let picture = |seed| {
            let options = PathOptions { seed, lanes: Some(lanes), ..PathOptions::default() };
            trace_with(&lit(HG), [32, 32], 96, &options)
        };
        let (a, b) = (picture(1), picture(2));
        let mut terms = Vec::new();
        for i in 0..a.mean.len() {
            let variance = f64::from(a.error[i][1]).powi(2) + f64::from(b.error[i][1]).powi(2);
            if a.mean[i][3].min(b.mean[i][3]) > 0.3 {
                terms.push(f64::from(a.mean[i][1] - b.mean[i][1]).powi(2) / variance);
            }
        }
        let mean = terms.iter().sum::<f64>() / terms.len() as f64;
        eprintln!("{lanes} threads a pixel: chi-square {mean:.3} a pixel, {} pixels", terms.len());
        // 1, with a deviation of sqrt(2 / n) for normal numbers; these have longer tails.
        let wide = 5.0 * (2.0 / terms.len() as f64).sqrt();
        assert!(terms.len() > 100 && (mean - 1.0).abs() < wide, "{lanes}: {mean}");
    }
}

#[test]
fn more_samples_continue_the_same_picture() {
    let scene = sphere(2.0, "\"mie\"", "\"none\"", [0.0, 0.6, 0.8], 1.0);
    let options = PathOptions { seed: 1, ..PathOptions::default() };
    let whole = trace(&scene, [8, 8], 60);
    let mut one = tracer(&scene, [8, 8], &options);
    for samples in [12, 33, 60] {
        one.trace(samples, &mut |_| true).unwrap();
    }
    // Another tracer, as after a restart, takes up what the first one left.
    let earlier = trace(&scene, [8, 8], 33);
    let mut other = tracer(&scene, [8, 8], &options).after(earlier).unwrap();
    other.trace(60, &mut |_| true).unwrap();
    for pieces in [one.estimate().unwrap(), other.estimate().unwrap()] {
        assert_eq!(whole.samples, pieces.samples);
        for (a, b) in whole.mean.iter().flatten().zip(pieces.mean.iter().flatten()) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
        for (a, b) in whole.error.iter().flatten().zip(pieces.error.iter().flatten()) {
            assert!((a - b).abs() < 1e-4 * a.max(0.01), "{a} {b}");
        }
    }
}

#[test]
fn a_picture_of_another_size_is_not_gone_on_with() {
    let scene = sphere(2.0, HG, "\"none\"", [0.0, 0.6, 0.8], 1.0);
    let earlier = trace(&scene, [8, 8], 3);
    let refusal = tracer(&scene, [8, 9], &PathOptions::default()).after(earlier).err().unwrap().to_string();
    assert!(refusal.contains("72 and of 64 pixels"), "{refusal}");
}

#[test]
fn pictures_end_by_samples_noise_or_time() {
    let until = |stop: Stop| {
        let mut last = 0.0;
        let mut tracer = tracer(&lit(HG), [12, 12], &PathOptions::default());
        let estimate = tracer.trace_until(&stop, &mut |progress| {
            assert!((0.0..=1.0).contains(&progress.share));
            last = progress.share;
            Ok(true)
        });
        (estimate.unwrap(), last)
    };
    let (estimate, share) = until(Stop { samples: 50, ..Stop::default() });
    assert_eq!((estimate.samples, share), (50, 1.0));
    let (estimate, share) = until(Stop { noise: 0.05, samples: 100_000, ..Stop::default() });
    assert!(estimate.noise() <= 0.05 && estimate.noise() > 0.03 && share == 1.0, "{}", estimate.noise());
    // Without an end to its time this would take days.
    let (estimate, _) = until(Stop { seconds: 0.5, ..Stop::default() });
    assert!((1..u32::MAX).contains(&estimate.samples), "{}", estimate.samples);
}
