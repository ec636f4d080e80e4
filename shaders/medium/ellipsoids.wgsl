// The medium as clouds of ellipsoids that join into one body, whose boundary noise displaces. Extinction at a
// point is that of the densest cloud there, so that overlaps count once.
// @use counts ellipsoids_at

// What is at a point of a region: noise finer than `footprint`, m, is left out, and edges are no
// sharper than `blur`, m.
fn medium_at(region: Region, p: vec3f, footprint: f32, blur: f32) -> Matter {
    return clouds_at(region, p, footprint, blur, 1.0);
}

// What is there on average over the noise.
fn medium_mean_at(region: Region, p: vec3f, blur: f32) -> Matter {
    return clouds_at(region, p, 0.0, blur, 0.0);
}

// The ellipsoids that a ray meets next: of the tile's that it has not left, the nearest ones that
// there is room for. Before `near_end` along the ray there are no others. Those that the ray is in
// are `holding` it; a point of the ray asks only them.
const MOST_NEAR: u32 = 32u;
var<private> near: array<u32, MOST_NEAR>;
var<private> near_entry: array<f32, MOST_NEAR>;
var<private> near_count: u32;
var<private> near_end: f32;
var<private> holding: array<u32, MOST_NEAR>;
var<private> holding_count: u32;
// Whether the ray is in more than there is room for: then all of the tile are asked.
var<private> crowded: bool;

// Lists the ellipsoids from `t` on.
fn find_near(region: Region, origin: vec3f, direction: vec3f, t: f32) {
    count(ELLIPSOIDS, region.count);
    near_count = 0u;
    near_end = 1e30;
    var farthest = 0u;
    for (var i = 0u; i < region.count; i++) {
        let index = candidates[region.first + i];
        let chord = ellipsoid_chord(ellipsoids[index], origin, direction, 1.0);
        if chord.x < chord.y && chord.y > t {
            var place = near_count;
            if near_count == MOST_NEAR {
                near_end = min(near_end, max(chord.x, near_entry[farthest]));
                place = select(MOST_NEAR, farthest, chord.x < near_entry[farthest]);
            }
            if place < MOST_NEAR {
                near[place] = index;
                near_entry[place] = chord.x;
                near_count = min(near_count + 1u, MOST_NEAR);
            }
            if near_count == MOST_NEAR {
                farthest = farthest_near();
            }
        }
    }
    crowded = near_end <= t;
}

// The one of the list that the ray meets last.
fn farthest_near() -> u32 {
    var last = 0u;
    for (var i = 1u; i < MOST_NEAR; i++) {
        last = select(last, i, near_entry[i] > near_entry[last]);
    }
    return last;
}

// Where a ray begins that is followed by `medium_ahead`.
fn medium_begin(region: Region, origin: vec3f, direction: vec3f, bend: f32) {
    find_near(region, origin, direction, 0.0);
}

// What lies ahead of `t` on the ray.
fn medium_ahead(region: Region, origin: vec3f, direction: vec3f, t: f32) -> Stretch {
    if t >= near_end || crowded {
        find_near(region, origin, direction, t);
    }
    var entry = 1e30;
    var exit = 1e30;
    var core_exit = 0.0;
    var core = 0.0;
    var boundary = 1e30;
    holding_count = 0u;
    let asked = select(near_count, region.count, crowded);
    count(ELLIPSOIDS, asked);
    for (var i = 0u; i < asked; i++) {
        let index = listed(region, i);
        let e = ellipsoids[index];
        let outer = ellipsoid_chord(e, origin, direction, 1.0);
        if outer.x < outer.y && outer.x > t {
            entry = min(entry, outer.x);
        } else if outer.y > t && outer.x <= t {
            if !crowded {
                holding[holding_count] = index;
                holding_count += 1u;
            }
            exit = min(exit, outer.y);
            let inner = ellipsoid_chord(e, origin, direction, e.core);
            if inner.x <= t && inner.y > t {
                exit = min(exit, inner.y);
                // Lumps of a cloud that has a core agree on the extinction in it.
                core_exit = max(core_exit, inner.y);
                core = e.extinction;
                // What changes with height needs steps that are short beside the lump.
                boundary = select(boundary, min(boundary, ellipsoid_thinnest(e)), bodies[0].uneven > 0.0);
            } else {
                // Only boundaries that the ray is in need short steps.
                boundary = min(boundary, ellipsoid_boundary(e, bodies[0].noise.frequency));
                exit = select(exit, min(exit, inner.x), inner.x < inner.y && inner.x > t);
            }
        }
    }
    let inside = exit < 1e30;
    // Beyond the end of the list there may be more.
    entry = min(entry, select(near_end, 1e30, crowded));
    if core > 0.0 && bodies[0].uneven == 0.0 {
        return Stretch(core_exit, true, core, boundary, 0u);
    }
    return Stretch(min(entry, exit), inside, 0.0, boundary, 0u);
}

// The `i`th ellipsoid of the list, or of the tile where it is crowded.
fn listed(region: Region, i: u32) -> u32 {
    if crowded {
        return candidates[region.first + i];
    }
    return near[i];
}

// What is at a point of the ray: one cloud, of whose ellipsoids only those are asked that the ray is in.
fn medium_on_ray(region: Region, p: vec3f, direction: vec3f, blur: f32) -> Matter {
    let asked = select(holding_count, region.count, crowded);
    count(DENSITY, 1u);
    count(ELLIPSOIDS, asked);
    var lumps = NO_LUMPS;
    for (var i = 0u; i < asked; i++) {
        var index = 0u;
        if crowded {
            index = candidates[region.first + i];
        } else {
            index = holding[i];
        }
        let e = ellipsoids[index];
        lumps = lumps_with(lumps, e, ellipsoid_depth(e, ellipsoid_unit(e, p, 1.0)), bodies[0].power, bodies[0].reach);
    }
    return cloud_at(0u, lumps, p, blur, blur, 1.0);
}

// Which way the cloud faces at a point, noise left out: away from where its ellipsoids
// gather. Each weighs by how deep the point is in it, so that there is no seam where one
// ends. Unit length on the surface of a lump, and less inside, down to none in its middle.
fn medium_facing(region: Region, p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    var weights = 1e-6;
    for (var i = 0u; i < region.count; i++) {
        let e = ellipsoids[candidates[region.first + i]];
        let facing = ellipsoid_facing(e, ellipsoid_unit(e, p, 1.0));
        sum += facing.xyz;
        weights += facing.w;
    }
    return sum / weights;
}
