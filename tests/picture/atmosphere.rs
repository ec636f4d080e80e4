//! Functions of `shaders/lib/air.wgsl` and `atmosphere.wgsl` against f64 and closed
//! forms. Those that read tables are tested in `sky.rs`, through the tables.

use crate::common::{self, atmosphere as reference};

use std::f64::consts::PI;

use common::evaluate_with;
use nephos::frame::AtmosphereUniform;
use reference::{Air, GROUND, TOP, to_sphere};

/// WGSL that makes `earth` the atmosphere which the renderer makes.
fn earth() -> String {
    let a = AtmosphereUniform::earth(6.0, 1.0, glam::Vec3::splat(0.1), 0.004625);
    let v = |v: glam::Vec3| format!("vec3f({:e}, {:e}, {:e})", v.x, v.y, v.z);
    format!(
        "const earth = Atmosphere({}, {:e}, {}, {:e}, {}, {:e}, {:e}, {:e}, {:e}, {:e}, {:e}, {:e}, {:e}, 0.0);",
        v(a.rayleigh),
        a.rayleigh_height,
        v(a.ozone),
        a.ozone_altitude,
        v(a.ground_albedo),
        a.ozone_half_width,
        a.mie_scattering,
        a.mie_extinction,
        a.mie_height,
        a.mie_g,
        a.ground_radius,
        a.thickness,
        a.sun_radius
    )
}

/// Evaluates `body` with `x` for every input.
fn gpu(body: &str, inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let inputs: Vec<[[f32; 4]; 1]> = inputs.iter().map(|x| [*x]).collect();
    let declarations = format!("{}\n fn f(x: vec4f) -> vec4f {{ {body} }}", earth());
    evaluate_with("atmosphere", &declarations, "return f(x[0]);", &inputs)
}

fn pairs(first: &[f32], second: &[f32]) -> Vec<[f32; 4]> {
    first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b, 0.0, 0.0])).collect()
}

fn close(what: &str, got: f32, want: f64, tolerance: f64) {
    let error = (f64::from(got) - want).abs();
    assert!(error <= tolerance, "{what}: {got} but {want}, error {error:e}");
}

const ALTITUDES: [f32; 9] = [0.0, 0.1, 1.7, 100.0, 2e3, 1e4, 3e4, 9e4, 1e5];

fn sines(count: usize) -> Vec<f32> {
    (0..=count).map(|i| 2.0 * i as f32 / count as f32 - 1.0).collect()
}

#[test]
fn atmosphere_medium_agrees_with_bruneton() {
    let inputs: Vec<_> = (-10..=200).map(|i| [500.0 * i as f32, 0.0, 0.0, 0.0]).collect();
    let scattering = gpu("let m = atmosphere_medium(earth, x.x); return vec4f(m.rayleigh, m.mie);", &inputs);
    let extinction = gpu("return vec4f(atmosphere_medium(earth, x.x).extinction, 0.0);", &inputs);
    for ((x, s), e) in inputs.iter().zip(scattering).zip(extinction) {
        let (rayleigh, mie, lost) = Air::EARTH.medium(f64::from(x[0]).max(0.0));
        for c in 0..3 {
            // The tent of ozone ends in a difference of two altitudes: 1e-6 of its height.
            close("rayleigh", s[c], rayleigh[c], 1e-5 * rayleigh[c]);
            close("extinction", e[c], lost[c], 2e-5 * lost[c] + 2e-12);
        }
        close("mie", s[3], mie, 1e-4 * mie + 1e-35);
    }
}

