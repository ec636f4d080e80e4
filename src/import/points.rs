//! Clouds of points: PLY (text or binary, by its header, Turk 1994) and CSV.

use std::{fs, path::Path};

use glam::DVec3;

use super::bytes::{Bytes, Problem};
use crate::Error;

/// Most points.
const MOST: usize = 20_000_000;
/// What the radius of a point is called: by most programs, by Houdini.
const RADII: [&str; 2] = ["radius", "pscale"];

/// A point of a cloud of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Where it is, m.
    pub place: DVec3,
    /// How far what it stands for reaches, m; 0 where nothing tells.
    pub radius: f64,
}

/// Whether a file has the name of one with points.
pub fn is_of_points(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    ["ply", "csv"].iter().any(|known| ending.eq_ignore_ascii_case(known))
}

/// Reads all points of a .ply or .csv file.
///
/// # Errors
/// [`Error::File`] and [`Error::Format`] where the file can't be read or has none.
pub fn read_points(path: &Path) -> crate::Result<Vec<Point>> {
    let bytes =
        fs::read(path).map_err(|source| Error::File { action: "read", path: path.to_owned(), source })?;
    parse_points(&bytes).map_err(|problem| Error::Format { path: path.to_owned(), problem })
}

/// The same of the bytes of a file.
///
/// # Errors
/// The rest of a sentence about the file.
pub fn parse_points(bytes: &[u8]) -> Result<Vec<Point>, String> {
    let points = if bytes.starts_with(b"ply") { ply(bytes)? } else { csv(bytes)? };
    if points.is_empty() {
        return Err("has no points: export it with some".to_owned());
    }
    let is_good = |point: &Point| point.place.is_finite() && point.radius.is_finite() && point.radius >= 0.0;
    match points.iter().position(|point| !is_good(point)) {
        Some(i) => {
            Err(format!("has point {} at no place, or of a radius below 0: export it without that", i + 1))
        }
        None => Ok(points),
    }
}

/// Numbers of PLY.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Signed(usize),
    Unsigned(usize),
    Float,
    Double,
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Signed(1),
            "uchar" | "uint8" => Self::Unsigned(1),
            "short" | "int16" => Self::Signed(2),
            "ushort" | "uint16" => Self::Unsigned(2),
            "int" | "int32" => Self::Signed(4),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float,
            "double" | "float64" => Self::Double,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Signed(size) | Self::Unsigned(size) => size,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn read(self, bytes: &mut Bytes<'_>, is_big: bool) -> Result<f64, Problem> {
        // The least significant byte first.
        let mut raw = [0; 8];
        let own = &mut raw[..self.size()];
        own.copy_from_slice(bytes.take(self.size())?);
        if is_big {
            own.reverse();
        }
        let whole = u64::from_le_bytes(raw);
        let unused = 64 - 8 * self.size() as u32;
        Ok(match self {
            Self::Unsigned(_) => whole as f64,
            Self::Signed(_) => (whole.cast_signed() << unused >> unused) as f64,
            Self::Float => f64::from(f32::from_bits(whole as u32)),
            Self::Double => f64::from_bits(whole),
        })
    }
}

/// A kind of thing in a PLY file, and the numbers of each.
struct Element {
    name: String,
    count: usize,
    /// Name and number; of a list also that of its length.
    properties: Vec<(String, Number, Option<Number>)>,
}

fn ply(all: &[u8]) -> Result<Vec<Point>, Problem> {
    const END: &[u8] = b"end_header";
    let end = all
        .windows(END.len())
        .position(|part| part == END)
        .ok_or("has no end of its header: export it again")?;
    let after = all[end..].iter().position(|byte| *byte == b'\n').map_or(all.len(), |line| end + line + 1);
    let header = String::from_utf8_lossy(&all[..end]).into_owned();
    let mut format = "";
    let mut elements: Vec<Element> = Vec::new();
    for line in header.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let bad = || format!("has the line `{line}` in its header, which is not read: export it again");
        match words.as_slice() {
            ["format", named, _] => format = *named,
            ["element", name, count] => elements.push(Element {
                name: (*name).to_owned(),
                count: count.parse().map_err(|_| bad())?,
                properties: Vec::new(),
            }),
            ["property", "list", length, number, name] => {
                let (length, number) = Number::named(length).zip(Number::named(number)).ok_or_else(bad)?;
                elements.last_mut().ok_or_else(bad)?.properties.push((
                    (*name).to_owned(),
                    number,
                    Some(length),
                ));
            }
            ["property", number, name] => {
                let number = Number::named(number).ok_or_else(bad)?;
                elements.last_mut().ok_or_else(bad)?.properties.push(((*name).to_owned(), number, None));
            }
            _ => {}
        }
    }
    match format {
        "ascii" => {
            let text = String::from_utf8_lossy(&all[after..]).into_owned();
            let mut words = text.split_whitespace();
            vertices(&elements, |_| {
                let word = words.next().ok_or("ends early: copy or export it again")?;
                word.parse().map_err(|_| format!("has `{word}` where a number should be: export it again"))
            })
        }
        "binary_little_endian" | "binary_big_endian" => {
            let mut bytes = Bytes::new(&all[after..]);
            vertices(&elements, |number| number.read(&mut bytes, format == "binary_big_endian"))
        }
        _ => Err(format!(
            "has the format `{format}`, and ascii, binary_little_endian and binary_big_endian are read"
        )),
    }
}

