//! Plots as SVG inside a page, whose style sheet gives the colours: light or dark.

use std::fmt::Write;

/// Points of one colour, joined by a line in their order.
pub struct Series {
    /// Name, told at the last point.
    pub name: String,
    /// Place of the colour in the page's list.
    pub colour: usize,
    /// The points.
    pub points: Vec<Point>,
}

/// A point of a plot; both coordinates above 0.
pub struct Point {
    /// Along the abscissa.
    pub x: f64,
    /// Along the ordinate.
    pub y: f64,
    /// What it is, told when it is pointed at.
    pub label: String,
    /// The mark: 0 a circle, 1 a square, 2 a diamond; others a small dot.
    pub mark: usize,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 430.0;
/// Left, top, right, bottom.
const MARGINS: [f64; 4] = [62.0, 14.0, 150.0, 48.0];

/// Both axes logarithmic.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

/// A plot with logarithmic axes; nothing where there are no points.
pub fn plot(x_label: &str, y_label: &str, series: &[Series]) -> String {
    let points = || series.iter().flat_map(|series| &series.points);
    if points().next().is_none() {
        return String::new();
    }
    let axes = Axes { x: range(points().map(|p| p.x)), y: range(points().map(|p| p.y)) };
    let mut svg = format!(r#"<svg class="plot" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">"#);
    axes.draw(&mut svg, x_label, y_label);
    for series in series {
        axes.line(&mut svg, series);
        series.points.iter().for_each(|point| axes.mark(&mut svg, series.colour, point));
    }
    axes.names(&mut svg, series);
    svg + "</svg>"
}

/// Least and greatest with a margin, of numbers that a logarithm takes.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let values = values.filter(|v| *v > 0.0 && v.is_finite());
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    if low > high { [0.1, 1.0] } else { [low / 1.25, high * 1.25] }
}

fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    (value.max(low) / low).ln() / (high / low).ln()
}

/// 1, 2 and 5 times the powers of ten in the range; powers alone where these are many.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let few: &[f64] = if high / low > 300.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
    let all = powers.flat_map(|power| few.iter().map(move |digit| digit * 10f64.powi(power)));
    all.filter(|tick| (low..=high).contains(tick)).collect()
}

impl Axes {
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let [left, top, right, bottom] = MARGINS;
        let across = left + share(x, self.x) * (WIDTH - left - right);
        (across, HEIGHT - bottom - share(y, self.y) * (HEIGHT - top - bottom))
    }

    fn draw(&self, svg: &mut String, x_label: &str, y_label: &str) {
        let [left, top, right, bottom] = MARGINS;
        let (far, low) = (WIDTH - right, HEIGHT - bottom);
        for tick in ticks(self.x) {
            let (x, _) = self.place(tick, self.y[0]);
            put(svg, format_args!(r#"<line class="grid" x1="{x:.1}" y1="{top}" x2="{x:.1}" y2="{low}"/>"#));
            let y = low + 17.0;
            put(svg, format_args!(r#"<text x="{x:.1}" y="{y}" text-anchor="middle">{tick}</text>"#));
        }
        for tick in ticks(self.y) {
            let (_, y) = self.place(self.x[0], tick);
            put(svg, format_args!(r#"<line class="grid" x1="{left}" y1="{y:.1}" x2="{far}" y2="{y:.1}"/>"#));
            let (x, y) = (left - 8.0, y + 4.0);
            put(svg, format_args!(r#"<text x="{x}" y="{y:.1}" text-anchor="end">{tick}</text>"#));
        }
        let (middle, under, side) = (0.5 * (left + far), HEIGHT - 10.0, 0.5 * (top + low));
        put(svg, format_args!(r#"<text x="{middle}" y="{under}" text-anchor="middle">{x_label}</text>"#));
        let turned = format!(r#"transform="translate(15 {side}) rotate(-90)" text-anchor="middle""#);
        put(svg, format_args!("<text {turned}>{y_label}</text>"));
    }

    fn line(&self, svg: &mut String, series: &Series) {
        let places: Vec<String> = series
            .points
            .iter()
            .map(|point| self.place(point.x, point.y))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let (colour, places) = (series.colour, places.join(" "));
        put(svg, format_args!(r#"<polyline class="line c{colour}" points="{places}"/>"#));
    }

    fn mark(&self, svg: &mut String, colour: usize, point: &Point) {
        let (x, y) = self.place(point.x, point.y);
        let shape = match point.mark {
            0 => format!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="5"/>"#),
            1 => format!(r#"<rect x="{:.1}" y="{:.1}" width="9" height="9"/>"#, x - 4.5, y - 4.5),
            2 => format!(r#"<path d="M{x:.1} {:.1}l6.5 6.5l-6.5 6.5l-6.5 -6.5z"/>"#, y - 6.5),
            _ => format!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="2.5"/>"#),
        };
        put(svg, format_args!(r#"<g class="mark c{colour}"><title>{}</title>{shape}</g>"#, point.label));
    }

    /// Names beside the last points, moved apart where they would meet.
    fn names(&self, svg: &mut String, series: &[Series]) {
        let last = |series: &Series| {
            let point = series.points.last()?;
            let (x, y) = self.place(point.x, point.y);
            Some((x + 11.0, y + 4.0, series.colour, series.name.clone()))
        };
        let mut names: Vec<_> = series.iter().filter_map(last).collect();
        names.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut above: Vec<(f64, f64)> = Vec::new();
        for (x, y, colour, name) in names {
            // Only names that are beside each other can meet.
            let near = above.iter().filter(|(other, _)| (other - x).abs() < 130.0);
            let y = near.fold(y, |y, (_, other)| y.max(other + 14.0));
            above.push((x, y));
            put(svg, format_args!(r#"<text class="name c{colour}" x="{x:.1}" y="{y:.1}">{name}</text>"#));
        }
    }
}

fn put(svg: &mut String, what: std::fmt::Arguments<'_>) {
    // A string takes whatever it is given.
    let _ = svg.write_fmt(what);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_within_the_range() {
        assert_eq!(ticks([0.09, 1.1]), [0.1, 0.2, 0.5, 1.0]);
        assert_eq!(ticks([1.0, 5000.0]), [1.0, 10.0, 100.0, 1000.0]);
    }

    #[test]
    fn every_point_is_drawn_and_nothing_is_no_plot() {
        let point = |x, y| Point { x, y, label: "l".to_owned(), mark: 1 };
        let points = vec![point(1.0, 0.1), point(10.0, 0.5)];
        let svg = plot("x", "y", &[Series { name: "n".to_owned(), colour: 0, points }]);
        assert_eq!(svg.matches("<title>").count(), 2);
        assert!(!svg.contains("NaN"));
        assert!(plot("x", "y", &[]).is_empty());
    }
}
