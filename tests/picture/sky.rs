//! The sky's tables and pictures: against f64, closed forms, and what everybody knows
//! of the sky. Also the twins of those functions of `shaders/lib/atmosphere.wgsl` that
//! read tables: `sun_irradiance_at`, `light_of_sky`, `aerial_perspective` directly;
//! `multiple_light`, `ground_irradiance`, `air_source`, `air_light` and `sky_radiance`
//! through the pictures that are made of nothing else.

use crate::common::{self, atmosphere as reference};

use std::f64::consts::PI;

use common::gpu;
use glam::{DVec3, Vec3};
use half::f16;
use nephos::gpu::{
    ComputeProgram, TextureDesc, link, read_buffer, read_texture, storage_buffer, texture, validate,
};
use nephos::scene::{Atmosphere, Camera, Ellipsoid, Projection, Scene, Sky as SceneSky, SunPosition};
use nephos::{
    frame::{AtmosphereUniform, CameraUniform, SkySettings, SkyUniform},
    render::{Redone, Sky},
};
use reference::{Air, GROUND, Multiple, Ray, Rgb};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A clear sky with the sun in the north.
fn scene(elevation_deg: f64) -> Scene {
    let mut scene = Scene::default();
    scene.sun.position = SunPosition::Angles { azimuth_deg: 0.0, elevation_deg };
    scene
}

/// A panorama, north in the middle, from `altitude` metres.
fn panorama(altitude: f64) -> Camera {
    let position = DVec3::new(0.0, altitude, 0.0);
    Camera {
        position,
        target: position + DVec3::NEG_Z,
        roll_deg: 0.0,
        projection: Projection::Equirectangular,
        ..Camera::default()
    }
}

struct Picture {
    width: u32,
    pixels: Vec<[f32; 4]>,
}

impl Picture {
    fn at(&self, x: u32, y: u32) -> [f32; 4] {
        self.pixels[(y * self.width + x) as usize]
    }
}

/// Prepares and draws.
fn draw(sky: &mut Sky, scene: &Scene, camera: &Camera, size: [u32; 2]) -> (Picture, Redone) {
    let gpu = gpu();
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
    let target = texture(
        &gpu.device,
        &TextureDesc { label: "picture", size: [size[0], size[1], 0], mips: 1, format: FORMAT, usage },
    );
    let camera = CameraUniform::new(camera, scene.ground.altitude, size);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let redone = sky.prepare(
        &gpu.device,
        &gpu.queue,
        &mut encoder,
        &SkySettings::new(scene, scene.sun.to_sun()),
        &camera,
        None,
    );
    sky.draw(&gpu.device, &mut encoder, &target.create_view(&Default::default()), FORMAT, None);
    gpu.queue.submit([encoder.finish()]);
    (Picture { width: size[0], pixels: texels(&target) }, redone)
}

fn texels(texture: &wgpu::Texture) -> Vec<[f32; 4]> {
    let bytes = read_texture(gpu(), texture, 0).expect("reads back");
    let halves: &[f16] = bytemuck::cast_slice(&bytes);
    halves.as_chunks().0.iter().map(|texel: &[f16; 4]| texel.map(f16::to_f32)).collect()
}

fn new_sky() -> Sky {
    Sky::new(&gpu().device)
}