#[test]
fn rayleigh_phase_and_haze_phase_are_cornette_shanks_and_normalised() {
    let steps = 20_000;
    let nus: Vec<_> =
        (0..steps).map(|i| [2.0 * (i as f32 + 0.5) / steps as f32 - 1.0, 0.8, 0.0, 0.0]).collect();
    let values =
        gpu("return vec4f(rayleigh_phase(x.x), haze_phase(x.y, x.x), haze_phase(0.0, x.x), 0.0);", &nus);
    let width = 2.0 * 2.0 * PI / f64::from(steps);
    for (phase, name) in ["air", "haze", "haze with g = 0"].iter().enumerate() {
        let whole: f64 = values.iter().map(|v| f64::from(v[phase]) * width).sum();
        assert!((whole - 1.0).abs() < 1e-4, "{name} sums to {whole}");
    }
    let mean: f64 = nus.iter().zip(&values).map(|(x, v)| f64::from(x[0] * v[1]) * width).sum();
    // Closed form of the mean cosine: 3 g (4 + g^2) / (5 (2 + g^2)).
    assert!((mean - 3.0 * 0.8 * 4.64 / (5.0 * 2.64)).abs() < 1e-3, "mean cosine {mean}");
    for (x, v) in nus.iter().zip(&values).step_by(97) {
        let nu = f64::from(x[0]);
        close("air", v[0], reference::rayleigh_phase(nu), 1e-7);
        // Towards the peak 1 + g^2 - 2 g nu cancels to 0.04: 24 times the rounding.
        close("haze", v[1], reference::haze_phase(0.8, nu), 1e-5 * reference::haze_phase(0.8, nu));
        close("g = 0", v[2], reference::rayleigh_phase(nu), 1e-7);
    }
}

#[test]
fn horizon_square_square_to_top_and_horizon_mu_do_not_cancel() {
    let inputs = pairs(&ALTITUDES, &[0.0]);
    let values = gpu(
        "return vec4f(horizon_square(earth, x.x), square_to_top(earth, x.x), horizon_mu(earth, x.x), 0.0);",
        &inputs,
    );
    for (x, v) in inputs.iter().zip(values) {
        let h = f64::from(x[0]);
        let r = GROUND + h;
        close("to the horizon", v[0], h * (2.0 * GROUND + h), 1e-6 * h * 2.0 * GROUND);
        close("to the top", v[1], TOP * TOP - r * r, 1e-6 * TOP * TOP / 64.0 * (1.0 - h / 1e5) + 1e3);
        let mu = -(h * (2.0 * GROUND + h)).sqrt() / r;
        close("horizon", v[2], mu, 1e-6 * mu.abs());
    }
}

#[test]
fn distance_to_top_is_exact_from_the_ground_to_the_top() {
    let mut inputs = pairs(&ALTITUDES, &sines(200));
    inputs.extend(pairs(&ALTITUDES, &[1e-6, -1e-6, 1e-3, -1e-3]));
    let values = gpu("return vec4f(distance_to_top(earth, x.x, x.y));", &inputs);
    for (x, v) in inputs.iter().zip(values) {
        let want = to_sphere(GROUND + f64::from(x[0]), f64::from(x[1]), TOP).expect("starts inside");
        // Rays from the top downwards end where they began: a difference of two equal numbers.
        close(&format!("{x:?}"), v[0], want, 2e-6 * want + 0.1);
    }
}

#[test]
fn distance_to_ground_holds_to_the_grazing_ray() {
    // Cosines from straight down to the horizon, ever closer.
    let mut inputs = Vec::new();
    for h in &ALTITUDES[1..] {
        let horizon = -(f64::from(*h) * (2.0 * GROUND + f64::from(*h))).sqrt() / (GROUND + f64::from(*h));
        for k in 0..=24 {
            let share = 1.0 - 0.5f64.powi(k);
            inputs.push([*h, (horizon * share - (1.0 - share)).min(0.9999 * horizon) as f32, 0.0, 0.0]);
        }
    }
    let values = gpu("return vec4f(distance_to_ground(earth, x.x, x.y));", &inputs);
    for (x, v) in inputs.iter().zip(values) {
        let (h, mu) = (f64::from(x[0]), f64::from(x[1]));
        let (across, square) = ((GROUND + h) * mu, h * (2.0 * GROUND + h));
        let root = (across * across - square).sqrt();
        let want = square / (root - across);
        // Near the horizon the root is of a difference: rounding there is amplified.
        let grazing = 1.0 + across.abs() / root;
        close(&format!("{x:?}"), v[0], want, 3e-7 * grazing * want);
    }
    let tangent =
        gpu("return vec4f(distance_to_ground(earth, x.x, horizon_mu(earth, x.x)));", &[[1e5, 0.0, 0.0, 0.0]]);
    // Half the digits are left at the tangent itself.
    close("tangent", tangent[0][0], (1e5f64 * (2.0 * GROUND + 1e5)).sqrt(), 600.0);
}

