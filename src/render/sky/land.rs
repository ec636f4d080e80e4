//! The pattern of fields and woods: a square that repeats itself, of what they reflect over its mean, in layers from fine
//! to smooth.

use std::sync::LazyLock;

use super::smooth;
use crate::{frame::FIELDS, scene::Dice};

/// Texels along an edge.
pub(super) const EDGE: usize = 512;
/// Octaves of what decides where woods are, and cells of the coarsest along an edge.
const OCTAVES: u32 = 6;
const COARSEST: usize = 5;
/// Share of woods.
const WOODS: f32 = 0.35;

/// What leaves of woods reflect, and what grows on fields: meadow, young corn, stubble, bare soil. Linear RGB; the mean of
/// the whole is divided out.
const LEAVES: [f32; 3] = [0.03, 0.045, 0.02];
const CROPS: [[f32; 3]; 4] =
    [[0.08, 0.11, 0.045], [0.06, 0.10, 0.035], [0.21, 0.17, 0.09], [0.12, 0.09, 0.06]];

/// Rows of texels of all layers.
pub(super) static TEXELS: LazyLock<Vec<[f32; 3]>> =
    LazyLock::new(|| smooth::layers(pattern(), [EDGE, EDGE], |x, edge| x.rem_euclid(edge)));

fn pattern() -> Vec<[f32; 3]> {
    let mut dice = Dice::new(7);
    let woods = fractal(&mut dice);
    let grain = fractal(&mut dice);
    let mut sorted = woods.clone();
    sorted.sort_by(f32::total_cmp);
    let edge = sorted[((1.0 - WOODS) * sorted.len() as f32) as usize];
    let fields = Fields::new(&mut dice);
    let texel = |i: usize| {
        let crop = fields.at(i % EDGE, i / EDGE);
        // Woods end within a texel or two.
        let wooded = ((woods[i] - edge) * 24.0 + 0.5).clamp(0.0, 1.0);
        let rough = 1.0 + 0.35 * grain[i];
        std::array::from_fn(|c| {
            let open = CROPS[crop][c];
            rough * (open + wooded * (LEAVES[c] - open))
        })
    };
    let mut texels: Vec<[f32; 3]> = (0..EDGE * EDGE).map(texel).collect();
    let mean: [f32; 3] = std::array::from_fn(|c| {
        texels.iter().map(|t| f64::from(t[c])).sum::<f64>() as f32 / texels.len() as f32
    });
    texels.iter_mut().for_each(|texel| *texel = std::array::from_fn(|c| texel[c] / mean[c]));
    texels
}

/// Noise of a power law whose mean is about 0 and whose largest values are about 1.
fn fractal(dice: &mut Dice) -> Vec<f32> {
    let mut sum = vec![0.0; EDGE * EDGE];
    for octave in 0..OCTAVES {
        let cells = COARSEST << octave;
        let values: Vec<f32> = (0..cells * cells).map(|_| dice.between(-1.0, 1.0) as f32).collect();
        let amplitude = 0.6_f32.powi(octave as i32);
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum += amplitude * between(&values, cells, i % EDGE, i / EDGE);
        }
    }
    sum
}

/// Values of a lattice that repeats itself, smoothly between its points.
fn between(values: &[f32], cells: usize, x: usize, y: usize) -> f32 {
    let place = |x: usize| {
        let x = (x as f32 + 0.5) * cells as f32 / EDGE as f32;
        let share = x.fract();
        (x as usize % cells, share * share * (3.0 - 2.0 * share))
    };
    let ((i, u), (j, v)) = (place(x), place(y));
    let at = |i: usize, j: usize| values[j % cells * cells + i % cells];
    let row = |j: usize| at(i, j) + u * (at(i + 1, j) - at(i, j));
    row(j) + v * (row(j + 1) - row(j))
}

/// Fields: what is nearest to one of their middles, as streets and hedges turn them.
struct Fields {
    /// Middles within their cells, and which crop grows there.
    middles: Vec<([f32; 2], usize)>,
}

impl Fields {
    fn new(dice: &mut Dice) -> Self {
        let middle = |_| ([dice.unit() as f32, dice.unit() as f32], dice.count(0, CROPS.len() - 1));
        Self { middles: (0..FIELDS * FIELDS).map(middle).collect() }
    }

    /// Which crop grows at a texel.
    fn at(&self, x: usize, y: usize) -> usize {
        let place = |x: usize| (x as f32 + 0.5) * FIELDS as f32 / EDGE as f32;
        let (x, y) = (place(x), place(y));
        let mut nearest = (f32::MAX, 0);
        for (i, j) in (0..9).map(|k| (k % 3, k / 3)) {
            let (column, row) = (x as usize + FIELDS + i - 1, y as usize + FIELDS + j - 1);
            let ([u, v], crop) = self.middles[row % FIELDS * FIELDS + column % FIELDS];
            let from = |cell: usize| cell as f32 - FIELDS as f32;
            let (dx, dy) = (from(column) + u - x, from(row) + v - y);
            // Fields are longer than wide.
            let distance = dx.abs().max(1.6 * dy.abs());
            if distance < nearest.0 {
                nearest = (distance, crop);
            }
        }
        nearest.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn land_reflects_its_mean_in_every_layer_and_each_is_smoother() {
        let spreads: Vec<f64> = TEXELS
            .chunks(EDGE * EDGE)
            .map(|layer| {
                let green = || layer.iter().map(|t| f64::from(t[1]));
                let count = layer.len() as f64;
                let mean = green().sum::<f64>() / count;
                assert!((mean - 1.0).abs() < 1e-4, "{mean}");
                green().map(|x| (x - mean).powi(2)).sum::<f64>() / count
            })
            .collect();
        assert_eq!(spreads.len(), smooth::LAYERS);
        assert!(spreads.windows(2).all(|pair| pair[1] < pair[0]), "{spreads:?}");
    }

    #[test]
    fn land_has_woods_and_fields_and_repeats_without_an_edge() {
        let finest = &TEXELS[..EDGE * EDGE];
        let green = |x: usize, y: usize| finest[y % EDGE * EDGE + x % EDGE][1];
        let dark = finest.iter().filter(|t| t[1] < 0.75).count() as f32 / finest.len() as f32;
        assert!((dark - WOODS).abs() < 0.08, "{dark}");
        assert!(finest.iter().all(|t| t.iter().all(|x| (0.05..4.0).contains(x))));
        let jump =
            |x: usize| (0..EDGE).map(|y| (green(x, y) - green(x + 1, y)).abs()).sum::<f32>() / EDGE as f32;
        let inside = (0..EDGE - 1).map(jump).fold(0.0, f32::max);
        assert!(jump(EDGE - 1) <= inside, "{} against {inside}", jump(EDGE - 1));
    }
}
