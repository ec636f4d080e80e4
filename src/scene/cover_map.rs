//! A painted map of what a layer covers.

use std::{fmt, path::Path, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{At, Limits};
use super::{
    Layer,
    pixels::{self, FromFile},
};
use crate::{Error, Result};

const SIZE: Limits = Limits::new(100.0, 1e6, "metres");
/// Heaps along its edge, at most: there are 1024 texels for them.
const MOST_HEAPS: f64 = 96.0;

/// A picture of what a layer covers: over a square, and over those beside it again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CoverMap {
    /// The file: PNG, whose grey counts as it is written, or EXR; from the folder of the scene's file on. North is up.
    pub file: String,
    /// Edge of the square that the picture is stretched to, metres, 100 to 1000000: up to 96 scales of the layer. Its middle is
    /// at the layer's offset.
    #[schemars(range(min = SIZE.min, max = SIZE.max), extend("unit" = SIZE.unit))]
    pub size: f64,
    /// What was read of the file.
    #[serde(skip)]
    pub(crate) opened: FromFile<Cover>,
}

impl Default for CoverMap {
    fn default() -> Self {
        Self { file: String::new(), size: 20_000.0, opened: FromFile::default() }
    }
}

/// Painted cover, from 0 to 1, rows from north to south.
#[derive(Clone, PartialEq)]
pub struct Cover {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl fmt::Debug for Cover {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Cover({} x {})", self.width, self.height)
    }
}

impl Cover {
    /// Longest edge of a picture, pixels.
    pub const MOST: usize = 8192;

    /// A picture of so many pixels in a row; values beyond 0 and 1 count as those, and what is no number as 0.
    ///
    /// # Errors
    /// Where there are none, the rows are not whole, or there are too many.
    pub fn new(width: usize, values: Vec<f32>) -> Result<Self> {
        let height = values.len().checked_div(width).unwrap_or(0);
        if height == 0 || width * height != values.len() {
            let count = values.len();
            return Err(Error::Argument(format!(
                "{count} values are no picture that is {width} pixels wide"
            )));
        }
        if width.max(height) > Self::MOST {
            let most = Self::MOST;
            return Err(Error::Argument(format!(
                "a map of {width} x {height} pixels is too large: scale it to {most} x {most} at most"
            )));
        }
        let values = values.into_iter().map(|x| if x > 0.0 { x.min(1.0) } else { 0.0 }).collect();
        Ok(Self { width, height, values })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Its mean.
    pub fn mean(&self) -> f64 {
        self.values.iter().map(|&value| f64::from(value)).sum::<f64>() / self.values.len() as f64
    }

    /// Means over `count` by `count` squares that it is cut into; where it has fewer pixels, between their middles.
    pub(crate) fn squares(&self, count: usize) -> Vec<f32> {
        let columns = weights(self.width, count);
        let rows = weights(self.height, count);
        let narrow: Vec<f32> = self
            .values
            .chunks(self.width)
            .flat_map(|row| columns.iter().map(|parts| parts.iter().map(|&(x, w)| w * row[x]).sum::<f32>()))
            .collect();
        let down =
            |parts: &[(usize, f32)], x: usize| parts.iter().map(|&(y, w)| w * narrow[y * count + x]).sum();
        rows.iter().flat_map(|parts| (0..count).map(move |x| down(parts, x)).collect::<Vec<f32>>()).collect()
    }
}

/// Of which of `pixels` in a row each of `count` parts of it is the mean, and by what weights.
fn weights(pixels: usize, count: usize) -> Vec<Vec<(usize, f32)>> {
    let ratio = pixels as f64 / count as f64;
    let part = |i: usize| -> Vec<(usize, f32)> {
        if ratio <= 1.0 {
            // Between the middles of two, round about.
            let at = (i as f64 + 0.5) * ratio - 0.5 + pixels as f64;
            let (first, share) = (at.floor(), (at - at.floor()) as f32);
            let like = |x: f64| x as usize % pixels;
            return vec![(like(first), 1.0 - share), (like(first + 1.0), share)];
        }
        let (low, high) = (i as f64 * ratio, (i + 1) as f64 * ratio);
        let covered = |x: usize| ((x + 1) as f64).min(high) - (x as f64).max(low);
        let last = (high.ceil() as usize).min(pixels);
        (low as usize..last).map(|x| (x, (covered(x) / ratio) as f32)).filter(|(_, w)| *w > 0.0).collect()
    };
    (0..count).map(part).collect()
}

impl CoverMap {
    /// A map of this picture, which stands in for that of its file.
    #[must_use]
    pub fn with_cover(mut self, cover: Cover) -> Self {
        self.opened.found = Some(Arc::new(cover));
        self
    }

