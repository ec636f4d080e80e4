// The medium as a layer: a height field that repeats (`lib/layer`), whose boundary noise displaces as that of
// other clouds.
// @use counts layer ray_box region

@group(1) @binding(0) var<uniform> layer: Layer;
@group(1) @binding(1) var<storage, read> bodies: array<Body>;
@group(1) @binding(2) var noise_volume: texture_3d<f32>;
@group(1) @binding(3) var repeat: sampler;
@group(1) @binding(4) var layer_texels: texture_2d<f32>;
// Greatest values of the field in squares and around them: 64 by 64 of 16 texels, then 32 by 32, and so on. No texture:
// some drivers read one mip for neighbouring rays.
@group(1) @binding(5) var<storage, read> layer_peaks: array<f32>;

fn medium_species(body: u32) -> Species {
    return bodies[body].species;
}

fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    return cloud_at(p, footprint, blur, 1.0);
}

// What is there on average over the noise.
fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return cloud_at(p, blur, blur, 0.0);
}

fn medium_on_ray(region: Region, p: vec3f, direction: vec3f, blur: f32) -> Matter {
    count(DENSITY, 1u);
    count(VOLUME_READS, 1u);
    return cloud_at(p, blur, blur, 1.0);
}

fn field_at(p: vec3f, footprint: f32) -> LayerField {
    let texel = textureSampleLevel(layer_texels, repeat, layer.frequency * p.xz, layer_mip(layer, footprint));
    return layer_field(layer, texel);
}

// What is at a point, with this `share` of the noise.
fn cloud_at(p: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    let edge = layer_edge(layer, field_at(p, footprint), p.y - layer.rim);
    let body = bodies[0];
    var noise = vec2f(0.0);
    if share > 0.0 && edge.depth > 0.0 && edge.depth < 2.0 * edge.boundary {
        count(NOISE_READS, noise_reads(body.noise));
        noise = share * noise_at(noise_volume, repeat, body.noise, p, footprint);
    }
    return matter_below(body, 0u, edge, p.y, noise, blur);
}

// Half the earth's curvature along the ray at hand, 1/m.
var<private> layer_bend: f32;

fn medium_begin(region: Region, origin: vec3f, direction: vec3f, bend: f32) {
    layer_bend = bend;
}

// Least squares along an edge of a period.
const LAYER_SQUARES: u32 = 64u;
// Squares that are looked at in one go.
const SQUARES: u32 = 6u;
// Steps go by a share of the layer's thickness where its boundary is thicker or thinner than that, and by one of
// the distance, beyond which nothing is seen of it.
const STEP_SHARES: vec2f = vec2f(0.1, 0.4);
const STEP_GROWTH: f32 = 0.004;

// What lies ahead of `t` on the ray: squares of the field in which it is under no part of the layer are clear.
fn medium_ahead(region: Region, origin: vec3f, direction: vec3f, t: f32) -> Stretch {
    let span = layer_span(layer, origin.y, direction.y, layer_bend, t);
    if span.x >= span.y {
        return Stretch(1e30, false, 0.0, 0.0, 0u);
    }
    if t < span.x {
        return Stretch(span.x, false, 0.0, 0.0, 0u);
    }
    let level = layer_square(layer, t);
    let square = SQUARE * layer.texel * f32(1u << level);
    var here = t;
    for (var i = 0u; i < SQUARES && here < span.y; i++) {
        let end = min(here + square_exit(origin, direction, here, square), span.y);
        if !square_is_clear(origin, direction, here, end, level, square) {
            break;
        }
        here = end;
    }
    if here > t {
        return Stretch(here, false, 0.0, 0.0, 0u);
    }
    let end = min(t + square_exit(origin, direction, t, square), span.y);
    let thickness = layer.top + layer.bottom;
    let boundary = layer.boundary / max(1.0, layer.boundary * bodies[0].noise.frequency);
    let bounded = clamp(boundary, STEP_SHARES.x * thickness, STEP_SHARES.y * thickness);
    return Stretch(end, true, 0.0, max(bounded, STEP_GROWTH * t), 0u);
}

fn square_place(origin: vec3f, direction: vec3f, t: f32, square: f32) -> vec2f {
    return (origin.xz + t * direction.xz) / square;
}

// Distance along the ray to where it leaves the square over which it is.
fn square_exit(origin: vec3f, direction: vec3f, t: f32, square: f32) -> f32 {
    // Along a wall a ray leaves by the others.
    let place = select(square_place(origin, direction, t, square), vec2f(0.5), abs(direction.xz) < vec2f(1e-6));
    return cell_exit(vec3f(place.x, 0.5, place.y), square, 0.0, vec3f(direction.x, 0.0, direction.z));
}

// Whether nothing of the layer reaches to where a ray is over or under a square.
fn square_is_clear(origin: vec3f, direction: vec3f, start: f32, end: f32, level: u32, square: f32) -> bool {
    count(MAP_READS, 1u);
    let size = i32(LAYER_SQUARES >> level);
    let place = vec2i(floor(square_place(origin, direction, 0.5 * (start + end), square)));
    let like = ((place % size) + size) % size;
    let finer = 4 * (i32(LAYER_SQUARES * LAYER_SQUARES) - size * size) / 3;
    let peak = layer_peaks[finer + like.y * size + like.x];
    let heights = origin.y - layer.rim + vec2f(start, end) * (direction.y + vec2f(start, end) * layer_bend);
    let nearest = clamp(0.0, min(heights.x, heights.y), max(heights.x, heights.y));
    return !layer_reaches(layer, layer_heaps(layer), peak, nearest) && !layer_reaches(layer, layer_sheet(layer), peak, nearest);
}

// Which way the layer faces at a point, noise left out: against the slope of what the field leaves.
fn medium_facing(region: Region, p: vec3f) -> vec3f {
    let field = field_at(p, layer.texel);
    let slope = vec3f(field.slope.x, -layer_need(layer, layer_heaps(layer), p.y - layer.rim).y, field.slope.y);
    return -slope / max(length(slope), 1e-9);
}
