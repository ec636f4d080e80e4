// Sunlight through a cloud, in the cloud's own frame: a volume of optical depth from
// the sun (red; green: the part of it that is other clouds' shadow, none yet; blue: that of the cloud alone), and, for models of
// slabs, a map seen from the sun (depth of the lit surface, of the far one, total optical depth, coverage). One thread marches one
// column along the light, over the ellipsoids at hand. The map is multiplied by coverage, so that plain
// averages of it weight by coverage. A sample asks only the ellipsoids that reach into its brick
// of voxels, however many there are.
// @use column light_box medium

@group(0) @binding(0) var<uniform> box: LightBox;
// Lists of what is in each brick.
@group(0) @binding(1) var<storage, read> lists: array<Region>;
@group(0) @binding(2) var<storage, read> candidates: array<u32>;
@group(0) @binding(3) var volume: texture_storage_3d<rgba16float, write>;
@group(0) @binding(4) var depths: texture_storage_2d<rgba16float, write>;

// Whether the map is wanted.
override MAPPED: bool = true;

// Samples in each voxel of a column.
const SAMPLES: u32 = 4u;

// Extinction without the forward peak at a point of the box, with all its noise.
fn extinction_at(p: vec3f, own: Region, blur: f32) -> f32 {
    let matter = medium_at(own, p, 0.0, blur);
    return transported(medium_species(matter.body)) * matter.extinction;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id.xy >= size.xy) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size.xy);
    let bricks = light_box_bricks(size);
    let tile = id.y / BRICK * bricks.x + id.x / BRICK;
    let step = box.length / f32(size.z * SAMPLES);
    let blur = step;
    var optical_depth = 0.0;
    var front = 0.0;
    var back = 0.0;
    for (var z = 0u; z < size.z; z++) {
        var middle = optical_depth;
        let own = lists[z / BRICK * bricks.x * bricks.y + tile];
        if own.count > 0u {
            for (var i = 0u; i < SAMPLES; i++) {
                let w = (f32(z * SAMPLES + i) + 0.5) / f32(size.z * SAMPLES);
                let thickness = step * extinction_at(light_box_point(box, vec3f(uv, w)), own, blur);
                if MAPPED {
                    front += column_seen(optical_depth, thickness) * w;
                    back = select(back, w, thickness > 0.0);
                }
                optical_depth += thickness;
                middle = select(middle, optical_depth, i == SAMPLES / 2u - 1u);
            }
        }
        let alone = min(middle, LIGHT_BOX_MOST);
        textureStore(volume, vec3u(id.xy, z), vec4f(alone, 0.0, alone, 0.0));
    }
    if MAPPED {
        textureStore(depths, id.xy, column_map(front, back, optical_depth, LIGHT_BOX_MOST));
    }
}
