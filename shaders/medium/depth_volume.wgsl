// The medium as a sparse volume of depths below the cloud's boundary, baked once a shape
// (`depth_bake`), with the same noise on top: one read of it takes the place of asking each ellipsoid.
// @use counts density depth_volume noise region species

@group(1) @binding(0) var<uniform> volume_frame: DepthVolume;
@group(1) @binding(1) var<storage, read> species: array<Species>;
@group(1) @binding(2) var<uniform> noise_frame: NoiseFrame;
@group(1) @binding(3) var noise_volume: texture_3d<f32>;
@group(1) @binding(4) var repeat: sampler;
@group(1) @binding(5) var depth_index: texture_3d<u32>;
@group(1) @binding(6) var depth_atlas: texture_3d<f32>;
@group(1) @binding(7) var depth_sampler: sampler;

fn medium_species(index: u32) -> Species {
    return species[index];
}

fn medium_noise(p: vec3f, footprint: f32) -> vec2f {
    return noise_at(noise_volume, repeat, noise_frame, p, footprint);
}

// A point among the bricks: its brick, and what the index tells of that.
struct DepthPlace {
    place: vec3f,
    brick: vec3f,
    entry: u32,
}

fn depth_place(p: vec3f) -> DepthPlace {
    let place = (p - volume_frame.low) / volume_frame.brick;
    let brick = floor(place);
    let outside = any(brick < vec3f(0.0)) || any(brick >= vec3f(volume_frame.size));
    let held = vec3u(clamp(brick, vec3f(0.0), vec3f(volume_frame.size) - 1.0));
    return DepthPlace(place, brick, select(textureLoad(depth_index, held, 0).x, 0u, outside));
}

// Depth, extinction, displacement and wispiness.
fn depth_texel(at: DepthPlace) -> vec4f {
    let coordinate = depth_coordinate(volume_frame, depth_number(at.entry), at.place - at.brick);
    return textureSampleLevel(depth_atlas, depth_sampler, coordinate, 0.0);
}

// What is at a point, with this noise; edges are no sharper than `blur`, m.
fn baked_at(p: vec3f, noise: vec2f, blur: f32) -> Matter {
    let at = depth_place(p);
    let kind = depth_kind(at.entry);
    let texel = depth_texel(at);
    if kind == DEPTH_CORE {
        return Matter(volume_frame.core, 1e4, volume_frame.brick, 0u);
    }
    if kind == DEPTH_EMPTY || texel.x <= 0.0 {
        let depth = select(texel.x, -volume_frame.brick, kind == DEPTH_EMPTY);
        return Matter(0.0, depth, -depth, 0u);
    }
    return matter_below(depth_edge(volume_frame, texel), texel.x, noise, blur);
}

fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    return baked_at(p, medium_noise(p, footprint), blur);
}

fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return baked_at(p, vec2f(0.0), blur);
}

fn medium_on_ray(region: Region, p: vec3f, blur: f32) -> Matter {
    count(DENSITY, 1u);
    count(NOISE_READS, 2u);
    count(VOLUME_READS, 2u);
    return medium_at(region, p, blur, blur);
}

fn medium_begin(region: Region, origin: vec3f, direction: vec3f) {
}

// Thickness of the boundary that steps go by, m: less where the noise moves it by more than the noise's
// own size, for then there is more than one edge in it.
fn stepped_boundary() -> f32 {
    return volume_frame.boundary / max(1.0, volume_frame.boundary * noise_frame.frequency);
}

// Bricks that are looked at for what comes next, and steps towards a boundary in one.
const MOST_BRICKS: u32 = 24u;
const MOST_APPROACHES: u32 = 6u;

// What lies ahead of `t` on the ray.
fn medium_ahead(region: Region, origin: vec3f, direction: vec3f, t: f32) -> Stretch {
    let nudge = 1e-3 * volume_frame.brick;
    let steady = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let a = (volume_frame.low - origin) / steady;
    let b = (volume_frame.low + volume_frame.brick * vec3f(volume_frame.size) - origin) / steady;
    let near = min(a, b);
    let far = max(a, b);
    let enters = max(near.x, max(near.y, near.z));
    let leaves = min(far.x, min(far.y, far.z));
    var now = max(t, enters + nudge);
    if now >= leaves || enters >= leaves {
        return Stretch(1e30, false, 0.0, 0.0, 0u);
    }
    // Jump over what is empty.
    var at = depth_place(origin + now * direction);
    for (var i = 0u; i < MOST_BRICKS; i++) {
        count(VOLUME_READS, 1u);
        if depth_kind(at.entry) != DEPTH_EMPTY || now >= leaves {
            break;
        }
        let clear = vec3f(max(f32(depth_number(at.entry)), 1.0) - 1.0);
        now = max(now, depth_exit(volume_frame, at.brick - clear, at.brick + clear + 1.0, origin, direction)) + nudge;
        at = depth_place(origin + now * direction);
    }
    if now >= leaves {
        return Stretch(1e30, false, 0.0, 0.0, 0u);
    }
    let exit = max(now, depth_exit(volume_frame, at.brick, at.brick + 1.0, origin, direction)) + nudge;
    if depth_kind(at.entry) == DEPTH_CORE {
        if now > t {
            return Stretch(now, false, 0.0, 0.0, 0u);
        }
        return Stretch(exit, true, volume_frame.core, stepped_boundary(), 0u);
    }
    // Approach the boundary, which is no nearer than the depth tells.
    for (var i = 0u; i < MOST_APPROACHES; i++) {
        count(VOLUME_READS, 1u);
        let depth = depth_texel(at).x;
        if depth_kind(at.entry) != DEPTH_STORED || depth >= 0.0 || now >= exit {
            break;
        }
        now += max(-depth, 0.5 * volume_frame.brick / f32(DEPTH_CELLS));
        at.place = (origin + now * direction - volume_frame.low) / volume_frame.brick;
    }
    if now > t {
        return Stretch(min(now, exit), false, 0.0, 0.0, 0u);
    }
    return Stretch(exit, true, 0.0, stepped_boundary(), 0u);
}

// Which way the cloud faces at a point, noise left out: against the slope of the depth. Unit length at
// the boundary, and less inside.
fn medium_facing(region: Region, p: vec3f) -> vec3f {
    let h = volume_frame.brick / f32(DEPTH_CELLS);
    var slope = vec3f(0.0);
    for (var i = 0u; i < 6u; i++) {
        var way = vec3f(0.0);
        way[i % 3u] = select(1.0, -1.0, i >= 3u);
        slope += way * baked_depth(p + h * way);
    }
    let deep = 1.0 - saturate(max(baked_depth(p), 0.0) / (4.0 * volume_frame.brick));
    return -deep * slope / max(length(slope), 1e-6);
}

fn baked_depth(p: vec3f) -> f32 {
    let at = depth_place(p);
    let kind = depth_kind(at.entry);
    let inside = select(-volume_frame.brick, volume_frame.brick, kind == DEPTH_CORE);
    return select(inside, depth_texel(at).x, kind == DEPTH_STORED);
}
