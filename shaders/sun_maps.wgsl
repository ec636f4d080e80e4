// Sunlight through a cloud, in the cloud's own frame: a volume of optical depth from
// the sun (red; green: the part of it that is other clouds' shadow; blue: that of the cloud alone), and, for models of slabs, a map
// seen from the sun (depth of the lit surface, of the far one, total optical depth, coverage). One thread marches one column along the light, over the
// ellipsoids at hand. The map is multiplied by coverage, so that plain
// averages of it weight by coverage. A sample asks only the ellipsoids that reach into its brick
// of voxels, however many there are.
// @use column light_box medium

@group(0) @binding(0) var<uniform> box: LightBox;
// Lists of what is in each brick, then of the ellipsoids of other clouds in each brick, then of those
// that may stand before each tile.
@group(0) @binding(1) var<storage, read> lists: array<Region>;
@group(0) @binding(2) var<storage, read> candidates: array<u32>;
// Ellipsoids of other clouds in this cloud's frame, cloud after cloud, and those clouds' bodies.
@group(0) @binding(3) var<storage, read> others: array<Ellipsoid>;
@group(0) @binding(4) var<storage, read> bodies_of_others: array<Body>;
@group(0) @binding(5) var volume: texture_storage_3d<rgba16float, write>;
@group(0) @binding(6) var depths: texture_storage_2d<rgba16float, write>;

// Whether the map is wanted.
override MAPPED: bool = true;
// Whether other clouds may stand before this one or reach into it.
override SHADED: bool = true;

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

fn collect_hits(top: vec3f, list: Region) {
    hit_count = 0u;
    for (var i = 0u; i < list.count && hit_count < MOST_HITS; i++) {
        let index = candidates[list.first + i];
        let chord = ellipsoid_chord(others[index], top, box.along, 1.0);
        if chord.x < min(chord.y, 0.0) {
            hits[hit_count] = index;
            hit_count += 1u;
        }
    }
}

// What other clouds there are at a point, as their lumps are asked one by one, cloud after cloud.
struct Others {
    matter: Matter,
    // The lump that the point is deepest in, and how deep, m.
    owner: u32,
    deepest: f32,
    // The cloud that is asked, and its lumps so far.
    body: u32,
    lumps: Lumps,
}

const NO_OTHERS: Others = Others(CLEAR, 0u, 0.0, 0u, NO_LUMPS);

fn others_with(before: Others, index: u32, p: vec3f, blur: f32) -> Others {
    var all = before;
    let e = others[index];
    if e.body != all.body {
        all = others_all(all, p, blur);
        all.body = e.body;
    }
    let depth = ellipsoid_depth(e, ellipsoid_unit(e, p, 1.0));
    all.owner = select(all.owner, index, depth > all.deepest);
    all.deepest = max(all.deepest, depth);
    all.lumps = lumps_with(all.lumps, e, depth, bodies_of_others[e.body].power, bodies_of_others[e.body].reach);
    return all;
}

// The cloud that is asked has no more lumps.
fn others_all(before: Others, p: vec3f, blur: f32) -> Others {
    var all = before;
    if all.lumps.weight > 0.0 {
        let body = bodies_of_others[all.body];
        // Noise finer than a texel is left out.
        let noise = noise_at(noise_volume, repeat, body.noise, p, 0.5 * box.texel);
        let edge = lumps_edge(all.lumps, body.power, body.reach);
        all.matter = matter_union(all.matter, matter_below(body, all.body, edge, p.y, noise, blur));
    }
    all.lumps = NO_LUMPS;
    return all;
}

// Their extinction without the peak.
fn transported_others(matter: Matter) -> f32 {
    return transported(bodies_of_others[matter.body].species) * matter.extinction;
}

// Optical depth of other clouds between the sun and the top of a column: each ellipsoid
// is sampled along its own chord, however far away, and counts where it is the deepest.
fn shadow_of_others(top: vec3f) -> f32 {
    var optical_depth = 0.0;
    for (var i = 0u; i < hit_count && optical_depth < DARK; i++) {
        let chord = ellipsoid_chord(others[hits[i]], top, box.along, 1.0);
        let step = chord_step(chord, 0.0, SAMPLES_BEFORE);
        for (var j = 0u; j < SAMPLES_BEFORE; j++) {
            let p = top + chord_middle(chord, step, j) * box.along;
            var there = NO_OTHERS;
            for (var k = 0u; k < hit_count; k++) {
                there = others_with(there, hits[k], p, 0.5 * step);
            }
            there = others_all(there, p, 0.5 * step);
            optical_depth += select(0.0, step * transported_others(there.matter), there.owner == hits[i]);
        }
    }
    return optical_depth;
}

// Extinction without the forward peak at a point of the box: of the cloud itself or of another one that
// is denser there, and of the cloud itself.
fn extinction_at(p: vec3f, own: Region, other: Region, blur: f32) -> vec2f {
    let matter = medium_at(own, p, 0.5 * box.texel, blur);
    let alone = transported(medium_species(matter.body)) * matter.extinction;
    if SHADED {
        var there = NO_OTHERS;
        for (var i = 0u; i < other.count; i++) {
            there = others_with(there, candidates[other.first + i], p, blur);
        }
        there = others_all(there, p, blur);
        if there.matter.extinction > matter.extinction {
            return vec2f(transported_others(there.matter), alone);
        }
    }
    return vec2f(alone);
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
    let all = bricks.x * bricks.y * bricks.z;
    let step = box.length / f32(size.z * SAMPLES);
    let blur = 2.0 * step;
    var shadow = 0.0;
    if SHADED {
        collect_hits(top, lists[2u * all + tile]);
        shadow = shadow_of_others(top);
    }
    var optical_depth = shadow;
    var alone = 0.0;
    var front = 0.0;
    var back = 0.0;
    for (var z = 0u; z < size.z; z++) {
        var middle = vec2f(optical_depth, alone);
        let brick = z / BRICK * bricks.x * bricks.y + tile;
        let own = lists[brick];
        let other = lists[all + brick];
        if own.count + other.count > 0u {
            for (var i = 0u; i < SAMPLES; i++) {
                let w = (f32(z * SAMPLES + i) + 0.5) / f32(size.z * SAMPLES);
                let both = step * extinction_at(light_box_point(box, vec3f(uv, w)), own, other, blur);
                let thickness = both.x;
                if MAPPED {
                    front += column_seen(optical_depth - shadow, thickness) * w;
                    back = select(back, w, thickness > 0.0);
                }
                optical_depth += thickness;
                alone += both.y;
                middle = select(middle, vec2f(optical_depth, alone), i == SAMPLES / 2u - 1u);
            }
        }
        textureStore(volume, vec3u(id.xy, z), vec4f(min(vec3f(middle.x, shadow, middle.y), vec3f(MOST)), 0.0));
    }
    if MAPPED {
        textureStore(depths, id.xy, column_map(front, back, optical_depth - shadow, MOST));
    }
}
