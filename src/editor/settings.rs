//! What the editor remembers from one day to the next, and where.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::{Error, Result, files::write_whole};

/// How many files "Open recent" lists.
const MOST_RECENT: usize = 10;

/// Folders of the editor's own files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Places {
    /// Where the settings are.
    pub settings: PathBuf,
    /// Where work is kept that was not saved yet.
    pub recovery: PathBuf,
}

impl Places {
    /// Those of this system, for this user.
    ///
    /// # Errors
    /// [`Error::Argument`] where the user has no home.
    pub fn of_the_system() -> Result<Self> {
        let places = directories::ProjectDirs::from("", "", "nephos").ok_or_else(|| {
            Error::Argument("there is no home folder to keep settings in: set HOME to one".to_owned())
        })?;
        let state = places.state_dir().unwrap_or_else(|| places.data_local_dir());
        Ok(Self { settings: places.config_dir().to_owned(), recovery: state.join("recovery") })
    }

    /// Where scenes are kept for jobs.
    pub fn jobs(&self) -> PathBuf {
        self.recovery.with_file_name("jobs")
    }

    /// Both in `folder`: for tests.
    pub fn within(folder: &Path) -> Self {
        Self { settings: folder.join("settings"), recovery: folder.join("recovery") }
    }
}

/// Dark or light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Look {
    /// Light text on dark ground: clouds are judged best in it.
    #[default]
    Dark,
    /// Dark text on light ground.
    Light,
    /// As the system has it.
    System,
}

/// Size and place of the window, in points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// Width and height of what is inside the frame.
    pub size: [f32; 2],
    /// Upper left corner on the desktop, where the system tells it.
    pub position: Option<[f32; 2]>,
    /// Whether it fills the desktop.
    pub maximized: bool,
}

/// What the editor remembers. A field that a file lacks, or has wrong, has its default.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Dark or light.
    pub look: Look,
    /// Size of everything, 1 as the system has it.
    pub zoom: Option<f32>,
    /// Files opened and saved last, the latest first.
    pub recent: Vec<PathBuf>,
    /// The window as it was left.
    pub window: Option<WindowPlace>,
    /// Whether files are chosen in a window of the editor's own.
    pub own_file_window: bool,
    /// The panels that are closed.
    pub closed_panels: Vec<String>,
    /// The viewport's settings, as it wrote them.
    pub viewport: serde_json::Value,
}

impl Settings {
    /// Reads them from `places`. Where there are none, or none that can be read, they are the
    /// defaults: an editor that does not start for its settings helps nobody.
    pub fn load(places: &Places) -> Self {
        let text = fs::read_to_string(file(places)).unwrap_or_default();
        let Ok(serde_json::Value::Object(fields)) = serde_json::from_str(&text) else {
            return Self::default();
        };
        // One field at a time, so that a bad one spoils no other.
        let mut settings = serde_json::to_value(Self::default()).unwrap_or_default();
        for (name, value) in fields {
            let mut tried = settings.clone();
            tried[&name] = value;
            if serde_json::from_value::<Self>(tried.clone()).is_ok() {
                settings = tried;
            }
        }
        serde_json::from_value(settings).unwrap_or_default()
    }

    /// Writes them to `places`.
    ///
    /// # Errors
    /// [`Error::File`] where they cannot be written.
    pub fn save(&self, places: &Places) -> Result<()> {
        fs::create_dir_all(&places.settings).map_err(|source| Error::File {
            action: "create",
            path: places.settings.clone(),
            source,
        })?;
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| Error::Argument(format!("the settings could not be written: {error}")))?;
        write_whole(&file(places), |file| file.write_all(text.as_bytes()))
    }

    /// Whether a panel is open.
    pub fn shows(&self, panel: &str) -> bool {
        !self.closed_panels.iter().any(|closed| closed == panel)
    }

    /// Opens a panel, or closes it.
    pub fn toggle(&mut self, panel: &str) {
        if self.shows(panel) {
            self.closed_panels.push(panel.to_owned());
        } else {
            self.closed_panels.retain(|closed| closed != panel);
        }
    }

    /// Puts `path` first among the recent files.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

fn file(places: &Places) -> PathBuf {
    places.settings.join("editor.json")
}
