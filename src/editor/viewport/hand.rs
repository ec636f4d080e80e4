//! What the mouse does to the view: orbit, pan, dolly, fly.

use eframe::egui::{CursorIcon, Event, Key, PointerButton, Response, Ui};
use glam::{DVec2, DVec3};

use super::{lens::Lens, lens::dvec, navigation::Navigation};

/// Turn of a drag across one point of the screen, rad.
const TURN: f64 = 0.006;
/// Turn of the head while flying, rad.
const LOOK: f64 = 0.004;
/// Share of the distance that is left after one notch of the wheel, 50 points.
const NOTCH: f64 = 0.85;
/// Share of the distance to the pivot that is flown in a second.
const SPEED: f64 = 0.6;

/// What a drag is doing to the view.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Hand {
    /// Nothing.
    #[default]
    Free,
    /// Turning about a point.
    Orbit {
        /// The point, m.
        about: DVec3,
    },
    /// Sliding what was grabbed.
    Pan {
        /// Its depth, m.
        depth: f64,
    },
    /// Coming nearer and going away by moving up and down.
    Dolly {
        /// What keeps its place.
        anchor: DVec3,
    },
    /// Looking around and flying by keys.
    Fly,
}

/// Where a drag takes hold of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// What is under the cursor, m.
    pub under: DVec3,
    /// What orbits turn about, m.
    pub about: DVec3,
}

impl Hand {
    /// Begins, goes on with or ends what the buttons say. Tells whether the view moved.
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        view: &mut Navigation,
        speed: &mut f64,
        hold: impl FnOnce(DVec2) -> Hold,
    ) -> bool {
        let before = view.clone();
        let lens = view.lens(response.rect);
        self.begin_and_end(ui, response, &lens, hold);
        let (delta, at) = ui.input(|i| (i.pointer.delta(), i.pointer.latest_pos()));
        let delta = DVec2::new(f64::from(delta.x), f64::from(delta.y));
        let turn = DVec2::new(delta.x, -delta.y);
        match *self {
            Self::Free => {}
            Self::Orbit { about } => view.orbit(about, TURN * turn),
            Self::Pan { depth } => {
                if let Some(at) = at {
                    view.pan(&lens, dvec(at) - delta, dvec(at), depth);
                }
            }
            Self::Dolly { anchor } => view.dolly(anchor, (0.01 * delta.y).exp()),
            Self::Fly => {
                view.look_around(LOOK * turn);
                self.fly(ui, view, *speed);
            }
        }
        *view != before
    }

    /// Whether the wheel sets the speed rather than the distance.
    pub fn flies(&self) -> bool {
        *self == Self::Fly
    }

    /// How the cursor looks meanwhile.
    pub fn cursor(&self) -> CursorIcon {
        match self {
            Self::Free => CursorIcon::Default,
            Self::Orbit { .. } => CursorIcon::Move,
            Self::Pan { .. } => CursorIcon::Grabbing,
            Self::Dolly { .. } => CursorIcon::ResizeVertical,
            Self::Fly => CursorIcon::Crosshair,
        }
    }

    fn begin_and_end(&mut self, ui: &Ui, response: &Response, lens: &Lens, hold: impl FnOnce(DVec2) -> Hold) {
        let (down, modifiers, origin) = ui.input(|i| {
            let down = |button| i.pointer.button_down(button);
            let buttons = [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary].map(down);
            (buttons, i.modifiers, i.pointer.press_origin())
        });
        let [left, middle, right] = down;
        let turning = middle || (left && modifiers.alt);
        if *self != Self::Free {
            let held = match self {
                Self::Fly => right,
                _ => middle || left,
            };
            if !held {
                *self = Self::Free;
            }
            return;
        }
        if !response.is_pointer_button_down_on() {
            return;
        }
        let Some(at) = origin else { return };
        if right {
            *self = Self::Fly;
        } else if turning {
            let hold = hold(dvec(at));
            *self = if modifiers.shift {
                Self::Pan { depth: lens.depth(hold.under) }
            } else if modifiers.command {
                Self::Dolly { anchor: hold.about }
            } else {
                Self::Orbit { about: hold.about }
            };
        }
    }

    fn fly(&self, ui: &Ui, view: &mut Navigation, speed: f64) {
        // Letters fly; they are nobody's shortcuts now.
        ui.input_mut(|i| i.events.retain(|event| !matches!(event, Event::Key { .. } | Event::Text(_))));
        let (keys, fast, dt) = ui.input(|i| {
            let axis =
                |plus, minus| f64::from(u8::from(i.key_down(plus))) - f64::from(u8::from(i.key_down(minus)));
            let keys = DVec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
            (keys, i.modifiers.shift, f64::from(i.stable_dt.min(0.1)))
        });
        if keys != DVec3::ZERO {
            let rate = SPEED * speed * view.distance.max(1.0) * if fast { 4.0 } else { 1.0 };
            view.fly(rate * dt * keys);
            ui.ctx().request_repaint();
        }
    }
}

/// The wheel: nearer to what is under the cursor, or faster while flying. Tells whether
/// the view moved.
pub fn wheel(
    ui: &Ui,
    response: &Response,
    hand: &Hand,
    view: &mut Navigation,
    speed: &mut f64,
    hold: impl FnOnce(DVec2) -> Hold,
) -> bool {
    let (scroll, zoom, at) =
        ui.input(|i| (f64::from(i.smooth_scroll_delta.y), f64::from(i.zoom_delta()), i.pointer.hover_pos()));
    if !response.contains_pointer() || (scroll == 0.0 && zoom == 1.0) {
        return false;
    }
    if hand.flies() {
        *speed = (*speed * (0.01 * scroll).exp()).clamp(0.01, 100.0);
        return false;
    }
    let Some(at) = at else { return false };
    view.dolly(hold(dvec(at)).under, NOTCH.powf(scroll / 50.0) / zoom);
    true
}
