//! Everything that menus, palette and keys can do, in one table: names, help and shortcuts are
//! written here, and for the viewport in its own table, and nowhere else.

use std::{borrow::Cow, sync::LazyLock};

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

use super::{
    settings::Look,
    viewport::{COMMANDS, ViewCommand},
};
use crate::scene::Preset;

/// One thing that the editor does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// An empty sky.
    New,
    /// The sky of a preset.
    NewFrom(Preset),
    /// Another file.
    Open,
    /// Writes the file.
    Save,
    /// Writes another file.
    SaveAs,
    /// Reads the file again.
    Revert,
    /// Asks for a picture, a sequence or an export: a number of [`super::jobs::KINDS`].
    Job(usize),
    /// Shows or closes the queue of jobs.
    ToggleJobs,
    /// Ends the program.
    Quit,
    /// Takes the last step back.
    Undo,
    /// Does it again.
    Redo,
    /// Copies what is selected and moves the copy.
    Duplicate,
    /// Deletes what is selected.
    Delete,
    /// Names what is active.
    Rename,
    /// Puts what is selected into a new cloud.
    Group,
    /// Moves what is selected into the cloud of the active one.
    Join,
    /// Grows heaps on what is selected.
    Grow,
    /// Hides what is selected.
    Hide,
    /// Shows all again.
    ShowAll,
    /// Locks what is selected, or unlocks it.
    Lock,
    /// Selects all that can be seen and is not locked.
    SelectAll,
    /// Selects nothing.
    SelectNone,
    /// Selects what is not selected.
    SelectOthers,
    /// Adds an ellipsoid.
    AddEllipsoid,
    /// Adds an empty cloud.
    AddCloud,
    /// Adds the clouds of a preset.
    AddPreset(Preset),
    /// Puts the scene's camera where the view is.
    CameraFromView,
    /// Shows or closes the timeline; makes one where the scene has none.
    ToggleTimeline,
    /// Plays the timeline, or stops.
    Play,
    /// Sets keys of what is selected.
    KeySelected,
    /// Takes the timeline away.
    RemoveTimeline,
    /// Shows or closes the outliner.
    ToggleOutliner,
    /// Shows or closes the inspector.
    ToggleInspector,
    /// Shows the inspector of what is selected.
    ObjectPanel,
    /// Shows the inspector of everything else.
    WorldPanel,
    /// Shows the controls of the view.
    ViewPanel,
    /// Dark or light.
    Look(Look),
    /// Everything larger.
    Larger,
    /// Everything smaller.
    Smaller,
    /// Everything as the system has it.
    ActualSize,
    /// Finds a command by its name.
    Palette,
    /// Lists the keys.
    Shortcuts,
    /// Tells the version.
    About,
    /// A command of the viewport.
    View(ViewCommand),
}

/// What menus, palette and the list of shortcuts show of an action.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The action.
    pub action: Action,
    /// The menu that it is in.
    pub menu: &'static str,
    /// Name.
    pub name: Cow<'static, str>,
    /// What it does, one sentence.
    pub help: Cow<'static, str>,
    /// Keys, the first of them shown.
    pub shortcuts: Vec<KeyboardShortcut>,
}

/// Every action, in the order of the menus.
pub fn entries() -> &'static [Entry] {
    static ENTRIES: LazyLock<Vec<Entry>> = LazyLock::new(all);
    &ENTRIES
}

/// What the table says of `action`.
pub fn entry(action: Action) -> Option<&'static Entry> {
    entries().iter().find(|entry| entry.action == action)
}

const PLAIN: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const ALT: Modifiers = Modifiers::ALT;
const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

fn own(
    menu: &'static str,
    action: Action,
    name: &'static str,
    keys: &[(Modifiers, Key)],
    help: &'static str,
) -> Entry {
    let shortcuts = keys.iter().map(|(modifiers, key)| KeyboardShortcut::new(*modifiers, *key)).collect();
    Entry { action, menu, name: name.into(), help: help.into(), shortcuts }
}

fn all() -> Vec<Entry> {
    let mut all = file();
    all.extend(Preset::ALL.map(|preset| of_preset("New", Action::NewFrom(preset), preset)));
    all.extend(edit());
    all.extend(Preset::ALL.map(|preset| of_preset("Add", Action::AddPreset(preset), preset)));
    all.extend(COMMANDS.iter().map(|entry| Entry {
        action: Action::View(entry.command),
        menu: entry.group,
        name: entry.name.into(),
        help: entry.help.into(),
        shortcuts: entry.shortcut.into_iter().collect(),
    }));
    all.extend(window());
    all
}

