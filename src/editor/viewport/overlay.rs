//! What is drawn over the picture besides handles: outlines, the ground's grid, the horizon
//! with the compass, the sun.

use std::f64::consts::TAU;

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2};
use glam::DVec3;

use super::{ink, lens::Lens, outline, pick, space::nice};
use crate::{
    editor::{EllipsoidId, Selection},
    scene::{Camera, Ellipsoid, Scene},
};

/// Lines of the grid on either side of its middle.
const LINES: i32 = 24;
/// Far enough to be the horizon, m.
const FAR: f64 = 1e7;
/// How far from the mouse outlines are drawn, points, and how many.
const NEAR: f32 = 140.0;
const MOST_AROUND: usize = 12;
/// Radius of the Earth, m.
const EARTH: f64 = 6.36e6;

/// Outlines of what is selected and what the mouse is on; and of the others around `mouse`, a place of
/// the screen, fainter with their distance: all of them would bury a cloud of hundreds.
pub fn outlines(
    painter: &Painter,
    lens: &Lens,
    scene: &Scene,
    selection: &Selection,
    hover: Option<EllipsoidId>,
    mouse: Option<Pos2>,
) {
    let rank = |id: EllipsoidId| match id {
        _ if selection.active == Some(id) => 3,
        _ if selection.contains(id) => 2,
        _ if hover == Some(id) => 1,
        _ => 0,
    };
    let draw = |id: EllipsoidId, ellipsoid: &Ellipsoid, width: f32, color: Color32| {
        let seen = scene.clouds[id.cloud].mean_edge(ellipsoid);
        for line in outline::lines(&seen, lens) {
            ink::line(painter, &line, width, color);
        }
    };
    if let Some(mouse) = mouse {
        for (id, ellipsoid, away) in around(lens, scene, mouse).into_iter().filter(|(id, ..)| rank(*id) == 0)
        {
            draw(id, ellipsoid, 1.0, ink::QUIET.gamma_multiply(1.0 - 0.75 * away / NEAR));
        }
    }
    let mut marked: Vec<_> = pick::visible(scene).map(|(id, e)| (rank(id), id, e)).collect();
    marked.retain(|(rank, ..)| *rank > 0);
    // The important ones over the others.
    marked.sort_by_key(|(rank, ..)| *rank);
    for (rank, id, ellipsoid) in marked {
        let hovered = hover == Some(id);
        let (width, color) = match rank {
            3 => (2.2, ink::ACTIVE),
            2 => (1.8, ink::SELECTED),
            _ => (1.6, ink::HOVER),
        };
        draw(id, ellipsoid, width + if hovered && rank > 1 { 0.8 } else { 0.0 }, color);
    }
}

/// What has its middle near `mouse` on the screen, nearest first, with the distance in points.
fn around<'a>(lens: &Lens, scene: &'a Scene, mouse: Pos2) -> Vec<(EllipsoidId, &'a Ellipsoid, f32)> {
    let away = |ellipsoid| outline::center(ellipsoid, lens).map(|at| at.distance(mouse));
    let mut near: Vec<_> = pick::visible(scene)
        .filter_map(|(id, ellipsoid)| Some((id, ellipsoid, away(ellipsoid)?)))
        .filter(|(.., away)| *away < NEAR)
        .collect();
    near.sort_by(|a, b| a.2.total_cmp(&b.2));
    near.truncate(MOST_AROUND);
    near
}

/// Dots at the centres of everything that a box can take.
pub fn centers(painter: &Painter, lens: &Lens, scene: &Scene, chosen: impl Fn(EllipsoidId) -> bool) {
    for (id, ellipsoid) in pick::free(scene) {
        if let Some(at) = outline::center(ellipsoid, lens) {
            ink::disc(painter, at, 3.5, if chosen(id) { ink::SELECTED } else { ink::WORDS });
        }
    }
}

