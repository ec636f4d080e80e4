//! The report on the models of slabs: `cargo run --release --example slab_report` prints the
//! numbers of `tables/README.md` and draws its plots into `tables/plots`.
#![allow(clippy::print_stdout, reason = "a report is for reading")]

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use nephos::optics::slab::compare::{Probe, errors, probes};
use nephos::optics::slab::samples::View;
use nephos::optics::slab::study::{DEGREE, droplets};
use nephos::optics::slab::walks::{self, Deflection, Walks};
use nephos::optics::slab::{
    Beam, Field, Medium, SETS, Solver, angles::Quadrature, axes, collector, moments, spread,
};
use nephos::optics::slab::{slab_functions, slab_moments, slab_radiance};
use nephos::scene::Droplets;
use nephos::tables::Grid;
use plotters::prelude::*;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

const SET_NAMES: [&str; SETS + 1] = ["2", "3", "4", "5-6", "7-9", "10-15", "16 and more", "all"];

/// Names and colours of the models, in the order of [`Models::of`].
const MODELS: [(&str, RGBColor); 3] = [
    ("direct table", RGBColor(30, 110, 190)),
    ("Bouthors' functions", RGBColor(205, 85, 30)),
    ("source moments", RGBColor(20, 140, 90)),
];
const EXACT: RGBColor = RGBColor(60, 60, 66);

fn main() -> Outcome {
    let folder = Path::new("tables/plots");
    std::fs::create_dir_all(folder)?;
    let solver = Solver::new(Medium::chopped(&droplets()?, DEGREE));
    let models = Models { medium: Medium::chopped(&droplets()?, DEGREE), moments: slab_moments()? };
    report_errors(&models, &solver, &folder.join("errors.svg"))?;
    report_collector()?;
    report_fluxes(&solver, &folder.join("fluxes.svg"))?;
    let reflected = [(-0.3, 0.0), (-0.9, PI)];
    let transmitted = [(0.9, 0.0), (0.5, PI)];
    draw_thickness(&models, &solver, &folder.join("reflected.svg"), "Reflected", 0.0, reflected)?;
    draw_thickness(&models, &solver, &folder.join("transmitted.svg"), "Transmitted", 1.0, transmitted)
}

struct Models {
    medium: Medium,
    moments: &'static Grid,
}

impl Models {
    /// C of all sets and of their sum, by one of [`MODELS`].
    fn of(&self, model: usize, view: View) -> Outcome<[f64; SETS + 1]> {
        let mut c: [f64; SETS + 1] = [0.0; SETS + 1];
        for (set, c) in c.iter_mut().enumerate().take(SETS) {
            *c = match model {
                0 => slab_radiance()?.radiance(set, view),
                1 => slab_functions()?.0.radiance(set, view),
                _ => along(view, |depth, x| {
                    moments::source(self.moments, set, [view.thickness, depth, view.mu0], [view.mu, x])
                }),
            };
        }
        c[SETS] = c[..SETS].iter().sum();
        if model == 2 {
            let remainder = |depth: f64| moments::remainder(&self.medium, depth / view.mu0, view.cosine());
            c[SETS] += along(view, |depth, _| remainder(depth));
        }
        Ok(c)
    }
}

/// The integral of a source along a view, by depth and the product of the parts of view and
/// sun across the normal.
fn along(view: View, source: impl Fn(f64, f64) -> f64) -> f64 {
    let x = ((1.0 - view.mu * view.mu) * (1.0 - view.mu0 * view.mu0)).sqrt() * view.phi.cos();
    let opacity = view.beam().opacity(view.depth, view.mu);
    let rule = Quadrature::new(12);
    let mean: f64 = rule
        .mu
        .iter()
        .zip(&rule.weight)
        .map(|(u, weight)| weight * source(view.depth + (1.0 - u * opacity).ln() * view.mu, x))
        .sum();
    opacity * mean
}

