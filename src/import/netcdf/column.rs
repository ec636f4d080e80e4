//! Columns of cells of uneven heights, brought to even ones so that each keeps what it holds.

/// Amounts each metre in even cells of `edge` m from the height 0 on, of cells whose walls are at `walls`, m, lowest
/// first, and which hold `amounts` each metre. What is below 0 goes into the lowest cell.
pub(super) fn even(walls: &[f64], amounts: &[f64], edge: f64, count: usize) -> Vec<f64> {
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
