//! What the program shows in a terminal.

use std::{
    io::{self, IsTerminal, Write},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};

use super::desk;
use crate::{Error, Result, scene::Scene};

/// Log lines go to the standard error: warnings by default, more with `RUST_LOG`.
pub(super) fn log() {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env()
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("nephos=warn"));
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr).without_time().init();
}

/// Tells how far a scene's clouds reach below its ground, where they do.
pub(super) fn below_ground(scene: &Scene) -> Result<()> {
    match scene.bounds() {
        Some((low, _)) if low.y < scene.ground.altitude => print(&format!(
            "It reaches {:.1} m below the ground, where nothing is seen of it: --at X,Y,Z lifts it.\n",
            scene.ground.altitude - low.y
        )),
        _ => Ok(()),
    }
}

/// A bar on terminals, for work that takes over a second; elsewhere a line now and then.
pub(super) fn progress(message: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(1000).with_message(message);
    let template = if io::stderr().is_terminal() {
        "{msg} {wide_bar} {percent}% {eta} left"
    } else {
        let lines =
            Lines { every: LINE_EVERY, last: Mutex::new(Instant::now()), out: |line| eprintln!("{line}") };
        bar.set_draw_target(ProgressDrawTarget::term_like_with_hz(Box::new(lines), 1));
        "{msg} {percent}% {eta} left"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// How far work is that draws or exports: a bar or lines, or what the program hears that listens.
pub(super) struct Share {
    bar: Option<ProgressBar>,
    told: AtomicU64,
}

/// Begins work of this name.
pub(super) fn share(message: &'static str) -> Share {
    let bar = (!desk::is_there()).then(|| progress(message));
    Share { bar, told: AtomicU64::new(0) }
}

impl Share {
    /// So much is done, 0 to 1; returns when the work may go on.
    pub fn set(&self, share: f64) {
        let thousandths = (1000.0 * share) as u64;
        if let Some(bar) = &self.bar {
            return bar.set_position(thousandths);
        }
        if self.told.swap(thousandths, Ordering::Relaxed) != thousandths {
            desk::tell(thousandths);
        }
        desk::wait();
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Time between two lines of progress.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Takes what a bar draws, and writes a line of it now and then: logs have no cursor to go back with.
#[derive(Debug)]
struct Lines {
    every: Duration,
    last: Mutex<Instant>,
    out: fn(&str),
}

impl TermLike for Lines {
    fn width(&self) -> u16 {
        80
    }

    fn move_cursor_up(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _: usize) -> io::Result<()> {
        Ok(())
    }

    fn write_line(&self, line: &str) -> io::Result<()> {
        self.write_str(line)
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let line = text.trim();
        if !line.is_empty() && last.elapsed() >= self.every {
            *last = Instant::now();
            (self.out)(line);
        }
        Ok(())
    }

    fn clear_line(&self) -> io::Result<()> {
        Ok(())
    }

    fn flush(&self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes `text` to the standard output; a reader that went away is no error.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    let printed = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match printed {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::File { action: "write", path: "-".into(), source: error })
        }
        _ => Ok(()),
    }
}

/// Writes a value as JSON to the standard output.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    print(&json(value)?)
}

/// A value as JSON, with the line's end.
pub(super) fn json(value: &impl serde::Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Error::Argument(format!("the result could not be written as JSON: {error}")))?;
    Ok(text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_progress_are_few_and_plain() {
        static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
        let lines = |every| Lines {
            every,
            last: Mutex::new(Instant::now()),
            out: |line| SAID.lock().unwrap().push(line.to_owned()),
        };
        let draw = |lines: Lines| {
            let style = ProgressStyle::with_template("{msg} {percent}%").unwrap();
            let target = ProgressDrawTarget::term_like(Box::new(lines));
            let bar = ProgressBar::with_draw_target(Some(1000), target).with_style(style);
            bar.set_message("frames");
            bar.set_position(250);
            bar.tick();
            bar.finish_and_clear();
        };
        draw(lines(LINE_EVERY));
        assert!(SAID.lock().unwrap().is_empty());
        draw(lines(Duration::ZERO));
        let said = SAID.lock().unwrap();
        assert!(said.iter().any(|line| line == "frames 25%"), "{said:?}");
        assert!(said.iter().all(|line| !line.is_empty() && !line.contains('\u{1b}')), "{said:?}");
    }
}
