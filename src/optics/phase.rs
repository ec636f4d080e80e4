//! Phase functions: how much light leaves a scattering by which angle.

use std::f64::consts::{FRAC_1_PI, PI};

use super::{ice, rain};
use crate::{
    Error, Result,
    scene::{self, Habit, Species},
};

/// A phase function of the three channels, in 1/sr, integrating to 1 over the
/// sphere.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Phase {
    /// The same in all directions.
    Isotropic,
    /// Henyey and Greenstein's, the same for all channels.
    HenyeyGreenstein {
        /// Mean cosine of the scattering angle, between -1 and 1.
        g: f64,
    },
    /// Tabulated for each channel, as Lorenz-Mie phase functions are.
    Tabulated(Box<[Tabulated; 3]>),
}

impl Phase {
    /// Henyey-Greenstein with mean cosine `g`, which must lie between -1 and 1.
    pub fn henyey_greenstein(g: f64) -> Result<Self> {
        if g.abs() < 1.0 {
            Ok(Self::HenyeyGreenstein { g })
        } else {
            Err(Error::Argument(format!(
                "an asymmetry of {g} is no phase function: give one between -1 and 1"
            )))
        }
    }

    /// Water droplets of an effective radius in micrometres between 4 and 20,
    /// from the embedded table: [`crate::tables::mie`].
    pub fn mie(effective_radius_um: f64) -> Result<Self> {
        let table = crate::tables::mie(effective_radius_um)?;
        let channel = |i: usize| Tabulated::new(table.theta.clone(), table.phase[i].clone());
        Ok(Self::Tabulated(Box::new([channel(0)?, channel(1)?, channel(2)?])))
    }

    /// That of a cloud's droplets, or what else it is made of.
    ///
    /// # Errors
    /// Where effective radius or asymmetry is out of its range.
    pub fn of(droplets: &scene::Droplets) -> Result<Self> {
        match droplets.phase {
            scene::Phase::Mie => Self::of_species(droplets),
            scene::Phase::HenyeyGreenstein { g } => Self::henyey_greenstein(g),
            scene::Phase::Isotropic => Ok(Self::Isotropic),
        }
    }

    fn of_species(droplets: &scene::Droplets) -> Result<Self> {
        let radius_um = droplets.effective_radius_um;
        let kind = match (droplets.species, droplets.habit) {
            (Species::Water, _) => return Self::mie(radius_um),
            (Species::Rain, _) => return Ok(Self::Tabulated(Box::new(rain::phase(radius_um)?))),
            (Species::Ice, Habit::Columns) => ice::Kind::Columns,
            (Species::Ice, Habit::Plates) => ice::Kind::Plates,
            (Species::Snow, _) => ice::Kind::Snow,
            (Species::Graupel, _) => ice::Kind::Graupel,
        };
        Ok(Self::Tabulated(Box::new(ice::phase(kind, radius_um, droplets.roughness)?)))
    }

    /// Value in 1/sr of a channel (0 red, 1 green, 2 blue) at scattering angle
    /// `theta` in radians, 0 to pi.
    pub fn value(&self, channel: usize, theta: f64) -> f64 {
        match self {
            Self::Isotropic => 0.25 * FRAC_1_PI,
            Self::HenyeyGreenstein { g } => henyey_greenstein(*g, theta),
            Self::Tabulated(channels) => channels[channel].value(theta),
        }
    }

    /// Mean cosine of the scattering angle of a channel.
    pub fn asymmetry(&self, channel: usize) -> f64 {
        match self {
            Self::Isotropic => 0.0,
            Self::HenyeyGreenstein { g } => *g,
            Self::Tabulated(channels) => channels[channel].asymmetry(),
        }
    }
}

/// Henyey and Greenstein's phase function in 1/sr, of mean cosine `g`, at
/// `theta` in radians: Astrophysical Journal 93 (1941), eq. 2, normalised to 1.
///
/// 1 + g^2 - 2 g cos theta is written as (1 - g)^2 + 4 g sin^2(theta / 2), which
/// keeps its digits near the peak.
pub fn henyey_greenstein(g: f64, theta: f64) -> f64 {
    let half_sine = (0.5 * theta).sin();
    let distance_squared = (1.0 - g).powi(2) + 4.0 * g * half_sine * half_sine;
    0.25 * FRAC_1_PI * (1.0 - g * g) / distance_squared.powf(1.5)
}

/// The scattering angle, rad, at coordinate `u` from 0 to 1 of a table that is even in the
/// square root of the angle up to the middle and mirrored beyond: dense at the forward peak
/// and at the glory. The inverse of `phase_coordinate` in `shaders/lib/phase.wgsl`.
pub fn angle_at(u: f64) -> f64 {
    let from_end = 2.0 * u.min(1.0 - u).powi(2) * PI;
    if u < 0.5 { from_end } else { PI - from_end }
}

/// A phase function known at some angles, its logarithm linear in the angle
/// between them. Integrals are exact for this interpolant, so that what is
/// normalised here is normalised for whoever interpolates in the same way.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    theta: Vec<f64>,
    ln_value: Vec<f64>,
    /// Share of the light scattered by less than each angle.
    within: Vec<f64>,
    /// The same integral with the cosine of the angle as a weight.
    cosine_within: Vec<f64>,
}

