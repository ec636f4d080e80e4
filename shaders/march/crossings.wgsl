// Clouds that pass through one another: how much of each gets past the others. Where their parts of the picture meet,
// each is marched for its visibility first, which is kept in blocks, one a cell of the picture and a cloud.
// @use camera ray_seen visibility

// Whether others stand among what is seen.
override CROSSES: bool = false;

// Pixels along the edge of a cell of the picture.
const CROSSING_CELL: u32 = 16u;

// Three for each pixel of a block, row by row: twelve half floats.
@group(0) @binding(12) var<storage, read_write> visibilities: array<vec2u>;

// Where the list of a tile's crossing is in `candidates`: how many others there are, twice, and 1 more for the cloud that
// puts the opacity of all over what is behind them; then the others' blocks.
var<private> crossing: u32 = 0u;
var<private> crossing_pixel: vec2u;

// Where a pixel of the picture has its numbers in a block.
fn crossing_place(block: u32, pixel: vec2u) -> u32 {
    let within = pixel % CROSSING_CELL;
    return 3u * ((block * CROSSING_CELL + within.y) * CROSSING_CELL + within.x);
}

// Begins a pixel of a tile whose list is here.
fn crossing_begins(list: u32, pixel: vec2f) {
    crossing = list;
    crossing_pixel = vec2u(pixel);
}

fn crossing_others() -> u32 {
    return candidates[crossing] >> 1u;
}

fn crossing_leads() -> bool {
    return (candidates[crossing] & 1u) != 0u;
}

fn crossing_of(other: u32) -> Visibility {
    let place = crossing_place(candidates[crossing + 1u + other], crossing_pixel);
    return Visibility(crossing_numbers(visibilities[place]), crossing_numbers(visibilities[place + 1u]),
        crossing_numbers(visibilities[place + 2u]));
}

fn crossing_numbers(packed: vec2u) -> vec4f {
    return vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
}

fn crossing_packed(numbers: vec4f) -> vec2u {
    return vec2u(pack2x16float(numbers.xy), pack2x16float(numbers.zw));
}

fn keep_visibility(block: u32, pixel: vec2u, v: Visibility) {
    let place = crossing_place(block, pixel);
    visibilities[place] = crossing_packed(v.begin);
    visibilities[place + 1u] = crossing_packed(v.middle);
    visibilities[place + 2u] = crossing_packed(v.end);
}

// What all others let through of what is seen of a piece.
fn crossing_share(piece: Piece) -> f32 {
    if !CROSSES {
        return 1.0;
    }
    return visibility_share(crossing_through(piece.begin), crossing_through(piece.end), piece.optical_depth);
}

// What all others let through of what is at a distance, m.
fn crossing_through(t: f32) -> f32 {
    var through = 1.0;
    for (var i = 0u; i < crossing_others(); i++) {
        through *= visibility_at(crossing_of(i), 1e-3 * t);
    }
    return through;
}

// What is put over what is behind, of a cloud of opacity `alpha`: in a crossing one cloud does so for all, and the others add
// their light to it.
fn crossing_alpha(alpha: f32) -> f32 {
    if !CROSSES {
        return alpha;
    }
    return select(0.0, 1.0 - crossing_clear(1.0 - alpha, 1.0).x, crossing_leads());
}

// What all of them let through of what is behind and of gathered light, of which one lets these pass.
fn crossing_clear(behind: f32, gathered: f32) -> vec2f {
    var clear = vec2f(behind, gathered);
    for (var i = 0u; i < crossing_others(); i++) {
        let opaque = crossing_of(i).end;
        clear *= 1.0 - opaque.wz;
    }
    return clear;
}

// The opacity ratio of all of them, of which one has these opacities: what each gathers adds up by one ratio alone.
fn crossing_ratio(alpha: f32, opacity: f32) -> f32 {
    let clear = crossing_clear(1.0 - alpha, 1.0 - opacity);
    return (1.0 - clear.x) / max(1.0 - clear.y, 1e-6);
}

// Distances kept on the way.
var<private> marks: array<f32, 10>;
var<private> next_mark: u32 = 0u;

// Keeps what a step from `t` on hides.
fn mark(t: f32, length: f32, before: f32, after: f32) {
    if next_mark == 0u {
        marks[0] = t;
        next_mark = 1u;
    }
    while next_mark < VISIBILITY_LEVELS && after <= visibility_level(next_mark) {
        marks[next_mark] = visibility_reached(t, length, before, after, visibility_level(next_mark));
        next_mark += 1u;
    }
    marks[VISIBILITY_LEVELS] = t + length;
}

// What was kept of a ray of this opacity, to gathered light and to what is behind.
fn visibility_marked(opacity: f32, alpha: f32) -> Visibility {
    for (var i = next_mark; i < VISIBILITY_LEVELS; i++) {
        marks[i] = marks[VISIBILITY_LEVELS];
    }
    return Visibility(1e-3 * vec4f(marks[0], marks[1], marks[2], marks[3]),
        1e-3 * vec4f(marks[4], marks[5], marks[6], marks[7]),
        vec4f(1e-3 * marks[8], 1e-3 * marks[9], opacity, alpha));
}
