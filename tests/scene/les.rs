//! Grids of large-eddy simulations: NetCDF files whose variables and dimensions have any names.

use std::{fs, path::Path};

use nephos::import::{Choice, parse_volume, read_volume};

/// A variable of a file: its dimensions by their numbers, its unit, its values.
struct Variable {
    name: &'static str,
    dimensions: Vec<u32>,
    unit: &'static str,
    values: Vec<f64>,
}

/// A file of NetCDF's classic format (CDF-1) with these dimensions and variables of doubles.
fn netcdf(dimensions: &[(&str, u32)], variables: &[Variable]) -> Vec<u8> {
    let text = |bytes: &mut Vec<u8>, text: &str| {
        bytes.extend((text.len() as u32).to_be_bytes());
        bytes.extend(text.as_bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    };
    let head = |offsets: &[u32]| {
        let mut bytes = b"CDF\x01\0\0\0\0".to_vec();
        let list = |bytes: &mut Vec<u8>, tag: u32, count: usize| {
            bytes.extend(tag.to_be_bytes());
            bytes.extend((count as u32).to_be_bytes());
        };
        list(&mut bytes, 10, dimensions.len());
        for (name, size) in dimensions {
            text(&mut bytes, name);
            bytes.extend(size.to_be_bytes());
        }
        list(&mut bytes, 0, 0);
        list(&mut bytes, 11, variables.len());
        for (variable, offset) in variables.iter().zip(offsets) {
            text(&mut bytes, variable.name);
            bytes.extend((variable.dimensions.len() as u32).to_be_bytes());
            variable.dimensions.iter().for_each(|dimension| bytes.extend(dimension.to_be_bytes()));
            list(&mut bytes, 12, 1);
            text(&mut bytes, "units");
            bytes.extend(2u32.to_be_bytes());
            text(&mut bytes, variable.unit);
            // Doubles.
            bytes.extend(6u32.to_be_bytes());
            bytes.extend((8 * variable.values.len() as u32).to_be_bytes());
            bytes.extend(offset.to_be_bytes());
        }
        bytes
    };
    let mut at = head(&vec![0; variables.len()]).len() as u32;
    let offsets: Vec<u32> = variables
        .iter()
        .map(|variable| {
            at += 8 * variable.values.len() as u32;
            at - 8 * variable.values.len() as u32
        })
        .collect();
    let mut bytes = head(&offsets);
    bytes
        .extend(variables.iter().flat_map(|variable| &variable.values).flat_map(|value| value.to_be_bytes()));
    bytes
}

/// Uneven heights in the middles of levels, m.
const HEIGHTS: [f64; 4] = [500.0, 520.0, 550.0, 600.0];
/// What levels are thick, m: half way to their neighbours.
const THICK: [f64; 4] = [20.0, 25.0, 40.0, 50.0];

/// A simulation of two times, 3 by 2 columns and four levels: dimensions are time, height, y and x.
fn simulation(unit: &'static str, more: Vec<Variable>) -> Vec<u8> {
    let count = 2 * 4 * 2 * 3;
    let mut variables = vec![
        Variable { name: "zt", dimensions: vec![1], unit: "m", values: HEIGHTS.to_vec() },
        Variable { name: "yt", dimensions: vec![2], unit: "km", values: vec![0.05, 0.1] },
        Variable { name: "xt", dimensions: vec![3], unit: "m", values: vec![25.0, 75.0, 125.0] },
        Variable { name: "lwp", dimensions: vec![0, 2, 3], unit: "g/m2", values: vec![1.0; 12] },
        Variable {
            name: "ql",
            dimensions: vec![0, 1, 2, 3],
            unit,
            values: (0..count).map(f64::from).collect(),
        },
    ];
    variables.extend(more);
    netcdf(&[("time", 2), ("zt", 4), ("yt", 2), ("xt", 3)], &variables)
}

fn column(of: &nephos::scene::Grid, x: i32, y: i32) -> f64 {
    of.filled()
        .filter(|(at, _)| (at.x, at.y) == (x, y))
        .map(|(_, value)| f64::from(value) * of.voxel().z)
        .sum()
}

#[test]
fn columns_of_a_simulation_keep_their_water_at_each_time() {
    let bytes = simulation("g/m3", Vec::new());
    for step in [0, 1] {
        let grid = parse_volume(&bytes, &Choice { step, ..Choice::default() }).unwrap();
        assert_eq!((grid.name.as_str(), grid.quantity.as_str()), ("ql", "mass of water, kg/m^3"));
        let voxel = grid.voxel();
        assert!((voxel.x - 50.0).abs() < 1e-9 && (voxel.y - 50.0).abs() < 1e-9 && voxel.z <= 20.0, "{voxel}");
        // The first column's middle, and the lowest wall 10 m below the lowest level's.
        let corner = grid.place.translation;
        assert!((corner.x - 25.0).abs() < 1e-9 && (corner.y - 50.0).abs() < 1e-9, "{corner}");
        assert!((corner.z - (490.0 + 0.5 * voxel.z)).abs() < 1e-9, "{corner}");
        for (x, y) in [(0, 0), (2, 0), (1, 1)] {
            let value = |level: usize| {
                f64::from((step as usize * 24 + level * 6 + y as usize * 3 + x as usize) as u32)
            };
            let wanted: f64 = (0..4).map(|level| 1e-3 * value(level) * THICK[level]).sum();
            let found = column(&grid, x, y);
            assert!((found / wanted - 1.0).abs() < 1e-5, "{x} {y}: {found} for {wanted}");
        }
    }
}

#[test]
fn water_each_kilogram_of_air_counts_with_the_density_of_air() {
    let air = [1.2, 1.1, 1.0, 0.9];
    let density = Variable { name: "rho", dimensions: vec![1], unit: "kg/m3", values: air.to_vec() };
    let told = parse_volume(&simulation("g/kg", vec![density]), &Choice::default()).unwrap();
    let wanted = |air: [f64; 4]| {
        (0..4).map(|level| 1e-3 * (6 * level) as f64 * air[level] * THICK[level]).sum::<f64>()
    };
    assert!((column(&told, 0, 0) / wanted(air) - 1.0).abs() < 1e-5);
    // Of the standard atmosphere where the file has none: 1.167 kg/m^3 at 500 m, 1.156 at 600 m.
    let standard = parse_volume(&simulation("kg kg-1", Vec::new()), &Choice::default()).unwrap();
    let found = 1e-3 * column(&standard, 0, 0) / wanted([1.0; 4]);
    assert!((1.156..1.167).contains(&found), "{found}");
}

#[test]
fn what_a_plain_grid_lacks_is_told() {
    let told = |bytes: &[u8], name: Option<&str>| {
        parse_volume(bytes, &Choice { grid: name, ..Choice::default() }).unwrap_err()
    };
    let odd = told(&simulation("K", Vec::new()), None);
    assert!(odd.contains("`ql` in `K`") && odd.contains("kg/kg"), "{odd}");
    let missing = told(&simulation("g/m3", Vec::new()), Some("qi"));
    assert!(missing.contains("no grid `qi`: it has `ql`"), "{missing}");
    let choice = Choice { step: 2, ..Choice::default() };
    let late = parse_volume(&simulation("g/m3", Vec::new()), &choice).unwrap_err();
    assert!(late.contains("2 times of `ql`") && late.contains("from 0 to 1"), "{late}");
    let water = |values: Vec<f64>| Variable { name: "ql", dimensions: vec![0, 1, 2], unit: "kg/m3", values };
    let axis = |name, number, unit, values| Variable { name, dimensions: vec![number], unit, values };
    let of = |variables: Vec<Variable>| netcdf(&[("z", 2), ("y", 2), ("x", 3)], &variables);
    let bare = told(&of(vec![water(vec![1.0; 12])]), None);
    assert!(bare.contains("no coordinates along `x`"), "{bare}");
    let uneven = of(vec![
        water(vec![1.0; 12]),
        axis("z", 0, "m", vec![0.0, 10.0]),
        axis("y", 1, "m", vec![0.0, 10.0]),
        axis("x", 2, "m", vec![0.0, 10.0, 30.0]),
    ]);
    assert!(told(&uneven, None).contains("not as far apart"), "{}", told(&uneven, None));
    let turned = of(vec![
        water(vec![1.0; 12]),
        axis("z", 0, "degrees", vec![0.0, 10.0]),
        axis("y", 1, "m", vec![0.0, 10.0]),
        axis("x", 2, "m", vec![0.0, 10.0, 20.0]),
    ]);
    assert!(told(&turned, None).contains("no length"), "{}", told(&turned, None));
    let nothing = netcdf(&[("time", 2)], &[axis("time", 0, "s", vec![0.0, 1.0])]);
    let nothing = told(&nothing, None);
    assert!(nothing.contains("no water by WRF's names") && nothing.contains("it has time"), "{nothing}");
}

#[test]
fn axes_may_stand_in_any_order_and_run_down() {
    // x, y, z by their names; heights and y run from the top and from the north.
    let values: Vec<f64> = (0..12).map(f64::from).collect();
    let axis = |name, number, values| Variable { name, dimensions: vec![number], unit: "m", values };
    let bytes = netcdf(
        &[("x", 3), ("y", 2), ("z", 2)],
        &[
            Variable { name: "liquid", dimensions: vec![0, 1, 2], unit: "kg/m3", values },
            axis("x", 0, vec![0.0, 10.0, 20.0]),
            axis("y", 1, vec![40.0, 20.0]),
            axis("z", 2, vec![115.0, 105.0]),
        ],
    );
    let grid = parse_volume(&bytes, &Choice::default()).unwrap();
    let at = |x: i32, y: i32, z: i32| {
        let found = grid.filled().find(|(at, _)| at.to_array() == [x, y, z]);
        found.map_or(0.0, |(_, value)| value)
    };
    // Number 4 x + 2 y + z of the file, whose last y and z are the least.
    assert_eq!([at(0, 0, 0), at(0, 0, 1), at(0, 1, 0), at(2, 1, 1)], [3.0, 2.0, 1.0, 8.0]);
    let corner = grid.place.translation;
    assert!(corner.distance(glam::DVec3::new(0.0, 20.0, 105.0)) < 1e-9, "{corner}");
}

#[test]
fn times_of_a_simulation_are_steps_of_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("les.nc"), simulation("g/m3", Vec::new())).unwrap();
    let text =
        r#"{"clouds": [{"volume": {"file": "les.nc", "grid": "ql", "up": "z", "sequence": {"fps": 1}}}]}"#;
    fs::write(folder.path().join("scene.json"), text).unwrap();
    let scene = nephos::scene::Scene::load(folder.path().join("scene.json")).unwrap();
    let of = |time: f64| {
        let moment = scene.at(time).unwrap();
        moment.clouds[0].volume.as_ref().unwrap().read_grid().unwrap().total
    };
    let read = |step: u32| {
        let path: &Path = &folder.path().join("les.nc");
        read_volume(path, &Choice { step, ..Choice::default() }).unwrap().total
    };
    assert_eq!([of(0.0), of(1.0)], [read(0), read(1)]);
}
