// Multiple scattering as octaves of single scattering (Wrenninge, Kulla and Lundqvist 2013,
// "Oz: The Great and Volumetric"; Hillaire 2016, "Physically Based Sky, Atmosphere and Cloud
// Rendering in Frostbite", 5.6.3): octave i scatters b^i of the light by a phase function
// whose asymmetry is c^i of the first's, through a^i of the optical depth from the sun.
// a = b = c = OCTAVE, and three octaves. The first is single scattering itself, found with
// the droplets' own phase function; here are the other two, Henyey-Greenstein's.
// @use constants phase species

const OCTAVE: f32 = 0.5;

// Henyey-Greenstein phase function of asymmetry `g` in (-1, 1), 1/sr.
fn octave_phase(g: f32, cosine: f32) -> f32 {
    let squared = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * PI * squared * sqrt(squared));
}

// What a unit of irradiance gives in the second and third octave where nothing dims it, 1/sr,
// for a medium of asymmetry `g`.
fn octave_phases(g: f32, cosine: f32) -> vec2f {
    return OCTAVE * vec2f(octave_phase(OCTAVE * g, cosine), OCTAVE * octave_phase(OCTAVE * OCTAVE * g, cosine));
}

// `sunlight_share` of the second and third octave.
fn octave_transmittances(optical_depth: f32, before: f32, after: f32) -> vec2f {
    let second = sunlight_share(optical_depth, OCTAVE * before, OCTAVE * after);
    let third = sunlight_share(optical_depth, OCTAVE * OCTAVE * before, OCTAVE * OCTAVE * after);
    return vec2f(second, third);
}

// Light of the second and third octave per unit of irradiance, of what is gathered of them without their
// phase functions.
fn octave_light(species: Species, octaves: vec2f, cosine: f32) -> f32 {
    return species.albedo * dot(octaves, octave_phases(species.asymmetry, cosine));
}
