//! The handles at what is selected: where they are, which one is under the cursor, how
//! they look. They keep their size on the screen.

use std::f64::consts::TAU;

use eframe::egui::{Color32, Painter, Pos2};
use glam::{DQuat, DVec2, DVec3};

use super::{
    ink,
    lens::{Lens, pos},
    operation::{Constraint, Kind},
    settings::Tool,
    space::{ARM, axis_of},
};

/// Radius of the ring in the plane of the screen, points.
const SCREEN_RING: f64 = 1.22 * ARM;
/// Corners of the squares in the planes, as shares of the arms.
const PLANE: [f64; 2] = [0.28, 0.46];
/// How near the cursor must come, points.
const REACH: f64 = 8.0;
/// Arms and planes that look shorter or narrower than this share are left out.
const SHORTEST: f64 = 0.12;
/// Corners of a ring.
const CORNERS: usize = 96;

/// A gizmo in the viewport.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gizmo {
    /// What it does.
    pub kind: Kind,
    /// Where it is, m.
    pub pivot: DVec3,
    /// From its axes to the world.
    pub frame: DQuat,
}

impl Gizmo {
    /// The gizmo of a tool; the select tool has none.
    pub fn new(tool: Tool, pivot: DVec3, frame: DQuat) -> Option<Self> {
        let kind = match tool {
            Tool::Select => return None,
            Tool::Move => Kind::Move,
            Tool::Rotate => Kind::Rotate,
            Tool::Scale => Kind::Scale,
        };
        Some(Self { kind, pivot, frame })
    }

    /// The handle under a place of the screen: what a drag there is held to.
    pub fn handle_at(&self, lens: &Lens, at: DVec2) -> Option<Constraint> {
        let center = lens.project(self.pivot)?;
        match self.kind {
            Kind::Rotate => self.ring_at(lens, center, at),
            Kind::Move | Kind::Scale => self.arm_at(lens, center, at),
        }
    }

    /// Draws it; `lit` is the handle under the cursor or in the hand.
    pub fn draw(&self, painter: &Painter, lens: &Lens, lit: Option<Constraint>) {
        let Some(center) = lens.project(self.pivot) else { return };
        match self.kind {
            Kind::Rotate => self.draw_rings(painter, lens, center, lit),
            Kind::Move | Kind::Scale => self.draw_arms(painter, lens, center, lit),
        }
    }

    /// A point of the gizmo, given in arms along its axes.
    fn point(&self, lens: &Lens, arms: DVec3) -> DVec3 {
        self.pivot + self.frame * (ARM * lens.metres_per_point(self.pivot) * arms)
    }

