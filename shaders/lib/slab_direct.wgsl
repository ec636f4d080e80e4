// C of [K 3.25] in a plane-parallel slab from the direct table of `nephos tables slab`;
// src/optics/slab/direct.rs tells what its numbers are. Depths are optical, along the inward
// normal, in the medium without its forward peak; cosines are those of directions in which
// light flies, to the inward normal.
// @use constants slab slab_view

// Thicknesses of the table.
const SLAB_DIRECT_THICKNESSES: f32 = 18.0;

// Radiance of a set of orders, 1/sr per unit of irradiance across the beam. `modes` has the
// view along x within the set, depth along y, the sun within the thickness along z; `phase`
// the sine of half the scattering angle along x, the set along y.
fn slab_direct(modes: texture_3d<f32>, phase: texture_2d<f32>, linear: sampler, orders: u32, view: SlabView) -> f32 {
    let v = slab_sunward(view);
    let sets = f32(SLAB_SETS);
    let size = vec3f(textureDimensions(modes));
    let views = size.x / sets;
    let suns = size.z / SLAB_DIRECT_THICKNESSES;
    let x = f32(orders) * views + 0.5 + slab_view_coordinate(v.mu) * (views - 1.0);
    let y = 0.5 + slab_depth_coordinate(v.depth, v.thickness) * (size.y - 1.0);
    let sun = 0.5 + slab_sun_coordinate(v.mu0) * (suns - 1.0);
    let row = slab_thickness_coordinate(v.thickness) * (SLAB_DIRECT_THICKNESSES - 1.0);
    let low = min(floor(row), SLAB_DIRECT_THICKNESSES - 2.0);
    let thin = textureSampleLevel(modes, linear, vec3f(x, y, sun + low * suns) / size, 0.0);
    let thick = textureSampleLevel(modes, linear, vec3f(x, y, sun + (low + 1.0) * suns) / size, 0.0);
    let angles = f32(textureDimensions(phase).x);
    let at = vec2f((0.5 + slab_half_sine(v) * (angles - 1.0)) / angles, (f32(orders) + 0.5) / sets);
    let shape = textureSampleLevel(phase, linear, at, 0.0).x;
    let c = v.cos_phi;
    let azimuth = vec4f(1.0, c, 2.0 * c * c - 1.0, c * (4.0 * c * c - 3.0));
    let exponent = dot(mix(thin, thick, row - low), azimuth) + slab_ln_known(orders, v.thickness, v.depth);
    return v.mu0 * slab_opacity(v) * shape * exp(exponent);
}

// How a set dies with depth and with thinness: ln of (t / (t + birth))^power e^(-decay depth).
fn slab_ln_known(orders: u32, thickness: f32, depth: f32) -> f32 {
    // Powers of birth, its thickness, decay.
    var known = array<vec3f, 7>(vec3f(1.0, 1.0, 1.0), vec3f(2.0, 1.0, 1.0), vec3f(3.0, 0.7, 1.0),
        vec3f(4.0, 0.3, 1.0), vec3f(6.0, 0.2, 0.9), vec3f(9.0, 0.2, 0.75), vec3f(15.0, 0.7, 0.0));
    let k = known[orders];
    let t = max(thickness, 1e-6);
    return -k.x * slab_ln_1p(k.y / t) - k.z * depth;
}
