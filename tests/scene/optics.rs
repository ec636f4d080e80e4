//! Droplets, phase functions and the Mie table, held against closed forms and
//! against an independent solver (`tests/data/mie`).

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::OnceLock;

use nephos::Error;
use nephos::optics::droplets::{self, Bulk, EFFECTIVE_VARIANCE, GammaDistribution};
use nephos::optics::mie::Sphere;
use nephos::optics::peak::{Chopped, GREEN_CUT_DEG};
use nephos::optics::phase::{Phase, Tabulated};
use nephos::optics::water::{RefractiveIndex, refractive_index};
use nephos::optics::{WAVELENGTHS_UM, table};
use nephos::tables::{self, MieTables};

const CHANNELS: [usize; 3] = [0, 1, 2];

const PHASE: &str = include_str!("../data/mie/phase_gamma_re06_ve0.10.csv");
const FORWARD: &str = include_str!("../data/mie/forward_0-2deg_gamma_re06_ve0.10.csv");
const SUMMARY: &str = include_str!("../data/mie/summary.csv");

/// The file as it lies in the repository.
const FILE: &[u8] = include_bytes!("../../tables/mie.bin");

// One sphere

#[test]
fn sphere_much_smaller_than_the_wavelength_scatters_like_rayleigh() {
    let size = 0.02;
    for n in [1.33, 1.5, 2.0] {
        let sphere = Sphere::new(size, RefractiveIndex { n, k: 0.0 });
        let polarisability = (n * n - 1.0) / (n * n + 2.0);
        let rayleigh = 8.0 / 3.0 * size.powi(4) * polarisability.powi(2);
        // The next term is of relative order x^2 = 4e-4.
        assert_close(sphere.q_sca(), rayleigh, 1e-3 * rayleigh, "Q_sca");
        assert_close(sphere.asymmetry(), 0.0, 1e-3, "g");
        let mu = 0.3;
        let phase = sphere.phase(&[mu])[0];
        let expected = 3.0 / (16.0 * PI) * (1.0 + mu * mu);
        assert_close(phase, expected, 1e-3 * expected, "P");
    }
}

#[test]
fn absorbing_sphere_much_smaller_than_the_wavelength_absorbs_like_rayleigh() {
    let size = 1e-2;
    // (m^2 - 1) / (m^2 + 2) of m = 1.5 + 0.5 i, worked out: m^2 = 2 + 1.5 i.
    let imaginary = 4.5 / 18.25;
    let sphere = Sphere::new(size, RefractiveIndex { n: 1.5, k: 0.5 });
    let absorbed = sphere.q_ext() - sphere.q_sca();
    // The next term is of relative order x^2 = 1e-4.
    assert_close(absorbed, 4.0 * size * imaginary, 1e-3 * absorbed, "Q_abs");
}

#[test]
fn extinction_of_a_large_sphere_tends_to_twice_its_shadow() {
    // The edge adds 1.99 x^(-2/3) (Nussenzveig and Wiscombe 1980). Absorption
    // takes the light through the sphere away, and with it the ripples.
    for size in [300.0, 1000.0, 4000.0] {
        let sphere = Sphere::new(size, RefractiveIndex { n: 1.33, k: 0.05 });
        let expected = 2.0 + 1.992_386_1 * f64::powf(size, -2.0 / 3.0);
        assert_close(sphere.q_ext(), expected, 3e-3, &format!("Q_ext at x = {size}"));
    }
}

#[test]
fn sphere_without_absorption_scatters_all_it_takes() {
    for size in [0.1, 1.0, 8.0, 50.0, 800.0, 2000.0] {
        let sphere = Sphere::new(size, RefractiveIndex { n: 1.33, k: 0.0 });
        assert_close(sphere.q_sca(), sphere.q_ext(), 1e-10, &format!("Q_sca at x = {size}"));
    }
}

