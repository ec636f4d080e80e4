//! Light in slabs against numbers that others computed (`tests/data/slab`) and against what
//! holds for every slab.

use std::f64::consts::PI;

use nephos::optics::slab::study::{DEGREE, droplets};
use nephos::optics::slab::{Beam, Field, Medium, SETS, Solver};

/// Rows of a file of `tests/data/slab`; the reflecting side R becomes 0, the other, T, 1.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/data/slab/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the file is in the repository");
    let number = |cell: &str| match cell {
        "R" => 0.0,
        "T" => 1.0,
        cell => cell.parse().expect("the file has numbers"),
    };
    let numbers = |line: &str| line.split(',').map(number).collect();
    text.lines().skip(1).map(numbers).collect()
}

fn chopped() -> Solver {
    Solver::new(Medium::chopped(&droplets().expect("the Mie table is whole"), DEGREE))
}

/// Reflected and transmitted shares of the sun's flux, of all orders.
fn fluxes(field: &Field) -> [f64; 2] {
    let parts = (0..SETS).map(|set| field.fluxes(set)).chain([field.single_fluxes()]);
    parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
}

/// The reference's columns are: thickness, solar zenith angle in degrees, R, T.
fn check_fluxes(solver: &Solver, rows: impl Iterator<Item = [f64; 4]>) {
    for [thickness, sun_deg, reflected, transmitted] in rows {
        let mu0 = sun_deg.to_radians().cos();
        let [r, t] = fluxes(&solver.solve(Beam { thickness, mu0 }, 0));
        let whole = r + t + (-thickness / mu0).exp();
        let slab = format!("thickness {thickness}, sun at {sun_deg} degrees");
        assert!((whole - 1.0).abs() < 1e-3, "{slab}: shares of the light add up to {whole}");
        // Levels grow by 12 % a step; the reference has 128 streams.
        assert!((r - reflected).abs() < 1e-3, "{slab}: R {r} for {reflected}");
        assert!((t - transmitted).abs() < 1e-3, "{slab}: T {t} for {transmitted}");
    }
}

#[test]
fn henyey_greenstein_has_the_fluxes_of_discrete_ordinates() {
    let solver = Solver::new(Medium::henyey_greenstein(0.85, DEGREE));
    check_fluxes(&solver, rows("hg085_flux_NQ128.csv").iter().map(|row| [row[0], row[1], row[2], row[3]]));
}

#[test]
fn droplets_have_the_fluxes_of_discrete_ordinates() {
    let rows = rows("chopped_re06_G_NQ128_flux.csv");
    check_fluxes(&chopped(), rows.iter().map(|row| [row[1], row[2], row[3], row[4]]));
}

/// What single scattering adds to the radiance that leaves by the lit face (side 0) and the other.
fn single(beam: Beam, side: usize, mu: f64, phase: f64) -> f64 {
    let Beam { thickness, mu0 } = beam;
    let weight = if side == 0 {
        mu0 / (mu0 + mu) * (1.0 - (-thickness * (1.0 / mu0 + 1.0 / mu)).exp())
    } else if (mu - mu0).abs() < 1e-9 {
        thickness / mu * (-thickness / mu).exp()
    } else {
        mu0 / (mu0 - mu) * ((-thickness / mu0).exp() - (-thickness / mu).exp())
    };
    phase * weight
}

#[test]
fn droplets_have_the_radiance_of_discrete_ordinates_but_for_the_glory() {
    let phase = droplets().expect("the Mie table is whole");
    let solver = chopped();
    let all = rows("chopped_re06_G_NQ128_radiance.csv");
    let (mut squares, mut count, mut worst) = (0.0, 0.0, 0.0_f64);
    for (tau, sun_deg) in [(1.0, 60.0), (10.0, 30.0), (10.0, 80.0), (100.0, 0.0), (100.0, 60.0)] {
        let mu0 = f64::to_radians(sun_deg).cos();
        let beam = Beam { thickness: tau * (1.0 - phase.f), mu0 };
        let field = solver.solve(beam, DEGREE);
        for view_deg in (0..=80).step_by(20).map(f64::from) {
            let mine: Vec<_> = all.iter().filter(|row| row[..3] == [tau, sun_deg, view_deg]).collect();
            let azimuths: Vec<f64> = mine.iter().map(|row| row[3].to_radians()).collect();
            let mu = view_deg.to_radians().cos();
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                let level = side * (field.depths().len() - 1);
                let sets: Vec<_> = (0..SETS).map(|set| field.radiance(set, sign * mu, &azimuths)).collect();
                for (i, row) in mine.iter().enumerate() {
                    let (angle_deg, truth) = (row[4 + 2 * side], row[5 + 2 * side]);
                    if angle_deg > 170.0 {
                        continue;
                    }
                    let value = phase.wide(1, angle_deg.to_radians()) / (1.0 - phase.f);
                    let many: f64 = sets.iter().map(|set| set[i][level]).sum();
                    let error = (many + single(beam, side, mu, value)) * PI / mu0 / truth - 1.0;
                    squares += error * error;
                    count += 1.0;
                    worst = worst.max(error.abs());
                }
            }
        }
    }
    let rms = f64::sqrt(squares / count);
    // Of what the tables must have, 1 % and 5 %, the solver may use a tenth and a fifth.
    assert!(count > 200.0 && rms < 1e-3 && worst < 1e-2, "rms {rms}, worst {worst} of {count}");
}

