//! The editor as a whole: its state, and one frame of it.

use std::{
    num::NonZeroUsize,
    path::PathBuf,
    time::{Duration, Instant},
};

use eframe::egui::{self, CentralPanel, Context, Frame, Margin, Panel, Ui, ViewportCommand};

use super::{
    Document, Session,
    actions::Action,
    asking::{Dialog, Then},
    choosing::{Choosing, Purpose},
    inbox,
    jobs::{Ended, JobForm, Jobs, Program},
    labels::name_widget,
    notices::Notices,
    panels::{ObjectPanel, Outliner, TimelinePanel, ViewPanel, Wish, WorldPanel},
    settings::{Look, Places, Settings},
    theme,
    viewport::{ViewCommand, ViewSettings, Viewport},
};
use crate::scene::{CoverMap, Volume};

/// What the editor starts with.
#[derive(Debug, Clone)]
pub struct Options {
    /// The scene to open.
    pub scene: Option<PathBuf>,
    /// Where the editor keeps its own files.
    pub places: Places,
    /// How long unsaved work may be lost by a crash.
    pub keep_after: Duration,
    /// What renders and exports beside the work; nothing where there is none.
    pub program: Option<Program>,
}

impl Options {
    /// Opens `scene`, or nothing, and keeps the editor's own files in `places`.
    pub fn new(scene: Option<PathBuf>, places: Places) -> Self {
        Self { scene, places, keep_after: Duration::from_secs(10), program: None }
    }
}

/// What the right panel shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Tab {
    #[default]
    Object,
    World,
    View,
}

/// The editor.
pub struct Editor {
    pub(super) document: Document,
    pub(super) session: Session,
    pub(super) settings: Settings,
    pub(super) places: Places,
    pub(super) viewport: Viewport,
    pub(super) outliner: Outliner,
    pub(super) object: ObjectPanel,
    pub(super) world: WorldPanel,
    pub(super) view: ViewPanel,
    pub(super) form: JobForm,
    pub(super) timeline: TimelinePanel,
    pub(super) tab: Tab,
    pub(super) dialog: Option<Dialog>,
    pub(super) notices: Notices,
    pub(super) program: Option<Program>,
    pub(super) jobs: Jobs,
    /// Whether the window was told to close while there were jobs.
    pub(super) warned: bool,
    pub(super) closing: bool,
    pub(super) had_focus: bool,
    /// Seed of the last preset.
    pub(super) seed: u64,
    keep_after: Duration,
    title: String,
    /// The settings as they are in their file.
    written: Option<Settings>,
    looked: Instant,
}

impl Editor {
    /// An editor whose viewport draws with the window's device.
    pub fn new(ctx: &Context, render_state: &egui_wgpu::RenderState, options: Options) -> Self {
        theme::dress(ctx);
        ctx.options_mut(|options| {
            options.zoom_with_keyboard = false;
            options.max_passes = NonZeroUsize::new(inbox::PASSES).unwrap_or(NonZeroUsize::MIN);
        });
        ctx.add_plugin(inbox::Inbox::default());
        let settings = Settings::load(&options.places);
        let (session, problem) = Session::begin(&options.places);
        let mut viewport = Viewport::new(render_state);
        viewport.settings =
            serde_json::from_value::<ViewSettings>(settings.viewport.clone()).unwrap_or_default();
        let mut editor = Self {
            document: Document::default(),
            session,
            settings,
            places: options.places,
            viewport,
            outliner: Outliner::default(),
            object: ObjectPanel::default(),
            world: WorldPanel::default(),
            view: ViewPanel,
            form: JobForm::default(),
            timeline: TimelinePanel::default(),
            tab: Tab::default(),
            dialog: None,
            notices: Notices::default(),
            program: options.program,
            jobs: Jobs::default(),
            warned: false,
            closing: false,
            had_focus: true,
            seed: 0,
            keep_after: options.keep_after,
            title: String::new(),
            written: None,
            looked: Instant::now(),
        };
        editor.apply_settings(ctx);
        if let Some(error) = problem {
            editor.notices.problem(format!("Unsaved work is not kept safe from a crash: {error}"));
        }
        editor.begin(options.scene);
        editor
    }

