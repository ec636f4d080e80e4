//! Phase functions as the path tracer samples them.

use crate::{
    Result,
    optics::phase::{Phase, angle_at},
    scene::Droplets,
};

/// Entries of each table.
pub const ANGLES: usize = 4096;

/// The droplets' albedo, phase functions (1/sr) and inverse distributions of the angle (rad), for
/// three channels, in the order of `phase_tables` in `shaders/path.wgsl`. Phase functions are
/// even in the coordinate of [`angle_at`]; inverse distributions in the root of the share from either
/// end.
///
/// # Errors
/// Where effective radius or asymmetry is out of its range.
pub fn phase_table(droplets: &Droplets) -> Result<Vec<f32>> {
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

/// The share of the light at coordinate `x` from 0 to 1 of an inverse distribution: quadratic at
/// both ends, so that angles, which grow like the root of what they hold there, are linear in it.
/// The inverse of `share_coordinate` in `shaders/lib/path_choice.wgsl`.
fn share_at(x: f64) -> f64 {
    let from_end = 2.0 * x.min(1.0 - x).powi(2);
    if x < 0.5 { from_end } else { 1.0 - from_end }
}

/// The angles below which the shares of [`share_at`] of the light are scattered.
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
            let share = whole * share_at(i as f64 / (ANGLES - 1) as f64);
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
            let table = phase_table(&Droplets { phase, ..Droplets::default() }).unwrap();
            let inverse = &table[1 + 4 * ANGLES..1 + 5 * ANGLES];
            // Midpoints, as the shader interpolates, by the share of light between them.
            let share = |i: usize| share_at(i as f64 / (ANGLES - 1) as f64);
            let ring =
                |(i, a): (usize, &[f32])| f64::from(0.5 * (a[0] + a[1])).cos() * (share(i + 1) - share(i));
            let mean: f64 = inverse.windows(2).enumerate().map(ring).sum();
            let expected = match phase {
                scene::Phase::Isotropic => 0.0,
                scene::Phase::HenyeyGreenstein { g } => g,
                scene::Phase::Mie => Phase::mie(6.0).unwrap().asymmetry(1),
            };
            assert!((mean - expected).abs() < 3e-4, "{phase:?}: {mean} for {expected}");
        }
    }
}
