//! What the sky is to look like, from the scene: the uniforms of its shaders.

use glam::{DVec3, Vec3};

use crate::scene::{self, Scene};

/// Where the light on clouds is gathered in a scene without clouds, metres.
const LIGHT_ALTITUDE: f64 = 1000.0;
/// Steps of that altitude, m.
const LIGHT_STEP: f64 = 25.0;
/// Reach of the aerial volume, metres, and where there are layers, which go on to the horizon.
pub(crate) const AERIAL_REACH: f32 = 60e3;
const LAYER_REACH: f32 = 350e3;

/// `Atmosphere` of `shaders/lib/air.wgsl`, which has the units.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[allow(missing_docs, reason = "the shader's struct has the one description")]
pub struct AtmosphereUniform {
    pub rayleigh: Vec3,
    pub rayleigh_height: f32,
    pub ozone: Vec3,
    pub ozone_altitude: f32,
    pub ground_albedo: Vec3,
    pub ozone_half_width: f32,
    pub mie_scattering: f32,
    pub mie_extinction: f32,
    pub mie_height: f32,
    pub mie_g: f32,
    pub ground_radius: f32,
    pub thickness: f32,
    pub sun_radius: f32,
    padding: f32,
}

impl AtmosphereUniform {
    /// The Earth's, with Bruneton's parameters of 2017 at 680, 550 and 440 nm as Hillaire
    /// (2020, table 1) gives them; aerosol has the albedo and the asymmetry of clean continental air
    /// at 550 nm (Hess, Koepke and Schult 1998, table 4: 0.972 and 0.709). `haze` and `ozone`
    /// multiply what there is of them; `sun_radius` is the angular radius of the sun's disc, rad.
    pub fn earth(haze: f32, ozone: f32, ground_albedo: Vec3, sun_radius: f32) -> Self {
        Self {
            rayleigh: Vec3::new(5.802e-6, 13.558e-6, 33.1e-6),
            rayleigh_height: 8e3,
            ozone: ozone * Vec3::new(0.650e-6, 1.881e-6, 0.085e-6),
            ozone_altitude: 25e3,
            ground_albedo,
            ozone_half_width: 15e3,
            mie_scattering: haze * 4.316e-6,
            mie_extinction: haze * 4.440e-6,
            mie_height: 1.2e3,
            mie_g: 0.7,
            ground_radius: 6360e3,
            thickness: 100e3,
            sun_radius,
            padding: 0.0,
        }
    }
}

/// `Sky` of `shaders/lib/atmosphere.wgsl`, which has the units.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[allow(missing_docs, reason = "the shader's struct has the one description")]
pub struct SkyUniform {
    pub atmosphere: AtmosphereUniform,
    pub to_sun: Vec3,
    pub light_altitude: f32,
    pub irradiance: Vec3,
    pub aerial_reach: f32,
    pub radiance: Vec3,
    padding: f32,
}

/// What the sky is to look like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkySettings {
    /// Is there an atmosphere? Otherwise the sky has the same `radiance` everywhere.
    pub atmosphere: bool,
    /// What the shaders read.
    pub uniform: SkyUniform,
}

impl SkySettings {
    /// The sky of a validated scene with the sun in direction `to_sun`. The light that
    /// falls on clouds is that at half their height, to 25 m: all of it would have to be made
    /// again for a cloud that has risen by a metre.
    pub fn new(scene: &Scene, to_sun: DVec3) -> Self {
        let sun_radius = (0.5 * scene.sun.angular_diameter_deg.to_radians()) as f32;
        let (air, radiance) = match &scene.sky {
            scene::Sky::Atmosphere(air) => (Some(air.clone()), [0.0; 3]),
            scene::Sky::Uniform { radiance } => (None, *radiance),
            scene::Sky::None => (None, [0.0; 3]),
        };
        let has_air = air.is_some();
        let air = air.unwrap_or_default();
        let rounded = |altitude: f64| LIGHT_STEP * (altitude / LIGHT_STEP).round();
        let has_layers = scene.layers().next().is_some();
        let middle = middle(scene).map(|altitude| altitude - scene.ground.altitude);
        Self {
            atmosphere: has_air,
            uniform: SkyUniform {
                atmosphere: AtmosphereUniform::earth(
                    air.haze as f32,
                    air.ozone as f32,
                    vec3(scene.ground.albedo),
                    sun_radius,
                ),
                to_sun: to_sun.as_vec3(),
                light_altitude: rounded(middle.unwrap_or(LIGHT_ALTITUDE)).max(0.0) as f32,
                irradiance: vec3(scene.sun.irradiance),
                aerial_reach: if has_layers { LAYER_REACH } else { AERIAL_REACH },
                radiance: vec3(radiance),
                padding: 0.0,
            },
        }
    }
}

/// Half the height of all clouds, m; of layers where there are no others.
fn middle(scene: &Scene) -> Option<f64> {
    let heights = || {
        let all = scene.layers().map(|layer| (layer.base, layer.base + layer.thickness));
        all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    let ends = scene.bounds().map(|(low, high)| (low.y, high.y));
    ends.or_else(heights).map(|(low, high)| 0.5 * (low + high))
}

fn vec3(rgb: [f64; 3]) -> Vec3 {
    Vec3::from_array(rgb.map(|channel| channel as f32))
}
