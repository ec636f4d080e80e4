//! The table of docs/numerics.md.

use rayon::prelude::*;

use crate::common::gpu;
use crate::harness::{Error, Inputs, Regime, Twin, error};

/// Random inputs of a regime.
const INPUTS: usize = 1 << 20;
const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/numerics.md");
const BEGIN: &str = "<!-- The table: made by the command above. -->\n";
const END: &str = "<!-- The end of the table. -->\n";

/// Measures every regime with random inputs and writes the table into its place in the document.
pub fn write(twins: &[Twin]) {
    let mut rows = String::new();
    let mut beyond = Vec::new();
    for twin in twins {
        for regime in twin.regimes.iter().filter(|regime| matches!(regime.inputs, Inputs::Random(_))) {
            let errors = measure(twin, regime);
            let row = row(twin.name, regime, &errors);
            eprint!("{row}");
            rows += &row;
            if worst(&errors, |e| e.conditioned) > regime.bound {
                if std::env::var("SHOW").is_ok() {
                    let inputs = twin.inputs(regime, INPUTS);
                    let got = twin.evaluate(&inputs);
                    let (i, e) = inputs.iter().enumerate().map(|(i, x)| (i, error(twin, regime, x, got[i]).map_or(0.0, |e| e.conditioned))).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
                    eprintln!("  {e} {:?} {:?} {:?}", inputs[i], got[i], (twin.reference)(&inputs[i].map(|v| v.map(f64::from))));
                }
                beyond.push(format!("{} over {}", twin.name, regime.name));
            }
        }
    }
    let table = format!(
        "Measured on {}.\n\n\
         | function | inputs | compared | ULP: median | 99.9 % | worst | conditioned: 99.9 % | worst | bound | relative, worst | absolute, worst |\n\
         | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n{rows}",
        gpu().adapter.name
    );
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let (before, rest) = document.split_once(BEGIN).unwrap();
    let (_, after) = rest.split_once(END).unwrap();
    std::fs::write(DOCUMENT, [before, BEGIN, "\n", &table, "\n", END, after].concat()).unwrap();
    assert!(beyond.is_empty(), "beyond their bounds: {beyond:?}");
}

fn measure(twin: &Twin, regime: &Regime) -> Vec<Error> {
    let inputs = twin.inputs(regime, INPUTS);
    let got = twin.evaluate(&inputs);
    inputs.par_iter().zip(got).filter_map(|(input, got)| error(twin, regime, input, got)).collect()
}

fn row(name: &str, regime: &Regime, errors: &[Error]) -> String {
    let share = 100.0 * errors.len() as f64 / INPUTS as f64;
    let mut ulps: Vec<f64> = errors.iter().map(|e| e.ulp).collect();
    let mut conditioned: Vec<f64> = errors.iter().map(|e| e.conditioned).collect();
    format!(
        "| `{name}` | {} | {share:.0} % | {} | {} | {} | {} | {} | {} | {:.0e} | {:.0e} |\n",
        regime.name,
        number(quantile(&mut ulps, 0.5)),
        number(quantile(&mut ulps, 0.999)),
        number(quantile(&mut ulps, 1.0)),
        number(quantile(&mut conditioned, 0.999)),
        number(quantile(&mut conditioned, 1.0)),
        regime.bound,
        worst(errors, |e| e.relative),
        worst(errors, |e| e.absolute),
    )
}

fn worst(errors: &[Error], of: impl Fn(&Error) -> f64) -> f64 {
    errors.iter().map(of).fold(0.0, f64::max)
}

/// The number below which this share of them is.
fn quantile(numbers: &mut [f64], share: f64) -> f64 {
    let place = (share * (numbers.len() - 1) as f64) as usize;
    *numbers.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Two digits, as people read them.
fn number(x: f64) -> String {
    match x {
        _ if x == 0.0 => "0".into(),
        _ if x < 10.0 => format!("{x:.1}"),
        _ if x < 1e5 => format!("{x:.0}"),
        _ => format!("{x:.0e}"),
    }
}
