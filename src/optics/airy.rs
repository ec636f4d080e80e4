//! Airy's function, which tells the light about a bow: G. B. Airy, Transactions of the Cambridge Philosophical
//! Society 6 (1838); H. C. van de Hulst, "Light Scattering by Small Particles" (1957), section 13.2.

use std::sync::OnceLock;

/// Where the table of [`light_within`] begins and its steps.
const FIRST: f64 = -8.0;
/// Where it ends: beyond, waves bring on average what rays do.
pub(super) const LAST: f64 = 24.0;
const STEPS: usize = 16_000;

/// The integral of Ai(-t)^2 over t up to `z`: light of a bow up to so many widths on its bright side.
///
/// It is z Ai^2 + Ai'^2 (at -z), as differentiating shows. Far on the bright side it goes like sqrt(z) / pi, which is
/// what rays without waves tell.
pub fn light_within(z: f64) -> f64 {
    if z <= FIRST {
        return 0.0;
    }
    if z >= LAST {
        return z.sqrt() / std::f64::consts::PI;
    }
    static TABLE: OnceLock<Vec<f64>> = OnceLock::new();
    let table = TABLE.get_or_init(table);
    let place = (z - FIRST) / (LAST - FIRST) * STEPS as f64;
    let i = (place as usize).min(STEPS - 1);
    table[i] + (place - i as f64) * (table[i + 1] - table[i])
}

/// y'' = x y, from the dark side on, where Ai is the solution that grows (Runge and Kutta).
fn table() -> Vec<f64> {
    let step = (LAST - FIRST) / STEPS as f64;
    // Asymptotic series at x = 8, of which the rest is below 1e-7 of the value.
    let zeta = 2.0 / 3.0 * (-FIRST).powf(1.5);
    let front = (-zeta).exp() / (2.0 * std::f64::consts::PI.sqrt());
    let series = |terms: [f64; 4]| -> f64 {
        terms.iter().enumerate().map(|(k, c)| c * (-1.0 / zeta).powi(k as i32)).sum()
    };
    let root = (-FIRST).powf(0.25);
    let mut state = [
        front / root * series([1.0, 5.0 / 72.0, 385.0 / 10_368.0, 85_085.0 / 2_239_488.0]),
        -front * root * series([1.0, -7.0 / 72.0, -455.0 / 10_368.0, -95_095.0 / 2_239_488.0]),
    ];
    let slope = |x: f64, [y, dy]: [f64; 2]| [dy, x * y];
    let light = |z: f64, [y, dy]: [f64; 2]| (z * y * y + dy * dy).max(0.0);
    let mut values = vec![light(FIRST, state)];
    for i in 0..STEPS {
        // Ai runs down its argument, x = -z.
        let x = -(FIRST + i as f64 * step);
        let add = |a: [f64; 2], b: [f64; 2], h: f64| [a[0] + h * b[0], a[1] + h * b[1]];
        let k1 = slope(x, state);
        let k2 = slope(x - 0.5 * step, add(state, k1, -0.5 * step));
        let k3 = slope(x - 0.5 * step, add(state, k2, -0.5 * step));
        let k4 = slope(x - step, add(state, k3, -step));
        for c in 0..2 {
            state[c] -= step / 6.0 * (k1[c] + 2.0 * k2[c] + 2.0 * k3[c] + k4[c]);
        }
        values.push(light(-(x - step), state));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_of_a_bow_is_that_of_tabulated_values() {
        // Ai(0)^2 ... (Abramowitz and Stegun, table 10.11): Ai'(0) = -0.2588194, and at z = 1 and 2
        // Ai(-1) = 0.5355609, Ai'(-1) = -0.0101606, Ai(-2) = 0.2274074, Ai'(-2) = 0.6182590.
        for (z, ai, slope) in [
            (0.0, 0.355_028_1, -0.258_819_4),
            (1.0, 0.535_560_9, -0.010_160_6),
            (2.0, 0.227_407_4, 0.618_259_0),
            (-2.0, 0.034_924_1, -0.053_090_4),
        ] {
            let right: f64 = z * ai * ai + slope * slope;
            assert!((light_within(z) - right).abs() < 2e-6, "{z}: {} for {right}", light_within(z));
        }
    }

    #[test]
    fn waves_bring_no_more_light_than_rays() {
        // Where rays take over, what is left of the waves is below 1 % of a width's light.
        let rays = |z: f64| z.sqrt() / std::f64::consts::PI;
        assert!((light_within(LAST - 1e-3) - rays(LAST)).abs() < 0.01);
        assert!(light_within(FIRST + 1e-3) < 1e-9);
    }
}
