//! Models of the light inside clouds.

/// How light inside a cloud is found. The order is that of the constants in
/// `shaders/clouds.wgsl`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Transport {
    /// As Max (1994): the cloud glows by itself, as brightly where it is opaque as the mean of
    /// the light that falls on it, and dims what is behind. No shadows.
    Emitter,
    /// Sunlight scattered once, and the light of sky and ground.
    Single,
    /// The same, and two octaves of it for sunlight scattered more often, as Wrenninge (2013)
    /// and Hillaire (2016): each half as bright, half as directed and half as shadowed as the
    /// one before.
    Octaves,
    /// Single scattering, and sunlight scattered more often as in a slab fitted to the cloud,
    /// in the closed form of delta-Eddington.
    DeltaEddington,
    /// The same from tables of slabs: each set of orders of scattering has the slab that fits
    /// the cloud over the spread of its light, and light that keeps its direction but for
    /// small angles is told apart.
    Slab,
    /// As Kol (2013): one slab at one point of a ray, for all orders, from the sun maps at one
    /// level of detail everywhere.
    SlabKol,
    /// As Bouthors (2008): a slab for each set of orders, under the area where its light
    /// entered, found by iteration. Slow.
    SlabBouthors,
    /// From moments of the light in the cloud, solved for on a grid, and light that keeps
    /// its direction but for small angles in closed form.
    #[default]
    Moments,
}

impl Transport {
    /// Names and values.
    pub const ALL: [(&'static str, Self); 8] = [
        ("emitter", Self::Emitter),
        ("single", Self::Single),
        ("octaves", Self::Octaves),
        ("delta-eddington", Self::DeltaEddington),
        ("slab", Self::Slab),
        ("slab-kol", Self::SlabKol),
        ("slab-bouthors", Self::SlabBouthors),
        ("moments", Self::Moments),
    ];

    /// Whether the light inside a cloud depends on how open it is, where sky and ground give
    /// light and where they don't.
    pub(super) fn needs_openness(self, sky_lights: bool) -> bool {
        match self {
            Self::Emitter | Self::Moments => false,
            Self::Single | Self::Octaves => sky_lights,
            _ => true,
        }
    }

    /// Whether light is that of slabs, which are fitted to the maps that are seen from the sun.
    pub(super) fn needs_maps(self) -> bool {
        matches!(self, Self::DeltaEddington | Self::Slab | Self::SlabKol | Self::SlabBouthors)
    }
}
