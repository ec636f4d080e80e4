//! Where a cloud reads the noise volume ([`noise_volume`](super::noise_volume)), and how much each octave counts.

use glam::{DQuat, DVec3, Vec4};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};

use super::noise_volume::{CELLS, SIZE};
use crate::scene;

/// Ratio of the fine look-up's frequency to the coarse one's: it goes on where the volume's octaves end.
pub(crate) const FINE: f64 = 16.0;

/// `NoiseFrame` of `shaders/lib/noise.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct NoiseFrame {
    pub(crate) coarse_x: Vec4,
    pub(crate) coarse_y: Vec4,
    pub(crate) coarse_z: Vec4,
    pub(crate) fine_x: Vec4,
    pub(crate) fine_y: Vec4,
    pub(crate) fine_z: Vec4,
    pub(crate) amplitudes: [f32; 3],
    pub(crate) scale: f32,
    pub(crate) texels_per_metre: f32,
    pub(crate) frequency: f32,
    pub(crate) padding: [f32; 2],
    pub(crate) flow: Vec4,
    pub(crate) first: Vec4,
    pub(crate) second: Vec4,
}

impl NoiseFrame {
    /// The look-up of `noise`, whose largest features are `size` metres wide, for a cloud whose frame
    /// has its origin at `origin` in the world. The volume's periods are taken out here, in double precision.
    pub fn new(noise: &scene::Noise, size: f64, origin: DVec3) -> Self {
        let period = size * f64::from(CELLS[0]);
        // Neither lattice lines up with the world or with the other.
        let upright = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7);
        let apart = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.9);
        // The noise turns one way, the place that is looked up the other.
        let turned = upright * noise.rotation.inverse();
        // The fine octaves slide along a diagonal as the noise evolves.
        let slide = DVec3::new(0.36, 0.8, 0.48) * noise.evolution;
        let [seeded_coarse, seeded_fine] = places(noise.seed);
        let coarse = rows(turned, period, origin - noise.offset, seeded_coarse);
        let fine = rows(apart * turned, period / FINE, origin - noise.offset - slide, seeded_fine);
        // An octave's amplitude over that of the one before.
        let gain = 2_f64.powf(noise.dimension - 3.0);
        let amplitudes = [gain.powi(2), 2.0 * noise.detail * gain.powi(4), 2.0 * noise.detail * gain.powi(6)];
        let [flow, first, second] = phases(noise.renewed, size);
        let variance = 1.0 + amplitudes.iter().map(|a| a * a).sum::<f64>();
        Self {
            coarse_x: coarse[0],
            coarse_y: coarse[1],
            coarse_z: coarse[2],
            fine_x: fine[0],
            fine_y: fine[1],
            fine_z: fine[2],
            amplitudes: amplitudes.map(|a| a as f32),
            scale: variance.sqrt().recip() as f32,
            texels_per_metre: (f64::from(SIZE) / period) as f32,
            frequency: (1.0 / size) as f32,
            padding: [0.0; 2],
            flow,
            first,
            second,
        }
    }
}

impl NoiseFrame {
    /// The same where it repeats itself every `repeat` metres along x and z, and its features are longer along
    /// `lengthening`, a unit vector times the logarithm of how many times: waves are turned and stretched to the
    /// nearest ones that do. `origin` is a corner of a period.
    pub fn repeating(
        noise: &scene::Noise,
        size: f64,
        origin: DVec3,
        repeat: f64,
        lengthening: DVec3,
    ) -> Self {
        let mut frame = Self::new(noise, size, origin);
        let share = 1.0 - (-lengthening.length()).exp();
        let along = lengthening.normalize_or_zero();
        let whole = |wave: f64| (wave * repeat).round() / repeat;
        let fit = |row: &mut Vec4| {
            let wave = row.truncate().as_dvec3();
            let wave = wave - share * wave.dot(along) * along;
            *row = DVec3::new(whole(wave.x), wave.y, whole(wave.z)).as_vec3().extend(row.w);
        };
        [&mut frame.coarse_x, &mut frame.coarse_y, &mut frame.coarse_z].into_iter().for_each(fit);
        [&mut frame.fine_x, &mut frame.fine_y, &mut frame.fine_z].into_iter().for_each(fit);
        frame
    }
}

/// How far the noise is carried while a phase of it is seen, in its largest billows.
const CARRIED: f64 = 1.0;

