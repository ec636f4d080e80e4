//! How much may be drawn at a time so that the window stays fluid.

/// Finest step between two resolutions: fewer sizes, fewer new textures.
const STEP: f64 = 1.189_207_115_002_721; // 2^(1/4)
/// Coarsest resolution, as a share of the window's.
const COARSEST: f64 = 0.1;

/// The share of the window's resolution that is drawn in time while something moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    scale: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { scale: 0.5 }
    }
}

impl Pace {
    /// To begin with on an adapter that is no GPU.
    pub const SLOW: Self = Self { scale: 0.2 };

    /// Learns that a picture at this pace took `ms`, where `budget` ms were wanted. Time
    /// goes with the pixels: with the square of the scale.
    pub fn measured(&mut self, ms: f64, budget: f64) {
        // Some slack, or it would swing.
        if (0.55 * budget..=1.1 * budget).contains(&ms) {
            return;
        }
        let wanted = self.scale * (0.85 * budget / ms.max(1e-3)).sqrt().clamp(0.4, 1.5);
        let steps = (wanted.log2() / STEP.log2()).floor();
        self.scale = STEP.powf(steps).clamp(COARSEST, 1.0);
    }

    /// The size for a window of `full` pixels.
    pub fn size(&self, full: [u32; 2]) -> [u32; 2] {
        full.map(|n| ((f64::from(n) * self.scale).round() as u32).max(1))
    }
}

/// How much of a thing is done between two frames of the window: tiles drawn, clouds lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helping {
    count: f64,
}

impl Helping {
    /// So many to begin with.
    pub fn of(count: u32) -> Self {
        Self { count: count.into() }
    }

    /// Learns that `count` took `ms` where `budget` was wanted.
    pub fn measured(&mut self, count: u32, ms: f64, budget: f64) {
        let wanted = f64::from(count) * budget / ms.max(0.01);
        self.count = wanted.clamp(0.5 * self.count, 4.0 * self.count).clamp(1.0, 1e6);
    }

    /// How many the next time.
    pub fn count(&self) -> u32 {
        self.count as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine that needs `ms` for a full picture and `fixed` for any.
    fn settle(full_ms: f64, fixed: f64) -> (f64, usize) {
        let mut pace = Pace::default();
        let mut changes = 0;
        for _ in 0..50 {
            let before = pace;
            pace.measured(fixed + full_ms * pace.scale * pace.scale, 33.0);
            changes += usize::from(pace != before);
        }
        (pace.scale, changes)
    }

    #[test]
    fn settles_within_the_budget_without_swinging() {
        for full_ms in [1.0, 30.0, 60.0, 200.0, 900.0] {
            let (scale, changes) = settle(full_ms, 2.0);
            assert!(2.0 + full_ms * scale * scale <= 36.4, "{full_ms}: {scale}");
            assert!(scale >= 1.0 || full_ms * scale * scale > 12.0, "{full_ms}: {scale}");
            assert!(changes < 8, "{full_ms}: {changes}");
        }
    }

    #[test]
    fn slow_machines_get_the_coarsest_picture_and_fast_ones_all_pixels() {
        assert_eq!(settle(1e6, 0.0).0, COARSEST);
        assert_eq!(settle(0.5, 0.0).0, 1.0);
        assert_eq!(Pace { scale: 0.1 }.size([3, 2]), [1, 1]);
    }

    #[test]
    fn helpings_approach_the_budget() {
        let mut helping = Helping::of(8);
        for _ in 0..20 {
            helping.measured(helping.count(), 0.4 * f64::from(helping.count()), 20.0);
        }
        assert_eq!(helping.count(), 50);
    }
}
