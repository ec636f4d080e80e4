//! A move, turn or scaling under way: from the mouse and the keys to a [`Change`].

use std::fmt::Write as _;

use glam::{DQuat, DVec2, DVec3};

use super::{
    lens::Lens,
    settings::Pivot,
    space::{ARM, axis_of, frame_of, move_step, nearest_on_axis, pivot_of, plane_meets, short},
    transform::Change,
};
use crate::{
    editor::{Document, EllipsoidId},
    scene::Ellipsoid,
};

/// Snapped angle and factor.
const ANGLE_STEP: f64 = 5.0;
const FACTOR_STEP: f64 = 0.1;
/// Nearest to the pivot that a scaling may begin, points: nearer it would be wild.
const NEAREST: f64 = 12.0;
/// Share of the mouse's way that counts with Shift.
const PRECISE: f64 = 0.1;
/// Names of the axes.
pub const AXES: [&str; 3] = ["X", "Y", "Z"];

/// What is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Moving.
    Move,
    /// Turning.
    Rotate,
    /// Scaling.
    Scale,
}

impl Kind {
    /// Name of the step of undo.
    pub fn name(self) -> &'static str {
        match self {
            Self::Move => "Move",
            Self::Rotate => "Rotate",
            Self::Scale => "Scale",
        }
    }
}

/// To what a change is held.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Constraint {
    /// The plane of the screen; all axes.
    #[default]
    Free,
    /// One axis.
    Axis(usize),
    /// The plane across one axis.
    Plane(usize),
}

/// What the keys say of the mouse's way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Grip {
    /// Round numbers only.
    pub snap: bool,
    /// Slowly.
    pub precise: bool,
}

/// A change under way.
#[derive(Debug, Clone)]
pub struct Operation {
    /// What is done.
    pub kind: Kind,
    /// To what it is held.
    pub constraint: Constraint,
    /// Whether its axes are the active ellipsoid's.
    pub local: bool,
    /// Whether it was begun at a handle, and ends where the button is released.
    pub dragged: bool,
    /// What was typed.
    pub typed: String,
    /// About what it turns and scales, m.
    pub pivot: DVec3,
    own: DQuat,
    each: bool,
    starts: Vec<(EllipsoidId, Ellipsoid)>,
    from: DVec2,
    to: DVec2,
    mouse: DVec2,
    turned: f64,
    change: Change,
}

impl Operation {
    /// Begins with what is selected and free, at a place of the screen; nothing where there
    /// is nothing to change. Opens a step of undo.
    pub fn begin(kind: Kind, document: &mut Document, pivot: Pivot, local: bool, at: DVec2) -> Option<Self> {
        let ids = document.free_selection();
        let starts: Vec<_> =
            ids.iter().filter_map(|&id| Some((id, document.ellipsoid(id)?.clone()))).collect();
        let middle = pivot_of(document, pivot)?;
        let own = frame_of(document);
        document.begin(kind.name());
        (!starts.is_empty()).then_some(Self {
            kind,
            constraint: Constraint::Free,
            local,
            dragged: false,
            typed: String::new(),
            pivot: middle,
            own,
            each: pivot == Pivot::Each && starts.len() > 1,
            starts,
            from: at,
            to: at,
            mouse: at,
            turned: 0.0,
            change: Change::Move(DVec3::ZERO),
        })
    }

    /// The same by a handle: it ends where the button is let go.
    pub fn dragged_by(self, handle: Constraint) -> Self {
        Self { constraint: handle, dragged: true, ..self }
    }

    /// From the axes that it is held to into the world.
    pub fn frame(&self) -> DQuat {
        if self.local { self.own } else { DQuat::IDENTITY }
    }

    /// The key of an axis: the world's, then the active ellipsoid's, then none.
    pub fn press_axis(&mut self, axis: usize, plane: bool, local_first: bool) {
        let wanted = if plane { Constraint::Plane(axis) } else { Constraint::Axis(axis) };
        if self.constraint != wanted {
            (self.constraint, self.local) = (wanted, local_first);
        } else if self.local == local_first {
            self.local = !local_first;
        } else {
            (self.constraint, self.local) = (Constraint::Free, local_first);
        }
        self.turned = 0.0;
        if self.kind == Kind::Rotate {
            // A turn is counted from where its axis was chosen.
            self.from = self.to;
        }
    }