#[test]
fn forward_amplitude_gives_the_extinction() {
    // The optical theorem bounds P(0) from below: |S(0)| >= Re S(0) = x^2 Q_ext / 4.
    for size in [1.0, 30.0, 800.0] {
        let sphere = Sphere::new(size, RefractiveIndex { n: 1.33, k: 0.0 });
        let mut intensity = [0.0];
        sphere.intensity(&[1.0], &mut intensity);
        let least = (0.25 * size * size * sphere.q_ext()).powi(2);
        assert!(intensity[0] >= least, "{} < {least} at x = {size}", intensity[0]);
        // What is beyond it is the imaginary part, which is small for large spheres.
        if size > 100.0 {
            assert_close(intensity[0], least, 0.05 * least, "intensity straight on");
        }
    }
}

#[test]
fn phase_function_of_a_sphere_is_normalised_and_has_its_asymmetry() {
    for size in [0.5, 10.0, 150.0, 800.0] {
        let sphere = Sphere::new(size, refractive_index(1));
        // A polynomial of degree 2 nstop in mu; the midpoint rule in theta needs
        // a few points an oscillation and converges fast.
        let steps = (40.0 * size) as usize + 400;
        let theta = |i: usize| PI * (i as f64 + 0.5) / steps as f64;
        let cosines: Vec<f64> = (0..steps).map(|i| theta(i).cos()).collect();
        let phase = sphere.phase(&cosines);
        let (mut total, mut mean_cosine) = (0.0, 0.0);
        for (i, value) in phase.iter().enumerate() {
            let ring = 2.0 * PI * theta(i).sin() * PI / steps as f64;
            total += value * ring;
            mean_cosine += value * ring * cosines[i];
        }
        assert_close(total, 1.0, 1e-4, &format!("integral at x = {size}"));
        assert_close(mean_cosine, sphere.asymmetry(), 1e-4, &format!("g at x = {size}"));
    }
}

#[test]
fn spheres_of_the_literature_have_their_published_values() {
    // Bohren and Huffman (1983), appendix A.
    let sphere = Sphere::new(2.0 * PI * 0.525 / 0.6328, RefractiveIndex { n: 1.55, k: 0.0 });
    assert_close(sphere.q_ext(), 3.10543, 5e-6, "Q_ext");
    // Q_back = 4 |S(180)|^2 / x^2.
    let mut backwards = [0.0];
    sphere.intensity(&[-1.0], &mut backwards);
    let size = 2.0 * PI * 0.525 / 0.6328;
    assert_close(4.0 * backwards[0] / (size * size), 2.92534, 5e-6, "Q_back");
    // Wiscombe, Mie Scattering Calculations, NCAR/TN-140+STR (1979): n, k, x, Q_sca, g.
    let spheres = [
        (1.33, 1e-5, 1.0, 0.093923, 0.184517),
        (1.33, 1e-5, 100.0, 2.096594, 0.868959),
        (1.33, 1e-5, 10_000.0, 1.723857, 0.907840),
        (0.75, 0.0, 10.0, 2.232265, 0.896473),
        (0.75, 0.0, 1000.0, 1.997908, 0.844944),
    ];
    for (n, k, size, q_sca, asymmetry) in spheres {
        let sphere = Sphere::new(size, RefractiveIndex { n, k });
        assert_close(sphere.q_sca(), q_sca, 1e-6, &format!("Q_sca at x = {size}"));
        assert_close(sphere.asymmetry(), asymmetry, 1e-6, &format!("g at x = {size}"));
    }
}

// Droplets

#[test]
fn gamma_distribution_has_its_effective_radius_and_variance() {
    for effective_variance in [0.05, 0.10, 0.25] {
        let distribution = GammaDistribution { effective_radius_um: 6.0, effective_variance };
        let moment = |weight: &dyn Fn(f64) -> f64| -> f64 {
            (1..40_000).map(|i| 2e-3 * f64::from(i)).map(|r| distribution.density(r) * weight(r)).sum()
        };
        let area = moment(&|r| r * r);
        let radius = moment(&|r| r * r * r) / area;
        let variance = moment(&|r| r * r * (r - 6.0).powi(2)) / (36.0 * area);
        assert_close(radius, 6.0, 1e-4, "effective radius");
        assert_close(variance, effective_variance, 1e-4, "effective variance");
    }
}

