//! Everything that the viewport does at a key or from a menu, in one table: names, help and
//! shortcuts are written here and nowhere else.

use eframe::egui::{Event, InputState, Key, KeyboardShortcut, Modifiers};

use super::{
    navigation::Side,
    settings::{Layer, Tool},
};

/// One thing that the viewport does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ViewCommand {
    /// Moves what is selected with the mouse.
    Move,
    /// Turns what is selected with the mouse.
    Rotate,
    /// Scales what is selected with the mouse.
    Scale,
    /// Shows another gizmo, or none.
    UseTool(Tool),
    /// World's axes or the active ellipsoid's.
    ToggleLocal,
    /// Middle of all, active one, or each its own.
    NextPivot,
    /// Whether drags snap.
    ToggleSnap,
    /// The next left drag selects by a box.
    SelectBox,
    /// Comes to what is selected.
    FrameSelected,
    /// Comes to all clouds.
    FrameAll,
    /// Looks along an axis.
    LookFrom(Side),
    /// With perspective or without.
    ToggleOrthographic,
    /// Looks as the scene's camera does.
    LookThroughSceneCamera,
    /// Keeps this view under a number, 1 to 9.
    SaveView(usize),
    /// Goes to a view that was kept.
    RecallView(usize),
    /// Outlines of ellipsoids that are not selected.
    ToggleOutlines,
    /// Grid and horizon.
    ToggleGrid,
    /// Shows a layer of the light.
    Show(Layer),
    /// Truth beside preview.
    ToggleTruth,
    /// Truth or its difference from the preview.
    ToggleErrorMap,
    /// Counts and times.
    ToggleMeasure,
}

/// What menus, palette and the list of shortcuts show of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// The command.
    pub command: ViewCommand,
    /// Group in menus.
    pub group: &'static str,
    /// Name.
    pub name: &'static str,
    /// What it does, one sentence.
    pub help: &'static str,
    /// Keys.
    pub shortcut: Option<KeyboardShortcut>,
}

const fn key(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::NONE, key))
}

const fn with(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
}

const fn entry(
    group: &'static str,
    command: ViewCommand,
    name: &'static str,
    shortcut: Option<KeyboardShortcut>,
    help: &'static str,
) -> Entry {
    Entry { command, group, name, help, shortcut }
}

const TRANSFORM: &str = "Transform";
const SELECT: &str = "Select";
const VIEW: &str = "View";
const SHOW: &str = "Show";

