//! Where operations take place: pivots, axes, and what the mouse means on them.

use glam::{DQuat, DVec3};

use super::{
    lens::{Lens, Ray},
    settings::Pivot,
};
use crate::editor::Document;

/// Length of the gizmo's arms and radius of its rings, points.
pub const ARM: f64 = 84.0;

/// One axis of a frame in the world.
pub fn axis_of(frame: DQuat, axis: usize) -> DVec3 {
    frame * DVec3::AXES[axis]
}

/// Where the gizmo is; nothing where nothing free is selected.
pub fn pivot_of(document: &Document, pivot: Pivot) -> Option<DVec3> {
    let ids = document.free_selection();
    let active = document.selection().active.filter(|id| ids.contains(id));
    match (pivot, active.and_then(|id| document.ellipsoid(id))) {
        (Pivot::Active, Some(active)) => Some(active.center),
        _ => {
            let centers: Vec<_> =
                ids.iter().filter_map(|&id| document.ellipsoid(id)).map(|e| e.center).collect();
            (!centers.is_empty()).then(|| centers.iter().sum::<DVec3>() / centers.len() as f64)
        }
    }
}

/// The axes of the active ellipsoid.
pub fn frame_of(document: &Document) -> DQuat {
    let ids = document.free_selection();
    let active = document.selection().active.or_else(|| ids.first().copied());
    active.and_then(|id| document.ellipsoid(id)).map_or(DQuat::IDENTITY, |e| e.orientation)
}

/// The step that moves snap to: 1, 2 or 5 times a power of ten, about 8 points on the screen.
pub fn move_step(lens: &Lens, at: DVec3) -> f64 {
    nice(8.0 * lens.metres_per_point(at))
}

/// The least of 1, 2, 5, 10 ... that is at least `x`.
pub fn nice(x: f64) -> f64 {
    let power = 10f64.powf(x.max(1e-12).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|n| n * power)
        .find(|&n| n >= x * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// Metres along an axis to the point that is nearest to a line of sight; nothing where they
/// are nearly parallel, or where it is behind the eye.
pub fn nearest_on_axis(origin: DVec3, axis: DVec3, ray: Ray) -> Option<f64> {
    let between = ray.origin - origin;
    let slant = axis.dot(ray.direction);
    let denominator = 1.0 - slant * slant;
    if denominator < 1e-4 {
        return None;
    }
    let along_axis = (between.dot(axis) - between.dot(ray.direction) * slant) / denominator;
    let along_ray = (between.dot(axis) * slant - between.dot(ray.direction)) / denominator;
    (along_ray > 0.0).then_some(along_axis)
}

/// Where a line of sight meets a plane; nothing where it grazes it or the plane is behind.
pub fn plane_meets(origin: DVec3, normal: DVec3, ray: Ray) -> Option<DVec3> {
    let slope = ray.direction.dot(normal);
    let distance = (origin - ray.origin).dot(normal) / slope;
    (slope.abs() > 1e-3 && distance > 0.0).then(|| ray.at(distance))
}

/// Enough digits to see a change, no more.
pub fn short(metres: f64) -> String {
    match metres.abs() {
        x if x >= 1000.0 => format!("{metres:.0}"),
        x if x >= 10.0 => format!("{metres:.1}"),
        _ => format!("{metres:.2}"),
    }
}
