//! What the particles of a cloud are.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::Limits;

/// What the particles of a cloud are: how they scatter light, how large they may be, what a gram of them is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Species {
    /// Droplets of water, effective radius 4 to 20 micrometres: glory and fogbow.
    #[default]
    Water,
    /// Drops of rain and drizzle, effective radius 50 to 3000 micrometres: the rainbow.
    Rain,
    /// Crystals of ice turned every way, effective radius 10 to 500 micrometres: halos of 22 and 46 degrees.
    Ice,
    /// Flakes of snow, effective radius 50 to 3000 micrometres: no halo.
    Snow,
    /// Graupel, lumps of rime, effective radius 100 to 5000 micrometres.
    Graupel,
}

/// What crystals of ice there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Habit {
    /// Hexagonal columns, twice as long as wide.
    #[default]
    Columns,
    /// Hexagonal plates, 0.4 times as thick as wide.
    Plates,
}

impl Species {
    /// Its name, as in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Water => "water",
            Self::Rain => "rain",
            Self::Ice => "ice",
            Self::Snow => "snow",
            Self::Graupel => "graupel",
        }
    }

    /// Least and greatest effective radius, micrometres.
    pub fn radii_um(self) -> [f64; 2] {
        let limits = self.limits();
        [limits.min, limits.max]
    }

    pub(super) const fn limits(self) -> Limits {
        match self {
            Self::Water => Limits::new(4.0, 20.0, "micrometres"),
            Self::Rain | Self::Snow => Limits::new(50.0, 3000.0, "micrometres"),
            Self::Ice => Limits::new(10.0, 500.0, "micrometres"),
            Self::Graupel => Limits::new(100.0, 5000.0, "micrometres"),
        }
    }

    /// Effective radius, micrometres, where nobody says otherwise: what clouds have, heavy rain, cirrus, flakes as
    /// weather models take them, lumps of two millimetres.
    pub fn usual_radius_um(self) -> f64 {
        match self {
            Self::Water => 6.0,
            Self::Rain => 500.0,
            Self::Ice => 40.0,
            Self::Snow => 250.0,
            Self::Graupel => 1000.0,
        }
    }

    /// Mass of its particles by their volume, kg/m^3: flakes and lumps have air in them.
    pub fn density(self) -> f64 {
        match self {
            Self::Water | Self::Rain => 1000.0,
            Self::Ice => 917.0,
            Self::Snow => 100.0,
            Self::Graupel => 400.0,
        }
    }

    /// Extinction coefficient, 1/m, of a mass of particles in the air, kg/m^3, of an effective radius in metres:
    /// 3 m / (2 rho r_e), twice the shadows of particles whose volume over shadow is 4 r_e / 3.
    pub fn extinction_of_mass(self, mass: f64, effective_radius: f64) -> f64 {
        1.5 * mass / (self.density() * effective_radius)
    }
}