    /// Whether a file has the name of a picture: .png or .exr.
    pub fn is_named(path: &Path) -> bool {
        pixels::is_named(path)
    }

    /// What was read of its file: [`Scene::load`](super::Scene::load) reads that.
    pub fn cover(&self) -> Option<&Arc<Cover>> {
        self.opened.found.as_ref()
    }

    /// Takes over what another one has read, where that is the same file.
    pub(crate) fn take_cover_of(&mut self, other: &Self) {
        if self.file == other.file {
            self.opened = other.opened.clone();
        }
    }

    /// How often heaps of a layer repeat themselves along its edge, and it along the period of the layer: one of both is 1.
    pub(crate) fn repeats(&self, scale: f64) -> [usize; 2] {
        let periods = self.size / (Layer::PERIOD * scale);
        [periods, 1.0 / periods].map(|count| count.round().max(1.0) as usize)
    }

    /// Reads its file, whose path starts from `folder`.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where it can't be read or is no picture.
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        let cover = cover_of(&folder.join(&self.file))?;
        self.opened = FromFile { found: Some(Arc::new(cover)), folder: folder.to_owned() };
        Ok(())
    }

    /// The same map in a scene whose file is in `folder`.
    pub(super) fn written_from(&self, folder: &Path) -> Self {
        Self { file: self.opened.written_from(folder, &self.file), ..self.clone() }
    }

    pub(super) fn check(&self, at: At, scale: f64) -> Result<()> {
        if self.file.is_empty() && self.opened.found.is_none() {
            return Err(at.field("file").problem("it is empty: name the picture of what is covered"));
        }
        at.field("size").number(self.size, SIZE)?;
        let most = MOST_HEAPS * scale;
        if self.size > most {
            let (size, needed) = (self.size, self.size / MOST_HEAPS);
            return Err(at.field("size").problem(format!(
                "{size} metres are more than {MOST_HEAPS} scales of the layer: make it {most} at most, or `scale` {needed:.0} at least"
            )));
        }
        Ok(())
    }

    /// What is wrong with a map that is to be drawn and was not read.
    pub(crate) fn unread(&self) -> Error {
        Error::Argument(format!(
            "the map `{}` was not read: load the scene from its file, or read it by `Scene::read_volumes`",
            self.file
        ))
    }
}

/// Grey as it is written.
fn cover_of(path: &Path) -> Result<Cover> {
    let pixels = pixels::read(path, Cover::MOST)?;
    let grey = pixels.values.iter().map(|rgb| rgb.iter().sum::<f32>() / 3.0).collect();
    Cover::new(pixels.width, grey)
        .map_err(|error| Error::Format { path: path.to_owned(), problem: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_keep_the_mean_whatever_the_picture_s_size() {
        for (width, height) in [(1, 1), (3, 5), (16, 16), (50, 37)] {
            let values = (0..width * height).map(|i| (i * 7919 % 101) as f32 / 100.0).collect();
            let cover = Cover::new(width, values).unwrap();
            let squares = cover.squares(16);
            let mean = squares.iter().map(|&value| f64::from(value)).sum::<f64>() / 256.0;
            assert!((mean - cover.mean()).abs() < 0.03, "{width} x {height}: {mean} for {}", cover.mean());
        }
    }

    #[test]
    fn a_picture_without_pixels_or_with_too_many_is_refused() {
        let problem =
            |width: usize, count: usize| Cover::new(width, vec![0.5; count]).unwrap_err().to_string();
        assert!(problem(0, 0).contains("no picture") && problem(3, 10).contains("no picture"));
        assert!(problem(9000, 9000).contains("8192"), "{}", problem(9000, 9000));
    }
}
