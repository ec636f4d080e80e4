// The medium as a volume that another program made (`lib/volume`): what is in its file and nothing else.
// @use counts density region volume

@group(1) @binding(0) var<uniform> volume_frame: Volume;
@group(1) @binding(1) var<storage, read> bodies: array<Body>;
@group(1) @binding(2) var noise_volume: texture_3d<f32>;
@group(1) @binding(3) var repeat: sampler;
// By level, then by brick, x fastest. No texture: models of light need all that a shader may have.
@group(1) @binding(4) var<storage, read> volume_index: array<u32>;
@group(1) @binding(5) var volume_atlas: texture_3d<f32>;
@group(1) @binding(6) var volume_sampler: sampler;

fn medium_species(body: u32) -> Species {
    return bodies[body].species;
}

// What the index tells of a brick of a level.
fn entry_of(brick: vec3f, level: u32) -> u32 {
    if !volume_holds(volume_frame, level, brick) {
        return VOLUME_EMPTY;
    }
    return volume_index[volume_entry(volume_frame, level, brick)];
}

// Extinction of each field at a point, 1/m, on average over a footprint, m.
fn fields_of(p: vec3f, footprint: f32) -> vec4f {
    let level = volume_level(volume_frame, footprint);
    let place = volume_scale(level) * volume_place(volume_frame, p);
    let brick = floor(place);
    let entry = entry_of(brick, level);
    if entry == VOLUME_EMPTY {
        return vec4f(0.0);
    }
    let coordinate = volume_coordinate(volume_frame, volume_number(entry), place - brick);
    return volume_fields(volume_frame, textureSampleLevel(volume_atlas, volume_sampler, coordinate, 0.0));
}

fn extinction_of(p: vec3f, footprint: f32) -> f32 {
    return dot(fields_of(p, footprint), vec4f(1.0));
}

// Where there are several fields it is one of them by chance, of which the place is: bodies are theirs.
fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    let fields = fields_of(p, max(footprint, blur));
    return volume_matter(volume_frame, dot(fields, vec4f(1.0)), volume_field(fields, volume_chance(p)));
}

// No noise is on top.
fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return volume_matter(volume_frame, extinction_of(p, blur), 0u);
}

// Width of a pixel where the ray at hand was asked last, m.
var<private> volume_blur: f32;

fn medium_on_ray(region: Region, p: vec3f, direction: vec3f, blur: f32) -> Matter {
    count(DENSITY, 1u);
    count(VOLUME_READS, 2u);
    volume_blur = blur;
    return volume_matter(volume_frame, extinction_of(p, blur), 0u);
}

fn medium_begin(region: Region, origin: vec3f, direction: vec3f, bend: f32) {
    volume_blur = 0.0;
}

// Bricks that are looked at in one go, and levels above that of the pixel that are looked at first.
const BRICKS: u32 = 8u;
const FIRST_ABOVE: u32 = 2u;

// What lies ahead of `t` on the ray: empty bricks are clear.
fn medium_ahead(region: Region, origin: vec3f, direction: vec3f, t: f32) -> Stretch {
    let start = volume_place(volume_frame, origin);
    let way = volume_way(volume_frame, direction);
    let span = box_span(vec3f(0.0), vec3f(volume_frame.levels[0].xyz), start, way);
    if t >= span.y || span.x >= span.y {
        return Stretch(1e30, false, 0.0, 0.0, 0u);
    }
    if t < span.x {
        return Stretch(span.x, false, 0.0, 0.0, 0u);
    }
    let level = volume_level(volume_frame, volume_blur);
    let above = min(level + FIRST_ABOVE, volume_frame.count - 1u);
    var here = t;
    var entry = VOLUME_EMPTY;
    for (var i = 0u; i < BRICKS && here < span.y; i++) {
        count(MAP_READS, 1u);
        let place = start + here * way;
        var scale = volume_scale(above);
        var brick = volume_ahead(scale * place, way);
        entry = entry_of(brick, above);
        if entry != VOLUME_EMPTY {
            scale = volume_scale(level);
            brick = volume_ahead(scale * place, way);
            entry = entry_of(brick, level);
        }
        let exit = min(here + volume_exit(scale * place, brick, scale * way), span.y);
        if entry != VOLUME_EMPTY {
            if here > t {
                break;
            }
            return Stretch(exit, true, 0.0, volume_boundary(volume_frame, level, volume_most(volume_frame, entry)), 0u);
        }
        here = exit;
    }
    return Stretch(here, false, 0.0, 0.0, 0u);
}

// Which way the cloud faces at a point: against the slope of the extinction. Unit length at the boundary, and less
// inside.
fn medium_facing(region: Region, p: vec3f) -> vec3f {
    let h = 2.0 * volume_frame.voxel;
    var slope = vec3f(0.0);
    for (var i = 0u; i < 6u; i++) {
        var way = vec3f(0.0);
        way[i % 3u] = select(1.0, -1.0, i >= 3u);
        slope += way * extinction_of(p + h * way, h);
    }
    return volume_facing(volume_frame, slope);
}
