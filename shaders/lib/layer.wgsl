// A layer as a height field n(x, z) that repeats. Where F = (n - begin) / rise is above 0, there is cloud from
// bottom(F) below the level of its rims to top(F) above it, both of which meet that level upright. Heights in m.
// @use density

struct Layer {
    // Height in the frame of the level of the rims, and the most above and below it.
    rim: f32,
    top: f32,
    bottom: f32,
    // Height of the ground in the frame.
    ground: f32,
    // 1 over the length after which the field repeats itself, 1/m.
    frequency: f32,
    // Edge of a texel of the field, m.
    texel: f32,
    // Value of the field where the cover begins, and how much more it has where the layer is thickest.
    begin: f32,
    rise: f32,
    // No value changes faster than this with place and height, 1/m.
    steepest: f32,
    // Extinction coefficient behind the boundary, 1/m.
    extinction: f32,
    // Thickness of the boundary that noise shapes, m, and 0 where that is all billows, 1 where it is all wisps.
    boundary: f32,
    wispiness: f32,
}

// Roundness c of heaps: 0 are cones, a great one are bowls [Max].
const ROUND: f32 = 1.0;
// The lower side's height over the upper side's where F = 1, were both of one size.
const LOWER: f32 = 0.77459667;

// Heights of top and bottom over their most where F is `fill`: sqrt(F^2 + 2 c F) / sqrt(1 + 2 c) = g above, and
// likewise g / sqrt(g^2 + 2 c^2) below.
fn layer_heights(fill: f32) -> vec2f {
    let f = saturate(fill);
    let g = sqrt(f * (f + 2.0 * ROUND));
    return vec2f(g / sqrt(1.0 + 2.0 * ROUND), g / sqrt(g * g + 2.0 * ROUND * ROUND) / LOWER);
}

// What F must be for cloud at a height above the rims, and how that changes with height, 1/m.
fn layer_fill(layer: Layer, height: f32) -> vec2f {
    let above = height > 0.0;
    let most = max(select(layer.bottom, layer.top, above), 1e-3);
    let share = min(abs(height) / most, 1.0);
    let reach = sqrt(1.0 + 2.0 * ROUND);
    // The same g from the upper side's height or the lower one's.
    let r = LOWER * share;
    let left = 1.0 - r * r;
    let g = select(sqrt(2.0) * ROUND * r / sqrt(left), reach * share, above);
    let g_slope = select(-sqrt(2.0) * ROUND * LOWER / (left * sqrt(left)), reach, above) / most;
    let root = sqrt(ROUND * ROUND + g * g);
    return vec2f(root - ROUND, g_slope * g / root);
}

// The field at a place: mean value over a pixel, slopes, 1/m, and half the range of values in the pixel, which
// are taken as spread evenly.
struct LayerField {
    value: f32,
    slope: vec2f,
    range: f32,
}

// From a texel, in which slopes are by tile and the last is the deviation.
fn layer_field(layer: Layer, texel: vec4f) -> LayerField {
    return LayerField(texel.x, layer.frequency * texel.yz, 1.7320508 * texel.w);
}

// The hull of the layer at a height above its rims, and the share of the pixel that is in it as its
// extinction. Noise moves no boundary farther than there is cloud in the column, so that what is covered stays so.
fn layer_edge(layer: Layer, field: LayerField, height: f32) -> Edge {
    let fill = layer_fill(layer, height);
    let need = layer.begin + layer.rise * fill.x;
    let excess = field.value + field.range - need;
    let local = length(vec3f(field.slope, layer.rise * fill.y));
    let slope = select(max(local, 1e-9), layer.steepest, excess < 0.0);
    let depth = min(excess / slope, layer.top - height);
    let share = saturate(excess / max(2.0 * field.range, 1e-6));
    let column = field.value + field.range - layer.begin;
    let heights = layer_heights(column / layer.rise);
    let thickness = heights.x * layer.top + heights.y * layer.bottom;
    let aside = max(column, 0.0) / max(length(field.slope), 1e-9);
    let boundary = min(layer.boundary, min(0.5 * thickness, aside));
    return Edge(depth, share * layer.extinction, boundary, layer.wispiness);
}

// Distances along a ray between which it is below a height: o + d t + b t^2 < 0, where o is the start's height above
// that, d its slope and b > 0 half the curvature of the earth along it. The first is beyond the second where
// it never is.
fn layer_below(o: f32, d: f32, b: f32) -> vec2f {
    let square = d * d - 4.0 * b * o;
    if square <= 0.0 {
        return vec2f(1e30, -1e30);
    }
    // No difference of numbers that are nearly the same.
    let q = -0.5 * (d + select(-1.0, 1.0, d >= 0.0) * sqrt(square));
    let roots = vec2f(q / b, o / select(q, 1e-30, q == 0.0));
    return vec2f(min(roots.x, roots.y), max(roots.x, roots.y));
}

// A ray goes on for no more than this, m.
const LAYER_FARTHEST: f32 = 5e5;
const LAYER_LEAST_BEND: f32 = 1e-13;

// The next piece of a ray, from `t` on, between the lowest and the highest height of the layer, and before the
// ground: where it begins and where it ends, which is no later where there is none.
fn layer_span(layer: Layer, height: f32, slope: f32, bend: f32, t: f32) -> vec2f {
    let b = max(bend, LAYER_LEAST_BEND);
    let below_top = layer_below(height - layer.rim - layer.top, slope, b);
    let below_base = layer_below(height - layer.rim + layer.bottom, slope, b);
    let in_ground = layer_below(height - layer.ground, slope, b);
    let ground = select(LAYER_FARTHEST, in_ground.x, in_ground.x < in_ground.y && in_ground.x > 0.0);
    let end = min(below_top.y, min(ground, LAYER_FARTHEST));
    var begin = max(below_top.x, t);
    let under = below_base.x < below_base.y;
    begin = select(begin, max(begin, below_base.y), under && begin >= below_base.x);
    return vec2f(begin, select(end, min(end, below_base.x), under && begin < below_base.x));
}
