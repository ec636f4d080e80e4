//! Slabs against numbers that others computed: `tests/data/slab`.

use nephos::optics::{
    peak::Chopped,
    phase::Phase,
    slab::{Beam, Field, Medium, SETS, Solver},
};

/// Rows of a file of `tests/data/slab`, as numbers; words become NaN.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/data/slab/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the file is in the repository");
    text.lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect()
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
        println!(
            "{:5} {:3} R {r:.6} {:+.2e} T {t:.6} {:+.2e} sum {:+.2e} {:.2?} n {}",
            row[0],
            row[1],
            r / row[2] - 1.0,
            t / row[3] - 1.0,
            sum - 1.0,
            started.elapsed(),
            field.depths().len()
        );
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
        println!(
            "{:5} {:3} R {r:.6} {:+.2e} T {t:.6} {:+.2e} sum {:+.2e} {:.2?}",
            row[0],
            row[2],
            r / row[3] - 1.0,
            t / row[4] - 1.0,
            sum - 1.0,
            started.elapsed()
        );
    }
}

#[test]
fn chopped_radiance() {
    let phase = Chopped::new(Phase::mie(6.0).expect("in range"));
    let medium = Medium::chopped(&phase, 64);
    let solver = Solver::new(medium.clone());
    let all = rows("chopped_re06_G_NQ128_radiance.csv");
    for tau in [1.0, 10.0, 100.0] {
        for sza in [0.0, 30.0, 60.0, 80.0f64] {
            let mu0 = sza.to_radians().cos();
            let started = std::time::Instant::now();
            let beam = Beam { thickness: tau * 0.5506, mu0 };
            let field = solver.solve(beam, 64);
            let t1 = started.elapsed();
            let mut worst = [(0.0f64, String::new()), (0.0, String::new())];
            let mut square = [0.0f64; 2];
            let mut n = 0.0;
            for vza in (0..=80).step_by(10) {
                let mine: Vec<_> =
                    all.iter().filter(|r| r[0] == tau && r[1] == sza && r[2] == vza as f64).collect();
                let phi: Vec<f64> = mine.iter().map(|r| r[3].to_radians()).collect();
                let mu = (vza as f64).to_radians().cos();
                let last = field.depths().len() - 1;
                let mut sums = vec![[0.0; 2]; phi.len()];
                for set in 0..SETS {
                    let up = field.radiance(set, -mu, &phi);
                    let down = field.radiance(set, mu, &phi);
                    for i in 0..phi.len() {
                        sums[i][0] += up[i][0];
                        sums[i][1] += down[i][last];
                    }
                }
                for (i, row) in mine.iter().enumerate() {
                    let sine = ((1.0 - mu * mu) * (1.0 - mu0 * mu0)).sqrt();
                    for side in 0..2 {
                        let sign = if side == 0 { -1.0 } else { 1.0 };
                        let cosine = (sign * mu * mu0 + sine * phi[i].cos()).clamp(-1.0, 1.0);
                        let p = phase.wide(1, cosine.acos()) / (1.0 - phase.f);
                        let path = if side == 0 {
                            mu0 / (mu0 + mu) * (1.0 - (-beam.thickness * (1.0 / mu0 + 1.0 / mu)).exp())
                        } else if (mu - mu0).abs() < 1e-9 {
                            beam.thickness / mu * (-beam.thickness / mu).exp()
                        } else {
                            mu0 / (mu0 - mu) * ((-beam.thickness / mu0).exp() - (-beam.thickness / mu).exp())
                        };
                        let mine = (sums[i][side] + p * path) * std::f64::consts::PI / mu0;
                        let truth = row[if side == 0 { 5 } else { 7 }];
                        let e = mine / truth - 1.0;
                        square[side] += e * e;
                        n += 0.5;
                        if e.abs() > worst[side].0 {
                            worst[side] = (
                                e.abs(),
                                format!(
                                    "vza {vza} raa {} scat {}",
                                    row[3],
                                    row[if side == 0 { 4 } else { 6 }]
                                ),
                            );
                        }
                    }
                }
            }
            println!(
                "tau {tau} sza {sza}: rms R {:.5} T {:.5} worst R {:?} T {:?} {:.2?}",
                (square[0] / n).sqrt(),
                (square[1] / n).sqrt(),
                worst[0],
                worst[1],
                t1
            );
        }
    }
}