/// Ways, m, and weights of the two phases of noise whose largest features are `size` metres wide, and where each
/// begins to read, in periods. A phase comes and goes once a renewal, half a one after the other, and begins
/// elsewhere each time; it is seen best where nothing has carried it.
fn phases(renewed: scene::Renewed, size: f64) -> [Vec4; 3] {
    if renewed.times == 0.0 {
        return [Vec4::ZERO; 3];
    }
    let phase = |ahead: f64| {
        let at = renewed.times + ahead;
        let rounds = at.floor();
        let way = CARRIED * size * (at - rounds - 0.5);
        // Those of sines half a turn apart have squares that add up to 1.
        (way, (std::f64::consts::PI * (at - rounds)).sin(), begin(rounds, renewed.round, ahead))
    };
    let ((way, weight, first), (other_way, other_weight, second)) = (phase(0.0), phase(0.5));
    let flow = Vec4::new(way as f32, other_way as f32, weight as f32, other_weight as f32);
    [flow, first, second]
}

/// Where a phase begins to read: elsewhere in each round, and in the first of those of the phase that is `ahead`
/// where noise that stands still does.
fn begin(rounds: f64, of: u32, ahead: f64) -> Vec4 {
    let rounds = if of > 0 { rounds.rem_euclid(f64::from(of)) } else { rounds };
    // Powers of the plastic number's inverse: places that keep apart (Roberts 2018).
    let step = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    let place = (rounds + 0.5 - ahead) * step;
    (place - place.floor()).extend(0.0).as_vec4()
}

/// Where a seed begins to read, in periods, coarse and fine.
fn places(seed: u32) -> [DVec3; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(u64::from(seed));
    let mut place = || DVec3::from([(); 3].map(|()| f64::from(random.next_u32()) / 2_f64.powi(32)));
    [place(), place()]
}