fn of_preset(menu: &'static str, action: Action, preset: Preset) -> Entry {
    let what = about(preset);
    let help = match menu {
        "New" => format!("Begins a new scene. {what}"),
        _ => format!("Adds to the scene. {what}"),
    };
    Entry { action, menu, name: format!("{menu}: {preset}").into(), help: help.into(), shortcuts: Vec::new() }
}

/// What a preset is, one sentence.
pub fn about(preset: Preset) -> &'static str {
    match preset {
        Preset::Humilis => "Fair-weather cumulus, wider than tall.",
        Preset::Mediocris => "Cumulus about as tall as wide.",
        Preset::Congestus => "Towering cumulus with sharp cauliflower turrets.",
        Preset::Fractus => "Small torn shreds.",
        Preset::ClosedCells => "Patches of stratocumulus in closed cells, with narrow gaps.",
        Preset::OpenCells => "Stratocumulus in open cells: rings around clear air.",
        Preset::Cumulonimbus => "A thunderstorm with its anvil.",
        Preset::Tower => "A towering cumulus that leans with the wind.",
        Preset::Field => "A sky of cumuli in streets along the wind.",
        Preset::Glory => "A thin sheet from above, with glory and fogbow.",
        Preset::Sphere => "One homogeneous sphere.",
        Preset::Drift => "Fair-weather cumuli that form, drift and dissolve: a loop of ten seconds.",
        Preset::Kol => "Eight ellipsoids with a wispy boundary, after Kol (2013).",
        Preset::Stratus => "A low grey layer from horizon to horizon.",
        Preset::Stratocumulus => "A layer of heaps with gaps, to the horizon.",
        Preset::Altocumulus => "A layer of small heaps, to the horizon.",
        Preset::Mackerel => "Ripples of thin cloud in rows, to the horizon.",
        Preset::Cirrostratus => "A veil of ice high up, to the horizon.",
        Preset::Shower => "A shower under a towering cumulus, with a rainbow.",
        Preset::Cirrus => "Streaks of ice along the shear of the wind, to the horizon.",
    }
}

#[rustfmt::skip]
fn file() -> Vec<Entry> {
    use Action::*;
    vec![
        own("File", New, "New", &[(CTRL, Key::N)], "Begins an empty sky."),
        own("File", Open, "Open...", &[(CTRL, Key::O)], "Opens a scene file."),
        own("File", Save, "Save", &[(CTRL, Key::S)], "Writes the scene to its file, whole or not at all."),
        own("File", SaveAs, "Save as...", &[(CTRL_SHIFT, Key::S)], "Writes the scene to another file and goes on with that."),
        own("File", Revert, "Revert to saved", &[], "Reads the file again; what was not saved is lost."),
        own("File", Job(0), "Render picture...", &[(PLAIN, Key::F12)], "Draws the final picture into a PNG or EXR file."),
        own("File", Job(1), "Render sequence...", &[(CTRL, Key::F12)], "Draws the scene over time into numbered pictures or a movie."),
        own("Export", Job(2), "Export volume...", &[], "Writes the density in voxels as OpenVDB or for Mitsuba."),
        own("Export", Job(3), "Export sky map...", &[], "Writes the whole sky around the camera."),
        own("Export", Job(4), "Export shadow map...", &[], "Writes how much sunlight the clouds let through to the ground."),
        own("Export", Job(5), "Export six-way sprite...", &[], "Writes how a cloud looks in light from six sides."),
        own("Export", Job(6), "Export flip-book...", &[], "Writes an atlas of frames of a cloud that changes."),
        own("Export", Job(7), "Export impostor...", &[], "Writes an atlas of pictures of a cloud from many sides."),
        own("Export", Job(8), "Export camera...", &[], "Writes the scene's camera as glTF for other programs."),
        own("Window", ToggleJobs, "Jobs", &[(PLAIN, Key::F10)], "Shows or closes the queue of pictures, sequences and exports."),
        own("File", Quit, "Quit", &[(CTRL, Key::Q)], "Ends the editor; asks first where something is not saved."),
    ]
}