/// Every command of the viewport.
pub const COMMANDS: &[Entry] = {
    use ViewCommand::*;
    &[
        entry(
            TRANSFORM,
            Move,
            "Move",
            key(Key::G),
            "Moves the selected ellipsoids with the mouse; then X, Y or Z for an axis, or a number in metres.",
        ),
        entry(
            TRANSFORM,
            Rotate,
            "Rotate",
            key(Key::R),
            "Turns the selected ellipsoids with the mouse; then X, Y or Z for an axis, or a number in degrees.",
        ),
        entry(
            TRANSFORM,
            Scale,
            "Scale",
            key(Key::S),
            "Scales the selected ellipsoids with the mouse; then X, Y or Z for an axis, or a factor.",
        ),
        entry(
            TRANSFORM,
            UseTool(Tool::Select),
            "Select tool",
            key(Key::Q),
            "Hides the gizmo: clicks and boxes only select.",
        ),
        entry(
            TRANSFORM,
            UseTool(Tool::Move),
            "Move tool",
            key(Key::W),
            "Shows arrows and planes to move by.",
        ),
        entry(TRANSFORM, UseTool(Tool::Rotate), "Rotate tool", key(Key::E), "Shows rings to turn by."),
        entry(TRANSFORM, UseTool(Tool::Scale), "Scale tool", key(Key::T), "Shows arms to scale by."),
        entry(
            TRANSFORM,
            ToggleLocal,
            "Local axes",
            key(Key::Comma),
            "Switches between the world's axes and those of the active ellipsoid.",
        ),
        entry(
            TRANSFORM,
            NextPivot,
            "Next pivot",
            None,
            "Turns and scales about the middle of the selected, about the active one, or each about itself.",
        ),
        entry(
            TRANSFORM,
            ToggleSnap,
            "Snap",
            with(Modifiers::SHIFT, Key::Tab),
            "Snaps drags to round numbers; Ctrl during a drag does the opposite.",
        ),
        entry(
            SELECT,
            SelectBox,
            "Box select",
            key(Key::B),
            "The next drag with the left button selects all centres in a box.",
        ),
        entry(
            VIEW,
            FrameSelected,
            "Frame selected",
            key(Key::F),
            "Brings what is selected into the middle of the view, near.",
        ),
        entry(VIEW, FrameAll, "Frame all", key(Key::Home), "Brings all clouds into the view."),
        entry(VIEW, LookFrom(Side::Front), "From the front", key(Key::Num1), "Looks from south to north."),
        entry(
            VIEW,
            LookFrom(Side::Back),
            "From the back",
            with(Modifiers::COMMAND, Key::Num1),
            "Looks from north to south.",
        ),
        entry(VIEW, LookFrom(Side::Right), "From the right", key(Key::Num3), "Looks from east to west."),
        entry(
            VIEW,
            LookFrom(Side::Left),
            "From the left",
            with(Modifiers::COMMAND, Key::Num3),
            "Looks from west to east.",
        ),
        entry(VIEW, LookFrom(Side::Top), "From the top", key(Key::Num7), "Looks down, north being up."),
        entry(
            VIEW,
            LookFrom(Side::Bottom),
            "From below",
            with(Modifiers::COMMAND, Key::Num7),
            "Looks up from below.",
        ),
        entry(VIEW, ToggleOrthographic, "Orthographic", key(Key::Num5), "Switches perspective off and on."),
        entry(
            VIEW,
            LookThroughSceneCamera,
            "Through the scene's camera",
            key(Key::Num0),
            "Looks from where the final picture is taken.",
        ),
        entry(
            VIEW,
            SaveView(1),
            "Save view 1",
            with(Modifiers::ALT, Key::F1),
            "Keeps this view to come back to.",
        ),
        entry(
            VIEW,
            SaveView(2),
            "Save view 2",
            with(Modifiers::ALT, Key::F2),
            "Keeps this view to come back to.",
        ),
        entry(
            VIEW,
            SaveView(3),
            "Save view 3",
            with(Modifiers::ALT, Key::F3),
            "Keeps this view to come back to.",
        ),
        entry(
            VIEW,
            RecallView(1),
            "Saved view 1",
            with(Modifiers::SHIFT, Key::F1),
            "Goes to the view that was saved as number 1.",
        ),
        entry(
            VIEW,
            RecallView(2),
            "Saved view 2",
            with(Modifiers::SHIFT, Key::F2),
            "Goes to the view that was saved as number 2.",
        ),
        entry(
            VIEW,
            RecallView(3),
            "Saved view 3",
            with(Modifiers::SHIFT, Key::F3),
            "Goes to the view that was saved as number 3.",
        ),
        entry(
            SHOW,
            ToggleOutlines,
            "Outlines",
            key(Key::O),
            "Shows the outlines of ellipsoids near the mouse, not of the selected ones alone.",
        ),
        entry(
            SHOW,
            ToggleGrid,
            "Grid and horizon",
            None,
            "Shows the ground's grid, the horizon and the sun's direction.",
        ),
        entry(SHOW, Show(Layer::Beauty), "Show beauty", None, "Shows the picture with all its light."),
        entry(
            SHOW,
            Show(Layer::Single),
            "Show single scattering",
            None,
            "Shows sunlight that droplets turned once.",
        ),
        entry(
            SHOW,
            Show(Layer::Multiple),
            "Show multiple scattering",
            None,
            "Shows sunlight that droplets turned more often.",
        ),
        entry(
            SHOW,
            Show(Layer::Ambient),
            "Show light of the sky",
            None,
            "Shows the light of sky and ground that droplets turned.",
        ),
        entry(SHOW, Show(Layer::Air), "Show air", None, "Shows light that the air before the clouds adds."),
        entry(
            SHOW,
            Show(Layer::Transmittance),
            "Show transmittance",
            None,
            "Shows how much of the background gets through.",
        ),
        entry(SHOW, Show(Layer::Normal), "Show normals", None, "Shows which way the clouds face."),
        entry(SHOW, Show(Layer::Cost), "Show cost", None, "Shows the steps of each ray as a heat map."),
        entry(
            SHOW,
            ToggleTruth,
            "Truth beside preview",
            key(Key::P),
            "Path traces the view beside the preview; drag the line between them.",
        ),
        entry(
            SHOW,
            ToggleErrorMap,
            "Error map",
            with(Modifiers::SHIFT, Key::P),
            "Shows where and how much the preview differs from the truth.",
        ),
        entry(
            SHOW,
            ToggleMeasure,
            "Count and time",
            None,
            "Counts the work of final pictures and times their passes.",
        ),
    ]
};

/// Whether a shortcut was pressed, with just its modifiers; takes it out of the events. The
/// modifiers are those of the moment of the key: a slow frame may end without them.
pub fn take(input: &mut InputState, shortcut: &KeyboardShortcut) -> bool {
    let is_it = |event: &Event| match event {
        Event::Key { key, pressed: true, modifiers, .. } => {
            *key == shortcut.logical_key && modifiers.matches_exact(shortcut.modifiers)
        }
        _ => false,
    };
    let before = input.events.len();
    input.events.retain(|event| !is_it(event));
    input.events.len() < before
}

/// What the list says of a command.
pub fn find(command: ViewCommand) -> Option<&'static Entry> {
    COMMANDS.iter().find(|entry| entry.command == command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_shortcut_and_no_name_is_given_twice() {
        for (i, a) in COMMANDS.iter().enumerate() {
            for b in &COMMANDS[i + 1..] {
                assert_ne!(a.name, b.name);
                assert!(a.shortcut.is_none() || a.shortcut != b.shortcut, "{} and {}", a.name, b.name);
            }
        }
    }

    #[test]
    fn help_is_a_sentence() {
        assert!(COMMANDS.iter().all(|entry| entry.help.ends_with('.') && entry.help.len() > 15));
    }
}
