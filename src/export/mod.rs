//! Files for other programs: pictures for eyes (PNG) and compositors (EXR), volumes (OpenVDB,
//! Mitsuba), skies and sprites for games.

pub mod atlas;
mod bleed;
mod camera;
mod cryptomatte;
mod estimate;
mod exr;
mod hdr;
mod header;
mod impostor;
mod ktx;
mod layers;
mod motion;
mod notes;
mod places;
mod png;
mod sky_map;
mod sprite;
mod studio;
mod vdb;
mod vol;

pub use bleed::bled;
pub use camera::{write_camera, write_moving_camera};
pub use estimate::{Earlier, read_estimate, write_estimate, write_estimate_noted};
pub use exr::{write_beauty, write_beauty_noted, write_named};
pub use hdr::write_hdr;
pub use header::{ColorSpace, Header, Shutter};
pub use impostor::{Around, impostor};
pub use ktx::write_ktx2;
pub use layers::{LayerKind, Layered, write_layers, write_layers_of};
pub use motion::{Motion, turning};
pub use notes::Notes;
pub use png::{opaque_of, read_rgb, write_grey, write_png, write_png_noted};
pub use sky_map::{FACES, cube_faces, equirectangular, meter_around};
pub use sprite::{Course, EDGES, SIDES, Subject};
pub use studio::{Shot, Studio};
pub use vdb::{VdbOptions, write_vdb, write_vdb_with};
pub use vol::write_vol;

pub use crate::render::Picture;
