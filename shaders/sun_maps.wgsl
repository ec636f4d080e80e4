// Sunlight through a cloud, in the cloud's own frame: a volume of optical depth from
// the sun, and a map seen from the sun (depth of the lit surface, of the far one, total
// optical depth, coverage). One thread marches one column along the light. The map is
// multiplied by coverage, so that plain averages of it weight by coverage.
// @use density noise light_box

@group(0) @binding(0) var<uniform> box: LightBox;
@group(0) @binding(1) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(2) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(3) var noise_volume: texture_3d<f32>;
@group(0) @binding(4) var repeat: sampler;
@group(0) @binding(5) var volume: texture_storage_3d<rgba16float, write>;
@group(0) @binding(6) var depths: texture_storage_2d<rgba16float, write>;

// Samples in each voxel of a column, and before the box where others cast shadows.
const SAMPLES: u32 = 4u;
const SAMPLES_BEFORE: u32 = 48u;

// Extinction at a point of the ellipsoids from `first` to `last`, without the forward
// peak. Noise finer than a texel is left out; edges are no sharper than `blur`.
fn extinction_at(p: vec3f, first: u32, last: u32, blur: f32) -> f32 {
    let noise = noise_at(noise_volume, repeat, noise_frame, p, 0.5 * box.texel);
    var matter = CLEAR;
    for (var i = first; i < last; i++) {
        matter = matter_with(matter, ellipsoids[i], ellipsoid_unit(ellipsoids[i], p, 1.0), noise, blur);
    }
    return (1.0 - box.chop) * matter.extinction;
}

// Optical depth of other clouds between the sun and the top of a column.
fn shadow_of_others(top: vec3f) -> f32 {
    if box.before <= 0.0 || box.all == box.own {
        return 0.0;
    }
    let step = box.before / f32(SAMPLES_BEFORE);
    var optical_depth = 0.0;
    for (var i = 0u; i < SAMPLES_BEFORE; i++) {
        let p = top - (f32(i) + 0.5) * step * box.along;
        optical_depth += step * extinction_at(p, box.own, box.all, 0.5 * step);
    }
    return optical_depth;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id.xy >= size.xy) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size.xy);
    let step = box.length / f32(size.z * SAMPLES);
    let blur = 2.0 * step;
    let shadow = shadow_of_others(light_box_point(box, vec3f(uv, 0.0)));
    var optical_depth = shadow;
    var front = 0.0;
    var back = 0.0;
    for (var z = 0u; z < size.z; z++) {
        var middle = optical_depth;
        for (var i = 0u; i < SAMPLES; i++) {
            let w = (f32(z * SAMPLES + i) + 0.5) / f32(size.z * SAMPLES);
            let p = light_box_point(box, vec3f(uv, w));
            let thickness = step * extinction_at(p, 0u, box.all, blur);
            if thickness > 0.0 {
                front += exp(shadow - optical_depth) * (1.0 - exp(-thickness)) * w;
                back = w;
            }
            optical_depth += thickness;
            if i == SAMPLES / 2u - 1u {
                middle = optical_depth;
            }
        }
        textureStore(volume, vec3u(id.xy, z), vec4f(middle, 0.0, 0.0, 0.0));
    }
    let coverage = 1.0 - exp(shadow - optical_depth);
    let total = coverage * (optical_depth - shadow);
    textureStore(depths, id.xy, vec4f(front, coverage * back, total, coverage));
}