fn rows(turn: DQuat, period: f64, origin: DVec3, place: DVec3) -> [Vec4; 3] {
    let start = turn * origin / period + place;
    [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
        let row = turn.inverse() * axis / period;
        row.extend(start.dot(axis).rem_euclid(1.0)).as_vec4()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frame of noise that was renewed so often, of billows of 120 m.
    fn renewed(times: f64, round: u32) -> NoiseFrame {
        let renewed = scene::Renewed { times, round };
        NoiseFrame::new(&scene::Noise { renewed, ..scene::Noise::default() }, 120.0, DVec3::ZERO)
    }

    #[test]
    fn phases_weigh_alike_and_the_one_that_begins_anew_weighs_nothing() {
        for i in -40..40 {
            let flow = renewed(0.013 + 0.1 * f64::from(i), 0).flow;
            assert!((flow.z * flow.z + flow.w * flow.w - 1.0).abs() < 1e-6, "{flow}");
            assert!(flow.x.abs() <= 60.0 && flow.y.abs() <= 60.0, "{flow}");
        }
        for (times, fresh) in [(3.0, 2), (-2.0, 2), (1.5, 3)] {
            let (before, after) = (renewed(times - 1e-6, 0), renewed(times + 1e-6, 0));
            assert!(before.flow[fresh] < 1e-5 && after.flow[fresh] < 1e-5, "{before:?}");
            let other = 3 - fresh;
            let place = |frame: &NoiseFrame| if fresh == 2 { frame.second } else { frame.first };
            assert!((before.flow[other] - after.flow[other]).abs() < 1e-3);
            assert_eq!(place(&before), place(&after), "the one that is seen stays");
        }
    }

    #[test]
    fn noise_begins_as_it_stands_still_and_comes_back_after_a_round() {
        let begun = renewed(1e-9, 0);
        assert!(begun.flow.w == 1.0 && begun.flow.y.abs() < 1e-6 && begun.second == Vec4::ZERO, "{begun:?}");
        assert_eq!(renewed(0.0, 0).flow, Vec4::ZERO);
        let (start, end) = (renewed(0.25, 7), renewed(7.25, 7));
        assert!((start.flow - end.flow).abs().max_element() < 1e-4, "{start:?} {end:?}");
        assert_eq!((start.first, start.second), (end.first, end.second));
        assert_ne!(renewed(1.25, 7).second, start.second, "each renewal has other billows");
    }

    #[test]
    fn noise_turns_about_its_offset_the_way_a_cloud_turns() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.7);
        let still = scene::Noise { offset: DVec3::new(40.0, -7.0, 90.0), ..scene::Noise::default() };
        let turned = scene::Noise { rotation: turn, ..still.clone() };
        let looked_up = |noise: &scene::Noise, p: DVec3| {
            let frame = NoiseFrame::new(noise, 120.0, DVec3::ZERO);
            let rows =
                [frame.coarse_x, frame.coarse_y, frame.coarse_z, frame.fine_x, frame.fine_y, frame.fine_z];
            rows.map(|row| f64::from(row.dot(p.as_vec3().extend(1.0))))
        };
        let p = DVec3::new(100.0, 30.0, -20.0);
        let carried = still.offset + turn * (p - still.offset);
        for (a, b) in looked_up(&still, p).into_iter().zip(looked_up(&turned, carried)) {
            // Whole periods apart; some ten periods of the fine look-up are good to 1e-6 each.
            let apart = a - b - (a - b).round();
            assert!(apart.abs() < 2e-5, "{a} {b}");
        }
    }

    #[test]
    fn seeds_read_from_places_that_are_far_apart() {
        let all: Vec<DVec3> = (0..200).flat_map(places).collect();
        assert!(all.iter().all(|p| p.cmpge(DVec3::ZERO).all() && p.cmplt(DVec3::ONE).all()));
        // Of 400 places in a cube two are 0.01 apart by chance once in some 10 000 pairs: evenly spread,
        // none is nearer than a texel of 1/128 but by a chance of 80 000 times 2e-6.
        let apart = |a: DVec3, b: DVec3| (a - b - (a - b).round()).length();
        let nearest = (0..all.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| apart(all[i], all[j]))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest > 1e-3, "{nearest}");
        let middle = all.iter().sum::<DVec3>() / all.len() as f64;
        // 1 / sqrt(12 * 400) is a deviation.
        assert!((middle - 0.5).abs().max_element() < 4.0 * 0.0145, "{middle}");
        let seeded = |seed| {
            let noise = scene::Noise { seed, ..scene::Noise::default() };
            NoiseFrame::new(&noise, 120.0, DVec3::new(3.0, 4.0, 5.0))
        };
        assert_eq!(seeded(7), seeded(7));
        let (a, b) = (seeded(7), seeded(8));
        assert!(a.coarse_x.w != b.coarse_x.w && a.fine_z.w != b.fine_z.w);
        assert_eq!(a.coarse_x.truncate(), b.coarse_x.truncate(), "a seed moves, and does no more");
    }

    #[test]
    fn amplitudes_follow_the_dimension_and_all_octaves_together_deviate_as_one() {
        for dimension in [2.0, 2.35, 2.9] {
            for detail in [0.0, 0.5, 1.0] {
                let noise = scene::Noise { dimension, detail, ..scene::Noise::default() };
                let frame = NoiseFrame::new(&noise, 120.0, DVec3::ZERO);
                let [third, fifth, seventh] = frame.amplitudes.map(f64::from);
                // Amplitude falls as size to the co-dimension: two octaves are four times as fine.
                let fourfold = 4_f64.powf(dimension - 3.0);
                assert!((third / fourfold - 1.0).abs() < 1e-6);
                assert!((fifth - 2.0 * detail * third * third).abs() < 1e-6);
                assert!((seventh - fifth * third).abs() < 1e-6);
                let deviation = (1.0 + third * third + fifth * fifth + seventh * seventh).sqrt();
                assert!((f64::from(frame.scale) * deviation - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn lookup_far_from_the_origin_keeps_its_precision() {
        let noise = scene::Noise { scale: Some(100.0), ..Default::default() };
        let near = DVec3::new(10.0, 20.0, 30.0);
        let far = DVec3::new(1e7, -3e6, 2e7);
        let moved = scene::Noise { offset: far, ..noise.clone() };
        let frames = [(&noise, near), (&moved, near + far)].map(|(n, p)| NoiseFrame::new(n, 100.0, p));
        let starts = frames.map(|f| [f.coarse_x, f.coarse_y, f.coarse_z, f.fine_x, f.fine_y, f.fine_z]);
        for (a, b) in starts[0].iter().zip(&starts[1]) {
            assert!((a.w - b.w).abs() < 1e-5, "{a} {b}");
            assert!((0.0..=1.0).contains(&b.w), "whole periods are taken out");
        }
    }
}
