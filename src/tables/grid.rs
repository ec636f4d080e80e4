//! Tables over grids of any number of axes, in half floats: how the tables of slabs are kept.

use half::f16;

use super::bytes::{Reader, seal, whole};
use crate::{Error, Result};

/// Begins every file of grids.
const MAGIC: [u8; 8] = *b"nephoGRD";

/// Layout of the file, told in `tables/README.md`.
const VERSION: u32 = 1;

/// The values that a variable has in a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What varies.
    pub name: String,
    /// Its values, rising or falling.
    pub values: Vec<f32>,
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// What it tells.
    pub name: String,
    /// What it depends on: the last axis is the one that varies fastest in `values`.
    pub axes: Vec<Axis>,
    /// Numbers at each point of the grid; they are neighbours in `values`.
    pub channels: usize,
    /// All numbers.
    pub values: Vec<f16>,
}

/// The tables of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grids(pub Vec<Grid>);

impl Axis {
    /// An axis of `name` with `values`.
    pub fn new(name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        Self { name: name.to_owned(), values: values.into_iter().map(|v| v as f32).collect() }
    }
}

impl Grid {
    /// A table of `values`, by the axes in their order, channels fastest.
    pub fn new(name: &str, axes: Vec<Axis>, channels: usize, values: impl IntoIterator<Item = f64>) -> Self {
        let values = values.into_iter().map(f16::from_f64).collect();
        Self { name: name.to_owned(), axes, channels, values }
    }

    /// Where the numbers of the point with these indices begin in `values`.
    pub fn place(&self, indices: &[usize]) -> usize {
        let point = self.axes.iter().zip(indices).fold(0, |at, (axis, i)| at * axis.values.len() + i);
        point * self.channels
    }

    /// Channel `channel`, linear in the index between points: `position` counts points of
    /// each axis from its first, and is kept within them.
    pub fn linear(&self, position: &[f64], channel: usize) -> f64 {
        let ends: Vec<(usize, f64)> = self
            .axes
            .iter()
            .zip(position)
            .map(|(axis, at)| {
                let at = at.clamp(0.0, (axis.values.len() - 1) as f64);
                let low = (at.floor() as usize).min(axis.values.len().saturating_sub(2));
                (low, at - low as f64)
            })
            .collect();
        (0..1_usize << ends.len())
            .map(|corner| {
                let high = |i: usize| corner >> i & 1;
                let weight: f64 = ends
                    .iter()
                    .enumerate()
                    .map(|(i, (_, share))| if high(i) == 1 { *share } else { 1.0 - share })
                    .product();
                if weight == 0.0 {
                    return 0.0;
                }
                let indices: Vec<usize> =
                    ends.iter().enumerate().map(|(i, (low, _))| low + high(i)).collect();
                weight * self.values[self.place(&indices) + channel].to_f64()
            })
            .sum()
    }

    fn points(&self) -> Option<usize> {
        let lengths = self.axes.iter().map(|axis| axis.values.len());
        lengths.chain([self.channels]).try_fold(1_usize, usize::checked_mul)
    }
}

impl Grids {
    /// The table of a name.
    pub fn named(&self, name: &str) -> Option<&Grid> {
        self.0.iter().find(|grid| grid.name == name)
    }

    /// Reads the bytes of the file `file` of `tables/`, checking that it is whole.
    ///
    /// # Errors
    /// [`Error::Table`] with what is wrong.
    pub fn decode(file: &'static str, bytes: &[u8]) -> Result<Self> {
        Self::read(bytes).map_err(|problem| Error::Table { name: file, problem })
    }

    /// The same; the error is what is wrong, without the name.
    pub(super) fn read(bytes: &[u8]) -> std::result::Result<Self, String> {
        read(bytes)
    }

