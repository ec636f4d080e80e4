//! Meshes that are boundaries: distances from their surface, and what is refused.

use std::{f64::consts::TAU, fs};

use glam::DVec3;
use nephos::scene::{Scene, Surface};

/// A ring of tubes around Y: radii of the ring and of the tube, m, and corners along each.
fn torus([ring, tube]: [f64; 2], [along, around]: [u32; 2]) -> Surface {
    let corner = |i: u32, j: u32| {
        let [a, b] = [(i, along), (j, around)].map(|(i, n)| TAU * f64::from(i % n) / f64::from(n));
        let out = ring + tube * b.cos();
        DVec3::new(out * a.cos(), tube * b.sin(), out * a.sin())
    };
    let positions: Vec<_> = (0..along * around).map(|n| corner(n / around, n % around)).collect();
    let at = |i: u32, j: u32| i % along * around + j % around;
    let quads = (0..along).flat_map(|i| (0..around).map(move |j| (i, j)));
    let triangles: Vec<_> = quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Surface::new(&positions, &triangles).unwrap()
}

#[test]
fn depths_below_a_ring_are_those_of_its_formula_and_its_hole_is_clear() {
    let ring = torus([100.0, 40.0], [192, 96]);
    assert_eq!(ring.openness(), 0.0);
    // Chords of its corners lie inside, by radius times half the square of half the angle between them.
    let sagitta = 140.0 * 0.5 * (TAU / 192.0 / 2.0).powi(2) + 40.0 * 0.5 * (TAU / 96.0 / 2.0).powi(2);
    for i in 0..3000u32 {
        let unit = |k: f64| (f64::from(i) * k).fract() - 0.5;
        let p = DVec3::new(320.0 * unit(0.618_034), 120.0 * unit(0.754_878), 320.0 * unit(0.569_840));
        let exact = 40.0 - (p.with_y(0.0).length() - 100.0).hypot(p.y);
        let found = ring.depth(p);
        // Beside the tube's middle, which is as far from all sides, flat sides are nearer by more.
        assert!((found - exact).abs() < 1.5 * sagitta, "{p}: {found} for {exact}");
    }
    assert!(ring.depth(DVec3::ZERO) < -59.0);
}

#[test]
fn what_is_no_boundary_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("empty.obj"), "v 0 0 0\n").unwrap();
    fs::write(folder.path().join("sheet.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n").unwrap();
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    fs::write(folder.path().join("good.obj"), tetrahedron).unwrap();
    let refused = |cloud: &str| {
        let file = folder.path().join("scene.json");
        fs::write(&file, format!(r#"{{"clouds": [{cloud}]}}"#)).unwrap();
        Scene::load(&file).map(drop).unwrap_err().to_string()
    };
    for (cloud, part) in [
        (r#"{"mesh": {"file": "gone.obj"}}"#, "gone.obj"),
        (r#"{"mesh": {"file": "empty.obj"}}"#, "no triangles"),
        (r#"{"mesh": {"file": "sheet.obj"}}"#, "fill its holes"),
        (r#"{"mesh": {"file": "rock.fbx"}}"#, ".obj"),
        (r#"{"mesh": {}}"#, "clouds[0].mesh.file"),
        (r#"{"mesh": {"file": "good.obj", "scale": 0}}"#, "clouds[0].mesh.scale"),
        (r#"{"mesh": {"file": "good.obj", "density": -1}}"#, "clouds[0].mesh.density"),
        (r#"{"mesh": {"file": "good.obj", "place": [9999999, 0, 0], "scale": 1000}}"#, "too far"),
        (
            r#"{"mesh": {"file": "good.obj"}, "ellipsoids": [{"center": [0, 0, 0], "radii": [1, 1, 1]}]}"#,
            "`mesh` and `ellipsoids`",
        ),
        (r#"{"mesh": {"file": "good.obj"}, "volume": {"file": "a.vdb"}}"#, "`volume` and `mesh`"),
        (r#"{"mesh": {"file": "good.obj"}, "evaporation": {"lee": 1}}"#, "wispiness"),
        (
            r#"{"mesh": {"file": "good.obj"}, "life": {"birth": 0, "death": 60, "forming": 9, "dissolving": 9}}"#,
            "density",
        ),
    ] {
        let text = refused(cloud);
        assert!(text.contains(part), "{cloud}: {text}");
    }
    // Who makes a scene of text reads files when asked to, and draws nothing before.
    let mut scene = Scene::from_json(r#"{"clouds": [{"mesh": {"file": "good.obj"}}]}"#).unwrap();
    let unread = nephos::render::Frame::new(&scene, [4, 4]).unwrap_err().to_string();
    assert!(unread.contains("was not read"), "{unread}");
    scene.read_volumes(folder.path()).unwrap();
    assert!(scene.clouds[0].mesh.as_ref().unwrap().surface().is_some());
}

#[test]
fn a_mesh_drifts_with_the_wind_turns_and_keeps_what_was_read() {
    let text = r#"{"clouds": [{"name": "ring", "mesh": {"file": "ring.obj", "up": "z", "place": [0, 500, 0]}}],
        "wind": {"velocity": [3, 0, 0]},
        "timeline": {"length": 20, "tracks": [{"path": "clouds['ring'].mesh.density", "keys": [
            {"time": 0, "value": 1}, {"time": 10, "value": 0.5}]}]}}"#;
    let mut scene = Scene::from_json(text).unwrap();
    let ring = torus([100.0, 40.0], [24, 12]);
    let mesh = scene.clouds[0].mesh.take().unwrap().with_surface(ring.into());
    scene.clouds[0].mesh = Some(mesh);
    let later = scene.at(10.0).unwrap();
    let mesh = later.clouds[0].mesh.as_ref().unwrap();
    assert!(mesh.surface().is_some() && (mesh.density - 0.5).abs() < 1e-9);
    assert!(mesh.place.distance(DVec3::new(30.0, 500.0, 0.0)) < 1e-9);
    // Z of the file is up: the ring stands.
    let (low, high) = later.bounds().unwrap();
    assert!((high - low).distance(DVec3::new(280.0, 280.0, 80.0)) < 5.0, "{}", high - low);
    let way = scene.movement(0.0, 1.0).unwrap().nearest(DVec3::new(0.0, 500.0, 0.0));
    assert!(way.distance(DVec3::new(3.0, 0.0, 0.0)) < 1e-9);
}