    /// The mouse went to `at`.
    pub fn point(&mut self, lens: &Lens, at: DVec2, grip: Grip) {
        let share = if grip.precise { PRECISE } else { 1.0 };
        let before = self.to;
        self.to += share * (at - self.mouse);
        self.mouse = at;
        if self.kind == Kind::Rotate {
            self.turned += self.turn_between(lens, before, self.to);
        }
    }

    /// Works out the change and makes it.
    pub fn update(&mut self, lens: &Lens, document: &mut Document, grip: Grip) {
        let change = match self.number() {
            Some(number) => Some(self.typed_change(lens, number)),
            None => self.mouse_change(lens, grip.snap),
        };
        self.change = change.unwrap_or(self.change);
        let (change, pivot, each) = (self.change, self.pivot, self.each);
        document.edit(self.kind.name(), |scene| {
            for (id, start) in &self.starts {
                let about = if each { start.center } else { pivot };
                if let Some(cloud) = scene.clouds.get_mut(id.cloud)
                    && let Some(ellipsoid) = cloud.ellipsoids.get_mut(id.ellipsoid)
                {
                    *ellipsoid = change.apply(about, start);
                }
            }
        });
    }

    /// A character of a number was typed; tells whether it was one.
    pub fn type_character(&mut self, character: char) -> bool {
        match character {
            '0'..='9' if self.typed.len() < 12 => self.typed.push(character),
            '.' | ',' if !self.typed.contains('.') => self.typed.push('.'),
            '-' if self.typed.starts_with('-') => drop(self.typed.remove(0)),
            '-' => self.typed.insert(0, '-'),
            _ => return false,
        }
        true
    }

    /// What was typed as a number; nothing where the mouse decides.
    pub fn number(&self) -> Option<f64> {
        if self.typed.is_empty() { None } else { Some(self.typed.parse().unwrap_or(0.0)) }
    }

    /// What is being done, in words and numbers.
    pub fn readout(&self) -> String {
        let mut text = self.kind.name().to_owned();
        match self.constraint {
            Constraint::Free => {}
            Constraint::Axis(axis) => {
                let _ = write!(text, " along {}", AXES[axis]);
            }
            Constraint::Plane(axis) => {
                let _ = write!(text, " across {}", AXES[axis]);
            }
        }
        if self.constraint != Constraint::Free && self.local {
            text.push_str(" (local)");
        }
        text.push_str("  ");
        text.push_str(&self.amount());
        if !self.typed.is_empty() {
            let _ = write!(text, "  [{}]", self.typed);
        }
        text
    }

    fn amount(&self) -> String {
        match self.change {
            Change::Move(by) => {
                let by = self.frame().inverse() * by;
                match self.constraint {
                    Constraint::Axis(axis) => format!("{} m", short(by[axis])),
                    _ => format!(
                        "x {}  y {}  z {}  ({} m)",
                        short(by.x),
                        short(by.y),
                        short(by.z),
                        short(by.length())
                    ),
                }
            }
            Change::Turn { angle, .. } => format!("{:.1}°", angle.to_degrees()),
            Change::Scale { factors, .. } => match self.constraint {
                Constraint::Axis(axis) => format!("× {:.3}", factors[axis]),
                Constraint::Plane(axis) => format!("× {:.3}", factors[(axis + 1) % 3]),
                Constraint::Free => format!("× {:.3}", factors.x),
            },
        }
    }

    fn typed_change(&self, lens: &Lens, number: f64) -> Change {
        match self.kind {
            Kind::Move => {
                let along = match self.constraint {
                    Constraint::Axis(axis) => axis_of(self.frame(), axis),
                    Constraint::Plane(axis) => axis_of(self.frame(), (axis + 1) % 3),
                    Constraint::Free => axis_of(self.frame(), 0),
                };
                Change::Move(number * along)
            }
            Kind::Rotate => Change::Turn { axis: self.turn_axis(lens), angle: number.to_radians() },
            Kind::Scale => self.scaling(number),
        }
    }