    fn arm_at(&self, lens: &Lens, center: DVec2, at: DVec2) -> Option<Constraint> {
        if at.distance(center) < 1.2 * REACH {
            return Some(Constraint::Free);
        }
        let arms = (0..3).filter_map(|axis| {
            let end = self.arm(lens, axis)?;
            Some((to_segment(at, center + 0.2 * (end - center), end), Constraint::Axis(axis)))
        });
        let nearest = arms.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance < REACH);
        nearest.map(|(_, arm)| arm).or_else(|| {
            (0..3)
                .find(|&axis| self.plane(lens, axis).is_some_and(|corners| inside(&corners, at)))
                .map(Constraint::Plane)
        })
    }

    fn ring_at(&self, lens: &Lens, center: DVec2, at: DVec2) -> Option<Constraint> {
        let rings = (0..3).filter_map(|axis| {
            let places: Vec<_> = self.front_of_ring(lens, axis).collect();
            let distance = places
                .windows(2)
                .filter_map(|pair| Some(to_segment(at, pair[0]?, pair[1]?)))
                .min_by(f64::total_cmp)?;
            Some((distance, Constraint::Axis(axis)))
        });
        let outer = ((at.distance(center) - SCREEN_RING).abs(), Constraint::Free);
        let nearest = rings.chain([outer]).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (nearest.0 < REACH).then_some(nearest.1)
    }

    /// The end of an arm on the screen, unless it points at the eye.
    fn arm(&self, lens: &Lens, axis: usize) -> Option<DVec2> {
        let end = lens.project(self.point(lens, DVec3::AXES[axis]))?;
        let center = lens.project(self.pivot)?;
        (end.distance(center) > SHORTEST * ARM).then_some(end)
    }

    /// Corners of the square across an axis, unless it is seen from its edge.
    fn plane(&self, lens: &Lens, axis: usize) -> Option<[DVec2; 4]> {
        if axis_of(self.frame, axis).dot(lens.to_eye(self.pivot)).abs() < 1.5 * SHORTEST {
            return None;
        }
        let (a, b) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
        let [near, far] = PLANE;
        let corner = |s: f64, t: f64| lens.project(self.point(lens, s * a + t * b));
        Some([corner(near, near)?, corner(far, near)?, corner(far, far)?, corner(near, far)?])
    }

    /// The half of a ring that faces the eye; gaps where the other half is.
    fn front_of_ring(&self, lens: &Lens, axis: usize) -> impl Iterator<Item = Option<DVec2>> {
        let toward = self.frame.inverse() * lens.to_eye(self.pivot);
        let across = DVec3::AXES[axis].dot(toward).abs() > 0.995;
        self.ring(axis).map(move |arms| {
            let front = across || arms.dot(toward) > -0.02;
            front.then(|| lens.project(self.point(lens, arms))).flatten()
        })
    }

    fn ring(&self, axis: usize) -> impl Iterator<Item = DVec3> {
        let (a, b) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
        (0..=CORNERS).map(move |i| {
            let (sin, cos) = (TAU * i as f64 / CORNERS as f64).sin_cos();
            cos * a + sin * b
        })
    }

    fn draw_arms(&self, painter: &Painter, lens: &Lens, center: DVec2, lit: Option<Constraint>) {
        for axis in 0..3 {
            if let Some(corners) = self.plane(lens, axis) {
                let (alpha, color) = shade(lit, Constraint::Plane(axis), ink::AXIS[axis]);
                ink::area(painter, corners.map(pos).to_vec(), color.gamma_multiply(0.55 * alpha));
            }
        }
        for axis in 0..3 {
            let Some(end) = self.arm(lens, axis) else { continue };
            let (alpha, color) = shade(lit, Constraint::Axis(axis), ink::AXIS[axis]);
            let color = color.gamma_multiply(alpha);
            let along = (end - center).normalize();
            ink::line(painter, &[pos(center + 10.0 * along), pos(end)], 3.0, color);
            let across = along.perp();
            let tip = match self.kind {
                Kind::Scale => {
                    let (a, b) = (6.0 * along, 6.0 * across);
                    vec![end - a - b, end + a - b, end + a + b, end - a + b]
                }
                _ => vec![end + 15.0 * along, end + 6.5 * across, end - 6.5 * across],
            };
            ink::area(painter, tip.into_iter().map(pos).collect(), color);
        }
        let (alpha, color) = shade(lit, Constraint::Free, ink::WORDS);
        match self.kind {
            Kind::Scale => ink::disc(painter, pos(center), 6.0, color.gamma_multiply(alpha)),
            _ => ink::ring(painter, pos(center), 7.0, 2.0, color.gamma_multiply(alpha)),
        }
    }

    fn draw_rings(&self, painter: &Painter, lens: &Lens, center: DVec2, lit: Option<Constraint>) {
        let (alpha, color) = shade(lit, Constraint::Free, ink::WORDS);
        ink::ring(painter, pos(center), SCREEN_RING as f32, 2.0, color.gamma_multiply(alpha));
        for axis in 0..3 {
            let (alpha, color) = shade(lit, Constraint::Axis(axis), ink::AXIS[axis]);
            let whole: Vec<_> =
                self.ring(axis).filter_map(|arms| lens.project(self.point(lens, arms))).map(pos).collect();
            ink::line(painter, &whole, 1.0, color.gamma_multiply(0.25 * alpha));
            let front: Vec<_> = self.front_of_ring(lens, axis).collect();
            for piece in front.split(Option::is_none).filter(|piece| piece.len() > 1) {
                let places: Vec<Pos2> = piece.iter().flatten().copied().map(pos).collect();
                ink::line(painter, &places, 3.0, color.gamma_multiply(alpha));
            }
        }
        ink::disc(painter, pos(center), 3.0, ink::WORDS);
    }
}

