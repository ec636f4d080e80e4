// What is seen of a ray, and of its steps.
// @use lighting

// What a step lets through, where this share of its optical depth is `kept`.
fn step_through(kept: f32, optical_depth: f32) -> f32 {
    return exp(-kept * optical_depth);
}

// The transmittance at which a ray ends. Before the sun a little of it is much light: look deeper
// there. `glare` is the phase function's peak in the direction of the sun, 1/sr.
fn opaque_before(opaque: f32, glare: f32) -> f32 {
    return opaque / (1.0 + 10.0 * glare);
}

// The same of what a model of light sees that takes the share `ahead` of the extinction as going straight on.
fn opaque_ahead(opaque: f32, ahead: f32) -> f32 {
    return pow(opaque, 1.0 - ahead);
}

// A ray that is as good as opaque is: nothing gets through, and the little light that was not
// gathered is like what was.
fn ray_seen(transmittance: f32, optical_depth: f32, opaque: f32, visible: f32) -> RaySeen {
    let closed = transmittance < opaque;
    return RaySeen(select(1.0 - transmittance, 1.0, closed), select(optical_depth, 1e4, closed),
        select(1.0, 1.0 / (1.0 - transmittance), closed), visible, 0.0);
}

// How much more of a ray is opaque to diffuse light, that comes from all sides, than to light that may go
// straight on as a model has it: both are near 1 where nothing gets through.
fn opacity_ratio(seen: RaySeen, transported: f32) -> f32 {
    let alone = (1.0 - exp(-transported * seen.optical_depth)) / seen.opacity;
    return select(alone, seen.together, seen.together > 0.0);
}

// What is lost of the light behind. That of the forward peak, all but the share `transported`, is not lost
// to a smooth background, but it is to the sun's disc: there, and only there, all that was scattered is gone.
fn ray_alpha(seen: RaySeen, transported: f32, before_sun: bool) -> f32 {
    return 1.0 - exp(-select(transported, 1.0, before_sun) * seen.optical_depth);
}

// Whether the pixel in direction `d` shows any of the sun's disc of angular `radius`, rad, which is drawn
// no smaller than a pixel. Its edge must be as dark as the rest.
fn sees_disc(d: vec3f, to_sun: vec3f, radius: f32, pixel: f32) -> bool {
    return radius > 0.0 && length(d - to_sun) < max(radius, pixel) + pixel;
}

// Mean over what is seen, of a sum that what is seen weighs.
fn ray_mean(sum: f32, seen: RaySeen) -> f32 {
    return sum * seen.share / (seen.opacity * seen.visible);
}

// Where between base and top of a cloud a ray sees it on average, from 0 to 1: `sum` is of heights from
// the cloud's middle, weighted by what is seen, and `extent` from base to top, m.
fn ray_height(sum: f32, extent: f32, seen: RaySeen) -> f32 {
    return saturate(0.5 + ray_mean(sum, seen) / max(extent, 1.0));
}

// Nodes share the opacity of a ray evenly: the number of that to which a piece belongs of which this
// much is `seen` behind what is `gathered`.
fn node_of(gathered: f32, seen: f32, count: u32) -> u32 {
    return min(u32((gathered + 0.5 * seen) * f32(count)), count - 1u);
}

// Whether less than half of a node's share is gathered: there it lies.
fn node_begins(gathered: f32, node: u32, count: u32) -> bool {
    return gathered * f32(count) < f32(node) + 0.5;
}

// A piece of a ray under way.
struct Piece {
    // Where it begins and ends, m.
    begin: f32,
    end: f32,
    // Optical depth to the sun where it begins, and the part of it that is other clouds' shadow.
    sun: vec2f,
    // Its own optical depth, without the peak.
    optical_depth: f32,
    // What is seen of it, and the sum of distances, m, weighted by what is seen.
    seen: f32,
    distance: f32,
}

// The piece grown by a step from `t`.
fn piece_with(piece: Piece, t: f32, length: f32, optical_depth: f32, seen: f32) -> Piece {
    return Piece(piece.begin, t + length, piece.sun, piece.optical_depth + optical_depth, piece.seen + seen,
        piece.distance + seen * (t + 0.5 * length));
}
