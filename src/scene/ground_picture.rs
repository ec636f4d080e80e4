//! A picture of the ground from above.

use std::{fmt, path::Path, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    pixels::{self, FromFile},
    validate::{At, COORDINATE, Limits},
};
use crate::{Error, Result, srgb};

const WIDTH: Limits = Limits::new(10.0, 1e7, "metres");

/// A picture of the ground from above, whose colours are the share of light that it reflects; around it the ground is even.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GroundPicture {
    /// The file: PNG, as screens show it, or EXR, linear; from the folder of the scene's file on. North is up.
    pub file: String,
    /// From its western to its eastern edge, metres, 10 to 10000000. Pixels are as high as wide.
    #[schemars(range(min = WIDTH.min, max = WIDTH.max), extend("unit" = WIDTH.unit))]
    pub width: f64,
    /// Where its middle is to the east, metres, -10000000 to 10000000.
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub x: f64,
    /// Where its middle is to the south, metres, -10000000 to 10000000.
    #[schemars(range(min = COORDINATE.min, max = COORDINATE.max), extend("unit" = COORDINATE.unit))]
    pub z: f64,
    /// What was read of the file.
    #[serde(skip)]
    pub(crate) opened: FromFile<GroundColors>,
}

/// What a picture of the ground reflects: rows from north to south of bytes as sRGB has them, at most 1024 pixels along an
/// edge.
#[derive(Clone, PartialEq, Eq)]
pub struct GroundColors {
    width: usize,
    texels: Vec<[u8; 4]>,
}

impl fmt::Debug for GroundColors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "GroundColors({} x {})", self.width, self.texels.len() / self.width)
    }
}

impl Default for GroundPicture {
    fn default() -> Self {
        Self { file: String::new(), width: 20_000.0, x: 0.0, z: 0.0, opened: FromFile::default() }
    }
}

impl GroundColors {
    /// Longest edge of a file's picture, pixels.
    const MOST_READ: usize = 16_384;
    /// Longest edge of what is kept, pixels.
    pub const MOST: usize = 1024;

    /// Linear colours, 0 to 1, of so many pixels in a row; values beyond count as those. What is larger than 1024 pixels is
    /// halved until it is not.
    ///
    /// # Errors
    /// Where there are none, or the rows are not whole.
    pub fn new(width: usize, mut colors: Vec<[f32; 3]>) -> Result<Self> {
        let (mut width, mut height) = (width, colors.len().checked_div(width).unwrap_or(0));
        if height == 0 || width * height != colors.len() {
            let count = colors.len();
            return Err(Error::Argument(format!(
                "{count} colours are no picture that is {width} pixels wide"
            )));
        }
        while width.max(height) > Self::MOST {
            colors = halved(&colors, [width, height]);
            (width, height) = (width.div_ceil(2), height.div_ceil(2));
        }
        let texels = colors
            .iter()
            .map(|&[r, g, b]| [r, g, b].map(srgb::byte))
            .map(|[r, g, b]| [r, g, b, 255])
            .collect();
        Ok(Self { width, texels })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.texels.len() / self.width]
    }

    /// Its linear colours.
    pub(crate) fn linear(&self) -> Vec<[f32; 3]> {
        let linear: Vec<f32> = (0..256).map(|i| srgb::decoded(f64::from(i) / 255.0) as f32).collect();
        self.texels.iter().map(|&[r, g, b, _]| [r, g, b].map(|byte| linear[usize::from(byte)])).collect()
    }
}

/// Means over two by two; an odd row or column is doubled.
fn halved(colors: &[[f32; 3]], [width, height]: [usize; 2]) -> Vec<[f32; 3]> {
    let at = |x: usize, y: usize| colors[y.min(height - 1) * width + x.min(width - 1)];
    let mean = |x: usize, y: usize| {
        let four = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
        std::array::from_fn(|c| 0.25 * four.iter().map(|rgb| rgb[c]).sum::<f32>())
    };
    let rows = 0..height.div_ceil(2);
    rows.flat_map(|y| (0..width.div_ceil(2)).map(move |x| mean(2 * x, 2 * y))).collect()
}

impl GroundPicture {
    /// A picture of these colours, which stand in for those of its file.
    #[must_use]
    pub fn with_colors(mut self, colors: GroundColors) -> Self {
        self.opened.found = Some(Arc::new(colors));
        self
    }

    /// What was read of its file: [`Scene::load`](super::Scene::load) reads that.
    pub fn colors(&self) -> Option<&Arc<GroundColors>> {
        self.opened.found.as_ref()
    }

    /// Takes over what another one has read, where that is the same file.
    pub(super) fn take_colors_of(&mut self, other: &Self) {
        if self.file == other.file {
            self.opened = other.opened.clone();
        }
    }

    /// Reads its file, whose path starts from `folder`.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Format`] where it can't be read or is no picture.
    pub fn read(&mut self, folder: &Path) -> Result<()> {
        let pixels = pixels::read(&folder.join(&self.file), GroundColors::MOST_READ)?;
        let mut colors = pixels.values;
        if pixels.is_encoded {
            let linear = |x: f32| srgb::decoded(f64::from(x)) as f32;
            colors.iter_mut().for_each(|rgb| *rgb = rgb.map(linear));
        }
        let found = Some(Arc::new(GroundColors::new(pixels.width, colors)?));
        self.opened = FromFile { found, folder: folder.to_owned() };
        Ok(())
    }

    /// The same picture in a scene whose file is in `folder`.
    pub(super) fn written_from(&self, folder: &Path) -> Self {
        Self { file: self.opened.written_from(folder, &self.file), ..self.clone() }
    }

    pub(super) fn check(&self, at: At) -> Result<()> {
        if self.file.is_empty() && self.opened.found.is_none() {
            return Err(at.field("file").problem("it is empty: name the picture of the ground"));
        }
        at.field("width").number(self.width, WIDTH)?;
        at.field("x").number(self.x, COORDINATE)?;
        at.field("z").number(self.z, COORDINATE)
    }

    /// What is wrong with a picture that is to be drawn and was not read.
    pub(crate) fn unread(&self) -> Error {
        Error::Argument(format!(
            "the picture `{}` of the ground was not read: load the scene from its file, or read it by `Scene::read_volumes`",
            self.file
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_halved_and_keep_their_light() {
        let colors = (0..4100 * 3).map(|i| [if i % 2 == 0 { 0.5 } else { 0.1 }; 3]).collect();
        let picture = GroundColors::new(4100, colors).unwrap();
        assert_eq!(picture.size(), [1025usize.div_ceil(2), 1]);
        let light = picture.linear()[7][0];
        assert!((light - 0.3).abs() < 0.003, "{light}");
        assert!(
            GroundColors::new(0, Vec::new()).is_err() && GroundColors::new(2, vec![[0.0; 3]; 3]).is_err()
        );
    }
}
