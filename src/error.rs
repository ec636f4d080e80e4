//! The one error type: every variant is a sentence that names the thing, the
//! value and the way out.

use std::path::PathBuf;

/// What can go wrong, told so that the reader knows what to do next.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value of a scene is missing, mistyped or out of range: mend it at `path`.
    #[error("{path}: {problem}")]
    Scene {
        /// JSON path of the value, for example `clouds[0].ellipsoids[2].radii`.
        path: String,
        /// The value found, what was expected, and where it helps, the nearest known name.
        problem: String,
    },
    /// A file could not be read or written: check the path and its permissions.
    #[error("cannot {action} `{}`: {source}", path.display())]
    File {
        /// What was attempted: "read", "write", "create".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file was read but is not what its name says: the sentence tells how to get a good one.
    #[error("`{}` {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// No graphics adapter fits: the sentence says what to install or which name to give.
    #[error("{0}")]
    Adapter(String),
    /// The graphics device refused or lost the work: the sentence says what was being done.
    #[error("the graphics device failed while {doing}: {reason}")]
    Gpu {
        /// The step that was under way.
        doing: String,
        /// What the driver or the validation said.
        reason: String,
    },
    /// Somebody asked the program to stop, and it has: see [`crate::gpu::Gpu::stop_token`].
    #[error("stopped: {kept}")]
    Stopped {
        /// What there is of the work, and how to go on.
        kept: String,
    },
    /// An argument has no meaning here: the sentence says which values do.
    #[error("{0}")]
    Argument(String),
    /// An embedded table is damaged or foreign: rebuild the program or the table it names.
    #[error("table `{name}`: {problem}")]
    Table {
        /// Name of the table's file in `tables/`.
        name: &'static str,
        /// What is wrong with it.
        problem: String,
    },
}

impl Error {
    /// A complaint about a scene that says at which moment it is about it, s.
    pub(crate) fn at_time(self, time: f64) -> Self {
        match self {
            Self::Scene { path, problem } => {
                Self::Scene { path, problem: format!("{problem} (at {time} seconds, where curves lead it)") }
            }
            other => other,
        }
    }

    /// A complaint about a scene that says which file it is about.
    #[cfg(any(feature = "cli", feature = "editor"))]
    pub(crate) fn in_file(self, file: &std::path::Path) -> Self {
        match self {
            Self::Scene { path, problem } => {
                Self::Scene { path: format!("{}: {path}", file.display()), problem }
            }
            other => other,
        }
    }
}

/// The result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;
