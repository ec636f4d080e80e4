//! Phase functions as the path tracer samples them.

use crate::{
    Result,
    optics::{
        peak::Chopped,
        phase::{Phase, angle_at},
    },
    scene::Droplets,
};

/// Entries of each table.
pub const ANGLES: usize = 4096;

/// The droplets' albedo, the share of the peak in their phase function, both parts of that (1/sr, each
/// normalised) and their inverse distributions of the angle (rad), the wide part first, for three channels,
/// in the order of `phase_tables` in `shaders/path.wgsl`. Phase functions are even in the coordinate of
/// [`angle_at`]; inverse distributions in the root of the share from either end.
///
/// The peak is the one that [`Chopped`] takes off, or nothing where it shall not be `split`.
///
/// # Errors
/// Where effective radius or asymmetry is out of its range.
pub fn phase_table(droplets: &Droplets, split: bool) -> Result<Vec<f32>> {
    let chopped = Chopped::new(Phase::of(droplets)?);
    let peak_share = if split { chopped.f } else { 0.0 };
    let peak = |channel: usize, theta: f64| chopped.peak(channel, theta).max(0.0) / chopped.f.max(1e-9);
    let wide = |channel: usize, theta: f64| {
        let taken = if split { chopped.peak(channel, theta).max(0.0) } else { 0.0 };
        (chopped.phase().value(channel, theta) - taken) / (1.0 - peak_share)
    };
    let parts: [&dyn Fn(usize, f64) -> f64; 2] = [&wide, &peak];
    let mut table = vec![droplets.albedo as f32, peak_share as f32];
    for (part, channel) in parts.iter().flat_map(|part| [0, 1, 2].map(|channel| (part, channel))) {
        let entry = |i: usize| part(channel, angle_at(i as f64 / (ANGLES - 1) as f64)) as f32;
        table.extend((0..ANGLES).map(entry));
    }
    for (part, channel) in parts.iter().flat_map(|part| [0, 1, 2].map(|channel| (part, channel))) {
        table.extend(inverse_distribution(|theta| part(channel, theta)));
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

    /// A part (0 wide, 1 peak) of green in a table: its values, and the angles of its shares.
    fn green(table: &[f32], part: usize) -> (&[f32], &[f32]) {
        let at = |row: usize| &table[2 + row * ANGLES..][..ANGLES];
        (at(3 * part + 1), at(6 + 3 * part + 1))
    }

    /// Mean cosine of the angles of shares, by midpoints, as the shader interpolates.
    fn mean_cosine(inverse: &[f32]) -> f64 {
        let share = |i: usize| share_at(i as f64 / (ANGLES - 1) as f64);
        let ring = |(i, a): (usize, &[f32])| f64::from(0.5 * (a[0] + a[1])).cos() * (share(i + 1) - share(i));
        inverse.windows(2).enumerate().map(ring).sum()
    }

    #[test]
    fn sampled_angles_have_the_mean_cosine_of_the_phase_function() {
        for phase in [scene::Phase::Isotropic, scene::Phase::HenyeyGreenstein { g: 0.85 }, scene::Phase::Mie]
        {
            for split in [false, true] {
                let table = phase_table(&Droplets { phase, ..Droplets::default() }, split).unwrap();
                let peak = f64::from(table[1]);
                let parts = [0, 1].map(|part| mean_cosine(green(&table, part).1));
                let mean = (1.0 - peak) * parts[0] + if peak > 0.0 { peak * parts[1] } else { 0.0 };
                let expected = match phase {
                    scene::Phase::Isotropic => 0.0,
                    scene::Phase::HenyeyGreenstein { g } => g,
                    scene::Phase::Mie => Phase::mie(6.0).unwrap().asymmetry(1),
                };
                assert!((mean - expected).abs() < 3e-4, "{phase:?}: {mean} for {expected}");
                assert_eq!(peak > 0.4, split && phase == scene::Phase::Mie);
            }
        }
    }

    #[test]
    fn peak_and_rest_are_the_phase_function() {
        for effective_radius_um in [4.0, 6.0, 20.0] {
            let droplets = Droplets { effective_radius_um, ..Droplets::default() };
            let [whole, split] = [false, true].map(|split| phase_table(&droplets, split).unwrap());
            let peak = split[1];
            for i in 0..ANGLES {
                let both = (1.0 - peak) * green(&split, 0).0[i] + peak * green(&split, 1).0[i];
                let wanted = green(&whole, 0).0[i];
                assert!(
                    (both / wanted - 1.0).abs() < 1e-5,
                    "{effective_radius_um}, {i}: {both} for {wanted}"
                );
                assert!(green(&split, 1).0[i] >= 0.0);
            }
        }
    }
}