    fn mouse_change(&self, lens: &Lens, snap: bool) -> Option<Change> {
        match self.kind {
            Kind::Move => {
                let by = self.way(lens)?;
                let step = move_step(lens, self.pivot);
                Some(Change::Move(if snap { self.snapped(by, step) } else { by }))
            }
            Kind::Rotate => {
                let step = ANGLE_STEP.to_radians();
                let angle = if snap { (self.turned / step).round() * step } else { self.turned };
                Some(Change::Turn { axis: self.turn_axis(lens), angle })
            }
            Kind::Scale => {
                let factor = self.factor(lens)?;
                let round = (factor / FACTOR_STEP).round() * FACTOR_STEP;
                Some(self.scaling(if snap { round } else { factor }))
            }
        }
    }

    /// The way that keeps what was grabbed under the mouse.
    fn way(&self, lens: &Lens) -> Option<DVec3> {
        let (from, to) = (lens.ray(self.from), lens.ray(self.to));
        match self.constraint {
            Constraint::Free => {
                let depth = lens.depth(self.pivot);
                Some(lens.at_depth(self.to, depth) - lens.at_depth(self.from, depth))
            }
            Constraint::Axis(axis) => {
                let axis = axis_of(self.frame(), axis);
                let along = |ray| nearest_on_axis(self.pivot, axis, ray);
                Some((along(to)? - along(from)?) * axis)
            }
            Constraint::Plane(axis) => {
                let normal = axis_of(self.frame(), axis);
                let meet = |ray| plane_meets(self.pivot, normal, ray);
                Some(meet(to)? - meet(from)?)
            }
        }
    }

    fn snapped(&self, by: DVec3, step: f64) -> DVec3 {
        let frame = self.frame();
        frame * ((frame.inverse() * by) / step).round() * step
    }

    /// The turn between two places of the mouse: around the pivot as seen, or across the
    /// ring where it is seen from its edge.
    fn turn_between(&self, lens: &Lens, from: DVec2, to: DVec2) -> f64 {
        let Some(center) = lens.project(self.pivot) else { return 0.0 };
        let (axis, toward) = (self.turn_axis(lens), lens.to_eye(self.pivot));
        let facing = axis.dot(toward);
        if self.dragged && facing.abs() < 0.2 {
            let front = axis.cross(toward).normalize_or_zero();
            let across = DVec2::new(front.dot(lens.right), -front.dot(lens.up)).normalize_or_zero();
            return (to - from).dot(across) / ARM;
        }
        let (a, b) = (from - center, to - center);
        if a.length() < 1.0 || b.length() < 1.0 {
            return 0.0;
        }
        // The screen's y goes down: what looks counter-clockwise is negative there.
        -a.angle_to(b) * if facing < 0.0 { -1.0 } else { 1.0 }
    }

    fn turn_axis(&self, lens: &Lens) -> DVec3 {
        match self.constraint {
            Constraint::Free => lens.to_eye(self.pivot),
            Constraint::Axis(axis) | Constraint::Plane(axis) => axis_of(self.frame(), axis),
        }
    }

    fn factor(&self, lens: &Lens) -> Option<f64> {
        let center = lens.project(self.pivot)?;
        let (from, to) = (self.from - center, self.to - center);
        if self.dragged
            && let Constraint::Axis(axis) = self.constraint
            && let Some(end) =
                lens.project(self.pivot + lens.metres_per_point(self.pivot) * axis_of(self.frame(), axis))
        {
            // Only the way along the arm counts.
            let along = (end - center).normalize_or_zero();
            let begin = from.dot(along);
            return Some(to.dot(along) / begin.abs().max(NEAREST) * begin.signum());
        }
        Some(to.length() / from.length().max(NEAREST))
    }

    fn scaling(&self, factor: f64) -> Change {
        let mut factors = DVec3::ONE;
        match self.constraint {
            Constraint::Free => factors = DVec3::splat(factor),
            Constraint::Axis(axis) => factors[axis] = factor,
            Constraint::Plane(axis) => {
                factors = DVec3::splat(factor);
                factors[axis] = 1.0;
            }
        }
        Change::Scale { factors, frame: self.frame() }
    }
}

#[cfg(test)]
#[path = "operation_tests.rs"]
mod tests;
