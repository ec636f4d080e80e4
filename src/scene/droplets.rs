//! The water of a cloud.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use super::{Habit, Species};
use crate::Result;

const CONCENTRATION: Limits = Limits::new(0.0, 1e5, "per cubic centimetre");
/// Of all species together.
const EFFECTIVE_RADIUS: Limits = Limits::new(4.0, 5000.0, "micrometres");
const MASS: Limits = Limits::new(0.0, 100.0, "grams per cubic metre");
const ROUGHNESS: Limits = Limits::new(0.0, 0.5, "");
const ALBEDO: Limits = Limits::new(0.0, 1.0, "");
const ASYMMETRY: Limits = Limits::new(-0.99, 0.99, "");

/// The droplets of a cloud, or what else its particles are: how many, how large, how they scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Droplets {
    /// What they are: "water", "rain", "ice", "snow" or "graupel".
    #[serde(skip_serializing_if = "is_default")]
    pub species: Species,
    /// Of ice, what crystals they are: "columns" or "plates".
    #[serde(skip_serializing_if = "is_default")]
    pub habit: Habit,
    /// Of ice, the slope of the roughness of its crystals, 0 (even: sharp halos) to 0.5 (none left), no unit.
    #[serde(skip_serializing_if = "is_usual")]
    #[schemars(range(min = ROUGHNESS.min, max = ROUGHNESS.max))]
    pub roughness: f64,
    /// Droplets per cubic centimetre in the core, 0 to 100000. More make a denser
    /// cloud. It is Kol's rho0, a measure of extinction rather than a count.
    #[schemars(range(min = CONCENTRATION.min, max = CONCENTRATION.max), extend("unit" = CONCENTRATION.unit))]
    pub concentration_per_cm3: f64,
    /// Their mass in the core, grams per cubic metre of air, 0 to 100, in place of the concentration: 0.3 in fair-weather
    /// cumuli, 1 in strong rain, 0.02 in cirrus. Left out where the concentration tells how dense the cloud is.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = MASS.min, max = MASS.max), extend("unit" = MASS.unit))]
    pub mass_g_per_m3: Option<f64>,
    /// Effective radius, micrometres: 4 to 20 of water, 50 to 3000 of rain and snow, 10 to 500 of ice, 100 to 5000 of
    /// graupel. Sets the density together with the concentration or the mass, and the size of glory and fogbow.
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
    /// That of the species for the effective radius: of water by Lorenz and Mie, with glory and fogbow; of others by
    /// rays, waves and diffraction.
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
        Self {
            species: Species::Water,
            habit: Habit::Columns,
            roughness: USUAL_ROUGHNESS,
            concentration_per_cm3: 400.0,
            mass_g_per_m3: None,
            effective_radius_um: Species::Water.usual_radius_um(),
            phase: Phase::default(),
            albedo: 1.0,
        }
    }
}

/// Roughness of crystals whose halos are as blunt as most are seen.
const USUAL_ROUGHNESS: f64 = 0.03;

fn is_usual(roughness: &f64) -> bool {
    *roughness == USUAL_ROUGHNESS
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Droplets {
    /// As much of a species as this mass, grams per cubic metre of air, in particles of their usual size.
    pub fn of_mass(species: Species, mass_g_per_m3: f64) -> Self {
        Self {
            species,
            mass_g_per_m3: Some(mass_g_per_m3),
            effective_radius_um: species.usual_radius_um(),
            ..Self::default()
        }
    }

    /// Extinction coefficient of the core, per metre: that of the mass ([`Species::extinction_of_mass`]) where it
    /// tells one, or else `k_e = rho0 2 pi r_e^2` [Kol 3.3].
    ///
    /// 0.0905 for the defaults, a mean free path of 11 m. The factor 2 is the
    /// large-droplet limit of the extinction efficiency, which is 2.07 to 2.16 for
    /// clouds, and `r_e^2` stands for the mean squared radius, which is smaller.
    pub fn extinction(&self) -> f64 {
        let radius = self.effective_radius_um * 1e-6;
        if let Some(grams) = self.mass_g_per_m3 {
            return self.species.extinction_of_mass(1e-3 * grams, radius);
        }
        let per_cubic_metre = self.concentration_per_cm3 * 1e6;
        per_cubic_metre * 2.0 * PI * radius * radius
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        at.field("concentration_per_cm3").number(self.concentration_per_cm3, CONCENTRATION)?;
        if let Some(grams) = self.mass_g_per_m3 {
            at.field("mass_g_per_m3").number(grams, MASS)?;
        }
        at.field("roughness").number(self.roughness, ROUGHNESS)?;
        self.check_radius(at.field("effective_radius_um"))?;
        if let Phase::HenyeyGreenstein { g } = self.phase {
            let phase = at.field("phase");
            let lobe = phase.field("henyey_greenstein");
            lobe.field("g").number(g, ASYMMETRY)?;
        }
        at.field("albedo").number(self.albedo, ALBEDO)
    }

    fn check_radius(&self, at: At) -> Result<()> {
        let limits = self.species.limits();
        if self.species == Species::Water {
            return at.number(self.effective_radius_um, limits);
        }
        let radius_um = self.effective_radius_um;
        if radius_um >= limits.min && radius_um <= limits.max {
            return Ok(());
        }
        Err(at.problem(format!(
            "{radius_um} is out of range for {}: expected {limits}, usual are {}",
            self.species.name(),
            self.species.usual_radius_um()
        )))
    }
}
