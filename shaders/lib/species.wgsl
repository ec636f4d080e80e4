// What a cloud is made of: a kind of particles and its optics. Matter names its species.

struct Species {
    // Share f of the extinction in the forward peak of the phase function, which transport leaves
    // out (delta scaling).
    truncated: f32,
    // Asymmetry g of the phase function without that peak.
    asymmetry: f32,
    // Single-scattering albedo of the medium without the peak.
    albedo: f32,
    // Optical depth in the medium of the slab tables that is like one of this.
    similarity: f32,
    // Legendre moments of the phase function over those of the slab tables', degree 0 to 3.
    degrees: vec4f,
    // Share of the extinction without the peak that light solved for on a grid takes as going straight
    // on (delta-M).
    ahead: f32,
    padding_ahead: f32,
    padding: vec2f,
}

// Share of the extinction that transport sees.
fn transported(species: Species) -> f32 {
    return 1.0 - species.truncated;
}

// Single-scattering albedo of the medium with its peak.
fn whole_albedo(species: Species) -> f32 {
    return species.albedo * (1.0 - species.truncated) + species.truncated;
}
