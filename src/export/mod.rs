//! Files for other programs: pictures for eyes (PNG) and compositors (EXR), volumes (OpenVDB, Mitsuba).

mod estimate;
mod exr;
mod picture;
mod png;
mod vdb;
mod vol;

pub use estimate::{Earlier, read_estimate, write_estimate};
pub use exr::{write_beauty, write_layers};
pub use picture::Picture;
pub use png::write_png;
pub use vdb::write_vdb;
pub use vol::write_vol;
