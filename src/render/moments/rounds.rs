//! How far each round of scattering goes, so that few of them reach the end.

/// Rounds of scattering on each field that are stretched, and plain ones after them, which take
/// away what turns over faster than [`LEFT`] allows for.
const ROUNDS: usize = 16;
const PLAIN: usize = 3;
/// Share of a disturbance that a plain round leaves of it, at the least (short characteristics may
/// turn it over) and at the most (light in the middle of a thick cloud fades slowly).
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
}
