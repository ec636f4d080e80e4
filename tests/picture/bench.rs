//! The benchmark finds what it is there to find: a wrong sign or a wrong density is far worse
//! than the model's own error, and the program tells so.
#![cfg(feature = "cli")]

use crate::common;

use std::time::Duration;

use assert_cmd::Command;
use common::gpu;
use glam::DVec3;
use nephos::{
    measure::{CORPUS, Entry, Limits, Reference, SIZE, Truth, draw, light},
    render::{Film, Quality, Renderer, Transport},
    scene::{Scene, SunPosition},
};

fn entry(name: &str) -> Entry {
    CORPUS.into_iter().find(|entry| entry.name == name).unwrap()
}

fn reference(entry: &Entry, samples: u32) -> Reference {
    let limits = Limits { noise: 0.0, samples, time: Duration::MAX };
    Reference::trace(gpu(), &entry.scene(), 1, &limits, None, &mut |_| ()).unwrap()
}

/// Relative RMSE of `scene`, drawn by `model`, against `reference`.
fn error(renderer: &mut Renderer, reference: &Reference, scene: &Scene, model: Transport) -> f64 {
    (renderer.settings.quality, renderer.settings.transport) = (Quality::PREVIEW, model);
    let sky = draw::sky(gpu(), renderer, &reference.scene, SIZE).unwrap();
    let drawn = draw::clouds(gpu(), renderer, scene, Film::new(SIZE, 1)).unwrap();
    Truth { reference, sky: &sky }.rmse(&drawn)
}

#[test]
fn wrong_signs_and_densities_are_far_above_the_error_of_the_best_model() {
    let entry = entry("fractus-back");
    let reference = reference(&entry, 48);
    let right = entry.scene();
    let models: Vec<_> = Transport::all().collect();
    let mut renderer = draw::renderer(gpu());
    let mut error = |scene: &Scene, model| error(&mut renderer, &reference, scene, model);
    let errors: Vec<_> = models.iter().map(|model| error(&right, *model)).collect();
    let best = errors.iter().position(|e| *e == errors.iter().fold(f64::INFINITY, |a, b| a.min(*b)));
    let (model, least) = (models[best.unwrap()], errors[best.unwrap()]);
    // Noise is taken off, what is left of it is a few hundredths; the best is at 0.08 on good references.
    assert!(least < 0.3, "{errors:?}");
    // The sun in front instead of behind: what a wrong sign of the phase angle does.
    let mut mirrored = right.clone();
    mirrored.sun.position = SunPosition::Direction(right.sun.to_sun() * DVec3::new(-1.0, 1.0, -1.0));
    let mut denser = right.clone();
    denser.clouds[0].droplets.concentration_per_cm3 *= 4.0;
    for (what, wrong) in [("mirrored", mirrored), ("denser", denser)] {
        let found = error(&wrong, model);
        assert!(found > 2.0 * least && found > 0.3, "{what}: {found} against {least}");
    }
}

#[test]
fn references_are_as_far_apart_as_their_standard_errors_say() {
    let entry = entry("sphere-side");
    let limits = Limits { noise: 0.0, samples: 24, time: Duration::MAX };
    let [a, b] =
        [1, 2].map(|seed| Reference::trace(gpu(), &entry.scene(), seed, &limits, None, &mut |_| ()).unwrap());
    let (mut squares, mut variance) = (0.0, 0.0);
    for i in a.cloud() {
        squares += (light(&a.picture.pixels[i]) - light(&b.picture.pixels[i])).powi(2);
        variance += a.variance(i) + b.variance(i);
    }
    // Mie's bright paths make the ratio unsteady; it was 8.6 when threads shared their paths.
    assert!((0.5..2.0).contains(&(squares / variance)), "{}", squares / variance);
}

fn nephos(words: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("nephos").unwrap();
    command.args(words);
    if let Ok(name) = std::env::var("NEPHOS_ADAPTER") {
        command.args(["--adapter", &name]);
    }
    command.assert()
}

#[test]
fn the_program_makes_references_and_tells_errors_and_costs() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    let page = folder.path().join("page.html");
    let make = ["bench", "reference", "--filter", "sphere-side", "--samples", "24", "--folder", place];
    let told =
        |words: &[&str]| String::from_utf8(nephos(words).success().get_output().stdout.clone()).unwrap();
    assert!(told(&make).contains("24 samples"));
    assert!(told(&make).contains("there already"));
    let bench = [
        "bench",
        "--filter",
        "sphere",
        "--folder",
        place,
        "--models",
        "single,slab",
        "--qualities",
        "draft",
        "--timing-size",
        "48",
        "27",
        "--repeats",
        "1",
        "--json",
        "-o",
        page.to_str().unwrap(),
    ];
    let report: serde_json::Value = serde_json::from_str(&told(&bench)).unwrap();
    assert_eq!(report["scores"].as_array().unwrap().len(), 2);
    assert_eq!(report["costs"].as_array().unwrap().len(), 2);
    // The other sphere has no reference.
    assert!(report["left_out"][0].as_str().unwrap().starts_with("two-spheres"));
    let errors: Vec<f64> = [0, 1].map(|i| report["means"][i]["rmse"].as_f64().unwrap()).into();
    assert!(errors[1] < errors[0], "multiple scattering is nearer to the truth: {errors:?}");
    let page = std::fs::read_to_string(&page).unwrap();
    // Pictures are told by letters that may be any.
    let words: String = page
        .split("base64,")
        .enumerate()
        .map(|(i, part)| if i == 0 { part } else { part.split_once('"').map_or("", |(_, rest)| rest) })
        .collect();
    assert!(words.contains("sphere-side") && words.contains("<svg") && !words.contains("NaN"));
}