/// The points of the element `vertex`, where `next` gives the numbers of a file one after the other.
fn vertices(
    elements: &[Element],
    mut next: impl FnMut(Number) -> Result<f64, Problem>,
) -> Result<Vec<Point>, Problem> {
    for element in elements {
        let place = |name: &str| element.properties.iter().position(|(own, ..)| own == name);
        let is_vertex = element.name == "vertex";
        let axes = ["x", "y", "z"].map(place);
        let radius = RADII.iter().find_map(|name| place(name));
        if is_vertex && element.count > MOST {
            return Err(format!("has {} vertices, more than {MOST}: thin them out", element.count));
        }
        if is_vertex && axes.contains(&None) {
            return Err(format!("has {} vertices without x, y and z: export points", element.count));
        }
        let mut points = Vec::new();
        for _ in 0..if element.properties.is_empty() { 0 } else { element.count } {
            let mut values = vec![0.0; element.properties.len()];
            for ((_, number, length), value) in element.properties.iter().zip(&mut values) {
                match length {
                    None => *value = next(*number)?,
                    Some(length) => (0..next(*length)? as u64).try_for_each(|_| next(*number).map(drop))?,
                }
            }
            let of = |place: Option<usize>| place.map_or(0.0, |i| values[i]);
            points.push(Point { place: DVec3::from(axes.map(of)), radius: of(radius) });
        }
        if is_vertex {
            return Ok(points);
        }
    }
    Err("has no element `vertex`: export points".to_owned())
}

/// Lines of x, y, z and perhaps a radius, in that order or as a first line of names says.
fn csv(bytes: &[u8]) -> Result<Vec<Point>, Problem> {
    let text = str::from_utf8(bytes).map_err(|_| "is neither PLY nor text: give .ply or .csv".to_owned())?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).peekable();
    let cells = |line: &str| -> Vec<String> {
        line.split([',', ';', '\t']).map(|cell| cell.trim().to_lowercase()).collect()
    };
    let mut columns = [Some(0), Some(1), Some(2), Some(3)];
    if let Some((_, line)) =
        lines.next_if(|(_, line)| cells(line).iter().any(|cell| cell.parse::<f64>().is_err()))
    {
        let names = cells(line);
        let place = |name: &str| names.iter().position(|own| own.trim_matches('"') == name);
        columns = [place("x"), place("y"), place("z"), RADII.iter().find_map(|name| place(name))];
        if columns[..3].contains(&None) {
            return Err(format!(
                "has the columns {}, and x, y and z are needed, with radius if there is one",
                names.join(", ")
            ));
        }
    }
    let mut points = Vec::new();
    for (number, line) in lines {
        let cells = cells(line);
        let value = |column: Option<usize>, is_needed: bool| match column.and_then(|column| cells.get(column))
        {
            Some(cell) => cell
                .parse()
                .map_err(|_| format!("has `{cell}` in line {} where a number should be", number + 1)),
            None if is_needed => {
                Err(format!("has fewer than three numbers in line {}: write x,y,z", number + 1))
            }
            None => Ok(0.0),
        };
        let [x, y, z, radius] = columns;
        let place = DVec3::new(value(x, true)?, value(y, true)?, value(z, true)?);
        points.push(Point { place, radius: value(radius, false)? });
        if points.len() > MOST {
            return Err(format!("has more than {MOST} points: thin them out"));
        }
    }
    Ok(points)
}
