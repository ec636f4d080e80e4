//! Phase functions as the path tracer samples them.

use crate::{
    Result,
    optics::phase::{Phase, angle_at},
    scene::Droplets,
};

/// Entries of each table; `ANGLES` of `shaders/path.wgsl`.
pub(super) const ANGLES: usize = 4096;

/// The droplets' albedo, phase functions and inverse distributions of the angle, for
/// three channels, in the order of the shader's `phase_tables`.
pub(super) fn tables(droplets: &Droplets) -> Result<Vec<f32>> {
    let phase = Phase::of(droplets)?;
    let mut table = vec![droplets.albedo as f32];
    for channel in 0..3 {
        table.extend(
            (0..ANGLES).map(|i| phase.value(channel, angle_at(i as f64 / (ANGLES - 1) as f64)) as f32),
        );
    }
    for channel in 0..3 {
        table.extend(inverse_distribution(|theta| phase.value(channel, theta)));
    }
    Ok(table)
}

/// The angle below which a share i / (ANGLES - 1) of the light is scattered.
fn inverse_distribution(phase: impl Fn(f64) -> f64) -> Vec<f32> {
    const FINE: usize = 1 << 16;
    let angles: Vec<f64> = (0..=FINE).map(|i| angle_at(i as f64 / FINE as f64)).collect();
    let mut within = vec![0.0];
    for pair in angles.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        let ring = pair[0].cos() - pair[1].cos();
        within.push(within[within.len() - 1] + phase(middle) * ring);
    }
    let whole = within[FINE];
    (0..ANGLES)
        .map(|i| {
            let share = whole * i as f64 / (ANGLES - 1) as f64;
            let above = within.partition_point(|&x| x < share).clamp(1, FINE);
            let (low, high) = (within[above - 1], within[above]);
            let part = if high > low { (share - low) / (high - low) } else { 0.0 };
            (angles[above - 1] + part * (angles[above] - angles[above - 1])) as f32
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    #[test]
    fn sampled_angles_have_the_mean_cosine_of_the_phase_function() {
        for phase in [scene::Phase::Isotropic, scene::Phase::HenyeyGreenstein { g: 0.85 }, scene::Phase::Mie]
        {
            let table = tables(&Droplets { phase, ..Droplets::default() }).unwrap();
            let inverse = &table[1 + 4 * ANGLES..1 + 5 * ANGLES];
            // Midpoints of equal shares, as the shader interpolates.
            let mean = inverse.windows(2).map(|a| f64::from(0.5 * (a[0] + a[1])).cos()).sum::<f64>()
                / (ANGLES - 1) as f64;
            let expected = match phase {
                scene::Phase::Isotropic => 0.0,
                scene::Phase::HenyeyGreenstein { g } => g,
                scene::Phase::Mie => Phase::mie(6.0).unwrap().asymmetry(1),
            };
            assert!((mean - expected).abs() < 3e-4, "{phase:?}: {mean} for {expected}");
        }
    }
}
