//! Auto exposure: how bright the picture has to be for the light of its clouds.
//!
//! A small draft of the frame is metered. What is metered of a pixel is its brightest channel, which
//! would be cut first: a low sun's clouds keep their red. Of clouds and of clear sky the brighter half counts,
//! without its brightest tenth, which are silver linings and the sun; a logarithmic mean of that many
//! pixels hardly moves with the size of the picture.

use super::{Film, Picture, Renderer, compose::BASE};
#[cfg(doc)]
use crate::render::Settings;
use crate::{Result, frame::Frame, gpu::Gpu};

/// Rays of the draft, about.
const RAYS: f64 = 9216.0;
/// Where the brighter half of the clouds' light comes to lie: at the foot of the shoulder of the tone curve, so that it keeps its
/// shades. [`crate::scene::ToneCurve::Photo`] leaves just that brightness as it is.
const CLOUDS: f64 = 0.78;
/// Where that of the clear sky lies at most: dusk stays dusk behind dark clouds, and blue stays blue.
const SKY: f64 = 0.6;
/// Where it lies at least: a day stays day behind clouds that the sun shines through, whose rims may be white.
const LEAST_SKY: f64 = 0.4;
/// The light of a clear sky by day over the dimmest that is exposed as day; the least of a dimmer one falls off as
/// its light, so that dusk stays dusk behind what the sun still reaches.
const BRIGHT_DAY: f64 = 40.0;
/// What covers a smaller share of the picture is not metered.
const LEAST_COVER: f64 = 1e-3;
/// Shares of what is sorted by brightness between which it counts.
const COUNTED: [f64; 2] = [0.5, 0.95];
/// The irradiance of the strongest light over the dimmest light that is exposed as day: six stops less than clouds
/// have at noon. What is darker comes out as night.
const NIGHT: f64 = 1.6e-3;
/// No light at all.
const BLACK: f64 = 1e-20;
/// Stops up and down that are enough for any scene.
const MOST: f64 = 40.0;

impl Renderer {
    /// Auto exposure of `frame`, in stops: to be added to the scene's own. It depends on the moment and on
    /// what is seen of it, as light is found now: with these [`Settings`], so that the picture finds its light
    /// made. Its passes are timed, but not counted.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device fails.
    pub fn meter(&mut self, gpu: &Gpu, frame: &Frame) -> Result<f64> {
        let frame = frame.resized(draft_size(frame.size()));
        let counting = std::mem::take(&mut self.settings.counting);
        let clouds = Film::new(frame.size(), 1).take(gpu, self, &frame, false, &mut |_| ());
        let sky = self.sky_picture(gpu, &frame);
        self.settings.counting = counting;
        let dimmest = NIGHT * f64::from(frame.unit() * frame.strongest_light());
        Ok(metered(&clouds?, Some(&sky?), dimmest))
    }
}

/// Auto exposure of a picture of clouds alone, whose colours are multiplied by alpha, in stops.
pub fn metered_alone(clouds: &Picture) -> f64 {
    metered(clouds, None, 0.0)
}

/// As many rays as are enough, in the shape of a picture of `size` pixels.
fn draft_size(size: [u32; 2]) -> [u32; 2] {
    let [width, height] = size.map(f64::from);
    let scale = (RAYS / (width * height)).sqrt();
    [width, height].map(|n| ((n * scale).round() as u32).clamp(1, Film::WIDEST))
}

fn metered(clouds: &Picture, sky: Option<&Picture>, dimmest: f64) -> f64 {
    let lit = brighter_half(
        clouds.pixels.iter().map(|pixel| (brightest(pixel) / pixel[3].max(1e-3), opaque(pixel[3]))),
    );
    let clear = sky.and_then(|sky| {
        let behind = sky.pixels.iter().zip(&clouds.pixels);
        brighter_half(behind.map(|(sky, cloud)| (brightest(sky), 1.0 - cloud[3])))
    });
    let of_clouds = lit.map(|light| CLOUDS / light.max(dimmest));
    let day = |light: f64| (light / (BRIGHT_DAY * dimmest)).min(1.0);
    let of_sky = clear.map(|light| [LEAST_SKY * day(light), SKY].map(|shown| shown / light.max(dimmest)));
    let factor = match (of_clouds, of_sky) {
        (Some(clouds), Some([least, most])) => Some(clouds.clamp(least, most)),
        (clouds, sky) => clouds.or(sky.map(|[_, most]| most)),
    };
    factor.map_or(0.0, |factor| (factor / BASE).log2().clamp(-MOST, MOST))
}

/// The brightest channel of a pixel.
fn brightest(pixel: &[f32; 4]) -> f32 {
    pixel[0].max(pixel[1]).max(pixel[2])
}

