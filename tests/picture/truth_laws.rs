//! The path tracer against what holds for light in any cloud: Beer and Lambert, the mean path of
//! light that comes from all sides, reciprocity; and against slabs and spheres by others.
#![cfg(feature = "export")]

use crate::common;

use common::{
    picture::{draw, renderer, scene},
    truth::{
        DISC, EXTINCTION_PER_CM3, HG, Measured, assert_agree, by_batches, chi_square_z, look_from, mean,
        noisy, opacity, sphere, trace, trace_with, tracer,
    },
};
use glam::{DMat3, DQuat, DVec3};
use nephos::{
    reference::PathOptions,
    render::{Quality, Transport},
    scene::{Projection, Scene},
};

/// A sky that shines everywhere alike and no sun: what leaves a cloud that absorbs nothing is 1.
const FURNACE: &str = r#"{"uniform": {"radiance": [1, 1, 1]}}"#;

fn seed(seed: u32) -> PathOptions {
    PathOptions { seed, ..PathOptions::default() }
}

/// The mean number of collisions of a path, over the picture: what droplets that absorb one photon
/// in 4096 take from a furnace. Twice collided light makes it too small by at most a thousandth
/// where the mean number is below 4.
fn collisions(scene: &Scene, seed: u32, batches: u32, samples: u32) -> Measured {
    const ABSORBED: f64 = 1.0 / 4096.0;
    let mut scene = scene.clone();
    scene.clouds.iter_mut().for_each(|cloud| cloud.droplets.albedo = 1.0 - ABSORBED);
    // Where the phase function alone chooses directions, all paths weigh the same.
    let mut tracer = tracer(&scene, [16, 16], &PathOptions { guided: false, ..self::seed(seed) });
    // All three channels together: what one of them lacks on a path, another one has.
    let light = |estimate: &_| [0, 1, 2].map(|c| mean(estimate, c).value).iter().sum::<f64>() / 3.0;
    let lost = |estimate: &_| (opacity(estimate) - light(estimate)) / ABSORBED;
    by_batches(&mut tracer, batches, samples, lost)
}

#[test]
fn light_from_all_sides_goes_four_volumes_over_surface_in_a_sphere() {
    // 4/3 of a radius whatever scatters: times the extinction, the mean number of collisions.
    let of = |name: &str, phase: &str, radius: f64, samples| {
        let found = collisions(&sphere(radius, phase, FURNACE, [0.0, 1.0, 0.0], 0.0), 1, 12, samples);
        (name.to_owned(), found, Measured::exact(DISC * 4.0 / 3.0 * radius))
    };
    assert_agree(&[
        of("isotropic", "\"isotropic\"", 1.0, 48),
        of("Henyey-Greenstein", HG, 2.5, 120),
        of("Mie", "\"mie\"", 2.5, 48),
    ]);
}

/// Corners of an icosahedron: means over them are means over the sphere for what has no harmonics
/// above the fifth.
fn all_around() -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let corners = |[a, b]: [f64; 2]| {
        let (a, b) = (a, b * golden);
        [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]
    };
    signs.into_iter().flat_map(corners).map(DVec3::normalize).collect()
}

#[test]
fn light_from_all_sides_counts_every_droplet_of_a_noisy_cloud() {
    // Inside a furnace radiance is 1, so that collisions, summed over pictures from all sides, are
    // the integral of the extinction. The renderer has it, too: as the opacity of a thin cloud.
    let mut thin = noisy("\"isotropic\"", 0.1, DVec3::Z);
    thin.sun.irradiance = [0.0; 3];
    let mut renderer = renderer(Quality::FINAL, Transport::EMITTER);
    let picture = draw(&mut renderer, &thin, [256, 256], false);
    let mass: f64 = picture.pixels.iter().map(|pixel| -f64::from(1.0 - pixel[3]).ln()).sum::<f64>();
    let mass = 200.0 * mass / (256.0 * 256.0);
    // Pictures of one seed would share the first random numbers, and their errors.
    let sides: Vec<_> = (1..)
        .zip(all_around())
        .map(|(seed, to_eye)| {
            let mut scene = noisy(HG, 20.0, to_eye);
            scene.sky = serde_json::from_str(FURNACE).unwrap();
            scene.sun.irradiance = [0.0; 3];
            collisions(&scene, seed, 8, 48)
        })
        .collect();
    // Half floats of the thin picture, steps of its march.
    let wanted = Measured { value: mass, error: 1e-3 * mass };
    assert_agree(&[("collisions".to_owned(), Measured::mean(&sides), wanted)]);
}

