//! Errors of models on the corpus, and their means.

use super::{Entry, Errors, Reference, Relief, SIZE, Set, Truth, draw};
use crate::{
    Result,
    export::Picture,
    gpu::Gpu,
    render::{Film, Quality, Renderer, Transport},
};

/// A way of drawing: a model at a quality, by their names.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// Name and value of the model.
    pub model: (&'static str, Transport),
    /// Name and value of the quality.
    pub quality: (&'static str, Quality),
}

impl Way {
    /// Makes `renderer` draw this way.
    pub fn set(&self, renderer: &mut Renderer) {
        renderer.settings.transport = self.model.1;
        renderer.settings.quality = self.quality.1;
    }
}

/// Errors of one way of drawing on one picture.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Score {
    /// Name of the picture.
    pub scene: &'static str,
    /// What the picture may be used for.
    pub set: Set,
    /// Name of the model.
    pub model: &'static str,
    /// Name of the quality.
    pub quality: &'static str,
    /// The errors.
    #[serde(flatten)]
    pub errors: Errors,
}

/// A picture of the corpus as each model draws it in the last of the qualities, for people.
#[derive(Debug, Clone)]
pub struct View {
    /// The picture.
    pub entry: Entry,
    /// The reference as screens show it, RGBA of 8 bits.
    pub truth: Vec<u8>,
    /// What was drawn.
    pub drawn: Vec<Drawn>,
}

/// What one model drew.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Name of the model.
    pub model: &'static str,
    /// Relative RMSE.
    pub rmse: f64,
    /// The picture as screens show it, RGBA of 8 bits.
    pub picture: Vec<u8>,
    /// Error of each pixel's light as a share of its light; none beside the cloud.
    pub error: Vec<Option<f64>>,
}

/// Rays along an edge of a pixel, of all qualities: pictures as small as references have rims in a tenth of their
/// pixels, which single rays miss or meet, and large ones, which people look at, do not.
const RAYS: u32 = 3;

/// Scores every way of drawing on one picture; keeps what `shown`, a quality, draws.
///
/// # Errors
/// Where the device fails.
pub fn score(
    gpu: &Gpu,
    renderer: &mut Renderer,
    (entry, reference): (&Entry, &Reference),
    ways: &[Way],
    shown: &str,
    progress: &mut dyn FnMut(),
) -> Result<(Vec<Score>, View)> {
    let scene = &reference.scene;
    let sky = draw::sky(gpu, renderer, scene, SIZE)?;
    let (truth, relief) = (Truth { reference, sky: &sky }, Relief::new(reference));
    let finished = draw::finished(gpu, renderer, scene, &reference.picture, &sky)?;
    let (mut scores, mut drawn) = (Vec::new(), Vec::new());
    for way in ways {
        way.set(renderer);
        let picture = draw::clouds(gpu, renderer, scene, Film::new(SIZE, RAYS))?;
        let bytes = draw::finished(gpu, renderer, scene, &picture, &sky)?;
        let errors = truth.errors(&picture, [&finished, &bytes], &relief);
        let (model, quality) = (way.model.0, way.quality.0);
        scores.push(Score { scene: entry.name, set: entry.set, model, quality, errors });
        if quality == shown {
            let error = relative(&truth, &picture);
            drawn.push(Drawn { model, rmse: errors.rmse, picture: bytes, error });
        }
        progress();
    }
    Ok((scores, View { entry: *entry, truth: finished, drawn }))
}

fn relative(truth: &Truth<'_>, picture: &Picture) -> Vec<Option<f64>> {
    let share = |(light, difference): (f64, f64)| difference / light.max(1e-9);
    truth.differences(picture).into_iter().map(|found| found.map(share)).collect()
}

