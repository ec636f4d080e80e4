//! The tables of docs/numerics.md.

use rayon::prelude::*;

use crate::common::gpu;
use crate::harness::{Error, Inputs, Regime, Twin, error};
use crate::textbook::forms;

/// Random inputs of a regime.
const INPUTS: usize = 1 << 18;
const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/numerics.md");

/// Measures every regime with random inputs and writes the tables into their places in the document.
pub fn write(twins: impl Fn() -> Vec<Twin>) {
    let ours = measured(&twins());
    let textbook = measured(&forms(twins()));
    let all: String = ours.iter().map(Measured::row).collect();
    let before: String = textbook
        .iter()
        .map(|form| {
            let same = |m: &&Measured| (m.name, m.regime) == (form.name, form.regime);
            form.beside(ours.iter().find(same).unwrap())
        })
        .collect();
    let adapter = &gpu().adapter.name;
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let document = filled(&document, "all functions", &format!("Measured on {adapter}.\n\n{HEAD}{all}"));
    let document = filled(&document, "textbook forms", &format!("{TEXTBOOK_HEAD}{before}"));
    std::fs::write(DOCUMENT, document).unwrap();
    let beyond: Vec<_> = ours.iter().filter(|m| m.conditioned.2 > m.bound).map(Measured::row).collect();
    assert!(beyond.is_empty(), "beyond their bounds:\n{}", beyond.concat());
}

const HEAD: &str = "\
| function | inputs | compared | ULP: median | 99.9 % | worst | conditioned: median | 99.9 % | worst | relative | absolute |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
";
const TEXTBOOK_HEAD: &str = "\
| function | inputs | conditioned, worst: textbook | now | relative: textbook | now | absolute: textbook | now |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |
";

/// The text with a table in the place of that name.
fn filled(document: &str, name: &str, table: &str) -> String {
    let [begin, end] = [format!("<!-- table: {name} -->\n"), format!("<!-- end: {name} -->\n")];
    let (before, rest) = document.split_once(&begin).unwrap();
    let (_, after) = rest.split_once(&end).unwrap();
    [before, &begin, "\n", table, "\n", &end, after].concat()
}

/// A regime's errors: medians, what 99.9 % are below, and the worst.
struct Measured {
    name: &'static str,
    regime: &'static str,
    bound: f64,
    compared: f64,
    ulp: (f64, f64, f64),
    conditioned: (f64, f64, f64),
    relative: f64,
    absolute: f64,
}

fn measured(twins: &[Twin]) -> Vec<Measured> {
    let random = |regime: &&Regime| matches!(regime.inputs, Inputs::Random(_));
    let regimes = twins.iter().flat_map(|twin| twin.regimes.iter().filter(random).map(move |r| (twin, r)));
    regimes.map(|(twin, regime)| Measured::new(twin, regime)).collect()
}

impl Measured {
    fn new(twin: &Twin, regime: &Regime) -> Self {
        let inputs = twin.inputs(regime, INPUTS);
        let got = twin.evaluate(&inputs);
        let errors: Vec<Error> =
            inputs.par_iter().zip(got).filter_map(|(input, got)| error(twin, regime, input, got)).collect();
        let of = |part: fn(&Error) -> f64| errors.iter().map(part).collect::<Vec<_>>();
        Self {
            name: twin.name,
            regime: regime.name,
            bound: twin.bound,
            compared: errors.len() as f64 / INPUTS as f64,
            ulp: quantiles(of(|e| e.ulp)),
            conditioned: quantiles(of(|e| e.conditioned)),
            relative: quantiles(of(|e| e.relative)).2,
            absolute: quantiles(of(|e| e.absolute)).2,
        }
    }

    fn row(&self) -> String {
        let [a, b, c, d, e, f] =
            [self.ulp.0, self.ulp.1, self.ulp.2, self.conditioned.0, self.conditioned.1, self.conditioned.2]
                .map(number);
        format!(
            "| `{}` | {} | {:.0} % | {a} | {b} | {c} | {d} | {e} | {f} | {:.0e} | {:.0e} |\n",
            self.name,
            self.regime,
            100.0 * self.compared,
            self.relative,
            self.absolute
        )
    }

    fn beside(&self, now: &Self) -> String {
        format!(
            "| `{}` | {} | {} | {} | {:.0e} | {:.0e} | {:.0e} | {:.0e} |\n",
            self.name,
            self.regime,
            number(self.conditioned.2),
            number(now.conditioned.2),
            self.relative,
            now.relative,
            self.absolute,
            now.absolute
        )
    }
}

fn quantiles(mut numbers: Vec<f64>) -> (f64, f64, f64) {
    let mut below = |share: f64| {
        let place = (share * (numbers.len() - 1) as f64) as usize;
        *numbers.select_nth_unstable_by(place, f64::total_cmp).1
    };
    (below(0.5), below(0.999), below(1.0))
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
