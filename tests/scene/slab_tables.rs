//! The tables of slabs: whole, listed, and what the study gives.

use half::f16;
use nephos::optics::slab::SETS;
use nephos::optics::slab::check::{Tables, run};
use nephos::optics::slab::samples::View;
use nephos::{
    optics::slab::{slab_functions, slab_radiance},
    tables::Grids,
};

const FILES: [(&str, &[u8]); 3] = [
    ("slab_moments.bin", include_bytes!("../../tables/slab_moments.bin")),
    ("slab_radiance.bin", include_bytes!("../../tables/slab_radiance.bin")),
    ("slab_functions.bin", include_bytes!("../../tables/slab_functions.bin")),
];

#[test]
fn readme_lists_size_and_checksum_of_each_file() {
    let readme = include_str!("../../tables/README.md");
    for (name, bytes) in FILES {
        let (_, checksum) = bytes.split_last_chunk().unwrap();
        let listed = format!("| `{name}` | {} | `{:016x}` |", bytes.len(), u64::from_le_bytes(*checksum));
        assert!(readme.contains(&listed), "tables/README.md must list {listed}");
    }
}

#[test]
fn a_flipped_bit_is_an_error_that_names_the_file() {
    for (name, bytes) in FILES {
        assert!(Grids::decode(name, bytes).is_ok());
        for place in [0, 9, bytes.len() / 2, bytes.len() - 1] {
            let mut bad = bytes.to_vec();
            bad[place] ^= 1;
            let error = Grids::decode(name, &bad).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
    }
}

#[test]
fn the_check_passes_the_tables_and_no_others() {
    let good = Tables::embedded().unwrap();
    let told = run(good, 1, 3).unwrap();
    for (name, _) in FILES {
        assert!(told.iter().any(|line| line.contains(name)), "{told:?}");
    }
    // A hundredth more than the right numbers, in tables that are whole otherwise.
    let more = |values: &mut Vec<f16>| {
        values.iter_mut().for_each(|value| *value = f16::from_f32(1.01 * value.to_f32() + 0.002));
    };
    let mut moments = good.moments.clone();
    more(&mut moments.values);
    let error = run(Tables { moments: &moments, ..good }, 1, 3).unwrap_err().to_string();
    assert!(error.contains("slab_moments.bin"), "{error}");
    let mut radiance = good.radiance.clone();
    more(&mut radiance.modes.values);
    let error = run(Tables { radiance: &radiance, ..good }, 1, 3).unwrap_err().to_string();
    assert!(error.contains("slab_radiance.bin"), "{error}");
    // The functions' errors are those of their fits: only grave damage shows.
    let mut functions = good.functions.clone();
    functions.view.values.iter_mut().for_each(|value| *value = f16::from_f32(value.to_f32() + 2.0));
    let error = run(Tables { functions: &functions, ..good }, 1, 3).unwrap_err().to_string();
    assert!(error.contains("slab_functions.bin"), "{error}");
}

#[test]
fn nothing_jumps_where_the_sun_goes_through_the_plane_of_the_slab() {
    for (depth, mu, phi) in [(0.0, -0.4, 0.3), (0.2, 0.7, 2.0), (4.0, 0.05, 1.0), (5.0, 0.9, 0.0)] {
        for set in 0..SETS {
            let [above, below] = [1e-4, -1e-4].map(|mu0| View { thickness: 5.0, depth, mu, phi, mu0 });
            // Light is in proportion to the cosine of a low sun, with at most a few times 1/sr.
            for model in
                [slab_radiance().unwrap().radiance(set, above), slab_radiance().unwrap().radiance(set, below)]
            {
                assert!(model.abs() < 1e-3, "direct table, set {set}: {model}");
            }
            let functions = &slab_functions().unwrap().0;
            for model in [functions.radiance(set, above), functions.radiance(set, below)] {
                assert!(model.abs() < 1e-3, "functions, set {set}: {model}");
            }
        }
    }
}
