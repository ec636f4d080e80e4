//! What draws: every pass and picture against closed forms, references and truth, on one device for all.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod apart;
mod atmosphere;
mod bench;
mod bodies;
mod cameras;
#[path = "../common/mod.rs"]
mod common;
mod exposure;
mod extremes;
mod frames;
mod ground;
mod land_and_water;
mod layers;
mod light_turns;
mod lights;
mod march;
mod media;
mod meshes;
mod mixed;
mod mixtures;
mod moments;
mod noise;
mod pieces;
mod presets_render;
mod random_scenes;
mod shadows;
mod skies;
mod skipping;
mod sky;
mod slab_render;
mod slab_shader;
mod species;
mod sprites;
mod transports;
mod truth;
mod truth_laws;
mod truth_peak;
mod truth_sampling;
mod units;
mod volumes;
mod volumes_drawn;
mod volumes_in;
mod volumes_over_time;
