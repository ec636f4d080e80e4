// A soft ball that shines, instead of the sun: a point of it is chosen for each collision, and a walk goes there.
// @use flash path_medium path_state

// Whether the light is such a ball.
override FLASH: bool = false;

// Where to from the collision at hand, and how far, m. Half of the points are drawn as the ball shines; they would
// weigh without a bound where the ball is near. The others lie in a direction that is drawn from all of them, as the
// ball shines along that line (balance heuristic). All four numbers count in the weight of `flash_weight`.
fn flash_point(p: vec3f) -> vec4f {
    let deviation = 0.5 * scene.flash.w;
    let around = any_direction(draw(), 6.2831853 * draw());
    let along = normal_number(draw(), 6.2831853 * draw());
    var to = scene.flash.xyz - p;
    if draw() < 0.5 {
        let across = normal_number(draw(), 6.2831853 * draw());
        to += deviation * vec3f(along, across, normal_number(draw(), 6.2831853 * draw()));
    } else {
        to = around * (dot(to, around) + deviation * along);
    }
    let away = max(length(to), 1e-3 * deviation);
    return vec4f(to / away, away);
}

// Light that a walk from a wide collision brings, where nothing is in its way.
fn flash_light(path: ptr<function, Path>, point: vec4f) -> vec3f {
    let scattering = phase((*path).species, WIDE, (*path).direction, point.xyz);
    return (*path).throughput * scattering * flash_weight(scene.flash, (*path).origin, point.xyz, point.w);
}

// The same from a collision in the peak, which is far narrower than the ball: along a direction that the peak
// chooses, as far as the ball shines along it.
fn flash_through_peak(path: ptr<function, Path>, d: vec3f) -> vec3f {
    let density = phase((*path).species, PEAK, (*path).direction, d);
    let chosen = spectral_weight((*path).throughput * density, (*path).choice * density);
    return chosen * flash_along(scene.flash, (*path).origin, d);
}

// How far along a direction from a place the ball shines, m: behind it where that is below 0.
fn flash_distance(p: vec3f, d: vec3f) -> f32 {
    return dot(scene.flash.xyz - p, d) + 0.5 * scene.flash.w * normal_number(draw(), 6.2831853 * draw());
}
