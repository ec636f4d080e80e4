//! WRF's output: water by kind, pressure, temperature and heights.
//!
//! Mixing ratios are kg of water each kg of dry air. Total pressure is P + PB (Pa), potential temperature T + 300 (K),
//! geopotential PH + PHB (m^2/s^2) at the walls of levels (Skamarock et al. 2008, NCAR/TN-475+STR).

use super::{super::bytes::Problem, Field, Grid, Source, column::Columns};
use crate::scene::Species;

/// Kinds of water: WRF's name, what it is, and its effective radius, um.
pub(super) const KINDS: [(&str, Species, f64); 5] = [
    ("QCLOUD", Species::Water, 10.0),
    ("QRAIN", Species::Rain, 500.0),
    ("QICE", Species::Ice, 40.0),
    ("QSNOW", Species::Snow, 250.0),
    ("QGRAUP", Species::Graupel, 1000.0),
];
/// m/s^2, as WRF has it.
const GRAVITY: f64 = 9.81;
/// Of dry air, J/(kg K), and over the heat capacity at constant pressure.
const GAS: f64 = 287.0;
const KAPPA: f64 = 2.0 / 7.0;
/// Gas constant of water vapour over that of dry air.
const VAPOUR: f64 = 461.6 / 287.0;
/// Most even heights.
const MOST_HEIGHTS: f64 = 256.0;

/// What is in the air at one time.
pub(super) struct Weather {
    /// Levels, rows, columns.
    size: [usize; 3],
    /// Heights of the walls of levels above the sea, m: one more than levels.
    walls: Vec<f64>,
    /// Mass of dry air, kg/m^3.
    air: Vec<f64>,
    /// By kind: mixing ratio, kg/kg.
    water: Vec<(&'static str, Vec<f64>)>,
    /// From one column to the next, m, along x and y.
    steps: [f64; 2],
}

impl Weather {
    pub fn read(source: &Source) -> Result<Self, Problem> {
        let mut water: Vec<(&'static str, Field)> = Vec::new();
        for (name, ..) in KINDS {
            water.extend(source.field(name)?.map(|field| (name, field)));
        }
        let Some(size) = water.first().map(|(_, field)| field.size) else {
            return Err(super::no_water(&source.file));
        };
        let [levels, rows, columns] = size;
        let walls = [levels + 1, rows, columns];
        let sum = |a: &str, b: &str, size| -> Result<Vec<f64>, Problem> {
            let (a, b) = (source.needed(a, Some(size))?, source.needed(b, Some(size))?);
            Ok(a.values.iter().zip(&b.values).map(|(a, b)| a + b).collect())
        };
        let pressure = sum("P", "PB", size)?;
        let heights = sum("PH", "PHB", walls)?.into_iter().map(|potential| potential / GRAVITY).collect();
        let theta = source.needed("T", Some(size))?;
        let vapour = source.field("QVAPOR")?.filter(|field| field.size == size);
        let vapour = |i: usize| vapour.as_ref().map_or(0.0, |field| field.values[i]);
        let air = pressure.iter().zip(&theta.values).enumerate();
        let air = air
            .map(|(i, (p, theta))| p / (GAS * temperature(*p, theta + 300.0) * (1.0 + VAPOUR * vapour(i))));
        let air: Vec<f64> = air.collect();
        let scale = match source.field("MAPFAC_M")? {
            Some(field) => field.values.iter().sum::<f64>() / field.values.len().max(1) as f64,
            None => 1.0,
        };
        let steps = [source.number("DX")? / scale, source.number("DY")? / scale];
        for (name, field) in &water {
            if field.size != size {
                return Err(format!("has `{name}` in another size than the water before it: write it again"));
            }
        }
        let water = water.into_iter().map(|(name, field)| (name, field.values)).collect();
        let weather = Self { size, walls: heights, air, water, steps };
        weather.check()?;
        Ok(weather)
    }

    fn check(&self) -> Result<(), Problem> {
        let known = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let rising = (0..self.size[1] * self.size[2])
            .all(|column| self.walls_of(column).is_sorted_by(|low, high| low < high));
        if !(known(&self.walls) && known(&self.air) && rising && self.steps.iter().all(|step| *step > 0.0)) {
            return Err(
                "has heights or pressures that are none: give a time at which the model has run".to_owned()
            );
        }
        Ok(())
    }

    /// Kinds of water that there are.
    pub fn kinds(&self) -> impl Iterator<Item = &'static str> {
        self.water.iter().map(|(name, _)| *name)
    }

