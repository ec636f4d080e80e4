//! Closed forms in f64 that references use, and their definitions: integrals, a differential
//! equation and a series, against which a test holds them.

use std::f64::consts::PI;

/// s(x) of [K 3.2]: s(0) = 0, s(1) = 1, s' proportional to x^2 (1-x)^2.
pub fn rise(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x)
}

/// Mean of e^{-s} for s between `a` and `b`.
pub fn mean_transmittance(a: f64, b: f64) -> f64 {
    let (least, x) = (a.min(b), (b - a).abs());
    (-least).exp() * if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}

/// Mean of the sun's e^{-depth} along a piece of a ray, weighted by what gets through the piece
/// from there.
pub fn sunlight_share(depth: f64, before: f64, after: f64) -> f64 {
    mean_transmittance(before, depth + after) / mean_transmittance(0.0, depth)
}

/// Henyey and Greenstein's phase function, 1/sr.
pub fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    let squared = (1.0 - g.abs()).powi(2) + 2.0 * g.abs() * (1.0 - cosine * g.signum());
    (1.0 - g) * (1.0 + g) / (4.0 * PI * squared.powf(1.5))
}

/// Source of a conservative slab under a beam by Eddington's equations, 1/sr: asymmetry `g`, sun
/// cosine, depth, thickness, view cosine. The flux is constant but for the beam, and no diffuse
/// light enters through either face.
pub fn eddington(g: f64, mu0: f64, depth: f64, thickness: f64, nu: f64) -> f64 {
    let f = g.max(0.0).powi(2);
    let g1 = (g - f) / (1.0 - f);
    let (t, total) = ((1.0 - f) * depth, (1.0 - f) * thickness);
    let lost = |t: f64| -(-t / mu0).exp_m1();
    // What leaves through the lit face, of the irradiance across the beam; the net flux is the rest.
    let resistance = 4.0 / 3.0 + (1.0 - g1) * total;
    let back = mu0 * ((1.0 - g1) * total - (mu0 - 2.0 / 3.0) * lost(total)) / resistance;
    let net = mu0 * ((2.0 / 3.0 + mu0) + (2.0 / 3.0 - mu0) * (1.0 - lost(total))) / resistance;
    let i1 = mu0 * lost(t) - back;
    let i0 = if total < 1.0 {
        // From the lit face.
        2.0 / 3.0 * back - (1.0 - g1) * net * t + mu0 * mu0 * lost(t)
    } else {
        // From the far face.
        net * (2.0 / 3.0 + (1.0 - g1) * (total - t)) - mu0 * mu0 * (-t / mu0).exp()
            + mu0 * (mu0 - 2.0 / 3.0) * (-total / mu0).exp()
    };
    3.0 / (4.0 * PI) * (i0 + g * nu * i1).max(0.0)
}

/// Mean of a function over [0, 1].
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

fn close(got: f64, wanted: f64, relative: f64, what: &str) {
    assert!((got - wanted).abs() <= relative * wanted.abs() + 1e-12, "{what}: {got} for {wanted}");
}

#[test]
fn rise_is_the_integral_of_its_slope() {
    for x in [1e-3, 0.2, 0.5, 0.9, 1.0] {
        close(rise(x), 30.0 * x * mean(|y| (x * y * (1.0 - x * y)).powi(2)), 1e-6, "rise");
    }
}

#[test]
fn mean_transmittance_and_sunlight_share_are_means() {
    for depth in [0.0, 1e-3, 0.3, 5.0] {
        for before in [0.0, 0.3, 9.0] {
            for after in [0.0, 0.31, 4.0, 9.0] {
                let between = |share: f64| (-before - share * (after - before)).exp();
                close(mean_transmittance(before, after), mean(between), 1e-5, "mean transmittance");
                let through = |share: f64| (-share * depth).exp();
                let wanted = mean(|share| through(share) * between(share)) / mean(through);
                close(sunlight_share(depth, before, after), wanted, 1e-5, "sunlight share");
            }
        }
    }
}

#[test]
fn henyey_greenstein_has_its_legendre_series() {
    // (2 l + 1) / (4 pi) g^l P_l.
    for g in [-0.5f64, 0.0, 0.3, 0.73] {
        for cosine in [-1.0, -0.2, 0.0, 0.9, 1.0] {
            let (mut before, mut here, mut sum) = (0.0, 1.0, 0.0);
            for l in 0..200 {
                let n = f64::from(l);
                sum += (2.0 * n + 1.0) / (4.0 * PI) * g.powi(l) * here;
                (before, here) = (here, ((2.0 * n + 1.0) * cosine * here - n * before) / (n + 1.0));
            }
            close(henyey_greenstein(g, cosine), sum, 1e-10, "phase");
        }
    }
}

/// Eddington's equations by shooting: integrated from the lit face with RK4 for two guesses of
/// the flux there, then combined so that no diffuse light comes in through the far face.
fn shot(g: f64, mu0: f64, depth: f64, thickness: f64, nu: f64) -> f64 {
    let f = g.max(0.0).powi(2);
    let g1 = (g - f) / (1.0 - f);
    let (t, total) = ((1.0 - f) * depth, (1.0 - f) * thickness);
    let c = 3.0 / (4.0 * PI);
    let slope = |t: f64, [_, i1]: [f64; 2]| {
        let beam = (-t / mu0).exp();
        // Energy: the diffuse flux gains what the beam loses. Momentum: what scattering turns.
        [-(1.0 - g1) * i1 + c * g1 * mu0 * beam, c * beam]
    };
    let integrate = |i1: f64, end: f64| {
        let n = 4000;
        let h = end / f64::from(n);
        let mut state = [-2.0 / 3.0 * i1, i1];
        for i in 0..n {
            let t = f64::from(i) * h;
            let add = |s: [f64; 2], k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
            let k1 = slope(t, state);
            let k2 = slope(t + h / 2.0, add(state, k1, h / 2.0));
            let k3 = slope(t + h / 2.0, add(state, k2, h / 2.0));
            let k4 = slope(t + h, add(state, k3, h));
            for j in 0..2 {
                state[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
            }
        }
        state
    };
    let leak = |i1: f64| {
        let [i0, i1] = integrate(i1, total);
        i0 - 2.0 / 3.0 * i1
    };
    let (a, b) = (leak(0.0), leak(1.0));
    let [i0, i1] = integrate(-a / (b - a), t);
    // Scattering of I0 + nu I1 by a phase function of asymmetry g.
    (i0 + g * nu * i1).max(0.0)
}

#[test]
fn eddington_solves_its_equations() {
    for g in [-0.6, 0.0, 0.73, 0.9] {
        for mu0 in [0.2, 0.7, 1.0] {
            for (depth, thickness) in
                [(0.0, 1e-3), (5e-4, 1e-3), (0.5, 0.5), (0.0, 5.0), (5.0, 5.0), (5.0, 30.0)]
            {
                let wanted = shot(g, mu0, depth, thickness, 0.6);
                close(eddington(g, mu0, depth, thickness, 0.6), wanted, 1e-6, "source");
            }
        }
    }
}
