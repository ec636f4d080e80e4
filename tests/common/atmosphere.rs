//! The atmosphere in f64, written from Hillaire (2020) and Bruneton and Neyret (2008)
//! with brute quadrature: radii instead of altitudes, angles instead of tables.

use std::f64::consts::PI;

pub type Rgb = [f64; 3];

/// Radius of the Earth and of the top of the atmosphere, metres.
pub const GROUND: f64 = 6_360_000.0;
pub const TOP: f64 = 6_460_000.0;

#[derive(Clone, Copy)]
pub struct Air {
    pub haze: f64,
    pub ozone: f64,
    pub albedo: Rgb,
    /// Angular radius of the sun, rad.
    pub sun_radius: f64,
}

impl Air {
    pub const EARTH: Self = Self { haze: 6.0, ozone: 1.0, albedo: [0.0; 3], sun_radius: 0.004625 };

    /// Rayleigh scattering, Mie scattering, extinction at altitude `h`, 1/m.
    pub fn medium(&self, h: f64) -> (Rgb, f64, Rgb) {
        let rayleigh = [5.802e-6, 13.558e-6, 33.1e-6].map(|s| s * (-h / 8000.0).exp());
        let haze = self.haze * (-h / 1200.0).exp();
        let tent = self.ozone * (1.0 - (h - 25_000.0).abs() / 15_000.0).max(0.0);
        let ozone = [0.650e-6, 1.881e-6, 0.085e-6].map(|s| s * tent);
        let extinction = std::array::from_fn(|c| rayleigh[c] + 4.44e-6 * haze + ozone[c]);
        (rayleigh, 4.316e-6 * haze, extinction)
    }

    /// Optical depth of the first `length` metres of a ray, composite Simpson.
    pub fn depth(&self, r: f64, mu: f64, length: f64, steps: usize) -> Rgb {
        let mut sum = [0.0; 3];
        // Fine about the lowest point, the thickest air.
        let low = (-r * mu).clamp(0.0, length);
        for (from, to) in [(low, 0.0), (low, length)] {
            for i in 0..=2 * steps {
                let x = i as f64 / (2 * steps) as f64;
                let weight = match i {
                    0 => 1.0,
                    _ if i == 2 * steps => 1.0,
                    _ => 2.0 + 2.0 * (i % 2) as f64,
                } / (6 * steps) as f64;
                let t = from + (to - from) * x * x;
                let h = (r * r + t * t + 2.0 * r * mu * t).sqrt() - GROUND;
                let jacobian = 2.0 * x * (to - from).abs();
                let extinction = self.medium(h.max(0.0)).2;
                sum = std::array::from_fn(|c| sum[c] + weight * jacobian * extinction[c]);
            }
        }
        sum
    }

    pub fn transmittance(&self, r: f64, mu: f64) -> Rgb {
        self.depth(r, mu, to_sphere(r, mu, TOP).unwrap_or(0.0), 64).map(|depth| (-depth).exp())
    }

    /// Irradiance across the sun's light, the disc cut by the horizon.
    pub fn sun(&self, r: f64, mu_sun: f64) -> Rgb {
        let horizon = -(1.0 - (GROUND / r).powi(2)).max(0.0).sqrt();
        let x = ((mu_sun - horizon) * r / GROUND / self.sun_radius).clamp(-1.0, 1.0);
        let share = 0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI;
        if share == 0.0 {
            return [0.0; 3];
        }
        let length = to_sphere(r, mu_sun.max(horizon), TOP).unwrap_or(0.0);
        self.depth(r, mu_sun.max(horizon), length, 12).map(|depth| share * (-depth).exp())
    }

