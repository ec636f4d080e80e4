//! Words between the program at work and one that listens to it, such as the editor.

/// Variable of the environment that is set where somebody listens.
pub const DESK: &str = "NEPHOS_DESK";
/// Begins a line of the standard error with the thousandths that are done.
pub const PROGRESS: &str = "progress ";
/// Lines of the standard input: wait before the next piece of work, go on, end where files are whole.
pub const PAUSE: &str = "pause";
/// See [`PAUSE`].
pub const GO: &str = "go";
/// See [`PAUSE`].
pub const STOP: &str = "stop";
