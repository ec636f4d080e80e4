//! Lines, shapes and words that stay readable over bright clouds and dark skies: each has a
//! dark rim.

use eframe::egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, epaint::RectShape,
};

/// Colours of the x, y and z axis.
pub const AXIS: [Color32; 3] =
    [Color32::from_rgb(240, 80, 88), Color32::from_rgb(112, 200, 80), Color32::from_rgb(86, 148, 255)];
/// What is selected.
pub const SELECTED: Color32 = Color32::from_rgb(255, 150, 40);
/// The active one of it.
pub const ACTIVE: Color32 = Color32::from_rgb(255, 205, 90);
/// What the cursor is over.
pub const HOVER: Color32 = Color32::from_rgb(140, 215, 255);
/// What is not selected.
pub const QUIET: Color32 = Color32::from_rgba_premultiplied(120, 120, 120, 120);
/// The sun.
pub const SUN: Color32 = Color32::from_rgb(255, 222, 120);
/// Words.
pub const WORDS: Color32 = Color32::from_rgb(240, 240, 240);
const RIM: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 120);
const PLATE: Color32 = Color32::from_rgba_premultiplied(17, 20, 24, 222);

/// A line through points, with its rim.
pub fn line(painter: &Painter, points: &[Pos2], width: f32, color: Color32) {
    let rim = RIM.gamma_multiply(f32::from(color.a()) / 255.0);
    painter.add(Shape::line(points.to_vec(), Stroke::new(width + 2.0, rim)));
    painter.add(Shape::line(points.to_vec(), Stroke::new(width, color)));
}

/// A filled shape without dents, with its rim.
pub fn area(painter: &Painter, points: Vec<Pos2>, color: Color32) {
    painter.add(Shape::convex_polygon(points, color, Stroke::new(1.0, RIM)));
}

/// A disc with its rim.
pub fn disc(painter: &Painter, at: Pos2, radius: f32, color: Color32) {
    painter.circle(at, radius, color, Stroke::new(1.0, RIM));
}

/// A ring with its rim.
pub fn ring(painter: &Painter, at: Pos2, radius: f32, width: f32, color: Color32) {
    painter.circle_stroke(at, radius, Stroke::new(width + 2.0, RIM));
    painter.circle_stroke(at, radius, Stroke::new(width, color));
}

/// Words with a shadow.
pub fn words(painter: &Painter, at: Pos2, align: Align2, size: f32, color: Color32, text: &str) -> Rect {
    let font = FontId::proportional(size);
    let shadow = Color32::from_black_alpha(150);
    painter.text(at + Vec2::new(0.5, 1.0), align, text, font.clone(), shadow);
    painter.text(at, align, text, font, color)
}

/// Words on a dark plate.
pub fn plate(painter: &Painter, at: Pos2, align: Align2, size: f32, text: &str) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(size), WORDS);
    let rect = align.anchor_size(at, galley.size() + Vec2::new(16.0, 8.0));
    panel(painter, rect);
    painter.galley(rect.min + Vec2::new(8.0, 4.0), galley, WORDS);
    rect
}

/// A dark plate.
pub fn panel(painter: &Painter, rect: Rect) {
    painter.add(panel_shape(rect));
}

/// The same, to be put under what is drawn already.
pub fn panel_shape(rect: Rect) -> Shape {
    let edge = Stroke::new(1.0, Color32::from_white_alpha(18));
    RectShape::new(rect, 5.0, PLATE, edge, StrokeKind::Inside).into()
}
