// The camera: from a place on the picture to a ray. Directions are those of the
// world; origins are relative to the camera's position.
// @use constants

const PERSPECTIVE: u32 = 0u;
const ORTHOGRAPHIC: u32 = 1u;
const EQUIRECTANGULAR: u32 = 2u;

struct Camera {
    // Half the picture's width and height as vectors: per unit of distance for a
    // perspective camera, in metres for an orthographic one, unit vectors for an
    // equirectangular one.
    right: vec3f,
    projection: u32,
    up: vec3f,
    // Metres above the ground.
    altitude: f32,
    // The line of sight in the middle of the picture; a unit vector for all but perspective cameras.
    forward: vec3f,
    // Angle of a pixel at the centre, rad; metres for an orthographic camera.
    pixel: f32,
    // At right angles to the picture, which `forward` is not where the lens is shifted; a unit vector.
    axis: vec3f,
    // 1 where pixels are offset by a fixed blue-noise-like pattern, else 0.
    jitter: f32,
    size: vec2f,
    padding: vec2f,
}

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

// The ray through `ndc`, x to the right and y up, both from -1 to 1.
fn camera_ray(camera: Camera, ndc: vec2f) -> Ray {
    let across = ndc.x * camera.right + ndc.y * camera.up;
    if camera.projection == ORTHOGRAPHIC {
        return Ray(across, camera.forward);
    }
    if camera.projection == EQUIRECTANGULAR {
        let azimuth = ndc.x * PI;
        let elevation = 0.5 * ndc.y * PI;
        let level = sin(azimuth) * camera.right + cos(azimuth) * camera.forward;
        return Ray(vec3f(0.0), cos(elevation) * level + sin(elevation) * camera.up);
    }
    return Ray(vec3f(0.0), normalize(camera.forward + across));
}

// Normalised device coordinates of the centre of a pixel, row 0 on top.
fn pixel_ndc(camera: Camera, pixel: vec2f) -> vec2f {
    let uv = pixel / camera.size;
    return vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
}

// Distance along a ray in this direction of what has this value in a depth buffer: `scale` is what the
// caller's projection does, for a perspective distance = x / (y + z depth) along the view axis.
fn depth_distance(camera: Camera, scale: vec4f, depth: f32, direction: vec3f) -> f32 {
    let d = scale;
    let axial = select(d.x / max(d.y + d.z * depth, 1e-20), d.x + d.y * depth, camera.projection == ORTHOGRAPHIC);
    return axial / max(dot(direction, camera.axis), 1e-6);
}

// Width in metres of what a pixel sees at distance `t`.
fn pixel_footprint(camera: Camera, t: f32) -> f32 {
    return select(camera.pixel * t, camera.pixel, camera.projection == ORTHOGRAPHIC);
}
