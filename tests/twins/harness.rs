//! What a twin is, and how its errors are measured.

use crate::common;
pub use crate::random::Random;

/// What a shader function takes, packed: `x: array<vec4f, 8>`.
pub type Input = [[f32; 4]; 8];
/// The same in f64.
pub type Wide = [[f64; 4]; 8];
/// What it gives; NaN in a reference means "not compared".
pub type Output = [f64; 4];

/// A shader function and its reference in f64.
pub struct Twin {
    pub name: &'static str,
    /// Library modules.
    pub uses: &'static str,
    /// Module-scope WGSL of its own.
    pub declarations: &'static str,
    /// WGSL body of `evaluate(x: array<vec4f, 8>) -> vec4f`.
    pub body: &'static str,
    pub reference: fn(&Wide) -> Output,
    /// Largest error allowed, in units of the last place of the condition (see `Error`).
    pub bound: f64,
    pub regimes: Vec<Regime>,
}

/// What a dozen roundings and a built-in function leave where nothing cancels. The worst of all
/// functions is 13 on Mesa's llvmpipe, over the inputs of docs/numerics.md.
const FEW_ROUNDINGS: f64 = 16.0;

/// A part of what a function may be given.
pub struct Regime {
    pub name: &'static str,
    pub inputs: Inputs,
    /// An amount beside which errors are nothing: the condition is at least that.
    pub beside: f64,
}

pub enum Inputs {
    Grid(Vec<Input>),
    Random(fn(&mut Random) -> Input),
}

impl Twin {
    pub fn new(
        name: &'static str,
        uses: &'static str,
        body: &'static str,
        reference: fn(&Wide) -> Output,
    ) -> Self {
        Self { name, uses, declarations: "", body, reference, bound: FEW_ROUNDINGS, regimes: Vec::new() }
    }

    pub fn declaring(self, declarations: &'static str) -> Self {
        Self { declarations, ..self }
    }

    /// For functions of integers.
    pub fn exact(self) -> Self {
        Self { bound: 0.0, ..self }
    }

    /// Adds a grid with the edge cases.
    pub fn edges(self, grid: Vec<Input>) -> Self {
        self.with(Regime { name: "edges", inputs: Inputs::Grid(grid), beside: DARK })
    }

    /// Adds random inputs.
    pub fn over(self, name: &'static str, sample: fn(&mut Random) -> Input) -> Self {
        self.with(Regime { name, inputs: Inputs::Random(sample), beside: DARK })
    }

    /// Judges the last regime's errors beside an amount that the result is added to.
    pub fn beside(mut self, amount: f64) -> Self {
        self.regimes.last_mut().unwrap().beside = amount;
        self
    }

    fn with(mut self, regime: Regime) -> Self {
        self.regimes.push(regime);
        self
    }

    /// The first inputs of a regime, at most `most`: the same on every run.
    pub fn inputs(&self, regime: &Regime, most: usize) -> Vec<Input> {
        match &regime.inputs {
            Inputs::Grid(grid) => grid.clone(),
            Inputs::Random(sample) => {
                let mut random = Random::new(&[self.name, regime.name].concat());
                (0..most).map(|_| sample(&mut random)).collect()
            }
        }
    }

    /// What the shader gives.
    pub fn evaluate(&self, inputs: &[Input]) -> Vec<[f32; 4]> {
        // 32 MiB at a time.
        let batches = inputs.chunks(1 << 18);
        batches
            .flat_map(|batch| common::evaluate_with(self.uses, self.declarations, self.body, batch))
            .collect()
    }
}

/// How far off a result is.
#[derive(Clone, Copy, Default)]
pub struct Error {
    /// Units in the last place of the reference rounded to f32.
    pub ulp: f64,
    /// The same of the condition: of |f| + sum over the inputs of |x df/dx|, the change that one
    /// relative unit of error in every input would make. A function that is off by one such unit
    /// is as good as its inputs.
    pub conditioned: f64,
    pub relative: f64,
    pub absolute: f64,
}

/// Below it, light is dark, 0 as well as anything: 2^-100. Numbers under 2^-126 are flushed to 0 on most
/// GPUs, and so are factors of which a larger number is made.
const DARK: f64 = 7.888609052210118e-31;

/// The step from the number of f32 at `x` to the next.
fn last_place(x: f64) -> f64 {
    let power = f64::from_bits(x.max(DARK).to_bits() & 0x7ff0_0000_0000_0000);
    power * f64::from(f32::EPSILON)
}

/// The worst error of the places of a result, or none where none is compared. NaN of the shader
/// is an infinite error.
pub fn error(twin: &Twin, regime: &Regime, input: &Input, got: [f32; 4]) -> Option<Error> {
    let reference = twin.reference;
    let x = input.map(|v| v.map(f64::from));
    let wanted = reference(&x);
    let mut worst: Option<Error> = None;
    for (place, condition) in condition(reference, &x, wanted).into_iter().enumerate() {
        let (got, wanted) = (f64::from(got[place]), wanted[place]);
        // Nor is the neighbour compared of what is not.
        if wanted.is_nan() || condition.is_nan() {
            continue;
        }
        let absolute = if got.is_nan() {
            f64::INFINITY
        } else if got.abs().max(wanted.abs()) < DARK {
            0.0
        } else {
            (got - wanted).abs()
        };
        let worst = worst.get_or_insert_default();
        worst.ulp = worst.ulp.max(absolute / last_place(wanted.abs()));
        worst.conditioned = worst.conditioned.max(absolute / last_place(condition.max(regime.beside)));
        worst.relative = worst.relative.max(absolute / wanted.abs().max(DARK));
        worst.absolute = worst.absolute.max(absolute);
    }
    worst
}

/// |f| + sum of |x df/dx|, by differences over what an f32 can tell apart.
fn condition(reference: fn(&Wide) -> Output, x: &Wide, value: Output) -> Output {
    let step = f64::from(f32::EPSILON);
    let mut sum = value.map(f64::abs);
    for (i, j) in (0..8).flat_map(|i| (0..4).map(move |j| (i, j))) {
        if x[i][j] == 0.0 {
            continue;
        }
        let mut moved = *x;
        moved[i][j] *= 1.0 + step;
        for (sum, (moved, value)) in sum.iter_mut().zip(reference(&moved).into_iter().zip(value)) {
            *sum += (moved - value).abs() / step;
        }
    }
    sum
}
