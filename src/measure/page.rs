//! One page that tells what a benchmark found: plots, tables, pictures, all inside it.

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::{
    Drawn, Report, SIZE, Set, View,
    plot::{Point, Series, plot},
};

/// Error maps end at this share of the light, both ways.
const MAP_END: f64 = 0.5;

/// Diverging colours of error maps, from too dark to too bright: ColorBrewer's RdBu, even in
/// lightness and safe for colour-blind eyes.
const MAP: [[f64; 3]; 7] = [
    [5.0, 48.0, 97.0],
    [67.0, 147.0, 195.0],
    [209.0, 229.0, 240.0],
    [247.0, 247.0, 247.0],
    [253.0, 219.0, 199.0],
    [214.0, 96.0, 77.0],
    [103.0, 0.0, 31.0],
];

pub(super) const STYLE: &str = include_str!("page.css");

/// The page, HTML.
pub fn page(report: &Report) -> String {
    let sections = [
        head(report),
        errors_against_cost(report),
        table(report),
        by_angle(report),
        by_scene(report),
        march(report),
        pictures(&report.views),
        about(report),
    ];
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
        <meta name=\"viewport\" content=\"width=device-width\"><meta name=\"color-scheme\" content=\"light dark\">\
        <title>nephos benchmark</title><style>{STYLE}</style></head><body><main>{}</main></body></html>\n",
        sections.concat()
    )
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn head(report: &Report) -> String {
    let commit = report.commit.as_ref().map_or(String::new(), |commit| format!(", commit {commit}"));
    let (a, [w, h]) = (&report.adapter, report.timing_size);
    let about = format!(
        "nephos {}{commit}. {} ({}, {}). {}. Timed at {w} x {h} pixels, errors at {} x {}.",
        report.version, a.name, a.backend, a.driver, report.date, SIZE[0], SIZE[1]
    );
    format!("<h1>Error and cost of every transport model</h1><p class=\"quiet\">{}</p>", escaped(&about))
}

/// The sets that have errors, those held out first: they tell more.
fn sets(report: &Report) -> Vec<Set> {
    let has = |set: &Set| report.means.iter().any(|mean| mean.set == *set);
    [Set::HeldOut, Set::Fit].into_iter().filter(has).collect()
}

fn models(report: &Report) -> Vec<&'static str> {
    let mut models: Vec<_> = report.ways().into_iter().map(|(model, _)| model).collect();
    models.dedup();
    models
}

fn qualities(report: &Report) -> Vec<&'static str> {
    let mut qualities = Vec::new();
    for (_, quality) in report.ways() {
        if !qualities.contains(&quality) {
            qualities.push(quality);
        }
    }
    qualities
}

fn errors_against_cost(report: &Report) -> String {
    let Some(&set) = sets(report).first() else { return String::new() };
    let series = |cost: fn(super::report::MeanCost) -> f64| -> Vec<Series> {
        let of = |(colour, model): (usize, &'static str)| {
            let points = qualities(report).into_iter().enumerate().filter_map(|(mark, quality)| {
                let (x, mean) = (cost(report.cost(model, quality)?), report.mean(model, quality, set)?);
                let y = mean.errors.rmse;
                let label = format!("{model}, {quality}: {x:.3}, error {y:.3}");
                Some(Point { x, y, label, mark })
            });
            Series { name: model.to_owned(), colour, points: points.collect() }
        };
        models(report).into_iter().enumerate().map(of).collect()
    };
    let error = format!("relative RMSE, {set} scenes");
    format!(
        "<h2>Error against time and work</h2><p>Lower and further left is better. {} A line joins the \
        qualities of one model.</p>{}{}",
        marks(report),
        plot("milliseconds a frame, camera moving, light at hand", &error, &series(|cost| cost.frame_ms)),
        plot("evaluations of the density and reads, per pixel", &error, &series(|cost| cost.work)),
    )
}

fn marks(report: &Report) -> String {
    let names = ["Circles are", "squares", "diamonds"];
    let told = qualities(report).into_iter().zip(names).map(|(quality, mark)| format!("{mark} {quality}"));
    format!("{}.", told.collect::<Vec<_>>().join(", "))
}

fn table(report: &Report) -> String {
    let mut rows = String::new();
    for (model, quality) in report.ways() {
        let cost = report.cost(model, quality).map_or("<td></td><td></td><td></td>".to_owned(), |cost| {
            let (frame, light, work) = (cost.frame_ms, cost.light_ms, cost.work);
            format!("<td>{frame:.1}</td><td>{light:.1}</td><td>{work:.0}</td>")
        });
        let errors: String =
            sets(report).into_iter().map(|set| mean_cells(report, model, quality, set)).collect();
        rows += &format!("<tr><th>{model}</th><th>{quality}</th>{errors}{cost}</tr>");
    }
    let groups: String = sets(report).into_iter().map(|set| format!("<th colspan=10>{set}</th>")).collect();
    let names =
        "<th>RMSE</th><th>pooled</th><th>mean</th><th>95 %</th><th>bias</th><th>PSNR</th><th>FLIP</th><th>c 1.5</th><th>c 3</th><th>c 6</th>"
            .repeat(sets(report).len());
    format!(
        "<h2>Means over the scenes</h2><div class=\"wide\"><table><tr><th></th><th></th>{groups}\
        <th colspan=3>cost</th></tr><tr><th>model</th><th>quality</th>{names}<th>frame ms</th>\
        <th>light ms</th><th>work / pixel</th></tr>{rows}</table></div>"
    )
}

