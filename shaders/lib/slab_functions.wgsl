// Bouthors' functions of multiple scattering in plane-parallel slabs [K 3.32-3.53], fitted by
// `nephos tables slab`: src/optics/slab/functions.rs and collector.rs tell how.
// @use constants slab slab_view

// Radiance of a set of orders, 1/sr per unit of irradiance across the beam. The tables have
// thickness within the set along y; along x they have the sine of half the scattering angle,
// the view, the sun.
fn slab_functions(angle: texture_2d<f32>, view_table: texture_2d<f32>, sun_table: texture_2d<f32>, linear: sampler,
    orders: u32, view: SlabView) -> f32 {
    let v = slab_sunward(view);
    let row = slab_thickness_coordinate(v.thickness);
    let ln_p = slab_functions_read(angle, linear, orders, slab_half_sine(v), row).x;
    let seen = slab_functions_read(view_table, linear, orders, slab_view_coordinate(v.mu), row);
    let lit = slab_functions_read(sun_table, linear, orders, slab_sun_coordinate(v.mu0), row).xy;
    let b = v.thickness * max(seen.y - lit.y, 0.0);
    let c = max(v.thickness, 1e-6) * exp(clamp(seen.z, -6.0, 6.0));
    let d = exp(clamp(seen.w, -6.0, 6.0));
    let ratio = slab_ln_1p(v.depth + d) / slab_ln_1p(b + d);
    let far = (v.depth - b) / c;
    return v.mu0 * slab_opacity(v) * exp(ln_p + seen.x + lit.x - 0.5 * far * far) * ratio * ratio;
}

// A table at coordinates from 0 to 1.
fn slab_functions_read(table: texture_2d<f32>, linear: sampler, orders: u32, x: f32, row: f32) -> vec4f {
    let size = vec2f(textureDimensions(table));
    let rows = size.y / f32(SLAB_SETS);
    let at = vec2f(x * (size.x - 1.0), f32(orders) * rows + row * (rows - 1.0));
    return textureSampleLevel(table, linear, (at + 0.5) / size, 0.0);
}

// Where the light of a set entered the face towards the sun, on average, as optical depths
// from the point straight above: x to the side of positive azimuths, y towards the sun along
// the face. `shared_table` has views within half of the numbers along x and sets along y,
// `offset` views along x and suns within the set along y.
fn slab_collector(shared_table: texture_2d<f32>, offset: texture_2d<f32>, linear: sampler, orders: u32,
    view: SlabView) -> vec2f {
    let v = slab_sunward(view);
    let size = vec2f(textureDimensions(shared_table));
    let views = 0.5 * size.x;
    let x = clamp((0.5 + 0.5 * v.mu) * views, 0.5, views - 0.5);
    let y = (f32(orders) + 0.5) / size.y;
    let first = textureSampleLevel(shared_table, linear, vec2f(x / size.x, y), 0.0);
    let second = textureSampleLevel(shared_table, linear, vec2f((x + views) / size.x, y), 0.0);
    let suns = f32(textureDimensions(offset).y) / size.y;
    let sun = 0.5 + slab_sun_coordinate(v.mu0) * (suns - 1.0);
    let n = textureSampleLevel(offset, linear, vec2f(x / views, y + (sun / suns - 0.5) / size.y), 0.0).xy;
    let mu0 = min(v.mu0, 1.0);
    let sine = sqrt(1.0 - mu0 * mu0);
    let theta = atan2(sine, mu0);
    let log_depth = log(1.0 + exp(clamp(first.x, -5.0, 5.0)) * v.depth);
    let s = log_depth * log_depth;
    let across = v.sin_phi * (first.y * sin(first.z * theta) * s + first.w * sine);
    let along = v.cos_phi * sin(second.z * theta) + second.w * theta;
    return vec2f(across, (second.x + second.y * along) * s + n.y + n.x * v.cos_phi);
}
