//! Random inputs, the same on every run and machine.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DQuat, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream that belongs to a name.
    pub fn new(name: &str) -> Self {
        let seed = name.bytes().fold(0u64, |hash, byte| hash.wrapping_mul(31).wrapping_add(u64::from(byte)));
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly spread logarithms.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// 0 to `count - 1`.
    pub fn index(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    pub fn sign(&mut self) -> f64 {
        [-1.0, 1.0][self.index(2)]
    }

    /// A cosine of angles from 0 to pi; one in three is within a millionth to a tenth of an end.
    pub fn cosine(&mut self) -> f64 {
        match self.index(3) {
            0 => self.sign() * (1.0 - self.log(1e-6, 0.1)),
            _ => self.between(-1.0, 1.0),
        }
    }

    /// An asymmetry from -0.99 to 0.99.
    pub fn asymmetry(&mut self) -> f64 {
        self.between(-0.99, 0.99)
    }

    pub fn direction(&mut self) -> DVec3 {
        let (y, (sine, cosine)) = (self.between(-1.0, 1.0), self.between(0.0, TAU).sin_cos());
        let level = (1.0 - y * y).sqrt();
        DVec3::new(level * cosine, y, level * sine)
    }

    /// A direction at a given angle to another.
    pub fn direction_off(&mut self, axis: DVec3, angle: f64) -> DVec3 {
        let across = axis.any_orthonormal_vector();
        let turned = DQuat::from_axis_angle(axis, self.between(0.0, TAU)) * across;
        angle.cos() * axis + angle.sin() * turned
    }

    pub fn turn(&mut self) -> DMat3 {
        let axis = self.direction();
        DMat3::from_axis_angle(axis, self.between(0.0, PI))
    }

    /// In the unit ball.
    pub fn ball(&mut self) -> DVec3 {
        self.direction() * self.between(0.0, 1.0).cbrt()
    }
}
