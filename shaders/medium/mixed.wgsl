// The medium as all that a scene has: clouds of ellipsoids, layers, meshes and volumes. Extinction at a point is that of the densest
// of them, as among clouds. For those that ask at points alone.
// @use counts depth_volume ellipsoids_at layer region volume

const MOST_LAYERS: u32 = 4u;
const MOST_VOLUMES: u32 = 8u;
const MOST_MESHES: u32 = 8u;

// A layer: its frame's origin, m, and its body.
struct PlacedLayer {
    layer: Layer,
    origin: vec3f,
    body: u32,
}

struct PlacedVolume {
    volume: Volume,
    origin: vec3f,
    body: u32,
}

// A mesh, and where its index begins among those of all.
struct PlacedMesh {
    volume: DepthVolume,
    origin: vec3f,
    body: u32,
    first: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct Mixed {
    layers: array<PlacedLayer, MOST_LAYERS>,
    volumes: array<PlacedVolume, MOST_VOLUMES>,
    meshes: array<PlacedMesh, MOST_MESHES>,
    layer_count: u32,
    volume_count: u32,
    mesh_count: u32,
    padding_0: u32,
}

@group(1) @binding(4) var<uniform> mixed: Mixed;
@group(1) @binding(5) var layer_fields: texture_2d_array<f32>;
// Rows of MIXED_ROW entries: a storage buffer more would be one too many.
@group(1) @binding(6) var volume_index: texture_2d<u32>;
@group(1) @binding(7) var volume_atlas: texture_3d<f32>;
@group(1) @binding(8) var volume_sampler: sampler;
@group(1) @binding(9) var depth_atlas: texture_3d<f32>;

const MIXED_ROW: u32 = 4096u;

fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    return all_at(region, p, footprint, blur, 1.0);
}

fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return all_at(region, p, 0.0, blur, 0.0);
}

fn all_at(region: Region, p: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    var matter = clouds_at(region, p, footprint, blur, share);
    for (var i = 0u; i < mixed.layer_count; i++) {
        matter = matter_union(matter, layer_at(i, p, footprint, blur, share));
    }
    for (var i = 0u; i < mixed.volume_count; i++) {
        matter = matter_union(matter, volume_at(i, p));
    }
    for (var i = 0u; i < mixed.mesh_count; i++) {
        matter = matter_union(matter, mesh_at(i, p, footprint, blur, share));
    }
    return matter;
}

fn layer_at(number: u32, place: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    let layer = mixed.layers[number].layer;
    let index = mixed.layers[number].body;
    let p = place - mixed.layers[number].origin;
    let at = layer.frequency * p.xz;
    let texel = textureSampleLevel(layer_fields, repeat, at, number, layer_mip(layer, footprint));
    let edge = layer_edge(layer, layer_field(layer, texel), p.y - layer.rim);
    let body = bodies[index];
    var noise = vec2f(0.0);
    if share > 0.0 && edge.depth > 0.0 && edge.depth < 2.0 * edge.boundary {
        noise = share * noise_at(noise_volume, repeat, body.noise, p, footprint);
    }
    return matter_below(body, index, edge, p.y, noise, blur);
}

fn mesh_at(number: u32, place: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    let volume = mixed.meshes[number].volume;
    let index = mixed.meshes[number].body;
    let p = place - mixed.meshes[number].origin;
    let q = (p - volume.low) / volume.brick;
    let brick = floor(q);
    if any(brick < vec3f(0.0)) || any(brick >= vec3f(volume.size)) {
        return CLEAR;
    }
    let held = vec3u(brick);
    let at = mixed.meshes[number].first + (held.z * volume.size.y + held.y) * volume.size.x + held.x;
    let entry = textureLoad(volume_index, vec2u(at % MIXED_ROW, at / MIXED_ROW), 0).r;
    let coordinate = depth_coordinate(volume, depth_number(entry), q - brick);
    let texel = textureSampleLevel(depth_atlas, volume_sampler, coordinate, 0.0);
    var certain = depth_certain(volume, DepthPlace(q, brick, entry), texel, vec3f(0.0, 1.0, 0.0));
    let body = bodies[index];
    if certain.extinction >= 0.0 {
        certain.body = index;
        return matter_at_height(body, certain, p.y);
    }
    var noise = vec2f(0.0);
    if share > 0.0 && p.y > body.level {
        noise = share * noise_at(noise_volume, repeat, body.noise, p, footprint);
    }
    return matter_below(body, index, depth_edge(volume, texel), p.y, noise, blur);
}

// The finest level: who asks at points alone has no footprint.
fn volume_at(number: u32, place: vec3f) -> Matter {
    let volume = mixed.volumes[number].volume;
    let level = 0u;
    let p = volume_place(volume, place - mixed.volumes[number].origin);
    let brick = floor(p);
    var matter = CLEAR;
    if volume_holds(volume, level, brick) {
        let at = volume_entry(volume, level, brick);
        let entry = textureLoad(volume_index, vec2u(at % MIXED_ROW, at / MIXED_ROW), 0).r;
        if entry != VOLUME_EMPTY {
            let coordinate = volume_coordinate(volume, volume_number(entry), p - brick);
            let share = textureSampleLevel(volume_atlas, volume_sampler, coordinate, 0.0).r;
            matter = volume_matter(volume, volume.extinction * share, mixed.volumes[number].body);
        }
    }
    return matter;
}
