//! What other programs made: cameras, and meshes to be filled with ellipsoids.

mod camera;
mod fill;
mod gltf;
mod inside;
mod mesh;
mod obj;

pub use camera::{MovingCamera, read_camera};
pub use fill::{Filled, fill};
pub use inside::Inside;
pub use mesh::{Mesh, read_mesh};
