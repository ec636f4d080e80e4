//! The program at work on one job: it tells its progress, and is told to pause, to go on and to stop.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{Receiver, Sender, TryRecvError, channel},
    thread,
    time::{Duration, Instant},
};

use eframe::egui::Context;

use crate::desk::{self, DESK, PROGRESS};

/// How long a program that was asked to stop may take before it is stopped.
const GRACE: Duration = Duration::from_secs(10);

/// What a program says.
enum Said {
    Share(f32),
    Trouble(String),
    Word(String),
}

/// How a job came out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// With what it told at the end.
    Done(String),
    /// With the sentence of its error.
    Failed(String),
}

/// A program at work.
pub struct Process {
    child: Child,
    stdin: Option<ChildStdin>,
    said: Receiver<Said>,
    share: f32,
    told: Vec<String>,
    trouble: Vec<String>,
    stopping: Option<Instant>,
}

impl Process {
    /// Begins; `window` is woken when there is something to see.
    ///
    /// # Errors
    /// Where the program can't be started.
    pub fn begin(words: &[String], window: &Context) -> io::Result<Self> {
        let (program, rest) = words.split_first().ok_or(io::ErrorKind::InvalidInput)?;
        let mut command = Command::new(program);
        command.args(rest).env(DESK, "1");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let (sender, said) = channel();
        if let Some(out) = child.stdout.take() {
            listen(out, Said::Word, sender.clone(), window.clone());
        }
        if let Some(errors) = child.stderr.take() {
            listen(errors, heard, sender, window.clone());
        }
        let stdin = child.stdin.take();
        let (told, trouble) = Default::default();
        Ok(Self { child, stdin, said, share: 0.0, told, trouble, stopping: None })
    }

    /// Share that is done, 0 to 1.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Has it wait before its next piece of work.
    pub fn pause(&mut self) {
        self.tell(desk::PAUSE);
    }

    /// Has it go on.
    pub fn go_on(&mut self) {
        self.tell(desk::GO);
    }

    /// Has it end where its files are whole.
    pub fn stop(&mut self) {
        self.tell(desk::STOP);
        self.stopping.get_or_insert_with(Instant::now);
    }

    /// A program that has just ended listens no more: that is seen soon enough.
    fn tell(&mut self, word: &str) {
        if let Some(stdin) = &mut self.stdin {
            let _ = stdin.write_all(format!("{word}\n").as_bytes()).and_then(|()| stdin.flush());
        }
    }

    /// Hears what it said; how it came out, once it has ended.
    pub fn look(&mut self) -> Option<Outcome> {
        let is_silent = loop {
            match self.said.try_recv() {
                Ok(Said::Share(share)) => self.share = share,
                Ok(Said::Trouble(line)) => self.trouble.push(line),
                Ok(Said::Word(line)) => self.told.push(line),
                Err(end) => break end == TryRecvError::Disconnected,
            }
        };
        if self.stopping.is_some_and(|since| since.elapsed() > GRACE) {
            let _ = self.child.kill();
        }
        match self.child.try_wait() {
            // The last words may come after the end.
            Ok(None) => None,
            Ok(Some(_)) if !is_silent => None,
            Ok(Some(status)) if status.success() => Some(Outcome::Done(joined(&self.told))),
            Ok(Some(status)) if self.trouble.is_empty() => Some(Outcome::Failed(format!(
                "the program ended with {status} and said nothing; the command line in a terminal may tell more"
            ))),
            Ok(Some(_)) => Some(Outcome::Failed(joined(&self.trouble))),
            Err(error) => Some(Outcome::Failed(format!("the program got lost: {error}"))),
        }
    }
}

impl Drop for Process {
    /// Nobody will hear it any more.
    fn drop(&mut self) {
        self.stdin = None;
        // It keeps what it has when nobody is there any more, if it is given the time.
        let begun = Instant::now();
        while begun.elapsed() < GRACE && matches!(self.child.try_wait(), Ok(None)) {
            thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn joined(lines: &[String]) -> String {
    lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n")
}

fn listen(
    stream: impl Read + Send + 'static,
    mean: fn(String) -> Said,
    sender: Sender<Said>,
    window: Context,
) {
    thread::spawn(move || {
        // Drivers may say what is no UTF-8.
        for line in BufReader::new(stream).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line).trim_end_matches('\r').to_owned();
            if sender.send(mean(line)).is_err() {
                return;
            }
            window.request_repaint();
        }
        drop(sender);
        window.request_repaint();
    });
}

/// A line of the standard error: progress, or trouble.
fn heard(line: String) -> Said {
    let share = line.strip_prefix(PROGRESS).and_then(|share| share.trim().parse::<f32>().ok());
    match share {
        Some(share) => Said::Share((share / 1000.0).clamp(0.0, 1.0)),
        None => Said::Trouble(line.strip_prefix("nephos: ").unwrap_or(&line).to_owned()),
    }
}
