// What clouds of ellipsoids have at a point.
//
// Who asks knows a region that holds all there is at a place: entries of its `candidates`, cloud after cloud.
// @use counts density region

@group(1) @binding(0) var<storage, read> ellipsoids: array<Ellipsoid>;
@group(1) @binding(1) var<storage, read> bodies: array<Body>;
@group(1) @binding(2) var noise_volume: texture_3d<f32>;
@group(1) @binding(3) var repeat: sampler;

fn medium_species(body: u32) -> Species {
    return bodies[body].species;
}

// Cloud by cloud, with this `share` of the noise.
fn clouds_at(region: Region, p: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    var matter = CLEAR;
    var i = 0u;
    while i < region.count {
        let index = ellipsoids[candidates[region.first + i]].body;
        var lumps = NO_LUMPS;
        while i < region.count {
            let e = ellipsoids[candidates[region.first + i]];
            if e.body != index {
                break;
            }
            lumps = lumps_with(lumps, e, ellipsoid_depth(e, ellipsoid_unit(e, p, 1.0)), bodies[index].power, bodies[index].reach);
            i += 1u;
        }
        matter = matter_union(matter, cloud_at(index, lumps, p, footprint, blur, share));
    }
    return matter;
}

// A cloud whose lumps at a point are known.
fn cloud_at(index: u32, lumps: Lumps, p: vec3f, footprint: f32, blur: f32, share: f32) -> Matter {
    if lumps.weight <= 0.0 {
        return CLEAR;
    }
    let body = bodies[index];
    var noise = vec2f(0.0);
    if share > 0.0 && p.y > body.level {
        count(NOISE_READS, noise_reads(body.noise));
        noise = share * noise_at(noise_volume, repeat, body.noise, p, footprint);
    }
    return matter_below(body, index, lumps_edge(lumps, body.power, body.reach), p.y, noise, blur);
}