/// The grid on the ground at `altitude`, its lines as far apart as suits the distance of
/// the pivot, fading with it.
pub fn grid(painter: &Painter, lens: &Lens, altitude: f64, pivot: DVec3, distance: f64) {
    let height = (lens.eye.y - altitude).abs();
    let step = nice(0.1 * distance.max(height));
    let middle = (pivot / step).round() * step;
    let end = f64::from(LINES) * step;
    for i in -LINES..=LINES {
        let fade = 1.0 - (f64::from(i.abs()) / f64::from(LINES)).powi(2);
        for along in [DVec3::X, DVec3::Z] {
            let across = DVec3::new(along.z, 0.0, along.x);
            let start = DVec3::new(middle.x, altitude, middle.z) + f64::from(i) * step * across;
            let index = (start.dot(across) / step).round() as i64;
            let strong = if index % 10 == 0 { 2.0 } else { 1.0 };
            faded_line(painter, lens, [start - end * along, start + end * along], 0.11 * strong * fade);
        }
    }
}

/// A line that is brightest in its middle.
fn faded_line(painter: &Painter, lens: &Lens, [a, b]: [DVec3; 2], strength: f64) {
    const PIECES: i32 = 8;
    let at = |i: i32| a.lerp(b, f64::from(i) / f64::from(PIECES));
    for i in 0..PIECES {
        let from_middle = (2.0 * (f64::from(i) + 0.5) / f64::from(PIECES) - 1.0).abs();
        let alpha = (255.0 * strength * (1.0 - from_middle.powi(2))) as u8;
        let Some(ends) = lens.clip(at(i), at(i + 1)) else { continue };
        if let [Some(a), Some(b)] = ends.map(|p| lens.place(p))
            && alpha > 3
        {
            painter.line_segment([a, b], Stroke::new(1.0, Color32::from_white_alpha(alpha)));
        }
    }
}

/// The horizon as it is seen from above ground at `altitude`, with the compass on it.
pub fn horizon(painter: &Painter, lens: &Lens, altitude: f64) {
    if lens.orthographic {
        return;
    }
    let dip = -(1.0 - (EARTH / (EARTH + (lens.eye.y - altitude).max(0.0))).powi(2)).sqrt();
    let direction = |turns: f64| {
        let (sin, cos) = (TAU * turns).sin_cos();
        DVec3::new(sin, dip, -cos)
    };
    let place = |turns: f64| lens.place(lens.eye + FAR * direction(turns));
    for i in 0..72 {
        let (a, b) = (f64::from(i) / 72.0, f64::from(i + 1) / 72.0);
        if let (Some(a), Some(b)) = (place(a), place(b)) {
            painter.line_segment([a, b], Stroke::new(1.0, Color32::from_white_alpha(38)));
        }
    }
    for (i, name) in ["N", "NE", "E", "SE", "S", "SW", "W", "NW"].into_iter().enumerate() {
        let Some(at) = place(i as f64 / 8.0).filter(|at| lens.rect.shrink(14.0).contains(*at)) else {
            continue;
        };
        let badge = at - Vec2::new(0.0, 13.0);
        painter
            .line_segment([at, at - Vec2::new(0.0, 4.0)], Stroke::new(1.0, Color32::from_white_alpha(120)));
        let half = Vec2::new(if name.len() > 1 { 11.0 } else { 8.0 }, 8.0);
        painter.rect_filled(Rect::from_center_size(badge, 2.0 * half), 8.0, Color32::from_black_alpha(120));
        painter.text(badge, Align2::CENTER_CENTER, name, FontId::proportional(10.5), Color32::from_gray(225));
    }
}

/// Where the sun stands, where it can be seen.
pub fn sun(painter: &Painter, lens: &Lens, to_sun: DVec3) {
    let place = lens.place(lens.eye + FAR * to_sun).filter(|at| lens.rect.expand(20.0).contains(*at));
    let (Some(at), false) = (place, lens.orthographic) else { return };
    ink::ring(painter, at, 9.0, 1.5, ink::SUN);
    for i in 0..8 {
        let ray = Vec2::angled(i as f32 * std::f32::consts::TAU / 8.0);
        ink::line(painter, &[at + 13.0 * ray, at + 17.0 * ray], 1.5, ink::SUN);
    }
}

