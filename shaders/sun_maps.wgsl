// Sunlight through a cloud, in the cloud's own frame: a volume of optical depth from
// the sun (red; green: the part of it that is other clouds' shadow), and, for models of slabs, a map
// seen from the sun (depth of the lit surface, of the far one, total optical depth, coverage). One thread marches one column along the light, over the
// ellipsoids at hand. The map is multiplied by coverage, so that plain
// averages of it weight by coverage. A sample asks only the ellipsoids that reach into its brick
// of voxels, however many there are.
// @use density noise light_box

@group(0) @binding(0) var<uniform> box: LightBox;
@group(0) @binding(1) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(2) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(3) var noise_volume: texture_3d<f32>;
@group(0) @binding(4) var repeat: sampler;
// Lists of the ellipsoids in each brick, then of those of other clouds that may stand before each
// tile: where they begin in `candidates`, and their length.
@group(0) @binding(5) var<storage, read> lists: array<vec2u>;
@group(0) @binding(6) var<storage, read> candidates: array<u32>;
@group(0) @binding(7) var volume: texture_storage_3d<rgba16float, write>;
@group(0) @binding(8) var depths: texture_storage_2d<rgba16float, write>;

// Whether the map is wanted.
override MAPPED: bool = true;

// Largest optical depth worth telling: half floats hold it, no light survives it.
const MOST: f32 = 30000.0;

// Samples in each voxel of a column, and through each ellipsoid of another cloud that
// casts its shadow on it.
const SAMPLES: u32 = 4u;
const SAMPLES_BEFORE: u32 = 12u;

// Ellipsoids of other clouds that stand before this column. More than these few cast no more
// shadow: together they are opaque, or as good as clear.
const MOST_HITS: u32 = 64u;
var<private> hits: array<u32, MOST_HITS>;
var<private> hit_count: u32;
// An optical depth that no light survives.
const DARK: f32 = 64.0;

fn collect_hits(top: vec3f, list: vec2u) {
    hit_count = 0u;
    for (var i = 0u; i < list.y && hit_count < MOST_HITS; i++) {
        let index = candidates[list.x + i];
        let chord = ellipsoid_chord(ellipsoids[index], top, box.along, 1.0);
        if chord.x < min(chord.y, 0.0) {
            hits[hit_count] = index;
            hit_count += 1u;
        }
    }
}

// Extinction without the forward peak at a point, and which ellipsoid it is of. Edges are no
// sharper than `blur`.
struct Point {
    extinction: f32,
    ellipsoid: u32,
}

fn denser(point: Point, index: u32, p: vec3f, noise: vec2f, blur: f32) -> Point {
    let e = ellipsoids[index];
    let here = matter_with(CLEAR, e, ellipsoid_unit(e, p, 1.0), noise, blur).extinction;
    if here > point.extinction {
        return Point(here, index);
    }
    return point;
}

// Noise finer than a texel is left out.
fn noise_here(p: vec3f) -> vec2f {
    return noise_at(noise_volume, repeat, noise_frame, p, 0.5 * box.texel);
}

// Optical depth of other clouds between the sun and the top of a column: each ellipsoid
// is sampled along its own chord, however far away, and counts where it is the densest.
fn shadow_of_others(top: vec3f) -> f32 {
    var optical_depth = 0.0;
    for (var i = 0u; i < hit_count && optical_depth < DARK; i++) {
        let chord = ellipsoid_chord(ellipsoids[hits[i]], top, box.along, 1.0);
        let step = (min(chord.y, 0.0) - chord.x) / f32(SAMPLES_BEFORE);
        for (var j = 0u; j < SAMPLES_BEFORE; j++) {
            let p = top + (chord.x + (f32(j) + 0.5) * step) * box.along;
            let noise = noise_here(p);
            var point = Point(0.0, 0u);
            for (var k = 0u; k < hit_count; k++) {
                point = denser(point, hits[k], p, noise, 0.5 * step);
            }
            let own = (1.0 - box.chop) * point.extinction;
            optical_depth += select(0.0, step * own, point.ellipsoid == hits[i]);
        }
    }
    return optical_depth;
}

// Extinction without the forward peak at a point of the box, from the list of its brick.
fn extinction_at(p: vec3f, list: vec2u, blur: f32) -> f32 {
    let noise = noise_here(p);
    var point = Point(0.0, 0u);
    for (var i = 0u; i < list.y; i++) {
        point = denser(point, candidates[list.x + i], p, noise, blur);
    }
    return (1.0 - box.chop) * point.extinction;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id.xy >= size.xy) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size.xy);
    let top = light_box_point(box, vec3f(uv, 0.0));
    let bricks = light_box_bricks(size);
    let tile = id.y / BRICK * bricks.x + id.x / BRICK;
    collect_hits(top, lists[bricks.x * bricks.y * bricks.z + tile]);
    let step = box.length / f32(size.z * SAMPLES);
    let blur = 2.0 * step;
    let shadow = shadow_of_others(top);
    var optical_depth = shadow;
    var front = 0.0;
    var back = 0.0;
    for (var z = 0u; z < size.z; z++) {
        var middle = optical_depth;
        let list = lists[z / BRICK * bricks.x * bricks.y + tile];
        if list.y > 0u {
            for (var i = 0u; i < SAMPLES; i++) {
                let w = (f32(z * SAMPLES + i) + 0.5) / f32(size.z * SAMPLES);
                let thickness = step * extinction_at(light_box_point(box, vec3f(uv, w)), list, blur);
                if MAPPED {
                    front += exp(shadow - optical_depth) * (1.0 - exp(-thickness)) * w;
                    back = select(back, w, thickness > 0.0);
                }
                optical_depth += thickness;
                middle = select(middle, optical_depth, i == SAMPLES / 2u - 1u);
            }
        }
        textureStore(volume, vec3u(id.xy, z), vec4f(min(vec2f(middle, shadow), vec2f(MOST)), 0.0, 0.0));
    }
    if MAPPED {
        let coverage = 1.0 - exp(shadow - optical_depth);
        let total = coverage * min(optical_depth - shadow, MOST);
        textureStore(depths, id.xy, vec4f(front, coverage * back, total, coverage));
    }
}