impl Tabulated {
    /// A phase function with `value`s at angles `theta` in radians, rising from
    /// 0 to pi. The values are positive, in any unit: they are scaled to
    /// integrate to 1 over the sphere.
    pub fn new(theta: Vec<f64>, value: Vec<f64>) -> Result<Self> {
        check_grid(&theta)?;
        check_values(&value, theta.len())?;
        let mut table = Self {
            ln_value: value.iter().map(|value| value.ln()).collect(),
            within: Vec::with_capacity(theta.len()),
            cosine_within: Vec::with_capacity(theta.len()),
            theta,
        };
        table.integrate();
        Ok(table)
    }

    /// Fills the running integrals and scales everything to a total of 1.
    fn integrate(&mut self) {
        let (mut within, mut cosine_within) = (0.0, 0.0);
        self.within.push(within);
        self.cosine_within.push(cosine_within);
        for i in 0..self.theta.len() - 1 {
            let (share, cosine) = self.segment(i, self.theta[i + 1]);
            within += share;
            cosine_within += cosine;
            self.within.push(within);
            self.cosine_within.push(cosine_within);
        }
        let ln_total = within.ln();
        self.ln_value.iter_mut().for_each(|ln_value| *ln_value -= ln_total);
        self.within.iter_mut().for_each(|share| *share /= within);
        self.cosine_within.iter_mut().for_each(|cosine| *cosine /= within);
    }

    /// Angles of the table in radians, from 0 to pi.
    pub fn theta(&self) -> &[f64] {
        &self.theta
    }

    /// Normalised values in 1/sr at the angles of the table.
    pub fn values(&self) -> Vec<f64> {
        self.ln_value.iter().map(|ln_value| ln_value.exp()).collect()
    }

    /// Value in 1/sr at `theta` in radians; beyond 0 and pi, that at the end.
    pub fn value(&self, theta: f64) -> f64 {
        let theta = theta.clamp(0.0, PI);
        let i = self.segment_at(theta);
        (self.ln_value[i] + self.slope(i) * (theta - self.theta[i])).exp()
    }

    /// Mean cosine of the scattering angle.
    pub fn asymmetry(&self) -> f64 {
        self.cosine_within(PI)
    }

    /// Share of the light, 0 to 1, that is scattered by less than `theta` radians.
    pub fn within(&self, theta: f64) -> f64 {
        let i = self.segment_at(theta);
        self.within[i] + self.segment(i, theta).0
    }

    /// The integral of cos(theta) P over directions within `theta` radians of straight on.
    pub fn cosine_within(&self, theta: f64) -> f64 {
        let i = self.segment_at(theta);
        self.cosine_within[i] + self.segment(i, theta).1
    }

    /// Index of the stretch between two angles of the table that holds `theta`.
    fn segment_at(&self, theta: f64) -> usize {
        let above = self.theta.partition_point(|&angle| angle <= theta);
        above.clamp(1, self.theta.len() - 1) - 1
    }

    /// d ln P / d theta in stretch i.
    fn slope(&self, i: usize) -> f64 {
        (self.ln_value[i + 1] - self.ln_value[i]) / (self.theta[i + 1] - self.theta[i])
    }

    /// Integrals of P and of cos(theta) P over the solid angle between the
    /// start of stretch i and the angle `end` in it, by their antiderivatives
    ///
    /// int e^(b t) sin t dt = e^(b t) (b sin t - cos t) / (b^2 + 1),
    /// int e^(b t) sin 2t / 2 dt = e^(b t) (b sin 2t / 2 - cos 2t) / (b^2 + 4).
    fn segment(&self, i: usize, end: f64) -> (f64, f64) {
        let start = self.theta[i];
        let b = self.slope(i);
        let scale = 2.0 * PI * self.ln_value[i].exp();
        let growth = (b * (end - start)).exp();
        let share = |t: f64| b * t.sin() - t.cos();
        let cosine = |t: f64| 0.5 * b * (2.0 * t).sin() - (2.0 * t).cos();
        (
            scale * (growth * share(end) - share(start)) / (b * b + 1.0),
            scale * (growth * cosine(end) - cosine(start)) / (b * b + 4.0),
        )
    }
}

/// The angles must cover the half turn, in rising order.
fn check_grid(theta: &[f64]) -> Result<()> {
    let rising = theta.windows(2).all(|pair| pair[0] < pair[1]);
    let ends = theta.first().zip(theta.last());
    if rising && ends.is_some_and(|(&first, &last)| first == 0.0 && last == PI) {
        return Ok(());
    }
    Err(Error::Argument("the angles of a phase function must rise from 0 to pi radians".to_owned()))
}

/// The values must be as many as the angles, finite and positive.
fn check_values(value: &[f64], angles: usize) -> Result<()> {
    if value.len() != angles {
        return Err(Error::Argument(format!(
            "a phase function has {} values at {angles} angles: give one for each",
            value.len()
        )));
    }
    match value.iter().find(|value| !(value.is_finite() && **value > 0.0)) {
        None => Ok(()),
        Some(value) => Err(Error::Argument(format!(
            "a phase function has the value {value}: all must be finite and above 0"
        ))),
    }
}
