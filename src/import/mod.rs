//! What other programs made: cameras, meshes to be filled with ellipsoids, and volumes.

#[cfg(feature = "import")]
mod bytes;
#[cfg(feature = "import")]
mod camera;
#[cfg(feature = "import")]
mod fill;
#[cfg(feature = "import")]
mod gltf;
mod grid;
#[cfg(feature = "import")]
mod inside;
#[cfg(feature = "import")]
mod mesh;
#[cfg(feature = "import")]
mod netcdf;
#[cfg(feature = "import")]
mod obj;
#[cfg(feature = "import")]
mod raw;
#[cfg(feature = "import")]
mod vdb;
#[cfg(feature = "import")]
mod vol;
#[cfg(feature = "import")]
mod volume;

#[cfg(feature = "import")]
pub use camera::{MovingCamera, read_camera};
#[cfg(feature = "import")]
pub use fill::{Filled, fill};
pub(crate) use grid::voxel;
pub use grid::{Grid, MOST_ALONG};
#[cfg(feature = "import")]
pub use inside::Inside;
#[cfg(feature = "import")]
pub use mesh::{Mesh, read_mesh};
#[cfg(feature = "import")]
pub use raw::Raw;
#[cfg(feature = "import")]
pub use volume::{Choice, Found, found_in, parse_volume, read_volume};
