//! New, open, save, and the questions before something is lost.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, ViewportCommand};

use super::{
    Document, Selection,
    app::Editor,
    asking::{Dialog, Then},
    choosing::Purpose,
    dialogs::{self, Beginning, Changed, Recover, Unsaved},
    jobs::{JobWish, Order},
    palette::Answer,
    viewport::ViewCommand,
};
use crate::{
    numbered::{siblings, stem},
    scene::{Cloud, CoverMap, GroundKind, GroundPicture, Scene, Sequence, Volume},
};

impl Editor {
    /// What the editor begins with.
    pub(super) fn begin(&mut self, scene: Option<PathBuf>) {
        if let Some(path) = scene {
            self.open(&path);
        }
        let kept = self.session.left_behind();
        if !kept.is_empty() {
            self.dialog = Some(Dialog::Recover(kept));
        } else {
            self.welcome();
        }
    }

    /// The start window, where there is nothing else to look at: no file, no cloud, no question.
    fn welcome(&mut self) {
        let untouched = self.session.path().is_none() && !self.document.is_dirty();
        if untouched && self.dialog.is_none() && self.document.scene().clouds.is_empty() {
            self.dialog = Some(Dialog::Welcome);
        }
    }

    /// Does `then`, after a question where something is not saved.
    pub(super) fn ask(&mut self, ctx: &Context, then: Then) {
        if self.document.is_dirty() {
            self.dialog = Some(Dialog::Unsaved(then));
        } else {
            self.go_on(ctx, then);
        }
    }

