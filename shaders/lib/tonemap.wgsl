// From scene-referred light to the screen: a tone curve and sRGB.

// Film-like curve: Narkowicz's fit (2015) of the ACES reference transform, per channel.
// 0.18 stays near 0.27, 1 becomes 0.80, and light rolls off to 1 at about 8.
fn filmic(light: vec3f) -> vec3f {
    let x = max(light, vec3f(0.0));
    return saturate(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

// Reinhard's curve (2002) with its white point, per channel: keeps contrast in highlights,
// reaches 1 at 8. Scaled so that 0.18 comes out as from the film-like curve.
fn soft(light: vec3f) -> vec3f {
    let x = 1.9 * max(light, vec3f(0.0));
    return saturate(x * (1.0 + x / (15.2 * 15.2)) / (1.0 + x));
}

// Keeps hue: brightness, the mean of luminance and the brightest channel, goes straight up to the
// shoulder, which rolls off to 1, and the channels with it. What of the colour would then be brighter than
// white fades to a grey of that brightness. By channel instead, a low sun would turn yellow, for its red is
// cut first, and clouds would lie on the shoulder with all that they have of texture.
const NATURAL_SHOULDER: f32 = 0.6;

fn natural_level(brightness: f32) -> f32 {
    let left = 1.0 - NATURAL_SHOULDER;
    let rolled = 1.0 - left * exp(min((NATURAL_SHOULDER - brightness) / left, 0.0));
    return select(brightness, rolled, brightness > NATURAL_SHOULDER);
}

// Share of a colour that is kept where its brightest channel is `brightest` and grey of its level `level`: about
// all of it as long as that fits below 1, and so much that it fits beyond.
fn natural_colour(brightest: f32, level: f32) -> f32 {
    let filled = min((brightest - level) / max(1.0 - level, 1e-6), 1e4);
    let square = filled * filled;
    return inverseSqrt(sqrt(1.0 + square * square));
}

// Luminance as IEC 61966-2-1 has it, and the brightest channel.
fn natural_brightness(x: vec3f) -> f32 {
    return 0.5 * (max(x.x, max(x.y, x.z)) + dot(x, vec3f(0.2126, 0.7152, 0.0722)));
}

fn natural(light: vec3f) -> vec3f {
    let x = max(light, vec3f(0.0));
    let brightest = max(x.x, max(x.y, x.z));
    let brightness = natural_brightness(x);
    let level = natural_level(brightness);
    let scale = level / max(brightness, 1e-20);
    let kept = natural_colour(scale * brightest, level);
    return saturate(kept * scale * x + (1.0 - kept) * level);
}

// The same with the contrast of a photograph: brightness by a power, but where it is that of lit clouds. Light
// scattered often lends clouds few shades of their own. Below the brightness of shaded clouds contrast is as it
// was, so that skies do not turn navy.
const PHOTO_CONTRAST: f32 = 1.22;
const PHOTO_STILL: f32 = 0.78;
const PHOTO_TOE: f32 = 0.3;

fn photo(light: vec3f) -> vec3f {
    let x = max(light, vec3f(0.0));
    let brightness = min(natural_brightness(x), 1e15);
    let toe = PHOTO_TOE * PHOTO_TOE;
    let square = (brightness * brightness + toe) / (PHOTO_STILL * PHOTO_STILL + toe);
    return natural(pow(square, 0.5 * (PHOTO_CONTRAST - 1.0)) * x);
}

const TONE_FILMIC: u32 = 0u;
const TONE_SOFT: u32 = 1u;
const TONE_LINEAR: u32 = 2u;
const TONE_NATURAL: u32 = 3u;
const TONE_PHOTO: u32 = 4u;

// Light to the screen's, 0 to 1, still linear.
fn tone_curve(curve: u32, light: vec3f) -> vec3f {
    switch curve {
        case TONE_SOFT: { return soft(light); }
        case TONE_LINEAR: { return saturate(light); }
        case TONE_FILMIC: { return filmic(light); }
        case TONE_NATURAL: { return natural(light); }
        default: { return photo(light); }
    }
}

// IEC 61966-2-1.
fn srgb_encode(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(1e-8)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

// Share of the way through the colours of a heat map that ends at `range`. Logarithmic: a step from 1 to 2
// counts as much as one from 100 to 200.
fn heat_share(value: f32, range: f32) -> f32 {
    return saturate(log2(1.0 + max(value, 0.0)) / log2(1.0 + range));
}
