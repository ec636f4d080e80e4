// The slab that fits a cloud at a point, from maps of the cloud as the sun sees it: depths
// (lit surface, far surface, optical thickness along the light, coverage) and normals, both
// multiplied by coverage, so that their averages weigh by it. Three ways: ours, Kol's and
// Bouthors'.
// @use light_box slab slab_view slab_functions

struct SlabFit {
    // Unit normal of the lit face, outward, and its cosine to the sun, not below 0.2.
    normal: vec3f,
    mu0: f32,
    // Optical thickness along the light.
    thickness: f32,
    // The middle of the lit face, and geometric thickness along the light, m.
    middle: vec3f,
    length: f32,
    // Whether the maps show any cloud there, as their mean coverage.
    coverage: f32,
    // Reads of the maps.
    reads: u32,
}

// Least cosine of the sun to a fitted slab's normal.
const LOWEST_SUN: f32 = 0.2;

// From a mean of the maps.
fn slab_fit_of(box: LightBox, uv: vec2f, map: vec4f, lit: vec3f, turn: vec3f, reads: u32) -> SlabFit {
    let share = 1.0 / max(map.w, 1e-3);
    let to_sun = -box.along;
    let mean = normalize(share * lit + turn + 1e-3 * to_sun);
    // A slab that turns from the sun is tilted back: no lit surface of a cloud is that steep.
    let facing = dot(mean, to_sun);
    let across = mean - facing * to_sun;
    let tilted = LOWEST_SUN * to_sun + sqrt(1.0 - LOWEST_SUN * LOWEST_SUN) * across / max(length(across), 1e-6);
    let normal = select(mean, tilted, facing < LOWEST_SUN);
    let mu0 = clamp(facing, LOWEST_SUN, 1.0);
    let middle = light_box_point(box, vec3f(uv, share * map.x));
    return SlabFit(normal, mu0, share * map.z, middle, share * max(map.y - map.x, 0.0) * box.length, map.w, reads);
}

// Ours: from the mip whose texels are as wide as `length`, m, around `uv`; its filter averages
// over about half of that either way. `turn` is where the lump at hand faces.
fn slab_fit(box: LightBox, depths: texture_2d<f32>, normals: texture_2d<f32>, linear: sampler, uv: vec2f,
    length: f32, turn: vec3f) -> SlabFit {
    let level = log2(max(length / box.texel, 1.0));
    let map = textureSampleLevel(depths, linear, uv, level);
    let lit = textureSampleLevel(normals, linear, uv, level).xyz;
    return slab_fit_of(box, uv, map, lit, turn, 2u);
}

// Kol's: level 6 of maps of 1024 texels, everywhere [K 3.4.5].
fn slab_fit_kol(box: LightBox, depths: texture_2d<f32>, normals: texture_2d<f32>, linear: sampler, uv: vec2f) -> SlabFit {
    let level = log2(max(f32(textureDimensions(depths).x) / 16.0, 1.0));
    let map = textureSampleLevel(depths, linear, uv, level);
    let lit = textureSampleLevel(normals, linear, uv, level).xyz;
    return slab_fit_of(box, uv, map, lit, vec3f(0.0), 2u);
}

// A Gaussian of standard deviation `sigma`, m, as three boxes from the mips.
fn slab_fit_gaussian(box: LightBox, depths: texture_2d<f32>, normals: texture_2d<f32>, linear: sampler, uv: vec2f,
    sigma: f32) -> SlabFit {
    // Weights 1/4, 1/2, 1/4 of widths 2, 3.3 and 4.6 sigma have its variance within 2 %.
    var map = vec4f(0.0);
    var lit = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        let level = log2(max((2.0 + 1.3 * f32(i)) * sigma / box.texel, 1.0));
        let weight = select(0.25, 0.5, i == 1u);
        map += weight * textureSampleLevel(depths, linear, uv, level);
        lit += weight * textureSampleLevel(normals, linear, uv, level).xyz;
    }
    return slab_fit_of(box, uv, map, lit, vec3f(0.0), 6u);
}

// View of a point in Kol's and Bouthors' slabs [K 3.55-3.58], which are as thick as the cloud
// is wide along the light: the depth is that below the lit face, and never less than a tenth
// of the thickness (3.4.5). Where the point lies deeper than the slab is thick, the slab is
// made to hold it, by the same tenth: there is cloud behind the point.
fn slab_fit_view(fit: SlabFit, p: vec3f, to_eye: vec3f, to_sun: vec3f, mean_free_path: f32) -> SlabView {
    let depth = dot(fit.middle - p, fit.normal) / mean_free_path;
    let thickness = max(fit.mu0 * fit.length / mean_free_path, depth / 0.9);
    return slab_view(thickness, max(depth, 0.1 * thickness), fit.normal, to_eye, to_sun);
}

const BOUTHORS_ROUNDS: u32 = 10u;

// Bouthors': the slab under the area where the light of a set entered, which depends on the
// slab; found by going from one to the other, with limits to the steps [K 3.59-3.63].
fn slab_fit_bouthors(box: LightBox, depths: texture_2d<f32>, normals: texture_2d<f32>, shared_table: texture_2d<f32>,
    offset: texture_2d<f32>, linear: sampler, orders: u32, p: vec3f, to_eye: vec3f, mean_free_path: f32) -> SlabFit {
    var center = p;
    var sigma = max(2.0 * mean_free_path, box.texel);
    var fit = slab_fit_gaussian(box, depths, normals, linear, light_box_coordinate(box, center).xy, sigma);
    var reads = fit.reads;
    for (var i = 0u; i < BOUTHORS_ROUNDS; i++) {
        if fit.coverage < 0.05 {
            // No cloud there: look farther around.
            sigma *= 2.0;
        } else {
            let view = slab_fit_view(fit, p, to_eye, -box.along, mean_free_path);
            let entered = mean_free_path * slab_collector(shared_table, offset, linear, orders, view);
            let side = cross(fit.normal, -box.along);
            let sunward = -box.along + dot(box.along, fit.normal) * fit.normal;
            let next = p + max(dot(fit.middle - p, fit.normal), 0.0) * fit.normal
                + entered.x * side / max(length(side), 1e-3) + entered.y * sunward / max(length(sunward), 1e-3);
            let step = next - center;
            let spread = mean_free_path * slab_spread(orders, view.thickness, view.depth);
            let far = length(step);
            center += step * min(1.0, 0.5 * sigma / max(far, 1e-6));
            let converged = far < 0.1 * sigma;
            sigma = clamp(spread, 0.5 * sigma, 1.5 * sigma);
            if converged {
                break;
            }
        }
        fit = slab_fit_gaussian(box, depths, normals, linear, light_box_coordinate(box, center).xy, sigma);
        reads += fit.reads + 3u;
    }
    fit.reads = reads;
    return fit;
}
