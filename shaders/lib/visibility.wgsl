// How much of what lies at a distance along a ray is seen through a cloud, in twelve numbers: distances at which the
// cloud's transmittance has fallen to levels that are evenly spaced, and its opacity in all. They are half floats:
// distances in kilometres, off by 0.05 %.

const VISIBILITY_LEVELS: u32 = 10u;

// Distances at which the cloud begins, at which its transmittance has fallen by a tenth and another tenth, and at which it
// ends, km, and its opacity: all 0 where there is no cloud.
struct Visibility {
    begin: vec4f,
    middle: vec4f,
    end: vec4f,
}

// The transmittance at a mark: 1 at the first, 0.1 less at each that follows.
fn visibility_level(mark: u32) -> f32 {
    return 1.0 - f32(mark) / f32(VISIBILITY_LEVELS);
}

// Where a step from `t` on lets through no more than `level`: transmittance falls in it from `before` to `after`, evenly in its
// logarithm. Something must fall, and `level` lie between them.
fn visibility_reached(t: f32, length: f32, before: f32, after: f32, level: f32) -> f32 {
    return t + length * saturate(log(before / level) / log(before / max(after, 1e-30)));
}

// Transmittance of what is before a place, at a distance in kilometres.
fn visibility_at(v: Visibility, distance: f32) -> f32 {
    let least = 1.0 - v.end.w;
    let marks = array<f32, 11>(v.begin.x, v.begin.y, v.begin.z, v.begin.w, v.middle.x, v.middle.y, v.middle.z,
        v.middle.w, v.end.x, v.end.y, v.end.z);
    var hidden = 0.0;
    for (var i = 1u; i <= VISIBILITY_LEVELS; i++) {
        let fall = max(visibility_level(i - 1u), least) - max(visibility_level(i), least);
        hidden += fall * saturate((distance - marks[i - 1u]) / max(marks[i] - marks[i - 1u], 1e-6));
    }
    return 1.0 - hidden;
}
