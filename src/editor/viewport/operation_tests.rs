use super::*;
use crate::{
    editor::{
        Selection,
        viewport::{
            lens::tests::{cameras, lens},
            space::nice,
        },
    },
    scene::{Cloud, Scene},
};

const MOUSE: Grip = Grip { snap: false, precise: false };

fn turned(center: DVec3) -> Ellipsoid {
    let orientation = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
    Ellipsoid { orientation, ..Ellipsoid::new(center, DVec3::new(90.0, 30.0, 50.0)) }
}

/// Two ellipsoids in view, both selected, the second one active.
fn document() -> Document {
    let ellipsoids = vec![turned(DVec3::new(500.0, 850.0, 300.0)), turned(DVec3::new(700.0, 900.0, 500.0))];
    let mut document =
        Document::new(Scene { clouds: vec![Cloud { ellipsoids, ..Cloud::default() }], ..Scene::default() });
    document.select(Selection::all(document.scene()));
    document
}

fn centers(document: &Document) -> [DVec3; 2] {
    [0, 1].map(|i| document.scene().clouds[0].ellipsoids[i].center)
}

fn begin(kind: Kind, document: &mut Document, at: DVec2) -> Operation {
    Operation::begin(kind, document, Pivot::Middle, false, at).unwrap()
}

#[test]
fn a_drag_along_an_axis_moves_by_what_the_mouse_passed_on_it() {
    for camera in cameras() {
        let lens = lens(&camera);
        for (axis, local) in [(0, false), (1, false), (2, false), (0, true), (2, true)] {
            let mut document = document();
            let before = centers(&document);
            let pivot = pivot_of(&document, Pivot::Middle).unwrap();
            let frame = if local { frame_of(&document) } else { DQuat::IDENTITY };
            let along = axis_of(frame, axis);
            let [from, to] = [20.0, 145.0].map(|s| lens.project(pivot + s * along).unwrap());
            let mut operation = begin(Kind::Move, &mut document, from);
            operation.press_axis(axis, false, local);
            operation.point(&lens, to, MOUSE);
            operation.update(&lens, &mut document, MOUSE);
            document.end();
            for (before, after) in before.iter().zip(centers(&document)) {
                assert!(after.distance(*before + 125.0 * along) < 1e-6, "{after} {before}");
            }
            document.undo();
            assert_eq!(centers(&document), before);
        }
    }
}

#[test]
fn a_free_drag_keeps_the_pivot_under_the_mouse_and_a_plane_holds_its_axis() {
    let lens = lens(&cameras()[0]);
    let mut document = document();
    let pivot = pivot_of(&document, Pivot::Middle).unwrap();
    let from = lens.project(pivot).unwrap();
    let to = from + DVec2::new(60.0, -35.0);
    let mut operation = begin(Kind::Move, &mut document, from);
    operation.point(&lens, to, MOUSE);
    operation.update(&lens, &mut document, MOUSE);
    assert!(lens.project(pivot_of(&document, Pivot::Middle).unwrap()).unwrap().distance(to) < 1e-6);
    operation.press_axis(1, true, false);
    operation.update(&lens, &mut document, MOUSE);
    let moved = pivot_of(&document, Pivot::Middle).unwrap();
    assert!((moved.y - pivot.y).abs() < 1e-9 && moved.distance(pivot) > 10.0);
    assert!(lens.project(moved).unwrap().distance(to) < 1e-6);
    document.cancel();
    assert_eq!(pivot_of(&document, Pivot::Middle).unwrap(), pivot);
}

#[test]
fn the_mouse_turns_as_it_goes_around_the_pivot_more_than_once_too() {
    let lens = lens(&cameras()[0]);
    for axis in [None, Some(0), Some(1), Some(2)] {
        let mut document = document();
        let before = document.scene().clouds[0].ellipsoids.clone();
        let pivot = pivot_of(&document, Pivot::Middle).unwrap();
        let center = lens.project(pivot).unwrap();
        let place = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            center + 80.0 * DVec2::new(cos, -sin)
        };
        let mut operation = begin(Kind::Rotate, &mut document, place(0.0));
        if let Some(axis) = axis {
            operation.press_axis(axis, false, false);
        }
        for degrees in (10..=400).step_by(10) {
            operation.point(&lens, place(f64::from(degrees)), MOUSE);
        }
        operation.update(&lens, &mut document, MOUSE);
        // Seen from the tip of the axis counter-clockwise is positive.
        let along = axis.map_or(lens.to_eye(pivot), |axis| DVec3::AXES[axis]);
        let sign = along.dot(lens.to_eye(pivot)).signum();
        let turn = DQuat::from_axis_angle(along, sign * 40f64.to_radians());
        for (before, after) in before.iter().zip(&document.scene().clouds[0].ellipsoids) {
            assert!(after.center.distance(pivot + turn * (before.center - pivot)) < 1e-6);
            assert_eq!(after.radii, before.radii);
        }
        assert!(operation.readout().contains(if sign > 0.0 { "400.0°" } else { "-400.0°" }));
    }
}

