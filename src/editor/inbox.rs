//! Input in the order in which it came, one thing at a time. egui asks of a frame what happened in it:
//! a click, a key. Frames that take long hold several, of which it would tell the last place of the
//! mouse and one click; and a number typed right after a click would come before its field has the
//! focus. So each pass gets the events up to one press, click or key, and the next of them waits.

use std::collections::{HashSet, VecDeque};

use eframe::egui::{Context, Event, Key, PlatformOutput, Plugin, RawInput, Ui};

/// Passes over the panels that one painted frame may take: more input than that is seen in between.
pub const PASSES: usize = 8;

/// Most passes without input while input waits.
const LONGEST: u32 = 3;

/// Events that wait for their pass.
#[derive(Debug, Default)]
pub struct Inbox {
    waiting: VecDeque<Event>,
    down: HashSet<Key>,
    /// The last pass had something that panels answer in the next one: a menu opens, a field gets the focus.
    settling: bool,
    /// Passes since the last input.
    settled: u32,
}

impl Plugin for Inbox {
    fn debug_name(&self) -> &'static str {
        "nephos inbox"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let typing = ctx.text_edit_focused();
        for event in input.events.drain(..) {
            self.take_in(event, typing);
        }
        input.events = self.next(typing);
    }

    fn on_end_pass(&mut self, ui: &mut Ui) {
        // Something was placed for the first time, and is where it belongs in the next pass.
        if ui.output(PlatformOutput::requested_discard) && self.settled < LONGEST {
            self.settling = true;
        }
        if !self.waiting.is_empty() {
            ui.ctx().request_discard("more input waits");
            ui.ctx().request_repaint();
        }
    }
}

impl Inbox {
    /// Puts `event` behind the others. A held key that repeats while its last repeat still waits is one:
    /// it would go on after it was let go.
    fn take_in(&mut self, event: Event, typing: bool) {
        if let Event::Key { key, pressed, .. } = event {
            let repeats = pressed && !self.down.insert(key);
            if !pressed {
                self.down.remove(&key);
            }
            let waits =
                |other: &Event| matches!(other, Event::Key { key: k, pressed: true, .. } if *k == key);
            if repeats && !typing && self.waiting.iter().any(waits) {
                return;
            }
        }
        self.waiting.push_back(event);
    }

    /// The events of the next pass.
    fn next(&mut self, typing: bool) -> Vec<Event> {
        if std::mem::take(&mut self.settling) {
            self.settled += 1;
            return Vec::new();
        }
        self.settled = 0;
        let mut events = Vec::new();
        while let Some(event) = self.waiting.front() {
            if moves_on(&events, event) {
                break;
            }
            let Some(event) = self.waiting.pop_front() else { break };
            let end = End::of(&event, typing);
            events.push(event);
            if end != End::No {
                while let Some(Event::Text(_)) = self.waiting.front() {
                    events.extend(self.waiting.pop_front());
                }
                self.settling = end == End::Settle;
                break;
            }
        }
        events
    }
}

/// Whether the mouse leaves the place where the wheel was turned.
fn moves_on(events: &[Event], next: &Event) -> bool {
    matches!(next, Event::PointerMoved(_) | Event::PointerGone)
        && events.iter().any(|event| matches!(event, Event::MouseWheel { .. } | Event::Zoom(_)))
}

/// Whether a pass ends with an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    No,
    Yes,
    /// And what it brings about has a pass to come up.
    Settle,
}

impl End {
    fn of(event: &Event, typing: bool) -> Self {
        match event {
            Event::PointerButton { pressed: true, .. } => Self::Yes,
            Event::Key { pressed: true, key, modifiers, .. }
                if typing && is_text(*key) && !modifiers.command =>
            {
                Self::No
            }
            Event::PointerButton { .. }
            | Event::Key { pressed: true, .. }
            | Event::Paste(_)
            | Event::Cut
            | Event::Touch { .. }
            | Event::AccessKitActionRequest(_) => Self::Settle,
            _ => Self::No,
        }
    }
}

/// Whether a field that has the focus keeps it at this key.
fn is_text(key: Key) -> bool {
    let function = key.name().len() > 1 && key.name().starts_with('F');
    !function && !matches!(key, Key::Tab | Key::Enter | Key::Escape)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Modifiers, PointerButton, pos2};

    fn key(key: Key, pressed: bool) -> Event {
        Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
    }

    fn button(pressed: bool) -> Event {
        let (pos, button, modifiers) = (pos2(3.0, 4.0), PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    }

    fn passes(events: impl IntoIterator<Item = Event>, typing: bool) -> Vec<Vec<Event>> {
        let mut inbox = Inbox::default();
        events.into_iter().for_each(|event| inbox.take_in(event, typing));
        let mut passes = Vec::new();
        while !inbox.waiting.is_empty() {
            passes.push(inbox.next(typing));
        }
        passes
    }

    #[test]
    fn a_click_is_where_it_was_whatever_the_mouse_does_after_it() {
        let [here, there] = [Event::PointerMoved(pos2(3.0, 4.0)), Event::PointerMoved(pos2(90.0, 9.0))];
        let got = passes([here.clone(), button(true), button(false), there.clone()], false);
        assert_eq!(got, [vec![here, button(true)], vec![button(false)], vec![], vec![there]]);
    }

    #[test]
    fn each_key_has_a_pass_of_its_own_with_its_text_and_text_in_a_field_goes_together() {
        let one = |name: &str, k: Key| [key(k, true), Event::Text(name.to_owned()), key(k, false)];
        let events =
            || one("1", Key::Num1).into_iter().chain(one("2", Key::Num2)).chain([key(Key::Tab, true)]);
        let sizes = |typing| passes(events(), typing).iter().map(Vec::len).collect::<Vec<_>>();
        // A release belongs to the next key's pass; after each key a pass to answer.
        assert_eq!(sizes(false), [2, 0, 3, 0, 2]);
        assert_eq!(sizes(true), [7]);
    }

    #[test]
    fn a_held_key_does_not_pile_up_and_one_pressed_again_counts_again() {
        let held = vec![key(Key::ArrowUp, true); 9];
        assert_eq!(passes(held.clone(), false).concat().len(), 1);
        assert_eq!(passes(held, true).concat().len(), 9);
        let again = [true, false, true, false].map(|pressed| key(Key::A, pressed));
        assert_eq!(passes(again.clone(), false).concat(), again);
    }
}
