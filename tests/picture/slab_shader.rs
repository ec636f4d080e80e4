//! The models of slabs in shaders against their references in f64, over random views.

use crate::common;

use common::{evaluate, evaluate_bound, gpu};
use nephos::gpu::linear_clamp;
use nephos::optics::slab::samples::{View, view_coordinate};
use nephos::optics::slab::{SETS, axes, direct, slab_functions, slab_radiance, spread};
use nephos::render::{DirectTextures, FunctionTextures};
use wgpu::BindingResource::{Sampler, TextureView};

/// WGSL that makes the view of two inputs; the set is the last number but one.
const VIEW: &str =
    "let v = SlabView(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x, x[1].y); let orders = u32(x[1].z);";

/// Views all over the tables and beyond, one of each for every set, with suns on both faces.
fn views() -> Vec<(View, usize)> {
    // The fractional parts of multiples of roots fill the unit cube evenly.
    let even = |i: usize, root: f64| (i as f64 * root.sqrt()).fract();
    (0..2000)
        .map(|i| {
            let thickness = axes::thickness_at(1.1 * even(i, 2.0) - 0.05);
            let view = View {
                thickness,
                depth: thickness * even(i, 3.0),
                mu: 2.0 * even(i, 5.0) - 1.0,
                phi: 6.2 * even(i, 7.0) - 3.1,
                mu0: 2.0 * even(i, 11.0) - 1.0,
            };
            // Rounded as the shader gets it.
            let [thickness, depth, mu, phi, mu0] =
                [view.thickness, view.depth, view.mu, view.phi, view.mu0].map(|x| f64::from(x as f32));
            (View { thickness, depth, mu, phi, mu0 }, i % SETS)
        })
        .collect()
}

fn inputs(views: &[(View, usize)]) -> Vec<[[f32; 4]; 2]> {
    let input = |(v, set): &(View, usize)| {
        let [thickness, depth, mu, mu0] = [v.thickness, v.depth, v.mu, v.mu0].map(|x| x as f32);
        [[thickness, depth, mu, mu0], [v.phi.cos() as f32, v.phi.sin() as f32, *set as f32, 0.0]]
    };
    views.iter().map(input).collect()
}

/// GPUs filter with weights of 8 bits and round what comes out to half floats (docs/numerics.md). A step
/// of a table's logarithm is up to 5: 1 % of the value; a half float of the largest exponent here leaves
/// as much.
const FILTERED: f64 = 0.02;
/// Bouthors' functions add three logarithms, and depths count in exponentials of two more numbers: 0.057
/// where a GPU's filters were imitated.
const FILTERED_FUNCTIONS: f64 = 0.08;

/// Fails where a number is further from its reference than `relative` and `absolute` allow, and where
/// numbers use more than an eighth of that in the mean (root mean square): rounding leaves a few far off.
fn compare(name: &str, got: impl Iterator<Item = (f64, f64, View)>, relative: f64, absolute: f64) {
    let mut wrong = Vec::new();
    let mut squares = Vec::new();
    for (got, wanted, view) in got {
        let share = (got - wanted).abs() / (relative * wanted.abs() + absolute);
        if share.is_nan() || share > 1.0 {
            wrong.push(format!("{got} for {wanted} at {view:?}"));
        }
        squares.push(share * share);
    }
    assert!(wrong.is_empty(), "{name}: {} wrong\n{}", wrong.len(), wrong[..wrong.len().min(8)].join("\n"));
    let mean = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(mean < 0.125, "{name}: {mean} of what is allowed in the mean");
}

#[test]
fn slab_direct_is_the_direct_table() {
    let textures = DirectTextures::new(&gpu().device, &gpu().queue).unwrap();
    let sampler = linear_clamp(&gpu().device);
    let views = views();
    let got = evaluate_bound(
        "slab_direct",
        "@group(0) @binding(2) var modes: texture_3d<f32>; @group(0) @binding(3) var phase: texture_2d<f32>;
         @group(0) @binding(4) var linear: sampler;",
        &format!("{VIEW} return vec4f(slab_direct(modes, phase, linear, orders, v));"),
        &inputs(&views),
        &[TextureView(&textures.modes), TextureView(&textures.phase), Sampler(&sampler)],
    );
    let table = slab_radiance().unwrap();
    let pairs = views.iter().zip(got);
    let pairs = pairs.map(|((view, set), got)| (f64::from(got[0]), table.radiance(*set, *view), *view));
    compare("slab_direct", pairs, FILTERED, 1e-9);
}

#[test]
fn slab_functions_and_slab_collector_are_the_fitted_functions() {
    let textures = FunctionTextures::new(&gpu().device, &gpu().queue).unwrap();
    let sampler = linear_clamp(&gpu().device);
    let views = views();
    // slab_functions reads by slab_functions_read.
    let got = evaluate_bound(
        "slab_functions",
        "@group(0) @binding(2) var angle: texture_2d<f32>; @group(0) @binding(3) var seen: texture_2d<f32>;
         @group(0) @binding(4) var sun: texture_2d<f32>; @group(0) @binding(5) var shared_numbers: texture_2d<f32>;
         @group(0) @binding(6) var offset: texture_2d<f32>; @group(0) @binding(7) var linear: sampler;",
        &format!(
            "{VIEW} return vec4f(slab_functions(angle, seen, sun, linear, orders, v), 0.0,
             slab_collector(shared_numbers, offset, linear, orders, v));"
        ),
        &inputs(&views),
        &[
            TextureView(&textures.angle),
            TextureView(&textures.view),
            TextureView(&textures.sun),
            TextureView(&textures.collector),
            TextureView(&textures.offset),
            Sampler(&sampler),
        ],
    );
    let (functions, collector) = slab_functions().unwrap();
    let radiance = views
        .iter()
        .zip(&got)
        .map(|((view, set), got)| (f64::from(got[0]), functions.radiance(*set, *view), *view));
    compare("slab_functions", radiance, FILTERED_FUNCTIONS, 1e-9);
    for axis in 0..2 {
        let places = views
            .iter()
            .zip(&got)
            .map(|((view, set), got)| (f64::from(got[2 + axis]), collector.center(*set, *view)[axis], *view));
        // Differences of numbers of the size of the depth, by an exponential of one that is filtered.
        compare("slab_collector", places, FILTERED_FUNCTIONS, 0.1);
    }
}