    /// Walls of a column.
    fn walls_of(&self, column: usize) -> Vec<f64> {
        let [levels, rows, columns] = self.size;
        (0..=levels).map(|level| self.walls[level * rows * columns + column]).collect()
    }

    /// Extinction coefficient of some kinds of water together, 1/m.
    fn extinction(&self, kinds: &[&str], cell: usize) -> f64 {
        let of = |(name, ratio): &(&str, Vec<f64>)| {
            let kind = KINDS.iter().find(|(known, ..)| known == name && kinds.contains(name));
            kind.map_or(0.0, |(_, species, radius_um)| {
                species.extinction_of_mass(ratio[cell] * self.air[cell], 1e-6 * radius_um)
            })
        };
        self.water.iter().map(of).sum()
    }

    /// The extinction of some kinds of water on even heights, with z up: its origin is in the middle of the map, at
    /// the height of the sea. Each column keeps its optical depth.
    pub fn grid(&self, kinds: &[&str], name: &str) -> Result<Grid, Problem> {
        let [_, rows, columns] = self.size;
        let steps = self.steps;
        let corner = [columns, rows].map(|n| -0.5 * (n - 1) as f64);
        let all = Columns {
            size: self.size,
            walls: &|column| self.walls_of(column),
            amount: &|column, level| self.extinction(kinds, level * rows * columns + column),
            floor: 0.0,
            most_heights: MOST_HEIGHTS,
        };
        let mut grid = all.grid(name, [corner[0] * steps[0], corner[1] * steps[1]], steps)?;
        grid.quantity = "extinction coefficient, 1/m".to_owned();
        Ok(grid)
    }
}

/// Temperature, K, of air of this potential temperature, K, at a pressure, Pa.
fn temperature(pressure: f64, potential: f64) -> f64 {
    potential * (pressure / 1e5).powf(KAPPA)
}

#[cfg(test)]
mod tests {
    use netcdf_reader::NcFile;

    use super::*;

    fn storm(step: u32) -> Source {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/volumes/storm.nc");
        Source { file: NcFile::open(path).unwrap(), step }
    }

    #[test]
    fn heights_pressures_and_temperatures_are_those_of_wrf_python() {
        let source = storm(0);
        let weather = Weather::read(&source).unwrap();
        let reference =
            |name: &str| source.needed(&format!("reference_{name}"), Some(weather.size)).unwrap().values;
        let (z, p, tk) = (reference("z"), reference("p"), reference("tk"));
        let vapour = source.needed("QVAPOR", Some(weather.size)).unwrap().values;
        let [_, rows, columns] = weather.size;
        for (i, wanted) in z.iter().enumerate() {
            let middle = 0.5 * (weather.walls[i] + weather.walls[i + rows * columns]);
            assert!((middle / wanted - 1.0).abs() < 1e-4, "{i}: {middle} m for {wanted}");
            // Mass of dry air by the gas law, from theirs.
            let air = p[i] / (287.0 * tk[i] * (1.0 + 461.6 / 287.0 * vapour[i]));
            assert!((weather.air[i] / air - 1.0).abs() < 1e-4, "{i}: {} kg for {air}", weather.air[i]);
        }
    }

    #[test]
    fn each_column_keeps_its_optical_depth() {
        for step in [0, 1] {
            let weather = Weather::read(&storm(step)).unwrap();
            for kinds in [&["QCLOUD"][..], &["QRAIN"], &["QCLOUD", "QRAIN"]] {
                let grid = weather.grid(kinds, "density").unwrap();
                let edge = grid.voxel().z;
                let [_, rows, columns] = weather.size;
                let mut found = vec![0.0; rows * columns];
                for (at, value) in grid.filled() {
                    found[at.y as usize * columns + at.x as usize] += f64::from(value) * edge;
                }
                for (column, found) in found.into_iter().enumerate() {
                    let thick = |(level, wall): (usize, &[f64])| {
                        (wall[1] - wall[0]) * weather.extinction(kinds, level * rows * columns + column)
                    };
                    let wanted: f64 = weather.walls_of(column).windows(2).enumerate().map(thick).sum();
                    assert!((found - wanted).abs() < 1e-5 * wanted + 1e-9, "{column}: {found} for {wanted}");
                }
            }
        }
    }
}
