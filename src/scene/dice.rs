//! Chance that falls the same on every platform.

use glam::{DQuat, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Unit quaternions about the vertical that are exact in two decimals, so that files
/// stay short: half angles of the triangles 7-24-25 and 3-4-5. The yaws are 0, 33,
/// 74, 106 and 147 degrees.
const YAWS: [(f64, f64); 5] = [(0.0, 1.0), (0.28, 0.96), (0.6, 0.8), (0.8, 0.6), (0.96, 0.28)];

/// Seeded chance.
///
/// Only sums, products and square roots, which IEEE 754 rounds the same everywhere:
/// no sine, which does not.
pub(crate) struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        // The 53 bits that a f64 can hold.
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of `low..=high`, all alike.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + (self.unit() * (high - low + 1) as f64) as usize
    }

    /// Uniform in the horizontal disc of radius 1.
    pub fn disc(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.between(-1.0, 1.0), 0.0, self.between(-1.0, 1.0));
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Uniform on the sphere of radius 1.
    pub fn sphere(&mut self) -> DVec3 {
        loop {
            let p = self.disc() + DVec3::Y * self.between(-1.0, 1.0);
            let squared = p.length_squared();
            if squared > 1e-4 && squared <= 1.0 {
                return p / squared.sqrt();
            }
        }
    }

    /// Uniform on the part of the sphere of radius 1 that is higher than `lowest`, -1 to 1.
    pub fn cap(&mut self, lowest: f64) -> DVec3 {
        let y = self.between(lowest, 1.0);
        let flat = loop {
            let p = self.disc();
            if p.length_squared() > 1e-4 {
                break p.normalize();
            }
        };
        flat * (1.0 - y * y).max(0.0).sqrt() + DVec3::Y * y
    }

    /// A turn about the vertical.
    pub fn yaw(&mut self) -> DQuat {
        let (y, w) = YAWS[self.count(0, YAWS.len() - 1)];
        DQuat::from_xyzw(0.0, y, 0.0, w)
    }
}