#[test]
fn water_has_the_refractive_index_of_the_reference() {
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let row = summary("6", name);
        let index = refractive_index(channel);
        // The reference prints five decimals and four digits.
        assert_close(index.n, row["n_real"], 6e-6, "n");
        assert_close(index.k, row["k_imag"], 1e-3 * index.k, "k");
    }
}

#[test]
fn progress_rises_to_the_end() {
    let highest = std::sync::Mutex::new(0.0_f64);
    let distribution = GammaDistribution { effective_radius_um: 1.0, effective_variance: 0.1 };
    droplets::average(&[distribution], 0.55, refractive_index(1), &[0.0], 2000, |share| {
        assert!((0.0..=1.0).contains(&share));
        let mut highest = highest.lock().unwrap();
        *highest = highest.max(share);
    });
    assert_close(*highest.lock().unwrap(), 1.0, 1e-3, "progress");
}

// The table

#[test]
fn table_matches_the_independent_solver_at_6_um() {
    let table = tables::mie(6.0).unwrap();
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let row = summary("6", name);
        assert_close(table.q_ext[channel], row["Qext"], 1e-3, "Q_ext");
        assert_close(table.asymmetry[channel], row["g"], 2e-4, "g");
        // Resonances narrower than any grid of radii carry a tenth of the absorption.
        assert_close(table.albedo[channel], row["ssa"], 3e-7, "albedo");
        let phase = tabulated(6.0, channel);
        assert_close(phase.asymmetry(), row["g"], 2e-4, "g of the interpolant");
        for (file, csv, worst, rms) in [("phase", PHASE, 0.01, 2.5e-3), ("forward", FORWARD, 0.005, 2e-3)] {
            let errors = errors(&phase, csv, channel);
            assert_small(&errors, worst, rms, &format!("{file} {name}"));
        }
    }
}

#[test]
fn table_matches_the_independent_solver_at_other_radii() {
    for radius in ["5", "10", "15"] {
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            let row = summary(radius, name);
            let table = tables::mie(radius.parse().unwrap()).unwrap();
            let phase = tabulated(radius.parse().unwrap(), channel);
            let what = |quantity| format!("{quantity} at {radius} um, {name}");
            assert_close(table.q_ext[channel], row["Qext"], 1e-3, &what("Q_ext"));
            assert_close(table.asymmetry[channel], row["g"], 2e-4, &what("g"));
            // The half float is within 5e-4, the normalisation within 1e-3 of that.
            for (theta, value) in [(0.0, row["P0_per_sr"]), (8.0, row["P8deg_per_sr"])] {
                assert_close(phase.value(f64::to_radians(theta)), value, 3e-3 * value, &what("P"));
            }
            // The reference's own average over radii is converged to 1 % here.
            assert_close(phase.value(PI), row["P180"], 1e-2 * row["P180"], &what("P(180)"));
            for (theta, share) in [(5.0, "frac_within_5deg"), (8.0, "frac_within_8deg")] {
                assert_close(phase.within(f64::to_radians(theta)), row[share], 1e-3, &what(share));
            }
        }
    }
}

#[test]
fn table_is_normalised_at_every_radius() {
    for radius in 4..=20 {
        for channel in CHANNELS {
            let table = tables::mie(f64::from(radius)).unwrap();
            let phase = tabulated(f64::from(radius), channel);
            assert_close(fine_integral(|theta| phase.value(theta)), 1.0, 2e-6, "integral");
            assert_close(phase.within(PI), 1.0, 1e-12, "closed form of the integral");
            let linear = linear_integral(&table.theta, &phase.values());
            assert_close(linear, 1.0, 1e-3, &format!("integral of linear P at {radius} um"));
            assert_close(phase.asymmetry(), table.asymmetry[channel], 2e-4, "g of the interpolant");
        }
    }
}

#[test]
fn half_floats_as_stored_are_normalised() {
    for entry in &stored().entries {
        for phase in &entry.phase {
            let theta: Vec<f64> = tables::mie(6.0).unwrap().theta;
            let raw: Vec<f64> = phase.iter().map(|value| value.to_f64()).collect();
            let scaled = Tabulated::new(theta, raw.clone()).unwrap().values();
            assert_close(raw[0] / scaled[0], 1.0, 1e-3, "integral before scaling");
        }
    }
}

