use eframe::egui::{pos2, vec2};

use super::*;

fn rect() -> Rect {
    Rect::from_min_size(pos2(10.0, 20.0), vec2(640.0, 360.0))
}

/// Views of everything from a pebble to a front of clouds.
fn views() -> Vec<Navigation> {
    let view = |pivot, distance, heading, pitch, roll, orthographic| Navigation {
        pivot,
        distance,
        heading,
        pitch,
        roll,
        orthographic,
        ..Navigation::default()
    };
    vec![
        view(DVec3::ZERO, 1.0, 0.3, 0.2, 0.0, false),
        view(DVec3::new(500.0, 1200.0, -80.0), 4000.0, 4.0, -0.9, 0.0, false),
        view(DVec3::new(8e4, 9e3, -7e4), 1e5, 2.0, 0.4, 0.3, false),
        view(DVec3::new(500.0, 1200.0, -80.0), 4000.0, 5.0, -0.3, 0.0, true),
    ]
}

#[test]
fn the_camera_of_a_view_is_the_view() {
    for view in views() {
        let turn = view.camera(1.5).world_from_camera();
        // A quaternion from a matrix in f64, the eye a metre to 1e5 m away.
        assert!((turn * DVec3::X).distance(view.turn() * DVec3::X) < 1e-6);
        assert!((turn * DVec3::NEG_Z).distance(view.forward()) < 1e-6);
        let back = Navigation::through(&view.camera(1.5), view.pivot);
        assert!(back.eye().distance(view.eye()) < 1e-6 * view.distance);
        assert!(back.lens(rect()).project(view.pivot).unwrap().distance(DVec2::new(330.0, 200.0)) < 1e-3);
    }
}