#[test]
fn free_paths_in_a_noisy_cloud_end_where_the_march_has_its_opacity() {
    let mut scene = noisy("\"isotropic\"", 20.0, DVec3::new(0.3, 0.2, 0.9));
    scene.sun.irradiance = [0.0; 3];
    let found = opacity(&trace(&scene, [32, 32], 1920));
    let mut renderer = renderer(Quality::FINAL, Transport::EMITTER);
    let picture = draw(&mut renderer, &scene, [256, 256], false);
    let wanted = picture.pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / (256.0 * 256.0);
    let error = (wanted * (1.0 - wanted) / (32.0 * 32.0 * 1920.0)).sqrt();
    let found = Measured { value: found, error };
    assert_agree(&[("opacity".to_owned(), found, Measured { value: wanted, error: 1e-3 * wanted })]);
}

#[test]
fn rays_through_an_ellipsoid_obey_beer_and_lambert() {
    let scene = scene(
        r#"{"clouds": [{"edge": {"boundary": 0},
            "droplets": {"phase": "isotropic", "concentration_per_cm3": 100},
            "ellipsoids": [{"center": [30, 1000, -20], "radii": [120, 40, 80],
                "orientation": [0.2, 0.3, 0.1, 0.9273618495495703]}]}],
        "sky": "none", "sun": {"irradiance": [0, 0, 0]},
        "camera": {"position": [300, 1200, 400], "target": [30, 1000, -20],
            "projection": {"orthographic": {"height": 260}}}}"#,
    );
    let (size, samples) = ([24, 16], 600);
    let found = trace(&scene, size, samples);
    let (mut chi_square, mut freedom) = (0.0, 0);
    for (i, wanted) in ellipsoid_opacities(&scene, size).into_iter().enumerate() {
        let variance = wanted * (1.0 - wanted) / f64::from(samples);
        // Where a handful of paths collide, numbers of them are not normal.
        if wanted * f64::from(samples) > 9.0 {
            chi_square += (f64::from(found.mean[i][3]) - wanted).powi(2) / variance;
            freedom += 1;
        } else if wanted == 0.0 {
            assert_eq!(found.mean[i][3], 0.0);
        }
    }
    let z = chi_square_z(chi_square, freedom);
    eprintln!("{freedom} pixels, z = {z:.2}");
    // Pixels are sampled evenly and not by strata, at most as scattered as this: one side only.
    assert!(freedom >= 80 && z < 3.1 && z > -6.0, "{chi_square} of {freedom} pixels");
}

/// Mean opacity of each pixel of an orthographic picture of one ellipsoid: 1 - e^{-k_e s}, with
/// the chord s = 2 sqrt(B^2 - DC)/D where u = A o, v = A d, B = u.v, C = u.u - 1, D = v.v.
fn ellipsoid_opacities(scene: &Scene, [width, height]: [u32; 2]) -> Vec<f64> {
    const ACROSS: u32 = 24;
    let (camera, e) = (scene.camera(), &scene.clouds[0].ellipsoids[0]);
    let Projection::Orthographic { height: metres } = camera.projection else { panic!("orthographic only") };
    let (world, turn) = (camera.world_from_camera(), DMat3::from_quat(e.orientation).transpose());
    let extinction = EXTINCTION_PER_CM3 * scene.clouds[0].droplets.concentration_per_cm3;
    let v = turn * (world * DVec3::NEG_Z) / e.radii;
    let opacity = |x: f64, y: f64| {
        let across = metres / f64::from(height) * DVec3::new(x, y, 0.0);
        let u = turn * (camera.position + world * across - e.center) / e.radii;
        let (b, c, d) = (u.dot(v), u.dot(u) - 1.0, v.dot(v));
        1.0 - (-extinction * 2.0 * (b * b - d * c).max(0.0).sqrt() / d).exp()
    };
    let place = |pixel: u32, i: u32| f64::from(pixel) + (f64::from(i) + 0.5) / f64::from(ACROSS);
    let pixel = |i: u32| {
        let points = (0..ACROSS * ACROSS).map(|k| {
            let x = place(i % width, k % ACROSS) - 0.5 * f64::from(width);
            let y = 0.5 * f64::from(height) - place(i / width, k / ACROSS);
            opacity(x, y)
        });
        points.sum::<f64>() / f64::from(ACROSS * ACROSS)
    };
    (0..width * height).map(pixel).collect()
}

