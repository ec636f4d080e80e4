// A layer as a height field n(x, z) that repeats: a sheet, and heaps that stand out of it on both sides. Where
// n > begin, there is cloud from the lower side below the level of its rims to the upper side above it; heights are those
// of F = (n - begin) / rise for heaps, and the `flat` share of those of F = (n - begin) / sheet for the sheet.
// Heights in m.
// @use density ray_box

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
    // Value of the field where the cover begins, and how much more it has where heaps and where the sheet are thickest.
    begin: f32,
    rise: f32,
    sheet: f32,
    // Height of the sheet over that of heaps.
    flat: f32,
    // Roundness c of heaps: small ones rise like cones, great ones like bowls [Max].
    round: f32,
    // No value changes faster than this with place and height, 1/m.
    steepest: f32,
    // Extinction coefficient behind the boundary, 1/m.
    extinction: f32,
    // Thickness of the boundary that noise shapes, m, and 0 where that is all billows, 1 where it is all wisps.
    boundary: f32,
    wispiness: f32,
    padding: f32,
}

// The value of the lower side's formula where F = 1.
fn layer_lower(round: f32) -> f32 {
    return sqrt((1.0 + 2.0 * round) / (3.0 + 2.0 * round));
}

// Heights of the upper and the lower side over their most where F is `fill`: with g^2 = F^2 + 2 c F they go as g and as
// g / sqrt(g^2 + 2), which is flatter in the middle [Max, with c = 1 there].
fn layer_heights(round: f32, fill: f32) -> vec2f {
    let f = saturate(fill);
    let g = sqrt(f * (f + 2.0 * round));
    return vec2f(g / sqrt(1.0 + 2.0 * round), g / sqrt(g * g + 2.0) / layer_lower(round));
}

// Thickness where the field is `column` above where the cover begins, m.
fn layer_thickness(layer: Layer, column: f32) -> f32 {
    let heaps = layer_heights(layer.round, column / layer.rise);
    let sheet = layer.flat * layer_heights(layer.round, column / layer.sheet);
    return dot(max(heaps, sheet), vec2f(layer.top, layer.bottom));
}

// What F must be for cloud at this share of the most height above the rims, or below them, and how that changes with
// the share.
fn layer_fill(round: f32, height: f32, above: bool) -> vec2f {
    let share = min(height, 1.0);
    let reach = sqrt(1.0 + 2.0 * round);
    // The same g from the upper side's height or the lower one's.
    let lower = layer_lower(round);
    let left = 1.0 - lower * lower * share * share;
    let g = select(sqrt(2.0 / left) * lower * share, reach * share, above);
    let g_slope = select(sqrt(2.0 / left) * lower / left, reach, above);
    let root = sqrt(round * round + g * g);
    // root - round, without a difference of numbers that are nearly the same.
    return vec2f(g * g / max(root + round, 1e-9), g_slope * g / max(root, 1e-9));
}

// The sheet and the heaps: how much more the field has where one is thickest than where it begins, and its height over
// the most.
struct LayerPart {
    rise: f32,
    share: f32,
}

fn layer_sheet(layer: Layer) -> LayerPart {
    return LayerPart(layer.sheet, layer.flat);
}

fn layer_heaps(layer: Layer) -> LayerPart {
    return LayerPart(layer.rise, 1.0);
}

// The most height above the rims of a part, or below them, m.
fn layer_most(layer: Layer, part: LayerPart, height: f32) -> f32 {
    return max(part.share * select(layer.bottom, layer.top, height > 0.0), 1e-3);
}

// How far above where the cover begins the field must be for a part at a height above the rims, and how that changes with
// height, 1/m. Beyond its most height that stays as it is there.
fn layer_need(layer: Layer, part: LayerPart, height: f32) -> vec2f {
    let most = layer_most(layer, part, height);
    let fill = layer_fill(layer.round, abs(height) / most, height > 0.0);
    return part.rise * vec2f(fill.x, sign(height) * fill.y / most);
}

// Whether a part reaches a height above the rims where the field is no higher than `peak`.
fn layer_reaches(layer: Layer, part: LayerPart, peak: f32, height: f32) -> bool {
    return peak >= layer.begin + layer_need(layer, part, height).x && abs(height) <= layer_most(layer, part, height);
}

