//! Sprites of clouds: loops, light from six sides, impostors, motion.
#![cfg(feature = "export")]

use crate::common;

use common::{gpu, picture::scene};
use glam::DVec3;
use nephos::{
    export::{Around, Course, EDGES, Motion, Picture, SIDES, Studio, Subject, impostor, turning},
    render::Quality,
    scene::Scene,
};

const PAIR: &str = r#"{"clouds":[
    {"name":"left","edge":{"boundary":30},"ellipsoids":[{"center":[-400,900,0],"radii":[100,70,90]}]},
    {"name":"right","droplets":{"concentration_per_cm3":60},"edge":{"boundary":30,"wispiness":0.2},
     "ellipsoids":[{"center":[300,900,0],"radii":[90,60,70]},{"center":[350,960,20],"radii":[50,50,50]}]}],
    "noise":{"scale":50},"camera":{"position":[300,905,900],"target":[0,905,0]}}"#;

/// Quick, and without grain.
fn studio() -> Studio {
    let mut studio = Studio::new(gpu(), 1, false);
    studio.renderer().settings.quality = Quality { jitter: false, ..Quality::DRAFT };
    studio
}

fn difference(a: &Picture, b: &Picture) -> f32 {
    let pixels = a.pixels.iter().zip(&b.pixels);
    let each = pixels.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>());
    each.sum::<f32>() / a.pixels.len() as f32
}

fn opacity(picture: &Picture) -> f32 {
    picture.pixels.iter().map(|pixel| pixel[3]).sum::<f32>() / picture.pixels.len() as f32
}

#[test]
fn a_sprite_shows_its_cloud_alone_and_whole() {
    let scene = scene(PAIR);
    let [both, right, second] =
        [None, Some("right"), Some("1")].map(|name| Subject::new(&scene, name).unwrap());
    assert_eq!(right, second);
    assert!(both.extent() > 3.0 * right.extent());
    for to_eye in [right.to_camera(), DVec3::Y, DVec3::NEG_X, DVec3::new(0.6, -0.48, 0.64)] {
        let picture = studio().picture(&right.seen_from(to_eye), [32, 32], false).unwrap();
        assert!(opacity(&picture) > 0.04, "{to_eye} {}", opacity(&picture));
        let rim = |i: usize| [0, 31].contains(&(i % 32)) || [0, 31].contains(&(i / 32));
        let cut = picture.pixels.iter().enumerate().any(|(i, pixel)| rim(i) && pixel[3] > 0.0);
        assert!(!cut, "{to_eye}");
    }
    let unknown = Subject::new(&scene, Some("middle")).unwrap_err().to_string();
    assert!(unknown.contains("`left`") && unknown.contains("`right`"), "{unknown}");
    assert!(Subject::new(&Scene::default(), None).is_err());
}

#[test]
fn a_loop_closes_and_does_not_stand_still() {
    let subject = Subject::new(&scene(PAIR), Some("right")).unwrap();
    let course = Course { travel: 100.0, ..Course::default() };
    let to_eye = subject.to_camera();
    let mut studio = studio();
    let mut frame =
        |i: u32| studio.picture(&subject.at(course, i, 32).seen_from(to_eye), [32, 32], false).unwrap();
    let (first, second, middle, last, after) = (frame(0), frame(1), frame(16), frame(31), frame(32));
    let (step, back, far) =
        (difference(&first, &second), difference(&last, &first), difference(&first, &middle));
    // sin(tau) is not quite 0: the noise is off by 1e-14 m.
    assert!(difference(&first, &after) < 1e-4, "{}", difference(&first, &after));
    assert!(step > 5e-4 && (back / step - 1.0).abs() < 0.5, "{step} {back}");
    assert!(far > 2.0 * step, "{far} {step}");
}

#[test]
fn time_carries_the_cloud_and_the_square_with_it() {
    let mut scene = scene(PAIR);
    scene.wind.velocity = DVec3::new(9.3, 0.0, 0.0);
    let subject = Subject::new(&scene, Some("right")).unwrap();
    let course = Course { seconds: 1000.0, ..Course::default() };
    let mut studio = studio();
    let mut frame =
        |i: u32| studio.picture(&subject.at(course, i, 2).seen_from(DVec3::Z), [32, 32], false).unwrap();
    let (first, second) = (frame(0), frame(1));
    // 4650 m on, which is no multiple of the noise's period, it has other billows and is where it was in the square.
    assert!(difference(&first, &second) > 1e-3);
    assert!((opacity(&first) / opacity(&second) - 1.0).abs() < 0.15);
}

