//! Lights beside the sun: light adds up, what does not shine costs nothing, and truth has the same.

use glam::DVec3;
use nephos::{
    export::Picture,
    reference::PathTracer,
    render::{Film, Quality, Transport},
    scene::{Light, LightSource, Lightning, Projection, Scene, Sky, Sun, SunPosition},
};

use crate::common::{
    gpu,
    picture::{draw, in_coarse_light, renderer},
};

const SIZE: [u32; 2] = [32, 24];

fn sharp() -> Quality {
    in_coarse_light(Quality { jitter: false, ..Quality::DRAFT })
}

/// Two heaps, one of which shades the other, over ground.
fn scene() -> Scene {
    crate::common::picture::scene(
        r#"{"clouds":[{"edge":{"boundary":30},"ellipsoids":[{"center":[0,900,0],"radii":[120,70,100]}]},
            {"edge":{"boundary":30},"ellipsoids":[{"center":[-300,1050,100],"radii":[100,70,100]}]}],
            "camera":{"position":[0,500,900],"target":[-100,850,0]}}"#,
    )
}

fn sun(azimuth_deg: f64, elevation_deg: f64, irradiance: [f64; 3]) -> Sun {
    Sun { position: SunPosition::Angles { azimuth_deg, elevation_deg }, irradiance, ..Sun::default() }
}

fn moon() -> Sun {
    sun(100.0, 35.0, [0.5, 0.7, 1.0])
}

fn light(source: LightSource) -> Light {
    Light { name: String::new(), source, hidden: false }
}

fn flash(irradiance: f64) -> Light {
    light(LightSource::Lightning(Lightning {
        position: DVec3::new(10.0, 900.0, 0.0),
        radius: 40.0,
        irradiance: [irradiance, 0.5 * irradiance, 2.0 * irradiance],
    }))
}

/// Checks that `found` is the sum of pictures, to the rounding of half floats.
fn is_sum(found: &Picture, of: &[Picture]) {
    for (i, pixel) in found.pixels.iter().enumerate() {
        for (c, found) in pixel[..3].iter().enumerate() {
            let sum: f32 = of.iter().map(|picture| picture.pixels[i][c]).sum();
            assert!((found - sum).abs() < 4e-3 * sum.abs() + 1e-5, "pixel {i}: {found} for {sum}");
        }
        assert!((pixel[3] - of[0].pixels[i][3]).abs() < 1e-3, "pixel {i}");
    }
}

#[test]
fn a_scene_with_a_moon_is_the_sum_of_its_pictures_with_either_sun() {
    let mut renderer = renderer(sharp(), Transport::default());
    let alone = scene();
    let under_moon = Scene { sun: moon(), ..scene() };
    let both = Scene { lights: vec![light(LightSource::Moon(moon()))], ..scene() };
    for sky in [true, false] {
        let parts = [&alone, &under_moon].map(|scene| draw(&mut renderer, scene, SIZE, sky));
        is_sum(&draw(&mut renderer, &both, SIZE, sky), &parts);
    }
}

/// A moon behind the middle of a cloud: where its disc is, the cloud takes all of its light that is scattered.
#[test]
fn the_disc_of_a_moon_is_dimmed_as_that_of_the_sun_is() {
    let text = r#"{"clouds":[{"droplets":{"concentration_per_cm3":25},"edge":{"boundary":0},
        "ellipsoids":[{"center":[0,900,-500],"radii":[120,70,40]}]}],"noise":{"detail":0},
        "camera":{"position":[0,900,0],"target":[0,900,-500],"projection":{"perspective":{"vertical_fov_deg":4}}},
        "sky":"none"}"#;
    let behind = Sun { angular_diameter_deg: 1.0, ..sun(0.0, 0.0, [1e-3; 3]) };
    let dark = Sun { irradiance: [0.0; 3], ..Sun::default() };
    let of_sun = Scene { sun: behind.clone(), ..crate::common::picture::scene(text) };
    let moon = light(LightSource::Moon(behind));
    let of_moon = Scene { sun: dark, lights: vec![moon], ..of_sun.clone() };
    let mut renderer = renderer(sharp(), Transport::default());
    let [sun, moon] = [&of_sun, &of_moon].map(|scene| draw(&mut renderer, scene, SIZE, true));
    let middle = sun.pixels[12 * 32 + 16][1];
    assert!(middle > 0.0);
    is_sum(&moon, &[sun]);
}

