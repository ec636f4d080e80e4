//! What other programs made: cameras, and meshes to be filled with ellipsoids.

mod camera;
mod fill;
mod gltf_file;
mod inside;
mod mesh;

pub use camera::read_camera;
pub use fill::{Filled, fill};
pub use inside::Inside;
pub use mesh::{Mesh, read_mesh};