    /// What is edited.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What is edited, to be changed as the panels do.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The file that is edited.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The viewport.
    pub fn viewport_mut(&mut self) -> &mut Viewport {
        &mut self.viewport
    }

    /// What the editor remembers.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the bar under the menu tells.
    pub fn told(&self) -> Vec<String> {
        self.notices.texts().map(str::to_owned).collect()
    }

    /// Whether the timeline plays.
    pub fn is_playing(&self) -> bool {
        self.timeline.is_playing()
    }

    /// Whether there is a timeline, and its panel is open.
    pub(super) fn shows_timeline(&self) -> bool {
        self.document.scene().timeline.is_some() && self.settings.shows("timeline")
    }

    /// Whether there are jobs that are not at their end.
    pub fn has_jobs(&self) -> bool {
        self.jobs.are_busy()
    }

    /// The jobs, to be added to.
    pub fn jobs_mut(&mut self) -> &mut Jobs {
        &mut self.jobs
    }

    /// One frame.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.take_in(&ctx);
        self.timeline.play_on(&ctx, &mut self.document);
        Panel::top("menu").frame(bar(&ctx)).show_separator_line(true).show(ui, |ui| self.menu(ui));
        self.notices.show(&ctx);
        Panel::bottom("status").frame(bar(&ctx)).show(ui, |ui| self.status(ui));
        self.panels(ui);
        CentralPanel::default()
            .frame(Frame::new().fill(ctx.global_style().visuals.extreme_bg_color))
            .show(ui, |ui| self.viewport.ui(ui, &mut self.document));
        self.jobs.show(&ctx);
        self.dialogs(&ctx);
        self.shortcuts(&ctx);
        self.wind_up(&ctx);
    }

    /// What came from outside since the last frame.
    fn take_in(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        if let Some(path) = dropped {
            if Volume::is_named(&path) {
                self.add_volume(&path);
            } else if let Some(layer) = self.layer_at_hand().filter(|_| CoverMap::is_named(&path)) {
                self.paint(layer, &path);
            } else if CoverMap::is_named(&path) {
                self.lay_on_the_ground(&path);
            } else {
                self.ask(ctx, Then::Open(path));
            }
        }
        for ended in self.jobs.go_on(ctx) {
            match ended {
                Ended::Well(text) => self.notices.news(text),
                Ended::Badly(text) => self.notices.problem(text),
            }
        }
        let has_focus = ctx.input(|input| input.focused);
        // Who comes back from another window may have changed the file there.
        let had_focus = std::mem::replace(&mut self.had_focus, has_focus);
        let back = has_focus && !had_focus;
        if back || self.looked.elapsed() > Duration::from_secs(2) {
            self.looked = Instant::now();
            self.notice_changes();
            self.write_settings();
        }
    }

    fn panels(&mut self, ui: &mut Ui) {
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 8));
        if self.shows_timeline() {
            let panel = Panel::bottom("timeline").frame(frame).resizable(true);
            panel.default_size(190.0).min_size(110.0).show(ui, |ui| {
                self.timeline.ui(ui, &mut self.document);
            });
        }
        if self.settings.shows("outliner") {
            Panel::left("outliner").frame(frame).default_size(216.0).min_size(150.0).show(ui, |ui| {
                self.outliner_head(ui);
                self.outliner.ui(ui, &mut self.document);
            });
        }
        if self.settings.shows("inspector") {
            Panel::right("inspector").frame(frame).default_size(332.0).min_size(290.0).show(ui, |ui| {
                self.inspector(ui);
            });
        }
    }

    fn inspector(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            for (tab, name) in [(Tab::Object, "Object"), (Tab::World, "World"), (Tab::View, "View")] {
                let response = ui.selectable_value(&mut self.tab, tab, name);
                name_widget(ui, &response, &format!("{name} panel"));
            }
        });
        ui.separator();
        let area = egui::ScrollArea::vertical().auto_shrink(false).id_salt(self.tab as u8);
        area.show(ui, |ui| match self.tab {
            Tab::Object => self.object.ui(ui, &mut self.document),
            Tab::World => match self.world.ui(ui, &mut self.document, self.viewport.metered()) {
                Some(Wish::CameraFromView) => self.perform(ui.ctx(), Action::CameraFromView),
                Some(Wish::ViewFromCamera) => {
                    self.perform(ui.ctx(), Action::View(ViewCommand::LookThroughSceneCamera));
                }
                None => {}
            },
            Tab::View => {
                if let Some(command) = self.view.ui(ui, &mut self.viewport) {
                    self.perform(ui.ctx(), Action::View(command));
                }
            }
        });
    }

    /// What remains to be done at the end of a frame.
    fn wind_up(&mut self, ctx: &Context) {
        if !ctx.input(|input| input.pointer.any_down()) && !ctx.text_edit_focused() {
            self.document.settle();
        }
        if let Some(news) = self.document.take_news() {
            self.notices.news(news);
        }
        if let Some(refusal) = self.document.take_refusal() {
            self.notices.problem(format!("That can't be: {refusal}"));
        }
        match self.session.keep(&self.document, self.keep_after) {
            Ok(Some(wait)) => ctx.request_repaint_after(wait),
            Ok(None) => {}
            Err(error) => {
                self.notices.problem(format!("Unsaved work could not be kept safe from a crash: {error}"));
            }
        }
        self.close_or_stay(ctx);
        self.set_title(ctx);
        self.remember_window(ctx);
    }

    fn set_title(&mut self, ctx: &Context) {
        let mark = if self.document.is_dirty() { "• " } else { "" };
        let title = format!("{mark}{} - nephos", self.session.name());
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    fn remember_window(&mut self, ctx: &Context) {
        let window = ctx.input(|input| {
            let window = input.viewport();
            let size = window.inner_rect?.size();
            let position = window.outer_rect.map(|rect| [rect.min.x, rect.min.y]);
            let maximized = window.maximized.unwrap_or(false);
            Some(super::settings::WindowPlace { size: [size.x, size.y], position, maximized })
        });
        // A window that fills the desktop is remembered with the size that it had before.
        if let Some(window) = window {
            let size = match (&self.settings.window, window.maximized) {
                (Some(before), true) => before.size,
                _ => window.size,
            };
            self.settings.window = Some(super::settings::WindowPlace { size, ..window });
        }
    }

    /// Writes down what is to be remembered, where it changed: in a while, and when the editor ends.
    pub fn write_settings(&mut self) {
        self.settings.viewport = serde_json::to_value(&self.viewport.settings).unwrap_or_default();
        if self.written.as_ref() == Some(&self.settings) {
            return;
        }
        // Told once, not every time.
        self.written = Some(self.settings.clone());
        if let Err(error) = self.settings.save(&self.places) {
            tracing::warn!(%error, "the settings were not saved");
        }
    }

    pub(super) fn apply_settings(&self, ctx: &Context) {
        ctx.set_theme(match self.settings.look {
            Look::Dark => egui::ThemePreference::Dark,
            Look::Light => egui::ThemePreference::Light,
            Look::System => egui::ThemePreference::System,
        });
        ctx.set_zoom_factor(self.settings.zoom.unwrap_or(1.0).clamp(0.5, 3.0));
    }

    /// Begins to choose a file.
    pub(super) fn choose(&mut self, ctx: &Context, purpose: Purpose, then: Option<Then>) {
        let near = match purpose {
            Purpose::Job => self.form.output(),
            Purpose::Open | Purpose::Save => self.near(purpose),
        };
        let own = self.settings.own_file_window || !super::choosing::system_has_a_window();
        self.dialog = Some(Dialog::Choosing(Choosing::begin(purpose, &near, own, ctx), then));
    }
}

/// The frame of the bars above and below.
fn bar(ctx: &Context) -> Frame {
    Frame::new().fill(ctx.global_style().visuals.panel_fill).inner_margin(Margin::symmetric(10, 4))
}
