// Several rays a pixel become one, and layers become something to look at: light stays
// linear, for `compose`; all else comes out as the screen shows it.
// @use tonemap

struct Resolve {
    // Rays across a pixel.
    rays: u32,
    // One of the constants below.
    shown: u32,
    // The value that gets the last colour.
    range: f32,
    padding: u32,
    // Colours of a heat map from none to `range`, as the screen shows them.
    stops: array<vec4f, 10>,
}

// Everything, with its opacity.
const BEAUTY: u32 = 0u;
// One layer of light over black.
const LIGHT: u32 = 1u;
const TRANSMITTANCE: u32 = 2u;
const NORMAL: u32 = 3u;
const HEAT: u32 = 4u;

@group(0) @binding(0) var<uniform> settings: Resolve;
@group(0) @binding(1) var picture: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn mean_of_rays(pixel: vec2u) -> vec4f {
    var sum = vec4f(0.0);
    for (var y = 0u; y < settings.rays; y++) {
        for (var x = 0u; x < settings.rays; x++) {
            sum += textureLoad(picture, pixel * settings.rays + vec2u(x, y), 0);
        }
    }
    return sum / f32(settings.rays * settings.rays);
}

fn heat(value: f32) -> vec3f {
    let x = 9.0 * heat_share(value, settings.range);
    let i = min(u32(x), 8u);
    return mix(settings.stops[i], settings.stops[i + 1u], x - f32(i)).rgb;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let value = mean_of_rays(vec2u(position.xy));
    switch settings.shown {
        case LIGHT: { return vec4f(value.rgb, 1.0); }
        case TRANSMITTANCE: { return vec4f(srgb_encode(vec3f(1.0 - saturate(value.a))), 1.0); }
        case NORMAL: {
            let facing = 0.5 + 0.5 * value.rgb / max(value.a, 1e-4);
            return vec4f(mix(vec3f(0.1), facing, value.a), 1.0);
        }
        case HEAT: { return vec4f(heat(value.r), 1.0); }
        default: { return value; }
    }
}