#[test]
fn the_mouse_scales_by_its_distance_from_the_pivot() {
    let lens = lens(&cameras()[0]);
    let mut document = document();
    let pivot = pivot_of(&document, Pivot::Middle).unwrap();
    let center = lens.project(pivot).unwrap();
    let mut operation = begin(Kind::Scale, &mut document, center + DVec2::new(50.0, 0.0));
    operation.point(&lens, center + DVec2::new(0.0, 100.0), MOUSE);
    operation.update(&lens, &mut document, MOUSE);
    let after = &document.scene().clouds[0].ellipsoids[0];
    assert!(after.radii.distance(2.0 * DVec3::new(90.0, 30.0, 50.0)) < 1e-6);
    let expected = pivot + 2.0 * (DVec3::new(500.0, 850.0, 300.0) - pivot);
    assert!(after.center.distance(expected) < 1e-6);
}

#[test]
fn each_about_itself_stays_where_it_is() {
    let lens = lens(&cameras()[0]);
    let mut document = document();
    let before = centers(&document);
    let at = DVec2::new(300.0, 200.0);
    let mut operation = Operation::begin(Kind::Scale, &mut document, Pivot::Each, false, at).unwrap();
    operation.type_character('2');
    operation.update(&lens, &mut document, MOUSE);
    assert_eq!(centers(&document), before);
    assert_eq!(document.scene().clouds[0].ellipsoids[1].radii, DVec3::new(180.0, 60.0, 100.0));
}

#[test]
fn typed_numbers_win_over_the_mouse_and_are_exact() {
    let lens = lens(&cameras()[0]);
    let mut document = document();
    let before = centers(&document);
    let mut operation = begin(Kind::Move, &mut document, DVec2::new(300.0, 200.0));
    operation.press_axis(1, false, false);
    operation.point(&lens, DVec2::new(350.0, 100.0), MOUSE);
    for character in "12x.5-".chars() {
        operation.type_character(character);
    }
    operation.update(&lens, &mut document, MOUSE);
    assert_eq!(centers(&document), before.map(|c| c - 12.5 * DVec3::Y));
    assert_eq!(operation.readout(), "Move along Y  -12.5 m  [-12.5]");
    operation.type_character('-');
    assert_eq!(operation.number(), Some(12.5));
}

#[test]
fn an_axis_pressed_again_is_the_ellipsoids_own_then_none() {
    let mut operation = begin(Kind::Move, &mut document(), DVec2::ZERO);
    operation.press_axis(0, false, false);
    assert_eq!((operation.constraint, operation.local), (Constraint::Axis(0), false));
    operation.press_axis(0, false, false);
    assert_eq!((operation.constraint, operation.local), (Constraint::Axis(0), true));
    operation.press_axis(0, false, false);
    assert_eq!((operation.constraint, operation.local), (Constraint::Free, false));
    operation.press_axis(2, true, true);
    assert_eq!((operation.constraint, operation.local), (Constraint::Plane(2), true));
}

#[test]
fn snapping_gives_round_numbers_and_precision_a_tenth() {
    let lens = lens(&cameras()[0]);
    let mut document = document();
    let before = centers(&document)[0];
    let snap = Grip { snap: true, precise: false };
    let mut operation = begin(Kind::Move, &mut document, DVec2::new(300.0, 200.0));
    operation.point(&lens, DVec2::new(363.0, 141.0), snap);
    operation.update(&lens, &mut document, snap);
    let step = move_step(&lens, operation.pivot);
    let by = (centers(&document)[0] - before) / step;
    assert!(by.distance(by.round()) < 1e-9 && by.length() > 1.0, "{by}");
    document.cancel();

    let way = |precise| {
        let mut operation = begin(Kind::Move, &mut self::document(), DVec2::new(300.0, 200.0));
        operation.point(&lens, DVec2::new(340.0, 200.0), Grip { snap: false, precise });
        operation.way(&lens).unwrap().length()
    };
    assert!((way(true) / way(false) - 0.1).abs() < 1e-9);
}

#[test]
fn what_cannot_be_told_from_the_mouse_stays_as_it_was() {
    let lens = lens(&cameras()[0]);
    let pivot = lens.eye + 500.0 * lens.forward;
    // Along the line of sight, and a plane seen from its edge.
    assert_eq!(nearest_on_axis(pivot, lens.forward, lens.ray(lens.project(pivot).unwrap())), None);
    assert_eq!(plane_meets(pivot, lens.up, lens.ray(lens.project(pivot).unwrap())), None);
    assert_eq!(nice(0.8), 1.0);
    assert_eq!(nice(13.0), 20.0);
    assert_eq!(nice(0.05), 0.05);
}

#[test]
fn locked_ellipsoids_stay() {
    let mut document = document();
    document.edit("Lock", |scene| scene.clouds[0].ellipsoids[0].locked = true);
    let before = centers(&document);
    let lens = lens(&cameras()[0]);
    let mut operation = begin(Kind::Move, &mut document, DVec2::ZERO);
    operation.type_character('5');
    operation.update(&lens, &mut document, MOUSE);
    assert_eq!(centers(&document), [before[0], before[1] + 5.0 * DVec3::X]);
    document.edit("Lock", |scene| scene.clouds[0].locked = true);
    document.end();
    assert!(Operation::begin(Kind::Move, &mut document, Pivot::Middle, false, DVec2::ZERO).is_none());
}
