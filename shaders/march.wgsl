// One cloud, marched: opacity, single scattering and multiple scattering in one go.
// Quads cover the tiles that the cloud can touch; each tile lists what its rays can meet. The
// medium cuts a ray into stretches: clear ones are jumped over, homogeneous ones are integrated in
// closed form, the rest is sampled (`steps`). What is seen is gathered in pieces and lit (`gather`).
// Where clouds pass through one another each sees what the others hide (`crossings`).
// @use atmosphere camera counts crossings random ray_seen steps medium light

// Discs beside the sun's.
const MOST_MOONS: u32 = 4u;

// The cloud for this picture.
struct Cloud {
    // The camera's position in the cloud's frame, m.
    camera: vec3f,
    // A ray ends where less than this gets through.
    opaque: f32,
    to_sun: vec3f,
    // Angular radius of the sun's disc, rad; 0 where the sky shows none.
    sun_radius: f32,
    // Sunlight above the atmosphere, across the beam.
    sun_irradiance: vec3f,
    // Farthest distance of the aerial perspective, m.
    aerial_range: f32,
    // Altitude of the cloud's base and top above the ground, m.
    base: f32,
    top: f32,
    // First and longest step behind an edge, as a share of the boundary, and growth of the steps.
    first_step: f32,
    longest_step: f32,
    growth: f32,
    // What is seen of a ray and is lit at once.
    lit_at_once: f32,
    // Farthest distance of shadows in the air, m.
    shadow_range: f32,
    // Half the earth's curvature, 1/m; 0 where the cloud is small.
    curvature: f32,
    // Distance of what the caller drew = x / (y + z depth) along the view axis.
    scene_depth: vec4f,
    // Unit vectors to moons, and the angular radius of their discs, rad.
    moons: array<vec4f, MOST_MOONS>,
}

struct Tile {
    // Left, top, right, bottom, pixels.
    area: vec4u,
    // Where the tile's ellipsoids begin in `candidates`, and how many there are.
    first: u32,
    count: u32,
    // Where clouds cross here: its block among the visibilities, and where the list of the others is in `candidates`.
    block: u32,
    others: u32,
}

override ATMOSPHERE: bool = true;
// Whether the air between camera and cloud shows.
override AERIAL: bool = true;
// Whether that air lacks light that clouds take.
override AIR_SHADED: bool = false;
// Whether the light at hand lights that air.
override AIR_LIT: bool = true;
override SCENE_DEPTH: bool = false;
// Moons whose discs may be behind the cloud.
override MOONS: u32 = 0u;
// Whether the ground hides what is behind it: the cloud reaches below it.
override GROUND: bool = false;

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> cloud: Cloud;
@group(0) @binding(2) var<storage, read> tiles: array<Tile>;
@group(0) @binding(3) var<storage, read> candidates: array<u32>;
@group(0) @binding(4) var<uniform> air: Atmosphere;
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>, 16>;
@group(0) @binding(6) var clamped: sampler;
@group(0) @binding(7) var aerial: texture_3d<f32>;
@group(0) @binding(8) var scene_depth: texture_depth_2d;
@group(0) @binding(9) var air_shadow: texture_3d<f32>;
// The vertex stage's own, so that they don't count among the textures of the fragment stage.
@group(3) @binding(0) var transmittance: texture_2d<f32>;
@group(3) @binding(1) var sky_light: texture_2d<f32>;

fn store_counts() {
    if COUNTING {
        for (var i = 0u; i < COUNTERS; i++) {
            let before = atomicAdd(&counters[2u * i], counts[i]);
            if before + counts[i] < before {
                atomicAdd(&counters[2u * i + 1u], 1u);
            }
        }
    }
}

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) first: u32,
    @location(1) @interpolate(flat) count: u32,
    // Sunlight that reaches the cloud's base and top; light of sky, horizon and ground.
    @location(2) @interpolate(flat) sun_base: vec3f,
    @location(3) @interpolate(flat) sun_top: vec3f,
    @location(4) @interpolate(flat) sky: vec3f,
    @location(5) @interpolate(flat) horizon: vec3f,
    @location(6) @interpolate(flat) ground: vec3f,
    @location(7) @interpolate(flat) block: u32,
    @location(8) @interpolate(flat) others: u32,
}

