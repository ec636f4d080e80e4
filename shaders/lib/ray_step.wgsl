// How long a step of the march is. Lengths and distances along the ray in metres.
// @use density

// Shortest step, in widths of a pixel.
const SHORTEST_STEP: f32 = 0.5;
// Share of the distance to a change of density that is stepped over, for noise steepens it, the
// largest optical depth that is, and how many times as long a step may become by it: noise has
// more in store than one point of it tells, and shorter steps must find it.
const STEADY: f32 = 0.6;
const THICKEST_STEP: f32 = 1.0;
const MOST_STRETCHED: f32 = 4.0;
// Optical depth of the first step in a homogeneous core.
const CORE_STEP: f32 = 0.15;
// Steps kept for stretches to come when a ray has used up its own.
const RESERVE: u32 = 8u;

// A share of the thickness of a boundary, and no less than what a pixel of this width shows.
fn step_of_boundary(share: f32, boundary: f32, pixel: f32) -> f32 {
    return max(share * boundary, SHORTEST_STEP * pixel);
}

// The step that the last one asks for: within bounds, or, where the extinction is `core` all the way,
// as long as it has grown.
fn step_spaced(step: f32, smallest: f32, longest: f32, core: f32) -> f32 {
    return select(clamp(step, smallest, longest), max(step, CORE_STEP / core), core > 0.0);
}

// Where steps run short, the share of what is `left` of the stretch for each of those that are left:
// 0 while no more than half of `most` are `taken`.
fn step_scarce(left: f32, taken: u32, most: u32) -> f32 {
    let scarce = left / f32(max(most, taken + RESERVE) - taken);
    return select(0.0, scarce, 2u * taken > most);
}

// A step of this `length`, in the middle of which there is `matter`, made as long as that allows, within
// reason: `wanted` is what it would be without, `kept` the share of the extinction that counts.
fn step_stretched(length: f32, wanted: f32, left: f32, matter: Matter, kept: f32) -> f32 {
    let thickest = THICKEST_STEP / max(kept * matter.extinction, 1e-6);
    let most = min(thickest, MOST_STRETCHED * wanted);
    let steady = min(0.5 * length + STEADY * matter.steady, most);
    return min(max(length, max(steady, 0.5 * length + matter.clear)), left);
}
