//! What the viewport is to show.

use std::sync::Arc;

use super::{settings::Layer, stage::Stage};
use crate::{
    Result,
    render::Frame,
    scene::{Camera, Cloud, Scene, ToneCurve},
};

/// What is to be seen.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The scene; its own camera, how it is toned and its name do not count.
    pub scene: Arc<Scene>,
    /// The viewport's camera.
    pub camera: Camera,
    /// Size of the viewport, pixels of the screen.
    pub size: [u32; 2],
    /// Which light.
    pub layer: Layer,
    /// Rays across a pixel of the final picture.
    pub rays: u32,
    /// What it is finished in.
    pub finest: Stage,
}

impl Subject {
    /// The scene as this viewport sees it.
    pub fn frame(&self, size: [u32; 2]) -> Result<Frame> {
        Frame::new(&self.scene.seen_by(self.camera.clone()), size)
    }

    pub(super) fn same_scene(&self, other: &Self) -> bool {
        if Arc::ptr_eq(&self.scene, &other.scene) {
            return true;
        }
        // Moments that look the same are the same: a timeline may play on and nothing move.
        let seen = |scene: &Scene| Scene {
            camera: None,
            exposure: 0.0,
            auto_exposure: None,
            tone_curve: ToneCurve::default(),
            name: String::new(),
            ..scene.at(scene.time).unwrap_or_else(|_| scene.clone())
        };
        seen(&self.scene) == seen(&other.scene) && grids(&self.scene).eq(grids(&other.scene))
    }

    pub(super) fn same_view(&self, other: &Self) -> bool {
        let rest = |subject: &Self| (subject.size, subject.layer, subject.rays, subject.finest);
        self.camera == other.camera && rest(self) == rest(other)
    }
}

/// What was read of the files of meshes and volumes, which scenes do not tell.
fn grids(scene: &Scene) -> impl Iterator<Item = Option<u64>> {
    scene.clouds.iter().map(Cloud::fingerprint)
}
