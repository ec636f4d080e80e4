// Sunlight through a cloud, in the cloud's own frame: a volume of optical depth from
// the sun (red; green: the part of it that is other clouds' shadow), and a map seen from the sun (depth of the lit surface, of the far one, total
// optical depth, coverage). One thread marches one column along the light, over the
// ellipsoids that the column meets. The map is multiplied by coverage, so that plain
// averages of it weight by coverage.
// @use density noise light_box

@group(0) @binding(0) var<uniform> box: LightBox;
@group(0) @binding(1) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(2) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(3) var noise_volume: texture_3d<f32>;
@group(0) @binding(4) var repeat: sampler;
@group(0) @binding(5) var volume: texture_storage_3d<rgba16float, write>;
@group(0) @binding(6) var depths: texture_storage_2d<rgba16float, write>;

// Largest optical depth worth telling: half floats hold it, no light survives it.
const MOST: f32 = 30000.0;

// Samples in each voxel of a column, and through each ellipsoid of another cloud that
// casts its shadow on it.
const SAMPLES: u32 = 4u;
const SAMPLES_BEFORE: u32 = 12u;

// The ellipsoids that this column meets. Where they are more than the list holds, it is
// of no use and all ellipsoids are asked: slower, and right, but that shadows of others
// come from the list alone. (Mesa's software Vulkan ends a shader's loops after 65535
// rounds in all; the list keeps columns of some sixty ellipsoids below that.)
const MOST_HITS: u32 = 64u;
var<private> hits: array<u32, 64>;
var<private> hit_count: u32;

fn collect_hits(origin: vec3f) {
    hit_count = 0u;
    for (var i = 0u; i < box.all; i++) {
        let chord = ellipsoid_chord(ellipsoids[i], origin, box.along, 1.0);
        if chord.x < chord.y {
            if hit_count < MOST_HITS {
                hits[hit_count] = i;
            }
            hit_count += 1u;
        }
    }
}

// Extinction without the forward peak at a point of the column, and which ellipsoid it is
// of. Noise finer than a texel is left out; edges are no sharper than `blur`.
struct Point {
    extinction: f32,
    ellipsoid: u32,
}

fn point_at(p: vec3f, blur: f32) -> Point {
    let noise = noise_at(noise_volume, repeat, noise_frame, p, 0.5 * box.texel);
    let listed = hit_count <= MOST_HITS;
    let asked = select(box.all, hit_count, listed);
    var point = Point(0.0, 0u);
    for (var i = 0u; i < asked; i++) {
        let index = select(i, hits[min(i, MOST_HITS - 1u)], listed);
        let e = ellipsoids[index];
        let here = matter_with(CLEAR, e, ellipsoid_unit(e, p, 1.0), noise, blur).extinction;
        if here > point.extinction {
            point = Point(here, index);
        }
    }
    return Point((1.0 - box.chop) * point.extinction, point.ellipsoid);
}

// Optical depth of other clouds between the sun and the top of a column: each ellipsoid
// is sampled along its own chord, however far away, and counts where it is the densest.
fn shadow_of_others(top: vec3f) -> f32 {
    if box.before <= 0.0 {
        return 0.0;
    }
    var optical_depth = 0.0;
    for (var i = 0u; i < min(hit_count, MOST_HITS); i++) {
        let chord = ellipsoid_chord(ellipsoids[hits[i]], top, box.along, 1.0);
        let step = (min(chord.y, 0.0) - chord.x) / f32(SAMPLES_BEFORE);
        if hits[i] >= box.own && step > 0.0 {
            for (var j = 0u; j < SAMPLES_BEFORE; j++) {
                let point = point_at(top + (chord.x + (f32(j) + 0.5) * step) * box.along, 0.5 * step);
                optical_depth += select(0.0, step * point.extinction, point.ellipsoid == hits[i]);
            }
        }
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
    let top = light_box_point(box, vec3f(uv, 0.0));
    collect_hits(top);
    let step = box.length / f32(size.z * SAMPLES);
    let blur = 2.0 * step;
    let shadow = shadow_of_others(top);
    var optical_depth = shadow;
    var front = 0.0;
    var back = 0.0;
    for (var z = 0u; z < size.z; z++) {
        var middle = optical_depth;
        if hit_count > 0u {
            for (var i = 0u; i < SAMPLES; i++) {
                let w = (f32(z * SAMPLES + i) + 0.5) / f32(size.z * SAMPLES);
                let thickness = step * point_at(light_box_point(box, vec3f(uv, w)), blur).extinction;
                front += exp(shadow - optical_depth) * (1.0 - exp(-thickness)) * w;
                back = select(back, w, thickness > 0.0);
                optical_depth += thickness;
                middle = select(middle, optical_depth, i == SAMPLES / 2u - 1u);
            }
        }
        textureStore(volume, vec3u(id.xy, z), vec4f(min(vec2f(middle, shadow), vec2f(MOST)), 0.0, 0.0));
    }
    let coverage = 1.0 - exp(shadow - optical_depth);
    let total = coverage * min(optical_depth - shadow, MOST);
    textureStore(depths, id.xy, vec4f(front, coverage * back, total, coverage));
}
