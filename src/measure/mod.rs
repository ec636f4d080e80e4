//! How far the renderer is from the truth, and what it costs: a corpus of pictures with path
//! traced references.

mod corpus;
mod reference;

pub use corpus::{CORPUS, Entry, SIZE, Set};
pub use reference::{Limits, OPAQUE, Progress, Reference, light};