#[test]
fn a_light_of_clouds_alone_is_a_sun_without_air_and_twice_the_same_is_twice_as_much() {
    let mut renderer = renderer(sharp(), Transport::default());
    renderer.settings.aerial = false;
    let dark = Scene { sun: Sun { irradiance: [0.0; 3], ..Sun::default() }, ..scene() };
    let airless = Scene { sun: moon(), sky: Sky::None, ..scene() };
    let key = light(LightSource::Key(moon()));
    let once = draw(&mut renderer, &Scene { lights: vec![key.clone()], ..dark.clone() }, SIZE, false);
    is_sum(&once, &[draw(&mut renderer, &airless, SIZE, false)]);
    let twice = draw(&mut renderer, &Scene { lights: vec![key.clone(), key], ..dark }, SIZE, false);
    is_sum(&twice, &[once.clone(), once]);
}

#[test]
fn every_model_has_a_moon_and_those_that_solve_for_light_have_lightning() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    for transport in Transport::all() {
        renderer.settings.transport = transport;
        let dark = Scene { sun: Sun { irradiance: [0.0; 3], ..Sun::default() }, sky: Sky::None, ..scene() };
        let mut light_of = |light: Light| {
            let picture = draw(&mut renderer, &Scene { lights: vec![light], ..dark.clone() }, SIZE, false);
            picture.pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max)
        };
        assert!(light_of(light(LightSource::Key(moon()))) > 0.002, "{transport}");
        let found = light_of(flash(4.0));
        assert_eq!(found > 0.01, transport == Transport::MOMENTS, "{transport}: {found}");
    }
}

#[test]
fn what_does_not_shine_costs_nothing_and_a_set_sun_no_light() {
    let mut renderer = renderer(sharp(), Transport::default());
    renderer.settings.counting = true;
    let mut work = |scene: &Scene| {
        let before = renderer.light_updates();
        draw(&mut renderer, scene, SIZE, true);
        (renderer.light_updates() - before, renderer.counts(gpu()).unwrap().density_evaluations)
    };
    let (first, density) = work(&scene());
    assert!(first > 0 && density > 0);
    let hidden = Light { hidden: true, ..light(LightSource::Moon(moon())) };
    let black = light(LightSource::Moon(sun(0.0, 40.0, [0.0; 3])));
    let set = light(LightSource::Moon(sun(0.0, -40.0, [1.0; 3])));
    let elsewhere = light(LightSource::Lightning(Lightning {
        position: DVec3::new(0.0, 9e3, 0.0),
        ..Lightning::default()
    }));
    assert_eq!(work(&Scene { lights: vec![hidden, black, set, elsewhere], ..scene() }), (0, density));
    // Another light has the clouds marched once more.
    let moonlit = Scene { lights: vec![light(LightSource::Moon(moon()))], ..scene() };
    assert_eq!(work(&moonlit).1, 2 * density);
    assert_eq!(work(&moonlit).0, 0, "nothing has changed");
    work(&scene());
    assert_eq!(work(&moonlit).0, 0, "it was dark for a moment");
    // No light is solved for of a sun that has set.
    let mut night = moonlit.clone();
    night.sun = sun(0.0, -40.0, [1.0; 3]);
    let bytes = |renderer: &nephos::render::Renderer| renderer.light_bytes();
    let mut fresh = crate::common::picture::renderer(sharp(), Transport::default());
    draw(&mut fresh, &night, SIZE, false);
    let by_night = bytes(&fresh);
    draw(&mut fresh, &moonlit, SIZE, false);
    assert!(by_night > 0 && 10 * bytes(&fresh) >= 19 * by_night, "{by_night} {}", bytes(&fresh));
}

