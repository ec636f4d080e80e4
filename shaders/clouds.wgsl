// One cloud, marched: opacity, single scattering and multiple scattering in one go.
// Quads cover the tiles that the cloud can touch; each tile lists the ellipsoids that
// its rays can meet. A ray is cut into stretches, bounded by where it enters or leaves
// an ellipsoid or a core: clear stretches are jumped over, stretches of the core are
// homogeneous and integrated in closed form, the rest is sampled.
// @use camera density noise light_box phase octaves eddington slab slab_direct slab_fit slab_functions random atmosphere field harmonics

struct Cloud {
    // The camera's position in the cloud's frame, m.
    camera: vec3f,
    // Share f of extinction in the forward peak that transport leaves out.
    chop: f32,
    to_sun: vec3f,
    // Asymmetry of the phase function without its peak.
    asymmetry: f32,
    // Sunlight above the atmosphere, across the beam.
    sun_irradiance: vec3f,
    // Single-scattering albedo of the medium without the peak.
    albedo: f32,
    // Altitude of the cloud's base and top above the ground, m.
    base: f32,
    top: f32,
    // Mean free path in the core of the medium without the peak, m.
    mean_free_path: f32,
    // Farthest distance of the aerial perspective, m.
    aerial_range: f32,
    // First step behind an edge, as a share of the boundary, and growth of the steps.
    first_step: f32,
    growth: f32,
    // A ray ends where less than this gets through.
    opaque: f32,
    // Longest step, as a share of the boundary.
    longest_step: f32,
    // What is seen of a ray and is lit at once.
    lit_at_once: f32,
    // Angular radius of the sun's disc, rad; 0 where the sky shows none.
    sun_radius: f32,
    // Optical depth in the slab table's medium that is like one of this.
    similarity: f32,
    padding: f32,
    // Distance of what the caller drew = x / (y + z depth) along the view axis.
    scene_depth: vec4f,
    // Legendre moments of the phase function over those of the slab table's, degree 0 to 3.
    degrees: vec4f,
    // Least corner of the box of moments, m, and 1 over its extent.
    field_low: vec3f,
    padding_low: f32,
    field_scale: vec3f,
    padding_scale: f32,
    sun: LightBox,
    sky: LightBox,
}

struct Tile {
    // Left, top, right, bottom, pixels.
    area: vec4u,
    // Where the tile's ellipsoids begin in `candidates`, and how many there are.
    first: u32,
    count: u32,
    padding: vec2u,
}

override COUNTING: bool = false;
override ATMOSPHERE: bool = true;
// Whether the air between camera and cloud shows.
override AERIAL: bool = true;
override SKY_LIGHT: bool = true;
override SCENE_DEPTH: bool = false;
// How multiple scattering is found.
override TRANSPORT: u32 = 4u;
override PEAK: bool = true;
override NORMALS: bool = false;
override ABSORBING: bool = false;
// Whether Kol's and Bouthors' slabs take their light from the direct table.
override DIRECT_TABLE: bool = false;
// Points of a ray at which diffuse light is found, at most 8.
override LIGHT_NODES: u32 = 6u;
override MAX_STEPS: u32 = 512u;

const EMITTER: u32 = 0u;
const SINGLE: u32 = 1u;
const OCTAVES: u32 = 2u;
const DELTA_EDDINGTON: u32 = 3u;
const SLAB: u32 = 4u;
const SLAB_KOL: u32 = 5u;
const SLAB_BOUTHORS: u32 = 6u;
const MOMENTS: u32 = 7u;