#[test]
fn orbit_keeps_the_point_that_it_turns_about_in_place() {
    for mut view in views() {
        let about = view.pivot + 0.2 * view.distance * DVec3::new(0.5, 0.3, -0.2);
        let before = view.lens(rect()).project(about).unwrap();
        let away = view.eye().distance(about);
        for turn in [[0.3, 0.1], [2.5, -0.4], [-1.0, 0.2]] {
            view.orbit(about, turn.into());
            assert!(view.lens(rect()).project(about).unwrap().distance(before) < 1e-4);
            assert!((view.eye().distance(about) / away - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn orbit_over_the_pole_stops_and_never_flips() {
    let mut view = Navigation::default();
    let mut up = DVec3::Y;
    for _ in 0..400 {
        view.orbit(view.pivot, DVec2::new(0.01, -0.05));
        let lens = view.lens(rect());
        assert!(lens.up.y >= 0.0 && lens.up.is_finite());
        // A step turns by 0.06 rad at most.
        assert!(lens.up.distance(up) < 0.07, "{up} {}", lens.up);
        up = lens.up;
    }
    assert_eq!(view.pitch, -STEEPEST);
}

#[test]
fn pan_keeps_the_grabbed_point_under_the_cursor() {
    for mut view in views() {
        let lens = view.lens(rect());
        let (from, to) = (DVec2::new(100.0, 80.0), DVec2::new(410.0, 222.0));
        let depth = 1.7 * view.distance;
        let grabbed = lens.at_depth(from, depth);
        view.pan(&lens, from, to, depth);
        assert!(view.lens(rect()).project(grabbed).unwrap().distance(to) < 1e-4);
    }
}

#[test]
fn dolly_keeps_the_anchor_under_the_cursor_and_comes_nearer() {
    for mut view in views() {
        let at = DVec2::new(500.0, 77.0);
        let anchor = view.lens(rect()).at_depth(at, 0.8 * view.distance);
        let before = view.lens(rect());
        view.dolly(anchor, 0.5);
        let after = view.lens(rect());
        assert!(after.project(anchor).unwrap().distance(at) < 1e-4);
        let seen = after.metres_per_point(anchor) / before.metres_per_point(anchor);
        assert!((seen - 0.5).abs() < 1e-6, "{seen}");
    }
}

#[test]
fn dolly_goes_on_through_the_pivot() {
    let mut view = Navigation::default();
    let anchor = view.pivot;
    for _ in 0..600 {
        view.dolly(anchor, 0.9);
        assert!(view.distance >= NEAREST && view.eye().is_finite());
    }
    for _ in 0..600 {
        view.dolly(anchor, 1.1);
    }
    assert!(view.distance <= FARTHEST && view.camera(1.0).position.abs().max_element() < 1e7);
}

#[test]
fn framing_puts_every_corner_into_the_picture_and_fills_it() {
    for mut view in views() {
        for (low, high) in [
            (DVec3::new(-1.0, 0.0, 3.0), DVec3::new(0.0, 1.0, 4.0)),
            (DVec3::new(-5e4, 500.0, -5e4), DVec3::new(5e4, 9000.0, 5e4)),
        ] {
            view.frame((low, high), 640.0 / 360.0);
            let lens = view.lens(rect());
            let places: Vec<_> = (0..8)
                .map(|i| {
                    let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
                    let corner =
                        DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
                    lens.project(corner).unwrap()
                })
                .collect();
            assert!(places.iter().all(|p| rect().contains(pos2(p.x as f32, p.y as f32))), "{places:?}");
            // A sphere around the box, seen across at least 0.4 of the height.
            let highest = places.iter().map(|p| p.y).fold(f64::MAX, f64::min);
            let lowest = places.iter().map(|p| p.y).fold(0.0, f64::max);
            let widest = places.iter().map(|p| (p.x - 330.0).abs()).fold(0.0, f64::max);
            assert!(lowest - highest > 140.0 || widest > 70.0);
        }
    }
}

#[test]
fn sides_look_along_their_axes() {
    let mut view = Navigation::default();
    for (side, forward, up) in [
        (Side::Front, DVec3::NEG_Z, DVec3::Y),
        (Side::Back, DVec3::Z, DVec3::Y),
        (Side::Right, DVec3::NEG_X, DVec3::Y),
        (Side::Left, DVec3::X, DVec3::Y),
        (Side::Top, DVec3::NEG_Y, DVec3::NEG_Z),
        (Side::Bottom, DVec3::Y, DVec3::Z),
    ] {
        view.look_from(side);
        let lens = view.lens(rect());
        // A hair less than straight.
        assert!(lens.forward.distance(forward) < 2e-4, "{side:?} {}", lens.forward);
        assert!(lens.up.distance(up) < 2e-4, "{side:?} {}", lens.up);
    }
}

#[test]
fn flying_moves_the_eye_and_keeps_where_it_looks() {
    let mut view = views().remove(1);
    let (eye, forward) = (view.eye(), view.forward());
    view.fly(DVec3::new(0.0, 0.0, 250.0));
    assert!(view.eye().distance(eye + 250.0 * forward) < 1e-6);
    view.look_around(DVec2::new(0.4, 0.1));
    assert!(view.eye().distance(eye + 250.0 * forward) < 1e-6);
    // 0.4 rad of heading at a pitch of -0.9, and 0.1 of pitch.
    assert!(view.forward().distance(forward) > 0.2);
}

#[test]
fn between_two_views_the_short_way_round() {
    let a = Navigation { heading: 6.2, ..Navigation::default() };
    let b = Navigation { heading: 0.1, ..Navigation::default() };
    let middle = a.toward(&b, 0.5).heading.rem_euclid(std::f64::consts::TAU);
    assert!(!(0.2..6.1).contains(&middle), "{middle}");
    assert!(a.toward(&b, 1.0).forward().distance(b.forward()) < 1e-12);
}

#[test]
fn all_of_the_picture_fits_into_windows_of_any_shape() {
    let projections = [
        Projection::Perspective { vertical_fov_deg: 40.0 },
        Projection::Lens { focal_length_mm: 24.0, sensor_width_mm: 36.0 },
        Projection::Orthographic { height: 3000.0 },
    ];
    for projection in projections {
        let camera = Camera { projection, ..Navigation::default().camera(1.0) };
        let view = Navigation { framed: true, ..Navigation::through(&camera, DVec3::ZERO) };
        // Where the final picture's corner is in space, in a picture of its own shape.
        let picture = Rect::from_min_size(pos2(0.0, 0.0), vec2(1600.0, 900.0));
        let corner = Lens::new(&camera, picture).at_depth(DVec2::ZERO, 3000.0);
        for (size, margin) in
            [(vec2(900.0, 900.0), vec2(0.0, 196.875)), (vec2(3200.0, 900.0), vec2(800.0, 0.0))]
        {
            let window = Rect::from_min_size(pos2(0.0, 0.0), size);
            let seen = view.lens(window).project(corner).unwrap();
            let expected = DVec2::new(f64::from(margin.x), f64::from(margin.y));
            // The aspect of windows is in f32: 1e-7 of 1600 points.
            assert!(seen.distance(expected) < 1e-3, "{projection:?} {size}: {seen}");
        }
    }
}
