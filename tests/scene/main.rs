//! What needs no graphics adapter: scenes, files, optics and tables.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod depth;
mod growth;
mod imports;
mod imports_gltf;
mod layers;
#[cfg(feature = "import")]
mod les;
#[cfg(feature = "import")]
mod meshes;
mod optics;
mod particles;
#[cfg(feature = "import")]
mod points;
mod presets;
#[cfg(all(feature = "export", feature = "import"))]
#[path = "../common/readers.rs"]
#[allow(dead_code, reason = "each binary of tests has its own readers")]
mod readers;
mod scene;
mod scene_geometry;
#[cfg(feature = "import")]
mod sequences;
mod shaders;
mod slab;
mod slab_tables;
mod timeline;
#[cfg(feature = "import")]
mod volumes;