// The field at a place: mean value over a pixel, slopes, 1/m, and half the range of values in the pixel, which
// are taken as spread evenly.
struct LayerField {
    value: f32,
    slope: vec2f,
    range: f32,
}

// Mip of the field in which a texel is as wide as a footprint, m.
fn layer_mip(layer: Layer, footprint: f32) -> f32 {
    return log2(max(footprint / layer.texel, 1.0));
}

// Squares of the field that a ray jumps over: edge of the least, in texels, growth with distance, and how many sizes
// there are, each twice as wide as the one before.
const SQUARE: f32 = 16.0;
const SQUARE_GROWTH: f32 = 0.02;
const SQUARE_SIZES: u32 = 7u;

// Which size at a distance along a ray, m.
fn layer_square(layer: Layer, t: f32) -> u32 {
    let edge = max(SQUARE, SQUARE_GROWTH * t / layer.texel);
    return min(u32(log2(edge / SQUARE)), SQUARE_SIZES - 1u);
}

// From a texel, in which slopes are by tile and the last is the deviation.
fn layer_field(layer: Layer, texel: vec4f) -> LayerField {
    return LayerField(texel.x, layer.frequency * texel.yz, 1.7320508 * texel.w);
}

// Depth below the surface of a part at a height above the rims, m, to first order; negative outside, where it is no less
// than the distance to it. The lowest side is left to the level of the cloud, below which there is none of it.
fn layer_depth(layer: Layer, part: LayerPart, field: LayerField, height: f32) -> f32 {
    let need = layer_need(layer, part, height);
    let excess = field.value + field.range - layer.begin - need.x;
    let local = length(vec3f(field.slope, need.y));
    let slope = select(max(local, 1e-9), layer.steepest, excess < 0.0);
    let below = select(height + part.share * layer.bottom, 1e30, part.share == 1.0 || layer.bottom == 0.0);
    return min(excess / slope, min(part.share * layer.top - height, below));
}

// The hull of the layer at a height above its rims, and as its extinction the mean over the pixel. Noise moves no boundary
// farther than there is cloud in the column, so that what is covered stays so.
fn layer_edge(layer: Layer, field: LayerField, height: f32) -> Edge {
    let sheet = select(-1e30, layer_depth(layer, layer_sheet(layer), field, height), layer.flat > 0.0);
    let depth = max(sheet, layer_depth(layer, layer_heaps(layer), field, height));
    let column = field.value + field.range - layer.begin;
    let need = min(layer_need(layer, layer_heaps(layer), height).x,
        select(1e30, layer_need(layer, layer_sheet(layer), height).x, abs(height) < layer_most(layer, layer_sheet(layer), height)));
    let share = saturate((column - need) / max(2.0 * field.range, 1e-6));
    let aside = max(column, 0.0) / max(length(field.slope), 1e-9);
    let boundary = min(layer.boundary, min(0.5 * layer_thickness(layer, column), aside));
    return Edge(depth, share * layer.extinction, boundary, layer.wispiness);
}

// A ray goes on for no more than this, m.
const LAYER_FARTHEST: f32 = 5e5;

// The next piece of a ray, from `t` on, between the lowest and the highest height of the layer, and before the
// ground: where it begins and where it ends, which is no later where there is none.
fn layer_span(layer: Layer, height: f32, slope: f32, bend: f32, t: f32) -> vec2f {
    let b = max(bend, RAY_LEAST_BEND);
    let below_top = ray_below(height - layer.rim - layer.top, slope, b);
    let below_base = ray_below(height - layer.rim + layer.bottom, slope, b);
    let in_ground = ray_below(height - layer.ground, slope, b);
    let ground = select(LAYER_FARTHEST, in_ground.x, in_ground.x < in_ground.y && in_ground.x > 0.0);
    let end = min(below_top.y, min(ground, LAYER_FARTHEST));
    var begin = max(below_top.x, t);
    let under = below_base.x < below_base.y;
    begin = select(begin, max(begin, below_base.y), under && begin >= below_base.x);
    return vec2f(begin, select(end, min(end, below_base.x), under && begin < below_base.x));
}