fn sun_at(altitude: f32) -> vec3f {
    if !ATMOSPHERE {
        return cloud.sun_irradiance;
    }
    return cloud.sun_irradiance * sun_irradiance_at(air, transmittance, clamped, altitude, cloud.to_sun.y);
}

@vertex
fn quad(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varyings {
    let tile = tiles[instance];
    let corner = vec2u(vertex & 1u, vertex >> 1u);
    let pixel = vec2f(select(tile.area.xy, tile.area.zw, corner == vec2u(1u)));
    return Varyings(vec4f(pixel_ndc(camera, pixel), 0.0, 1.0), tile.first, tile.count,
        sun_at(cloud.base), sun_at(cloud.top), light_of_sky(sky_light, LIGHT_ABOVE),
        light_of_sky(sky_light, LIGHT_HORIZON), light_of_sky(sky_light, LIGHT_GROUND), tile.block, tile.others);
}

// Distance along the ray of what hides the rest of it: the ground, or what the caller drew in this pixel.
fn drawn_distance(pixel: vec2f, ray: LightRay) -> f32 {
    var nearest = 1e29;
    if GROUND {
        let altitude = camera.altitude + ray.origin.y - cloud.camera.y;
        nearest = ground_ahead(air, altitude, ray.direction.y);
    }
    if SCENE_DEPTH {
        let depth = textureLoad(scene_depth, vec2u(pixel), 0);
        nearest = min(nearest, depth_distance(camera, cloud.scene_depth, depth, ray.direction));
    }
    return nearest;
}

// A pixel's light, premultiplied by opacity.
struct Shade {
    alpha: f32,
    // What is seen of the cloud: its own opacity where it is alone.
    visible: f32,
    // Of the sun, scattered once and more often, and of sky and ground.
    single: vec3f,
    multiple: vec3f,
    ambient: vec3f,
    // Light scattered by the air between camera and cloud.
    air: vec3f,
    distance: f32,
    normal: vec3f,
}

// Whether the disc of the sun or of a moon may be seen in a direction.
fn is_before_disc(direction: vec3f) -> bool {
    var before = sees_disc(direction, cloud.to_sun, cloud.sun_radius, camera.pixel);
    for (var i = 0u; i < MOONS; i++) {
        before = before || sees_disc(direction, cloud.moons[i].xyz, cloud.moons[i].w, camera.pixel);
    }
    return before;
}

// The ray through a pixel.
fn ray_of(v: Varyings, pixel: vec2f) -> LightRay {
    let seen = camera_ray(camera, pixel_ndc(camera, pixel));
    return LightRay(cloud.camera + seen.origin, seen.direction, cloud.to_sun, Region(v.first, v.count), medium_species(0u),
        cloud.curvature * (1.0 - seen.direction.y * seen.direction.y));
}

// The march of a ray that is as good as opaque where less than `opaque` gets through.
fn march_of(ray: LightRay, pixel: vec2f, opaque: f32) -> March {
    let offset = mix(1.0, interleaved_gradient(pixel), camera.jitter);
    return march(ray, drawn_distance(pixel, ray), max(offset, 0.05), opaque);
}

fn opaque_of(ray: LightRay) -> f32 {
    return opaque_ahead(opaque_before(cloud.opaque, light_glare(ray)), light_ahead(ray.species));
}

fn alpha_of(ray: LightRay, seen: RaySeen) -> f32 {
    return ray_alpha(seen, light_transported(ray.species), PEAK && is_before_disc(ray.direction));
}

fn shade(v: Varyings) -> Shade {
    count(RAYS, 1u);
    if CROSSES {
        crossing_begins(v.others, v.position.xy);
    }
    let ray = ray_of(v, v.position.xy);
    let opaque = opaque_of(ray);
    let m = march_of(ray, v.position.xy, opaque);
    if m.transmittance >= 1.0 {
        var nothing = Shade();
        nothing.alpha = crossing_alpha(0.0);
        return nothing;
    }
    count(HITS, 1u);
    var visible = 1.0;
    if CROSSES {
        visible = max(m.visible / m.gathered, 1e-6);
    }
    var seen = ray_seen(m.transmittance, m.optical_depth, opaque, visible);
    let own = alpha_of(ray, seen);
    if CROSSES {
        seen.together = crossing_ratio(own, seen.opacity);
    }
    let alpha = crossing_alpha(own);
    let distance = ray_mean(m.distance, seen);
    let height = ray_height(m.height, cloud.top - cloud.base, seen);
    let normal = seen.share * m.normal;
    let lights = Lights(mix(v.sun_base, v.sun_top, height), v.sky, v.horizon, v.ground);
    let light = light_ray(m.light, ray, seen, lights);
    if !AERIAL {
        return Shade(alpha, own * visible, light.single, light.multiple, light.ambient, vec3f(0.0), distance, normal);
    }
    let uv = v.position.xy / camera.size;
    let air = aerial_perspective(aerial, clamped, uv, distance, cloud.aerial_range);
    var shining = air.rgb;
    if !AIR_LIT {
        shining = vec3f(0.0);
    }
    if AIR_SHADED {
        shining = max(shining - aerial_perspective(air_shadow, clamped, uv, distance, cloud.shadow_range).rgb, vec3f(0.0));
    }
    return Shade(alpha, own * visible, light.single * air.a, light.multiple * air.a, light.ambient * air.a,
        own * visible * cloud.sun_irradiance * shining, distance, normal);
}

// Largest value of a half float.
const MOST: vec3f = vec3f(65504.0);

// All light in one, for pictures and games.
@fragment
fn beauty(v: Varyings) -> @location(0) vec4f {
    let s = shade(v);
    store_counts();
    return vec4f(min(s.single + s.multiple + s.ambient + s.air, MOST), s.alpha);
}

// The same light apart.
struct LightLayers {
    @location(0) single: vec4f,
    @location(1) multiple: vec4f,
    @location(2) ambient: vec4f,
    @location(3) air: vec4f,
}

// How far a ray sees, for clouds that pass through this one. Nothing is drawn.
@fragment
fn visibility(v: Varyings) {
    count(RAYS, 1u);
    let ray = ray_of(v, v.position.xy);
    let opaque = opaque_of(ray);
    let m = march_of(ray, v.position.xy, opaque);
    store_counts();
    if m.transmittance < 1.0 {
        let seen = ray_seen(m.transmittance, m.optical_depth, opaque, 1.0);
        keep_visibility(v.block, vec2u(v.position.xy), visibility_marked(seen.opacity, alpha_of(ray, seen)));
    }
}

// What is where: which way the cloud faces, its distance in kilometres, so that half floats hold it, and the same of
// this cloud alone with its opacity, of which another that passes through it may hide some. Of what goes into two channels alpha is there to be blended by.
struct Places {
    @location(0) normal: vec4f,
    @location(1) distance: vec4f,
    @location(2) matte: vec4f,
}

// Both in one.
struct Everything {
    @location(0) single: vec4f,
    @location(1) multiple: vec4f,
    @location(2) ambient: vec4f,
    @location(3) air: vec4f,
    @location(4) normal: vec4f,
    @location(5) distance: vec4f,
    @location(6) matte: vec4f,
}

fn light_layers(s: Shade) -> LightLayers {
    return LightLayers(vec4f(min(s.single, MOST), s.alpha), vec4f(min(s.multiple, MOST), s.alpha),
        vec4f(min(s.ambient, MOST), s.alpha), vec4f(min(s.air, MOST), s.alpha));
}

fn places_of(s: Shade) -> Places {
    let away = 1e-3 * s.distance * s.visible;
    return Places(vec4f(s.normal, s.alpha), vec4f(vec3f(away), s.alpha), vec4f(away, s.visible, 0.0, s.visible));
}

// Light apart, for compositors.
@fragment
fn layers(v: Varyings) -> LightLayers {
    let s = shade(v);
    store_counts();
    return light_layers(s);
}

// What is where, where one pass has no room for both.
@fragment
fn places(v: Varyings) -> Places {
    let s = shade(v);
    store_counts();
    return places_of(s);
}

// Light and what is where.
@fragment
fn everything(v: Varyings) -> Everything {
    let s = shade(v);
    store_counts();
    let light = light_layers(s);
    let places = places_of(s);
    return Everything(light.single, light.multiple, light.ambient, light.air, places.normal, places.distance, places.matte);
}

// Work of the pixel, for heat maps: steps, density evaluations, reads of maps. Alpha is 0
// so that the clouds before and behind each other add up.
@fragment
fn cost(v: Varyings) -> @location(0) vec4f {
    _ = shade(v);
    store_counts();
    return vec4f(f32(counts[STEPS]), f32(counts[DENSITY]), f32(counts[MAP_READS]), 0.0);
}
