//! What the ground looks like, from the scene: its kind and the uniform of its shader.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};

use crate::{
    gpu::Role,
    scene::{GroundColors, GroundKind},
};

/// Fields along an edge of the pattern of land.
pub(crate) const FIELDS: usize = 32;
/// Squares of the pattern along what repeats itself: it is used so many times as large, too.
pub(crate) const LARGER: u32 = 8;
/// What 1 in the pattern's texture stands for, over the mean.
pub(crate) const PATTERN_SCALE: f32 = 4.0;

/// `Ground` of `shaders/lib/ground.wgsl`, which has the units.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[allow(missing_docs, reason = "the shader's struct has the one description")]
pub struct GroundUniform {
    pub offset: Vec2,
    pub edge: f32,
    pub variation: f32,
    pub slope_variance: f32,
    pub height: f32,
}

/// Which module draws the ground.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum GroundShader {
    /// The same everywhere, which the table of the sky has already.
    #[default]
    Even,
    /// Fields and woods.
    Land,
    /// Water under wind.
    Water,
    /// A picture from above.
    Picture,
}

/// What the ground looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundSettings {
    /// Its kind.
    pub shader: GroundShader,
    /// What its shader reads.
    pub uniform: GroundUniform,
    /// Of a picture.
    pub colors: Option<Arc<GroundColors>>,
}

impl GroundShader {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Even, Self::Land, Self::Water, Self::Picture];

    /// What fills the role `ground_kind` of shaders.
    pub fn role(self) -> Role<'static> {
        let source = match self {
            Self::Even => include_str!("../../shaders/ground/even.wgsl"),
            Self::Land => include_str!("../../shaders/ground/land.wgsl"),
            Self::Water => include_str!("../../shaders/ground/water.wgsl"),
            Self::Picture => include_str!("../../shaders/ground/picture.wgsl"),
        };
        ("ground_kind", source)
    }
}

impl GroundSettings {
    /// Ground of a validated scene, seen from `camera`. Land of no variation is even.
    pub fn new(kind: &GroundKind, camera: DVec3) -> Self {
        let mut settings = Self {
            shader: GroundShader::Even,
            uniform: GroundUniform {
                offset: Vec2::ZERO,
                edge: 1.0,
                variation: 0.0,
                slope_variance: 1.0,
                height: 1.0,
            },
            colors: None,
        };
        let uniform = &mut settings.uniform;
        match kind {
            GroundKind::Even => {}
            GroundKind::Land(land) if land.variation == 0.0 => {}
            GroundKind::Land(land) => {
                let edge = FIELDS as f64 * land.field_width;
                let place = |x: f64| x.rem_euclid(f64::from(LARGER) * edge) as f32;
                settings.shader = GroundShader::Land;
                uniform.offset = Vec2::new(place(camera.x), place(camera.z));
                (uniform.edge, uniform.variation) = (edge as f32, land.variation as f32);
            }
            GroundKind::Picture(picture) => {
                let Some(colors) = picture.colors() else { return settings };
                let [columns, rows] = colors.size();
                let height = picture.width * rows as f64 / columns as f64;
                settings.shader = GroundShader::Picture;
                uniform.offset = DVec2::new(
                    camera.x - picture.x + 0.5 * picture.width,
                    camera.z - picture.z + 0.5 * height,
                )
                .as_vec2();
                (uniform.edge, uniform.height) = (picture.width as f32, height as f32);
                settings.colors = Some(colors.clone());
            }
            GroundKind::Water(water) => {
                settings.shader = GroundShader::Water;
                uniform.slope_variance = slope_variance(water.wind) as f32;
            }
        }
        settings
    }
}

/// Variance of the slopes of a sea under a wind of so many metres per second, along both axes together (Cox and Munk
/// 1954, of a clean sea: 0.003 + 0.00512 a metre per second, standard error 0.004).
fn slope_variance(wind: f64) -> f64 {
    0.003 + 0.00512 * wind
}