/// The scene's camera as seen from elsewhere: what a picture of 16 by 9 would hold.
pub fn camera(painter: &Painter, lens: &Lens, camera: &Camera) {
    const ASPECT: f64 = 16.0 / 9.0;
    let size = 46.0 * lens.metres_per_point(camera.position);
    if lens.depth(camera.position) < 0.05 * size && !lens.orthographic {
        return;
    }
    let turn = camera.world_from_camera();
    let half = camera.projection.vertical_fov(ASPECT).map_or(0.5, |fov| (0.5 * fov).tan()).clamp(0.15, 1.0);
    let [right, higher] = camera.shift(ASPECT);
    let corner = |x: f64, y: f64| {
        camera.position + size * (turn * DVec3::new((x + right) * half * ASPECT, (y + higher) * half, -1.0))
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let up = [corner(-0.35, 1.15), corner(0.35, 1.15), corner(0.0, 1.6)];
    let line = |a: DVec3, b: DVec3| {
        if let Some([Some(a), Some(b)]) = lens.clip(a, b).map(|ends| ends.map(|p| lens.place(p))) {
            ink::line(painter, &[a, b], 1.2, ink::WORDS);
        }
    };
    for i in 0..4 {
        line(corners[i], corners[(i + 1) % 4]);
        line(camera.position, corners[i]);
    }
    (0..3).for_each(|i| line(up[i], up[(i + 1) % 3]));
}

/// What the final picture holds: the largest rectangle of `aspect`, the rest dimmed.
pub fn frame(painter: &Painter, window: Rect, aspect: f32) {
    let size = window.size();
    let size = Vec2::new(size.x.min(size.y * aspect), size.y.min(size.x / aspect));
    let picture = Rect::from_center_size(window.center(), size);
    let (low, high) = (picture.min, picture.max);
    for rest in [
        Rect::from_min_max(window.min, Pos2::new(window.max.x, low.y)),
        Rect::from_min_max(Pos2::new(window.min.x, high.y), window.max),
        Rect::from_min_max(Pos2::new(window.min.x, low.y), Pos2::new(low.x, high.y)),
        Rect::from_min_max(Pos2::new(high.x, low.y), Pos2::new(window.max.x, high.y)),
    ] {
        if rest.is_positive() {
            painter.rect_filled(rest, 0.0, Color32::from_black_alpha(96));
        }
    }
    painter.rect_stroke(picture, 0.0, Stroke::new(1.0, Color32::from_white_alpha(120)), StrokeKind::Inside);
}

/// The line of an axis through the pivot, right across the view.
pub fn axis_line(painter: &Painter, lens: &Lens, pivot: DVec3, axis: DVec3, color: Color32) {
    let reach = 2e4 * lens.metres_per_point(pivot);
    if let Some([a, b]) = lens.clip(pivot - reach * axis, pivot + reach * axis)
        && let [Some(a), Some(b)] = [a, b].map(|p| lens.place(p))
    {
        ink::line(painter, &[a, b], 1.8, color);
    }
}

/// A dashed line, from the pivot to the mouse.
pub fn tether(painter: &Painter, from: Pos2, to: Pos2) {
    painter.extend(Shape::dashed_line(
        &[from, to],
        Stroke::new(3.0, Color32::from_black_alpha(110)),
        6.0,
        4.0,
    ));
    painter.extend(Shape::dashed_line(&[from, to], Stroke::new(1.2, ink::WORDS), 6.0, 4.0));
}

/// The box that selects.
pub fn selection_box(painter: &Painter, area: Rect) {
    painter.rect(
        area,
        0.0,
        ink::HOVER.gamma_multiply(0.12),
        Stroke::new(1.0, ink::HOVER),
        StrokeKind::Middle,
    );
}