#[cfg(feature = "export")]
#[test]
fn exr_files_have_a_layer_for_each_light_and_the_beauty_is_their_sum() {
    use exr::prelude::*;
    let moon = Light { name: "la luna".to_owned(), ..light(LightSource::Moon(moon())) };
    let mut bolt = flash(2.0);
    if let LightSource::Lightning(flash) = &mut bolt.source {
        // In the cloud behind, which the other one hides in part.
        flash.position = DVec3::new(-300.0, 1050.0, 100.0);
    }
    let lights = vec![moon, light(LightSource::Key(sun(10.0, 20.0, [0.2; 3]))), bolt];
    let mut lit = Scene { lights, ..scene() };
    lit.camera.as_mut().unwrap().position = DVec3::new(500.0, 600.0, 0.0);
    let mut renderer = renderer(sharp(), Transport::default());
    let layers =
        renderer.render_layers(gpu(), &Film::new(SIZE, 1).frame(&lit).unwrap(), &mut |_| ()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lights.exr");
    nephos::export::write_layers(&path, gpu(), &layers, false, 1).unwrap();
    let image = read_first_flat_layer_from_file(&path).unwrap();
    let channel = |name: &str| {
        let found = image.layer_data.channel_data.list.iter().find(|own| own.name.to_string() == name);
        let own = found.unwrap_or_else(|| panic!("no channel {name}"));
        own.sample_data.values_as_f32().collect::<Vec<_>>()
    };
    let whole = draw(&mut renderer, &lit, SIZE, true);
    for (c, color) in ["R", "G", "B"].into_iter().enumerate() {
        let of = |name: &str| channel(&format!("{name}.{color}"));
        let parts = ["light.sun", "light.la luna", "light.key2", "light.lightning3"].map(of);
        let (beauty, sky) = (channel(color), of("sky"));
        let all = ["single", "multiple", "air"].map(of);
        let through = channel("transmittance.Y");
        for i in 0..beauty.len() {
            let sum: f32 = parts.iter().map(|part| part[i]).sum();
            assert!((sum - beauty[i]).abs() < 4e-3 * beauty[i] + 1e-5, "{color} {i}: {sum} {}", beauty[i]);
            let layers = sky[i] * through[i] + all.iter().map(|layer| layer[i]).sum::<f32>();
            assert!((layers - beauty[i]).abs() < 6e-3 * beauty[i] + 1e-5, "{color} {i}: {layers}");
            let drawn = whole.pixels[i][c];
            assert!((drawn - beauty[i]).abs() < 6e-3 * beauty[i] + 1e-5, "{color} {i}: {drawn}");
        }
    }
}

#[test]
fn lights_that_are_none_end_in_a_sentence() {
    let refused =
        |lights: &str| Scene::from_json(&format!(r#"{{"lights":{lights}}}"#)).unwrap_err().to_string();
    let cases = [
        (r#"[{"source":{"moon":{"position":{"direction":[0,0,0]}}}}]"#, "lights[0].source.moon.position"),
        (r#"[{"source":{"key":{"irradiance":[-1,0,0]}}}]"#, "lights[0].source.key.irradiance[0]"),
        (r#"[{"source":{"lightning":{"radius":0}}}]"#, "1 to 100000 metres"),
        (r#"[{"source":{"lamp":{}}}]"#, "lamp"),
        (r#"[{"name":"a.b","source":{"key":{}}}]"#, "a.b"),
        (r#"[{"name":"月","source":{"key":{}}}]"#, "月"),
        (r#"[{"name":"sun","source":{"key":{}}}]"#, "lights[0].name"),
        (r#"[{"name":"sky","source":{"key":{}}}]"#, "lights[0].name"),
        (r#"[{"name":"moon2","source":{"key":{}}},{"source":{"moon":{}}}]"#, "lights[1].name"),
        (r#"[{"name":"a","source":{"key":{}}},{"name":"a","source":{"moon":{}}}]"#, "lights[1].name"),
        (r#"[{"name":"a"}]"#, "source"),
    ];
    for (lights, told) in cases {
        let found = refused(lights);
        assert!(found.contains(told), "{lights}: {found}");
    }
    let five = [r#"{"source":{"key":{}}}"#; 5].join(",");
    assert!(refused(&format!("[{five}]")).contains("5 lights are too many"));
}

/// Mean of the light of a picture, and of its error.
fn traced(scene: &Scene, samples: u32) -> ([f64; 3], f64) {
    let frame = Film::new([12, 9], 1).frame(scene).unwrap();
    let mut tracer = PathTracer::new(gpu(), &frame, 3).unwrap();
    tracer.trace(samples, &mut |_| true).unwrap();
    let estimate = tracer.estimate().unwrap();
    let n = estimate.mean.len() as f64;
    let mean = [0, 1, 2].map(|c| estimate.mean.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / n);
    let variance: f64 = estimate.error.iter().map(|error| f64::from(error[1]).powi(2)).sum();
    (mean, variance.sqrt() / n)
}

#[test]
fn truth_has_the_same_lights() {
    let near = r#"{"clouds":[{"droplets":{"concentration_per_cm3":30},"edge":{"boundary":30},"ellipsoids":[{"center":[0,900,0],"radii":[120,90,100]}]}],
        "camera":{"position":[0,900,500],"target":[0,900,0]},"sky":"none","sun":{"irradiance":[0,0,0]}}"#;
    let dark = crate::common::picture::scene(near);
    let key = light(LightSource::Key(moon()));
    let as_sun = traced(&Scene { sun: moon(), ..dark.clone() }, 96);
    let as_key = traced(&Scene { lights: vec![key.clone()], ..dark.clone() }, 96);
    let spread = 4.0 * as_sun.1.hypot(as_key.1);
    assert!((as_sun.0[1] - as_key.0[1]).abs() < spread, "{as_sun:?} {as_key:?}");
    // Truth of lightning, and the model that solves for it: in the middle, and half outside.
    let mut renderer = renderer(
        Quality { jitter: false, light_resolution: 32, light_cells: 32, ..Quality::PREVIEW },
        Transport::MOMENTS,
    );
    for (x, bound) in [(10.0, 0.1), (110.0, 0.25)] {
        let mut bolt = flash(3.0);
        if let LightSource::Lightning(flash) = &mut bolt.source {
            flash.position.x = x;
        }
        let lit = Scene { lights: vec![bolt], ..dark.clone() };
        let ([red, green, blue], error) = traced(&lit, 3072);
        assert!(error < 0.05 * green && green > 0.0, "{green} {error}");
        assert!((red / green - 2.0).abs() < 0.1 && (blue / green - 4.0).abs() < 0.2, "{red} {green} {blue}");
        let picture = draw(&mut renderer, &lit, [12, 9], false);
        let drawn = picture.pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / 108.0;
        println!("lightning at {x}: drawn {drawn:.5}, traced {green:.5} +- {error:.5}");
        assert!((drawn / green - 1.0).abs() < bound, "{x}: {drawn} for {green} +- {error}");
    }
}

/// A ball of droplets that absorb nothing and scatter alike to all sides, with a small flash in its middle: what
/// is not scattered is not seen, e^-tau of the power, and all the rest leaves alike to all directions.
#[test]
fn a_ball_gives_off_what_a_flash_in_its_middle_does_but_for_what_goes_straight_out() {
    for concentration in [15.0, 240.0] {
        let mut scene = crate::common::picture::scene(&format!(
            r#"{{"clouds":[{{"droplets":{{"phase":"isotropic","concentration_per_cm3":{concentration}}},
            "edge":{{"boundary":0}},"ellipsoids":[{{"center":[0,0,0],"radii":[200,200,200]}}]}}],
            "noise":{{"detail":0}},"sky":"none","sun":{{"irradiance":[0,0,0]}},
            "camera":{{"position":[0,0,900],"target":[0,0,0]}}}}"#
        ));
        scene.camera.as_mut().unwrap().projection = Projection::Orthographic { height: 420.0 };
        let tau = 200.0 * scene.clouds[0].droplets.extinction();
        let (radius, irradiance) = (20.0, 2.0);
        scene.lights = vec![light(LightSource::Lightning(Lightning {
            position: DVec3::ZERO,
            radius,
            irradiance: [irradiance; 3],
        }))];
        let edge = 32u32;
        let area = (420.0 / f64::from(edge)).powi(2);
        let wanted = radius * radius * irradiance * (1.0 - (-tau).exp());
        let frame = Film::new([edge; 2], 1).frame(&scene).unwrap();
        let mut tracer = PathTracer::new(gpu(), &frame, 1).unwrap();
        tracer.trace(96, &mut |_| true).unwrap();
        let estimate = tracer.estimate().unwrap();
        let traced: f64 = estimate.mean.iter().map(|pixel| f64::from(pixel[1]) * area).sum::<f64>() / wanted;
        let error =
            estimate.error.iter().map(|error| (f64::from(error[1]) * area).powi(2)).sum::<f64>().sqrt();
        let error = error / wanted;
        let mut renderer = renderer(Quality { jitter: false, ..Quality::PREVIEW }, Transport::MOMENTS);
        let picture = draw(&mut renderer, &scene, [edge; 2], false);
        let drawn = picture.pixels.iter().map(|pixel| f64::from(pixel[1]) * area).sum::<f64>() / wanted;
        println!("tau {tau:.2}: drawn {drawn:.4}, traced {traced:.4} +- {error:.4}");
        assert!(error < 0.06 && (traced - 1.0).abs() < 0.01 + 4.0 * error, "{tau}: {traced} +- {error}");
        assert!((drawn - 1.0).abs() < 0.17, "{tau}: {drawn}");
    }
}