    /// Light of a ray from inside, and where it ends: radiance with a source function
    /// per metre, transmittance, length.
    pub fn march(
        &self,
        ray: Ray,
        length: f64,
        steps: usize,
        mut source: impl FnMut(Ray, Rgb, f64) -> Rgb,
    ) -> (Rgb, Rgb) {
        let (mut radiance, mut depth) = ([0.0; 3], [0.0; 3]);
        let low = (-ray.r * ray.mu).clamp(0.0, length);
        for (from, to) in [(0.0, low), (low, length)] {
            if to - from < 1e-6 {
                continue;
            }
            for i in 0..steps {
                // Fine at both ends.
                let at = |x: f64| from + (to - from) * x * x * (3.0 - 2.0 * x);
                let (start, end) = (at(i as f64 / steps as f64), at((i + 1) as f64 / steps as f64));
                let here = ray.at(0.5 * (start + end));
                let (rayleigh, mie, extinction) = self.medium((here.r - GROUND).max(0.0));
                let light = source(here, rayleigh, mie);
                for c in 0..3 {
                    let tau = extinction[c] * (end - start);
                    radiance[c] += light[c] * (end - start) * (-depth[c] - 0.5 * tau).exp();
                    depth[c] += tau;
                }
            }
        }
        (radiance, depth.map(|depth| (-depth).exp()))
    }
}

/// A ray by its radius, the cosines of its and the sun's zenith angle, and of the angle
/// between both.
#[derive(Clone, Copy)]
pub struct Ray {
    pub r: f64,
    pub mu: f64,
    pub mu_sun: f64,
    pub nu: f64,
}

impl Ray {
    pub fn new(r: f64, mu: f64, mu_sun: f64, azimuth: f64) -> Self {
        let level = ((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun)).max(0.0).sqrt();
        Self { r, mu, mu_sun, nu: mu * mu_sun + level * azimuth.cos() }
    }

    pub fn at(self, t: f64) -> Self {
        let r = (self.r * self.r + t * t + 2.0 * self.r * self.mu * t).sqrt();
        Self {
            r,
            mu: (self.r * self.mu + t) / r,
            mu_sun: (self.r * self.mu_sun + t * self.nu) / r,
            nu: self.nu,
        }
    }

    /// Length inside the atmosphere, and whether the ground ends it.
    pub fn length(self) -> (f64, bool) {
        let horizon = -(1.0 - (GROUND / self.r).powi(2)).max(0.0).sqrt();
        if self.mu < horizon {
            let across = self.r * self.mu;
            let square = (self.r - GROUND) * (self.r + GROUND);
            return (square / ((across * across - square).max(0.0).sqrt() - across), true);
        }
        (to_sphere(self.r, self.mu, TOP).unwrap_or(0.0), false)
    }
}

/// Farther crossing of a ray with a sphere about the Earth's centre.
pub fn to_sphere(r: f64, mu: f64, radius: f64) -> Option<f64> {
    let root = r * r * mu * mu + (radius - r) * (radius + r);
    (root >= 0.0).then(|| root.sqrt() - r * mu)
}

pub fn rayleigh_phase(nu: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + nu * nu)
}

/// Cornette and Shanks (1992).
pub fn haze_phase(g: f64, nu: f64) -> f64 {
    3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + nu * nu)
        / ((2.0 + g * g) * (1.0 + g * g - 2.0 * g * nu).powf(1.5))
}

/// Light scattered twice and more [Hillaire 2020, 5.5], on a grid of altitudes and sun
/// zenith angles that is finer than what it is compared with.
pub struct Multiple {
    values: Vec<Rgb>,
}

const ALTITUDES: usize = 20;
const SUNS: usize = 40;

impl Multiple {
    pub fn new(air: &Air) -> Self {
        let values = (0..ALTITUDES * SUNS)
            .map(|i| {
                let h = 100e3 * ((i / SUNS) as f64 / (ALTITUDES - 1) as f64).powi(3);
                Self::solve(air, GROUND + h.max(1e-3), Self::mu_sun((i % SUNS) as f64))
            })
            .collect();
        Self { values }
    }

    /// Evenly spaced in the cube root: fine about the horizon.
    fn mu_sun(i: f64) -> f64 {
        (2.0 * i / (SUNS - 1) as f64 - 1.0).powi(3)
    }