#[test]
fn table_entry_recomputed_from_scratch_is_the_one_stored() {
    let channel = 0;
    let entry = &stored().entries[0];
    let picks: Vec<usize> = (0..stored().theta_deg.len()).step_by(60).collect();
    let theta: Vec<f64> = picks.iter().map(|&i| f64::from(stored().theta_deg[i]).to_radians()).collect();
    let bulk = computed(f64::from(entry.effective_radius_um), channel, &theta);
    assert_close(bulk.q_ext, f64::from(entry.q_ext[channel]), 2e-4, "Q_ext");
    assert_close(bulk.asymmetry, f64::from(entry.asymmetry[channel]), 2e-4, "g");
    for ((&i, theta), value) in picks.iter().zip(&theta).zip(&bulk.phase) {
        let stored = entry.phase[channel][i].to_f64();
        // A sixteenth of the table's radii.
        assert_close(*value, stored, 5e-3 * stored, &format!("P at {theta} rad"));
    }
}

#[test]
fn table_between_radii_is_close_to_a_computed_one() {
    // Where interpolation is worst; few radii at few angles, all of one side.
    let theta_deg = [0.0, 1.0, 3.0, 4.4, 6.0, 30.0, 90.0, 140.0, 150.0, 176.0, 178.0];
    let theta = theta_deg.map(f64::to_radians);
    let bulk = computed(4.5, 0, &theta);
    let phase = tabulated(4.5, 0);
    for (theta, value) in theta.into_iter().zip(&bulk.phase) {
        let error = phase.value(theta) / value - 1.0;
        assert!(error.abs() < 0.012, "{error} at {} deg", theta.to_degrees());
    }
}

#[test]
fn radius_outside_the_table_is_an_error_that_tells_the_range() {
    for radius in [3.99, 20.01, -1.0, f64::NAN] {
        let message = tables::mie(radius).unwrap_err().to_string();
        assert!(message.contains("from 4 to 20 um"), "{message}");
    }
}

#[test]
fn table_survives_encoding() {
    assert_eq!(stored().encode(), FILE);
    // Unequal sizes, none that of the file.
    let small = table::mie_tables(&[1.0, 1.5], 50, |_| ());
    assert_eq!(MieTables::decode(&small.encode()).unwrap(), small);
}

#[test]
fn any_corrupted_byte_is_an_error_that_names_the_table() {
    let every_header_byte = 0..64;
    let some_of_the_others = (64..FILE.len()).step_by(397);
    for i in every_header_byte.chain(some_of_the_others).chain([FILE.len() - 1]) {
        let mut bytes = FILE.to_vec();
        bytes[i] ^= 1;
        assert_names_the_table(&bytes);
    }
}

#[test]
fn short_foreign_or_newer_file_is_an_error_that_names_the_table() {
    for length in [0, 4, 12, 30, FILE.len() - 2] {
        assert_names_the_table(&FILE[..length]);
    }
    assert_names_the_table(b"P6 640 480 255 and then some pixels");
    // A consistent file of the next version, and one of another number of channels.
    for position in [8, 20] {
        let mut bytes = FILE[..FILE.len() - 8].to_vec();
        bytes[position] += 1;
        let checksum = fnv1a(&bytes);
        bytes.extend(checksum.to_le_bytes());
        assert_names_the_table(&bytes);
    }
}

#[test]
fn readme_lists_the_checksum_of_the_table() {
    let readme = include_str!("../../tables/README.md");
    let (content, stored) = FILE.split_last_chunk().unwrap();
    assert_eq!(fnv1a(content), u64::from_le_bytes(*stored));
    let checksum = format!("{:016x}", u64::from_le_bytes(*stored));
    assert!(readme.contains(&checksum), "tables/README.md must list {checksum}");
}

#[test]
fn table_that_cannot_be_written_is_an_error_before_it_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing").join("mie.bin");
    let error = table::write_mie_table(&path, |_| panic!("computed")).unwrap_err();
    assert!(matches!(&error, Error::Argument(text) if text.contains("missing")), "{error}");
}

