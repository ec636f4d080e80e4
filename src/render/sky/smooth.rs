//! Layers of a picture, each half as fine as the one before, of the same size.

/// How many.
pub(super) const LAYERS: usize = 6;

/// All layers of a picture of so many columns and rows, the finest first; `beyond` tells the place along an edge that is
/// taken for one beyond it.
pub(super) fn layers(
    finest: Vec<[f32; 3]>,
    size: [usize; 2],
    beyond: fn(isize, isize) -> isize,
) -> Vec<[f32; 3]> {
    let mut all = vec![finest];
    for layer in 1..LAYERS {
        all.push(smoothed(&all[layer - 1], size, beyond, 1 << (layer - 1)));
    }
    all.concat()
}

/// Means of texels and those `step` beside them, along rows and then along columns.
fn smoothed(
    finer: &[[f32; 3]],
    [width, height]: [usize; 2],
    beyond: fn(isize, isize) -> isize,
    step: isize,
) -> Vec<[f32; 3]> {
    let beside =
        |x: usize, edge: usize| [-step, 0, step].map(|by| beyond(x as isize + by, edge as isize) as usize);
    let mean = |three: [[f32; 3]; 3]| {
        std::array::from_fn::<f32, 3, _>(|c| 0.25 * (three[0][c] + three[2][c]) + 0.5 * three[1][c])
    };
    let places = || (0..finer.len()).map(|i| (i % width, i / width));
    let rows: Vec<[f32; 3]> =
        places().map(|(x, y)| mean(beside(x, width).map(|x| finer[y * width + x]))).collect();
    places().map(|(x, y)| mean(beside(y, height).map(|y| rows[y * width + x]))).collect()
}
