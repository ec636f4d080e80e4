// One cloud into the map of the sun's light: its box, seen from the sun, multiplies what is there by what the
// cloud lets through up to each plane. The box's columns lie along the light, so that it is one parallelogram.
// @use light_box sun_map

// A cloud that casts a shadow.
struct Caster {
    // Its box, the corner told from where the map's places are.
    light_box: LightBox,
    // Periods in a row that the box stands for.
    tiles: f32,
    // 1 less the asymmetry of what scatters without the peak.
    turning: f32,
    padding: vec2f,
}

@group(0) @binding(0) var<uniform> map: SunMap;
@group(0) @binding(1) var<uniform> caster: Caster;
@group(0) @binding(2) var volume: texture_3d<f32>;
@group(0) @binding(3) var linear: sampler;

struct Corner {
    @builtin(position) position: vec4f,
    // Place in the box across the light, and the depth at which light enters it, m.
    @location(0) uv: vec2f,
    @location(1) entry: f32,
    @location(2) @interpolate(flat) square: u32,
}

// Four vertices a square. A box that repeats itself does so by instances, in rows of so many, about itself.
@vertex
fn footprint(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    var place = map.place;
    let square = vertex / 4u;
    let whole = select(1.0, caster.light_box.repeat, caster.light_box.repeat > 0.0);
    let uv = 0.5 + whole * (vec2f(f32(vertex & 1u), f32((vertex >> 1u) & 1u)) - 0.5);
    let row = u32(caster.tiles);
    let tile = vec2f(f32(instance % row), f32(instance / row)) - 0.5 * (caster.tiles - 1.0);
    let at = sun_map_coordinate(map, place[square], light_box_point(caster.light_box, vec3f(uv + whole * tile, 0.0)));
    return Corner(vec4f(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0), uv, at.z, square);
}

struct Light {
    @location(0) first: vec4f,
    @location(1) second: vec4f,
    @location(2) third: vec4f,
    @location(3) fourth: vec4f,
}

@fragment
fn light(corner: Corner) -> Light {
    let across = 0.25 * dpdx(corner.uv);
    let aside = 0.25 * dpdy(corner.uv);
    let planes = planes_within(corner.square);
    let thickness = -caster.light_box.along.y * caster.light_box.length;
    var sum = array<f32, PLANES>();
    // A texel may be wider than the voxels of the cloud: light is averaged over four places of it.
    for (var i = 0u; i < 4u; i++) {
        let uv = corner.uv + select(-across, across, (i & 1u) == 1u) + select(-aside, aside, i > 1u);
        for (var plane = planes.x; plane < planes.y; plane++) {
            let w = (plane_at(corner.square, plane) - corner.entry) / thickness;
            let depth = textureSampleLevel(volume, linear, vec3f(uv, w), 0.0).b;
            sum[plane] += 0.25 * sun_map_through(select(0.0, depth, w > 0.0));
        }
    }
    for (var plane = 0u; plane < PLANES; plane++) {
        // Before the cloud all is light; behind it, it is as on the first plane there.
        sum[plane] = select(sum[min(plane, planes.y - 1u)], 1.0, plane < planes.x);
    }
    let depth = textureSampleLevel(volume, linear, vec3f(corner.uv, 1.0), 0.0).b;
    let whole = sun_map_whole(depth, -map.along.y, caster.turning);
    return Light(vec4f(sum[0], sum[1], sum[2], sum[3]), vec4f(sum[4], sum[5], sum[6], sum[7]),
        vec4f(sum[8], sum[9], sum[10], sum[11]), vec4f(sum[12], sum[13], sum[14], whole));
}

const PLANES: u32 = 4u * SUN_MAP_LAYERS - 1u;

// Depth of a plane of a square, m.
fn plane_at(square: u32, plane: u32) -> f32 {
    var planes = map.planes;
    return planes[SUN_MAP_LAYERS * square + plane / 4u][plane % 4u];
}

// The planes that the box reaches and the first one behind it: the first of them, and one beyond the last.
fn planes_within(square: u32) -> vec2u {
    let edges = -vec2f(caster.light_box.edge_u.y, caster.light_box.edge_v.y);
    let low = -caster.light_box.corner.y + min(edges.x, 0.0) + min(edges.y, 0.0);
    let high = -caster.light_box.corner.y + max(edges.x, 0.0) + max(edges.y, 0.0) - caster.light_box.along.y * caster.light_box.length;
    var first = 0u;
    var last = 0u;
    for (var plane = 0u; plane < PLANES; plane++) {
        first += u32(plane_at(square, plane) <= low);
        last += u32(plane_at(square, plane) < high);
    }
    return vec2u(min(first, PLANES - 1u), min(last + 1u, PLANES));
}
