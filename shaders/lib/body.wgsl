// What is the same all over a cloud: its noise, its particles, how its lumps join, how its density
// changes with height and depth.
// @use noise species

struct Body {
    noise: NoiseFrame,
    species: Species,
    // Exponent with which depths of lumps are joined, and the depth that they are told in, m.
    power: f32,
    reach: f32,
    // Height of its base in the frame, m, and 1 over that of its top above the base, 1/m.
    base: f32,
    inverse_height: f32,
    // Share of the adiabatic growth of density with height.
    stratification: f32,
    // Share of its droplets that the rim has lost.
    dilution: f32,
    // Height in the frame below which there is none of it, m.
    level: f32,
    // 1 where extinction changes behind the boundary, else 0.
    uneven: f32,
    // Place of its species among those of all clouds.
    table: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

// Extinction at a height over that at the top. In air that rises without mixing, liquid water grows like
// the height above the base while the number of droplets stays: their radius grows like its cube root,
// and extinction, which is number times area, like its power of 2/3.
fn height_profile(height: f32, stratification: f32) -> f32 {
    return mix(1.0, pow(clamp(height, 1e-4, 1.0), 2.0 / 3.0), stratification);
}
