// A view of a point in a plane-parallel slab, and what all models of slabs know of it.
// @use constants attenuation

struct SlabView {
    // Optical thickness of the slab and optical depth of the point, without the forward peak.
    thickness: f32,
    depth: f32,
    // Cosines to the inward normal of the directions in which the light at the point and the
    // sunlight fly; that of the sunlight is negative where the sun shines on the far face.
    mu: f32,
    mu0: f32,
    // Cosine and sine of the azimuth from the sun's: the cosine is 1 straight on.
    cos_phi: f32,
    sin_phi: f32,
}

// The view of a point at optical depth `depth` below the face with outward normal `normal`,
// towards an eye in direction `to_eye`, with the sun in direction `to_sun`. The side of
// positive azimuths is that of cross(normal, to_sun).
fn slab_view(thickness: f32, depth: f32, normal: vec3f, to_eye: vec3f, to_sun: vec3f) -> SlabView {
    let mu = -dot(normal, to_eye);
    let mu0 = dot(normal, to_sun);
    let sun = mu0 * normal - to_sun;
    let eye = to_eye + mu * normal;
    // Of one length, whatever the vectors across have lost by their differences.
    let azimuth = vec2f(dot(sun, eye), dot(cross(normal, to_sun), eye));
    let turn = azimuth / max(length(azimuth), 1e-9);
    let held = max(thickness, 1e-4);
    return SlabView(held, clamp(depth, 0.0, held), mu, mu0, turn.x, turn.y);
}

// The same with the slab turned over where the sun shines on its far face.
fn slab_sunward(view: SlabView) -> SlabView {
    if view.mu0 >= 0.0 {
        return view;
    }
    return SlabView(view.thickness, view.thickness - view.depth, -view.mu, -view.mu0, view.cos_phi, view.sin_phi);
}

// Sine of half the scattering angle, as half the chord between the two directions.
fn slab_half_sine(view: SlabView) -> f32 {
    let across = sqrt(max((1.0 - view.mu) * (1.0 + view.mu), 0.0));
    let across0 = sqrt(max((1.0 - view.mu0) * (1.0 + view.mu0), 0.0));
    let chord = vec3f(view.mu - view.mu0, across - across0, sqrt(2.0 * across * across0 * (1.0 - view.cos_phi)));
    return min(0.5 * length(chord), 1.0);
}

// 1 - e^-path up to the face behind the point as the eye sees it.
fn slab_opacity(view: SlabView) -> f32 {
    let behind = select(view.thickness - view.depth, view.depth, view.mu > 0.0);
    let path = max(behind, 0.0) / max(abs(view.mu), 1e-6);
    return path * mean_through(path);
}

// Coordinate of a view's cosine in tables, from 0 to 1: dense along the slab.
fn slab_view_coordinate(mu: f32) -> f32 {
    return 0.5 + 0.5 * sign(mu) * pow(saturate(abs(mu)), 2.0 / 3.0);
}
