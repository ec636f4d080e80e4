// Transmittance of all clouds along the sun's beam, seen from the sun: squares across the beam, each finer than the
// one before, with the share of light at level planes, four in a texel of each layer; the last place of
// them holds what reaches the ground in all, scattered light too. Planes are level because the
// clouds of a sky share their heights, however low the sun stands. Between planes light is linear in height; it is light, not optical depth, that is kept and filtered, so that the mean light on the ground is right
// however coarse a texel is.
//
// Lokovic and Veach, "Deep Shadow Maps", SIGGRAPH 2000; Nes, thesis, 2008 (planes in place of his nodes by texel:
// then four planes are one filtered read). Not their peak: light that goes almost straight on counts as let through.

const SUN_MAP_SQUARES: u32 = 3u;
// Layers of a square, of four planes each.
const SUN_MAP_LAYERS: u32 = 4u;

struct SunMap {
    // Unit vectors of the world: two across the beam, one along it.
    across: vec3f,
    // Squares in use, the coarsest first; 0 where nothing casts a shadow.
    squares: u32,
    aside: vec3f,
    // Angular radius of the sun's disc, rad.
    sun_radius: f32,
    along: vec3f,
    // Distance from the camera beyond which the air has no shadow, m.
    reach: f32,
    // By square: its corner across and aside, m; 1 over its edge; depth below the camera where the interval of the first
    // plane begins, m.
    place: array<vec4f, SUN_MAP_SQUARES>,
    // Depths of the planes below the camera, m, rising.
    planes: array<vec4f, SUN_MAP_SQUARES * SUN_MAP_LAYERS>,
    // 1 where something casts a shadow that has no end, and heights follow the round earth; else 0.
    endless: f32,
}

// Texture coordinates of a point, m from the camera, and its depth below the camera, m.
fn sun_map_coordinate(map: SunMap, place: vec4f, p: vec3f) -> vec3f {
    return vec3f((vec2f(dot(p, map.across), dot(p, map.aside)) - place.xy) * place.z, -p.y);
}

// Share of the way through the intervals that end at the planes `to`, at the depth `depth`.
fn sun_map_passed(begin: f32, to: vec4f, depth: f32) -> vec4f {
    let from4 = vec4f(begin, to.xyz);
    return saturate((depth - from4) / max(to - from4, vec4f(1e-3)));
}

// The finest square that holds a point; `squares` where none does.
fn sun_map_square(map: SunMap, p: vec3f) -> u32 {
    var place = map.place;
    var square = map.squares;
    for (var i = 0u; i < map.squares; i++) {
        let uv = sun_map_coordinate(map, place[i], p).xy;
        square = select(square, i, all(uv > vec2f(0.01)) && all(uv < vec2f(0.99)));
    }
    return square;
}

// Where a point, m from the camera, is in the map.
struct SunMapPlace {
    square: u32,
    at: vec3f,
    // Whether there may be a shadow.
    known: bool,
}

// The place in the finest square that holds a point. Beyond the map layers go on: there they are as in it, again and again.
fn sun_map_place(map: SunMap, p: vec3f) -> SunMapPlace {
    var place = map.place;
    let square = sun_map_square(map, p);
    let inside = square < map.squares;
    let held = select(0u, square, inside);
    let at = sun_map_coordinate(map, place[held], p);
    return SunMapPlace(held, select(vec3f(fract(at.xy), at.z), at, inside), inside || map.endless > 0.0);
}

// Share of light after an optical depth.
fn sun_map_through(optical_depth: f32) -> f32 {
    return exp(-optical_depth);
}

// Optical depth that lets this share of light through: as good as none is through at most 1e-6.
fn sun_map_depth(light: f32) -> f32 {
    return -log(clamp(light, 1e-6, 1.0));
}

// Share of sunlight that comes out below a broad cloud in all, straight or scattered: Joseph, Wiscombe and Weinman,
// "The delta-Eddington approximation", J. Atmos. Sci. 33, 1976, without absorption and over black ground; `optical_depth` is told
// along the beam of elevation sine `mu`, and `turning` is 1 less the asymmetry.
fn sun_map_whole(optical_depth: f32, mu: f32, turning: f32) -> f32 {
    let entering = 2.0 / 3.0 + mu + (2.0 / 3.0 - mu) * exp(-optical_depth);
    return entering / (4.0 / 3.0 + turning * mu * optical_depth);
}

// The planes of a texel: the last place of the last layer is none, and repeats the one before.
fn sun_map_planes(texel: vec4f, layer: u32) -> vec4f {
    return select(texel, texel.xyzz, layer + 1u == SUN_MAP_LAYERS);
}

// Light at a place of one square.
fn sun_map_in(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, square: u32, at: vec3f) -> f32 {
    var place = map.place;
    var planes = map.planes;
    var begin = place[square].w;
    var before = 1.0;
    var light = 1.0;
    for (var i = 0u; i < SUN_MAP_LAYERS; i++) {
        let layer = SUN_MAP_LAYERS * square + i;
        let through = sun_map_planes(textureSampleLevel(lit, linear, at.xy, layer, 0.0), i);
        light += dot(through - vec4f(before, through.xyz), sun_map_passed(begin, planes[layer], at.z));
        begin = planes[layer].w;
        before = through.w;
    }
    return light;
}