#[test]
fn light_goes_the_same_way_back() {
    // Light of the sun that reaches the eye, summed over the picture: sun and eye may change places.
    let light = |to_eye: DVec3, to_sun: DVec3, number: u32| {
        // Less forward than droplets, for less noise: the law holds for all.
        let mut scene = noisy(r#"{"henyey_greenstein": {"g": 0.5}}"#, 120.0, to_eye);
        scene.sun.position = nephos::scene::SunPosition::Direction(to_sun);
        let picture = trace_with(&scene, [16, 16], 720, &seed(number));
        mean(&picture, 1)
    };
    let pairs = [
        ("aside", DVec3::new(0.2, 0.3, 0.9), DVec3::new(0.8, 0.5, -0.1)),
        ("against", DVec3::new(0.9, 0.1, 0.3), DVec3::new(-0.7, 0.6, 0.2)),
    ];
    let results = pairs.map(|(name, a, b)| (name.to_owned(), light(a, b, 1), light(b, a, 2)));
    assert_agree(&results);
}

/// Reflected and transmitted shares of the sun's flux by a slab: an ellipsoid 240 times as wide as
/// thick, with the camera close to the middle of the face that faces the sun, or of the other one,
/// taking a panorama. Seen at a hundredth of its radius, it is thinner by a ten thousandth.
fn slab_flux(phase: &str, thickness: f64, sun_deg: f64, transmitted: bool, samples: u32) -> Measured {
    const ROWS: u32 = 64;
    let (height, per_cm3) = (if transmitted { 998.9 } else { 1001.1 }, 0.5 * thickness / EXTINCTION_PER_CM3);
    let (sine, mu0) = sun_deg.to_radians().sin_cos();
    let scene = scene(&format!(
        r#"{{"clouds": [{{"edge": {{"boundary": 0}},
            "droplets": {{"phase": {phase}, "concentration_per_cm3": {per_cm3}}},
            "ellipsoids": [{{"center": [0, 1000, 0], "radii": [240, 1, 240]}}]}}],
        "sky": "none", "sun": {{"position": {{"direction": [{sine}, {mu0}, 0]}}, "irradiance": [1, 1, 1]}},
        "camera": {{"position": [0, {height}, 0], "target": [0, {height}, -10],
            "projection": "equirectangular"}}}}"#
    ));
    let found = trace(&scene, [4, ROWS], samples);
    // The flux through the face that a row of the panorama stands for, at radiance 1.
    let row = |i: usize| {
        let edge = |row: f64| (std::f64::consts::PI * (0.5 - row / f64::from(ROWS))).sin().powi(2);
        let i = (i / 4) as f64;
        0.25 * std::f64::consts::PI * (edge(i) - edge(i + 1.0)).abs()
    };
    let value: f64 = found.mean.iter().enumerate().map(|(i, pixel)| row(i) * f64::from(pixel[1])).sum();
    let variance: f64 =
        found.error.iter().enumerate().map(|(i, error)| (row(i) * f64::from(error[1])).powi(2)).sum();
    Measured { value, error: variance.sqrt() }.times(1.0 / mu0)
}

/// A row of a file of `tests/data/slab`: thickness and solar zenith angle, R and T.
fn reference(name: &str, thickness: f64, sun_deg: f64) -> [f64; 2] {
    let path = format!("{}/tests/data/slab/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let columns: Vec<_> = text.lines().next().unwrap().split(',').collect();
    let place = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let [tau, sun, reflected, diffuse] = ["tau", "sza_deg", "R_plane_albedo", "T_diffuse"].map(place);
    let rows = text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect());
    let row = |row: &Vec<f64>| row[tau] == thickness && row[sun] == sun_deg;
    let found: Vec<f64> = { rows }.find(row).unwrap();
    [found[reflected], found[diffuse]]
}

