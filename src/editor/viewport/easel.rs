//! The picture of the viewport, drawn on a thread of its own: however long light takes, the window
//! goes on. Adapters that are no GPU draw with a device of their own, too, for what the window itself
//! has to draw would stand behind the clouds in the queue of theirs; pixels then go over by memory.

use std::{
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use eframe::egui::{Context, TextureId, mutex::RwLock};

use super::{
    canvas::Canvas, error_map::Numbers, screen::Shelf, statistics::Statistics, subject::Subject, truth::Truth,
};
use crate::{gpu::Gpu, scene::Tone};

/// How often the window looks how far a picture has come.
const LOOK: Duration = Duration::from_millis(100);

/// What is to be drawn.
#[derive(Debug, Clone)]
pub struct Order {
    /// What is seen.
    pub subject: Subject,
    /// How light becomes the picture.
    pub tone: Tone,
    /// Time between two looks at what is wanted.
    pub budget: Duration,
    /// Whether work is counted and timed.
    pub measure: bool,
    /// Whether the truth is wanted, once the picture is final.
    pub truth: bool,
}

impl Order {
    /// Whether both give the same picture.
    fn is_like(&self, other: &Self) -> bool {
        let rest = |order: &Self| {
            let Self { subject, tone, budget, measure, truth } = order;
            (*tone, *budget, *measure, *truth, subject.scene.is_metered())
        };
        rest(self) == rest(other)
            && self.subject.same_view(&other.subject)
            && self.subject.same_scene(&other.subject)
    }
}

/// What there is to see.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// The picture for egui.
    pub image: Option<TextureId>,
    /// What was drawn and how long it took.
    pub statistics: Statistics,
    /// What auto exposure adds to the scene's exposure, stops.
    pub metered: Option<f64>,
    /// Why there is no new picture.
    pub error: Option<String>,
    /// The truth, where it was asked for.
    pub truth: TruthSeen,
    at_rest: bool,
    /// The order that it was drawn for.
    order: u64,
}

/// What there is to see of the truth.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TruthSeen {
    /// Its picture.
    pub image: Option<TextureId>,
    /// The map of differences.
    pub map: Option<TextureId>,
    /// Samples of each pixel, and how far the preview is from it.
    pub numbers: Option<(u32, Numbers)>,
    /// Why there is none.
    pub error: Option<String>,
    /// Whether there is no more to do.
    pub done: bool,
}

/// What window and thread tell one another.
#[derive(Default)]
struct Table {
    order: Option<(Order, Context)>,
    orders: u64,
    seen: Seen,
    /// Pictures that the window has seen: a finer one is not begun before that.
    looked: u64,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    table: Mutex<Table>,
    news: Condvar,
}

impl Shared {
    fn table(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for an order after the one of number `last`, or for `after`. Nothing where all is over.
    fn next(&self, last: u64, after: Option<Duration>) -> Option<(Order, Context, u64)> {
        let due = after.map(|after| Instant::now() + after);
        let mut table = self.table();
        loop {
            if table.closed {
                return None;
            }
            let wait = due.map(|due| due.saturating_duration_since(Instant::now()));
            let was_seen = table.seen.statistics.pictures <= table.looked;
            let is_due = was_seen && wait == Some(Duration::ZERO);
            if let Some((order, window)) = &table.order
                && (table.orders > last || is_due)
            {
                return Some((order.clone(), window.clone(), table.orders));
            }
            table = match wait.filter(|wait| was_seen && !wait.is_zero()) {
                Some(wait) => self.news.wait_timeout(table, wait).unwrap_or_else(PoisonError::into_inner).0,
                None => self.news.wait(table).unwrap_or_else(PoisonError::into_inner),
            };
        }
    }
}

/// The window's end of it.
pub struct Easel {
    gpu: Gpu,
    shared: Arc<Shared>,
    seen: Seen,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Easel {
    /// Begins with nothing; `gpu` is the window's, and `egui` draws the window.
    pub fn new(gpu: Gpu, egui: Arc<RwLock<egui_wgpu::Renderer>>) -> Self {
        let (shared, stop) = (Arc::<Shared>::default(), Arc::<AtomicBool>::default());
        let (theirs, token, windows) = (shared.clone(), stop.clone(), gpu.clone());
        let thread = thread::spawn(move || work(&theirs, windows, egui, token));
        Self { gpu, shared, seen: Seen::default(), stop, thread: Some(thread) }
    }

    /// The window's device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What there was to see when [`Easel::ask`] was called last.
    pub fn seen(&self) -> &Seen {
        &self.seen
    }

    /// Whether what was asked for is drawn in final quality.
    pub fn at_rest(&self) -> bool {
        self.seen.at_rest && self.seen.order == self.shared.table().orders
    }

    /// Asks for a picture, and looks at what there is.
    pub fn ask(&mut self, order: Order, window: &Context) {
        let mut table = self.shared.table();
        if !table.order.as_ref().is_some_and(|(before, _)| before.is_like(&order)) {
            table.order = Some((order, window.clone()));
            table.orders += 1;
        }
        self.seen = table.seen.clone();
        table.looked = self.seen.statistics.pictures;
        let more = self.seen.order != table.orders || !self.seen.at_rest;
        drop(table);
        self.shared.news.notify_all();
        if more && self.seen.error.is_none() {
            window.request_repaint_after(LOOK);
        }
    }
}

impl Drop for Easel {
    /// Waits for the thread: a device must not outlive the program.
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.shared.table().closed = true;
        self.shared.news.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread does.
fn work(shared: &Shared, windows: Gpu, egui: Arc<RwLock<egui_wgpu::Renderer>>, stop: Arc<AtomicBool>) {
    let own = if windows.adapter.kind == "Cpu" { own_device(&windows) } else { None };
    let (gpu, shelf) = match own {
        Some(gpu) => (gpu, Shelf::Memory),
        None => (windows, Shelf::Device(egui)),
    };
    let mut canvas = Canvas::new(gpu.stopped_by(stop), shelf);
    let mut truth = Truth::default();
    let (mut last, mut after) = (0, None);
    while let Some((order, window, number)) = shared.next(last, after) {
        last = number;
        after = step(&mut canvas, &mut truth, order, &window);
        let seen = Seen {
            image: canvas.image(),
            statistics: canvas.statistics.clone(),
            metered: canvas.metered(),
            error: canvas.error.clone(),
            truth: truth.seen(),
            at_rest: canvas.at_rest(),
            order: number,
        };
        let mut table = shared.table();
        let before = std::mem::replace(&mut table.seen, seen);
        let now = &table.seen;
        let is_news = before.order != now.order
            || before.at_rest != now.at_rest
            || before.statistics.pictures != now.statistics.pictures
            || before.metered != now.metered
            || before.truth != now.truth;
        drop(table);
        if is_news {
            window.request_repaint();
        }
    }
}

fn own_device(windows: &Gpu) -> Option<Gpu> {
    let opened = pollster::block_on(Gpu::open(Some(&windows.adapter.name)));
    opened.inspect_err(|error| tracing::warn!(%error, "the view shares the window's device")).ok()
}

/// A helping of work for `order`; tells when there is more to do.
fn step(canvas: &mut Canvas, truth: &mut Truth, order: Order, window: &Context) -> Option<Duration> {
    canvas.measure(order.measure);
    let after = canvas.update(order.subject, order.tone, order.budget, window);
    if !order.truth || !canvas.at_rest() {
        truth.stop();
        return after;
    }
    let tone = canvas.tone();
    let more = truth.update(window, canvas, tone, order.budget);
    if more { Some(Duration::ZERO) } else { after }
}
