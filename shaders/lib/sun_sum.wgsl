// Sunlight scattered once, gathered along a ray.
// @use attenuation lighting phase

// Phase functions from the sun into a ray, 1/sr: without the peak, and the peak's alone.
struct SunPhase {
    wide: vec3f,
    peak: vec3f,
}

// Sunlight gathered along a ray, per unit of irradiance.
struct SunSum {
    // Scattered once, without the phase function.
    single: f32,
    // What other clouds let through to what is seen.
    lit: f32,
}

fn sun_piece(sum: SunSum, piece: LitPiece) -> SunSum {
    return SunSum(sum.single + piece.seen * sunlight_share(piece.optical_depth, piece.before.x, piece.after.x),
        sum.lit + piece.seen * mean_transmittance(piece.before.y, piece.after.y));
}

// What a ray sees of sunlight scattered once, per unit of irradiance, 1/sr.
fn sun_scattered(sum: SunSum, phase: SunPhase, seen: RaySeen) -> vec3f {
    return phase.wide * (sum.single * seen.share);
}

// What it sees of sunlight scattered within the peak alone, of which `truncated` is the share. Only what came straight through other
// clouds counts, which is a power of what transport lets through: what their peaks have scattered stands behind as their own
// light, and comes through this one's peak as any other.
fn sun_recovered(sum: SunSum, phase: SunPhase, truncated: f32, seen: RaySeen) -> vec3f {
    let lit = saturate(sum.lit * seen.share / seen.opacity);
    let straight = pow(lit, 1.0 / (1.0 - truncated));
    return phase.peak * (recovered_peak(seen.optical_depth, truncated) * straight);
}
