//! What other programs made: cameras, meshes and clouds of points to be filled with ellipsoids, and volumes.

mod bytes;
mod camera;
mod fill;
mod gltf;
mod inside;
mod mesh;
mod netcdf;
mod obj;
mod points;
mod raw;
mod vdb;
mod vol;
mod volume;

pub use camera::{MovingCamera, read_camera};
pub use fill::{Filled, fill, fill_points};
pub use inside::Inside;
pub use mesh::{Mesh, read_mesh};
pub use netcdf::species_of;
pub use points::{Point, is_of_points, parse_points, read_points};
pub use raw::Raw;
pub use volume::{Choice, Found, choose, found_in, parse_volume, read_volume};
pub(crate) use volume::{times_in, velocity_in};
