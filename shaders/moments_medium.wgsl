// What a cell of the field holds: mean extinction, and, as moments, the sun's beam that
// reaches its droplets, from eight samples. One thread a cell.
// @use field harmonics light_box medium

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<uniform> sun: LightBox;
@group(0) @binding(2) var linear: sampler;
@group(0) @binding(3) var sun_volume: texture_3d<f32>;
@group(0) @binding(4) var<storage, read_write> cells: array<f32>;
// Lists of what is in each brick of the sun's volume.
@group(0) @binding(5) var<storage, read> lists: array<Region>;
@group(0) @binding(6) var<storage, read> candidates: array<u32>;
// Moments of what is scattered of the light that is given, by light and cell.
@group(0) @binding(7) var<storage, read_write> given: array<array<vec4f, 4>>;

// Extinction without the forward peak, with all its noise: crests are what light falls on, and smoothed to the width of a
// cell they are gone.
fn extinction_at(p: vec3f, list: Region, blur: f32) -> f32 {
    let matter = medium_at(list, p, 0.0, blur);
    return transported(medium_species(matter.body)) * matter.extinction;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= field_cells(field) {
        return;
    }
    let size = textureDimensions(sun_volume);
    let blur = 0.5 * min(field.cell.x, min(field.cell.y, field.cell.z));
    var sum = 0.0;
    var lit = 0.0;
    var open = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let p = field_sample(field, id.x, i);
        let at = light_box_coordinate(sun, p);
        let extinction = extinction_at(p, lists[light_box_brick(size, at)], blur);
        let depth = textureSampleLevel(sun_volume, linear, at, 0.0).r;
        let through = field_beam(field, depth);
        sum += extinction;
        lit += extinction * through;
        open += through;
    }
    let cell = field_cell(field, sum, lit, open);
    cells[id.x] = cell.extinction;
    if field.beam.w > 0.0 {
        let beam = harmonics_with(array<vec4f, 4>(), cell.beam, field.beam.xyz);
        given[id.x] = harmonics_scattered(beam, field.scattering);
    }
}