#[rustfmt::skip]
fn edit() -> Vec<Entry> {
    use Action::*;
    vec![
        own("Edit", Undo, "Undo", &[(CTRL, Key::Z)], "Takes the last step back."),
        own("Edit", Redo, "Redo", &[(CTRL_SHIFT, Key::Z), (CTRL, Key::Y)], "Does again what was taken back."),
        own("Edit", Duplicate, "Duplicate", &[(SHIFT, Key::D)], "Copies what is selected; the copy then follows the mouse."),
        own("Edit", Delete, "Delete", &[(PLAIN, Key::Delete), (PLAIN, Key::X)], "Deletes what is selected and not locked."),
        own("Edit", Rename, "Rename", &[(PLAIN, Key::F2)], "Gives the active ellipsoid, or the selected cloud, another name."),
        own("Edit", Group, "Group into a cloud", &[(CTRL, Key::G)], "Puts the selected ellipsoids into a new cloud; they keep their edges."),
        own("Edit", Join, "Move into the active cloud", &[(CTRL, Key::J)], "Moves the selected ellipsoids into the cloud of the active one; they keep their edges."),
        own("Edit", Grow, "Grow heaps", &[(CTRL, Key::H)], "Heaps smaller ellipsoids on the upper side of each selected one."),
        own("Edit", Hide, "Hide", &[(PLAIN, Key::H)], "Leaves what is selected out of all pictures."),
        own("Edit", ShowAll, "Show all", &[(ALT, Key::H)], "Shows everything that was hidden."),
        own("Edit", Lock, "Lock or unlock", &[(PLAIN, Key::L)], "Keeps what is selected from being changed in the view, or lets it."),
        own("Edit", Play, "Play or stop", &[(PLAIN, Key::Space)], "Plays the timeline at its own pace; frames that come too late are left out."),
        own("Edit", KeySelected, "Key what is selected", &[(PLAIN, Key::I)], "Sets keys of place, size, rotation and density at the playhead."),
        own("Edit", RemoveTimeline, "Remove the timeline", &[], "Takes all keys away; the scene stays as it is at the playhead."),
        own("Select", SelectAll, "Select all", &[(PLAIN, Key::A), (CTRL, Key::A)], "Selects every ellipsoid that is seen and not locked."),
        own("Select", SelectNone, "Select nothing", &[(ALT, Key::A)], "Lets go of everything."),
        own("Select", SelectOthers, "Select the others", &[(CTRL, Key::I)], "Selects what is not selected, and lets go of what is."),
        own("Add", AddEllipsoid, "Add ellipsoid", &[(SHIFT, Key::A)], "Adds an ellipsoid like the active one beside it, in its cloud."),
        own("Add", AddCloud, "Add cloud", &[(CTRL_SHIFT, Key::A)], "Adds an empty cloud; the next ellipsoids go into it."),
    ]
}

#[rustfmt::skip]
fn window() -> Vec<Entry> {
    use Action::*;
    vec![
        own("View", CameraFromView, "Set the scene's camera", &[(CTRL, Key::Num0)], "Takes the final picture from where you look now."),
        own("Window", ToggleTimeline, "Timeline", &[(PLAIN, Key::F4)], "Shows or closes the panel below; begins a timeline where the scene has none."),
        own("Window", ToggleOutliner, "Outliner", &[(PLAIN, Key::F5)], "Shows or closes the list on the left."),
        own("Window", ToggleInspector, "Inspector", &[(PLAIN, Key::F6)], "Shows or closes the panel on the right."),
        own("Window", ObjectPanel, "Object", &[(PLAIN, Key::F7)], "Shows what is selected in the inspector."),
        own("Window", WorldPanel, "World", &[(PLAIN, Key::F8)], "Shows sun, sky, camera, noise and the rest in the inspector."),
        own("Window", ViewPanel, "View", &[(PLAIN, Key::F9)], "Shows layers, overlays, pace and statistics in the inspector."),
        own("Window", Look(self::Look::Dark), "Dark theme", &[], "Light text on dark ground: clouds are judged best in it."),
        own("Window", Look(self::Look::Light), "Light theme", &[], "Dark text on light ground."),
        own("Window", Look(self::Look::System), "Theme of the system", &[], "Dark or light, as the system has it."),
        own("Window", Larger, "Larger", &[(CTRL, Key::Plus), (CTRL, Key::Equals)], "Makes text and everything else larger."),
        own("Window", Smaller, "Smaller", &[(CTRL, Key::Minus)], "Makes text and everything else smaller."),
        own("Window", ActualSize, "Actual size", &[(CTRL_SHIFT, Key::Num0)], "Makes everything as large as the system has it."),
        own("Help", Palette, "Find a command...", &[(PLAIN, Key::F3), (CTRL, Key::P)], "Finds a command by a part of its name and runs it."),
        own("Help", Shortcuts, "Keyboard and mouse", &[(PLAIN, Key::F1)], "Lists all keys, and what the mouse does in the view."),
        own("Help", About, "About nephos", &[], "Tells the version and the graphics adapter."),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_shortcut_and_no_name_is_given_twice() {
        let all = entries();
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert_ne!(a.name, b.name);
                let shared = a.shortcuts.iter().find(|keys| b.shortcuts.contains(keys));
                assert!(shared.is_none(), "{} and {} share {shared:?}", a.name, b.name);
            }
        }
        assert!(all.len() > 60, "{}", all.len());
    }

    #[test]
    fn help_is_a_sentence() {
        assert!(entries().iter().all(|entry| entry.help.ends_with('.') && entry.help.len() > 15));
    }
}