#[test]
fn sides_are_those_of_the_picture() {
    // Dense enough that little light comes through.
    let mut scene = scene(PAIR);
    scene.clouds[0].droplets.concentration_per_cm3 = 4000.0;
    let subject = Subject::new(&scene, Some("left")).unwrap();
    let [positive, negative] = subject.six_ways(&mut studio(), DVec3::Z, 32).unwrap();
    assert_eq!(positive.pixels[0][3], negative.pixels[0][3]);
    // Mean light of the half of the cloud towards a side, and of the other half.
    let half = |map: &Picture, channel: usize, keep: &dyn Fn(usize, usize) -> bool| {
        let pixels = map.pixels.iter().enumerate().filter(|(i, p)| p[3] > 0.3 && keep(i % 32, i / 32));
        let values: Vec<_> = pixels.map(|(_, pixel)| pixel[channel]).collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    let (east, upper) = (|x: usize, _: usize| x >= 16, |_: usize, y: usize| y < 16);
    let (west, lower) = (|x: usize, _: usize| x < 16, |_: usize, y: usize| y >= 16);
    for (map, channel, lit, dark) in [
        (&positive, 0, &east as &dyn Fn(usize, usize) -> bool, &west as &dyn Fn(usize, usize) -> bool),
        (&positive, 1, &upper, &lower),
        (&negative, 0, &west, &east),
        (&negative, 1, &lower, &upper),
    ] {
        let (lit, dark) = (half(map, channel, lit), half(map, channel, dark));
        assert!(lit > 1.1 * dark, "{channel}: {lit} {dark}");
    }
    let all = |_: usize, _: usize| true;
    let (back, front) = (half(&positive, 2, &all), half(&negative, 2, &all));
    // A thick cloud is brighter where light falls on it than where it must come through; a white sheet is 1.
    assert!(front > 1.3 * back && front < 1.2 && back > 0.0, "{front} {back}");
    assert_eq!(SIDES.map(|(name, _)| name), ["right", "top", "back", "left", "bottom", "front"]);
}

#[test]
fn a_side_is_the_mean_of_four_lights_and_light_is_linear() {
    let mut scene = scene(PAIR);
    let subject = Subject::new(&scene, Some("left")).unwrap();
    let [_, negative] = subject.six_ways(&mut studio(), DVec3::Z, 24).unwrap();
    scene.sky = nephos::scene::Sky::None;
    scene.ground.albedo = [0.0; 3];
    scene.sun.irradiance = [2.0; 3];
    let mut light = vec![0.0; 24 * 24];
    let front = EDGES.iter().filter(|edge| edge.z > 0.0);
    assert_eq!(front.clone().count(), 4);
    for edge in front {
        scene.sun.position = nephos::scene::SunPosition::Direction(*edge);
        let lit = Subject::new(&scene, Some("left")).unwrap();
        let picture = studio().picture(&lit.seen_from(DVec3::Z), [24, 24], false).unwrap();
        for (sum, pixel) in light.iter_mut().zip(&picture.pixels) {
            *sum += 0.25 * (pixel[0] + pixel[1] + pixel[2]) / 3.0;
        }
    }
    for (map, light) in negative.pixels.iter().zip(light).filter(|(map, _)| map[3] > 0.1) {
        let expected = 2.0 / std::f32::consts::PI * map[2] * map[3];
        assert!((light - expected).abs() < 0.01 * expected, "{light} {expected}");
    }
}

#[test]
fn impostors_have_depth_and_normals_of_their_side() {
    let text =
        r#"{"clouds":[{"edge":{"boundary":0},"ellipsoids":[{"center":[0,900,0],"radii":[100,100,100]}]}]}"#;
    let subject = Subject::new(&scene(text), None).unwrap();
    let shots = impostor(&mut studio(), &subject, Around::Sphere, 3, 16, &mut |_| ()).unwrap();
    assert_eq!(shots.len(), 9);
    for (i, shot) in shots.iter().enumerate() {
        let place = glam::DVec2::new((i % 3) as f64 - 1.0, (i / 3) as f64 - 1.0);
        let to_eye = Around::Sphere.to_eye(place);
        let middle = 8 * 16 + 8;
        let (distance, normal) = (shot.distance.pixels[middle], shot.normal.pixels[middle]);
        assert!(shot.color.pixels[middle][3] > 0.99);
        // The ball's surface is a radius nearer than its middle; light comes from a few free paths below.
        let depth = f64::from(distance[0] / distance[3]) - (subject.extent() - 100.0);
        assert!((-1.0..30.0).contains(&depth), "{i}: {depth}");
        let facing = DVec3::new(normal[0].into(), normal[1].into(), normal[2].into()).normalize();
        assert!(facing.dot(to_eye) > 0.9, "{i}: {facing} {to_eye}");
    }
}

#[test]
fn a_cloud_that_turns_comes_round_and_light_stands_still() {
    let mut scene = scene(PAIR);
    scene.sun.position = nephos::scene::SunPosition::Direction(DVec3::X);
    let course = Course { turns: 1, ..Course::default() };
    let mut studio = studio();
    let mut frame = |scene: &Scene, i: u32| {
        let subject = Subject::new(scene, Some("right")).unwrap();
        studio.picture(&subject.at(course, i, 4).seen_from(DVec3::Z), [32, 32], false).unwrap()
    };
    let (first, quarter, round) = (frame(&scene, 0), frame(&scene, 1), frame(&scene, 4));
    assert!(difference(&first, &round) < 1e-3, "{}", difference(&first, &round));
    assert!(difference(&first, &quarter) > 0.01);
    // A quarter against the clock from above: what was in the east is then in the north.
    let mut turned = scene.clone();
    for e in turned.clouds.iter_mut().flat_map(|cloud| &mut cloud.ellipsoids) {
        let quarter = glam::DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
        // About the middle of the bounds.
        let center = DVec3::new(305.0, 925.0, 0.0);
        (e.center, e.orientation) = (center + quarter * (e.center - center), quarter * e.orientation);
    }
    scene.clouds.iter_mut().chain(&mut turned.clouds).for_each(|cloud| cloud.edge.boundary = 0.0);
    let (by_course, by_hand) = (frame(&scene, 1), frame(&turned, 0));
    assert!(difference(&by_course, &by_hand) < 0.1 * difference(&by_hand, &frame(&scene, 0)));
}

#[test]
fn frames_blended_by_motion_are_nearer_to_what_is_between_than_faded_ones() {
    let subject = Subject::new(&scene(PAIR), Some("right")).unwrap();
    let course = Course { turns: 1, ..Course::default() };
    let to_eye = subject.to_camera();
    let mut studio = studio();
    studio.renderer().settings.quality = Quality { jitter: false, ..Quality::PREVIEW };
    let (mut faded, mut warped) = (0.0, 0.0);
    for i in [0, 9] {
        let mut frame = |i: u32| {
            let scene = subject.at(course, i, 40).seen_from(to_eye);
            (studio.shot(&scene, [64, 64]).unwrap(), scene.camera().world_from_camera())
        };
        let ((a, turned), (between, _), (b, _)) = (frame(i), frame(i + 1), frame(i + 2));
        let shifts = turning(&a, turned, subject.extent(), 2.0 * course.turn(40));
        let pixels: Vec<_> = shifts.iter().map(|shift| shift.map(|share| 64.0 * share)).collect();
        faded += difference(&between.color, &mix(&a.color, &b.color, &vec![[0.0; 2]; pixels.len()]));
        warped += difference(&between.color, &mix(&a.color, &b.color, &pixels));
        let motion = Motion::new(std::slice::from_ref(&shifts), 64);
        for (pixel, shift) in motion.frames[0].pixels.iter().zip(&shifts) {
            assert!(((2.0 * pixel[0] - 1.0) * motion.strongest - shift[0]).abs() < 1e-5);
        }
    }
    // What is left is light, which does not turn with the cloud, and octaves too fine for pixels to carry:
    // measured 0.922.
    assert!(warped < 0.94 * faded, "{warped} {faded}");
}

/// Half way between two frames, as engines blend flip-books.
fn mix(a: &Picture, b: &Picture, shifts: &[[f32; 2]]) -> Picture {
    let sample = |picture: &Picture, x: f32, y: f32| {
        let clamped = |v: f32| v.clamp(0.0, 62.999);
        let (x, y) = (clamped(x), clamped(y));
        let (i, j) = (x as usize, y as usize);
        let (u, v) = (x - i as f32, y - j as f32);
        let at = |i: usize, j: usize| picture.pixels[j * 64 + i];
        let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
        std::array::from_fn::<f32, 4, _>(|c| {
            (1.0 - v) * ((1.0 - u) * p[c] + u * q[c]) + v * ((1.0 - u) * r[c] + u * s[c])
        })
    };
    let pixel = |i: usize| {
        let (x, y) = ((i % 64) as f32, (i / 64) as f32);
        let [dx, dy] = shifts[i].map(|shift| 0.5 * shift);
        let (p, q) = (sample(a, x - dx, y - dy), sample(b, x + dx, y + dy));
        std::array::from_fn(|c| 0.5 * (p[c] + q[c]))
    };
    Picture { width: 64, height: 64, pixels: (0..64 * 64).map(pixel).collect() }
}

#[test]
fn layers_which_have_no_end_are_left_out_of_sprites() {
    let mut scene = scene(PAIR);
    let without = Subject::new(&scene, None).unwrap().seen_from(DVec3::Z);
    scene.clouds.push(
        Scene::from_json(r#"{"clouds":[{"name":"deck","layer":{"base":700}}]}"#).unwrap().clouds.remove(0),
    );
    let with = Subject::new(&scene, None).unwrap().seen_from(DVec3::Z);
    assert_eq!(with, without);
    let told = Subject::new(&scene, Some("deck")).unwrap_err().to_string();
    assert!(told.contains("layers, which have no end, are left out"), "{told}");
}
