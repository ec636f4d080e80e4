//! What other programs made: cameras, meshes to be filled with ellipsoids, and volumes.

mod bytes;
mod camera;
mod fill;
mod gltf;
mod inside;
mod mesh;
mod netcdf;
mod obj;
mod raw;
mod vdb;
mod vol;
mod volume;

pub use camera::{MovingCamera, read_camera};
pub use fill::{Filled, fill};
pub use inside::Inside;
pub use mesh::{Mesh, read_mesh};
pub use netcdf::species_of;
pub use raw::Raw;
pub use volume::{Choice, Found, choose, found_in, parse_volume, read_volume};
pub(crate) use volume::{times_in, velocity_in};