/// Means of the errors of one way of drawing over the pictures of a set.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Mean {
    /// Name of the model.
    pub model: &'static str,
    /// Name of the quality.
    pub quality: &'static str,
    /// The set.
    pub set: Set,
    /// How many pictures.
    pub scenes: usize,
    /// Means; `bias_error` is the standard error of the mean bias.
    #[serde(flatten)]
    pub errors: Errors,
    /// Mean of the absolute bias: those of both signs don't cancel in it.
    pub absolute_bias: f64,
    /// Root of the mean of the squared relative RMSE: no picture's noise is cut off in it, and bad
    /// pictures weigh more than in the mean of the RMSE.
    pub pooled_rmse: f64,
}

/// Means over each set, for every way of drawing that has scores there.
pub fn means(ways: &[Way], scores: &[Score]) -> Vec<Mean> {
    let all = ways.iter().flat_map(|way| [Set::Fit, Set::HeldOut].map(|set| (way, set)));
    all.filter_map(|(way, set)| {
        let (model, quality) = (way.model.0, way.quality.0);
        let of = |s: &&Score| (s.model, s.quality, s.set) == (model, quality, set);
        let errors: Vec<Errors> = scores.iter().filter(of).map(|score| score.errors).collect();
        let absolute_bias = mean(errors.iter().map(|e| e.bias.abs()))?;
        let pooled_rmse = mean(errors.iter().map(|e| e.relative_square))?.max(0.0).sqrt();
        let scenes = errors.len();
        Some(Mean { model, quality, set, scenes, errors: mean_of(&errors), absolute_bias, pooled_rmse })
    })
    .collect()
}

fn mean_of(errors: &[Errors]) -> Errors {
    let of = |value: fn(&Errors) -> f64| mean(errors.iter().map(value)).unwrap_or_default();
    Errors {
        rmse: of(|e| e.rmse),
        relative_square: of(|e| e.relative_square),
        mean_relative: of(|e| e.mean_relative),
        p95_relative: of(|e| e.p95_relative),
        bias: of(|e| e.bias),
        bias_error: (of(|e| e.bias_error * e.bias_error) / errors.len().max(1) as f64).sqrt(),
        bands: [0, 1, 2, 3].map(|band| mean(errors.iter().filter_map(|e| e.bands[band]))),
        contrast: [0, 1, 2].map(|scale| mean(errors.iter().filter_map(|e| e.contrast[scale]))),
        psnr: of(|e| e.psnr),
        flip: of(|e| e.flip),
    }
}

/// The mean; none of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_the_pictures_of_a_set() {
        let errors = |bias: f64, band: Option<f64>| Errors {
            rmse: bias.abs(),
            relative_square: bias * bias - 0.01,
            mean_relative: 0.0,
            p95_relative: 0.0,
            bias,
            bias_error: 0.3,
            bands: [band; 4],
            contrast: [band.map(|band| 2.0 * band), None, band],
            psnr: 30.0,
            flip: 0.1,
        };
        let way = Way { model: Transport::entries()[0], quality: Quality::PRESETS[0] };
        let score = |set, bias, band| Score {
            scene: "a",
            set,
            model: way.model.0,
            quality: way.quality.0,
            errors: errors(bias, band),
        };
        let scores =
            [score(Set::Fit, 0.1, Some(0.5)), score(Set::Fit, -0.3, None), score(Set::HeldOut, 9.0, None)];
        let found = means(&[way], &scores);
        assert_eq!((found.len(), found[0].scenes, found[1].scenes), (2, 2, 1));
        assert!((found[0].errors.bias + 0.1).abs() < 1e-12 && (found[0].absolute_bias - 0.2).abs() < 1e-12);
        assert_eq!(found[0].errors.bands, [Some(0.5); 4]);
        assert_eq!(found[0].errors.contrast, [Some(1.0), None, Some(0.5)]);
        assert!((found[0].pooled_rmse - 0.04f64.sqrt()).abs() < 1e-12);
        // Two independent errors of 0.3.
        assert!((found[0].errors.bias_error - 0.3 / 2f64.sqrt()).abs() < 1e-12);
    }
}