    fn solve(air: &Air, r: f64, mu_sun: f64) -> Rgb {
        let (rings, places) = (8, 8);
        let (mut second, mut again) = ([0.0; 3], [0.0; 3]);
        for i in 0..rings * places {
            let mu = 2.0 * ((i / places) as f64 + 0.5) / rings as f64 - 1.0;
            let ray = Ray::new(r, mu, mu_sun, PI * ((i % places) as f64 + 0.5) / places as f64);
            let (length, ground) = ray.length();
            let (once, through) = air.march(ray, length, 16, |here, rayleigh, mie| {
                let sun = air.sun(here.r, here.mu_sun);
                std::array::from_fn(|c| sun[c] * (rayleigh[c] + mie) / (4.0 * PI))
            });
            let (share, _) = air.march(ray, length, 16, |_, rayleigh, mie| rayleigh.map(|s| s + mie));
            let foot = ray.at(length).mu_sun.max(0.0);
            let lit = if ground { air.sun(GROUND, foot) } else { [0.0; 3] };
            for c in 0..3 {
                second[c] += once[c] + air.albedo[c] / PI * foot * lit[c] * through[c];
                again[c] += share[c];
            }
        }
        let count = (rings * places) as f64;
        std::array::from_fn(|c| second[c] / count / (1.0 - again[c] / count))
    }

    pub fn at(&self, r: f64, mu_sun: f64) -> Rgb {
        let y = ((r - GROUND).clamp(0.0, 100e3) / 100e3).cbrt() * (ALTITUDES - 1) as f64;
        let x = (0.5 * mu_sun.cbrt() + 0.5) * (SUNS - 1) as f64;
        let (i, j) = ((y as usize).min(ALTITUDES - 2), (x as usize).min(SUNS - 2));
        let (v, u) = (y - i as f64, x - j as f64);
        std::array::from_fn(|c| {
            let value = |i: usize, j: usize| self.values[i * SUNS + j][c];
            let row = |i| value(i, j) * (1.0 - u) + value(i, j + 1) * u;
            row(i) * (1.0 - v) + row(i + 1) * v
        })
    }
}

/// Radiance of the air along `ray`, and its transmittance.
pub fn air_light(air: &Air, multiple: &Multiple, ray: Ray, length: f64, steps: usize) -> (Rgb, Rgb) {
    let (single, haze) = (rayleigh_phase(ray.nu), haze_phase(0.7, ray.nu));
    air.march(ray, length, steps, |here, rayleigh, mie| {
        let (sun, again) = (air.sun(here.r, here.mu_sun), multiple.at(here.r, here.mu_sun));
        std::array::from_fn(|c| sun[c] * (rayleigh[c] * single + mie * haze) + again[c] * (rayleigh[c] + mie))
    })
}

/// Irradiance of the ground by sun and sky.
pub fn ground_irradiance(air: &Air, multiple: &Multiple, mu_sun: f64) -> Rgb {
    let (rings, places) = (16, 16);
    let mut sky = [0.0; 3];
    for i in 0..rings * places {
        let mu = (((i / places) as f64 + 0.5) / rings as f64).sqrt();
        let azimuth = PI * ((i % places) as f64 + 0.5) / places as f64;
        let ray = Ray::new(GROUND + 1e-3, mu, mu_sun, azimuth);
        let (light, _) = air_light(air, multiple, ray, ray.length().0, 24);
        sky = std::array::from_fn(|c| sky[c] + PI * light[c] / (rings * places) as f64);
    }
    let sun = air.sun(GROUND + 1e-3, mu_sun);
    std::array::from_fn(|c| sky[c] + mu_sun.max(0.0) * sun[c])
}

/// Radiance of sky and ground along `ray` from inside the atmosphere.
pub fn sky_radiance(air: &Air, multiple: &Multiple, ray: Ray) -> Rgb {
    let (length, ground) = ray.length();
    let (light, through) = air_light(air, multiple, ray, length, 64);
    let foot = ray.at(length).mu_sun;
    let lit =
        if ground && air.albedo != [0.0; 3] { ground_irradiance(air, multiple, foot) } else { [0.0; 3] };
    std::array::from_fn(|c| light[c] + air.albedo[c] / PI * lit[c] * through[c])
}
