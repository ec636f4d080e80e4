// How well the light of sky, horizon and ground reaches each voxel of a cloud: optical
// depth up, optical depth down, and mean conductance to the sides. One thread marches
// one column, twice: the depth below a voxel is what remains of the column's total.
// @use density noise light_box eddington

@group(0) @binding(0) var<uniform> box: LightBox;
@group(0) @binding(1) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(2) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(3) var noise_volume: texture_3d<f32>;
@group(0) @binding(4) var repeat: sampler;
@group(0) @binding(5) var volume: texture_storage_3d<rgba16float, write>;

const SIDES: u32 = 6u;
const SAMPLES_ASIDE: u32 = 4u;

// Extinction at a point without the forward peak, given the noise there.
fn extinction_with(p: vec3f, noise: vec2f, blur: f32) -> f32 {
    var matter = CLEAR;
    for (var i = 0u; i < box.own; i++) {
        matter = matter_with(matter, ellipsoids[i], ellipsoid_unit(ellipsoids[i], p, 1.0), noise, blur);
    }
    return (1.0 - box.chop) * matter.extinction;
}

fn extinction_at(p: vec3f, blur: f32) -> f32 {
    return extinction_with(p, noise_at(noise_volume, repeat, noise_frame, p, 0.5 * box.texel), blur);
}

// Mean conductance of horizontal paths out of the cloud, noise left out: samples at
// distances that grow with their square, to the edge of the box at most.
fn side_conductance(p: vec3f, blur: f32) -> f32 {
    let reach = 0.5 * max(length(box.edge_u), length(box.edge_v));
    var sum = 0.0;
    for (var side = 0u; side < SIDES; side++) {
        let angle = 6.2831853 * f32(side) / f32(SIDES);
        let direction = vec3f(cos(angle), 0.0, sin(angle));
        var optical_depth = 0.0;
        for (var i = 0u; i < SAMPLES_ASIDE; i++) {
            let near = f32(i) / f32(SAMPLES_ASIDE);
            let far = f32(i + 1u) / f32(SAMPLES_ASIDE);
            let length = reach * (far * far - near * near);
            let middle = 0.5 * reach * (far * far + near * near);
            optical_depth += length * extinction_with(p + middle * direction, vec2f(0.0), blur);
        }
        sum += diffuse_conductance(box.asymmetry, optical_depth);
    }
    return sum / f32(SIDES);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id.xy >= size.xy) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size.xy);
    let step = box.length / f32(size.z);
    let blur = step;
    var total = 0.0;
    for (var z = 0u; z < size.z; z++) {
        total += step * extinction_at(light_box_point(box, vec3f(uv, (f32(z) + 0.5) / f32(size.z))), blur);
    }
    var above = 0.0;
    for (var z = 0u; z < size.z; z++) {
        let p = light_box_point(box, vec3f(uv, (f32(z) + 0.5) / f32(size.z)));
        let half = 0.5 * step * extinction_at(p, blur);
        above += half;
        textureStore(volume, vec3u(id.xy, z), vec4f(above, max(total - above, 0.0), side_conductance(p, blur), 0.0));
        above += half;
    }
}