fn report_errors(models: &Models, solver: &Solver, path: &Path) -> Outcome {
    let probes = probes(solver, 64, 200, 2);
    println!("relative error of C, rms and worst, over {} views", probes.len());
    let mut all = Vec::new();
    for (model, (name, _)) in MODELS.iter().enumerate() {
        let found: Vec<[f64; SETS + 1]> =
            probes.iter().map(|probe| models.of(model, probe.view)).collect::<Outcome<_>>()?;
        let errors = errors(&probes, |set, i| found[i][set]);
        // What belongs to no set, the remainder, is in the sum.
        let whole = whole_errors(&probes, &found);
        let rms: Vec<f64> = errors[..SETS].iter().map(|e| e.rms).chain([whole.0]).collect();
        let worst: Vec<f64> = errors[..SETS].iter().map(|e| e.worst).chain([whole.1]).collect();
        let cells = rms.iter().zip(&worst).map(|(r, w)| format!("{:.1} / {:.0}", 100.0 * r, 100.0 * w));
        println!("| {name} | {} |", cells.collect::<Vec<_>>().join(" | "));
        all.push(rms);
    }
    draw_errors(path, &all)
}

/// The same as [`errors`] has for the sum, of models that know more of it than of the sets.
fn whole_errors(probes: &[Probe], found: &[[f64; SETS + 1]]) -> (f64, f64) {
    let sums =
        probes.iter().zip(found).map(|(probe, found)| (probe, probe.truth.iter().sum::<f64>(), found[SETS]));
    let lit = sums.filter(|(probe, whole, _)| *whole >= 0.02 * probe.brightest);
    let errors: Vec<f64> = lit.map(|(_, whole, found)| (found / whole - 1.0).abs()).collect();
    let square: f64 = errors.iter().map(|error| error * error).sum();
    ((square / errors.len() as f64).sqrt(), errors.iter().copied().fold(0.0, f64::max))
}

fn report_collector() -> Outcome {
    let deflection = Deflection::chopped(&droplets()?);
    let jobs = walks::THICKNESSES * walks::SUNS;
    // Another seed than that of the tables.
    let walks: Vec<Walks> = (0..jobs).map(|job| Walks::for_tables(&deflection, job, 9)).collect();
    let places = collector::places(&walks);
    let measured = spread::measure(&walks);
    let (_, table) = slab_functions()?;
    println!("collector: error of the centre over the spread, rms; relative error of the spread, rms");
    for (set, name) in SET_NAMES.iter().enumerate().take(SETS) {
        let (mut sum, mut whole) = (0.0, 0.0);
        for place in places.iter().filter(|place| place.set == set) {
            let found = table.center(set, place.view);
            let error: f64 = (0..2).map(|i| (found[i] - place.mean[i]).powi(2)).sum();
            sum += place.weight.powi(4) * error / place.sigma.powi(2).max(1e-6);
            whole += place.weight.powi(4);
        }
        let spreads: Vec<f64> = measured
            .iter()
            .filter(|m| m.set == set)
            .map(|m| (spread::spread(set, m.thickness, m.depth) / m.sigma - 1.0).powi(2))
            .collect();
        let rms = (spreads.iter().sum::<f64>() / spreads.len() as f64).sqrt();
        println!("| {name} | {:.2} | {:.0} % |", f64::sqrt(sum / whole), 100.0 * rms);
    }
    Ok(())
}

