//! Functions as a textbook has them, in whose differences digits are lost: each must fail its twin,
//! and the table of docs/numerics.md tells by how much.

use crate::harness::Twin;

/// Name of the function, module-scope WGSL, body.
type Form = (&'static str, &'static str, &'static str);

/// The twins of `list` that have such a form, with it in the place of the function.
pub fn forms(list: Vec<Twin>) -> Vec<Twin> {
    let form = |twin: &Twin| FORMS.iter().find(|(name, ..)| *name == twin.name);
    let replaced = |twin: Twin| {
        let (_, declarations, body) = form(&twin)?;
        let declarations = format!("{}\n{declarations}", twin.declarations).leak();
        Some(Twin { declarations, body, ..twin })
    };
    list.into_iter().filter_map(replaced).collect()
}

const FORMS: &[Form] = &[
    // The quadratic formula, 2 sqrt(B^2 - DC) / D: far ellipsoids are small differences of squares.
    (
        "ellipsoid_chord",
        "fn textbook(e: Ellipsoid, origin: vec3f, direction: vec3f, scale: f32) -> vec2f {
            let a = ellipsoid_unit(e, origin, 1.0);
            let v = ellipsoid_unit(e, direction, 0.0);
            let b = dot(a, v);
            let d = dot(v, v);
            let discriminant = b * b - d * (dot(a, a) - scale * scale);
            if discriminant <= 0.0 { return vec2f(1e30, -1e30); }
            return vec2f(-b - sqrt(discriminant), -b + sqrt(discriminant)) / d;
        }",
        "return vec4f(textbook(make(x), x[5].xyz, x[6].xyz, x[7].z), 0.0, 0.0);",
    ),
    ("mean_through", "", "return vec4f((1.0 - exp(-x[0].x)) / x[0].x);"),
    (
        "mean_transmittance",
        "",
        "let a = x[0].x; let b = x[0].y; return vec4f((exp(-a) - exp(-b)) / (b - a));",
    ),
    (
        "recovered_peak",
        "",
        "let tau = x[0].x; return vec4f(exp(-(1.0 - x[0].y) * tau) - exp(-tau));",
    ),
    (
        "slab_opacity",
        "",
        "let v = view(x); let behind = select(v.thickness - v.depth, v.depth, v.mu > 0.0);
         return vec4f(1.0 - exp(-max(behind, 0.0) / abs(v.mu)));",
    ),
    ("slab_ln_1p", "", "return vec4f(log(1.0 + x[0].x));"),
    (
        "slab_ln_known",
        "",
        "var known = array<vec3f, 7>(vec3f(1.0, 1.0, 1.0), vec3f(2.0, 1.0, 1.0), vec3f(3.0, 0.7, 1.0),
            vec3f(4.0, 0.3, 1.0), vec3f(6.0, 0.2, 0.9), vec3f(9.0, 0.2, 0.75), vec3f(15.0, 0.7, 0.0));
         let k = known[u32(x[1].z)];
         return vec4f(k.x * log(x[0].x / (x[0].x + k.y)) - k.z * x[0].y);",
    ),
    (
        "slab_depth_coordinate",
        "",
        "let near = log(1.0 + x[0].y / SLAB_FACE); let far = log(1.0 + (x[0].x - x[0].y) / SLAB_FACE);
         return vec4f(0.5 + 0.5 * (near - far) / log(1.0 + x[0].x / SLAB_FACE));",
    ),
    // The half angle from the cosine.
    (
        "slab_half_sine",
        "",
        "let v = view(x); let across = sqrt(max((1.0 - v.mu * v.mu) * (1.0 - v.mu0 * v.mu0), 0.0));
         return vec4f(sqrt(saturate(0.5 - 0.5 * (v.mu * v.mu0 + across * v.cos_phi))));",
    ),
    // The azimuth by the lengths of both parts across the normal.
    (
        "slab_view",
        "",
        "let normal = x[0].xyz; let mu = -dot(normal, x[1].xyz); let mu0 = dot(normal, x[2].xyz);
         let sun = mu0 * normal - x[2].xyz; let eye = x[1].xyz + mu * normal;
         let across = length(sun) * length(eye);
         return vec4f(mu, mu0, dot(sun, eye) / across, dot(cross(normal, x[2].xyz), eye) / across);",
    ),
    // The normal put together again from its cosine and its part across.
    (
        "slab_fit_of",
        "",
        "let to_sun = -x[5].xyz; let mean = normalize(x[3].xyz / x[1].w + x[4].xyz + 1e-3 * to_sun);
         let across = mean - dot(mean, to_sun) * to_sun; let mu0 = clamp(dot(mean, to_sun), 0.2, 1.0);
         return vec4f(mu0 * to_sun + sqrt(1.0 - mu0 * mu0) * across / max(length(across), 1e-6), mu0);",
    ),
    // The limb from the square of the distance to the centre.
    (
        "disc_radiance",
        "",
        "let sharp = 1.0 - 0.5 * x[0].y / x[0].x; let rim = min(x[0].z / x[0].x, sharp); let exponent = 0.5 * sharp * LIMB;
         let limb = (1.0 + exponent) * pow(vec3f(max(1.0 - rim * rim, 1e-6)), exponent);
         return vec4f(limb * x[0].w / (PI * (x[0].x * x[0].x + x[0].y * x[0].y / 12.0)), 0.0);",
    ),
    // Maclaurin's series of asin to x^17.
    (
        "asin_small",
        "",
        "let y = x[0].x; let z = y * y;
         let tail = z * (0.030381944 + z * (0.022372159 + z * (0.017352764 + z * (0.01396484 + z * 0.0115518))));
         return vec4f(y * (1.0 + z * (0.16666667 + z * (0.075 + z * (0.04464286 + tail)))));",
    ),
    // The cross product of both tangents, of which steep slopes make nearly one.
    (
        "light_box_normal",
        "",
        "let box = leaning(x); let u = normalize(box.edge_u) + x[2].x * box.along;
         let v = normalize(box.edge_v) + x[2].y * box.along; let n = normalize(cross(u, v));
         return vec4f(select(n, -n, dot(n, box.along) > 0.0), 0.0);",
    ),
];
