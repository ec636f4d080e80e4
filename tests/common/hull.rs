//! Clouds without noise in f64, from the definition: what is at a point, and along a ray.

use glam::{DMat3, DVec3};
use nephos::scene::{Cloud, Ellipsoid};

use super::constants::{constant, constants};

/// s(x) of [K 3.2].
pub fn smooth_rise(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x)
}

/// First-order depth below an ellipsoid's surface, m.
pub fn depth_in(e: &Ellipsoid, p: DVec3) -> f64 {
    let u = DMat3::from_quat(e.orientation).transpose() * (p - e.center) / e.radii;
    if u.length() < 1e-9 {
        return e.radii.min_element();
    }
    (1.0 - u.length()) * u.length() / (u / e.radii).length()
}

/// Depth, extinction, boundary and wispiness below the hull of a cloud's lumps.
#[derive(Debug, Clone, Copy)]
pub struct Edge {
    pub depth: f64,
    pub extinction: f64,
    pub boundary: f64,
    pub wispiness: f64,
}

/// The exponent that a blend stands for: from creases to one smooth body.
pub fn power(blend: f64) -> f64 {
    8.0 - 6.0 * blend
}

/// The norm of depths, and means weighted by their powers; none outside.
pub fn edge_at(cloud: &Cloud, p: DVec3) -> Option<Edge> {
    let power = power(cloud.blend);
    let inside: Vec<_> =
        cloud.ellipsoids.iter().map(|e| (e, depth_in(e, p))).filter(|(_, d)| *d > 0.0).collect();
    let deepest = inside.iter().map(|(_, d)| *d).fold(0.0, f64::max);
    // Told in the deepest, so that no power is too large.
    let weigh = |d: f64| (d / deepest).powf(power);
    let whole: f64 = inside.iter().map(|(_, d)| weigh(*d)).sum();
    let mean =
        |f: &dyn Fn(&Ellipsoid) -> f64| inside.iter().map(|(e, d)| weigh(*d) * f(e)).sum::<f64>() / whole;
    (!inside.is_empty()).then(|| Edge {
        depth: deepest * whole.powf(1.0 / power),
        extinction: cloud.droplets.extinction() * mean(&|e| e.density),
        boundary: mean(&|e| cloud.edge_of(e).boundary),
        wispiness: mean(&|e| cloud.edge_of(e).wispiness),
    })
}

/// Extinction where the noise is `noise` all over, 1/m.
pub fn extinction_at(cloud: &Cloud, noise: f64, p: DVec3) -> f64 {
    let Some(edge) = edge_at(cloud, p) else { return 0.0 };
    let [billows, wisps] = constants("density", "RISE")[..] else { panic!("of billows and of wisps") };
    let low = constant("density", "LEVELLING") * cloud.level.map_or(f64::INFINITY, |level| p.y - level);
    let edge = Edge { depth: edge.depth.min(low), ..edge };
    let rise = (edge.boundary * (billows + (wisps - billows) * edge.wispiness)).max(1e-3);
    let depth = edge.depth - 0.5 * (edge.boundary - rise).max(0.0) * (1.0 - noise);
    let (low, high) = cloud.bounds().expect("there is a lump");
    let height = ((p.y - low.y) / (high.y - low.y)).clamp(0.0, 1.0);
    let profile = 1.0 - cloud.stratification * (1.0 - height.cbrt().powi(2));
    let rim = (constant("density", "DILUTED") - 1.0) * edge.boundary.max(1e-3);
    let kept = 1.0 - cloud.dilution * (1.0 - smooth_rise(depth / rim));
    edge.extinction * profile * kept * smooth_rise(depth / rise)
}

/// Optical depth from `from` to `to`, by so many samples.
pub fn optical_depth(cloud: &Cloud, noise: f64, from: DVec3, to: DVec3, samples: u32) -> f64 {
    let step = (to - from) / f64::from(samples);
    let sum: f64 =
        (0..samples).map(|i| extinction_at(cloud, noise, from + step * (f64::from(i) + 0.5))).sum();
    step.length() * sum
}