#[test]
fn air_ray_at_turns_with_the_earth() {
    let mut inputs = Vec::new();
    for h in ALTITUDES {
        for (mu, mu_sun, azimuth) in [(0.0, 0.1, 0.3), (0.3, -0.2, 1.0), (1.0, 0.5, 0.0), (-0.1, 0.0, 3.0)] {
            for t in [0.0, 10.0, 3e4, 1e6] {
                inputs.push(([h, mu, mu_sun, t], azimuth));
            }
        }
    }
    let plain: Vec<[f32; 4]> = inputs.iter().map(|(x, _)| *x).collect();
    let nus: Vec<_> = inputs
        .iter()
        .map(|(x, azimuth)| reference::Ray::new(GROUND, f64::from(x[1]), f64::from(x[2]), *azimuth).nu as f32)
        .collect();
    let both: Vec<_> = plain.iter().zip(&nus).map(|(x, nu)| [*x, [*nu; 4]]).collect();
    let body = "let r = air_ray_at(earth, AirRay(x[0].x, x[0].y, x[0].z, x[1].x), x[0].w);
        return vec4f(r.altitude, r.mu, r.mu_sun, r.nu);";
    let values = evaluate_with("atmosphere", &earth(), body, &both);
    for ((x, nu), v) in plain.iter().zip(&nus).zip(values) {
        let [h, mu, mu_sun, t] = x.map(f64::from);
        let want = reference::Ray { r: GROUND + h, mu, mu_sun, nu: f64::from(*nu) }.at(t);
        // Square of the distance, up to 1e12, rounds by 6e-8, over 2 R; the altitude itself.
        close("altitude", v[0], want.r - GROUND, 0.02 + 3e-7 * (want.r - GROUND).abs());
        close("mu", v[1], want.mu, 3e-7);
        close("mu_sun", v[2], want.mu_sun, 3e-7);
        assert_eq!(v[3], *nu);
    }
}

#[test]
fn distance_to_entry_is_zero_inside_and_negative_where_it_misses() {
    let inputs = pairs(&[5e4, 1e5, 1.5e5, 4e5, 1e7], &sines(400));
    let values = gpu("return vec4f(distance_to_entry(earth, x.x, x.y));", &inputs);
    for (x, v) in inputs.iter().zip(values) {
        let (r, mu) = (GROUND + f64::from(x[0]), f64::from(x[1]));
        let root = r * r * mu * mu + (TOP - r) * (TOP + r);
        if x[0] <= 1e5 {
            assert_eq!(v[0], 0.0);
        } else if mu >= 0.0 || root < 0.0 {
            assert!(v[0] < 0.0, "{x:?} gives {}", v[0]);
        } else {
            let grazing = 1.0 + (r * mu).abs() / root.sqrt();
            close(&format!("{x:?}"), v[0], -r * mu - root.sqrt(), 1e-6 * grazing * r);
        }
    }
}

#[test]
fn scattering_step_and_step_distance_lose_nothing_at_any_number_of_steps() {
    // A homogeneous medium: radiance is source / extinction (1 - e^-tau), whatever the steps.
    let mut inputs = Vec::new();
    for steps in 1..40 {
        for lowest in [0.0, 0.3, 1.0] {
            for tau in [1e-4, 0.05, 0.2, 5.0] {
                inputs.push([steps as f32, lowest, tau, 0.0]);
            }
        }
    }
    let body = "var light = Scattering(vec3f(0.0), vec3f(1.0));
        var start = 0.0;
        for (var i = 0u; i < u32(x.x); i++) {
            let end = step_distance(f32(i + 1u) / x.x, x.y * 1e5, 1e5);
            light = scattering_step(light, vec3f(1e-5), vec3f(x.z * 1e-5), end - start);
            start = end;
        }
        return vec4f(light.radiance.x, light.transmittance.x, start, 0.0);";
    for (x, v) in inputs.iter().zip(gpu(body, &inputs)) {
        let tau = f64::from(x[2]);
        let want = -(-tau).exp_m1() / tau;
        // Forty steps of 9 ULP each.
        close(&format!("radiance of {x:?}"), v[0], want, 3e-5 * want);
        close(&format!("transmittance of {x:?}"), v[1], (-tau).exp(), 3e-5);
        close(&format!("length of {x:?}"), v[2], 1e5, 0.05);
    }
}

