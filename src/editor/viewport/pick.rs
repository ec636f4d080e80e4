//! What is under the cursor: rays and boxes against ellipsoids, in f64.

use eframe::egui::Rect;
use glam::DVec3;

use super::lens::{Lens, Ray, pos};
use crate::{
    editor::EllipsoidId,
    scene::{Ellipsoid, Scene},
};

/// An ellipsoid on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Which one.
    pub id: EllipsoidId,
    /// Where the ray meets its surface, m.
    pub distance: f64,
    /// Whether the ray begins in it, and leaves it there.
    pub inside: bool,
}

/// Where a ray enters and leaves an ellipsoid, m along the ray; negative behind its origin.
///
/// In the space where the ellipsoid is the unit sphere the ray's nearest point to the centre
/// is `nearest`; half the chord follows from Pythagoras. Nothing of the size of the origin's
/// distance is subtracted from its like, so small spheres far away lose no digits.
pub fn chord(ellipsoid: &Ellipsoid, ray: &Ray) -> Option<(f64, f64)> {
    let turn = ellipsoid.orientation.inverse();
    let origin = turn * (ray.origin - ellipsoid.center) / ellipsoid.radii;
    let direction = turn * ray.direction / ellipsoid.radii;
    let square = direction.length_squared();
    let middle = -origin.dot(direction) / square;
    let nearest = (origin + middle * direction).length_squared();
    let half = ((1.0 - nearest) / square).max(0.0).sqrt();
    (nearest <= 1.0).then_some((middle - half, middle + half))
}

/// Every ellipsoid that can be seen and is not locked, with its place.
pub fn free(scene: &Scene) -> impl Iterator<Item = (EllipsoidId, &Ellipsoid)> {
    visible(scene).filter(|(id, ellipsoid)| !scene.clouds[id.cloud].locked && !ellipsoid.locked)
}

/// Every ellipsoid that can be seen, with its place.
pub fn visible(scene: &Scene) -> impl Iterator<Item = (EllipsoidId, &Ellipsoid)> {
    scene.clouds.iter().enumerate().filter(|(_, cloud)| !cloud.hidden).flat_map(|(cloud, of)| {
        let seen = of.ellipsoids.iter().enumerate().filter(|(_, e)| !e.hidden);
        seen.map(move |(ellipsoid, e)| (EllipsoidId { cloud, ellipsoid }, e))
    })
}

/// What a ray meets, nearest first; those that it begins in come last, so that from inside
/// a large one the others can still be picked.
pub fn hits(scene: &Scene, ray: &Ray) -> Vec<Hit> {
    let hit = |(id, ellipsoid)| {
        let (enter, leave) = chord(ellipsoid, ray)?;
        let inside = enter <= 0.0;
        (leave > 0.0).then_some(Hit { id, distance: if inside { leave } else { enter }, inside })
    };
    let mut hits: Vec<Hit> = free(scene).filter_map(hit).collect();
    hits.sort_by(|a, b| a.inside.cmp(&b.inside).then(a.distance.total_cmp(&b.distance)));
    hits
}

