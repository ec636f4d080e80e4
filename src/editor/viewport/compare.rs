//! Truth and preview side by side: the line between them, their names, the numbers.

use eframe::egui::{Align2, Color32, CursorIcon, Id, Painter, Rect, Sense, Ui, pos2, vec2};

use super::{Viewport, error_map, hud, ink};

/// All of a texture.
pub const WHOLE: Rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
/// Half the width of the line's reach, points.
const REACH: f32 = 7.0;

impl Viewport {
    /// Shows the truth, or the map of differences, to the right of the line.
    pub(super) fn draw_truth(&self, painter: &Painter) {
        let truth = &self.easel.seen().truth;
        let image = if self.settings.error_map { truth.map } else { truth.image };
        if let Some(image) = image.filter(|_| self.truth) {
            let split = self.settings.split.clamp(0.0, 1.0);
            let area = Rect::from_min_max(pos2(self.line(), self.rect.top()), self.rect.max);
            let part = Rect::from_min_max(pos2(split, 0.0), pos2(1.0, 1.0));
            painter.image(image, area, part, Color32::WHITE);
        }
    }

    /// The line between both, to be dragged.
    pub(super) fn divide(&mut self, ui: &Ui) {
        if !self.truth {
            return;
        }
        let x = self.line();
        let area = Rect::from_x_y_ranges(x - REACH..=x + REACH, self.rect.y_range());
        let response = ui.interact(area, Id::new("nephos split"), Sense::drag());
        if response.dragged() {
            self.settings.split += response.drag_delta().x / self.rect.width().max(1.0);
            self.settings.split = self.settings.split.clamp(0.02, 0.98);
        }
        let strong = response.hovered() || response.dragged();
        if strong {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        let painter = ui.painter_at(self.rect);
        let color = if strong { ink::HOVER } else { ink::WORDS };
        let x = self.line();
        ink::line(&painter, &[pos2(x, self.rect.top()), pos2(x, self.rect.bottom())], 1.5, color);
        let knob = pos2(x, self.rect.center().y);
        ink::disc(&painter, knob, 10.0, color);
        for side in [-1.0, 1.0] {
            let tip = knob + vec2(6.5 * side, 0.0);
            let base = knob + vec2(2.0 * side, 0.0);
            let points = vec![tip, base + vec2(0.0, 4.0), base - vec2(0.0, 4.0)];
            ink::area(&painter, points, Color32::from_gray(40));
        }
    }

    /// Shows the truth beside the preview, or puts it away.
    pub(super) fn toggle_truth(&mut self) {
        self.truth ^= true;
    }

    /// Shows the map of differences, and the truth with it where it was not shown.
    pub(super) fn toggle_error_map(&mut self) {
        if !self.truth {
            self.toggle_truth();
            self.settings.error_map = true;
        } else {
            self.settings.error_map ^= true;
        }
    }

    /// Names of both sides, and how far they are from each other.
    pub(super) fn tell_truth(&self, painter: &Painter) {
        if !self.truth {
            return;
        }
        let truth = &self.easel.seen().truth;
        let x = self.line();
        let below_bar = self.rect.top() + 54.0;
        ink::plate(painter, pos2(x - 10.0, below_bar), Align2::RIGHT_TOP, 12.0, "Preview");
        let right = match (&truth.error, &truth.numbers) {
            (Some(error), _) => error.clone(),
            (None, None) if self.easel.at_rest() => "Truth: tracing the first paths".to_owned(),
            (None, None) => "Truth begins when the preview is final".to_owned(),
            (None, Some((samples, _))) if self.settings.error_map => {
                format!("Difference   {samples} samples")
            }
            (None, Some((samples, _))) => format!("Truth   {samples} samples"),
        };
        ink::plate(painter, pos2(x + 10.0, below_bar), Align2::LEFT_TOP, 12.0, &right);
        let Some((_, numbers)) = &truth.numbers else { return };
        let percent = |x: f64| format!("{:.1} %", 100.0 * x);
        let text = format!(
            "Relative RMSE  {}\nwithout noise  {}\nBias  {:+.1} %\nNoise of the truth  {}",
            percent(numbers.relative_rmse),
            percent(numbers.without_noise()),
            100.0 * numbers.bias,
            percent(numbers.noise),
        );
        let corner = self.rect.right_bottom() - vec2(10.0, 30.0);
        let plate = ink::plate(painter, corner, Align2::RIGHT_BOTTOM, 12.0, &text);
        if self.settings.error_map {
            let at = plate.left_bottom() - vec2(194.0, 32.0);
            let tick = |x: f32| (0.5 + 0.5 * x, format!("{:+.0} %", 100.0 * error_map::RANGE * x));
            let mut ticks = [-1.0, -0.5, 0.5, 1.0].map(tick).to_vec();
            ticks.push((0.5, "0".to_owned()));
            hud::scale(painter, at, "Preview darker / brighter", |x| error_map::color(2.0 * x - 1.0), &ticks);
        }
    }

    /// Where the line is on the screen.
    fn line(&self) -> f32 {
        self.rect.left() + self.settings.split.clamp(0.0, 1.0) * self.rect.width()
    }
}