fn mean_cells(report: &Report, model: &str, quality: &str, set: Set) -> String {
    let Some(mean) = report.mean(model, quality, set) else { return "<td></td>".repeat(10) };
    let e = &mean.errors;
    let contrast =
        e.contrast.map(|ratio| ratio.map_or("<td></td>".to_owned(), |ratio| format!("<td>{ratio:.2}</td>")));
    format!(
        "{}<td>{:.3}</td><td>{:.3}</td><td>{:.3}</td><td>{:+.3}</td><td>{:.1}</td><td>{:.3}</td>{}",
        heat(e.rmse),
        mean.pooled_rmse,
        e.mean_relative,
        e.p95_relative,
        e.bias,
        e.psnr,
        e.flip,
        contrast.concat()
    )
}

/// A cell with an error, the darker the greater.
fn heat(error: f64) -> String {
    let share = (100.0 * (error / 0.8).sqrt().min(1.0)).round();
    format!("<td class=\"heat\" style=\"--share:{share}%\">{error:.3}</td>")
}

fn by_angle(report: &Report) -> String {
    let Some(quality) = qualities(report).last().copied() else { return String::new() };
    let bands: String =
        super::BANDS.windows(2).map(|band| format!("<th>{} to {} deg</th>", band[0], band[1])).collect();
    let mut rows = String::new();
    for model in models(report) {
        let cells = |set| {
            let mean = report.mean(model, quality, set)?;
            Some(mean.errors.bands.map(|band| band.map_or("<td></td>".to_owned(), heat)).concat())
        };
        let cells: String = sets(report).into_iter().filter_map(cells).collect();
        rows += &format!("<tr><th>{model}</th>{cells}</tr>");
    }
    let groups: String = sets(report).into_iter().map(|set| format!("<th colspan=4>{set}</th>")).collect();
    let bands = bands.repeat(sets(report).len());
    format!(
        "<h2>RMSE by scattering angle</h2><p>Angle between sunlight and the way to the eye; {quality} \
        quality.</p><div class=\"wide\"><table><tr><th></th>{groups}</tr><tr><th>model</th>{bands}</tr>\
        {rows}</table></div>"
    )
}

fn by_scene(report: &Report) -> String {
    let Some(quality) = qualities(report).last().copied() else { return String::new() };
    let models = models(report);
    let mut rows = String::new();
    for known in &report.references {
        let score = |model: &str| {
            report.scores.iter().find(|s| (s.scene, s.model, s.quality) == (known.scene, model, quality))
        };
        let set = models.first().and_then(|model| score(model)).map_or(String::new(), |s| s.set.to_string());
        let cells: String = models
            .iter()
            .map(|model| score(model).map_or("<td></td>".to_owned(), |score| heat(score.errors.rmse)))
            .collect();
        let (samples, noise) = (known.samples, known.noise);
        rows += &format!(
            "<tr><th>{}</th><th>{set}</th>{cells}<td>{samples}</td><td>{noise:.3}</td></tr>",
            known.scene
        );
    }
    let names: String = models.iter().map(|model| format!("<th>{model}</th>")).collect();
    format!(
        "<h2>RMSE of each scene</h2><p>In {quality} quality. The reference's noise is taken off; where \
        it is much larger than an error, the error is not to be trusted.</p><div class=\"wide\"><table>\
        <tr><th>scene</th><th>set</th>{names}<th>samples</th><th>noise</th></tr>{rows}</table></div>"
    )
}

fn march(report: &Report) -> String {
    let mut curves: Vec<(String, Vec<Point>, Vec<Point>)> = Vec::new();
    for p in &report.march {
        let name = format!("{}, {}", p.scene, p.model);
        if curves.last().is_none_or(|(known, ..)| *known != name) {
            curves.push((name.clone(), Vec::new(), Vec::new()));
        }
        let steps = p.quality.map_or_else(|| format!("steps x {}", p.scale.unwrap_or(1.0)), str::to_owned);
        let mark = match p.quality {
            Some(quality) => qualities_of_march().iter().position(|known| *known == quality).unwrap_or(0),
            None => usize::MAX,
        };
        let label = format!("{name}, {steps}: {:.0} evaluations, error {:.4}", p.work.density, p.rmse);
        let point = Point { x: p.work.density, y: p.rmse.max(1e-5), label, mark };
        if let Some((_, curve, marked)) = curves.last_mut() {
            if p.quality.is_some() { marked.push(point) } else { curve.push(point) }
        }
    }
    if curves.is_empty() {
        return String::new();
    }
    let series: Vec<Series> = curves.into_iter().enumerate().flat_map(marked).collect();
    format!(
        "<h2>Error of the march alone</h2><p>The same model with longer and shorter steps, against a march \
        that has converged; light as in final quality. Circle, square and diamond are the marches of \
        draft, preview and final.</p>{}",
        plot("evaluations of the density per pixel", "relative RMSE", &series)
    )
}