#[test]
fn what_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    for (words, reason) in [
        (vec!["bench", "--filter", "nothing"], "no picture has `nothing`"),
        (vec!["bench", "--models", "best"], "--models knows no `best`: there are emitter"),
        (vec!["bench", "--folder", place], "there is nothing to measure against"),
    ] {
        let output = nephos(&words).code(1).get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(text.contains(reason) && !text.contains("panicked"), "{text}");
    }
}

#[test]
fn the_program_tells_how_fast_frames_are() {
    let folder = tempfile::tempdir().unwrap();
    let [file, page] = ["speed.json", "speed.html"].map(|name| folder.path().join(name));
    for (scenes, output) in [("sphere,clouds-3", &file), ("sphere", &page)] {
        let output = output.to_str().unwrap();
        let words = ["bench", "speed", "--scenes", scenes, "--sizes", "32x18", "--frames", "2"];
        nephos(&[&words[..], &["--gflops", "50", "-o", output]].concat()).success();
    }
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    let speeds = report["speeds"].as_array().unwrap();
    assert_eq!((speeds.len(), &report["gflops"]), (4, &serde_json::json!(50.0)));
    for (speed, motion) in speeds.iter().zip(["standing", "flying"].into_iter().cycle()) {
        assert_eq!(speed["motion"], motion);
        for number in ["recorded_ms", "frame_ms", "pixels_per_s", "first_s", "bytes", "covered"] {
            assert!(speed[number].as_f64().unwrap() > 0.0, "{number} of {speed}");
        }
        assert!(speed["usage"]["rays"].as_f64().unwrap() > 0.0);
        let made =
            ["buffers", "groups", "textures", "pipelines"].map(|what| speed["made"][what].as_u64().unwrap());
        // A camera that flies has the air's shadow bound anew, and clouds that come into view.
        assert!(motion == "flying" || made == [0; 4], "{speed}");
    }
    assert_eq!(speeds[2]["clouds"], 3);
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("<th>sphere</th>") && page.contains("<svg") && !page.contains("NaN"));
}

#[test]
fn what_speed_is_not_told_of_is_told() {
    for (words, reason) in [
        (["--scenes", "clouds-9999"], "--scenes knows no `clouds-9999`"),
        (["--sizes", "8k"], "--sizes knows no `8k`: there are 720p"),
        (["--qualities", "best"], "--qualities knows no `best`"),
        (["-o", "speed.txt"], "`speed.txt` is neither JSON nor a page"),
    ] {
        let output = nephos(&[&["bench", "speed"], &words[..]].concat()).code(1).get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(text.contains(reason) && !text.contains("panicked"), "{text}");
    }
}

#[test]
fn the_program_tells_what_kept_light_is_off_by() {
    let words = [
        "bench", "moving", "--scenes", "sphere", "--size", "16x9", "--frames", "3", "--slack", "0,1",
        "--json",
    ];
    let output = nephos(&words).success().get_output().stdout.clone();
    let report: serde_json::Value = serde_json::from_slice(&output).unwrap();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    for pair in rows.chunks(2) {
        let [exact, kept] = [&pair[0], &pair[1]]
            .map(|row| ["made", "rmse", "most", "jump", "mean_ms"].map(|what| row[what].as_f64().unwrap()));
        assert_eq!(exact[..4], [1.0, 0.0, 0.0, 0.0], "{pair:?}");
        assert!(kept[0] < 1.0 && kept[1] < 0.02 && kept[4] > 0.0, "{pair:?}");
    }
    for (words, reason) in [
        (["--slack", "91"], "`91` is no number from 0 to 90"),
        (["--slack", "nan"], "`nan` is no number"),
        (["--size", "8k"], "--size knows no `8k`"),
    ] {
        let output =
            nephos(&[&["bench", "moving"], &words[..]].concat()).failure().get_output().stderr.clone();
        let text = String::from_utf8(output).unwrap();
        assert!(text.contains(reason) && !text.contains("panicked"), "{text}");
    }
}