// Whether light is that of slabs at one point of a ray.
fn has_one_point() -> bool {
    return TRANSPORT == SLAB_KOL || TRANSPORT == SLAB_BOUTHORS;
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> cloud: Cloud;
@group(0) @binding(2) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(3) var<storage, read> tiles: array<Tile>;
@group(0) @binding(4) var<storage, read> candidates: array<u32>;
@group(0) @binding(5) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(6) var noise_volume: texture_3d<f32>;
@group(0) @binding(7) var repeat: sampler;
@group(0) @binding(8) var clamped: sampler;
@group(0) @binding(9) var phase_table: texture_2d<f32>;
@group(0) @binding(10) var sun_volume: texture_3d<f32>;
@group(0) @binding(11) var sun_depths: texture_2d<f32>;
@group(0) @binding(12) var sun_normals: texture_2d<f32>;
@group(0) @binding(13) var sky_volume: texture_3d<f32>;
@group(0) @binding(14) var transmittance: texture_2d<f32>;
@group(0) @binding(15) var sky_light: texture_2d<f32>;
@group(0) @binding(16) var aerial: texture_3d<f32>;
@group(0) @binding(17) var scene_depth: texture_depth_2d;
@group(0) @binding(18) var<uniform> air: Atmosphere;
// Tables of light, by what the transport needs: the moments and their remainder, of this
// cloud or of slabs, or the direct table of slabs and its phase functions, or Bouthors'
// functions.
@group(0) @binding(20) var light_volume: texture_3d<f32>;
@group(0) @binding(21) var light_angles: texture_2d<f32>;
@group(0) @binding(22) var slab_views: texture_2d<f32>;
@group(0) @binding(23) var slab_suns: texture_2d<f32>;
@group(0) @binding(24) var slab_entries: texture_2d<f32>;
@group(0) @binding(25) var slab_offsets: texture_2d<f32>;
@group(0) @binding(19) var<storage, read_write> counters: array<atomic<u32>, 14>;

// What `--stats` counts, in pairs of low and high words.
const RAYS: u32 = 0u;
const HITS: u32 = 1u;
const STEPS: u32 = 2u;
const DENSITY: u32 = 3u;
const NOISE_READS: u32 = 4u;
const MAP_READS: u32 = 5u;
const ELLIPSOIDS: u32 = 6u;
var<private> counts: array<u32, 7>;

fn count(what: u32, amount: u32) {
    if COUNTING {
        counts[what] += amount;
    }
}

fn store_counts() {
    if COUNTING {
        for (var i = 0u; i < 7u; i++) {
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
        light_of_sky(sky_light, LIGHT_HORIZON), light_of_sky(sky_light, LIGHT_GROUND));
}

// What lies ahead on a ray, from a distance to the next boundary.
struct Stretch {
    end: f32,
    inside: bool,
    // Extinction where the stretch is homogeneous, else 0.
    core: f32,
    // Thinnest boundary of the ellipsoids here, m; less where the noise moves it by more than the
    // noise's own size, for then there is more than one edge in it.
    boundary: f32,
}

// The ellipsoids that a ray meets next: of the tile's that it has not left, the nearest ones that
// there is room for. Before `near_end` along the ray there are no others. Those that the ray is in
// are `holding` it; a point of the ray asks only them.
const MOST_NEAR: u32 = 32u;
var<private> near: array<u32, MOST_NEAR>;
var<private> near_entry: array<f32, MOST_NEAR>;
var<private> near_count: u32;
var<private> near_end: f32;
var<private> holding: array<u32, MOST_NEAR>;
var<private> holding_count: u32;
// Whether the ray is in more than there is room for: then all of the tile are asked.
var<private> crowded: bool;

// Lists the ellipsoids from `t` on.
fn find_near(v: Varyings, ray: Ray, t: f32) {
    count(ELLIPSOIDS, v.count);
    near_count = 0u;
    near_end = 1e30;
    var farthest = 0u;
    for (var i = 0u; i < v.count; i++) {
        let index = candidates[v.first + i];
        let chord = ellipsoid_chord(ellipsoids[index], ray.origin, ray.direction, 1.0);
        if chord.x < chord.y && chord.y > t {
            var place = near_count;
            if near_count == MOST_NEAR {
                near_end = min(near_end, max(chord.x, near_entry[farthest]));
                place = select(MOST_NEAR, farthest, chord.x < near_entry[farthest]);
            }
            if place < MOST_NEAR {
                near[place] = index;
                near_entry[place] = chord.x;
                near_count = min(near_count + 1u, MOST_NEAR);
            }
            if near_count == MOST_NEAR {
                farthest = farthest_near();
            }
        }
    }
    crowded = near_end <= t;
}

// The one of the list that the ray meets last.
fn farthest_near() -> u32 {
    var last = 0u;
    for (var i = 1u; i < MOST_NEAR; i++) {
        last = select(last, i, near_entry[i] > near_entry[last]);
    }
    return last;
}

fn survey(v: Varyings, ray: Ray, t: f32) -> Stretch {
    if t >= near_end || crowded {
        find_near(v, ray, t);
    }
    var entry = 1e30;
    var exit = 1e30;
    var core_exit = 0.0;
    var core = 0.0;
    var densest = 0.0;
    var boundary = 1e30;
    holding_count = 0u;
    let asked = select(near_count, v.count, crowded);
    count(ELLIPSOIDS, asked);
    for (var i = 0u; i < asked; i++) {
        let index = listed(v, i);
        let e = ellipsoids[index];
        let outer = ellipsoid_chord(e, ray.origin, ray.direction, 1.0);
        if outer.x < outer.y && outer.x > t {
            entry = min(entry, outer.x);
        } else if outer.y > t && outer.x <= t {
            if !crowded {
                holding[holding_count] = index;
                holding_count += 1u;
            }
            exit = min(exit, outer.y);
            densest = max(densest, e.extinction);
            let inner = ellipsoid_chord(e, ray.origin, ray.direction, e.core);
            if inner.x <= t && inner.y > t {
                exit = min(exit, inner.y);
                core_exit = select(core_exit, max(inner.y, select(0.0, core_exit, e.extinction == core)), e.extinction >= core);
                core = max(core, e.extinction);
            } else {
                // Only boundaries that the ray is in need short steps, and no boundary is thicker than
                // its ellipsoid: there the core is less than nothing.
                let edges = max(1.0, e.displacement * noise_frame.frequency);
                boundary = min(boundary, (e.displacement + e.rise) / (max(1.0, 1.0 - e.core) * edges));
                exit = select(exit, min(exit, inner.x), inner.x < inner.y && inner.x > t);
            }
        }
    }
    let inside = exit < 1e30;
    // Beyond the end of the list there may be more.
    entry = min(entry, select(near_end, 1e30, crowded));
    if core > 0.0 && core >= densest {
        return Stretch(min(core_exit, entry), true, core, boundary);
    }
    return Stretch(min(entry, exit), inside, 0.0, boundary);
}

// The `i`th ellipsoid of the list, or of the tile where it is crowded.
fn listed(v: Varyings, i: u32) -> u32 {
    if crowded {
        return candidates[v.first + i];
    }
    return near[i];
}

// The union, at a point, of the ellipsoids that the ray is in.
fn matter_at(v: Varyings, p: vec3f, blur: f32) -> Matter {
    let asked = select(holding_count, v.count, crowded);
    count(DENSITY, 1u);
    count(NOISE_READS, 2u);
    count(ELLIPSOIDS, asked);
    let noise = noise_at(noise_volume, repeat, noise_frame, p, blur);
    var matter = CLEAR;
    for (var i = 0u; i < asked; i++) {
        var index = 0u;
        if crowded {
            index = candidates[v.first + i];
        } else {
            index = holding[i];
        }
        let e = ellipsoids[index];
        matter = matter_with(matter, e, ellipsoid_unit(e, p, 1.0), noise, blur);
    }
    return matter;
}

// Optical depth to the sun without the peak, and the part of it in the shadow of other clouds.
fn sun_depth(p: vec3f) -> vec2f {
    if TRANSPORT == EMITTER {
        return vec2f(0.0);
    }
    count(MAP_READS, 1u);
    return textureSampleLevel(sun_volume, clamped, light_box_coordinate(cloud.sun, p), 0.0).rg;
}

// Which way the cloud faces at a point, noise left out: away from where its ellipsoids
// gather. Each weighs by how deep the point is in it, so that there is no seam where one
// ends. Unit length on the surface of a lump, and less inside, down to none in its middle.
fn facing_at(v: Varyings, p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    var weights = 1e-6;
    for (var i = 0u; i < v.count; i++) {
        let e = ellipsoids[candidates[v.first + i]];
        let u = ellipsoid_unit(e, p, 1.0);
        let weight = max(1.0 - dot(u, u), 0.0);
        sum += weight * dot(u, u) * ellipsoid_normal(e, u);
        weights += weight;
    }
    return sum / weights;
}

// Our slab around `uv`, over `length` metres; it holds the point at hand.
fn fitted_slab(uv: vec2f, length: f32, facing: vec3f, depth: f32) -> SlabFit {
    count(MAP_READS, 2u);
    var fit = slab_fit(cloud.sun, sun_depths, sun_normals, clamped, uv, length, facing);
    fit.thickness = max(fit.thickness, depth);
    return fit;
}

// Source of sunlight scattered more than once, per unit of irradiance, less what leaves by
// the sides that a slab has not. `depth` is the cloud's own optical depth to the sun,
// `shadow` that of other clouds, which dims the beam and lets through what it scatters
// straight on.
fn multiple_source(v: Varyings, p: vec3f, direction: vec3f, depth: f32, shadow: f32) -> vec3f {
    let g = cloud.asymmetry;
    let uv = light_box_coordinate(cloud.sun, p).xy;
    let around = facing_at(v, p);
    let away = min(dot(around, cloud.to_sun), 0.0);
    let facing = (1.0 + away) * (around - away * cloud.to_sun);
    count(MAP_READS, 1u);
    let open = openness_at(p);
    var source = 0.0;
    if TRANSPORT == DELTA_EDDINGTON {
        let fit = fitted_slab(uv, cloud.mean_free_path / (1.0 - g), facing, depth);
        let kept = kept_by_sides(fit, depth, open);
        source = kept * eddington_beam(g, fit.mu0, fit.mu0 * depth, fit.mu0 * fit.thickness, dot(direction, fit.normal));
    } else {
        source = slab_sets(uv, direction, facing, depth, open);
    }
    source *= exp(-(1.0 - max(g, 0.0) * g) * shadow);
    var light = vec3f(source);
    if TRANSPORT == SLAB {
        count(MAP_READS, 1u);
        let at = vec2f(phase_coordinate(-cloud.to_sun, -direction), slab_path_coordinate(depth + shadow));
        light += textureSampleLevel(light_angles, clamped, at, 0.0).rgb;
    }
    if ABSORBING {
        light *= absorbed(cloud.albedo, g, depth);
    }
    return max(light, vec3f(0.0));
}

// What the sides leave of light that has wandered as deep as `depth`. Of the six ways out of
// a cloud those along the slab's normal are its faces.
fn kept_by_sides(fit: SlabFit, depth: f32, open: vec3f) -> f32 {
    let faces = diffuse_conductance(cloud.asymmetry, fit.mu0 * depth)
        + diffuse_conductance(cloud.asymmetry, fit.mu0 * (fit.thickness - depth));
    let upright = fit.normal.y * fit.normal.y;
    return side_loss(faces, (open.x + open.z) * (1.0 - upright) + 0.5 * open.y * (1.0 + upright));
}

// Kol's and Bouthors' light: that of slabs at one point of the ray, for all that is behind.
// Their slabs have no sides to lose light by.
fn slab_radiance(p: vec3f, direction: vec3f) -> f32 {
    var radiance = 0.0;
    let uv = light_box_coordinate(cloud.sun, p).xy;
    var fit = slab_fit_kol(cloud.sun, sun_depths, sun_normals, clamped, uv);
    count(MAP_READS, select(0u, fit.reads, TRANSPORT == SLAB_KOL));
    for (var orders = 0u; orders < SLAB_SETS; orders++) {
        if TRANSPORT == SLAB_BOUTHORS {
            fit = slab_fit_bouthors(cloud.sun, sun_depths, sun_normals, slab_entries, slab_offsets, clamped, orders, p,
                -direction, cloud.mean_free_path / cloud.similarity);
            count(MAP_READS, fit.reads);
        }
        let view = slab_fit_view(fit, p, -direction, cloud.to_sun, cloud.mean_free_path / cloud.similarity);
        count(MAP_READS, 3u);
        if DIRECT_TABLE {
            radiance += slab_direct(light_volume, light_angles, clamped, orders, view);
        } else {
            radiance += slab_functions(light_angles, slab_views, slab_suns, clamped, orders, view);
        }
    }
    return radiance;
}

// The sets of orders of scattering, each from the slab that fits the cloud over its spread.
fn slab_sets(uv: vec2f, direction: vec3f, facing: vec3f, depth: f32, open: vec3f) -> f32 {
    var source = 0.0;
    var thickness = depth;
    for (var orders = 0u; orders < SLAB_SETS; orders++) {
        let spread = slab_spread(orders, cloud.similarity * thickness, cloud.similarity * depth) / cloud.similarity;
        let fit = fitted_slab(uv, spread * cloud.mean_free_path, facing, depth);
        thickness = fit.thickness;
        let mu = dot(direction, fit.normal);
        let x = dot(direction, cloud.to_sun) - mu * fit.mu0;
        let scale = cloud.similarity * fit.mu0;
        count(MAP_READS, 2u);
        let light = slab_source(light_volume, clamped, orders, scale * fit.thickness, scale * depth,
            fit.mu0, mu, x, cloud.degrees);
        // The light has wandered deeper than where it is now.
        let wandered = min(depth + 0.5 * spread, max(depth, 0.5 * fit.thickness));
        source += light * kept_by_sides(fit, wandered, open);
    }
    return source;
}

// Conductances from a point up, to the four sides together, and down.
fn openness_at(p: vec3f) -> vec3f {
    let depths = textureSampleLevel(sky_volume, clamped, light_box_coordinate(cloud.sky, p), 0.0).rgb;
    return vec3f(diffuse_conductance(cloud.asymmetry, depths.x), 4.0 * diffuse_conductance(cloud.asymmetry, depths.z),
        diffuse_conductance(cloud.asymmetry, depths.y));
}

// Weights of sky, horizon and ground in the source of their diffuse light; they sum to 1.
fn diffuse_weights(p: vec3f) -> vec3f {
    count(MAP_READS, 1u);
    let open = openness_at(p);
    let weights = open / (open.x + open.y + open.z);
    if ABSORBING {
        // Back from the largest conductance to the smallest optical depth.
        let nearest = diffuse_depth(cloud.asymmetry, max(open.x, open.z));
        return weights * absorbed(cloud.albedo, cloud.asymmetry, nearest);
    }
    return weights;
}

// Source of sunlight scattered more than once, per unit of irradiance: the solved moments,
// and what they leave out, which follows from the optical depth to the sun.
fn source_of_moments(p: vec3f, direction: vec3f, depth: f32) -> vec3f {
    count(MAP_READS, 2u);
    let inside = (p - cloud.field_low) * cloud.field_scale;
    let after = -direction;
    let solved = dot(textureSampleLevel(light_volume, clamped, inside, 0.0), harmonics_low(after));
    let at = vec2f(phase_coordinate(-cloud.to_sun, after), slab_path_coordinate(depth));
    let beyond = textureSampleLevel(light_angles, clamped, at, 0.0).rgb;
    return max(vec3f(solved) + beyond, vec3f(0.0));
}

// Source of the light of sky and ground, from its moments.
fn sky_of_moments(p: vec3f, direction: vec3f) -> vec3f {
    count(MAP_READS, 3u);
    let inside = (p - cloud.field_low) * cloud.field_scale;
    let layers = f32(textureDimensions(sky_volume).z);
    let harmonics = harmonics_low(-direction);
    var light = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        let at = field_coordinate(inside, layers, i, 3u);
        light[i] = dot(textureSampleLevel(sky_volume, clamped, at, 0.0), harmonics);
    }
    return max(light, vec3f(0.0));
}

// Light gathered along a ray, per unit of the lights outside.
struct March {
    transmittance: f32,
    // Full optical depth, peak included.
    optical_depth: f32,
    single: f32,
    multiple: vec3f,
    // Second and third octave, without their phase functions.
    octaves: vec2f,
    // Sunlight that other clouds let through to what is seen.
    sunlit: f32,
    // Weights of sky, horizon and ground; their light where it was solved for.
    diffuse: vec3f,
    // Sum of all weights so far.
    gathered: f32,
    // Distance and height, weighted by what is seen.
    distance: f32,
    height: f32,
    normal: vec3f,
}

// A point of a ray at which diffuse light is found, for all that is seen around it.
struct Node {
    t: f32,
    // Optical depth to the sun, and the part of it in the shadow of other clouds.
    depth: vec2f,
    seen: f32,
}

const MOST_NODES: u32 = 8u;
var<private> nodes: array<Node, MOST_NODES>;
// The one point of Kol and Bouthors: where the ray has gathered this much of its opacity.
const SURFACE: f32 = 0.0625;
var<private> surface: Node;

// A piece of a ray that is lit at once.
struct Piece {
    end: f32,
    // Optical depth to the sun where it begins, and the part of it that is other clouds' shadow.
    sun: vec2f,
    // Its own optical depth, without the peak.
    optical_depth: f32,
    // What is seen of it, and the sum of distances, m, weighted by what is seen.
    seen: f32,
    distance: f32,
}

// Lights a piece; `after` is the optical depth to the sun where it ends.
fn add_light(v: Varyings, m: ptr<function, March>, ray: Ray, piece: Piece, after: vec2f) {
    let seen = piece.seen;
    let t = piece.distance / seen;
    let p = ray.origin + t * ray.direction;
    (*m).distance += piece.distance;
    (*m).height += seen * p.y;
    if TRANSPORT == EMITTER {
        return;
    }
    let depth = 0.5 * (piece.sun + after);
    // Nodes share the opacity of the ray evenly; each lies where half of its share is gathered.
    let gathered = (*m).gathered;
    let node = min(u32((gathered + 0.5 * seen) * f32(LIGHT_NODES)), LIGHT_NODES - 1u);
    if nodes[node].seen == 0.0 || gathered * f32(LIGHT_NODES) < f32(node) + 0.5 {
        nodes[node].t = t;
        nodes[node].depth = depth;
    }
    nodes[node].seen += seen;
    if has_one_point() && gathered <= SURFACE {
        surface = Node(t, depth, 1.0);
    }
    (*m).gathered += seen;
    (*m).single += seen * sunlight_share(piece.optical_depth, piece.sun.x, after.x);
    (*m).sunlit += seen * mean_transmittance(piece.sun.y, after.y);
    if TRANSPORT == OCTAVES {
        (*m).octaves += seen * octave_transmittances(piece.optical_depth, piece.sun.x, after.x);
    }
    if NORMALS {
        (*m).normal += seen * facing_at(v, p);
    }
}

// Lights a piece, where there is one, and begins the next at `t`, which may be farther on.
fn next_piece(v: Varyings, m: ptr<function, March>, ray: Ray, piece: Piece, t: f32) -> Piece {
    var sun = vec2f(0.0);
    if piece.seen > 0.0 {
        sun = sun_depth(ray.origin + piece.end * ray.direction);
        add_light(v, m, ray, piece, sun);
    }
    if t > piece.end {
        sun = sun_depth(ray.origin + t * ray.direction);
    }
    return Piece(t, sun, 0.0, 0.0, 0.0);
}

// Diffuse light changes slowly: it is found at the nodes alone, after the march.
fn add_diffuse_light(v: Varyings, m: ptr<function, March>, ray: Ray) {
    if has_one_point() {
        let light = slab_radiance(ray.origin + surface.t * ray.direction, ray.direction);
        (*m).multiple += (*m).gathered * exp(-surface.depth.y) * light;
    }
    for (var i = 0u; i < LIGHT_NODES; i++) {
        let node = nodes[i];
        if node.seen > 0.0 {
            let p = ray.origin + node.t * ray.direction;
            if TRANSPORT == DELTA_EDDINGTON || TRANSPORT == SLAB {
                let own = max(node.depth.x - node.depth.y, 0.0);
                (*m).multiple += node.seen * multiple_source(v, p, ray.direction, own, node.depth.y);
            }
            if TRANSPORT == MOMENTS {
                (*m).multiple += node.seen * source_of_moments(p, ray.direction, node.depth.x);
            }
            if SKY_LIGHT && TRANSPORT == MOMENTS {
                (*m).diffuse += node.seen * sky_of_moments(p, ray.direction);
            } else if SKY_LIGHT {
                (*m).diffuse += node.seen * diffuse_weights(p);
            }
        }
    }
}

// Shortest step, in widths of a pixel.
const SHORTEST_STEP: f32 = 0.5;
// Share of the distance to a change of density that is stepped over, for noise steepens it, the
// largest optical depth that is, and how many times as long a step may become by it: noise has
// more in store than one point of it tells, and shorter steps must find it.
const STEADY: f32 = 0.6;
const THICKEST_STEP: f32 = 1.0;
const MOST_STRETCHED: f32 = 4.0;
// Optical depth of the first step in a homogeneous core.
const CORE_STEP: f32 = 0.15;
// Steps kept for stretches to come when a ray has used up its own.
const RESERVE: u32 = 8u;
// Rounds for jumps and for the last stretches, beyond the steps that a ray should take.
const SPARE_STEPS: u32 = 256u;

// Ends a ray that is as good as opaque: nothing gets through, and the little light that
// was not gathered is like what was.
fn close(m: ptr<function, March>) {
    let share = 1.0 / (1.0 - (*m).transmittance);
    (*m).single *= share;
    (*m).multiple *= share;
    (*m).octaves *= share;
    (*m).sunlit *= share;
    (*m).diffuse *= share;
    (*m).distance *= share;
    (*m).height *= share;
    (*m).normal *= share;
    (*m).transmittance = 0.0;
    (*m).optical_depth = 1e4;
}

fn march(v: Varyings, ray: Ray, farthest: f32, offset: f32, opaque: f32) -> March {
    var m = March(1.0, 0.0, 0.0, vec3f(0.0), vec2f(0.0), 0.0, vec3f(0.0), 0.0, 0.0, 0.0, vec3f(0.0));
    var t = 0.0;
    find_near(v, ray, t);
    var stretch = Stretch(0.0, false, 0.0, 0.0);
    var step = 0.0;
    var phase = offset;
    var piece = Piece(-1.0, vec2f(0.0), 0.0, 0.0, 0.0);
    for (var i = 0u; i < MAX_STEPS + SPARE_STEPS; i++) {
        // Find the next stretch; jump over clear air.
        if t >= stretch.end {
            stretch = survey(v, ray, t);
            if !stretch.inside {
                if stretch.end >= farthest {
                    break;
                }
                t = stretch.end;
                step = 0.0;
                phase = offset;
                continue;
            }
        }
        // Take one step, no farther than the stretch.
        let blur = pixel_footprint(camera, t);
        let smallest = max(cloud.first_step * stretch.boundary, SHORTEST_STEP * blur);
        let longest = max(cloud.longest_step * stretch.boundary, SHORTEST_STEP * blur);
        let homogeneous = stretch.core > 0.0;
        let spaced = select(clamp(step, smallest, longest), max(step, CORE_STEP / stretch.core), homogeneous);
        // Where steps run short, what is left of the stretch shares those that are left.
        let left = min(stretch.end, farthest) - t;
        let scarce = left / f32(max(MAX_STEPS, i + RESERVE) - i);
        let wanted = max(spaced, select(0.0, scarce, 2u * i > MAX_STEPS));
        var length = min(wanted * phase, left);
        phase = 1.0;
        count(STEPS, 1u);
        var matter = Matter(stretch.core, 0.0, 0.0);
        if !homogeneous {
            matter = matter_at(v, ray.origin + (t + 0.5 * length) * ray.direction, blur);
            // The step is as long as what it found, within reason.
            let thickest = THICKEST_STEP / max((1.0 - cloud.chop) * matter.extinction, 1e-6);
            let most = min(thickest, MOST_STRETCHED * wanted);
            length = min(max(length, min(0.5 * length + STEADY * matter.steady, most)), left);
        }
        // Gather the light of this step in closed form.
        let optical_depth = matter.extinction * length;
        let through = exp(-(1.0 - cloud.chop) * optical_depth);
        let seen = m.transmittance * (1.0 - through);
        // Light what came before, where it is enough or has ended.
        if optical_depth > 0.0 {
            if t > piece.end || piece.seen > cloud.lit_at_once {
                piece = next_piece(v, &m, ray, piece, t);
            }
            piece.end = t + length;
            piece.optical_depth += (1.0 - cloud.chop) * optical_depth;
            piece.seen += seen;
            piece.distance += seen * (t + 0.5 * length);
        }
        m.transmittance *= through;
        m.optical_depth += optical_depth;
        if m.transmittance < opaque {
            break;
        }
        // Inside, steps grow.
        t = select(t + length, stretch.end, t + length >= stretch.end);
        step = select(wanted * cloud.growth, smallest, matter.depth < 0.0);
        if t >= farthest {
            break;
        }
    }
    _ = next_piece(v, &m, ray, piece, piece.end);
    if TRANSPORT >= DELTA_EDDINGTON || (SKY_LIGHT && TRANSPORT != EMITTER) {
        add_diffuse_light(v, &m, ray);
    }
    if m.transmittance < opaque {
        close(&m);
    }
    return m;
}

// Distance along the ray of what the caller drew in this pixel.
fn drawn_distance(pixel: vec2f, ray: Ray) -> f32 {
    if !SCENE_DEPTH {
        return 1e29;
    }
    let depth = textureLoad(scene_depth, vec2u(pixel), 0);
    let d = cloud.scene_depth;
    let axial = select(d.x / max(d.y + d.z * depth, 1e-20), d.x + d.y * depth, camera.projection == ORTHOGRAPHIC);
    return axial / max(dot(ray.direction, normalize(camera.forward)), 1e-6);
}

// Whether the pixel in direction `d` shows any of the sun's disc, which is drawn no
// smaller than a pixel. Its edge must be as dark as the rest.
fn sees_sun_disc(d: vec3f) -> bool {
    return cloud.sun_radius > 0.0 && length(d - cloud.to_sun) < max(cloud.sun_radius, camera.pixel) + camera.pixel;
}

// Max's emitter (1994, after Sabella 1988): the radiance of an opaque cloud, which is the mean
// over all directions of the light of sun, sky and ground that falls on it.
fn emission(v: Varyings, sun: vec3f) -> vec3f {
    let mean = sun / (4.0 * PI);
    return select(mean, mean + 0.5 * (v.sky + v.ground), SKY_LIGHT);
}

// A pixel's light, premultiplied by opacity.
struct Shade {
    alpha: f32,
    single: vec3f,
    multiple: vec3f,
    // Light scattered by the air between camera and cloud.
    air: vec3f,
    distance: f32,
    normal: vec3f,
}

fn shade(v: Varyings) -> Shade {
    count(RAYS, 1u);
    let seen_from_camera = camera_ray(camera, pixel_ndc(camera, v.position.xy));
    let ray = Ray(cloud.camera + seen_from_camera.origin, seen_from_camera.direction);
    let offset = mix(1.0, interleaved_gradient(v.position.xy), camera.jitter);
    var wide = vec3f(0.0);
    var peak = vec3f(0.0);
    if TRANSPORT != EMITTER {
        let u = phase_coordinate(-cloud.to_sun, -ray.direction);
        wide = textureSampleLevel(phase_table, clamped, vec2f(u, 0.25), 0.0).rgb;
        peak = textureSampleLevel(phase_table, clamped, vec2f(u, 0.75), 0.0).rgb;
    }
    // Before the sun a little transmittance is much light: look deeper there.
    let opaque = cloud.opaque / (1.0 + 10.0 * peak.g);
    let m = march(v, ray, drawn_distance(v.position.xy, ray), max(offset, 0.05), opaque);
    // Light of the forward peak is not lost to a smooth background, but it is to the
    // sun's disc: there, and only there, all that was scattered is gone.
    let alpha = 1.0 - select(m.transmittance, exp(-m.optical_depth), PEAK && sees_sun_disc(ray.direction));
    if m.transmittance >= 1.0 {
        return Shade(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, vec3f(0.0));
    }
    count(HITS, 1u);
    let opacity = 1.0 - m.transmittance;
    let distance = m.distance / opacity;
    let height = saturate(0.5 + m.height / (opacity * max(cloud.top - cloud.base, 1.0)));
    let sun = mix(v.sun_base, v.sun_top, height);
    var single = wide * m.single;
    if PEAK {
        single += peak * recovered_peak(m.optical_depth, cloud.chop) * m.sunlit / opacity;
    }
    single *= sun;
    // The moments of sky and ground are light; other models have weights of three lights.
    let weighed = m.diffuse.x * v.sky + m.diffuse.y * v.horizon + m.diffuse.z * v.ground;
    let diffuse = select(weighed, m.diffuse, TRANSPORT == MOMENTS);
    var multiple = cloud.albedo * (sun * m.multiple + diffuse);
    if TRANSPORT == OCTAVES {
        let cosine = dot(ray.direction, cloud.to_sun);
        multiple += cloud.albedo * dot(m.octaves, octave_phases(cloud.asymmetry, cosine)) * sun;
    }
    if TRANSPORT == EMITTER {
        multiple = cloud.albedo * opacity * emission(v, sun);
    }
    if !AERIAL {
        return Shade(alpha, single, multiple, vec3f(0.0), distance, m.normal);
    }
    let air = aerial_perspective(aerial, clamped, v.position.xy / camera.size, distance, cloud.aerial_range);
    return Shade(alpha, single * air.a, multiple * air.a, alpha * cloud.sun_irradiance * air.rgb, distance, m.normal);
}

// Largest value of a half float.
const MOST: vec3f = vec3f(65504.0);

// All light in one, for pictures and games.
@fragment
fn beauty(v: Varyings) -> @location(0) vec4f {
    let s = shade(v);
    store_counts();
    return vec4f(min(s.single + s.multiple + s.air, MOST), s.alpha);
}

struct LightLayers {
    @location(0) single: vec4f,
    @location(1) multiple: vec4f,
    @location(2) air: vec4f,
    // Distance in kilometres, so that half floats hold it.
    @location(3) distance: vec4f,
}

// The same light apart, for compositors.
@fragment
fn layers(v: Varyings) -> LightLayers {
    let s = shade(v);
    store_counts();
    return LightLayers(vec4f(min(s.single, MOST), s.alpha), vec4f(min(s.multiple, MOST), s.alpha), vec4f(min(s.air, MOST), s.alpha),
        vec4f(vec3f(1e-3 * s.distance * s.alpha), s.alpha));
}

// Which way the cloud faces, for compositors.
@fragment
fn normals(v: Varyings) -> @location(0) vec4f {
    let s = shade(v);
    store_counts();
    return vec4f(s.normal, s.alpha);
}

// Work of the pixel, for heat maps: steps, density evaluations, reads of maps. Alpha is 0
// so that the clouds before and behind each other add up.
@fragment
fn cost(v: Varyings) -> @location(0) vec4f {
    _ = shade(v);
    store_counts();
    return vec4f(f32(counts[STEPS]), f32(counts[DENSITY]), f32(counts[MAP_READS]), 0.0);
}