/// The handle in the hand or under the cursor shines, the others step back.
fn shade(lit: Option<Constraint>, handle: Constraint, color: Color32) -> (f32, Color32) {
    match lit {
        Some(lit) if lit == handle => (1.0, color.lerp_to_gamma(Color32::WHITE, 0.45)),
        Some(_) => (0.5, color),
        None => (0.92, color),
    }
}

fn to_segment(at: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
    at.distance(a + share * (b - a))
}

/// Whether a place is in a polygon without dents.
fn inside(corners: &[DVec2], at: DVec2) -> bool {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (b - a).perp_dot(at - a)
    };
    let sides: Vec<f64> = (0..corners.len()).map(side).collect();
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::viewport::lens::tests::{cameras, lens};

    fn gizmo(lens: &Lens, tool: Tool) -> Gizmo {
        let frame = DQuat::from_axis_angle(DVec3::new(0.6, 0.48, 0.64), 0.8);
        Gizmo::new(tool, lens.eye + 900.0 * lens.forward + 50.0 * lens.right, frame).unwrap()
    }

    #[test]
    fn every_handle_is_found_where_it_is_drawn() {
        for camera in cameras() {
            let lens = lens(&camera);
            for tool in [Tool::Move, Tool::Scale] {
                let gizmo = gizmo(&lens, tool);
                let center = lens.project(gizmo.pivot).unwrap();
                assert_eq!(gizmo.handle_at(&lens, center), Some(Constraint::Free));
                for axis in 0..3 {
                    let end = gizmo.arm(&lens, axis).unwrap();
                    assert_eq!(gizmo.handle_at(&lens, end), Some(Constraint::Axis(axis)));
                }
                assert_eq!(gizmo.handle_at(&lens, center + DVec2::new(200.0, 0.0)), None);
            }
            let rings = gizmo(&lens, Tool::Rotate);
            let center = lens.project(rings.pivot).unwrap();
            let outside = center + SCREEN_RING * DVec2::new(0.6, 0.8);
            assert_eq!(rings.handle_at(&lens, outside), Some(Constraint::Free));
            for axis in 0..3 {
                let hit = rings
                    .front_of_ring(&lens, axis)
                    .flatten()
                    .filter(|&at| rings.handle_at(&lens, at) == Some(Constraint::Axis(axis)))
                    .count();
                assert!(hit > 20, "{hit}");
            }
        }
    }

    #[test]
    fn a_plane_is_found_in_its_square() {
        let lens = lens(&cameras()[0]);
        let gizmo = gizmo(&lens, Tool::Move);
        let found = (0..3).filter(|&axis| {
            let Some(corners) = gizmo.plane(&lens, axis) else { return false };
            let middle = corners.iter().sum::<DVec2>() / 4.0;
            gizmo.handle_at(&lens, middle) == Some(Constraint::Plane(axis))
        });
        assert!(found.count() >= 2);
    }

    #[test]
    fn an_arm_that_points_at_the_eye_is_left_out() {
        let lens = lens(&cameras()[0]);
        let pivot = lens.eye + 900.0 * lens.forward;
        let frame = DQuat::from_rotation_arc(DVec3::X, -lens.forward);
        let gizmo = Gizmo::new(Tool::Move, pivot, frame).unwrap();
        assert_eq!(gizmo.arm(&lens, 0), None);
        assert!(gizmo.arm(&lens, 1).is_some() && gizmo.plane(&lens, 0).is_some());
        assert_eq!(Gizmo::new(Tool::Select, pivot, frame), None);
    }
}
