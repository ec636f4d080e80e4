// Beer's law with a powder effect (Schneider 2015, "The Real-Time Volumetric Cloudscapes of
// Horizon: Zero Dawn"): sunlight after an optical depth t is 2 e^-t (1 - e^-2t) of what it was outside,
// which is darkest at the surface and brightest at t = ln(3) / 2. That is the difference of two
// transmittances, so that its mean over a piece of a ray is in closed form. On a piece of which both ends
// are near the surface it is too dark: depths between are told by those of the ends.
// @use octave phase species

// Asymmetry of the one lobe of Henyey and Greenstein that all light is scattered by.
const POWDER_ASYMMETRY: f32 = 0.2;

// `sunlight_share` with the powder effect, at most 4 / (3 sqrt(3)).
fn powder_share(optical_depth: f32, before: f32, after: f32) -> f32 {
    return 2.0 * max(0.0, sunlight_share(optical_depth, before, after)
        - sunlight_share(optical_depth, 3.0 * before, 3.0 * after));
}

// Light per unit of irradiance of what is gathered of it without its phase function.
fn powder_light(species: Species, gathered: f32, cosine: f32) -> f32 {
    return species.albedo * gathered * octave_phase(POWDER_ASYMMETRY, cosine);
}
