// How much of what lies at a distance along a ray is seen through a cloud, in twelve numbers: distances at which the
// cloud's transmittance has fallen to levels that are evenly spaced, and its opacity in all. They are half floats:
// distances in kilometres, off by 0.05 %.
// @use attenuation

const VISIBILITY_LEVELS: u32 = 9u;

// Distances at which the cloud begins, at which its transmittance has fallen by a ninth and another ninth, and at which it
// ends, km: ten; its opacity to the light that a model gathers, and that to what is behind: all 0 where there is no cloud.
struct Visibility {
    begin: vec4f,
    middle: vec4f,
    end: vec4f,
}

// The transmittance at a mark: 1 at the first, a ninth less at each that follows.
fn visibility_level(mark: u32) -> f32 {
    return 1.0 - f32(mark) / f32(VISIBILITY_LEVELS);
}

// Where a step from `t` on lets through no more than `level`: transmittance falls in it from `before` to `after`, evenly in its
// logarithm. Something must fall, and `level` lie between them.
fn visibility_reached(t: f32, length: f32, before: f32, after: f32, level: f32) -> f32 {
    return t + length * saturate(log(before / level) / log(before / max(after, 1e-30)));
}

// What is seen of an even piece of this optical depth through what lets `before` pass where it begins and `after` where it
// ends, evenly between, over what is seen of it alone: the integral of both extinctions is theirs by their shares.
fn visibility_share(before: f32, after: f32, optical_depth: f32) -> f32 {
    let seen = max(before, 1e-20);
    let others = log(seen / clamp(after, 1e-20, seen));
    return before * mean_through(optical_depth + others) / mean_through(optical_depth);
}

// Less than this is nothing.
const VISIBILITY_LEAST: f32 = 1e-3;

// Transmittance of what is before a place, at a distance in kilometres: between marks it falls evenly in its logarithm.
fn visibility_at(v: Visibility, distance: f32) -> f32 {
    let least = log(max(1.0 - v.end.z, VISIBILITY_LEAST));
    let marks = array<f32, 10>(v.begin.x, v.begin.y, v.begin.z, v.begin.w, v.middle.x, v.middle.y, v.middle.z,
        v.middle.w, v.end.x, v.end.y);
    var depth = 0.0;
    var before = 0.0;
    for (var i = 1u; i <= VISIBILITY_LEVELS; i++) {
        let after = max(log(max(visibility_level(i), VISIBILITY_LEAST)), least);
        depth += (before - after) * saturate((distance - marks[i - 1u]) / max(marks[i] - marks[i - 1u], 1e-6));
        before = after;
    }
    return select(exp(-depth), 1.0 - v.end.z, distance >= v.end.y && v.end.z > 0.0);
}
