//! Layers in scene files.

use nephos::render::Frame;
use nephos::scene::{Cloud, Layer, Preset, Scene};

fn refusal(cloud: &str) -> String {
    let text = format!(r#"{{"format": 1, "clouds": [{cloud}]}}"#);
    Scene::from_json(&text).unwrap_err().to_string()
}

#[test]
fn what_is_wrong_with_a_layer_is_told_with_the_way_out() {
    let cases = [
        (r#"{"layer": {"coverage": 1.2}}"#, "clouds[0].layer.coverage: 1.2 is out of range: expected 0 to 1"),
        (
            r#"{"layer": {"thickness": 0}}"#,
            "clouds[0].layer.thickness: 0 is out of range: expected 1 to 20000 metres",
        ),
        (r#"{"layer": {"scale": -3}}"#, "clouds[0].layer.scale: -3 is out of range"),
        (
            r#"{"layer": {}, "ellipsoids": [{"center": [0, 0, 0], "radii": [1, 1, 1]}]}"#,
            "both `layer` and `ellipsoids`",
        ),
        (r#"{"layer": {}, "growth": {"kind": "humilis"}}"#, "both `layer` and `growth`"),
        (r#"{"layer": {}, "level": 900}"#, "both `layer` and `level`"),
        (r#"{"layer": {}, "evaporation": {"lee": 0.5, "base": 0}}"#, "raise the edge's `wispiness`"),
        (
            r#"{"layer": {}, "life": {"birth": 0, "death": 60, "forming": 10, "dissolving": 10}}"#,
            "animate the layer's `coverage`",
        ),
        (r#"{"layer": {"covrage": 0.5}}"#, "did you mean `coverage`?"),
    ];
    for (cloud, expected) in cases {
        let found = refusal(cloud);
        assert!(found.contains(expected), "{found}\n  lacks\n{expected}");
    }
}

#[test]
fn old_files_have_no_layer() {
    let text = Preset::Kol.scene(1).to_json();
    assert!(!text.contains("layer"), "{text}");
}

#[test]
fn coverage_follows_its_curve() {
    let text = r#"{"format": 1, "clouds": [{"name": "deck", "layer": {"coverage": 0.2}}], "timeline": {"length": 10,
        "tracks": [{"path": "clouds['deck'].layer.coverage", "keys": [
            {"time": 0, "value": 0.2, "interpolation": "linear"}, {"time": 10, "value": 0.8}]}]}}"#;
    let scene = Scene::from_json(text).unwrap();
    let coverage = |time: f64| scene.at(time).unwrap().layers().next().unwrap().coverage;
    assert_eq!(coverage(0.0), 0.2);
    assert!((coverage(5.0) - 0.5).abs() < 1e-9, "{}", coverage(5.0));
}

#[test]
fn the_wind_carries_a_layer() {
    let mut scene = Scene { clouds: vec![Cloud::layered("deck", Layer::default())], ..Scene::default() };
    scene.wind.velocity = glam::DVec3::new(10.0, 0.0, -4.0);
    let moved = scene.at(60.0).unwrap();
    assert_eq!(moved.layers().next().unwrap().offset, [600.0, -240.0]);
    scene.clouds[0].shift(glam::DVec3::new(1.0, 50.0, 2.0));
    let layer = scene.clouds[0].layer.as_ref().unwrap();
    assert_eq!((layer.base, layer.offset), (1250.0, [1.0, 2.0]));
}

#[test]
fn a_layer_has_no_bounds_and_may_be_hidden() {
    let mut scene = Preset::Stratocumulus.scene(1);
    assert!(scene.bounds().is_none() && Frame::new(&scene, [16, 9]).is_ok());
    assert_eq!(scene.layers().count(), 1);
    scene.clouds[0].hidden = true;
    assert_eq!(scene.layers().count(), 0);
}
