//! The water of a cloud.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use crate::Result;

const CONCENTRATION: Limits = Limits::new(0.0, 1e5, "per cubic centimetre");
const EFFECTIVE_RADIUS: Limits = Limits::new(4.0, 20.0, "micrometres");
const ALBEDO: Limits = Limits::new(0.0, 1.0, "");
const ASYMMETRY: Limits = Limits::new(-0.99, 0.99, "");

/// The droplets of a cloud: how many, how large, how they scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Droplets {
    /// Droplets per cubic centimetre in the core, 0 to 100000. More make a denser
    /// cloud. It is Kol's rho0, a measure of extinction rather than a count.
    #[schemars(range(min = CONCENTRATION.min, max = CONCENTRATION.max), extend("unit" = CONCENTRATION.unit))]
    pub concentration_per_cm3: f64,
    /// Effective radius of the droplets, micrometres, 4 to 20. Sets the density
    /// together with the concentration, and the size of glory and fogbow.
    #[schemars(range(min = EFFECTIVE_RADIUS.min, max = EFFECTIVE_RADIUS.max), extend("unit" = EFFECTIVE_RADIUS.unit))]
    pub effective_radius_um: f64,
    /// Where the scattered light goes.
    pub phase: Phase,
    /// Share of the light that each scattering keeps, 0 to 1, no unit. 1 is pure
    /// water; smoke and dust are darker.
    #[schemars(range(min = ALBEDO.min, max = ALBEDO.max))]
    pub albedo: f64,
}

/// The phase function: the share of scattered light that goes in each direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Phase {
    /// Water droplets by Lorenz and Mie, for the effective radius: with glory and fogbow.
    #[default]
    Mie,
    /// The smooth lobe of Henyey and Greenstein.
    HenyeyGreenstein {
        /// Mean cosine of the scattering angle, -0.99 to 0.99, no unit: 0.85 is like
        /// cloud, 0 is isotropic, below 0 throws light back.
        #[schemars(range(min = ASYMMETRY.min, max = ASYMMETRY.max))]
        g: f64,
    },
    /// The same in every direction.
    Isotropic,
}

impl Default for Droplets {
    fn default() -> Self {
        Self { concentration_per_cm3: 400.0, effective_radius_um: 6.0, phase: Phase::default(), albedo: 1.0 }
    }
}

impl Droplets {
    /// Extinction coefficient of the core, per metre: `k_e = rho0 2 pi r_e^2` [Kol 3.3].
    ///
    /// 0.0905 for the defaults, a mean free path of 11 m. The factor 2 is the
    /// large-droplet limit of the extinction efficiency, which is 2.07 to 2.16 for
    /// clouds, and `r_e^2` stands for the mean squared radius, which is smaller.
    pub fn extinction(&self) -> f64 {
        let per_cubic_metre = self.concentration_per_cm3 * 1e6;
        let radius = self.effective_radius_um * 1e-6;
        per_cubic_metre * 2.0 * PI * radius * radius
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("concentration_per_cm3").number(self.concentration_per_cm3, CONCENTRATION)?;
        at.field("effective_radius_um").number(self.effective_radius_um, EFFECTIVE_RADIUS)?;
        if let Phase::HenyeyGreenstein { g } = self.phase {
            let phase = at.field("phase");
            let lobe = phase.field("henyey_greenstein");
            lobe.field("g").number(g, ASYMMETRY)?;
        }
        at.field("albedo").number(self.albedo, ALBEDO)
    }
}