#[test]
fn attenuated_length_is_smooth_where_its_series_ends() {
    let inputs: Vec<_> = (0..400).map(|i| [10f32.powf(0.02 * i as f32 - 6.0), 0.0, 0.0, 0.0]).collect();
    for (x, v) in inputs.iter().zip(gpu("return vec4f(attenuated_length(vec3f(x.x), 1.0), 0.0);", &inputs)) {
        let tau = f64::from(x[0]);
        // exp is good to 9 ULP, a difference of 0.1 to ten times that.
        close(&format!("{tau}"), v[0], -(-tau).exp_m1() / tau, 6e-6 * -(-tau).exp_m1() / tau);
    }
    assert_eq!(gpu("return vec4f(attenuated_length(vec3f(x.x), 7.0), 0.0);", &[[0.0; 4]])[0][0], 7.0);
}

#[test]
fn lowest_distance_is_the_foot_of_the_perpendicular() {
    let inputs = [[1e3, 0.2, 5e4, 0.0], [1e3, -0.01, 5e5, 0.0], [1e3, -0.5, 2e3, 0.0]];
    let values = gpu("return vec4f(lowest_distance(earth, x.x, x.y, x.z));", &inputs);
    close("upwards", values[0][0], 0.0, 0.0);
    close("grazing", values[1][0], 63_610.0, 0.01);
    close("into the ground", values[2][0], 2e3, 0.0);
}

#[test]
fn texel_from_unit_and_unit_from_texel_invert_each_other() {
    let inputs = pairs(&[0.0, 0.3, 1.0], &[2.0, 33.0, 256.0]);
    let body = "let u = texel_from_unit(x.x, x.y); return vec4f(u, unit_from_texel(u, x.y), 0.0, 0.0);";
    for (x, v) in inputs.iter().zip(gpu(body, &inputs)) {
        let (unit, size) = (f64::from(x[0]), f64::from(x[1]));
        close("texel", v[0], (0.5 + unit * (size - 1.0)) / size, 1e-7);
        close("unit", v[1], unit, 3e-7);
    }
}

#[test]
fn transmittance_uv_is_brunetons_and_transmittance_point_inverts_it() {
    let inputs = pairs(&ALTITUDES, &sines(100));
    let body = "let mu = max(x.y, horizon_mu(earth, x.x));
        let uv = transmittance_uv(earth, vec2f(256.0, 64.0), x.x, mu);
        return vec4f(uv, transmittance_point(earth, vec2f(256.0, 64.0), uv));";
    for (x, v) in inputs.iter().zip(gpu(body, &inputs)) {
        let r = GROUND + f64::from(x[0]);
        let (rho, whole) = ((r * r - GROUND * GROUND).sqrt(), (TOP * TOP - GROUND * GROUND).sqrt());
        let mu = f64::from(x[1]).max(-rho / r);
        let d = to_sphere(r, mu, TOP).expect("inside");
        let (near, far) = (TOP - r, rho + whole);
        close("u", v[0], (0.5 + (d - near) / (far - near) * 255.0) / 256.0, 2e-6);
        close("v", v[1], (0.5 + rho / whole * 63.0) / 64.0, 1e-6);
        close("altitude", v[2], f64::from(x[0]), 2e-6 * f64::from(x[0]) + 0.02);
        // At the top all rays upwards leave at once: no direction to find.
        if x[0] < 9.9e4 {
            // mu follows from the distance, which close to the zenith hardly depends on it.
            close(&format!("mu of {x:?}"), v[3], mu, 2e-3);
        }
    }
}