/// Reflected and transmitted shares of sunlight, the unscattered included.
fn fluxes(field: &Field) -> [f64; 2] {
    let Beam { thickness, mu0 } = field.beam();
    let parts = (0..SETS).map(|set| field.fluxes(set)).chain([field.single_fluxes()]);
    parts.fold([0.0, (-thickness / mu0).exp()], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
}

fn report_fluxes(solver: &Solver, path: &Path) -> Outcome {
    let per_metre = Droplets::default().extinction() * (1.0 - droplets()?.f);
    let at = |metres: f64, mu0: f64| fluxes(&solver.solve(Beam { thickness: per_metre * metres, mu0 }, 0));
    for sun_deg in [0.0_f64, 30.0, 60.0] {
        let mu0 = sun_deg.to_radians().cos();
        let (mut low, mut high) = (1.0_f64, 5000.0);
        while high / low > 1.001 {
            let middle = (low * high).sqrt();
            let [r, t] = at(middle, mu0);
            if r < t { low = middle } else { high = middle }
        }
        println!("sun at {sun_deg} degrees: reflectance overtakes transmittance at {high:.0} m");
    }
    // Multiply scattered light along the normal, the sun as good as in the zenith.
    let along_normal = |metres: f64| {
        let field = solver.solve(Beam { thickness: per_metre * metres, mu0: 0.99999 }, DEGREE);
        let light = |mu: f64, level: usize| -> f64 {
            (0..SETS).map(|set| field.radiance(set, mu, &[0.0])[0][level]).sum()
        };
        [light(-1.0, 0), light(1.0, field.depths().len() - 1)]
    };
    let (mut low, mut high) = (1.0_f64, 5000.0);
    while high / low > 1.01 {
        let middle = (low * high).sqrt();
        let [r, t] = along_normal(middle);
        if r < t { low = middle } else { high = middle }
    }
    println!("sun in the zenith: the lit face is as bright as the other along the normal at {high:.0} m");
    for metres in [225.0, 500.0, 900.0] {
        let [r, t] = at(metres, 1.0);
        println!("{metres} m, sun in the zenith: R {r:.3}, T {t:.3}");
    }
    let root = SVGBackend::new(path, (760, 440)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("A slab of 400 droplets of 6 um in a cubic centimetre", ("sans-serif", 18))
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(52)
        .build_cartesian_2d((10.0..3000.0_f64).log_scale(), 0.0..1.0)?;
    chart
        .configure_mesh()
        .light_line_style(RGBColor(242, 242, 242))
        .bold_line_style(RGBColor(228, 228, 228))
        .x_desc("thickness, m")
        .y_desc("share of the sun's flux")
        .label_style(("sans-serif", 13))
        .draw()?;
    for (sun_deg, color) in [(0.0_f64, MODELS[0].1), (60.0, MODELS[1].1)] {
        let mu0 = sun_deg.to_radians().cos();
        let curve: Vec<(f64, [f64; 2])> = (0..60)
            .map(|i| 10.0 * 300.0_f64.powf(f64::from(i) / 59.0))
            .map(|metres| (metres, at(metres, mu0)))
            .collect();
        let reflected = curve.iter().map(|(x, y)| (*x, y[0]));
        chart
            .draw_series(LineSeries::new(reflected, color.stroke_width(2)))?
            .label(format!("reflected, sun {sun_deg} degrees from the zenith"))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], color.stroke_width(2)));
        let through = curve.iter().map(|(x, y)| (*x, y[1]));
        chart
            .draw_series(DashedLineSeries::new(through, 6, 4, color.stroke_width(2)))?
            .label(format!("transmitted, sun {sun_deg} degrees from the zenith"))
            .legend(move |(x, y)| {
                EmptyElement::at((x, y))
                    + PathElement::new([(0, 0), (9, 0)], color.stroke_width(2))
                    + PathElement::new([(14, 0), (23, 0)], color.stroke_width(2))
            });
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::MiddleRight)
        .background_style(WHITE.mix(0.9))
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Bars of the rms error of each set, one colour a model; the scale is logarithmic.
fn draw_errors(path: &Path, all: &[Vec<f64>]) -> Outcome {
    let root = SVGBackend::new(path, (760, 400)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("Relative error of C by set of orders, rms", ("sans-serif", 18))
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..(SETS + 1) as f64, (0.005..3.0).log_scale())?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(RGBColor(242, 242, 242))
        .bold_line_style(RGBColor(228, 228, 228))
        .x_labels(0)
        .y_label_formatter(&|y| format!("{} %", 100.0 * y))
        .label_style(("sans-serif", 13))
        .draw()?;
    for (model, (name, color)) in MODELS.iter().enumerate() {
        let bar = |set: usize| {
            let left = set as f64 + 0.14 + 0.25 * model as f64;
            Rectangle::new([(left, 0.005), (left + 0.22, all[model][set])], color.filled())
        };
        let color = *color;
        chart
            .draw_series((0..=SETS).map(bar))?
            .label(*name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 14, y + 5)], color.filled()));
    }
    let style = TextStyle::from(("sans-serif", 13)).color(&EXACT);
    for (set, name) in SET_NAMES.iter().enumerate() {
        let (x, y) = chart.backend_coord(&(set as f64 + 0.5, 0.005));
        let width = root.estimate_text_size(name, &style)?.0 as i32;
        root.draw_text(name, &style, (x - width / 2, y + 10))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.9))
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}

