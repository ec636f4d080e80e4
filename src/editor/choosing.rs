//! Choosing a file: in the system's own window, or where it has none, in one of ours.

use std::{
    env, fs,
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, TryRecvError, channel},
    thread,
};

use eframe::egui::{Context, Key, RichText, ScrollArea, TextEdit, Ui};
use egui_phosphor::regular as icon;

use super::{labels::name_widget, palette::Answer, theme::modal};

/// What a file is chosen for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to read.
    Open,
    /// A scene to write.
    Save,
    /// A file for a job to write.
    Job,
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a scene",
            Self::Save => "Save the scene as",
            Self::Job => "File to write",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::Save => "Save",
            Self::Job => "Choose",
        }
    }

    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Open | Self::Save => &["json"],
            Self::Job => &["png", "exr", "mp4", "webm", "vdb", "vol", "hdr", "ktx2", "glb", "gltf"],
        }
    }

    /// `path` with an ending, where none was given.
    fn complete(self, path: PathBuf) -> PathBuf {
        match self {
            Self::Job => path,
            _ if path.extension().is_some() => path,
            Self::Open if path.exists() => path,
            _ => path.with_extension(self.endings()[0]),
        }
    }
}

/// Whether this system has a window to choose files in, as far as can be told without asking.
pub fn system_has_a_window() -> bool {
    let on_path = |program: &str| {
        env::var_os("PATH")
            .is_some_and(|path| env::split_paths(&path).any(|folder| folder.join(program).is_file()))
    };
    let has_bus = || env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|bus| !bus.is_empty());
    !cfg!(target_os = "linux") || has_bus() || on_path("zenity")
}

/// A file being chosen.
#[derive(Debug)]
pub struct Choosing {
    /// What for.
    pub purpose: Purpose,
    window: Window,
}

#[derive(Debug)]
enum Window {
    System(Receiver<Option<PathBuf>>),
    Own(OwnWindow),
}

impl Choosing {
    /// Asks for a file, beginning at `near`: in a window of our own where `own`.
    pub fn begin(purpose: Purpose, near: &Path, own: bool, ctx: &Context) -> Self {
        let window = match own {
            true => Window::Own(OwnWindow::new(near)),
            false => Window::System(ask_system(purpose, near, ctx.clone())),
        };
        Self { purpose, window }
    }

    /// Shows the window, or waits for the system's.
    pub fn show(&mut self, ctx: &Context) -> Answer<PathBuf> {
        let answer = match &mut self.window {
            Window::Own(window) => window.show(ctx, self.purpose),
            Window::System(receiver) => match receiver.try_recv() {
                Ok(Some(path)) => Answer::Chosen(path),
                Ok(None) | Err(TryRecvError::Disconnected) => Answer::Closed,
                Err(TryRecvError::Empty) => Answer::Open,
            },
        };
        match answer {
            Answer::Chosen(path) => Answer::Chosen(self.purpose.complete(path)),
            other => other,
        }
    }

    /// Whether it is a window of the system's, which covers nothing of ours.
    pub fn is_systems(&self) -> bool {
        matches!(self.window, Window::System(_))
    }
}

fn ask_system(purpose: Purpose, near: &Path, ctx: Context) -> Receiver<Option<PathBuf>> {
    let (sender, receiver) = channel();
    let mut dialog = rfd::AsyncFileDialog::new().set_title(purpose.title()).set_directory(folder_of(near));
    dialog = match purpose {
        Purpose::Open | Purpose::Save => dialog.add_filter("nephos scene", purpose.endings()),
        // The ending says what is written: any file may be meant.
        Purpose::Job => dialog,
    };
    if let Some(name) = near.file_name() {
        dialog = dialog.set_file_name(name.to_string_lossy());
    }
    // Some systems want the window made on this thread; all let another one wait for it.
    let file = match purpose {
        Purpose::Open => Box::pin(dialog.pick_file()) as std::pin::Pin<Box<dyn Future<Output = _> + Send>>,
        Purpose::Save | Purpose::Job => Box::pin(dialog.save_file()),
    };
    thread::spawn(move || {
        let path = pollster::block_on(file).map(|file| file.path().to_owned());
        // Nobody listens any more where the editor was closed meanwhile.
        let _ = sender.send(path);
        ctx.request_repaint();
    });
    receiver
}

/// The folder that `near` is, or is in; the current one where there is no such folder.
fn folder_of(near: &Path) -> PathBuf {
    let folder = if near.is_dir() { Some(near) } else { near.parent() };
    let folder = folder.filter(|folder| folder.is_dir()).map(Path::to_owned);
    folder.or_else(|| env::current_dir().ok()).unwrap_or_default()
}

