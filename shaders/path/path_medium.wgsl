// Where a path or a walk collides, and what it scatters there.
// @use medium path_choice path_state phase ray_box

// A species in `phase_tables`: its albedo and the share of the peak; then for both parts of the phase
// function, the wide one first, and each channel their values over the coordinate of the angle, each part
// normalised; then likewise the angle below which a share of light is scattered, over the coordinate of
// that share.
const ANGLES: u32 = 4096u;
const TABLE: u32 = 2u + 12u * ANGLES;

fn table_at(base: u32, x: f32) -> f32 {
    let place = clamp(x, 0.0, 1.0) * f32(ANGLES - 1u);
    let i = min(u32(place), ANGLES - 2u);
    return mix(phase_tables[base + i], phase_tables[base + i + 1u], place - f32(i));
}

fn albedo(species: u32) -> f32 {
    return phase_tables[TABLE * species];
}

// Share of the scattered light in the peak.
fn peak_share(species: u32) -> f32 {
    return phase_tables[TABLE * species + 1u];
}

// A part of the phase function between two directions of propagation, three channels, 1/sr.
fn phase(species: u32, part: u32, before: vec3f, after: vec3f) -> vec3f {
    let x = phase_coordinate(before, after);
    let base = TABLE * species + 2u + 3u * part * ANGLES;
    return vec3f(table_at(base, x), table_at(base + ANGLES, x), table_at(base + 2u * ANGLES, x));
}

// The same of green.
fn phase_green(species: u32, part: u32, before: vec3f, after: vec3f) -> f32 {
    return table_at(TABLE * species + 2u + (3u * part + 1u) * ANGLES, phase_coordinate(before, after));
}

// A direction after scattering by a part of the phase function, chosen by one channel.
fn scattered(species: u32, part: u32, channel: u32, before: vec3f) -> vec3f {
    let x = share_coordinate(draw());
    let angle = table_at(TABLE * species + 2u + (6u + 3u * part + channel) * ANGLES, x);
    return turned(before, angle, 6.2831853 * draw());
}

// Tracking as far as the next tentative collision.
struct Step {
    position: vec3f,
    // Whether the grid was left.
    outside: bool,
    // Whether this is a tentative collision, and what is there.
    tentative: bool,
    matter: Matter,
    majorant: f32,
}

// Where a grid that repeats itself ends all the same, m.
const FARTHEST: f32 = 5e5;

// Cells that one step crosses at the most; the next one goes on from there.
const CELLS: u32 = 8u;

// Crosses cells until an optical depth of the majorant, drawn once, is used up; only there
// the density is asked. (Stopping between cells and drawing anew changes nothing: what is
// left of an exponential is distributed like a fresh one.)
fn track(position: vec3f, direction: vec3f) -> Step {
    var p = position;
    var left = free_flight(draw());
    var outside = false;
    var tentative = false;
    var cell = Cell(0u, 0u, 0.0, 0u);
    for (var i = 0u; i < CELLS; i++) {
        let place = (p - scene.low) / scene.cell;
        var index = vec3i(floor(place));
        if scene.repeats == 1u {
            let size = vec3i(scene.size);
            let like = ((index % size) + size) % size;
            index = select(vec3i(like.x, index.y, like.z), vec3i(-1), max(abs(p.x), abs(p.z)) > FARTHEST);
        }
        outside = any(index < vec3i(0)) || any(index >= vec3i(scene.size));
        if outside {
            break;
        }
        let c = vec3u(index);
        cell = cells[(c.z * scene.size.y + c.y) * scene.size.x + c.x];
        let exit = cell_exit(place, scene.cell, f32(cell.clear), direction);
        tentative = cell.majorant * exit > left;
        if tentative {
            p += left / cell.majorant * direction;
            break;
        }
        p += exit * direction;
        left -= cell.majorant * exit;
    }
    if !tentative {
        return Step(p, outside, false, CLEAR, 0.0);
    }
    return Step(p, false, true, medium_at(Region(cell.first, cell.count), p, 0.0, 0.0), cell.majorant);
}