/// Weight of a cloud of opacity `alpha`: what is thin shows what is behind.
fn opaque(alpha: f32) -> f32 {
    if alpha > 0.5 { alpha } else { 0.0 }
}

/// Logarithmic mean of the brighter half of `pixels`, given as brightness and weight, without the
/// brightest of them; none where they weigh next to nothing, or are black.
fn brighter_half(pixels: impl Iterator<Item = (f32, f32)>) -> Option<f64> {
    let mut pixels: Vec<_> = pixels.collect();
    let all = pixels.len() as f64;
    pixels.retain(|&(light, weight)| weight > 0.0 && light.is_finite());
    let total: f64 = pixels.iter().map(|pixel| f64::from(pixel.1)).sum();
    if total < LEAST_COVER * all || total <= 0.0 {
        return None;
    }
    pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [from, to] = COUNTED.map(|share| share * total);
    let (mut passed, mut sum) = (0.0, 0.0);
    for (light, weight) in pixels.into_iter().map(|(light, weight)| (f64::from(light), f64::from(weight))) {
        // The part of its weight that is between both shares.
        let counted = ((passed + weight).min(to) - passed.max(from)).max(0.0);
        sum += counted * light.max(0.1 * BLACK).ln();
        passed += weight;
    }
    Some((sum / (to - from)).exp()).filter(|light| *light > BLACK)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of `n` pixels of light and opacity.
    fn picture(n: usize, pixel: impl Fn(usize) -> (f32, f32)) -> Picture {
        let pixels = (0..n).map(pixel).map(|(light, alpha)| [light * alpha, 0.5 * light * alpha, 0.0, alpha]);
        Picture { width: n, height: 1, pixels: pixels.collect() }
    }

    #[test]
    fn even_clouds_come_out_just_below_white_whatever_their_light_and_their_veil() {
        for (light, alpha) in [(0.01, 1.0), (0.2, 0.7), (30.0, 0.51)] {
            let stops = metered_alone(&picture(100, |_| (light, alpha)));
            let shown = BASE * stops.exp2() * f64::from(light);
            assert!((shown - CLOUDS).abs() < 1e-6, "{light} {alpha}: {shown}");
        }
    }

    #[test]
    fn the_sun_and_the_shadows_do_not_count() {
        let even = metered_alone(&picture(100, |_| (0.2, 1.0)));
        let uneven = metered_alone(&picture(100, |i| {
            ([0.01, 0.2, 6e4][usize::from(i >= 49) + usize::from(i >= 96)], 1.0)
        }));
        assert!((even - uneven).abs() < 1e-6, "{even} {uneven}");
    }

    #[test]
    fn bright_sky_holds_back_dark_clouds_and_is_alone_where_there_are_none() {
        let sky = picture(100, |_| (0.3, 1.0));
        let by_sky = (SKY / (BASE * 0.3f64)).log2();
        for (dark, share) in [(0.05, 50), (0.05, 1), (0.05, 0)] {
            let clouds = picture(100, |i| if i < share { (dark, 1.0) } else { (0.0, 0.0) });
            let stops = metered(&clouds, Some(&sky), 0.0);
            assert!((stops - by_sky).abs() < 1e-6, "{share}: {stops} {by_sky}");
        }
    }

    #[test]
    fn clouds_brighter_than_the_sky_are_exposed_by_their_light_until_the_sky_is_too_dark() {
        let sky = picture(100, |_| (0.3, 1.0));
        for (light, shown) in [(0.42, CLOUDS / 0.42 * 0.3), (0.55, CLOUDS / 0.55 * 0.3), (6.0, LEAST_SKY)] {
            let clouds = picture(100, |i| if i < 50 { (light, 1.0) } else { (0.0, 0.0) });
            let sky_shown = BASE * metered(&clouds, Some(&sky), 0.0).exp2() * f64::from(0.3f32);
            assert!((sky_shown - shown).abs() < 1e-5, "{light}: {sky_shown}");
        }
    }

    #[test]
    fn night_stays_night_and_nothing_is_not_exposed() {
        let dim = picture(100, |_| (1e-5, 1.0));
        assert_eq!(metered(&dim, None, 1e-3), (CLOUDS / (BASE * 1e-3)).log2());
        assert_eq!(metered(&picture(100, |_| (0.0, 0.0)), None, 0.0), 0.0);
        assert_eq!(metered_alone(&picture(100, |_| (0.0, 1.0))), 0.0);
    }

    #[test]
    fn drafts_have_the_shape_of_the_picture_and_about_as_many_rays() {
        assert_eq!([[480, 270], [1920, 1080], [960, 540]].map(draft_size), [[128, 72]; 3]);
        assert_eq!(draft_size([8192, 1]), [8192, 1]);
        assert_eq!(draft_size([300, 300]), [96, 96]);
    }
}
