// Samples of an extinction along a line, and what the sun sees of a column along its light.

// Length of each of `count` equal steps of a chord, as far as its `end`; and the middle of one.
fn chord_step(chord: vec2f, end: f32, count: u32) -> f32 {
    return (min(chord.y, end) - chord.x) / f32(count);
}

fn chord_middle(chord: vec2f, step: f32, i: u32) -> f32 {
    return chord.x + (f32(i) + 0.5) * step;
}

// Share of the sun's light that is taken by a sample of this `thickness`, below an optical depth.
fn column_seen(optical_depth: f32, thickness: f32) -> f32 {
    return exp(-optical_depth) * (1.0 - exp(-thickness));
}

// The map of a column: depth of its lit surface, which is weighted by what the sun sees, and of the far
// one, optical depth, up to `most`, and coverage; all times that coverage.
fn column_map(front: f32, back: f32, optical_depth: f32, most: f32) -> vec4f {
    let coverage = 1.0 - exp(-optical_depth);
    return vec4f(front, coverage * back, coverage * min(optical_depth, most), coverage);
}

// Where, from 0 to 1, the `i`th of `count` samples begins and ends whose distances grow with their square.
fn square_step(i: u32, count: u32) -> vec2f {
    let near = f32(i * i) / f32(count * count);
    let far = f32((i + 1u) * (i + 1u)) / f32(count * count);
    return vec2f(near, far);
}

// The `i`th of `count` level directions all around.
fn level_direction(i: u32, count: u32) -> vec3f {
    let angle = 6.2831853 * f32(i) / f32(count);
    return vec3f(cos(angle), 0.0, sin(angle));
}
