//! Linking WGSL: a shader names the modules it uses in header comments (`// @use density phase`), each
//! module likewise; whole modules are concatenated once, dependencies first. Names are unique, so
//! nothing is renamed, and a line number in a driver's message can be found.
//!
//! A *role* is a name that no module has, such as `medium` in `// @use medium`: who links says which
//! module fills it. A role by the name of a part takes that part's place.

macro_rules! sources {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/", $folder, $name, ".wgsl")))),*]
    };
}

/// Every module of `shaders/lib`, pure functions and structs: name and source.
pub const LIBRARY: &[(&str, &str)] = sources!("lib/":
    "air", "atmosphere", "attenuation", "body", "camera", "characteristic", "column", "constants",
    "density", "depth_volume", "eddington", "ellipsoid", "field", "field_view", "flash",
    "forward_cone", "ground", "harmonics", "layer", "light_box", "lighting", "noise", "octave", "path_choice",
    "path_random", "phase", "powder", "random", "ray_box", "ray_seen", "ray_step", "region", "slab",
    "slab_direct", "slab_fit", "slab_functions", "slab_light", "slab_view", "species",
    "sphere_grid", "sun_disc", "sun_map", "sun_sum", "tonemap", "visibility", "volume", "water",
);

/// Parts of the march, of models of light and of the path tracer that have bindings, overrides or state.
pub const PARTS: &[&[(&str, &str)]] = &[
    sources!("march/": "counts", "crossings", "gather", "shade", "shade_map", "steps"),
    sources!("light/": "flags", "openness", "slab_maps", "slab_nodes", "slab_surface", "sunlight", "unshadowed"),
    sources!("medium/": "ellipsoids_at"),
    sources!("path/": "path_flash", "path_medium", "path_state", "path_walk"),
];

/// Every entry point of `shaders`: name and source.
pub const ENTRY_POINTS: &[(&str, &str)] = sources!("":
    "aerial", "air_shadow", "compose", "depth_bake", "ground_light", "march", "mips",
    "moments_around", "moments_entering", "moments_keep", "moments_medium", "moments_prolong",
    "moments_restrict", "moments_scatter", "moments_sweep", "moments_tile", "moments_view",
    "multiple_scattering", "path", "resolve", "sky", "sky_light", "sky_view",
    "sky_volume", "sun_map", "sun_maps", "sun_normals", "sun_shade", "transmittance", "voxels",
);

/// A role and the source of the module that fills it.
pub type Role<'a> = (&'a str, &'a str);

/// The whole source of an entry point, or of any text with `// @use` lines.
///
/// # Panics
/// Where a module that the text uses does not exist, or a role that it has is not filled: a mistake
/// in the program itself, which a test finds for every entry point.
pub fn link(source: &str, roles: &[Role<'_>]) -> String {
    let mut done = Vec::new();
    let mut linked = String::new();
    append(source, roles, &mut done, &mut linked);
    linked
}

fn append<'a>(source: &'a str, roles: &[Role<'a>], done: &mut Vec<&'a str>, linked: &mut String) {
    for name in used(source) {
        if !done.contains(&name) {
            done.push(name);
            append(module(name, roles), roles, done, linked);
        }
    }
    linked.push_str(source);
    linked.push('\n');
}

/// Names of what a module uses.
fn used(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| line.strip_prefix("// @use ")).flat_map(str::split_whitespace)
}

fn module<'a>(name: &str, roles: &[Role<'a>]) -> &'a str {
    let parts = PARTS.iter().copied().flatten();
    let found = roles.iter().chain(LIBRARY).chain(parts).find(|(known, _)| *known == name);
    found.map(|(_, source)| *source).unwrap_or_else(|| {
        panic!("no shader module and no role is `{name}`: is it in LIBRARY or PARTS of src/gpu/link.rs?")
    })
}

/// The part called `name`, to take the place of another.
///
/// # Panics
/// Where there is none: a mistake in the program itself.
pub fn in_place_of(other: &'static str, name: &str) -> Role<'static> {
    let found = PARTS.iter().copied().flatten().find(|(known, _)| *known == name);
    found.map(|(_, source)| (other, *source)).unwrap_or_else(|| panic!("no part `{name}` in src/gpu/link.rs"))
}

/// The source of the entry point called `name`, with its roles filled.
pub(crate) fn entry_point(name: &str, roles: &[Role<'_>]) -> String {
    let found = ENTRY_POINTS.iter().find(|(known, _)| *known == name);
    link(found.map(|(_, source)| *source).unwrap_or_else(|| panic!("no shader `{name}` in shaders")), roles)
}

/// Parses and validates linked WGSL, without a device. Not in a browser, which does so itself.
///
/// # Errors
/// The parser's or validator's message, with the place in the linked text.
#[cfg(not(target_arch = "wasm32"))]
pub fn validate(linked: &str) -> Result<wgpu::naga::Module, String> {
    use wgpu::naga::{front::wgsl, valid};
    // Half floats packed in pairs are what WebGPU guarantees and naga asks about.
    const WEBGPU: valid::Capabilities = valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let module = wgsl::parse_str(linked).map_err(|error| error.emit_to_string(linked))?;
    valid::Validator::new(valid::ValidationFlags::all(), WEBGPU)
        .validate(&module)
        .map_err(|error| error.emit_to_string(linked))?;
    Ok(module)
}
