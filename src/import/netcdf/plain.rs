//! Plain grids: variables over height, y and x, as large-eddy simulations write them.
//!
//! Which dimension is which is told by its name, or by its place (height, y, x, as the COARDS conventions have it), and where
//! its points are by a variable over it alone. Water in kg each kg of air becomes kg/m^3 with the density in the file, or
//! that of the standard atmosphere (ISO 2533) below 11 km, continued above.

use netcdf_reader::{NcFile, NcSliceInfo, NcSliceInfoElem, NcVariable};

use super::{super::bytes::Problem, column::Columns, damaged};
use crate::scene::{Grid, MOST_ALONG};

/// Names of the density of air.
const DENSITIES: [&str; 9] =
    ["rho", "rhof", "rhobf", "rho0", "dn0", "dens", "density", "rho_air", "air_density"];
/// Most even heights.
const MOST_HEIGHTS: f64 = 1024.0;
/// How far steps between points may differ from their mean, as a share of it.
const UNEVEN: f64 = 1e-3;

/// What numbers of a variable are.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Measure {
    /// Of water, kg each kg of air, and of kg/m^3, when multiplied by this.
    Ratio(f64),
    Mass(f64),
    /// 1/m.
    Extinction,
}

impl Measure {
    /// Of a unit as files write it: `kg/kg`, `g kg-1`, `kg m-3`, `g/m^3`, `1/m`.
    fn of(unit: &str) -> Option<Self> {
        let plain: String = unit.to_lowercase().chars().filter(|c| !" ^*_.".contains(*c)).collect();
        match plain.as_str() {
            "kg/kg" | "kgkg-1" | "kgkg**-1" => Some(Self::Ratio(1.0)),
            "g/kg" | "gkg-1" => Some(Self::Ratio(1e-3)),
            "kg/m3" | "kgm-3" => Some(Self::Mass(1.0)),
            "g/m3" | "gm-3" => Some(Self::Mass(1e-3)),
            "1/m" | "m-1" => Some(Self::Extinction),
            _ => None,
        }
    }

    /// What a grid of it says of its values.
    fn quantity(self) -> &'static str {
        match self {
            Self::Extinction => "extinction coefficient, 1/m",
            Self::Ratio(_) | Self::Mass(_) => "mass of water, kg/m^3",
        }
    }
}

/// Points along an axis, m, least first, and whether the file has the greatest first.
struct Points {
    at: Vec<f64>,
    falls: bool,
}

/// A variable over three axes, and over times where there are four.
pub(super) struct Plain<'a> {
    file: &'a NcFile,
    variable: &'a NcVariable,
    /// Which of its dimensions are x, y and z.
    axes: [usize; 3],
    measure: Option<Measure>,
}

impl<'a> Plain<'a> {
    /// Those of a file, but for the density of air.
    pub fn all(file: &'a NcFile) -> Result<Vec<Self>, Problem> {
        let variables = file.variables().map_err(|error| damaged("its list of variables", &error))?;
        let water = variables.iter().filter(|variable| !DENSITIES.contains(&variable.name()));
        Ok(water.filter_map(|variable| Self::of(file, variable)).collect())
    }

    fn of(file: &'a NcFile, variable: &'a NcVariable) -> Option<Self> {
        let axes = axes(&dimensions(variable))?;
        Some(Self { file, variable, axes, measure: Measure::of(&text(variable, "units")) })
    }

    pub fn name(&self) -> &str {
        self.variable.name()
    }

    /// Its unit, as the file has it.
    pub fn unit(&self) -> String {
        text(self.variable, "units")
    }

    /// How many times there are.
    pub fn times(&self) -> u64 {
        if self.variable.ndim() == 4 { self.variable.shape()[0] } else { 1 }
    }