#[test]
fn transmittance_to_top_has_the_closed_form_at_the_zenith_and_the_reference_elsewhere() {
    // Columns: scale heights, cut off at the top; the tent's area.
    let columns = |c: usize, h: f64| {
        let scattering = [5.802e-6, 13.558e-6, 33.1e-6][c];
        let tent = [0.650e-6, 1.881e-6, 0.085e-6][c] * 15e3;
        scattering * 8e3 * ((-h / 8e3).exp() - (-100e3f64 / 8e3).exp())
            + 6.0 * 4.44e-6 * 1.2e3 * (-h / 1.2e3).exp()
            + tent
    };
    let inputs = pairs(&[0.0, 500.0, 5e3], &[1.0]);
    for (x, v) in
        inputs.iter().zip(gpu("return vec4f(transmittance_to_top(earth, x.x, x.y, 48u), 0.0);", &inputs))
    {
        for (c, got) in v.into_iter().take(3).enumerate() {
            let want = (-columns(c, f64::from(x[0]))).exp();
            // 48 midpoint steps; the rounding to a half float in the table is as large.
            close(&format!("zenith at {}", x[0]), got, want, 5e-4);
        }
    }
    let inputs = pairs(&ALTITUDES, &[1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.0]);
    for (x, v) in
        inputs.iter().zip(gpu("return vec4f(transmittance_to_top(earth, x.x, x.y, 48u), 0.0);", &inputs))
    {
        let want = Air::EARTH.transmittance(GROUND + f64::from(x[0]), f64::from(x[1]));
        for c in 0..3 {
            // 48 midpoint steps.
            close(&format!("{x:?} channel {c}"), v[c], want[c], 1e-3);
        }
    }
}

#[test]
fn sun_visibility_is_the_share_of_the_disc() {
    let radius = 0.004625;
    for h in [0.0, 1e3, 3e4] {
        let horizon = -(h * (2.0 * GROUND + h)).sqrt() / (GROUND + h);
        let width = radius * GROUND / (GROUND + h);
        let inputs: Vec<_> =
            (-12..=12).map(|i| [h as f32, (horizon + 0.1 * f64::from(i) * width) as f32, 0.0, 0.0]).collect();
        for (x, v) in inputs.iter().zip(gpu("return vec4f(sun_visibility(earth, x.x, x.y));", &inputs)) {
            let y = ((f64::from(x[1]) - horizon) / width).clamp(-1.0, 1.0);
            close("share", v[0], 0.5 + (y * (1.0 - y * y).sqrt() + y.asin()) / PI, 0.04);
        }
    }
}

