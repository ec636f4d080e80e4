//! Columns of cells of uneven heights, brought to even ones so that each keeps what it holds.

use glam::{DAffine3, DMat3, DVec3};

use super::super::bytes::Problem;
use crate::scene::Grid;

/// Columns of cells, x fastest.
pub(super) struct Columns<'a> {
    /// Levels, rows, columns.
    pub size: [usize; 3],
    /// Heights of the walls of the cells of a column, m, lowest first.
    pub walls: &'a dyn Fn(usize) -> Vec<f64>,
    /// What a cell of a column holds, each metre.
    pub amount: &'a dyn Fn(usize, usize) -> f64,
    /// Height that even cells begin at, or below it where there are any, m.
    pub floor: f64,
    pub most_heights: f64,
}

impl Columns<'_> {
    /// They as a grid with z up, on even heights as thin as the thinnest cell: the middle of the first column is at `corner`, the
    /// others `steps` apart, m.
    pub fn grid(&self, name: &str, corner: [f64; 2], steps: [f64; 2]) -> Result<Grid, Problem> {
        let [levels, rows, columns] = self.size;
        let (mut lowest, mut highest, mut thinnest) = (self.floor, f64::NEG_INFINITY, f64::INFINITY);
        for column in 0..rows * columns {
            let walls = (self.walls)(column);
            lowest = walls.iter().copied().fold(lowest, f64::min);
            highest = walls.iter().copied().fold(highest, f64::max);
            thinnest = walls.windows(2).map(|wall| wall[1] - wall[0]).fold(thinnest, f64::min);
        }
        let edge = thinnest.max((highest - lowest) / self.most_heights);
        let count = ((highest - lowest) / edge).ceil().max(1.0) as usize;
        let mut values = vec![0.0f32; count * rows * columns];
        for column in 0..rows * columns {
            let walls: Vec<f64> = (self.walls)(column).into_iter().map(|wall| wall - lowest).collect();
            let amounts: Vec<f64> = (0..levels).map(|level| (self.amount)(column, level)).collect();
            for (height, value) in even(&walls, &amounts, edge, count).into_iter().enumerate() {
                values[height * rows * columns + column] = value as f32;
            }
        }
        let corner = DVec3::new(corner[0], corner[1], lowest + 0.5 * edge);
        let edges = DVec3::new(steps[0], steps[1], edge);
        let place = DAffine3::from_mat3_translation(DMat3::from_diagonal(edges), corner);
        let size = [columns, rows, count].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        Grid::dense(name.to_owned(), place, size, values.into_iter())
    }
}

/// Amounts each metre in even cells of `edge` m from the height 0 on, of cells whose walls are at `walls`, m, lowest
/// first, and which hold `amounts` each metre. What is below 0 goes into the lowest cell.
fn even(walls: &[f64], amounts: &[f64], edge: f64, count: usize) -> Vec<f64> {
    let mut cells = vec![0.0; count];
    for (pair, amount) in walls.windows(2).zip(amounts) {
        let (low, high) = (pair[0] / edge, pair[1] / edge);
        let last = count.saturating_sub(1) as f64;
        let (first, end) = (low.floor().clamp(0.0, last), high.ceil().clamp(1.0, last + 1.0));
        for (i, held) in cells.iter_mut().enumerate().take(end as usize).skip(first as usize) {
            let cell = i as f64;
            let below = if i == 0 { f64::NEG_INFINITY } else { cell };
            let above = if i + 1 == count { f64::INFINITY } else { cell + 1.0 };
            *held += amount * (high.min(above) - low.max(below)).max(0.0);
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_keeps_what_it_holds_whatever_its_heights() {
        let walls = [-13.0, 40.0, 95.0, 320.0, 333.0, 900.0, 1477.0];
        let amounts = [0.3, 0.0, 2.0, 9.0, 0.5, 0.01];
        let whole: f64 =
            walls.windows(2).zip(amounts).map(|(wall, amount)| (wall[1] - wall[0]) * amount).sum();
        for (edge, count) in [(10.0, 160), (100.0, 15), (37.0, 40), (500.0, 3), (2000.0, 1)] {
            let cells = even(&walls, &amounts, edge, count);
            let found: f64 = cells.iter().map(|cell| cell * edge).sum();
            assert!((found / whole - 1.0).abs() < 1e-12, "{edge}: {found} for {whole}");
        }
        // Within a cell of the model it is as even as there.
        assert!((even(&walls, &amounts, 10.0, 160)[20] - 2.0).abs() < 1e-12);
    }
}
