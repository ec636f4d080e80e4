//! Work for another program that listens, as the editor does: progress in lines, and its words on the standard
//! input, `pause`, `go` and `stop`. Where it goes away, the work ends as at Ctrl-C, with whole files.

use std::{
    env,
    io::{self, BufRead, Write},
    sync::{Condvar, Mutex, PoisonError, atomic::Ordering},
    thread,
};

use super::STOP;
use crate::desk::{self, DESK, PROGRESS};

/// Whether work waits.
static PAUSED: Mutex<bool> = Mutex::new(false);
static NEWS: Condvar = Condvar::new();

/// Whether somebody listens.
pub(super) fn is_there() -> bool {
    env::var_os(DESK).is_some()
}

/// Does as it is told from now on, where somebody listens.
pub(super) fn listen() {
    if !is_there() {
        return;
    }
    thread::spawn(|| {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            match line.trim() {
                desk::PAUSE => set_paused(true),
                desk::GO => set_paused(false),
                desk::STOP => break,
                _ => {}
            }
        }
        STOP.store(true, Ordering::Relaxed);
        set_paused(false);
    });
}

fn set_paused(paused: bool) {
    *PAUSED.lock().unwrap_or_else(PoisonError::into_inner) = paused;
    NEWS.notify_all();
}

/// Tells the thousandths that are done.
pub(super) fn tell(thousandths: u64) {
    // Nobody may listen any more.
    let _ = writeln!(io::stderr(), "{PROGRESS}{thousandths}");
}

/// Waits as long as it shall.
pub(super) fn wait() {
    let mut paused = PAUSED.lock().unwrap_or_else(PoisonError::into_inner);
    while *paused {
        paused = NEWS.wait(paused).unwrap_or_else(PoisonError::into_inner);
    }
}
