//! Volumes of any format.

use std::{
    fs::{self, File},
    io::Read,
    path::Path,
};

use super::{
    bytes::Problem,
    netcdf,
    raw::{self, Raw},
    vdb, vol,
};
use crate::{
    Error, Result,
    scene::{Grid, Velocity},
};

/// A grid in a file.
#[derive(Debug, Clone)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// The type of its values, as its format calls it.
    pub kind: String,
    /// Itself, or why it can't be drawn: the rest of a sentence about the file.
    pub grid: std::result::Result<Grid, String>,
}

/// What is wanted of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Choice<'a> {
    /// Name of the grid, as [`choose`] takes it.
    pub grid: Option<&'a str>,
    /// How floats lie in a file that holds nothing else.
    pub raw: Option<Raw>,
    /// Which of its times, where a file holds several: 0 is the first.
    pub step: u32,
}

/// Name of the grid that is taken where none is named and there are several.
const USUAL: &str = "density";

/// All grids of a volume's file, whichever is chosen: OpenVDB, Mitsuba's .vol, NetCDF, or floats.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where it can't be read or is no volume.
pub fn found_in(path: &Path, choice: &Choice<'_>) -> Result<Vec<Found>> {
    all_in(path, &Choice { grid: None, ..*choice })
}

/// The grid of a volume's file that is chosen.
///
/// # Errors
/// As [`found_in`], and where there is no such grid.
pub fn read_volume(path: &Path, choice: &Choice<'_>) -> Result<Grid> {
    choose(all_in(path, choice)?, choice.grid)
        .map_err(|problem| Error::Format { path: path.to_owned(), problem })
}

/// How fast what is in a volume's file goes, where that tells it: OpenVDB with a grid `vel`, `v` or `velocity`.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where it can't be read.
pub(crate) fn velocity_in(path: &Path) -> Result<Option<Velocity>> {
    if !vdb::is_one(&head(path)?) {
        return Ok(None);
    }
    vdb::velocity(&content(path)?).map_err(|problem| Error::Format { path: path.to_owned(), problem })
}

/// How many times a volume's file holds.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where it is no file that holds any number of them.
pub(crate) fn times_in(path: &Path) -> Result<i32> {
    let refused = |problem| Error::Format { path: path.to_owned(), problem };
    if !netcdf::is_one(&head(path)?) {
        return Err(refused("holds one time, and a `sequence` goes through several: name its files with #### in place of their \
                            number, such as storm.####.vdb, or leave it out".to_owned()));
    }
    netcdf::open(path).and_then(|file| netcdf::times(&file)).map_err(refused)
}

fn all_in(path: &Path, choice: &Choice<'_>) -> Result<Vec<Found>> {
    let found = match choice.raw.is_none() && netcdf::is_one(&head(path)?) {
        // Of a file of many times only one is read.
        true => netcdf::open(path).and_then(|file| netcdf::read(file, choice.step, choice.grid)),
        false => all(&content(path)?, choice),
    };
    found.map_err(|problem| Error::Format { path: path.to_owned(), problem })
}

/// The same of the bytes of a file.
///
/// # Errors
/// The rest of a sentence about the file.
pub fn parse_volume(bytes: &[u8], choice: &Choice<'_>) -> std::result::Result<Grid, String> {
    choose(all(bytes, choice)?, choice.grid)
}

/// The grid of this name; where there is none, the only one that can be drawn, or `density`.
///
/// # Errors
/// The rest of a sentence about the file.
pub fn choose(found: Vec<Found>, name: Option<&str>) -> std::result::Result<Grid, String> {
    let names = || found.iter().map(|found| format!("`{}`", found.name)).collect::<Vec<_>>().join(", ");
    let named = |name: &str| found.iter().position(|found| found.name == name);
    let mut good = found.iter().enumerate().filter(|(_, found)| found.grid.is_ok()).map(|(i, _)| i);
    let chosen = match name {
        Some(name) if !found.is_empty() => {
            named(name).ok_or_else(|| format!("has no grid `{name}`: it has {}", names()))?
        }
        _ => match (named(USUAL), good.next(), good.next()) {
            (Some(usual), ..) => usual,
            (None, Some(_), Some(_)) => {
                return Err(format!("has several grids, and none is `{USUAL}`: name one of {}", names()));
            }
            (None, only, _) => only.unwrap_or(0),
        },
    };
    let grid = found.into_iter().nth(chosen).map(|found| found.grid);
    grid.unwrap_or_else(|| Err("has no grid: export it with one".to_owned()))
}

fn all(bytes: &[u8], choice: &Choice<'_>) -> std::result::Result<Vec<Found>, Problem> {
    let alone =
        |grid: Grid| vec![Found { name: grid.name.clone(), kind: "float".to_owned(), grid: Ok(grid) }];
    if choice.step > 0 && !netcdf::is_one(bytes) {
        return Err(format!("has one time, 0, and not {}: only NetCDF holds several", choice.step));
    }
    if let Some(raw) = &choice.raw {
        return raw::read(bytes, raw).map(alone);
    }
    if vdb::is_one(bytes) {
        return vdb::read(bytes, choice.grid);
    }
    if vol::is_one(bytes) {
        return vol::read(bytes).map(alone);
    }
    if netcdf::is_one(bytes) {
        return netcdf::read(netcdf::open_bytes(bytes)?, choice.step, choice.grid);
    }
    Err("is no volume that is read: give OpenVDB (.vdb), Mitsuba's .vol, NetCDF, or floats with their `raw` size".to_owned())
}

/// Bytes of a file. Devices and pipes, which may have no end, are refused.
fn content(path: &Path) -> Result<Vec<u8>> {
    begin(path, u64::MAX)
}

/// What a file begins with, by which its format is known.
fn head(path: &Path) -> Result<Vec<u8>> {
    begin(path, 8)
}

fn begin(path: &Path, most: u64) -> Result<Vec<u8>> {
    let failed = |source| Error::File { action: "read", path: path.to_owned(), source };
    if !fs::metadata(path).map_err(failed)?.is_file() {
        let problem = "is no file: give one that holds a volume".to_owned();
        return Err(Error::Format { path: path.to_owned(), problem });
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}