/// Evaluates WGSL that sees the uniform `sky`, the tables and the input `x`.
fn with_tables(sky: &Sky, body: &str, inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let source = format!(
        "// @use atmosphere
        @group(0) @binding(0) var<uniform> sky: Sky;
        @group(0) @binding(1) var transmittance: texture_2d<f32>;
        @group(0) @binding(2) var light: texture_2d<f32>;
        @group(0) @binding(3) var volume: texture_3d<f32>;
        @group(0) @binding(4) var linear_sampler: sampler;
        @group(0) @binding(5) var<storage, read_write> values: array<vec4f>;
        fn evaluate(x: vec4f) -> vec4f {{ {body} }}
        @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3u) {{
            // Keeps all bindings in the layout.
            let all = f32(textureDimensions(transmittance).x + textureDimensions(light).x + textureDimensions(volume).x)
                + sky.padding + textureSampleLevel(light, linear_sampler, vec2f(0.5), 0.0).x;
            values[id.x] = select(evaluate(values[id.x]), vec4f(0.0), all < 0.0);
        }}"
    );
    let gpu = gpu();
    let values = storage_buffer(&gpu.device, "values", inputs);
    let program = ComputeProgram::from_source(&gpu.device, "tables", link(&source, &[]));
    let group = program.bind(
        &gpu.device,
        &[
            Some(sky.atmosphere().as_entire_binding()),
            Some(wgpu::BindingResource::TextureView(sky.transmittance())),
            Some(wgpu::BindingResource::TextureView(sky.sky_light())),
            Some(wgpu::BindingResource::TextureView(sky.aerial())),
            Some(wgpu::BindingResource::Sampler(sky.sampler())),
            Some(values.as_entire_binding()),
        ],
    );
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    program.dispatch(&mut encoder, &[&group], [inputs.len() as u32, 1, 1], None);
    gpu.queue.submit([encoder.finish()]);
    read_buffer(gpu, &values).expect("reads back")
}

fn sun_at(sky: &Sky, altitude: f32, elevation_deg: f32) -> [f32; 4] {
    let body =
        "return vec4f(sun_irradiance_at(sky.atmosphere, transmittance, linear_sampler, x.x, x.y), 0.0);";
    with_tables(sky, body, &[[altitude, elevation_deg.to_radians().sin(), 0.0, 0.0]])[0]
}

fn relative_error(got: [f32; 4], want: Rgb) -> f64 {
    (0..3).map(|c| (f64::from(got[c]) - want[c]).abs() / want[c].max(1e-30)).fold(0.0, f64::max)
}

#[test]
fn the_uniforms_are_laid_out_as_the_shader_has_them() {
    let module = validate(&link("// @use atmosphere\n", &[])).expect("valid");
    let offset = |structure: &str, member: &str| {
        let (_, found) =
            module.types.iter().find(|(_, t)| t.name.as_deref() == Some(structure)).expect("exists");
        let wgpu::naga::TypeInner::Struct { members, .. } = &found.inner else { panic!("no struct") };
        members.iter().find(|m| m.name.as_deref() == Some(member)).expect("has it").offset as usize
    };
    macro_rules! same {
        ($name:literal, $type:ty: $($field:ident)*) => {
            $(assert_eq!(offset($name, stringify!($field)), std::mem::offset_of!($type, $field));)*
        };
    }
    same!("Atmosphere", AtmosphereUniform: rayleigh rayleigh_height ozone ozone_altitude ground_albedo
        ozone_half_width mie_scattering mie_extinction mie_height mie_g ground_radius thickness sun_radius);
    same!("Sky", SkyUniform: atmosphere to_sun light_altitude irradiance aerial_reach radiance);
}

#[test]
fn the_transmittance_table_holds_the_reference() {
    let mut sky = new_sky();
    draw(&mut sky, &scene(30.0), &panorama(2.0), [8, 4]);
    let table = sky.transmittance().texture();
    let (width, height) = (table.width(), table.height());
    let texels = texels(table);
    let whole = (100e3f64 * (2.0 * GROUND + 100e3)).sqrt();
    for y in (0..height).step_by(7) {
        for x in (0..width).step_by(15) {
            let rho = whole * f64::from(y) / f64::from(height - 1);
            let r = (GROUND * GROUND + rho * rho).sqrt();
            let near = reference::TOP - r;
            let d = near + f64::from(x) / f64::from(width - 1) * (rho + whole - near);
            let mu = if d < 1e-3 {
                1.0
            } else {
                ((whole * whole - rho * rho - d * d) / (2.0 * r * d)).clamp(-1.0, 1.0)
            };
            let want = Air::EARTH.transmittance(r, mu);
            let got = texels[(y * width + x) as usize];
            for c in 0..3 {
                // 48 midpoint steps and the rounding to half floats.
                let error = (f64::from(got[c]) - want[c]).abs();
                assert!(error < 1e-3, "texel {x} {y} channel {c}: {} but {}", got[c], want[c]);
            }
        }
    }
}

