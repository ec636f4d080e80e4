// How well the light of sky, horizon and ground reaches each voxel of a cloud: optical
// depth up, down, and that which conducts as the sides do on average. The light is diffuse,
// so the noise is left out. One thread a voxel.
// @use column eddington light_box medium

@group(0) @binding(0) var<uniform> box: LightBox;
// Lists of what is in each brick.
@group(0) @binding(1) var<storage, read> lists: array<Region>;
@group(0) @binding(2) var<storage, read> candidates: array<u32>;
@group(0) @binding(3) var volume: texture_storage_3d<rgba16float, write>;

const SIDES: u32 = 6u;
// Samples of each path, at distances that grow with their square.
const SAMPLES: u32 = 4u;

// Mean extinction at a point without the forward peak.
fn extinction_at(p: vec3f, blur: f32) -> f32 {
    let list = lists[light_box_brick(textureDimensions(volume), light_box_coordinate(box, p))];
    let matter = medium_mean_at(list, p, blur);
    return transported(medium_species(matter.body)) * matter.extinction;
}

// Optical depth from a point over `reach` metres.
fn optical_depth_along(p: vec3f, direction: vec3f, reach: f32, blur: f32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < SAMPLES; i++) {
        let ends = square_step(i, SAMPLES);
        sum += (ends.y - ends.x) * reach * extinction_at(p + 0.5 * (ends.x + ends.y) * reach * direction, blur);
    }
    return sum;
}

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id >= size) {
        return;
    }
    let uvw = (vec3f(id) + 0.5) / vec3f(size);
    let p = light_box_point(box, uvw);
    let blur = box.length / f32(size.z);
    let above = optical_depth_along(p, -box.along, uvw.z * box.length, blur);
    let below = optical_depth_along(p, box.along, (1.0 - uvw.z) * box.length, blur);
    let g = medium_species(0u).asymmetry;
    let aside = 0.5 * max(length(box.edge_u), length(box.edge_v));
    var sides = 0.0;
    for (var i = 0u; i < SIDES; i++) {
        let depth = optical_depth_along(p, level_direction(i, SIDES), aside, blur);
        sides += diffuse_conductance(g, depth) / f32(SIDES);
    }
    let beside = diffuse_depth(g, sides);
    textureStore(volume, id, vec4f(min(vec3f(above, below, beside), vec3f(LIGHT_BOX_MOST)), 0.0));
}