    /// Its grid at the time `step`, with z up: each column keeps its water.
    pub fn grid(&self, step: u32) -> Result<Grid, Problem> {
        let name = self.name();
        let measure = self.measure.ok_or_else(|| {
            format!(
                "has `{name}` in `{}`, which is no amount of water that is read: give kg/kg, g/kg, kg/m3, g/m3, or extinction in 1/m \
                 in its attribute `units`",
                self.unit()
            )
        })?;
        if u64::from(step) >= self.times() {
            return Err(format!(
                "has {} times of `{name}`, and time {step} is asked for: give `step` from 0 to {}",
                self.times(),
                self.times() - 1
            ));
        }
        let points = [self.points(0)?, self.points(1)?, self.points(2)?];
        let falls = points.each_ref().map(|points| points.falls);
        let [xs, ys, zs] = points.each_ref().map(|points| points.at.as_slice());
        let steps = [even_step(xs, self.dimension(0))?, even_step(ys, self.dimension(1))?];
        let values = self.values(self.variable, step, falls)?;
        let air = match measure {
            Measure::Ratio(_) => self.air(zs, step, falls)?,
            _ => vec![1.0; values.len()],
        };
        let factor = match measure {
            Measure::Ratio(factor) | Measure::Mass(factor) => factor,
            Measure::Extinction => 1.0,
        };
        let amounts: Vec<f64> = values.iter().zip(&air).map(|(value, air)| factor * value * air).collect();
        let walls = walls(zs, self.dimension(2))?;
        let columns = Columns {
            size: [zs.len(), ys.len(), xs.len()],
            walls: &|_| walls.clone(),
            amount: &|column, level| amounts[level * ys.len() * xs.len() + column],
            floor: f64::INFINITY,
            most_heights: MOST_HEIGHTS,
        };
        let mut grid = columns.grid(name, [xs[0], ys[0]], steps)?;
        grid.quantity = measure.quantity().to_owned();
        Ok(grid)
    }

    fn dimension(&self, axis: usize) -> &str {
        &self.variable.dimensions()[self.axes[axis]].name
    }

    /// Where the points along an axis are.
    fn points(&self, axis: usize) -> Result<Points, Problem> {
        let dimension = self.dimension(axis);
        let size = self.variable.shape()[self.axes[axis]] as usize;
        if !(1..=MOST_ALONG as usize).contains(&size) {
            return Err(format!(
                "has {size} points along `{dimension}`, and 1 to {MOST_ALONG} are read: cut or coarsen it"
            ));
        }
        let variables = self.file.variables().map_err(|error| damaged("its list of variables", &error))?;
        let lies_along =
            |variable: &&NcVariable| matches!(variable.dimensions(), [only] if only.name == dimension);
        let named = variables.iter().filter(lies_along).find(|variable| variable.name() == dimension);
        let of_length = |variable: &&NcVariable| length(&text(variable, "units")).is_some();
        let found = named.or_else(|| variables.iter().filter(lies_along).find(of_length)).ok_or_else(|| {
            format!("has no coordinates along `{dimension}`, over which `{}` lies: write a variable `{dimension}` in metres", self.name())
        })?;
        let unit = text(found, "units");
        let factor = if unit.is_empty() { Some(1.0) } else { length(&unit) };
        let factor = factor.ok_or_else(|| {
            format!("has `{}` in `{unit}`, which is no length: write it in m or km", found.name())
        })?;
        let read =
            self.file.read_variable_as_f64(found.name()).map_err(|error| damaged(found.name(), &error))?;
        let mut at: Vec<f64> = read.iter().map(|point| factor * point).collect();
        if at.len() != size || at.iter().any(|point| !point.is_finite()) {
            return Err(format!(
                "has coordinates in `{}` that are no {size} numbers: write it again",
                found.name()
            ));
        }
        let falls = at.first() > at.last();
        if falls {
            at.reverse();
        }
        Ok(Points { at, falls })
    }

