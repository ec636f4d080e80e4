// Light that is scattered by less than some angle stays in the beam.
// @use constants lighting

// Largest angle of scattering that leaves light in the beam, rad: 20 degrees.
const FORWARD_ANGLE: f32 = 0.34906585;
// Points of the sum over that cone: rings of equal width in cosine, in which phase functions without
// their peak are smooth.
const FORWARD_POINTS: u32 = 8u;

// Solid angle of a ring, sr.
fn forward_ring() -> f32 {
    return 2.0 * PI * ((1.0 - cos(FORWARD_ANGLE)) / f32(FORWARD_POINTS));
}

// A direction in the middle of a ring around the x axis.
fn forward_direction(i: u32) -> vec3f {
    let ring = (1.0 - cos(FORWARD_ANGLE)) / f32(FORWARD_POINTS);
    let cosine = 1.0 - (f32(i) + 0.5) * ring;
    return vec3f(cosine, sqrt(1.0 - cosine * cosine), 0.0);
}

// A piece to which the sun's beam falls off with its optical depth less the share `on` that goes on.
fn forward_piece(piece: LitPiece, on: f32) -> LitPiece {
    var dimmed = piece;
    dimmed.before.x *= 1.0 - on;
    dimmed.after.x *= 1.0 - on;
    return dimmed;
}