/// C against thickness at a face, 0 the lit one: a panel a set, two views each.
fn draw_thickness(
    models: &Models,
    solver: &Solver,
    path: &Path,
    side: &str,
    face: f64,
    views: [(f64, f64); 2],
) -> Outcome {
    let mu0 = 0.6;
    let thicknesses: Vec<f64> = (0..48).map(|i| axes::thickness_at(f64::from(i) / 47.0)).collect();
    let fields: Vec<Field> =
        thicknesses.iter().map(|t| solver.solve(Beam { thickness: *t, mu0 }, DEGREE)).collect();
    let root = SVGBackend::new(path, (1080, 620)).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!(
        "{side} light by set of orders against optical thickness, sun at cosine {mu0}, views at {} (solid), {} (dashed)",
        views[0].0, views[1].0
    );
    let (head, area) = root.split_vertically(46);
    let style = TextStyle::from(("sans-serif", 17)).color(&EXACT);
    head.draw_text(&title, &style, (20, 16))?;
    for (set, panel) in area.split_evenly((2, 4)).iter().enumerate() {
        let mut chart = ChartBuilder::on(panel)
            .caption(
                if set < SETS { format!("orders {}", SET_NAMES[set]) } else { "all orders".into() },
                ("sans-serif", 14),
            )
            .margin(8)
            .x_label_area_size(30)
            .y_label_area_size(44)
            .build_cartesian_2d((0.05..400.0_f64).log_scale(), (1e-4..1.0_f64).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(232, 232, 232))
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .label_style(("sans-serif", 11))
            .draw()?;
        for (which, (mu, phi)) in views.into_iter().enumerate() {
            let exact = |field: &Field| {
                let level = face as usize * (field.depths().len() - 1);
                let of = |set| field.radiance(set, mu, &[phi])[0][level];
                if set < SETS { of(set) } else { (0..SETS).map(of).sum() }
            };
            let curve = thicknesses.iter().zip(&fields).map(|(t, field)| (*t, exact(field)));
            let curve: Vec<_> = curve.filter(|(_, c)| *c > 1e-4).collect();
            let wide = EXACT.mix(0.3).stroke_width(6);
            let exact = chart.draw_series(LineSeries::new(curve, wide))?;
            if set == SETS && which == 0 {
                exact.label("solver").legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], EXACT.mix(0.3).stroke_width(6))
                });
            }
            for (model, (name, color)) in MODELS.into_iter().enumerate() {
                let mut curve = Vec::new();
                for thickness in &thicknesses {
                    let view = View { thickness: *thickness, depth: face * thickness, mu, phi, mu0 };
                    curve.push((*thickness, models.of(model, view)?[set]));
                }
                curve.retain(|(_, c)| *c > 1e-4);
                if which == 0 {
                    let line = chart.draw_series(LineSeries::new(curve, color.stroke_width(2)))?;
                    if set == SETS {
                        line.label(name).legend(move |(x, y)| {
                            PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                        });
                    }
                } else {
                    chart.draw_series(DashedLineSeries::new(curve, 5, 4, color.stroke_width(2)))?;
                }
            }
        }
        if set == SETS {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::LowerRight)
                .background_style(WHITE.mix(0.9))
                .label_font(("sans-serif", 12))
                .draw()?;
        }
    }
    root.present()?;
    Ok(())
}