// Phase functions

#[test]
fn phase_functions_integrate_to_one() {
    for (name, phase) in phases() {
        for channel in CHANNELS {
            let integral = fine_integral(|theta| phase.value(channel, theta));
            assert_close(integral, 1.0, 1e-5, &name);
        }
    }
}

#[test]
fn phase_functions_have_their_asymmetry() {
    for (name, phase) in phases() {
        for channel in CHANNELS {
            let mean = fine_integral(|theta| theta.cos() * phase.value(channel, theta));
            assert_close(mean, phase.asymmetry(channel), 1e-5, &name);
        }
    }
}

#[test]
fn henyey_greenstein_takes_an_asymmetry_between_minus_one_and_one() {
    for g in [1.0, -1.0, 1.5, f64::NAN] {
        assert!(matches!(Phase::henyey_greenstein(g), Err(Error::Argument(_))), "{g}");
    }
    assert_eq!(Phase::henyey_greenstein(0.0).unwrap().value(0, 1.0), 0.25 / PI);
}

#[test]
fn tabulated_phase_function_of_a_bad_grid_is_an_error() {
    let bad: [(&[f64], &[f64]); 6] = [
        (&[], &[]),
        (&[0.0, 1.0], &[1.0, 1.0]),
        (&[0.1, PI], &[1.0, 1.0]),
        (&[0.0, 2.0, 1.0, PI], &[1.0; 4]),
        (&[0.0, PI], &[1.0]),
        (&[0.0, PI], &[1.0, 0.0]),
    ];
    for (theta, values) in bad {
        let result = Tabulated::new(theta.to_vec(), values.to_vec());
        assert!(matches!(result, Err(Error::Argument(_))), "{theta:?} {values:?}");
    }
}

#[test]
fn tabulated_phase_function_goes_through_its_points_and_is_log_linear_between() {
    let table = Tabulated::new(vec![0.0, 0.5, PI], vec![4.0, 1.0, 2.0]).unwrap();
    let values = table.values();
    assert_close(values[0] / values[1], 4.0, 1e-12, "ratio");
    assert_close(table.value(0.5), values[1], 1e-12, "at a point");
    assert_close(table.value(0.25), (values[0] * values[1]).sqrt(), 1e-12, "half way");
    assert_close(table.value(4.0), values[2], 1e-12, "beyond the end");
    let part = fine_integral(|theta| if theta < 0.7 { table.value(theta) } else { 0.0 });
    assert_close(table.within(0.7), part, 1e-5, "share within 0.7 rad");
}

// The chopped peak

#[test]
fn wide_part_and_peak_add_up_to_the_phase_function() {
    for (name, chopped) in chopped() {
        for channel in CHANNELS {
            for theta_deg in [0.0, 0.5, 3.0, 7.0, 7.99, 8.0, 8.01, 9.0, 40.0, 139.0, 180.0] {
                let theta = f64::to_radians(theta_deg);
                let whole = chopped.phase().value(channel, theta);
                let (wide, peak) = (chopped.wide(channel, theta), chopped.peak(channel, theta));
                assert_close(wide + peak, whole, 1e-12 * whole, &name);
                assert!(peak >= 0.0 && wide > 0.0, "{name} at {theta_deg} deg: {peak}, {wide}");
            }
        }
    }
}

#[test]
fn peak_has_the_same_weight_in_all_channels_and_the_wide_part_the_rest() {
    for (name, chopped) in chopped() {
        for channel in CHANNELS {
            let wide = fine_integral(|theta| chopped.wide(channel, theta));
            let peak = fine_integral(|theta| chopped.peak(channel, theta));
            assert_close(wide, 1.0 - chopped.f, 1e-5, &format!("wide part of {name}"));
            assert_close(peak, chopped.f, 1e-5, &format!("peak of {name}"));
            let mean = fine_integral(|theta| theta.cos() * chopped.wide(channel, theta));
            assert_close(mean / (1.0 - chopped.f), chopped.asymmetry[channel], 1e-5, &name);
        }
    }
}

