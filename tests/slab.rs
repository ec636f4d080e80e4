//! Slabs against numbers that others computed: `tests/data/slab`.

use nephos::optics::{peak::Chopped, phase::Phase, slab::{Beam, Field, Medium, SETS, Solver}};

/// Rows of a file of `tests/data/slab`, as numbers; words become NaN.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/data/slab/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the file is in the repository");
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect()
}

fn flux(field: &Field) -> [f64; 2] {
    let mut sum = field.single_fluxes();
    for set in 0..SETS {
        let part = field.fluxes(set);
        sum = [sum[0] + part[0], sum[1] + part[1]];
    }
    sum
}

#[test]
fn henyey_greenstein_reflects_as_discrete_ordinates_do() {
    let solver = Solver::new(Medium::henyey_greenstein(0.85, 64));
    for row in rows("hg085_flux_NQ128.csv") {
        let mu0 = row[1].to_radians().cos();
        let started = std::time::Instant::now();
        let field = solver.solve(Beam { thickness: row[0], mu0 }, 0);
        let [r, t] = flux(&field);
        let sum = r + t + (-row[0] / mu0).exp();
        println!("{:5} {:3} R {r:.6} {:+.2e} T {t:.6} {:+.2e} sum {:+.2e} {:.2?} n {}", row[0], row[1], r / row[2] - 1.0, t / row[3] - 1.0, sum - 1.0, started.elapsed(), field.depths().len());
    }
}

#[test]
fn chopped_fluxes() {
    let phase = Chopped::new(Phase::mie(6.0).expect("in range"));
    let solver = Solver::new(Medium::chopped(&phase, 64));
    println!("{:?}", &Medium::chopped(&phase, 64).chi[..8]);
    for row in rows("chopped_re06_G_NQ128_flux.csv") {
        let mu0 = row[2].to_radians().cos();
        let started = std::time::Instant::now();
        let field = solver.solve(Beam { thickness: row[1], mu0 }, 0);
        let [r, t] = flux(&field);
        let sum = r + t + (-row[1] / mu0).exp();
        println!("{:5} {:3} R {r:.6} {:+.2e} T {t:.6} {:+.2e} sum {:+.2e} {:.2?}", row[0], row[2], r / row[3] - 1.0, t / row[4] - 1.0, sum - 1.0, started.elapsed());
    }
}
