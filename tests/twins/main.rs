//! Every function of `shaders/lib` against a double-precision reference written from its
//! definition, not transcribed; functions of other shaders read, call those and store (`bound`): a grid with edge cases, and random inputs over each regime of
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
mod bound;
mod builtins;
#[path = "../common/mod.rs"]
mod common;
mod definitions;
mod geometry;
mod grids;
mod ground;
mod harness;
mod layer;
mod light;
mod march;
mod matter;
mod pack;
mod path;
mod picture;
mod random;
mod scattering;
mod shadow;
mod sky;
mod slab;
mod solve;
mod table;
mod textbook;
mod visibility;
mod volume;

use harness::{Regime, Twin, error};
use nephos::frame::{GroundShader, MEDIA, MIXED};
use nephos::gpu::{ENTRY_POINTS, LIBRARY, PARTS};
use nephos::render::Transport;

/// Without a twin, with the reason.
const ELSEWHERE: &[(&str, &str)] = &[
    ("noise_at", "reads a texture: tests/picture/noise.rs compares it with the baked volume"),
    ("noise_of_phase", "the same"),
    ("slab_source", "reads the table: tests/picture/slab_render.rs compares it with the reference"),
    ("slab_fit", "reads sun maps, as the next: tests/picture/slab_render.rs holds pictures against slabs"),
    ("slab_fit_kol", "the same"),
    ("slab_fit_gaussian", "the same"),
    ("slab_fit_bouthors", "the same"),
    ("slab_direct", "reads tables: tests/picture/slab_shader.rs compares it with them, as the next"),
    ("slab_functions", "the same"),
    ("slab_functions_read", "the same"),
    ("slab_collector", "the same"),
    ("transmittance_to_top", "an integral: tests/picture/atmosphere.rs compares it with closed forms"),
    ("sun_irradiance_at", "reads tables: tests/picture/sky.rs compares it with the reference, as the next"),
    ("light_of_sky", "the same"),
    ("aerial_perspective", "the same"),
    ("multiple_light", "the same, through pictures made of nothing else"),
    ("ground_irradiance", "the same"),
    ("air_source", "the same"),
    ("air_light", "the same"),
    ("sky_radiance", "the same"),
    (
        "air_source_of_sun",
        "reads tables: tests/picture/shadows.rs holds pictures against the reference, as the next",
    ),
    ("transmittance_to_ground", "the same"),
    ("ground_shadow", "the same"),
    (
        "ground_point",
        "reads tables: tests/picture/ground.rs compares pictures of ground with the reference, as the next",
    ),
    ("ground_diffuse", "the same"),
    ("ground_samples", "the same"),
    (
        "sun_map_in",
        "reads the map: tests/picture/shadows.rs compares it with pictures from the sun, as the next",
    ),
    ("sun_map_light", "the same"),
    ("sun_map_distance", "the same"),
    ("sun_map_ground", "the same"),
    (
        "sun_map_around",
        "the same: tests/picture/mixed.rs holds layers in shadow against the path tracer, as the next",
    ),
    ("sun_map_scattered", "the same"),
];