/// A window of our own: a folder's list and a path.
#[derive(Debug)]
struct OwnWindow {
    folder: PathBuf,
    path: String,
    /// What the folder holds: name, whether it is a folder.
    entries: Vec<(String, bool)>,
    complaint: Option<String>,
    fresh: bool,
}

impl OwnWindow {
    fn new(near: &Path) -> Self {
        let folder = folder_of(near);
        let path = match near.file_name().filter(|_| !near.is_dir()) {
            Some(name) => folder.join(name),
            None => folder.join(""),
        };
        let path = path.display().to_string();
        let mut window = Self { folder, path, entries: Vec::new(), complaint: None, fresh: true };
        window.list();
        window
    }

    fn list(&mut self) {
        let read = match fs::read_dir(&self.folder) {
            Ok(read) => read,
            Err(error) => {
                self.complaint = Some(format!("cannot read `{}`: {error}", self.folder.display()));
                return;
            }
        };
        let name = |entry: fs::DirEntry| {
            let is_folder = entry.path().is_dir();
            (entry.file_name().to_string_lossy().into_owned(), is_folder)
        };
        self.entries = read.flatten().map(name).filter(|(name, _)| !name.starts_with('.')).collect();
        self.entries.sort_by_key(|(name, is_folder)| (!is_folder, name.to_lowercase()));
        self.complaint = None;
    }

    fn enter(&mut self, folder: PathBuf) {
        let name =
            Path::new(&self.path).file_name().map(ToOwned::to_owned).filter(|_| !self.path.ends_with('/'));
        self.path = folder.join(name.unwrap_or_default()).display().to_string();
        self.folder = folder;
        self.list();
    }

    fn show(&mut self, ctx: &Context, purpose: Purpose) -> Answer<PathBuf> {
        let mut answer = Answer::Open;
        let modal = modal(ctx, "choose a file").show(ctx, |ui| {
            ui.set_width(520.0);
            ui.heading(purpose.title());
            ui.add_space(6.0);
            let field = TextEdit::singleline(&mut self.path).desired_width(f32::INFINITY);
            let response = ui.add(field);
            name_widget(ui, &response, "Path of the file");
            if std::mem::take(&mut self.fresh) {
                response.request_focus();
            }
            let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.add_space(4.0);
            if let Some(path) = self.entries_ui(ui, purpose) {
                answer = Answer::Chosen(path);
            }
            if let Some(complaint) = &self.complaint {
                ui.colored_label(ui.visuals().error_fg_color, complaint);
            }
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let clicked = ui.button(RichText::new(purpose.button()).strong()).clicked();
                if ui.button("Cancel").clicked() {
                    answer = Answer::Closed;
                }
                if clicked || entered {
                    answer = self.choose(purpose);
                }
            });
        });
        if modal.should_close() && answer == Answer::Open {
            return Answer::Closed;
        }
        answer
    }

    /// The path as it was typed; a folder is entered.
    fn choose(&mut self, purpose: Purpose) -> Answer<PathBuf> {
        let path = PathBuf::from(self.path.trim());
        if path.is_dir() {
            self.enter(path);
            return Answer::Open;
        }
        let path = purpose.complete(path);
        if purpose == Purpose::Open && !path.is_file() {
            self.complaint = Some(format!("there is no file `{}`", path.display()));
            return Answer::Open;
        }
        Answer::Chosen(path)
    }

    /// Folders and files; a file that was clicked twice.
    fn entries_ui(&mut self, ui: &mut Ui, purpose: Purpose) -> Option<PathBuf> {
        let (mut go_to, mut chosen) = (None, None);
        let scroll = ScrollArea::vertical().max_height(240.0).min_scrolled_height(240.0).auto_shrink(false);
        scroll.show(ui, |ui| {
            if let Some(parent) = self.folder.parent()
                && ui.selectable_label(false, format!("{} ..", icon::FOLDER)).clicked()
            {
                go_to = Some(parent.to_owned());
            }
            let fits =
                |name: &str| purpose.endings().iter().any(|ending| name.ends_with(&format!(".{ending}")));
            for (name, is_folder) in self.entries.iter().filter(|(name, folder)| *folder || fits(name)) {
                let mark = if *is_folder { icon::FOLDER } else { icon::FILE };
                let path = self.folder.join(name);
                let response = ui.selectable_label(Path::new(&self.path) == path, format!("{mark} {name}"));
                if response.clicked() && *is_folder {
                    go_to = Some(path.clone());
                } else if response.clicked() {
                    self.path = path.display().to_string();
                }
                if response.double_clicked() && !is_folder {
                    chosen = Some(path);
                }
            }
        });
        if let Some(folder) = go_to {
            self.enter(folder);
        }
        chosen
    }
}
