//! The sky as seen by a person lying on the ground, north up: the zenith in the middle, the
//! horizon as a ring, the sun to be dragged.

use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Pos2, Response, Sense, Stroke, Ui, WidgetInfo, WidgetType, pos2,
    vec2,
};

/// Radius of the horizon, points.
const HORIZON: f32 = 62.0;
/// Lowest elevation that the dial shows, degrees.
const LOWEST: f64 = -18.0;

/// The dial.
#[derive(Debug, Clone, Copy)]
pub struct SunDial {
    /// Where the sun stands, degrees clockwise from north.
    pub azimuth_deg: f64,
    /// How high it stands, degrees.
    pub elevation_deg: f64,
    /// Where the camera looks, degrees clockwise from north.
    pub heading_deg: f64,
}

impl SunDial {
    /// Shows the dial and lights to choose; the new azimuth and elevation where they were set.
    pub fn ui(self, ui: &mut Ui) -> Option<(f64, f64)> {
        let mut set = None;
        ui.horizontal(|ui| {
            set = self.dial(ui);
            ui.vertical(|ui| {
                ui.add_space(8.0);
                let light = |name, turn, elevation| (name, (self.heading_deg + turn, elevation));
                // Turns from where the camera looks, that clouds are commonly lit from.
                let lights = [
                    light("Front light", 155.0, 35.0),
                    light("Side light", 100.0, 25.0),
                    light("Back light", 12.0, 16.0),
                    light("Low sun", 70.0, 3.0),
                    light("Noon", 180.0, 65.0),
                ];
                for (name, (azimuth, elevation)) in lights {
                    let button = ui.button(name);
                    if button.on_hover_text("Puts the sun there, seen from the scene's camera.").clicked() {
                        set = Some((azimuth.rem_euclid(360.0).round(), elevation));
                    }
                }
            });
        });
        set
    }

    fn dial(self, ui: &mut Ui) -> Option<(f64, f64)> {
        let (rect, response) =
            ui.allocate_exact_size(vec2(2.0 * HORIZON + 36.0, 2.0 * HORIZON + 36.0), Sense::click_and_drag());
        let response = response
            .on_hover_text("Drag the sun: the middle is overhead, the ring is the horizon. North is up.")
            .on_hover_cursor(CursorIcon::Crosshair);
        self.describe(&response);
        self.paint(ui, rect.center());
        let from = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())?;
        Some(angles_at(from, rect.center()))
    }

    fn describe(self, response: &Response) {
        let (azimuth, elevation) = (self.azimuth_deg, self.elevation_deg);
        response.widget_info(|| {
            let text = format!("Sun dial: azimuth {azimuth:.0}, elevation {elevation:.0} degrees");
            WidgetInfo::labeled(WidgetType::Other, true, text)
        });
    }

    fn paint(self, ui: &Ui, center: Pos2) {
        let visuals = ui.visuals();
        let line = visuals.widgets.noninteractive.bg_stroke.color;
        let (faint, strong) = (visuals.weak_text_color(), visuals.strong_text_color());
        let painter = ui.painter();
        painter.circle(center, HORIZON, visuals.extreme_bg_color, Stroke::new(1.5, faint));
        for elevation in [30.0, 60.0] {
            painter.circle_stroke(center, radius(elevation), Stroke::new(1.0, line));
        }
        painter.line_segment([place(0.0, 0.0, center), place(180.0, 0.0, center)], Stroke::new(1.0, line));
        painter.line_segment([place(90.0, 0.0, center), place(270.0, 0.0, center)], Stroke::new(1.0, line));
        for (name, azimuth) in [("N", 0.0), ("E", 90.0), ("S", 180.0), ("W", 270.0)] {
            let at = place(azimuth, -14.0, center);
            painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(11.0), faint);
        }
        self.paint_camera(ui, center);
        let sun = place(self.azimuth_deg, self.elevation_deg, center);
        let color = match self.elevation_deg {
            e if e < 0.0 => Color32::from_rgb(150, 110, 90),
            e if e < 12.0 => Color32::from_rgb(255, 160, 70),
            _ => Color32::from_rgb(255, 214, 102),
        };
        painter.line_segment([center, sun], Stroke::new(1.0, color.gamma_multiply(0.4)));
        painter.circle(sun, 7.0, color, Stroke::new(1.5, strong));
    }

    /// A wedge from the middle: what the camera looks at.
    fn paint_camera(self, ui: &Ui, center: Pos2) {
        let color = ui.visuals().hyperlink_color;
        for turn in [-18.0, 18.0] {
            let end = place(self.heading_deg + turn, 0.0, center);
            ui.painter().line_segment([center, end], Stroke::new(1.0, color.gamma_multiply(0.55)));
        }
    }
}

/// Distance of an elevation from the zenith, points.
fn radius(elevation_deg: f64) -> f32 {
    HORIZON * ((90.0 - elevation_deg) / 90.0) as f32
}

fn place(azimuth_deg: f64, elevation_deg: f64, center: Pos2) -> Pos2 {
    let (sin, cos) = (azimuth_deg.to_radians() as f32).sin_cos();
    let radius = radius(elevation_deg.max(LOWEST));
    pos2(center.x + radius * sin, center.y - radius * cos)
}

/// The direction that `at` shows: degrees, rounded to tenths.
fn angles_at(at: Pos2, center: Pos2) -> (f64, f64) {
    let from = at - center;
    let azimuth = f64::from(from.x).atan2(f64::from(-from.y)).to_degrees().rem_euclid(360.0);
    let elevation = 90.0 - 90.0 * f64::from(from.length() / HORIZON);
    let tenths = |x: f64| (x * 10.0).round() / 10.0;
    (tenths(azimuth), tenths(elevation.clamp(LOWEST, 90.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dragged_is_where_it_is_shown() {
        let center = pos2(100.0, 80.0);
        for (azimuth, elevation) in [(0.0, 10.0), (90.0, 45.0), (200.5, -10.0), (359.0, 80.0)] {
            let (a, e) = angles_at(place(azimuth, elevation, center), center);
            // Half of the tenth that angles are rounded to, and f32 of points.
            assert!((a - azimuth).abs() < 0.06 && (e - elevation).abs() < 0.06, "{a} {e}");
        }
    }
}