    /// Numbers of a variable over the same axes: x fastest, then y, then height; 0 where there are none.
    fn values(&self, variable: &NcVariable, step: u32, falls: [bool; 3]) -> Result<Vec<f64>, Problem> {
        let mut selections = Vec::new();
        if variable.ndim() == 4 {
            selections.push(NcSliceInfoElem::Index(step.into()));
        }
        let all = NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 };
        selections.extend([all.clone(), all.clone(), all]);
        let read =
            self.file.read_variable_slice_unpacked_masked(variable.name(), &NcSliceInfo { selections });
        let found: Vec<f64> =
            read.map_err(|error| damaged(variable.name(), &error))?.iter().copied().collect();
        let shape: Vec<usize> = variable.shape().iter().map(|n| *n as usize).collect();
        let stride = |axis: usize| shape[axis + 1..].iter().product::<usize>();
        // It may lie over times where the other does not.
        let places = self.axes.map(|axis| axis + variable.ndim() - self.variable.ndim());
        let [(width, dx), (depth, dy), (height, dz)] = places.map(|axis| (shape[axis], stride(axis)));
        if found.len() != width * depth * height {
            return Err(format!("has `{}` in a size that it does not tell: write it again", variable.name()));
        }
        let at = |i: usize, count: usize, axis: usize| if falls[axis] { count - 1 - i } else { i };
        let mut values = Vec::with_capacity(found.len());
        for z in 0..height {
            for y in 0..depth {
                for x in 0..width {
                    let place = at(x, width, 0) * dx + at(y, depth, 1) * dy + at(z, height, 2) * dz;
                    values.push(Some(found[place]).filter(|value| value.is_finite()).unwrap_or(0.0));
                }
            }
        }
        Ok(values)
    }

    /// Density of air at each point, kg/m^3.
    fn air(&self, heights: &[f64], step: u32, falls: [bool; 3]) -> Result<Vec<f64>, Problem> {
        let shape = self.variable.shape();
        let count = self.axes.map(|axis| shape[axis] as usize);
        let layer = count[0] * count[1];
        let spread =
            |column: Vec<f64>| column.into_iter().flat_map(|air| std::iter::repeat_n(air, layer)).collect();
        let Some(variable) = DENSITIES.iter().find_map(|name| self.file.variable(name).ok()) else {
            return Ok(spread(heights.iter().map(|height| standard_air(*height)).collect()));
        };
        let (names, own) = (dimensions(variable), dimensions(self.variable));
        let air: Vec<f64> = match names.as_slice() {
            names if own.ends_with(names) && names.len() >= 3 => self.values(variable, step, falls)?,
            [.., height] if *height == self.dimension(2) && names.len() <= 2 => {
                let mut selections = vec![NcSliceInfoElem::Index(step.into()); names.len() - 1];
                selections.push(NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 });
                let read = self.file.read_variable_slice_as_f64(variable.name(), &NcSliceInfo { selections });
                let column: Vec<f64> =
                    read.map_err(|error| damaged(variable.name(), &error))?.iter().copied().collect();
                spread(if falls[2] { column.into_iter().rev().collect() } else { column })
            }
            _ => {
                return Err(format!(
                    "has the density of air, `{}`, over other dimensions than `{}`: write it over the same ones, or over `{}`",
                    variable.name(),
                    self.name(),
                    self.dimension(2)
                ));
            }
        };
        if air.len() != layer * count[2] || air.iter().any(|air| !(0.0..100.0).contains(air)) {
            return Err(format!(
                "has densities of air in `{}` that are none, in kg/m3: write it again",
                variable.name()
            ));
        }
        Ok(air)
    }
}

/// Which dimensions are x, y and z: by their names where all three tell it, else the last three are height, y and x. The
/// first of four is time.
fn axes(names: &[&str]) -> Option<[usize; 3]> {
    let first = names.len().checked_sub(3).filter(|first| *first <= 1)?;
    let names: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
    if ["t", "time", "times"].contains(&names[first].as_str()) {
        return None;
    }
    let named = |letters: [char; 2]| {
        let is_it = |i: &usize| names[*i].trim_start_matches('n').starts_with(letters);
        let mut found = (first..names.len()).filter(is_it);
        found.next().filter(|_| found.next().is_none())
    };
    let told = [named(['x', 'i']), named(['y', 'j']), named(['z', 'k'])];
    match told {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
        _ => Some([first + 2, first + 1, first]),
    }
}

/// Names of the dimensions of a variable, slowest first.
fn dimensions(variable: &NcVariable) -> Vec<&str> {
    variable.dimensions().iter().map(|dimension| dimension.name.as_str()).collect()
}

