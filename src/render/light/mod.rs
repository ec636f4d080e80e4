//! What the cloud receives: models of the light inside clouds, and what they read, which is prepared
//! in each cloud's own frame and redone only when the sun, the shape or the noise changed.

mod around;
mod boxes;
mod bricks;
mod field;
mod inputs;
mod model;
mod models;
mod moment;
mod occluders;
mod openness;
mod plan;
mod prepare;
mod shading;
#[cfg(feature = "slabs")]
mod slab_tables;
mod slack;
mod store;
mod sun;

#[cfg(test)]
pub(crate) use around::AroundUniform;
pub use boxes::LightBox;
#[cfg(test)]
pub(crate) use bricks::BRICK;
#[cfg(test)]
pub use field::FieldUniform;
pub(super) use inputs::Inputs;
pub use model::Transport;
pub(super) use moment::Clouds;
pub(super) use occluders::{Occluders, begins_before};
#[cfg(test)]
pub use prepare::LightUniform;
pub(super) use prepare::{Binding, CloudLight};
#[cfg(feature = "slabs")]
pub use slab_tables::{DirectTextures, FunctionTextures};
pub(super) use store::{LightStore, Presence, Request};