// Share of the sun's light that clouds let through to a point, m from the camera: for air and for things.
fn sun_map_light(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, p: vec3f) -> f32 {
    let place = sun_map_place(map, p);
    return select(1.0, sun_map_in(map, lit, linear, place.square, place.at), place.known);
}

const TAPS: u32 = 8u;

// A point of a disc of radius 1: TAPS of them cover it evenly (Vogel's spiral).
fn disc_tap(i: u32) -> vec2f {
    let angle = 2.3999632 * f32(i);
    return sqrt((f32(i) + 0.5) / f32(TAPS)) * vec2f(cos(angle), sin(angle));
}

// Mean distance back along the beam to what shades a place of one square, m.
fn sun_map_distance(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, square: u32, at: vec3f) -> f32 {
    var place = map.place;
    var planes = map.planes;
    var begin = place[square].w;
    var before = 1.0;
    var sum = vec2f(0.0);
    for (var i = 0u; i < SUN_MAP_LAYERS; i++) {
        let layer = SUN_MAP_LAYERS * square + i;
        let through = sun_map_planes(textureSampleLevel(lit, linear, at.xy, layer, 0.0), i);
        let taken = max(vec4f(before, through.xyz) - through, vec4f(0.0)) + 1e-4;
        let middle = 0.5 * (vec4f(begin, planes[layer].xyz) + planes[layer]);
        sum += vec2f(dot(taken, at.z - middle), dot(taken, vec4f(1.0)));
        begin = planes[layer].w;
        before = through.w;
    }
    return max(sum.x / sum.y, 0.0) / -map.along.y;
}

// Mean share over a level disc, radius in m, about a point.
fn sun_map_around(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, p: vec3f, radius: f32) -> f32 {
    let taps = select(0u, TAPS, map.squares > 0u);
    var light = select(1.0, 0.0, taps > 0u);
    for (var tap = 0u; tap < taps; tap++) {
        let away = radius * disc_tap(tap);
        light += sun_map_light(map, lit, linear, p + vec3f(away.x, 0.0, away.y)) / f32(TAPS);
    }
    return light;
}

// Radius of the disc over which light that came in by one point of the top has spread `below` it in a layer of this
// thickness, m: it diffuses, and leaves at both faces, so that the mean square of its way across is
// 2/3 z (2 H - z), whatever the mean free path.
fn sun_map_diffused(thickness: f32, below: f32) -> f32 {
    return sqrt(4.0 / 3.0 * below * (2.0 * thickness - below));
}

// How far light that a cloud scatters down spreads about the foot of its beam, as a share of the way there.
const SPREAD: f32 = 0.7;

// What clouds scatter down to a point, m from the camera, where `light` of the sun's own comes through to it: as behind
// all of them, as much of it as they have taken before the point.
fn sun_map_scattered(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, p: vec3f, light: f32) -> f32 {
    var place = map.place;
    let whole = sun_map_coordinate(map, place[0], p);
    let at = vec3f(select(whole.xy, fract(whole.xy), map.endless > 0.0), whole.z);
    let spread = SPREAD * sun_map_distance(map, lit, linear, 0u, at) * place[0].z;
    let taps = select(0u, TAPS, map.squares > 0u);
    var sum = vec2f(0.0);
    for (var tap = 0u; tap < taps; tap++) {
        let wide = textureSampleLevel(lit, linear, at.xy + spread * disc_tap(tap), SUN_MAP_LAYERS - 1u, 0.0);
        sum += vec2f(max(wide.w - wide.z, 0.0), 1.0 - wide.z) / f32(TAPS);
    }
    return sum.x * saturate((1.0 - light) / max(sum.y, 1e-4));
}

// Light on level ground behind all clouds, as shares of what it has without them: the sun's own, with the penumbra of
// its disc, and what clouds scatter down. The third is the share of sky that no clouds hide, as the sun finds it around.
fn sun_map_ground(map: SunMap, lit: texture_2d_array<f32>, linear: sampler, p: vec3f) -> vec3f {
    var place = map.place;
    let here = sun_map_place(map, p);
    let known = here.square;
    let at = here.at;
    let way = sun_map_distance(map, lit, linear, known, at);
    let radius = map.sun_radius * way * place[known].z;
    // Light spreads far: the coarsest square does for it.
    let whole = select(sun_map_coordinate(map, place[0], p), at, known == 0u);
    let spread = SPREAD * way * place[0].z;
    var light = vec3f(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        let near = at.xy + radius * disc_tap(tap);
        let wide = textureSampleLevel(lit, linear, whole.xy + spread * disc_tap(tap), SUN_MAP_LAYERS - 1u, 0.0);
        light.x += textureSampleLevel(lit, linear, near, SUN_MAP_LAYERS * (known + 1u) - 1u, 0.0).z;
        light.y += max(wide.w - wide.z, 0.0);
        light.z += wide.z;
    }
    return select(vec3f(1.0, 0.0, 1.0), light / f32(TAPS), here.known);
}
