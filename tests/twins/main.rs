//! Every function of `shaders/lib` against a double-precision reference written from its
//! definition, not transcribed: a grid with edge cases, and random inputs over each regime of
//! what it may be given, the extremes among them.
//!
//! `cargo test` takes the first thousands of random inputs of each regime. All of them, and the
//! table of docs/numerics.md, which this command writes anew, are
//!
//! ```text
//! cargo test --release --test twins -- --ignored
//! ```
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod air;
mod builtins;
#[path = "../common/mod.rs"]
mod common;
mod definitions;
mod geometry;
mod grids;
mod harness;
mod pack;
mod picture;
mod random;
mod scattering;
mod sky;
mod slab;
mod table;

use harness::{Twin, error};
use nephos::gpu::LIBRARY;

/// Without a twin, with the reason.
const ELSEWHERE: &[(&str, &str)] = &[
    ("noise_at", "reads a texture: tests/noise.rs compares it with the baked volume"),
    ("slab_source", "reads the table: tests/slab_render.rs compares it with the reference"),
    ("slab_fit", "reads sun maps, as the next: tests/slab_render.rs holds pictures against slabs"),
    ("slab_fit_kol", "the same"),
    ("slab_fit_gaussian", "the same"),
    ("slab_fit_view", "the same"),
    ("slab_fit_bouthors", "the same"),
    ("slab_direct", "reads tables: tests/slab_shader.rs compares it with them, as the next"),
    ("slab_functions", "the same"),
    ("slab_functions_read", "the same"),
    ("slab_collector", "the same"),
    ("transmittance_to_top", "an integral: tests/atmosphere.rs compares it with closed forms"),
    ("sun_irradiance_at", "reads tables: tests/sky.rs compares it with the reference, as the next"),
    ("light_of_sky", "the same"),
    ("aerial_perspective", "the same"),
    ("multiple_light", "the same, through pictures made of nothing else"),
    ("ground_irradiance", "the same"),
    ("air_source", "the same"),
    ("air_light", "the same"),
    ("sky_radiance", "the same"),
];

fn twins() -> Vec<Twin> {
    [
        geometry::twins(),
        scattering::twins(),
        slab::twins(),
        air::twins(),
        sky::twins(),
        grids::twins(),
        picture::twins(),
        builtins::twins(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[test]
fn shader_functions_agree_with_their_references() {
    let mut failures = Vec::new();
    for twin in twins() {
        for regime in &twin.regimes {
            let inputs = twin.inputs(regime, 4096);
            let mut compared = 0;
            for (input, got) in inputs.iter().zip(twin.evaluate(&inputs)) {
                let Some(error) = error(&twin, regime, input, got) else { continue };
                compared += 1;
                // NaN of the shader is infinitely wrong.
                if error.conditioned > regime.bound {
                    let wanted = (twin.reference)(&input.map(|v| v.map(f64::from)));
                    failures.push(format!(
                        "{} over {}: {:.1} ULP, {got:?} for {wanted:?} at {input:?}",
                        twin.name, regime.name, error.conditioned
                    ));
                }
            }
            assert!(compared > 0, "{} over {} compares nothing", twin.name, regime.name);
        }
    }
    assert!(
        failures.is_empty(),
        "{} differences, first:\n{}",
        failures.len(),
        failures[..failures.len().min(12)].join("\n")
    );
}

#[test]
fn every_shader_function_has_a_twin() {
    let twins = twins();
    for (module, source) in LIBRARY {
        for line in source.lines().filter_map(|line| line.strip_prefix("fn ")) {
            let name = line.split('(').next().unwrap_or_default();
            let known = twins.iter().any(|twin| twin.name == name)
                || ELSEWHERE.iter().any(|(elsewhere, _)| *elsewhere == name);
            assert!(known, "`{name}` of shaders/lib/{module}.wgsl has no twin");
        }
    }
}

#[test]
#[ignore = "minutes of random inputs; writes docs/numerics.md"]
fn the_table_of_docs_numerics() {
    table::write(&twins());
}
