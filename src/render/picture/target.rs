//! Where pictures go: the caller's textures, or layers of light.

use super::Matte;
use crate::frame::CameraUniform;

/// Where a picture goes.
pub struct Target<'a> {
    /// A view of a linear texture of the renderer's format and the frame's size. What it
    /// holds stays behind the clouds.
    pub color: &'a wgpu::TextureView,
    /// What the caller drew there before: clouds end at it.
    pub depth: Option<SceneDepth<'a>>,
    /// Whether to draw the sky first, over everything.
    pub sky: bool,
}

/// A depth buffer of the caller's, drawn with the frame's camera: perspective, or
/// orthographic with a finite far plane.
pub struct SceneDepth<'a> {
    /// A view of a depth texture, depth aspect, that can be sampled.
    pub view: &'a wgpu::TextureView,
    /// Distance of the near plane, m.
    pub near: f32,
    /// Distance of the far plane, m; may be infinite.
    pub far: f32,
    /// Whether depth is 1 at the near plane and 0 at the far one.
    pub reversed: bool,
}

impl SceneDepth<'_> {
    /// (x, y, z) such that the distance along the view axis is x / (y + z depth), or
    /// x + y depth for an orthographic camera.
    pub(in crate::render) fn coefficients(&self, camera: &CameraUniform) -> [f32; 4] {
        let (near, far) = (self.near, self.far);
        if camera.projection == CameraUniform::ORTHOGRAPHIC {
            let (zero, one) = if self.reversed { (far, near) } else { (near, far) };
            return [zero, one - zero, 0.0, 0.0];
        }
        // 1/distance is linear in depth: 1/near at the near plane, 1/far at the far one.
        let (zero, one) = if self.reversed { (1.0 / far, 1.0 / near) } else { (1.0 / near, 1.0 / far) };
        [1.0, zero, one - zero, 0.0]
    }
}

/// The light of one sun apart, all premultiplied by the alpha in their fourth channel: its part of
/// beauty = sky (1 - alpha) + single + multiple + ambient + air.
pub struct LightLayers {
    /// Sky, sun and ground without clouds.
    pub sky: wgpu::Texture,
    /// Its light scattered once in the clouds.
    pub single: wgpu::Texture,
    /// Its light scattered more often.
    pub multiple: wgpu::Texture,
    /// Light of the sky and the ground that it lights, and of a sky with light of its own, scattered in the clouds.
    pub ambient: wgpu::Texture,
    /// Light scattered by the air in front of the clouds.
    pub air: wgpu::Texture,
}

impl LightLayers {
    /// Views of those that clouds are drawn into, in the order of the shader's outputs.
    pub(super) fn of_clouds(&self) -> [wgpu::TextureView; 4] {
        [&self.single, &self.multiple, &self.ambient, &self.air].map(super::view)
    }
}

/// The light of a picture apart.
pub struct Layers {
    /// Of the sun, and of a sky with light of its own.
    pub sun: LightLayers,
    /// Of each further light that shines, by its name: the whole picture is the sum.
    pub lights: Vec<(String, LightLayers)>,
    /// Distance of the clouds in kilometres, in the first three channels.
    pub distance: wgpu::Texture,
    /// Which way the clouds face: a unit vector of the world where alpha is 1.
    pub normal: wgpu::Texture,
    /// Each cloud by itself, far ones first, where they were asked for.
    pub mattes: Vec<Matte>,
    /// What 1 stands for in those of light: [`Frame::unit`](crate::render::Frame::unit).
    pub unit: f32,
}
