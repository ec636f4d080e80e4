//! NetCDF: output of the weather model WRF, by its own names, and plain grids by theirs.

mod column;
mod plain;
mod wrf;

use std::{path::Path, sync::Arc};

use netcdf_reader::{FileStorage, NcFile, NcOpenOptions, NcSliceInfo, NcSliceInfoElem, NcVariable};

use self::plain::Plain;
use super::{bytes::Problem, volume::Found};
use crate::scene::{Grid, Species};

/// What files begin with: the classic formats, and HDF5.
const HEADS: [&[u8]; 2] = [b"CDF", b"\x89HDF\r\n\x1a\n"];
/// Most bytes that one variable may take, unpacked.
const MOST_BYTES: usize = 1 << 31;

/// What a grid of a weather model is made of, by its name, and the effective radius, um, that its extinction stands on.
pub fn species_of(grid: &str) -> Option<(Species, f64)> {
    wrf::KINDS.iter().find(|(name, ..)| *name == grid).map(|(_, species, radius_um)| (*species, *radius_um))
}

pub(super) fn is_one(bytes: &[u8]) -> bool {
    HEADS.iter().any(|head| bytes.starts_with(head))
}

/// Opens a file, of which only what is asked for is read.
pub(super) fn open(path: &Path) -> Result<NcFile, Problem> {
    let storage = FileStorage::open(path).map_err(unreadable)?;
    NcFile::from_storage_with_options(Arc::new(storage), options()).map_err(unreadable)
}

/// Opens the bytes of a file.
pub(super) fn open_bytes(bytes: &[u8]) -> Result<NcFile, Problem> {
    NcFile::from_bytes_with_options(bytes, options()).map_err(unreadable)
}

fn options() -> NcOpenOptions {
    NcOpenOptions { max_read_bytes: MOST_BYTES, ..Default::default() }
}

fn unreadable(error: impl std::fmt::Display) -> Problem {
    format!("is no NetCDF file that can be read ({error}): copy or write it again")
}

/// How many times there are.
pub(super) fn times(file: &NcFile) -> Result<i32, Problem> {
    let of_weather = waters(file).next().and_then(|variable| variable.shape().first().copied());
    let times = match of_weather {
        Some(times) => Some(times),
        None => Plain::all(file)?.iter().map(Plain::times).max(),
    };
    times.and_then(|times| i32::try_from(times).ok()).ok_or_else(|| no_water(file))
}

/// Water by WRF's names.
fn waters(file: &NcFile) -> impl Iterator<Item = &NcVariable> {
    wrf::KINDS.iter().filter_map(|(name, ..)| file.variable(name).ok())
}

fn no_water(file: &NcFile) -> Problem {
    let names =
        file.variables().map(|all| all.iter().map(|variable| variable.name().to_owned()).collect::<Vec<_>>());
    format!(
        "has no water by WRF's names ({}) and nothing over height, y and x: it has {}",
        wrf::KINDS.map(|(name, ..)| name).join(", "),
        names.unwrap_or_default().join(", ")
    )
}

/// The water at the time `step` (0 is the first): of WRF all of it, as `density`, and each kind; else each variable over
/// three axes, of which one may be `wanted`.
pub(super) fn read(file: NcFile, step: u32, wanted: Option<&str>) -> Result<Vec<Found>, Problem> {
    if waters(&file).next().is_some() {
        return weather(file, step);
    }
    let all = Plain::all(&file)?;
    if all.is_empty() {
        return Err(no_water(&file));
    }
    let found = all.iter().map(|plain| {
        let is_wanted = wanted.is_none_or(|wanted| wanted == plain.name());
        let grid = if is_wanted { plain.grid(step) } else { Err("was not asked for".to_owned()) };
        Found { name: plain.name().to_owned(), kind: plain.unit(), grid }
    });
    Ok(found.collect())
}

fn weather(file: NcFile, step: u32) -> Result<Vec<Found>, Problem> {
    let weather = wrf::Weather::read(&Source { file, step })?;
    let mut found: Vec<Found> = Vec::new();
    for kind in weather.kinds() {
        found.push(Found {
            name: kind.to_owned(),
            kind: "extinction".to_owned(),
            grid: weather.grid(&[kind], kind),
        });
    }
    let all: Vec<&str> = weather.kinds().collect();
    let grid: Result<Grid, Problem> = weather.grid(&all, "density");
    found.insert(0, Found { name: "density".to_owned(), kind: "extinction".to_owned(), grid });
    Ok(found)
}

/// A file at one of its times.
struct Source {
    file: NcFile,
    step: u32,
}

/// Numbers over levels, rows from south to north, and columns from west to east, the last fastest.
struct Field {
    size: [usize; 3],
    values: Vec<f64>,
}

impl Source {
    /// A variable over time, levels, rows and columns, or without levels; `None` where there is none of that name.
    fn field(&self, name: &str) -> Result<Option<Field>, Problem> {
        let Ok(variable) = self.file.variable(name) else { return Ok(None) };
        let shape: Vec<u64> = variable.shape();
        let ([times, ..], 3 | 4) = (shape.as_slice(), shape.len()) else {
            return Err(format!(
                "has `{name}` over {} dimensions, and WRF has it over time, levels, rows and columns: give WRF's own output",
                shape.len()
            ));
        };
        if u64::from(self.step) >= *times {
            return Err(format!(
                "has {times} times, and time {} is asked for: give `step` from 0 to {}",
                self.step,
                times.saturating_sub(1)
            ));
        }
        let mut selections = vec![NcSliceInfoElem::Index(self.step.into())];
        let all = NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 };
        selections.extend(shape[1..].iter().map(|_| all.clone()));
        let read = self.file.read_variable_slice_as_f64(name, &NcSliceInfo { selections });
        let values: Vec<f64> = read.map_err(|error| damaged(name, &error))?.iter().copied().collect();
        let size = match *shape.as_slice() {
            [_, levels, rows, columns] => [levels, rows, columns],
            [_, rows, columns] => [1, rows, columns],
            _ => [0; 3],
        };
        let size = size.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        if size.iter().try_fold(1usize, |all, n| all.checked_mul(*n)) != Some(values.len()) {
            return Err(format!("has `{name}` in a size that it does not tell: write it again"));
        }
        Ok(Some(Field { size, values }))
    }

    /// A variable that must be there, in just this size.
    fn needed(&self, name: &str, size: Option<[usize; 3]>) -> Result<Field, Problem> {
        let field = self.field(name)?.ok_or_else(|| {
            format!("has no `{name}`, which tells where its water is: give WRF's own output with all of P, PB, PH, PHB and T")
        })?;
        match size {
            Some(size) if size != field.size => Err(format!(
                "has `{name}` in {:?} levels, rows and columns, and {size:?} are needed: write it again",
                field.size
            )),
            _ => Ok(field),
        }
    }

    /// A number of the whole file.
    fn number(&self, name: &str) -> Result<f64, Problem> {
        let found = self.file.global_attribute(name).ok().and_then(|attribute| attribute.value.as_f64());
        found.ok_or_else(|| format!("has no attribute `{name}`: give WRF's own output"))
    }
}

fn damaged(what: &str, error: &dyn std::fmt::Display) -> Problem {
    format!("does not give {what} ({error}): copy or write it again")
}
