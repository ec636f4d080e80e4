//! How much work a picture gets. Presets are values; anyone can make another.

/// Numbers that trade error against time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// First step behind an edge, as a share of the boundary's thickness.
    pub first_step: f32,
    /// Growth of the steps from one to the next: logarithmic spacing.
    pub growth: f32,
    /// Longest step in a boundary, as a share of its thickness.
    pub longest_step: f32,
    /// A ray ends where a smaller share than this gets through.
    pub opaque: f32,
    /// What is seen of a ray, from 0 to 1, and has its sunlight found at once, at its two ends.
    pub lit_at_once: f32,
    /// Points of a ray at which diffuse light is found, 1 to 8.
    pub light_nodes: u32,
    /// Texels across the largest cloud's sun maps and light volume: a power of two.
    pub light_resolution: u32,
    /// Cells along the longest axis of the grid that light is solved for on.
    pub light_cells: u32,
    /// Texels along the edge of the map of the sun's light on ground and air.
    pub shadow_texels: u32,
    /// Most steps of a ray.
    pub max_steps: u32,
    /// Whether rays start at random fractions of a step, to trade bands for grain.
    pub jitter: bool,
}

impl Quality {
    /// While things move.
    pub const DRAFT: Self = Self {
        first_step: 0.16,
        growth: 1.3,
        longest_step: 0.5,
        opaque: 0.02,
        lit_at_once: 0.1,
        light_nodes: 2,
        light_resolution: 32,
        light_cells: 24,
        shadow_texels: 128,
        max_steps: 128,
        jitter: true,
    };
    /// For judging light and shape.
    pub const PREVIEW: Self = Self {
        first_step: 0.14,
        growth: 1.2,
        longest_step: 0.4,
        opaque: 0.01,
        lit_at_once: 0.05,
        light_nodes: 3,
        light_resolution: 64,
        light_cells: 56,
        shadow_texels: 256,
        max_steps: 256,
        jitter: true,
    };
    /// For keeping.
    pub const FINAL: Self = Self {
        first_step: 0.05,
        growth: 1.1,
        longest_step: 0.2,
        opaque: 0.003,
        lit_at_once: 0.03,
        light_nodes: 8,
        light_resolution: 128,
        light_cells: 64,
        shadow_texels: 512,
        max_steps: 768,
        jitter: false,
    };

    /// Names of the presets with their values.
    pub const PRESETS: [(&'static str, Self); 3] =
        [("draft", Self::DRAFT), ("preview", Self::PREVIEW), ("final", Self::FINAL)];
}

impl Default for Quality {
    fn default() -> Self {
        Self::FINAL
    }
}
