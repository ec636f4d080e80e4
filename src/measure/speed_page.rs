//! One page that tells how fast scenes are: plots and a table, all inside it.

use super::{
    KOL, Speed, SpeedReport,
    page::{STYLE, escaped},
    plot::{Point, Series, plot},
};

/// The page, HTML.
pub fn speed_page(report: &SpeedReport) -> String {
    let sections = [head(report), plots(report), table(report), passes(report), about()];
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
        <meta name=\"viewport\" content=\"width=device-width\"><meta name=\"color-scheme\" content=\"light dark\">\
        <title>nephos speed</title><style>{STYLE}</style></head><body><main>{}</main></body></html>\n",
        sections.concat()
    )
}

fn head(report: &SpeedReport) -> String {
    let commit = report.commit.as_ref().map_or(String::new(), |commit| format!(", commit {commit}"));
    let a = &report.adapter;
    let gflops = report.gflops.map_or(String::new(), |gflops| format!(" Said to have {gflops} GFLOPS."));
    let about = format!(
        "nephos {}{commit}. {} ({}, {}).{gflops} {}. Medians of {} frames.",
        report.version, a.name, a.backend, a.driver, report.date, report.frames
    );
    format!("<h1>How fast scenes are</h1><p class=\"quiet\">{}</p>", escaped(&about))
}

/// Times against the number of clouds, a line for each quality, size and motion.
fn plots(report: &SpeedReport) -> String {
    let mut series: [Vec<Series>; 2] = Default::default();
    for speed in &report.speeds {
        let name = format!("{}, {}, {}x{}", speed.quality, speed.motion, speed.size[0], speed.size[1]);
        let mark = usize::from(speed.motion != super::Motion::Standing);
        for (series, y) in series.iter_mut().zip([speed.recorded_ms, speed.frame_ms]) {
            let x = speed.clouds.max(1) as f64;
            let label = format!("{}, {name}: {y:.3} ms", speed.scene);
            let point = Point { x, y: y.max(1e-4), label, mark };
            match series.iter_mut().find(|known| known.name == name) {
                Some(known) => known.points.push(point),
                None => series.push(Series { colour: series.len(), name: name.clone(), points: vec![point] }),
            }
        }
    }
    for one in series.iter_mut().flatten() {
        one.points.sort_by(|a, b| a.x.total_cmp(&b.x));
    }
    let [recorded, frames] = &series;
    format!(
        "<h2>Time against the number of clouds</h2><p>Circles are frames of a camera that stands, squares of one that \
        flies.</p>{}{}",
        plot("clouds", "milliseconds to record a frame", recorded),
        plot("clouds", "milliseconds a frame", frames),
    )
}

fn table(report: &SpeedReport) -> String {
    let rows: String = report.speeds.iter().map(|speed| row(report, speed)).collect();
    let names = [
        "scene",
        "clouds",
        "quality",
        "size",
        "camera",
        "first s",
        "record ms",
        "submit ms",
        "frame ms",
        "made",
        "rays",
        "hits",
        "density",
        "noise",
        "maps",
        "ellipsoids",
        "volumes",
        "MiB",
        "Mpix/s",
        "kpix/s/GFLOPS",
    ];
    let names: String = names.iter().map(|name| format!("<th>{name}</th>")).collect();
    format!(
        "<h2>Scene by scene</h2><p>Work is that of a pixel that clouds cover by more than half.</p>\
        <div class=\"wide\"><table><tr>{names}</tr>{rows}</table></div>"
    )
}

fn row(report: &SpeedReport, s: &Speed) -> String {
    let u = &s.usage;
    let made = s.made.buffers + s.made.textures + s.made.groups + s.made.pipelines;
    let efficiency = report.efficiency(s).map_or(String::new(), |found| format!("{found:.2}"));
    let cells = [
        s.clouds.to_string(),
        s.quality.to_owned(),
        format!("{}x{}", s.size[0], s.size[1]),
        s.motion.to_string(),
        format!("{:.2}", s.first_s),
        format!("{:.3}", s.recorded_ms),
        format!("{:.3}", s.submitted_ms),
        format!("{:.1}", s.frame_ms),
        made.to_string(),
        format!("{:.1}", u.rays),
        format!("{:.1}", u.hits),
        format!("{:.1}", u.density),
        format!("{:.1}", u.noise_reads),
        format!("{:.1}", u.map_reads),
        format!("{:.1}", u.ellipsoids),
        format!("{:.1}", u.volume_reads),
        format!("{:.1}", s.bytes as f64 / f64::from(1 << 20)),
        format!("{:.3}", 1e-6 * s.pixels_per_s),
        efficiency,
    ];
    let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
    format!("<tr><th>{}</th>{cells}</tr>", escaped(&s.scene))
}

fn passes(report: &SpeedReport) -> String {
    let row = |speed: &Speed| {
        let times: Vec<_> = speed.passes.iter().map(|pass| format!("{} {:.3}", pass.pass, pass.ms)).collect();
        let name = format!("{}, {}, {}", speed.scene, speed.quality, speed.motion);
        format!("<tr><th>{}</th><td>{}</td></tr>", escaped(&name), escaped(&times.join(", ")))
    };
    let rows: String = report.speeds.iter().filter(|speed| !speed.passes.is_empty()).map(row).collect();
    if rows.is_empty() {
        return "<h2>Passes</h2><p>This adapter has no time stamps.</p>".to_owned();
    }
    format!(
        "<h2>Passes</h2><p>Milliseconds by the adapter's clock.</p><div class=\"wide\"><table>{rows}</table></div>"
    )
}

fn about() -> String {
    format!(
        "<p class=\"quiet\">Kol (2013) has {KOL} thousand pixels a second for each GFLOPS of his graphics card. \
        docs/speed.md has the definitions.</p>"
    )
}