    /// The bytes of a file.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        let number = |bytes: &mut Vec<u8>, n: usize| bytes.extend((n as u32).to_le_bytes());
        let text = |bytes: &mut Vec<u8>, text: &str| {
            bytes.extend((text.len() as u32).to_le_bytes());
            bytes.extend(text.as_bytes());
        };
        number(&mut bytes, VERSION as usize);
        number(&mut bytes, self.0.len());
        for grid in &self.0 {
            text(&mut bytes, &grid.name);
            number(&mut bytes, grid.channels);
            number(&mut bytes, grid.axes.len());
            for axis in &grid.axes {
                text(&mut bytes, &axis.name);
                number(&mut bytes, axis.values.len());
                bytes.extend(axis.values.iter().flat_map(|v| v.to_le_bytes()));
            }
            bytes.extend(grid.values.iter().flat_map(|v| v.to_le_bytes()));
        }
        seal(bytes)
    }
}

fn read(bytes: &[u8]) -> std::result::Result<Grids, String> {
    let content = whole(bytes, &MAGIC)?;
    let mut reader = Reader(&content[MAGIC.len()..]);
    let version = reader.u32().ok_or("ends before its version")?;
    if version != VERSION {
        return Err(format!("has version {version}: this program reads version {VERSION}"));
    }
    let count = reader.u32().ok_or("ends before its number of tables")?;
    let grids = (0..count)
        .map(|i| grid(&mut reader).ok_or_else(|| format!("ends within its table {i}")))
        .collect::<std::result::Result<_, _>>()?;
    if !reader.0.is_empty() {
        return Err(format!("has {} bytes after its last table", reader.0.len()));
    }
    Ok(Grids(grids))
}

/// `None` where bytes end early; nothing is set aside for more numbers than there are bytes.
fn grid(reader: &mut Reader<'_>) -> Option<Grid> {
    let name = reader.text()?.to_owned();
    let channels = reader.u32()? as usize;
    let count = reader.u32()?;
    let axes = (0..count).map(|_| axis(reader)).collect::<Option<Vec<_>>>()?;
    let mut grid = Grid { name, axes, channels, values: Vec::new() };
    let points = grid.points()?;
    if points > reader.0.len() / size_of::<f16>() {
        return None;
    }
    grid.values = (0..points).map(|_| reader.f16()).collect::<Option<_>>()?;
    Some(grid)
}

fn axis(reader: &mut Reader<'_>) -> Option<Axis> {
    let name = reader.text()?.to_owned();
    let count = reader.u32()? as usize;
    if count == 0 || count > reader.0.len() / size_of::<f32>() {
        return None;
    }
    Some(Axis { name, values: (0..count).map(|_| reader.f32()).collect::<Option<_>>()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Axes of unequal sizes, so that a wrong stride shows.
    fn grids() -> Grids {
        let axes = vec![Axis::new("a", [0.0, 1.0, 4.0]), Axis::new("b", [1.0, 2.0])];
        let values = (0..12).map(|i| f64::from(i) * 0.5);
        Grids(vec![
            Grid::new("one", axes, 2, values),
            Grid::new("two", vec![Axis::new("c", [7.0])], 1, [3.0]),
        ])
    }

    #[test]
    fn what_is_written_is_read() {
        let read = Grids::decode("test.bin", &grids().encode()).unwrap();
        assert_eq!(read, grids());
    }

    #[test]
    fn every_damage_is_an_error_that_names_the_file() {
        let good = grids().encode();
        for i in 0..good.len() {
            let mut bad = good.clone();
            bad[i] ^= 0x40;
            let error = Grids::decode("test.bin", &bad).unwrap_err().to_string();
            assert!(error.contains("test.bin"), "{error}");
            assert!(Grids::decode("test.bin", &good[..i]).is_err(), "{i} bytes");
        }
    }

    #[test]
    fn sizes_beyond_the_file_are_refused() {
        let mut bytes = MAGIC.to_vec();
        for number in [VERSION, 1, 0, u32::MAX, 1, 0, u32::MAX] {
            bytes.extend(number.to_le_bytes());
        }
        assert!(Grids::decode("test.bin", &seal(bytes)).is_err());
    }

    #[test]
    fn between_points_it_is_linear() {
        let all = grids();
        let grid = all.named("one").unwrap();
        assert_eq!(grid.linear(&[2.0, 1.0], 1), 5.5);
        assert_eq!(grid.linear(&[0.5, 0.25], 0), 0.5 * 2.0 + 0.25 * 1.0);
        assert_eq!(grid.linear(&[-3.0, 9.0], 1), grid.linear(&[0.0, 1.0], 1), "beyond the ends");
    }
}