/// Slabs of `phase`, by thickness, sun and side (0 lit, 1 not), against those of a file.
fn assert_slabs(phase: &str, file: &str, samples: u32, slabs: &[(f64, f64, usize)]) {
    let slab = |&(thickness, sun_deg, side): &(f64, f64, usize)| {
        let wanted = reference(file, thickness, sun_deg)[side];
        let found = slab_flux(phase, thickness, sun_deg, side == 1, samples);
        // What the ellipsoid's curvature and the rows of the panorama may do.
        let wanted = Measured { value: wanted, error: 5e-4 * wanted };
        (format!("thickness {thickness}, {sun_deg} degrees, side {side}"), found, wanted)
    };
    assert_agree(&slabs.iter().map(slab).collect::<Vec<_>>());
}

const SLABS_HG: &str = "hg085_flux_NQ128.csv";
const SLABS_MIE: &str = "mie_re06_G_NQ128_flux.csv";

#[test]
fn slabs_have_the_fluxes_of_discrete_ordinates() {
    assert_slabs(HG, SLABS_HG, 960, &[(1.0, 60.0, 0), (1.0, 60.0, 1), (10.0, 30.0, 0), (10.0, 30.0, 1)]);
    assert_slabs("\"mie\"", SLABS_MIE, 480, &[(10.0, 60.0, 0)]);
}

#[test]
#[ignore = "minutes: the same, sharper"]
fn slabs_have_the_fluxes_of_discrete_ordinates_to_half_a_percent() {
    assert_slabs(HG, SLABS_HG, 6000, &[(10.0, 30.0, 0), (10.0, 30.0, 1)]);
    assert_slabs("\"mie\"", SLABS_MIE, 6000, &[(10.0, 60.0, 0)]);
}

/// Cosines of scattering and weights for integrals from -1 to 0: Gauss and Legendre's, four of them.
const BACKWARD: [(f64, f64); 4] = [
    (-0.930_568_155_797_026, 0.173_927_422_568_727),
    (-0.669_990_521_792_428, 0.326_072_577_431_273),
    (-0.330_009_478_207_572, 0.326_072_577_431_273),
    (-0.069_431_844_202_974, 0.173_927_422_568_727),
];

#[test]
fn a_sphere_sends_back_as_much_as_others_found() {
    // Of Henyey-Greenstein spheres in a beam, columns tau_radius, backward_hemisphere_fraction of
    // sphere_integrals.csv, a Monte Carlo of about 2e5 photons.
    let of = |radius: f64, wanted: f64| {
        let mut number = 0;
        let parts = BACKWARD.map(|(mu, weight)| {
            number += 1;
            let to_sun = [(1.0 - mu * mu).sqrt(), 0.0, -mu];
            let scene = sphere(radius, HG, "\"none\"", to_sun, 1.0);
            // Radiance over the square, in units of the disc that the beam meets.
            let found = mean(&trace_with(&scene, [16, 16], 480, &seed(number)), 1).times(1.0 / DISC);
            found.times(4.0 * 2.0 * std::f64::consts::PI * weight)
        });
        let wanted = Measured { value: wanted, error: (wanted * (1.0 - wanted) / 2e5).sqrt() };
        (format!("radius {radius}"), Measured::mean(&parts), wanted)
    };
    assert_agree(&[of(2.5, 0.12897), of(5.0, 0.24478)]);
}

#[test]
fn the_camera_turns_with_the_ellipsoid() {
    // What a turned cloud shows to a turned camera is what it showed before: no axis is preferred.
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 1.1);
    let light = |turn: DQuat, number: u32| {
        let mut scene = sphere(3.0, HG, "\"none\"", [0.0, 1.0, 0.0], 1.0);
        let e = &mut scene.clouds[0].ellipsoids[0];
        (e.radii, e.orientation) = (DVec3::new(40.0, 90.0, 60.0), turn);
        scene.sun.position = nephos::scene::SunPosition::Direction(turn * DVec3::new(0.5, 0.2, 0.7));
        look_from(&mut scene, turn * DVec3::new(0.1, 0.3, 1.0));
        mean(&trace_with(&scene, [16, 16], 360, &seed(number)), 1)
    };
    assert_agree(&[("turned".to_owned(), light(turn, 1), light(DQuat::IDENTITY, 2))]);
}