/// A curve, and the qualities on it, which no line joins.
fn marked((colour, (name, mut curve, marked)): (usize, (String, Vec<Point>, Vec<Point>))) -> Vec<Series> {
    let alone = |point| Series { name: String::new(), colour, points: vec![point] };
    let mut all: Vec<Series> = marked.into_iter().map(alone).collect();
    // Ends, and has its name, where steps are shortest.
    curve.reverse();
    all.push(Series { name, colour, points: curve });
    all
}

fn qualities_of_march() -> [&'static str; 3] {
    crate::render::Quality::PRESETS.map(|(name, _)| name)
}

fn pictures(views: &[View]) -> String {
    let sets: String = views.iter().map(view).collect();
    let stops = MAP.map(|[r, g, b]| format!("rgb({r},{g},{b})")).join(",");
    format!(
        "<h2>Pictures</h2><p>Each model above its error: blue is too dark, red too bright.</p>\
        <div class=\"legend\"><span>-{MAP_END} of the light</span><i style=\"background:linear-gradient(\
        90deg,{stops})\"></i><span>+{MAP_END}</span></div>{sets}"
    )
}

fn view(view: &View) -> String {
    let drawn: String = view.drawn.iter().map(figure).collect();
    format!(
        "<h3>{} <small>{}</small></h3><div class=\"row\"><figure><img src=\"{}\" alt=\"\">\
        <figcaption>path traced</figcaption></figure>{drawn}</div>",
        view.entry.name,
        view.entry.set,
        data_uri(&view.truth)
    )
}

fn figure(drawn: &Drawn) -> String {
    let map: Vec<u8> = drawn.error.iter().flat_map(|error| error.map_or([0; 4], mapped)).collect();
    format!(
        "<figure><img src=\"{}\" alt=\"\"><img src=\"{}\" alt=\"error\"><figcaption>{} {:.3}</figcaption></figure>",
        data_uri(&drawn.picture),
        data_uri(&map),
        drawn.model,
        drawn.rmse
    )
}

/// Colour of an error, RGBA.
fn mapped(error: f64) -> [u8; 4] {
    let place = (0.5 + 0.5 * error / MAP_END).clamp(0.0, 1.0) * (MAP.len() - 1) as f64;
    let below = (place as usize).min(MAP.len() - 2);
    let [r, g, b] = [0, 1, 2].map(|c| {
        let share = place - below as f64;
        (MAP[below][c] * (1.0 - share) + MAP[below + 1][c] * share).round() as u8
    });
    [r, g, b, 255]
}

/// An RGBA picture of the corpus's size as an address that holds it.
fn data_uri(rgba: &[u8]) -> String {
    let mut png = Vec::new();
    let written = PngEncoder::new(&mut png).write_image(rgba, SIZE[0], SIZE[1], ExtendedColorType::Rgba8);
    // Memory takes all that is written, and the size is the corpus's: a picture that failed is
    // seen to be missing.
    if written.is_err() { String::new() } else { format!("data:image/png;base64,{}", base64(&png)) }
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let bits =
            chunk.iter().fold(0u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for i in 0..4 {
            let digit = (bits >> (18 - 6 * i)) & 63;
            text.push(if i <= chunk.len() { char::from(DIGITS[digit as usize]) } else { '=' });
        }
    }
    text
}

fn about(report: &Report) -> String {
    let left_out: String =
        report.left_out.iter().map(|reason| format!("<li>{}</li>", escaped(reason))).collect();
    let left_out =
        if left_out.is_empty() { left_out } else { format!("<p>Left out:</p><ul>{left_out}</ul>") };
    format!(
        "<h2>How to read this</h2><p>Light of the clouds alone, without air before them, against an unbiased \
        path tracer over the same density. RMSE: root of the mean squared error over the root of the mean \
        squared light, over pixels more opaque than 0.3, the reference's variance taken off. Pooled: \
        the root of the mean squared RMSE of the scenes, in which noise is not cut off at 0. Mean and 95 %: of \
        |error| / light. Bias: ratio of the sums of light, less 1. PSNR and FLIP are of finished pictures over \
        the sky. c: relief inside clouds between blurs of so many pixels and twice that, over the reference's. Numbers of models may be fitted to the scenes of the set fit; nothing is tuned on those held \
        out. Pictures have 3 x 3 rays a pixel. Definitions: docs/benchmark.md.</p>{left_out}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        let known = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (text, code) in known {
            assert_eq!(base64(text.as_bytes()), code);
        }
    }

    #[test]
    fn error_maps_are_white_in_the_middle_and_end() {
        assert_eq!(mapped(0.0), [247, 247, 247, 255]);
        assert_eq!([mapped(9.0), mapped(-9.0)], [[103, 0, 31, 255], [5, 48, 97, 255]]);
    }
}