fn text(variable: &NcVariable, name: &str) -> String {
    variable.attribute(name).and_then(|found| found.value.as_string()).unwrap_or_default().trim().to_owned()
}

/// Metres of a unit of length.
fn length(unit: &str) -> Option<f64> {
    match unit.to_lowercase().as_str() {
        "m" | "meter" | "meters" | "metre" | "metres" => Some(1.0),
        "km" | "kilometer" | "kilometers" | "kilometre" | "kilometres" => Some(1000.0),
        _ => None,
    }
}

/// From one point to the next, m, where all are as far apart.
fn even_step(points: &[f64], dimension: &str) -> Result<f64, Problem> {
    let last = points.len() - 1;
    if last == 0 {
        return Err(format!(
            "has one point along `{dimension}`, which tells no width: give a file with two or more"
        ));
    }
    let step = (points[last] - points[0]) / last as f64;
    let is_even = points.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() <= UNEVEN * step);
    if step > 0.0 && is_even {
        return Ok(step);
    }
    Err(format!(
        "has points along `{dimension}` that are not as far apart as the others: bring them to even steps (heights may be uneven)"
    ))
}

/// Walls between heights: half way between them, and as far beyond the first and the last one.
fn walls(heights: &[f64], dimension: &str) -> Result<Vec<f64>, Problem> {
    let [first, second, ..] = *heights else {
        return Err(format!(
            "has one height along `{dimension}`, which tells no thickness: give a file with two or more"
        ));
    };
    if !heights.is_sorted_by(|low, high| low < high) {
        return Err(format!("has one height twice along `{dimension}`: write it again"));
    }
    let last = heights.len() - 1;
    let between = heights.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let mut walls = vec![first - 0.5 * (second - first)];
    walls.extend(between);
    walls.push(heights[last] + 0.5 * (heights[last] - heights[last - 1]));
    Ok(walls)
}

/// Density of air, kg/m^3, at a height, m.
fn standard_air(height: f64) -> f64 {
    const TROPOPAUSE: f64 = 11_000.0;
    let at = |height: f64| 1.225 * (1.0 - 2.255_77e-5 * height).powf(4.255_88);
    let above = (height - TROPOPAUSE).max(0.0);
    // Of 216.65 K, where the scale height is R T / (M g).
    at(height.min(TROPOPAUSE)) * (-above / 6341.6).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_every_way_that_they_are_written() {
        let of = |units: [&str; 4]| units.map(Measure::of);
        assert_eq!(of(["kg/kg", "kg kg-1", "kg kg^-1", "KG.KG**-1"]), [Some(Measure::Ratio(1.0)); 4]);
        assert_eq!(of(["g/kg", "g kg-1", "g/m3", "g m^-3"]).map(|found| found.is_some()), [true; 4]);
        assert_eq!(of(["kg/m^3", "kg m-3", "1/m", "m-1"]).map(|found| found.is_some()), [true; 4]);
        assert_eq!(of(["", "K", "m/s", "kg"]), [None; 4]);
    }

    #[test]
    fn axes_are_known_by_name_or_by_place() {
        assert_eq!(axes(&["time", "zt", "yt", "xt"]), Some([3, 2, 1]));
        assert_eq!(axes(&["time", "x", "y", "zu_3d"]), Some([1, 2, 3]));
        assert_eq!(axes(&["nk", "nj", "ni"]), Some([2, 1, 0]));
        assert_eq!(axes(&["lev", "lat", "lon"]), Some([2, 1, 0]));
        assert_eq!(axes(&["time", "y", "x"]), None);
        assert_eq!((axes(&["y", "x"]), axes(&["a", "b", "z", "y", "x"])), (None, None));
    }

    #[test]
    fn air_is_that_of_the_standard_atmosphere() {
        // Heights of its table are geopotential ones.
        for (height, air) in
            [(0.0, 1.225), (1000.0, 1.1117), (5000.0, 0.7361), (11_000.0, 0.3639), (15_000.0, 0.1937)]
        {
            assert!((standard_air(height) / air - 1.0).abs() < 2e-3, "{height}: {}", standard_air(height));
        }
    }
}
