//! How far each round of scattering goes, so that few of them reach the end.

/// Rounds of scattering that are stretched, and plain ones after them, which take away what turns
/// over faster than [`LEFT`] allows for.
const ROUNDS: usize = 16;
const PLAIN: usize = 3;
/// Share of a disturbance that a plain round leaves of it, at the least (short characteristics may
/// turn it over) and at the most (light in the middle of a thick cloud fades slowly). Nearer to 1,
/// rounds would let grow what swings while it fades, as light in wide flat cells does.
const LEFT: [f64; 2] = [-0.2, 0.97];
/// How much lower than its lowest moment a phase function's share may be.
const BELOW: f64 = 0.05;

/// How far each round goes from the last moments to those that it gives: one over the roots of the
/// polynomial of Chebyshev that is least over [`LEFT`] (Richardson's method), of which all rounds
/// leave a hundredth; plain ones would take a hundred and fifty for that. In the order of
/// Lebedev and Finogenov (1971), backwards, nothing grows in between. A phase function that throws
/// light back turns its flux over in each round: `lowest` is the least of its moments.
pub fn relaxations(lowest: f64) -> [f32; ROUNDS + PLAIN] {
    let mut order = vec![1];
    while order.len() < ROUNDS {
        let twice = 4 * order.len();
        order = order.iter().flat_map(|&i| [i, twice - i]).collect();
    }
    let [least, most] = [LEFT[0].min(lowest - BELOW), LEFT[1]];
    std::array::from_fn(|round| {
        if round >= ROUNDS {
            return 1.0;
        }
        let odd = f64::from(order[ROUNDS - 1 - round] as u32);
        let node = (std::f64::consts::PI * odd / (2 * ROUNDS) as f64).cos();
        (1.0 / (1.0 - 0.5 * (least + most) - 0.5 * (most - least) * node)) as f32
    })
}

/// How far a single round goes, where `lowest` is the least moment of the phase function: all the way, but for
/// droplets that throw light back, whose flux would go to and fro.
pub fn one_round(lowest: f64) -> f32 {
    (1.0 / (1.0 - 0.7 * lowest.min(0.0))) as f32
}

/// Share of the slowest disturbance that may be left in a thick cloud, and most repeats for that.
const ENOUGH: f64 = 0.05;
const MOST_REPEATS: f64 = 8.0;

/// How often all rounds are done on the coarsest field, where they cost little, so that light finds
/// its way into a cloud of this optical thickness (transport optical depth: of a medium that
/// scatters alike in all directions, with this albedo): more than once beyond 10.
pub fn repeats(thickness: f64, albedo: f64) -> usize {
    // Of light that spreads through a slab, which ends 0.71 mean free paths beyond its faces.
    let slowest = albedo * (1.0 - (std::f64::consts::PI / (thickness + 1.42)).powi(2) / 3.0).max(0.0);
    let left = relaxations(0.0).iter().fold(1.0, |left, &r| left * (1.0 - f64::from(r) * (1.0 - slowest)));
    (ENOUGH.ln() / left.abs().min(1.0 - 1e-9).ln()).ceil().clamp(1.0, MOST_REPEATS) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_leave_little_of_any_disturbance_and_let_none_grow() {
        // The last is of a phase function that throws light back, where rounds do a little less.
        for (lowest, end) in [(1.0, 0.013), (0.0, 0.013), (-0.5, 0.03)] {
            let least = LEFT[0].min(lowest);
            for i in 0..=100 {
                let share = least + (LEFT[1] - least) * f64::from(i) / 100.0;
                let mut left: f64 = 1.0;
                for relaxation in relaxations(lowest) {
                    left *= 1.0 - f64::from(relaxation) * (1.0 - share);
                    assert!(left.abs() < 1.01, "{lowest} {share}: {left}");
                }
                assert!(left.abs() < end, "{lowest} {share}: {left}");
            }
        }
    }

    #[test]
    fn thick_clouds_take_more_rounds_and_those_that_absorb_do_not() {
        assert_eq!([0.0, 3.0, 10.0].map(|thickness| repeats(thickness, 1.0)), [1; 3]);
        assert!((2..8).contains(&repeats(20.0, 1.0)));
        assert_eq!((repeats(1e9, 1.0), repeats(1e9, 0.9)), (8, 1));
    }
}