/// Within the noise of the reference, its last digit, and 2 %.
fn agrees(found: f64, truth: f64, sigma: f64) -> bool {
    // Four sigma: hundreds of numbers are compared.
    (found - truth).abs() < 4.0 * sigma + 2e-6 + 0.02 * truth
}

#[test]
fn sets_of_orders_have_the_fluxes_of_a_path_tracer() {
    let solver = chopped();
    let rows = rows("chopped_orders_flux_G.csv");
    for row in &rows {
        let side = row[3] as usize;
        let field = solver.solve(Beam { thickness: row[1], mu0: row[2].to_radians().cos() }, 0);
        for set in 0..SETS {
            let (found, truth) = (field.fluxes(set)[side], row[5 + set]);
            // Shares of photons; correlated estimates of the reference do not do worse.
            let sigma = (truth.max(1e-6) / row[13]).sqrt();
            assert!(agrees(found, truth, sigma), "set {set}, {row:?}: {found} for {truth}");
        }
    }
}

#[test]
fn sets_of_orders_have_the_radiance_of_a_path_tracer() {
    let solver = chopped();
    let rows = rows("chopped_orders_radiance_G.csv");
    let mut solved: Vec<Field> = Vec::new();
    for row in rows.iter().filter(|row| row[2] == 60.0 || row[0] == 10.0) {
        let beam = Beam { thickness: row[1], mu0: row[2].to_radians().cos() };
        if solved.last().is_none_or(|field| field.beam() != beam) {
            solved.push(solver.solve(beam, DEGREE));
        }
        let field = &solved[solved.len() - 1];
        let transmitted = row[3] == 1.0;
        let level = if transmitted { field.depths().len() - 1 } else { 0 };
        let mu = row[4].to_radians().cos() * if transmitted { 1.0 } else { -1.0 };
        for set in 0..SETS {
            let radiance = field.radiance(set, mu, &[row[5].to_radians()])[0][level];
            let (found, truth) = (radiance * PI / beam.mu0, row[7 + set]);
            // The file has the noise of the sum: of n even photons the sum is n w and the
            // variance n w^2, and a set without any may have had one.
            let weight = row[15] * row[15] / row[14];
            let sigma = (weight * truth.max(weight)).sqrt();
            assert!(agrees(found, truth, sigma), "set {set}, {row:?}: {found} for {truth}");
        }
    }
}

#[test]
fn light_goes_the_same_way_back() {
    let solver = chopped();
    let (a, b, thickness) = (0.8, 0.35, 6.0);
    let [from_a, from_b] = [a, b].map(|mu0| solver.solve(Beam { thickness, mu0 }, DEGREE));
    for phi in [0.3, 2.0] {
        for set in 0..SETS {
            // R over the sun's cosine is the same both ways; so is T through an even slab.
            for sign in [-1.0, 1.0] {
                let level = if sign < 0.0 { 0 } else { from_a.depths().len() - 1 };
                let there = from_a.radiance(set, sign * b, &[phi])[0][level] / a;
                let back = from_b.radiance(set, sign * a, &[phi])[0][level] / b;
                // The levels' step.
                assert!((there / back - 1.0).abs() < 2e-3, "set {set}, {phi} {sign}: {there} {back}");
            }
        }
    }
}

#[test]
fn isotropic_scattering_reflects_as_chandrasekhar_has_it() {
    let conservative = rows("chandrasekhar_H.csv").into_iter().find(|row| row[0] == 1.0);
    let h = conservative.expect("the table has the row of albedo 1");
    let solver = Solver::new(Medium::henyey_greenstein(0.0, 2));
    for sun in [2, 5, 10] {
        let mu0 = sun as f64 / 10.0;
        let field = solver.solve(Beam { thickness: 60.0, mu0 }, 0);
        let last = field.depths().len() - 1;
        for view in [1, 3, 6, 10] {
            let mu = view as f64 / 10.0;
            // What a thick slab lets through is what it lacks in reflection.
            let sum: f64 = (0..SETS)
                .map(|set| field.radiance(set, -mu, &[0.0])[0][0] + field.radiance(set, mu, &[0.0])[0][last])
                .sum();
            let right = mu0 / (mu0 + mu) * (h[sun] * h[view] - 1.0) / (4.0 * PI);
            assert!((sum / right - 1.0).abs() < 2e-3, "sun {mu0}, view {mu}: {sum} for {right}");
        }
    }
}
