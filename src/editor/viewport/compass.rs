//! The small axes in the corner: which way the view looks, and a click to look along one.

use eframe::egui::{Align2, Color32, CursorIcon, FontId, Id, Painter, Pos2, Rect, Sense, Ui, Vec2};
use glam::DVec3;

use super::{ink, lens::Lens, navigation::Side};

/// From the middle to a ball, points.
const REACH: f32 = 32.0;
const BALL: f32 = 8.5;

/// A ball at the end of an axis: its axis, its letter if it is the positive end, and from
/// where a click on it looks.
const BALLS: [(usize, f64, &str, Side); 6] = [
    (0, 1.0, "X", Side::Right),
    (0, -1.0, "", Side::Left),
    (1, 1.0, "Y", Side::Top),
    (1, -1.0, "", Side::Bottom),
    (2, 1.0, "Z", Side::Front),
    (2, -1.0, "", Side::Back),
];

/// Draws it around `center`, with the sun's direction; tells the side that was clicked.
pub fn show(ui: &mut Ui, lens: &Lens, center: Pos2, to_sun: DVec3) -> Option<Side> {
    let painter = ui.painter().clone();
    let size = 2.0 * (REACH + BALL + 2.0);
    let area = Rect::from_center_size(center, Vec2::splat(size));
    let response = ui.interact(area, Id::new("nephos compass"), Sense::click());
    if response.hovered() {
        painter.circle_filled(center, 0.5 * size, Color32::from_white_alpha(22));
    }
    let place = |direction: DVec3| {
        let across = Vec2::new(direction.dot(lens.right) as f32, -direction.dot(lens.up) as f32);
        center + REACH * across
    };
    let mut balls = BALLS.map(|(axis, sign, name, side)| {
        let direction = sign * DVec3::AXES[axis];
        (direction.dot(lens.forward), place(direction), axis, name, side)
    });
    // Far ones first.
    balls.sort_by(|a, b| b.0.total_cmp(&a.0));
    let pointer = response.hover_pos();
    let over = pointer.and_then(|at| balls.iter().rev().find(|ball| ball.1.distance(at) < BALL + 2.0));
    let over = over.map(|ball| ball.4);
    for &(depth, at, axis, name, side) in &balls {
        ball(&painter, center, (at, depth), ink::AXIS[axis], name, over == Some(side));
    }
    sun(&painter, center, place(to_sun), to_sun.dot(lens.forward));
    if over.is_some() {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    }
    response
        .on_hover_text("Click an axis to look along it; the yellow dot is the sun.")
        .clicked()
        .then_some(over)?
}

fn ball(painter: &Painter, center: Pos2, (at, depth): (Pos2, f64), color: Color32, name: &str, over: bool) {
    // What points away steps back.
    let color = color.gamma_multiply(1.0 - 0.35 * (0.5 + 0.5 * depth as f32));
    let color = if over { color.lerp_to_gamma(Color32::WHITE, 0.5) } else { color };
    if name.is_empty() {
        painter.circle(at, 0.7 * BALL, Color32::from_black_alpha(110), (1.5, color));
        return;
    }
    ink::line(painter, &[center, at], 2.0, color);
    ink::disc(painter, at, BALL, color);
    painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(11.0), Color32::from_black_alpha(220));
}

fn sun(painter: &Painter, center: Pos2, at: Pos2, depth: f64) {
    let color = if depth < 0.0 { ink::SUN } else { ink::SUN.gamma_multiply(0.6) };
    painter.line_segment([center, at], (1.0, color.gamma_multiply(0.6)));
    ink::disc(painter, at, 3.5, color);
}