/// Everything whose centre is in a box of the screen.
pub fn in_box(scene: &Scene, lens: &Lens, area: Rect) -> Vec<EllipsoidId> {
    let within = |center: DVec3| lens.project(center).is_some_and(|at| area.contains(pos(at)));
    free(scene).filter(|(_, ellipsoid)| within(ellipsoid.center)).map(|(id, _)| id).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        editor::viewport::lens::tests::{cameras, lens},
        scene::Cloud,
    };
    use eframe::egui::pos2;
    use glam::DQuat;

    fn turned(center: DVec3, radii: DVec3) -> Ellipsoid {
        let orientation = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        Ellipsoid { orientation, ..Ellipsoid::new(center, radii) }
    }

    fn scene(ellipsoids: Vec<Ellipsoid>) -> Scene {
        Scene { clouds: vec![Cloud { ellipsoids, ..Cloud::default() }], ..Scene::default() }
    }

    #[test]
    fn ends_of_the_chord_are_on_the_surface() {
        let ellipsoid = turned(DVec3::new(4e4, 2e3, -7e4), DVec3::new(900.0, 30.0, 400.0));
        for target in [DVec3::ZERO, DVec3::new(300.0, 5.0, 100.0), DVec3::new(-500.0, -3.0, 20.0)] {
            let aim = ellipsoid.center + ellipsoid.orientation * target;
            let ray = Ray {
                origin: DVec3::new(1.0, 2.0, 3.0),
                direction: (aim - DVec3::new(1.0, 2.0, 3.0)).normalize(),
            };
            let (enter, leave) = chord(&ellipsoid, &ray).unwrap();
            assert!(0.0 < enter && enter < leave);
            for t in [enter, leave] {
                let unit = ellipsoid.orientation.inverse() * (ray.at(t) - ellipsoid.center) / ellipsoid.radii;
                // f64 at 8e4 m is good to 1e-11 m, against radii of 30 m.
                assert!((unit.length() - 1.0).abs() < 1e-9, "{}", unit.length() - 1.0);
            }
        }
        let past = Ray { origin: ellipsoid.center + 901.0 * DVec3::Y, direction: DVec3::X };
        assert_eq!(chord(&ellipsoid, &past), None);
    }

    #[test]
    fn a_click_on_the_place_of_a_surface_point_picks_its_ellipsoid() {
        let near = turned(DVec3::new(900.0, 850.0, 300.0), DVec3::new(80.0, 40.0, 60.0));
        let far = turned(DVec3::new(-200.0, 900.0, 600.0), DVec3::new(300.0, 200.0, 500.0));
        let scene = scene(vec![far.clone(), near.clone()]);
        for camera in cameras() {
            let lens = lens(&camera);
            for (index, ellipsoid) in [(1, &near), (0, &far)] {
                let side = if index == 0 { 0.8 * lens.up } else { DVec3::ZERO };
                let toward = (lens.to_eye(ellipsoid.center) + side).normalize();
                // Where a line from the centre leaves the surface.
                let local = ellipsoid.orientation.inverse() * toward / ellipsoid.radii;
                let surface = ellipsoid.center + toward / local.length();
                let ray = lens.ray(lens.project(surface).unwrap());
                let hit = hits(&scene, &ray)[0];
                assert_eq!(hit.id, EllipsoidId { cloud: 0, ellipsoid: index });
                assert!(ray.at(hit.distance).distance(surface) < 1e-6);
            }
        }
    }

    #[test]
    fn from_inside_the_others_come_first_and_the_one_around_last() {
        let around = Ellipsoid::new(DVec3::ZERO, DVec3::splat(100.0));
        let before = Ellipsoid::new(DVec3::new(0.0, 0.0, -50.0), DVec3::splat(10.0));
        let behind = Ellipsoid::new(DVec3::new(0.0, 0.0, 50.0), DVec3::splat(10.0));
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::NEG_Z };
        let found = hits(&scene(vec![around, before, behind]), &ray);
        let seen: Vec<_> =
            found.iter().map(|hit| (hit.id.ellipsoid, hit.distance.round(), hit.inside)).collect();
        assert_eq!(seen, [(1, 40.0, false), (0, 100.0, true)]);
    }

    #[test]
    fn what_is_hidden_or_locked_is_not_picked() {
        let lump = Ellipsoid::new(DVec3::new(0.0, 0.0, -50.0), DVec3::splat(10.0));
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::NEG_Z };
        let mut scene = scene(vec![lump.clone(), lump]);
        assert_eq!(hits(&scene, &ray).len(), 2);
        scene.clouds[0].ellipsoids[0].hidden = true;
        scene.clouds[0].ellipsoids[1].locked = true;
        assert_eq!(hits(&scene, &ray), []);
        assert_eq!(visible(&scene).count(), 1);
    }

    #[test]
    fn a_box_takes_the_centres_in_it() {
        let lens = lens(&cameras()[0]);
        let at = |x: f64, y: f64| lens.at_depth(glam::DVec2::new(x, y), 2000.0);
        let lump = |center| Ellipsoid::new(center, DVec3::splat(300.0));
        let scene = scene(vec![lump(at(100.0, 100.0)), lump(at(300.0, 200.0)), lump(at(500.0, 100.0))]);
        let area = Rect::from_min_max(pos2(50.0, 50.0), pos2(320.0, 210.0));
        let found: Vec<_> = in_box(&scene, &lens, area).into_iter().map(|id| id.ellipsoid).collect();
        assert_eq!(found, [0, 1]);
    }
}
