// What a cell of the field holds: mean extinction, and the share of the sun's beam that
// reaches its droplets, from eight samples. One thread a cell.
// @use attenuation density noise light_box field

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<uniform> sun: LightBox;
@group(0) @binding(2) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(0) @binding(3) var<uniform> noise_frame: NoiseFrame;
@group(0) @binding(4) var noise_volume: texture_3d<f32>;
@group(0) @binding(5) var repeat: sampler;
@group(0) @binding(6) var clamped: sampler;
@group(0) @binding(7) var sun_volume: texture_3d<f32>;
@group(0) @binding(8) var<storage, read_write> cells: array<FieldCell>;
// Lists of the ellipsoids in each brick of the sun's volume.
@group(0) @binding(9) var<storage, read> lists: array<vec2u>;
@group(0) @binding(10) var<storage, read> candidates: array<u32>;

fn extinction_at(p: vec3f, list: vec2u, blur: f32) -> f32 {
    let noise = noise_at(noise_volume, repeat, noise_frame, p, blur);
    var matter = CLEAR;
    for (var i = 0u; i < list.y; i++) {
        let e = ellipsoids[candidates[list.x + i]];
        matter = matter_with(matter, e, ellipsoid_unit(e, p, 1.0), noise, blur);
    }
    return (1.0 - sun.chop) * matter.extinction;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= field_cells(field) {
        return;
    }
    let corner = field.low + vec3f(field_place(field, id.x)) * field.cell;
    let size = textureDimensions(sun_volume);
    let blur = 0.5 * min(field.cell.x, min(field.cell.y, field.cell.z));
    let kept = 1.0 - field.ahead;
    var sum = 0.0;
    var lit = 0.0;
    var open = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let p = corner + (0.25 + 0.5 * vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u))) * field.cell;
        let at = light_box_coordinate(sun, p);
        let extinction = extinction_at(p, lists[light_box_brick(size, at)], blur);
        let depth = textureSampleLevel(sun_volume, clamped, at, 0.0).r;
        let through = exp(-kept * depth);
        sum += extinction;
        lit += extinction * through;
        open += through;
    }
    // No more light is scattered in a cell than comes in by its face: that face, across the light, is
    // its volume over `length`. Eight points of a thick cell may see too much of it.
    let d = abs(field.beam.xyz);
    let length = 1.0 / max(d.x / field.cell.x + d.y / field.cell.y + d.z / field.cell.z, 1e-12);
    let extinction = 0.125 * kept * sum;
    let beam = select(0.125 * open, min(lit / sum, mean_through(length * extinction)), sum > 0.0);
    cells[id.x] = FieldCell(extinction, beam);
}