#[test]
fn unit_from_mu_sun_rises_and_mu_sun_from_unit_inverts_it() {
    let inputs: Vec<_> = sines(200).iter().map(|&mu| [mu, 0.0, 0.0, 0.0]).collect();
    let values =
        gpu("let u = unit_from_mu_sun(x.x); return vec4f(u, mu_sun_from_unit(u), 0.0, 0.0);", &inputs);
    for (end, wanted) in [(0, 0.0), (200, 1.0)] {
        // WGSL lets a division be 2.5 last places of 0.8 off.
        close("end", values[end][0], wanted, 2e-7);
    }
    assert!(values.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    for (x, v) in inputs.iter().zip(values) {
        close("mu", v[1], f64::from(x[0]), 2e-6);
    }
}

#[test]
fn multiple_uv_and_multiple_point_invert_each_other() {
    let inputs = pairs(&ALTITUDES, &sines(40));
    let body = "let uv = multiple_uv(earth, vec2f(32.0, 16.0), x.x, x.y);
        return vec4f(multiple_point(earth, vec2f(32.0, 16.0), uv), uv);";
    for (x, v) in inputs.iter().zip(gpu(body, &inputs)) {
        close("altitude", v[0], f64::from(x[0]), 1e-5 * f64::from(x[0]) + 0.05);
        close("mu", v[1], f64::from(x[1]), 1e-5);
        assert!(v[2] > 0.0 && v[2] < 1.0 && v[3] > 0.0 && v[3] < 1.0);
    }
}

#[test]
fn sky_view_uv_keeps_its_half_and_sky_view_point_inverts_it() {
    let size = "vec2f(192.0, 128.0)";
    for h in [0.0f32, 2.0, 1e4, 1e5, 1e6] {
        let inputs = pairs(&sines(300), &[0.0, 0.4, 1.0]);
        let body = format!(
            "let ground = x.x < horizon_mu(earth, {h:e});
             let uv = sky_view_uv(earth, {size}, {h:e}, x.x, x.y, ground);
             return vec4f(sky_view_point(earth, {size}, {h:e}, uv), uv.y);"
        );
        for (x, v) in inputs.iter().zip(gpu(&body, &inputs)) {
            // Half angles: cosines near 1 have lost half their digits.
            close(&format!("mu {x:?} at {h}"), v[0], f64::from(x[0]), 2e-6);
            close("sine", v[1], f64::from(x[1]), 1e-6);
            // Half a texel off the middle, where the other half begins.
            let texel = 0.5 / 128.0 - 1e-6;
            assert!(if v[2] > 0.5 { v[3] >= 0.5 + texel } else { v[3] <= 0.5 - texel }, "{x:?}: {v:?}");
        }
    }
}

#[test]
fn half_azimuth_sine_and_sky_view_ray_give_back_the_angle_to_the_sun() {
    let mut inputs = Vec::new();
    for (elevation, sun, azimuth) in
        [(0.2, 0.5, 0.0), (0.2, 0.5, 1.0), (-0.4, -0.1, 3.0), (1.5, 0.3, 2.0), (0.0, 1.5, PI)]
    {
        let unit =
            |e: f64, a: f64| [(e.cos() * a.sin()) as f32, e.sin() as f32, (-e.cos() * a.cos()) as f32, 0.0];
        inputs.push([unit(elevation, 0.7 + azimuth), unit(sun, 0.7)]);
        inputs.push([unit(PI / 2.0, 0.0), unit(sun, 0.7)]);
    }
    let body = "let sine = half_azimuth_sine(x[0].xyz, x[1].xyz);
        return vec4f(sine, sky_view_ray(0.0, x[0].y, sine, x[1].y).nu, 0.0, 0.0);";
    for (x, v) in inputs.iter().zip(evaluate_with("atmosphere", "", body, &inputs)) {
        let dot: f64 = (0..3).map(|c| f64::from(x[0][c]) * f64::from(x[1][c])).sum();
        close(&format!("{x:?}"), v[1], dot, 1e-6);
        assert!((0.0..=1.0).contains(&v[0]));
    }
}

#[test]
fn light_texel_holds_from_dusk_to_the_brightest_scene() {
    let inputs: Vec<_> = (-8..=6).map(|e| [0.2, 1.0, 0.7].map(|c: f32| c * 10f32.powi(e))).collect();
    let vectors: Vec<_> = inputs.iter().map(|v| [v[0], v[1], v[2], 0.0]).collect();
    for (x, v) in vectors.iter().zip(gpu("return light_texel(x.xyz);", &vectors)) {
        let half = v.map(|c| half::f16::from_f32(c).to_f32());
        for c in 0..3 {
            close(&format!("{x:?}"), half[c] * half[3], f64::from(x[c]), 1e-3 * f64::from(x[c]));
        }
    }
    assert_eq!(gpu("return light_texel(vec3f(0.0));", &[[0.0; 4]])[0][..3], [0.0; 3]);
}

#[test]
fn aerial_distance_ends_at_the_farthest() {
    let inputs = pairs(&[0.0, 15.0, 31.0], &[32.0]);
    let values = gpu("return vec4f(aerial_distance(x.x, x.y, 6e4));", &inputs);
    for (v, want) in values.iter().zip([6e4 / 1024.0, 15e3, 6e4]) {
        close("slice", v[0], want, 1e-2);
    }
}