    fn go_on(&mut self, ctx: &Context, then: Then) {
        match then {
            Then::New => self.start(Scene::default()),
            // A preset is a scene to be saved, not one that is.
            Then::NewFrom(preset) => {
                self.start(Scene::default());
                let scene = preset.scene(self.next_seed());
                self.replace(Document::unsaved(scene, Scene::default()));
            }
            Then::ChooseFile => self.choose(ctx, Purpose::Open, None),
            Then::Open(path) => self.open(&path),
            Then::Close => {
                self.closing = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    fn start(&mut self, scene: Scene) {
        self.session.start_new();
        self.replace(Document::new(scene));
        self.form.forget_files();
    }

    fn replace(&mut self, document: Document) {
        self.document = document;
        self.viewport.look_through(&self.document);
        self.notices.clear();
    }

    /// Opens `path`; where that fails, everything stays as it was.
    fn open(&mut self, path: &Path) {
        match self.session.open(path) {
            Ok(scene) => {
                self.replace(Document::new(scene));
                self.remember(path);
                self.form.forget_files();
                if self.session.is_read_only() {
                    let name = self.session.name();
                    self.notices.problem(format!("{name} is read-only: save changes under another name."));
                }
            }
            Err(error) => {
                self.settings.recent.retain(|recent| recent != path || path.exists());
                self.notices.problem(error);
            }
        }
    }

    /// Adds a cloud that is the volume in a file, or in all files that are numbered as it is; where it would reach below the
    /// ground, above that.
    pub(super) fn add_volume(&mut self, path: &Path) {
        let folder = self.session.path().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let all = siblings(path);
        let sequence = all.as_ref().map(|_| Sequence::default());
        let path = all.as_deref().unwrap_or(path);
        let (file, up) = (Volume::path_from(&folder, path), Volume::usual_up(path));
        let mut volume = Volume { file, up, sequence, ..Volume::default() };
        if let Err(error) = volume.read(&folder) {
            return self.notices.problem(error);
        }
        if let Some(grid) = volume.read_grid() {
            volume.extinction = Volume::usual_extinction(grid);
        }
        let ground = self.document.scene().ground.altitude;
        if let Some((low, high)) = volume.bounds().filter(|(low, _)| low.y < ground) {
            volume.place.y += ground - low.y + (high.y - low.y);
        }
        let name = stem(path);
        let steps =
            volume.steps().map_or(String::new(), |(first, last, _)| format!(", steps {first} to {last}"));
        let cloud = Cloud::of_volume(&name, volume);
        let added = Scene { clouds: vec![cloud.clone()], ..self.document.scene().clone() };
        if let Err(error) = added.validate() {
            return self.notices.problem(error);
        }
        self.document.edit_and_select("Add a volume", |scene, selection| {
            scene.clouds.push(cloud);
            *selection = Selection::cloud(scene, scene.clouds.len() - 1);
        });
        self.notices.news(format!("Added {}{steps}.", path.display()));
    }

    /// The number of the selected cloud where it is a layer.
    pub(super) fn layer_at_hand(&self) -> Option<usize> {
        self.document.active_cloud().filter(|(_, cloud)| cloud.layer.is_some()).map(|(index, _)| index)
    }

    /// Lets the picture in a file tell what the layer of a cloud covers.
    pub(super) fn paint(&mut self, index: usize, path: &Path) {
        let folder = self.session.path().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let mut scene = self.document.scene().clone();
        let Some(layer) = &mut scene.clouds[index].layer else { return };
        let size = layer.map.as_ref().map_or(2.0 * layer.period(), |map| map.size);
        let mut map = CoverMap { file: Volume::path_from(&folder, path), size, ..CoverMap::default() };
        if let Err(error) = map.read(&folder) {
            return self.notices.problem(error);
        }
        layer.map = Some(map);
        let painted = scene.clouds[index].layer.clone();
        if let Err(error) = scene.validate() {
            return self.notices.problem(error);
        }
        self.document.edit("Paint a layer", |scene| scene.clouds[index].layer = painted);
        self.notices.news(format!("{} tells what the layer covers.", path.display()));
    }

    /// Lays the picture in a file on the ground, as wide as the one before it.
    pub(super) fn lay_on_the_ground(&mut self, path: &Path) {
        let folder = self.session.path().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let before = self.document.scene().ground.kind.picture().cloned().unwrap_or_default();
        let mut picture = GroundPicture { file: Volume::path_from(&folder, path), ..before };
        if let Err(error) = picture.read(&folder) {
            return self.notices.problem(error);
        }
        self.document
            .edit("Lay a picture on the ground", |scene| scene.ground.kind = GroundKind::Picture(picture));
        self.notices.news(format!("{} is the ground.", path.display()));
    }

    /// Saves to the file, or to one that is asked for; then goes on with `then`.
    pub(super) fn save(&mut self, ctx: &Context, then: Option<Then>) {
        match self.session.path().map(Path::to_owned) {
            None => self.choose(ctx, Purpose::Save, then),
            Some(_) if self.session.changed_by_others() => self.dialog = Some(Dialog::Overwrite(then)),
            Some(path) => self.save_to(ctx, &path, then),
        }
    }

    fn save_to(&mut self, ctx: &Context, path: &Path, then: Option<Then>) {
        match self.session.save(&mut self.document, path) {
            Ok(()) => {
                self.remember(path);
                self.notices.clear();
                self.notices.news(format!("Saved {}.", path.display()));
                if let Some(then) = then {
                    self.go_on(ctx, then);
                }
            }
            Err(error) => self.notices.problem(error),
        }
    }

    /// Lists `path` among the recent files, even if the editor ends in a crash.
    fn remember(&mut self, path: &Path) {
        self.settings.remember(path);
        self.write_settings();
    }

    /// Where to begin to look for a file.
    pub(super) fn near(&self, purpose: Purpose) -> PathBuf {
        let near = self.session.path().or(self.settings.recent.first().map(PathBuf::as_path));
        match (near, purpose) {
            (Some(path), Purpose::Open) => path.parent().unwrap_or(path).to_owned(),
            (Some(path), _) if self.session.path().is_some() => path.to_owned(),
            (Some(path), _) => path.with_file_name("cloud.json"),
            (None, Purpose::Open) => PathBuf::from("."),
            (None, _) => PathBuf::from("cloud.json"),
        }
    }

    /// Asks what to do where another program changed the file.
    pub(super) fn notice_changes(&mut self) {
        if self.dialog.is_none() && self.session.changed_by_others() {
            self.dialog = Some(Dialog::Changed);
        }
    }

    /// Reads the file again.
    pub(super) fn revert(&mut self) {
        if let Some(path) = self.session.path().map(Path::to_owned) {
            self.open(&path);
        }
    }

    /// Closes, or asks first where something is not saved.
    pub(super) fn close_or_stay(&mut self, ctx: &Context) {
        if !ctx.input(|input| input.viewport().close_requested()) {
            return;
        }
        if self.document.is_dirty() && !self.closing {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.dialog = Some(Dialog::Unsaved(Then::Close));
            return;
        }
        if self.jobs.are_busy() && !std::mem::replace(&mut self.warned, true) {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            (self.closing, self.jobs.is_open) = (false, true);
            self.notices.problem("Jobs are under way: wait for them, or close once more to stop them.");
            return;
        }
        self.jobs.stop_all();
    }

    /// Shows what is open over everything else.
    pub(super) fn dialogs(&mut self, ctx: &Context) {
        let Some(dialog) = self.dialog.take() else { return };
        if let Some(dialog) = self.show_dialog(ctx, dialog) {
            // What was opened meanwhile goes first.
            self.dialog.get_or_insert(dialog);
        }
    }

    /// Shows `dialog` and gives it back where it stays open.
    fn show_dialog(&mut self, ctx: &Context, mut dialog: Dialog) -> Option<Dialog> {
        let name = self.session.name();
        let stays = match &mut dialog {
            Dialog::Welcome => stay(dialogs::welcome(ctx), |beginning| match beginning {
                Beginning::Empty => self.go_on(ctx, Then::New),
                Beginning::Preset(preset) => self.go_on(ctx, Then::NewFrom(preset)),
                Beginning::Open => self.go_on(ctx, Then::ChooseFile),
            }),
            Dialog::Recover(kept) => {
                let mut left = kept.clone();
                let stays = stay(dialogs::recover(ctx, kept), |what| self.recover(what, &mut left));
                if !stays && !left.is_empty() && left.len() < kept.len() && !self.document.is_dirty() {
                    self.dialog = Some(Dialog::Recover(left));
                }
                if !stays {
                    self.welcome();
                }
                stays
            }
            Dialog::Unsaved(then) => stay(dialogs::unsaved(ctx, &name), |what| match what {
                Unsaved::Save => self.save(ctx, Some(then.clone())),
                Unsaved::Discard => self.go_on(ctx, then.clone()),
            }),
            Dialog::Changed => {
                stay(dialogs::changed(ctx, &name, self.document.is_dirty()), |what| match what {
                    Changed::Reload => self.revert(),
                    Changed::Keep => {
                        self.session.accept_change();
                        self.document.mark_unsaved();
                    }
                })
            }
            Dialog::Overwrite(then) => stay(dialogs::overwrite(ctx, &name), |()| {
                if let Some(path) = self.session.path().map(Path::to_owned) {
                    self.save_to(ctx, &path, then.take());
                }
            }),
            Dialog::Choosing(choosing, then) => {
                let purpose = choosing.purpose;
                let answer = choosing.show(ctx);
                if answer == Answer::Closed && purpose == Purpose::Open {
                    self.welcome();
                }
                stay(answer, |path| match purpose {
                    Purpose::Open => self.open(&path),
                    Purpose::Save => self.save_to(ctx, &path, then.take()),
                    Purpose::Job => {
                        self.form.set_output(&path);
                        self.dialog = Some(Dialog::Job);
                    }
                })
            }
            Dialog::Job => {
                let Some(program) = &self.program else { return None };
                stay(self.form.show(ctx, program), |wish| match wish {
                    JobWish::Choose => self.choose(ctx, Purpose::Job, None),
                    JobWish::Begin => self.begin_job(),
                })
            }
            Dialog::Palette(palette) => {
                stay(palette.show(ctx, |action| self.can(action)), |action| self.perform(ctx, action))
            }
            Dialog::Shortcuts(list) => !list.show(ctx),
            Dialog::About => !self.about(ctx),
        };
        stays.then_some(dialog)
    }

    fn recover(&mut self, what: Recover, left: &mut Vec<super::Kept>) {
        match what {
            Recover::Restore(kept) => {
                let saved = self.session.resume(&kept);
                self.replace(Document::unsaved(kept.scene.clone(), saved));
                // It is kept anew before the old copy goes.
                match self.session.keep(&self.document, std::time::Duration::ZERO) {
                    Ok(_) => kept.discard(),
                    Err(error) => self.notices.problem(error),
                }
                left.retain(|other| *other != *kept);
            }
            Recover::Discard(kept) => {
                kept.discard();
                left.retain(|other| *other != *kept);
            }
        }
    }

    /// Asks for a job of a kind.
    pub(super) fn ask_for_job(&mut self, kind: usize) {
        if let Some(program) = &self.program {
            let adapter = &self.viewport.gpu().adapter.name;
            self.form.begin(program, kind, self.session.path(), adapter);
            self.dialog = Some(Dialog::Job);
        }
    }

    /// Puts the job that was asked for into the queue, with the scene as it is now.
    fn begin_job(&mut self) {
        let Some(program) = &self.program else { return };
        let Some(kind) = self.form.kind(program) else { return };
        let stem =
            Path::new(&self.session.name()).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let scene = match self.jobs.keep(&self.places.jobs(), &stem, &self.document.file_scene()) {
            Ok(scene) => scene,
            Err(error) => return self.notices.problem(error),
        };
        let mut words = vec![program.path.display().to_string()];
        words.extend(self.form.words(kind, &scene.display().to_string()));
        self.jobs.add(Order { title: kind.title, words, output: self.form.output(), scene });
        self.warned = false;
    }

    /// Looks at all clouds where the first one was just added.
    pub(super) fn frame_first(&mut self, was_empty: bool) {
        if was_empty {
            self.viewport.run(ViewCommand::FrameAll, &mut self.document);
        }
    }
}

/// Whether a window stays open; does what was chosen in it.
fn stay<T>(answer: Answer<T>, chosen: impl FnOnce(T)) -> bool {
    match answer {
        Answer::Open => true,
        Answer::Closed => false,
        Answer::Chosen(choice) => {
            chosen(choice);
            false
        }
    }
}