fn twins() -> Vec<Twin> {
    [
        geometry::twins(),
        layer::twins(),
        matter::twins(),
        scattering::twins(),
        slab::twins(),
        air::twins(),
        sky::twins(),
        shadow::twins(),
        grids::twins(),
        ground::twins(),
        picture::twins(),
        builtins::twins(),
        march::twins(),
        light::twins(),
        solve::twins(),
        path::twins(),
        visibility::twins(),
        volume::twins(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// How many inputs of a regime, among thousands, have an error beyond the twin's bound, and the worst of
/// them; nothing where none has.
fn failure(twin: &Twin, regime: &Regime) -> Option<String> {
    let inputs = twin.inputs(regime, 4096);
    let pairs = inputs.iter().zip(twin.evaluate(&inputs));
    let compared: Vec<_> =
        pairs.filter_map(|(x, got)| Some((x, got, error(twin, regime, x, got)?.conditioned))).collect();
    assert!(!compared.is_empty(), "{} over {} compares nothing", twin.name, regime.name);
    let beyond: Vec<_> = compared.into_iter().filter(|(.., error)| *error > twin.bound).collect();
    let (input, got, ulp) = beyond.iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    let wanted = (twin.reference)(&input.map(|v| v.map(f64::from)));
    let (name, regime, count) = (twin.name, regime.name, beyond.len());
    Some(format!("{name} over {regime}: {count}, worst {ulp:.1} ULP, {got:?} for {wanted:?} at {input:?}"))
}

#[test]
fn shader_functions_agree_with_their_references() {
    let twins = twins();
    let all = twins.iter().flat_map(|twin| twin.regimes.iter().map(move |regime| (twin, regime)));
    let failures: Vec<_> = all.filter_map(|(twin, regime)| failure(twin, regime)).collect();
    assert!(failures.is_empty(), "beyond their bounds:\n{}", failures.join("\n"));
}

#[test]
fn forms_of_the_textbook_fail() {
    let mut forms = textbook::forms(twins());
    if products_are_fused() {
        forms.retain(|form| form.name != "slab_view");
    }
    forms.retain(|form| form.regimes.iter().all(|regime| failure(form, regime).is_none()));
    let names: Vec<_> = forms.iter().map(|form| form.name).collect();
    assert!(names.is_empty(), "as the textbook has them these would pass: {names:?}");
}

/// Whether this adapter takes products in sums without rounding them first. The parts of `slab_view`
/// across the normal are such sums, and lose nothing then.
fn products_are_fused() -> bool {
    // The square of 1 + 2^-12 is 1 + 2^-11 and, where it is not rounded, 2^-24.
    let x = 1.0 + 2f32.powi(-12);
    let input = [[x, 1.0 + 2f32.powi(-11), 0.0, 0.0]];
    let got = common::evaluate("constants", "return vec4f(x[0].x * x[0].x - x[0].y);", &[input]);
    got[0][0] != 0.0
}

/// Names of a shader's functions, whatever attributes stand before them.
fn functions(source: &str) -> impl Iterator<Item = &str> {
    let code = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    let names = code.filter_map(|line| {
        line.split_once("fn ").filter(|(before, _)| !before.ends_with(char::is_alphanumeric))
    });
    names.map(|(_, rest)| rest.split('(').next().unwrap_or_default())
}

/// Modules outside of `shaders/lib`, by name or by the role that they fill.
fn bound_modules() -> Vec<(&'static str, &'static str)> {
    let models = Transport::all().flat_map(|transport| transport.roles().iter().copied());
    let parts = PARTS.iter().copied().flatten().copied();
    parts
        .chain(ENTRY_POINTS.iter().copied())
        .chain(MEDIA.iter().copied())
        .chain([MIXED])
        .chain(GroundShader::ALL.map(GroundShader::role))
        .chain(models)
        .collect()
}

#[test]
fn every_shader_function_has_a_twin() {
    let twins = twins();
    let mut without: Vec<_> = ELSEWHERE.iter().map(|(name, _)| *name).collect();
    for (module, source) in LIBRARY {
        for name in functions(source) {
            let elsewhere = without.iter().position(|known| *known == name);
            let known = twins.iter().any(|twin| twin.name == name) || elsewhere.is_some();
            assert!(known, "`{name}` of shaders/lib/{module}.wgsl has no twin");
            elsewhere.map(|place| without.swap_remove(place));
        }
    }
    assert!(without.is_empty(), "no functions of shaders/lib: {without:?}");
    for twin in twins {
        let exists = LIBRARY.iter().any(|(_, source)| functions(source).any(|name| name == twin.name));
        assert!(exists || twin.uses == "constants", "{} is the twin of nothing", twin.name);
    }
}

#[test]
fn functions_with_bindings_compute_nothing_new() {
    let mut unseen: Vec<(&str, &str)> = bound::KINDS
        .iter()
        .flat_map(|(_, modules)| modules.iter())
        .flat_map(|(module, names)| names.split_whitespace().map(move |name| (*module, name)))
        .collect();
    let listed = unseen.clone();
    for (module, source) in bound_modules() {
        for name in functions(source) {
            let known = listed.contains(&(module, name));
            assert!(known, "`{name}` of `{module}`: what it computes belongs into shaders/lib, with a twin");
            unseen.retain(|entry| *entry != (module, name));
        }
        for line in source.lines().map(|line| line.split("//").next().unwrap_or_default()) {
            let words = || line.split(|c: char| !c.is_alphanumeric() && c != '_');
            let formula = bound::FORMULAS.iter().find(|word| words().any(|w| w == **word));
            assert!(formula.is_none(), "`{module}` has a formula that belongs into shaders/lib: {line}");
        }
    }
    assert!(unseen.is_empty(), "listed, and in no shader: {unseen:?}");
}

#[test]
#[ignore = "minutes of random inputs; writes docs/numerics.md"]
fn the_table_of_docs_numerics() {
    table::write(twins);
}
