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

// Whether there are several grids.
override MANY_GRIDS: bool = false;

// Where a grid that repeats itself ends all the same, m.
const FARTHEST: f32 = 5e5;

// What a grid has at a point, and how far along a direction that is so, m; nothing of it lies ahead where that is NEVER.
struct Crossing {
    cell: Cell,
    exit: f32,
}

const NEVER: f32 = 1e30;

fn crossing(grid: Grid, p: vec3f, direction: vec3f) -> Crossing {
    let place = (p - grid.low) / grid.cell;
    let size = vec3i(grid.size);
    var index = vec3i(floor(place));
    if grid.repeats == 1u {
        let like = ((index % size) + size) % size;
        index = select(vec3i(like.x, index.y, like.z), vec3i(-1), max(abs(p.x), abs(p.z)) > FARTHEST);
    }
    if any(index < vec3i(0)) || any(index >= size) {
        return Crossing(Cell(0u, 0u, 0.0, 0u), entry_ahead(grid, p, direction));
    }
    let cell = cells[grid.first + u32((index.z * size.y + index.y) * size.x + index.x)];
    return Crossing(cell, cell_exit(place, grid.cell, f32(cell.clear), direction));
}

// Distance along a ray to a grid that it is not in, and a little beyond, m. Where there is but one, rays begin in it.
fn entry_ahead(grid: Grid, p: vec3f, direction: vec3f) -> f32 {
    if !MANY_GRIDS {
        return NEVER;
    }
    var low = grid.low;
    var high = grid.low + grid.cell * vec3f(grid.size);
    if grid.repeats == 1u {
        low = vec3f(-FARTHEST, low.y, -FARTHEST);
        high = vec3f(FARTHEST, high.y, FARTHEST);
    }
    let span = box_span(low, high, p, direction);
    return select(NEVER, span.x + 1e-4 * grid.cell, span.x < span.y);
}

// What all grids have at a point: as far as the nearest wall.
fn crossing_of_all(p: vec3f, direction: vec3f) -> Crossing {
    var all = crossing(scene.grids[0], p, direction);
    if !MANY_GRIDS {
        return all;
    }
    // A number that compilers don't know: they would write the loop out, which takes them minutes.
    for (var i = 1u; i <= scene.grids[0].more; i++) {
        let other = crossing(scene.grids[i], p, direction);
        all.exit = min(all.exit, other.exit);
        all.cell.majorant = max(all.cell.majorant, other.cell.majorant);
    }
    return all;
}

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
        let here = crossing_of_all(p, direction);
        outside = here.exit >= NEVER;
        if outside {
            break;
        }
        cell = here.cell;
        let exit = here.exit;
        tentative = cell.majorant * exit > left;
        if tentative {
            p += left / cell.majorant * direction;
            break;
        }
        p += exit * direction;
        if MANY_GRIDS {
            // Far from the origin what a flat ray rises by in a hair's breadth is rounded away: it must get through the wall.
            p += 2e-7 * abs(p) * sign(direction);
        }
        left -= cell.majorant * exit;
    }
    if !tentative {
        return Step(p, outside, false, CLEAR, 0.0);
    }
    return Step(p, false, true, medium_at(Region(cell.first, cell.count), p, 0.0, 0.0), cell.majorant);
}
