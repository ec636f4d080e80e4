//! Files for other programs: pictures for eyes (PNG) and compositors (EXR), volumes (OpenVDB,
//! Mitsuba), skies and sprites for games.

pub mod atlas;
mod camera;
mod estimate;
mod exr;
mod hdr;
mod impostor;
mod ktx;
mod motion;
mod picture;
mod png;
mod sky_map;
mod sprite;
mod studio;
mod vdb;
mod vol;

pub use camera::write_camera;
pub use estimate::{Earlier, read_estimate, write_estimate};
pub use exr::{write_beauty, write_layers, write_named};
pub use hdr::write_hdr;
pub use impostor::{Around, impostor};
pub use ktx::write_ktx2;
pub use motion::{Motion, turning};
pub use picture::Picture;
pub use png::{write_grey, write_png};
pub use sky_map::{FACES, cube_faces, equirectangular};
pub use sprite::{Course, EDGES, SIDES, Subject};
pub use studio::{Shot, Studio};
pub use vdb::write_vdb;
pub use vol::write_vol;
