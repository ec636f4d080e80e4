//! How much of what lies along a ray is seen through a cloud.

use crate::harness::{Input, Random, Twin, Wide};
use crate::pack::{input, one, plane, scalars};

pub fn twins() -> Vec<Twin> {
    vec![
        Twin::new("visibility_level", "visibility", "return vec4f(visibility_level(u32(x[0].x)));", |x| {
            one(1.0 - x[0][0] / 9.0)
        })
        .edges(plane(&[0.0, 1.0, 5.0, 8.0, 9.0], &[0.0]))
        .beside(1.0)
        .over("all", |random| scalars([random.index(10) as f64]))
        .beside(1.0),
        Twin::new(
            "visibility_reached",
            "visibility",
            "return vec4f(visibility_reached(x[0].x, x[0].y, x[0].z, x[0].w, x[1].x));",
            |x| {
                // As deep, in optical depth, as the level is.
                let ([t, length, before, after], level) = (x[0], x[1][0]);
                let deep = |transmittance: f64| -(transmittance / before).ln();
                one(t + length * deep(level) / deep(after.max(1e-30)))
            },
        )
        .over("all", |random| {
            let (before, optical_depth) = (random.between(0.1, 1.0), random.log(0.05, 50.0));
            let level = before * (-optical_depth * random.between(0.1, 1.0)).exp();
            let length = random.log(0.1, 1e3);
            input([
                [random.between(1.0, 1e4), length, before, before * (-optical_depth).exp()],
                [level.max(1e-20), 0.0, 0.0, 0.0],
            ])
        }),
        Twin::new(
            "visibility_share",
            "visibility",
            "return vec4f(visibility_share(x[0].x, x[0].y, x[0].z));",
            |x| {
                // By the sum of both: the share of the piece of what is taken in it by the two.
                let [before, after, own, _] = x[0];
                let both = own + (before / after).ln();
                one(before * (own / both) * (-both).exp_m1() / (-own).exp_m1())
            },
        )
        .over("all", |random| {
            let before = random.between(0.01, 1.0);
            scalars([before, before * (-random.log(1e-3, 8.0)).exp(), random.log(1e-3, 20.0)])
        }),
        Twin::new(
            "visibility_at",
            "visibility",
            "return vec4f(visibility_at(Visibility(x[0], x[1], x[2]), x[3].x));",
            |x| one(seen_past(x)),
        )
        .over("all", visibility)
        // A step between two marks that are as good as one is steep.
        .beside(20.0),
    ]
}

/// What is told of a ray's transmittance: ten distances and the opacity; then a distance.
fn visibility(random: &mut Random) -> Input {
    let opacity = [1.0, random.between(0.0, 1.0), random.log(1e-3, 1.0)][random.index(3)];
    let mut marks = [0.0; 10].map(|_| random.log(0.01, 20.0));
    marks.sort_by(f64::total_cmp);
    // Levels that are never reached are where all ends.
    for (i, mark) in marks.into_iter().enumerate().skip(1).collect::<Vec<_>>() {
        marks[i] = if 1.0 - i as f64 / 9.0 < 1.0 - opacity { marks[9] } else { mark };
    }
    let place = random.between(0.9 * marks[0], 1.1 * marks[9]);
    input([
        [marks[0], marks[1], marks[2], marks[3]],
        [marks[4], marks[5], marks[6], marks[7]],
        [marks[8], marks[9], opacity, 0.5],
        [place, 0.0, 0.0, 0.0],
    ])
}

/// Straight lines of the logarithm between the marks, at each of which the transmittance is a ninth less, but no less than at last.
fn seen_past(x: &Wide) -> f64 {
    let mark = |i: usize| x[i / 4][i % 4];
    let (least, place) = (1.0 - x[2][2], x[3][0]);
    let through = |i: usize| (1.0 - i as f64 / 9.0).max(least);
    if place <= mark(0) {
        return 1.0;
    }
    let Some(next) = (1..10).find(|&i| place < mark(i)) else { return least };
    let (a, b) = (mark(next - 1), mark(next));
    let [from, to] = [next - 1, next].map(|i| through(i).max(1e-3));
    from * (to / from).powf((place - a) / (b - a))
}