#[test]
fn sun_irradiance_at_agrees_between_texels_and_sets_smoothly() {
    let mut sky = new_sky();
    draw(&mut sky, &scene(30.0), &panorama(2.0), [8, 4]);
    for altitude in [0.0, 300.0, 2500.0, 12e3] {
        for elevation in [1.0, 3.0, 7.0, 20.0, 45.0, 89.0f32] {
            let got = sun_at(&sky, altitude, elevation);
            let want = Air::EARTH.sun(GROUND + f64::from(altitude), f64::from(elevation.to_radians().sin()));
            for c in 0..3 {
                // Bilinear between 256 by 64 texels.
                assert!(
                    (f64::from(got[c]) - want[c]).abs() < 3e-3,
                    "{altitude} {elevation}: {got:?} {want:?}"
                );
            }
        }
    }
    let setting: Vec<f32> = (0..40).map(|i| sun_at(&sky, 0.0, 0.5 - 0.025 * i as f32)[0]).collect();
    assert!(setting.windows(2).all(|pair| pair[1] <= pair[0]), "{setting:?}");
    assert_eq!(setting[39], 0.0);
    // No step larger than a tenth of what is left at the horizon.
    assert!(setting.windows(2).all(|pair| pair[0] - pair[1] < 0.15 * setting[0]), "{setting:?}");
}

#[test]
fn a_low_sun_is_redder_and_dimmer() {
    let mut sky = new_sky();
    draw(&mut sky, &scene(30.0), &panorama(2.0), [8, 4]);
    let (low, high) = (sun_at(&sky, 0.0, 1.0), sun_at(&sky, 0.0, 45.0));
    assert!(low[0] / low[2] > 10.0 * high[0] / high[2], "{low:?} {high:?}");
    assert!(low[0] < high[0] && high[2] < high[1] && high[1] < high[0]);
    let above = sun_at(&sky, 1e5, 45.0);
    assert!(above[..3].iter().all(|t| (0.999..=1.001).contains(t)), "{above:?}");
}