#[test]
fn phase_function_falls_up_to_where_the_cut_is_looked_for() {
    for radius in 4..=20 {
        for channel in CHANNELS {
            let phase = tabulated(f64::from(radius), channel);
            for i in 0..1600 {
                let [near, far] = [0, 1].map(|j| phase.value(f64::to_radians(0.01 * f64::from(i + j))));
                // Neighbours may be the same half float.
                assert!(near >= far, "{radius} um, channel {channel}, {} deg", 0.01 * f64::from(i));
            }
        }
    }
}

#[test]
fn green_is_cut_as_the_reference_and_the_others_at_the_same_weight() {
    for radius in ["5", "6", "10", "15"] {
        let chopped = Chopped::new(Phase::mie(radius.parse().unwrap()).unwrap());
        let row = summary(radius, "G");
        assert_close(chopped.f, row["f_chop_flat8"], 3e-4, "f");
        assert_close(chopped.asymmetry[1], row["g_chopped"], 3e-4, "g without the peak");
        let [red, green, blue] = chopped.cut_deg;
        assert_close(green, GREEN_CUT_DEG, 1e-12, "cut of green");
        assert!((8.0..9.5).contains(&red), "red is cut at {red}");
        assert!((6.5..8.0).contains(&blue), "blue is cut at {blue}");
        // The reference cuts them at 8 degrees, which moves g by up to 0.007.
        for channel in [0, 2] {
            assert_close(chopped.asymmetry[channel], row["g_chopped"], 1e-2, "g without the peak");
        }
    }
}

#[test]
fn light_in_the_three_places_adds_up() {
    for (name, chopped) in chopped() {
        for channel in CHANNELS {
            // The angular part of the recovered peak does not depend on tau.
            let unit = fine_integral(|theta| chopped.recovered_peak(channel, theta, 1.0));
            assert_close(unit, chopped.recovered_share(1.0), 1e-5, &name);
        }
        for tau in [0.0, 1e-9, 1e-3, 0.1, 1.0, 3.0, 10.0, 100.0, 1e4] {
            let untouched = f64::exp(-tau);
            let beyond = 1.0 - f64::exp(-(1.0 - chopped.f) * tau);
            let sum = untouched + chopped.recovered_share(tau) + beyond;
            assert_close(sum, 1.0, 1e-15 * 4.0, &format!("{name} at tau = {tau}"));
        }
    }
}

#[test]
fn recovered_peak_of_a_thin_layer_is_its_single_scattering() {
    let chopped = Chopped::new(Phase::mie(6.0).unwrap());
    let (theta, tau) = (0.02, 1e-9);
    let single = chopped.peak(1, theta) * tau;
    // The next term is of relative order tau; digits would be lost from e^-a - e^-b.
    assert_close(chopped.recovered_peak(1, theta, tau), single, 1e-8 * single, "T_p");
}

#[test]
fn phase_functions_without_a_table_have_no_peak() {
    for phase in [Phase::Isotropic, Phase::henyey_greenstein(0.85).unwrap()] {
        let chopped = Chopped::new(phase.clone());
        assert_eq!(chopped.f, 0.0);
        assert_eq!(chopped.asymmetry, [phase.asymmetry(0); 3]);
        assert_eq!(chopped.peak(0, 0.0), 0.0);
        assert_eq!(chopped.recovered_peak(0, 0.0, 1.0), 0.0);
        assert_eq!(chopped.wide(0, 0.0), phase.value(0, 0.0));
    }
}

// Helpers

fn assert_close(value: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (value - expected).abs();
    assert!(error <= tolerance, "{what}: {value}, expected {expected} within {tolerance}");
}

fn assert_small(errors: &[f64], worst: f64, rms: f64, what: &str) {
    let largest = errors.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
    let mean = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    eprintln!("{what}: worst {largest:.5}, rms {:.5}", mean.sqrt());
    assert!(largest <= worst, "{what}: worst error {largest}");
    assert!(mean.sqrt() <= rms, "{what}: rms error {}", mean.sqrt());
}

fn assert_names_the_table(bytes: &[u8]) {
    let error = MieTables::decode(bytes).unwrap_err();
    assert!(matches!(error, Error::Table { name: "mie.bin", .. }), "{error}");
    assert!(error.to_string().contains("mie.bin"), "{error}");
}

