// The medium as a sparse volume of depths below the cloud's boundary, baked once a shape
// (`depth_bake`), with the same noise on top: one read of it takes the place of asking each ellipsoid.
// @use counts density depth_volume ray_box region

@group(1) @binding(0) var<uniform> volume_frame: DepthVolume;
@group(1) @binding(1) var<storage, read> bodies: array<Body>;
@group(1) @binding(2) var noise_volume: texture_3d<f32>;
@group(1) @binding(3) var repeat: sampler;
// By brick, x fastest. No texture: models of light need all that a shader may have.
@group(1) @binding(4) var<storage, read> depth_index: array<u32>;
@group(1) @binding(5) var depth_atlas: texture_3d<f32>;
@group(1) @binding(6) var depth_sampler: sampler;

fn medium_species(body: u32) -> Species {
    return bodies[body].species;
}

fn depth_place(p: vec3f) -> DepthPlace {
    let place = (p - volume_frame.low) / volume_frame.brick;
    let brick = floor(place);
    let outside = any(brick < vec3f(0.0)) || any(brick >= vec3f(volume_frame.size));
    let held = vec3u(clamp(brick, vec3f(0.0), vec3f(volume_frame.size) - 1.0));
    let size = volume_frame.size;
    let entry = depth_index[(held.z * size.y + held.y) * size.x + held.x];
    return DepthPlace(place, brick, select(entry, 0u, outside));
}

// Depth, share of the densest extinction, boundary and wispiness.
fn depth_texel(at: DepthPlace) -> vec4f {
    let coordinate = depth_coordinate(volume_frame, depth_number(at.entry), at.place - at.brick);
    return textureSampleLevel(depth_atlas, depth_sampler, coordinate, 0.0);
}

fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    return cloud_at(p, vec3f(0.0, 1.0, 0.0), footprint, blur, 1.0);
}

// What is there on average over the noise.
fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return cloud_at(p, vec3f(0.0, 1.0, 0.0), 0.0, blur, 0.0);
}

fn medium_on_ray(region: Region, p: vec3f, direction: vec3f, blur: f32) -> Matter {
    count(DENSITY, 1u);
    count(VOLUME_READS, 2u);
    return cloud_at(p, direction, blur, blur, 1.0);
}

// What is at a point, seen along a direction, with this `share` of the noise.
fn cloud_at(p: vec3f, direction: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    let at = depth_place(p);
    let texel = depth_texel(at);
    let certain = depth_certain(volume_frame, at, texel, direction);
    if certain.extinction >= 0.0 {
        return matter_at_height(bodies[0], certain, p.y);
    }
    let body = bodies[0];
    var noise = vec2f(0.0);
    if share > 0.0 && p.y > body.level {
        count(NOISE_READS, noise_reads(body.noise));
        noise = share * noise_at(noise_volume, repeat, body.noise, p, footprint);
    }
    return matter_below(body, 0u, depth_edge(volume_frame, texel), p.y, noise, blur);
}

fn medium_begin(region: Region, origin: vec3f, direction: vec3f, bend: f32) {
}

// Bricks that one stretch of a ray is long, so that short steps are shared by what is near.
const STRETCH: f32 = 8.0;

// What lies ahead of `t` on the ray, in which what is clear tells how far it is so.
fn medium_ahead(region: Region, origin: vec3f, direction: vec3f, t: f32) -> Stretch {
    let high = volume_frame.low + volume_frame.brick * vec3f(volume_frame.size);
    let span = box_span(volume_frame.low, high, origin, direction);
    if t >= span.y || span.x >= span.y {
        return Stretch(1e30, false, 0.0, 0.0, 0u);
    }
    let boundary = depth_boundary(volume_frame, bodies[0].noise.frequency);
    let end = min(span.y, t + STRETCH * volume_frame.brick);
    return Stretch(select(end, span.x, t < span.x), t >= span.x, 0.0, boundary, 0u);
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
    return depth_facing(volume_frame, slope, baked_depth(p));
}

fn baked_depth(p: vec3f) -> f32 {
    let at = depth_place(p);
    let kind = depth_kind(at.entry);
    let inside = select(-volume_frame.brick, volume_frame.brick, kind == DEPTH_CORE);
    return select(inside, depth_texel(at).x, kind == DEPTH_STORED);
}