/// Directions of a panorama's pixels, off the sun, as the reference has them.
fn panorama_ray(altitude: f64, elevation_deg: f64, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> Ray {
    let azimuth = (2.0 * (f64::from(x) + 0.5) / f64::from(width) - 1.0) * PI;
    let elevation = (0.5 - (f64::from(y) + 0.5) / f64::from(height)) * PI;
    Ray::new(GROUND + altitude, elevation.sin(), elevation_deg.to_radians().sin(), azimuth)
}

/// `tolerance` is what 32 steps, bilinear tables and half floats may differ from hundreds
/// of steps and no tables; twice what was measured.
fn compare_panoramas(haze: f64, albedo: Rgb, elevations: &[f64], altitudes: &[f64], tolerance: f64) {
    let air = Air { haze, albedo, ..Air::EARTH };
    let multiple = Multiple::new(&air);
    let size = [64, 32];
    let mut sky = new_sky();
    let mut worst: f64 = 0.0;
    for &elevation in elevations {
        for &altitude in altitudes {
            let mut scene = scene(elevation);
            scene.sky = SceneSky::Atmosphere(Atmosphere { haze, ozone: 1.0 });
            scene.ground.albedo = albedo;
            // Dusk is too dark for the half floats of the picture.
            scene.sun.irradiance = [1e3; 3];
            let (picture, _) = draw(&mut sky, &scene, &panorama(altitude), size);
            // Columns 31 and 32 hold the sun; the rows at the horizon are half of each.
            for pixel in [
                [34, 2],
                [36, 9],
                [40, 12],
                [33, 14],
                [45, 14],
                [63, 14],
                [63, 4],
                [50, 18],
                [35, 22],
                [60, 31],
            ] {
                let ray = panorama_ray(altitude, elevation, pixel, size);
                let want = reference::sky_radiance(&air, &multiple, ray);
                let got = picture.at(pixel[0], pixel[1]).map(|light| 1e-3 * light);
                let error = relative_error(got, want);
                worst = worst.max(error);
                assert!(error < tolerance, "sun {elevation}, {altitude} m, {pixel:?}: {got:?} but {want:?}");
            }
        }
    }
    eprintln!("haze {haze}: worst relative error {worst:.3}");
}

#[test]
fn clear_skies_agree_with_the_reference() {
    compare_panoramas(1.0, [0.1, 0.2, 0.3], &[60.0, 20.0, 4.0], &[2.0, 3e3], 0.03);
}

#[test]
fn dusk_agrees_with_the_reference() {
    compare_panoramas(1.0, [0.0; 3], &[-3.0], &[2.0], 0.03);
}

#[test]
fn hazy_skies_agree_with_the_reference() {
    compare_panoramas(8.0, [0.1; 3], &[35.0], &[2.0], 0.015);
}

#[test]
fn the_zenith_is_bluer_and_darker_than_the_horizon() {
    let mut sky = new_sky();
    for elevation in [15.0, 40.0, 70.0] {
        let mut scene = scene(elevation);
        // Haze whitens all about a high sun.
        scene.sky = SceneSky::Atmosphere(Atmosphere { haze: 1.0, ozone: 1.0 });
        let (picture, _) = draw(&mut sky, &scene, &panorama(2.0), [64, 64]);
        let (zenith, horizon) = (picture.at(0, 1), picture.at(0, 30));
        assert!(zenith[2] / zenith[0] > 1.5 * horizon[2] / horizon[0], "{zenith:?} {horizon:?}");
        assert!(zenith[1] < horizon[1]);
        assert!(zenith[2] > zenith[1] && zenith[1] > zenith[0]);
    }
}

#[test]
fn every_sun_and_altitude_gives_finite_light() {
    let mut sky = new_sky();
    for elevation in [-90.0, -20.0, -6.0, -1.0, 0.0, 0.2, 5.0, 45.0, 90.0] {
        for altitude in [-100e3, -1.0, 0.0, 0.1, 20e3, 99.9e3, 100e3, 400e3, 1e7] {
            let (picture, _) = draw(&mut sky, &scene(elevation), &panorama(altitude), [32, 32]);
            for pixel in &picture.pixels {
                assert!(
                    pixel.iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{elevation} {altitude}: {pixel:?}"
                );
                assert_eq!(pixel[3], 1.0);
            }
            let tables = [sky.transmittance(), sky.sky_light(), sky.aerial()];
            for texel in tables.iter().flat_map(|view| texels(view.texture())) {
                assert!(
                    texel.iter().all(|v| v.is_finite() && *v >= 0.0),
                    "{elevation} {altitude}: {texel:?}"
                );
            }
        }
    }
}

#[test]
fn extremes_of_haze_ozone_and_albedo_give_finite_light() {
    let mut sky = new_sky();
    for (haze, ozone, albedo) in [(0.0, 0.0, 1.0), (20.0, 20.0, 1.0), (20.0, 0.0, 0.0)] {
        let mut scene = scene(3.0);
        scene.sky = SceneSky::Atmosphere(Atmosphere { haze, ozone });
        scene.ground.albedo = [albedo; 3];
        scene.sun.irradiance = [1e6; 3];
        let (picture, _) = draw(&mut sky, &scene, &panorama(10.0), [32, 32]);
        assert!(picture.pixels.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
    }
}

#[test]
fn pure_air_over_white_ground_gives_all_light_back() {
    // Nothing absorbs: what falls in at the top leaves there. Not all of it: the series
    // of higher orders leaves out light that comes back from the ground once more, which
    // over snow is a tenth in the blue.
    let mut sky = new_sky();
    let mut scene = scene(80.0);
    scene.sky = SceneSky::Atmosphere(Atmosphere { haze: 0.0, ozone: 0.0 });
    scene.ground.albedo = [1.0; 3];
    let size = [64, 64];
    let (picture, _) = draw(&mut sky, &scene, &panorama(100e3), size);
    let mut up = [0.0; 3];
    for y in 32..64 {
        let below = PI * ((f64::from(y) + 0.5) / 64.0 - 0.5);
        let weight = below.sin() * below.cos() * (PI / 64.0) * (2.0 * PI / 64.0);
        for x in 0..64 {
            up = std::array::from_fn(|c| up[c] + weight * f64::from(picture.at(x, y)[c]));
        }
    }
    let share = up.map(|flux| flux / 80f64.to_radians().sin());
    assert!(share.iter().all(|s| (0.87..1.01).contains(s)), "{share:?}");
}

#[test]
fn both_sides_of_the_horizon_agree_with_the_reference() {
    let (mut sky, multiple) = (new_sky(), Multiple::new(&Air::EARTH));
    let altitude = 20e3f64;
    let dip = (GROUND / (GROUND + altitude)).acos();
    let mut camera = panorama(altitude);
    camera.target = camera.position + DVec3::new(dip.cos(), -dip.sin(), 0.0) * 1e3;
    camera.projection = Projection::Perspective { vertical_fov_deg: 2.0 };
    let mut scene = scene(30.0);
    scene.ground.albedo = [0.0; 3];
    let (picture, _) = draw(&mut sky, &scene, &camera, [9, 129]);
    for y in [0, 30, 55, 62, 66, 72, 90, 128] {
        let elevation = -dip + (0.5 - (f64::from(y) + 0.5) / 129.0) * 2f64.to_radians();
        let ray = Ray::new(GROUND + altitude, elevation.sin(), 0.5, PI / 2.0);
        let want = reference::sky_radiance(&Air::EARTH, &multiple, ray);
        let got = picture.at(4, y);
        assert!(relative_error(got, want) < 0.03, "row {y}: {got:?} but {want:?}");
    }
    // Over the middle pixel the picture goes from one side to the other.
    let [above, on, below] = [63, 64, 65].map(|y| picture.at(4, y)[0]);
    assert!(below < on && on < above, "{below} {on} {above}");
}

#[test]
fn unchanged_inputs_redo_nothing_and_each_change_only_what_depends_on_it() {
    let mut sky = new_sky();
    let (mut scene, mut camera) = (scene(30.0), panorama(2.0));
    let nothing = Redone::default();
    let mut redo = |scene: &Scene, camera: &Camera| draw(&mut sky, scene, camera, [16, 8]).1;
    let all = Redone { atmosphere: true, sky_view: true, sky_light: true, aerial: true };
    assert_eq!(redo(&scene, &camera), all);
    assert_eq!(redo(&scene, &camera), nothing);

    camera.position.x += 100.0;
    camera.target.x += 100.0;
    assert_eq!(redo(&scene, &camera), nothing, "what is seen of the sky does not depend on where one stands");
    camera.target.x += 300.0;
    assert_eq!(redo(&scene, &camera), Redone { aerial: true, ..nothing }, "turned");
    camera.position.y += 50.0;
    camera.target.y += 50.0;
    assert_eq!(redo(&scene, &camera), Redone { sky_view: true, aerial: true, ..nothing }, "risen");

    scene.sun.position = SunPosition::Angles { azimuth_deg: 90.0, elevation_deg: 30.0 };
    assert_eq!(redo(&scene, &camera), Redone { aerial: true, ..nothing }, "the sun gone round");
    scene.sun.position = SunPosition::Angles { azimuth_deg: 90.0, elevation_deg: 20.0 };
    assert_eq!(redo(&scene, &camera), Redone { atmosphere: false, ..all }, "the sun sunk");
    scene.sun.irradiance = [2.0; 3];
    assert_eq!(redo(&scene, &camera), Redone { sky_light: true, ..nothing }, "a brighter sun");
    scene.sky = SceneSky::Atmosphere(Atmosphere { haze: 2.0, ozone: 1.0 });
    assert_eq!(redo(&scene, &camera), all, "haze");
    scene.sky = SceneSky::None;
    assert_eq!(redo(&scene, &camera), nothing, "no sky");
    scene.sky = SceneSky::default();
    assert_eq!(redo(&scene, &camera), all, "a sky again");
}

#[test]
fn tables_that_were_kept_equal_tables_made_afresh() {
    let (mut kept, mut fresh) = (new_sky(), new_sky());
    draw(&mut kept, &scene(60.0), &panorama(2.0), [16, 8]);
    let (mut evening, camera) = (scene(8.0), panorama(500.0));
    evening.sun.irradiance = [3.0, 2.0, 1.0];
    let (a, _) = draw(&mut kept, &evening, &camera, [16, 8]);
    let (b, _) = draw(&mut fresh, &evening, &camera, [16, 8]);
    assert_eq!(a.pixels, b.pixels);
    assert_eq!(texels(kept.sky_light().texture()), texels(fresh.sky_light().texture()));
    assert_eq!(texels(kept.aerial().texture()), texels(fresh.aerial().texture()));
}

#[test]
fn a_uniform_sky_has_exactly_its_radiance_everywhere() {
    let mut sky = new_sky();
    let mut scene = scene(30.0);
    scene.sky = SceneSky::Uniform { radiance: [0.25, 0.5, 2.0] };
    scene.sun.irradiance = [0.0; 3];
    for projection in [
        Projection::Equirectangular,
        Projection::Orthographic { height: 1e3 },
        Projection::Perspective { vertical_fov_deg: 90.0 },
    ] {
        let camera = Camera { projection, ..panorama(2.0) };
        let (picture, redone) = draw(&mut sky, &scene, &camera, [16, 16]);
        assert_eq!(redone, Redone::default());
        assert!(picture.pixels.iter().all(|p| *p == [0.25, 0.5, 2.0, 1.0]));
    }
    for part in 0..3 {
        let light = with_tables(
            &sky,
            "return vec4f(light_of_sky(light, u32(x.x)), 1.0);",
            &[[part as f32, 0.0, 0.0, 0.0]],
        );
        assert_eq!(light[0], [0.25, 0.5, 2.0, 1.0]);
    }
    assert_eq!(texels(sky.transmittance().texture()), [[1.0; 4]]);
    assert_eq!(texels(sky.aerial().texture()), [[0.0, 0.0, 0.0, 1.0]]);
    let air = with_tables(
        &sky,
        "return aerial_perspective(volume, linear_sampler, x.xy, x.z, 6e4);",
        &[[0.5, 0.5, 1e4, 0.0]],
    );
    assert_eq!(air[0], [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn no_sky_is_black_but_for_the_sun() {
    let mut sky = new_sky();
    let mut scene = scene(10.0);
    scene.sky = SceneSky::None;
    let mut camera = panorama(2.0);
    camera.target = camera.position + scene.sun.to_sun();
    camera.projection = Projection::Perspective { vertical_fov_deg: 1.0 };
    let (picture, _) = draw(&mut sky, &scene, &camera, [64, 64]);
    assert_eq!(picture.at(0, 0), [0.0, 0.0, 0.0, 1.0]);
    // The disc's radiance over the picture is the sun's irradiance: limb, edge and all.
    let pixel = (2.0 * 0.5f64.to_radians().tan() / 64.0).powi(2);
    for c in 0..3 {
        let irradiance: f64 = picture.pixels.iter().map(|p| f64::from(p[c]) * pixel).sum();
        assert!((irradiance - 1.0).abs() < 0.02, "channel {c}: {irradiance}");
    }
    assert!(picture.at(32, 32)[2] > 1.5 * picture.at(32, 16)[2], "the limb is darker");
    camera.projection = Projection::Orthographic { height: 10.0 };
    let (picture, _) = draw(&mut sky, &scene, &camera, [8, 8]);
    assert!(picture.pixels.iter().all(|p| *p == [0.0, 0.0, 0.0, 1.0]), "parallel rays see no disc");
}

#[test]
fn a_sun_smaller_than_a_pixel_keeps_its_light() {
    let mut sky = new_sky();
    let mut scene = scene(0.0);
    scene.sky = SceneSky::None;
    for diameter in [0.0, 0.1, 0.53] {
        scene.sun.angular_diameter_deg = diameter;
        let mut sums = Vec::new();
        for shift in [0.0, 0.3, 0.5] {
            let mut camera = panorama(2.0);
            camera.projection = Projection::Perspective { vertical_fov_deg: 30.0 };
            let angle = f64::to_radians(shift * 30.0 / 16.0);
            camera.target = camera.position + DVec3::new(angle.sin(), 0.0, -angle.cos());
            let (picture, _) = draw(&mut sky, &scene, &camera, [16, 16]);
            let pixel = (2.0 * 15f64.to_radians().tan() / 16.0).powi(2);
            sums.push(picture.pixels.iter().map(|p| f64::from(p[1]) * pixel).sum::<f64>());
        }
        // A round spot on square pixels.
        assert!(sums.iter().all(|sum| (0.85..1.15).contains(sum)), "{diameter}: {sums:?}");
    }
}

#[test]
fn sky_light_is_the_mean_of_what_the_clouds_see() {
    let air = Air { albedo: [0.1, 0.2, 0.3], ..Air::EARTH };
    let multiple = Multiple::new(&air);
    let mut sky = new_sky();
    for elevation in [50.0, 6.0] {
        let mut scene = scene(elevation);
        scene.ground.albedo = air.albedo;
        scene.sun.irradiance = [1.0, 2.0, 3.0];
        draw(&mut sky, &scene, &panorama(2.0), [8, 4]);
        let light = with_tables(
            &sky,
            "return vec4f(light_of_sky(light, u32(x.x)), 1.0);",
            &[[0.0; 4], [1.0; 4], [2.0; 4]],
        );
        let mu_sun = elevation.to_radians().sin();
        let mean = |mus: &dyn Fn(f64) -> f64| -> Rgb {
            let mut sum = [0.0; 3];
            for i in 0..144 {
                let mu = mus((f64::from(i / 12) + 0.5) / 12.0);
                let ray = Ray::new(GROUND + 1000.0, mu, mu_sun, PI * (f64::from(i % 12) + 0.5) / 12.0);
                let value = reference::sky_radiance(&air, &multiple, ray);
                sum = std::array::from_fn(|c| sum[c] + value[c] / 144.0 * f64::from(c as u32 + 1));
            }
            sum
        };
        let above = mean(&|y| y.sqrt());
        assert!(relative_error(light[0], above) < 0.05, "{:?} {above:?}", light[0]);
        let ground = reference::ground_irradiance(&air, &multiple, mu_sun);
        let ground: Rgb = std::array::from_fn(|c| ground[c] * air.albedo[c] / PI * (c + 1) as f64);
        assert!(relative_error(light[2], ground) < 0.03, "{:?} {ground:?}", light[2]);
        if elevation > 10.0 {
            let (low, high) = (-(10f64.to_radians().sin()), 0.5);
            let belt = mean(&|y| low + (high - low) * y);
            assert!(relative_error(light[1], belt) < 0.05, "{:?} {belt:?}", light[1]);
        }
    }
}

#[test]
fn light_is_gathered_at_half_the_height_of_the_clouds() {
    let mut scene = scene(30.0);
    assert_eq!(SkySettings::new(&scene, scene.sun.to_sun()).uniform.light_altitude, 1000.0);
    scene.ground.altitude = 200.0;
    scene.clouds.push(nephos::scene::Cloud {
        ellipsoids: vec![Ellipsoid { center: DVec3::new(0.0, 2200.0, 0.0), ..Default::default() }],
        ..Default::default()
    });
    assert!((SkySettings::new(&scene, scene.sun.to_sun()).uniform.light_altitude - 2000.0).abs() < 1e-3);
}

#[test]
fn aerial_perspective_is_nothing_at_no_distance_and_the_reference_farther() {
    // Where there is more haze the texels of a panorama, 6 degrees, are too wide for it.
    let air = Air { haze: 1.0, ..Air::EARTH };
    let multiple = Multiple::new(&Air { albedo: [0.12, 0.11, 0.07], ..air });
    let mut sky = new_sky();
    let elevation = 25.0;
    let mut scene = scene(elevation);
    scene.sky = SceneSky::Atmosphere(Atmosphere { haze: 1.0, ozone: 1.0 });
    for altitude in [2.0, 3000.0] {
        draw(&mut sky, &scene, &panorama(altitude), [64, 32]);
        let body = "return aerial_perspective(volume, linear_sampler, x.xy, x.z, sky.aerial_reach);";
        assert_eq!(with_tables(&sky, body, &[[0.3, 0.4, 0.0, 0.0]])[0], [0.0, 0.0, 0.0, 1.0]);
        for distance in [10.0, 200.0, 1500.0, 9e3, 35e3, 60e3f32, 1e6] {
            // Half way round from the sun and off the volume's texels.
            let uv = [0.9f32, 0.47];
            let got = with_tables(&sky, body, &[[uv[0], uv[1], distance, 0.0]])[0];
            let pixel = [uv[0] as f64 * 2.0 * PI - PI, (0.5 - uv[1] as f64) * PI];
            let ray = Ray::new(GROUND + altitude, pixel[1].sin(), elevation.to_radians().sin(), pixel[0]);
            let length = f64::from(distance).min(60e3);
            let (light, through) = reference::air_light(&air, &multiple, ray, length, 64);
            assert!(relative_error(got, light) < 0.05, "{altitude} {distance}: {got:?} {light:?}");
            let mean = through.iter().sum::<f64>() / 3.0;
            // A panorama's volume has a texel every 6 degrees.
            assert!((f64::from(got[3]) - mean).abs() < 1e-2, "{altitude} {distance}: {} {mean}", got[3]);
        }
        let ends = with_tables(&sky, body, &[[0.0, 0.4, 2e4, 0.0], [1.0, 0.4, 2e4, 0.0]]);
        for c in 0..4 {
            assert!((ends[0][c] - ends[1][c]).abs() <= 1e-3 * ends[0][c], "the panorama closes: {ends:?}");
        }
    }
}

#[test]
fn settings_take_all_of_the_scene() {
    let mut scene = scene(90.0);
    scene.sky = SceneSky::Atmosphere(Atmosphere { haze: 3.0, ozone: 2.0 });
    scene.ground.albedo = [0.1, 0.2, 0.3];
    let settings = SkySettings::new(&scene, scene.sun.to_sun());
    let earth = AtmosphereUniform::earth(1.0, 1.0, Vec3::ZERO, 0.0);
    assert!(settings.atmosphere);
    assert_eq!(settings.uniform.atmosphere.mie_extinction, 3.0 * earth.mie_extinction);
    assert_eq!(settings.uniform.atmosphere.ozone, 2.0 * earth.ozone);
    assert_eq!(settings.uniform.atmosphere.ground_albedo, Vec3::new(0.1, 0.2, 0.3));
    assert!(settings.uniform.to_sun.distance(Vec3::Y) < 1e-6);
}