fn stored() -> &'static MieTables {
    static STORED: OnceLock<MieTables> = OnceLock::new();
    STORED.get_or_init(|| MieTables::decode(FILE).unwrap())
}

fn tabulated(radius_um: f64, channel: usize) -> Tabulated {
    match Phase::mie(radius_um).unwrap() {
        Phase::Tabulated(channels) => channels[channel].clone(),
        other => panic!("droplets have a table, not {other:?}"),
    }
}

/// Droplets computed here and now, with few radii: within 0.5 %.
fn computed(effective_radius_um: f64, channel: usize, theta: &[f64]) -> Bulk {
    let effective_variance = EFFECTIVE_VARIANCE;
    let distribution = GammaDistribution { effective_radius_um, effective_variance };
    let (wavelength_um, index) = (WAVELENGTHS_UM[channel], refractive_index(channel));
    droplets::average(&[distribution], wavelength_um, index, theta, 20_000, |_| ()).remove(0)
}

fn phases() -> Vec<(String, Phase)> {
    let mut phases = vec![("isotropic".to_owned(), Phase::Isotropic)];
    for g in [-0.6, 0.3, 0.85, 0.95] {
        phases.push((format!("HG {g}"), Phase::henyey_greenstein(g).unwrap()));
    }
    for radius in [4.0, 5.7, 6.0, 20.0] {
        phases.push((format!("Mie {radius} um"), Phase::mie(radius).unwrap()));
    }
    phases
}

fn chopped() -> Vec<(String, Chopped)> {
    phases().into_iter().map(|(name, phase)| (name, Chopped::new(phase))).collect()
}

/// Integral over the sphere by the midpoint rule, independent of the closed
/// forms under test. The steps grow from both ends, where the peaks are.
fn fine_integral(f: impl Fn(f64) -> f64) -> f64 {
    let steps = 40_000;
    // theta = pi (3 s^2 - 2 s^3) is dense at 0 and at pi.
    let sum: f64 = (0..steps)
        .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
        .map(|s| (PI * s * s * (3.0 - 2.0 * s), PI * 6.0 * s * (1.0 - s)))
        .map(|(theta, slope)| f(theta) * theta.sin() * slope)
        .sum();
    2.0 * PI * sum / f64::from(steps)
}

/// Integral over the sphere with P linear in theta between the angles.
fn linear_integral(theta: &[f64], values: &[f64]) -> f64 {
    let stretch = |i: usize| {
        let (a, b) = (theta[i], theta[i + 1]);
        let slope = (values[i + 1] - values[i]) / (b - a);
        values[i] * a.cos() - values[i + 1] * b.cos() + slope * (b.sin() - a.sin())
    };
    2.0 * PI * (0..theta.len() - 1).map(stretch).sum::<f64>()
}

/// Relative errors of a phase function at the angles of a reference file.
fn errors(phase: &Tabulated, csv: &str, channel: usize) -> Vec<f64> {
    let row = |line: &str| -> Vec<f64> { line.split(',').map(|v| v.parse().unwrap()).collect() };
    csv.lines()
        .skip(1)
        .map(row)
        .map(|row| phase.value(row[0].to_radians()) / row[channel + 1] - 1.0)
        .collect()
}

/// The numbers of the reference's summary for gamma-distributed droplets of
/// effective variance 0.10, by the name of their column.
fn summary(radius_um: &str, channel: &str) -> HashMap<&'static str, f64> {
    let mut lines = SUMMARY.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let row = lines.find(|row| row[..4] == ["gamma", radius_um, "0.1", channel]).unwrap();
    let numbers = header.into_iter().zip(row);
    numbers.filter_map(|(name, value)| Some((name, value.parse().ok()?))).collect()
}

/// FNV-1a, 64 bit, written apart from the one under test.
fn fnv1a(bytes: &[u8]) -> u64 {
    let mut hash = 14_695_981_039_346_656_037_u64;
    for byte in bytes {
        hash ^= u64::from(*byte);
        hash = hash.wrapping_mul(1_099_511_628_211);
    }
    hash
}