#[test]
fn what_models_know_of_a_view_is_right() {
    let views = views();
    // slab_sunward, slab_half_sine, slab_opacity, slab_view_coordinate.
    let got = evaluate(
        "slab_view",
        &format!(
            "{VIEW} let u = slab_sunward(v);
             return vec4f(u.depth, slab_half_sine(u), slab_opacity(u), slab_view_coordinate(u.mu));"
        ),
        &inputs(&views),
    );
    for (i, (name, absolute)) in
        [("depth", 1e-6), ("half sine", 1e-3), ("opacity", 1e-5), ("coordinate", 1e-5)]
            .into_iter()
            .enumerate()
    {
        let pairs = views.iter().zip(&got).map(|((view, _), got)| {
            let v = view.sunward();
            let wanted = [v.depth, v.half_sine(), v.beam().opacity(v.depth, v.mu), view_coordinate(v.mu)][i];
            (f64::from(got[i]), wanted, *view)
        });
        compare(name, pairs, 1e-4, absolute);
    }
    // slab_ln_known and slab_ln_1p.
    let got = evaluate(
        "slab_direct slab_functions",
        &format!(
            "{VIEW} return vec4f(slab_ln_known(orders, v.thickness, v.depth), slab_ln_1p(0.01 * v.depth), 0.0, 0.0);"
        ),
        &inputs(&views),
    );
    let pairs = views.iter().zip(&got).flat_map(|((view, set), got)| {
        let known = direct::ln_known(*set, view.thickness, view.depth);
        [(f64::from(got[0]), known, *view), (f64::from(got[1]), (0.01 * view.depth).ln_1p(), *view)]
    });
    compare("logarithms", pairs, 1e-4, 1e-4);
}

#[test]
fn slab_view_takes_its_numbers_from_directions() {
    let normal = glam::Vec3::new(0.3, 0.9, -0.1).normalize();
    let eyes =
        [glam::Vec3::new(0.8, 0.5, 0.2), glam::Vec3::new(-0.4, -0.6, 0.9), glam::Vec3::new(0.1, 0.2, -1.0)];
    let suns =
        [glam::Vec3::new(0.2, 1.0, 0.4), glam::Vec3::new(-1.0, 0.1, 0.3), glam::Vec3::new(0.5, -0.8, 0.1)];
    let pairs: Vec<_> =
        eyes.iter().flat_map(|eye| suns.iter().map(|sun| (eye.normalize(), sun.normalize()))).collect();
    let inputs: Vec<[[f32; 4]; 2]> =
        pairs.iter().map(|(eye, sun)| [eye.extend(0.0).to_array(), sun.extend(0.0).to_array()]).collect();
    let body = "let v = slab_view(5.0, 2.0, normalize(vec3f(0.3, 0.9, -0.1)), x[0].xyz, x[1].xyz);
        return vec4f(v.mu, v.mu0, 2.0 * slab_half_sine(v) * slab_half_sine(v), v.sin_phi);";
    for ((eye, sun), got) in pairs.iter().zip(evaluate("slab_view", body, &inputs)) {
        // Light flies to the eye and away from the sun; the scattering angle lies between.
        let wanted = [-normal.dot(*eye), normal.dot(*sun), 1.0 + eye.dot(*sun)];
        for (got, wanted) in got.iter().zip(wanted) {
            assert!((got - wanted).abs() < 1e-5, "{got} for {wanted}");
        }
        let side = normal.cross(*sun).dot(*eye);
        assert!(got[3] * side > 0.0, "positive azimuths are on the side of normal x sun: {} {side}", got[3]);
    }
}

#[test]
fn coordinates_and_spreads_are_those_of_the_tables() {
    let views = views();
    // slab_thickness_coordinate, slab_depth_coordinate, slab_sun_coordinate, slab_spread.
    let got = evaluate(
        "slab slab_view",
        &format!(
            "{VIEW} return vec4f(slab_thickness_coordinate(v.thickness), slab_depth_coordinate(v.depth, v.thickness),
             slab_sun_coordinate(v.mu0), slab_spread(orders, v.thickness, v.depth));"
        ),
        &inputs(&views),
    );
    for i in 0..4 {
        let pairs = views.iter().zip(&got).map(|((view, set), got)| {
            let wanted = [
                axes::thickness_coordinate(view.thickness),
                axes::depth_coordinate(view.depth, view.thickness),
                axes::sun_coordinate(view.mu0),
                spread::spread(*set, view.thickness, view.depth),
            ];
            (f64::from(got[i]), wanted[i], *view)
        });
        // Logarithms have 1.4e-5; the depth's is a difference of two over a small one.
        compare("coordinates", pairs, 1e-3, 2e-4);
    }
}
