// What the march and the medium tell each other.

// A part of the medium, known by its list of what it is made of.
struct Region {
    first: u32,
    count: u32,
}

// What lies ahead on a ray, from a distance to the next boundary.
struct Stretch {
    end: f32,
    inside: bool,
    // Extinction where the stretch is homogeneous, else 0.
    core: f32,
    // Thinnest boundary of the ellipsoids here, m; less where the noise moves it by more than the
    // noise's own size, for then there is more than one edge in it.
    boundary: f32,
    // Body of the homogeneous stretch.
    body: u32,
}
