//! How far the renderer is from the truth, and what it costs: a corpus of pictures with path
//! traced references, metrics, time and work.

mod contrast;
mod corpus;
mod cost;
mod crowd;
pub mod draw;
mod flip;
mod march;
mod metrics;
mod moving;
mod page;
mod plot;
mod reference;
mod report;
mod score;
mod speed;
mod speed_page;

pub use contrast::{Relief, SCALES};
pub use corpus::{CORPUS, Entry, SIZE, Set};
pub use cost::{Cost, Stopwatch, Work};
pub use crowd::{MOST_CLOUDS, crowd, heap};
pub use flip::flip;
pub use march::{MarchPoint, PICTURES as MARCH_PICTURES, curve};
pub use metrics::{BANDS, Errors, Truth};
pub use moving::{Change, Moving, MovingReport, Shift};
pub use page::page;
pub use reference::{Limits, OPAQUE, Progress, Reference, SEED, light};
pub use report::{Known, MeanCost, Report, march_text};
pub use score::{Drawn, Mean, Score, View, Way, means, score};
pub use speed::{KOL, Motion, Speed, SpeedReport, Track, Usage};
pub use speed_page::speed_page;
