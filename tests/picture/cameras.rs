//! Cameras that come as matrices, as game engines have them, against the scene's own.
#![cfg(feature = "export")]

use crate::common;

use common::{
    gpu,
    picture::{in_coarse_light, lent, renderer},
};
use glam::{
    DAffine3, DQuat, DVec3, Mat4,
    camera::{lh::proj::directx as left_handed, rh::proj::directx as proj},
    vec3,
};
use nephos::{
    export::Picture,
    render::{Film, Frame, Quality, SceneDepth, Target, Transport},
    scene::{Camera, Preset, Projection, Scene},
};

const SIZE: [u32; 2] = [64, 36];
const ASPECT: f32 = 16.0 / 9.0;
const NEAR: f32 = 0.5;
/// Of half floats that are sums of some; matrices of f32 move an edge by less.
const ROUNDING: f32 = 4e-3;

fn scene(projection: Projection) -> Scene {
    let mut scene = Preset::Kol.scene(1);
    let camera = Camera { projection, roll_deg: 12.0, ..scene.camera() };
    scene.camera = Some(camera);
    scene
}

fn perspective() -> Scene {
    scene(Projection::Perspective { vertical_fov_deg: 30.0 })
}

fn world_from_view(scene: &Scene) -> DAffine3 {
    let camera = scene.camera();
    DAffine3::from_rotation_translation(camera.world_from_camera(), camera.position)
}

fn taken(frame: &Frame, sky: bool) -> Picture {
    lent(in_coarse_light(Quality::PREVIEW), Transport::OCTAVES, |renderer| {
        // The air before clouds is kept in as many cells for a part of a picture as for the whole.
        renderer.settings.aerial = sky;
        Film::new(frame.size(), 1).take(gpu(), renderer, frame, sky, &mut |_| ()).unwrap()
    })
}

/// Both pictures are of the same light and alpha, but for `tolerance` of the brightest pixel's.
fn assert_alike(found: &Picture, expected: &Picture, tolerance: f32) {
    assert_eq!((found.width, found.height), (expected.width, expected.height));
    let brightest = expected.pixels.iter().map(|pixel| pixel[1]).fold(0.0, f32::max);
    assert!(brightest > 0.02, "there is something to be seen");
    let most = [brightest, brightest, brightest, 1.0];
    let off =
        |(a, b): (&[f32; 4], &[f32; 4])| (0..4).map(|c| (a[c] - b[c]).abs() / most[c]).fold(0.0, f32::max);
    let worst = found.pixels.iter().zip(&expected.pixels).map(off).fold(0.0, f32::max);
    assert!(worst < tolerance, "{worst} of {brightest}");
}

#[test]
fn a_matrix_without_shift_shows_what_the_cameras_own_projection_does() {
    let fov = 30f32.to_radians();
    let turned = vec3(1.0, 1.0, -1.0);
    let perspectives = [
        proj::perspective_infinite_reverse(fov, ASPECT, NEAR),
        proj::perspective(fov, ASPECT, NEAR, 4e4),
        // A multiple of a projection is the same one; so is one of another depth.
        3.0 * Mat4::from_scale(turned) * proj::perspective(fov, ASPECT, NEAR, 4e4),
    ];
    let half = 900.0;
    let parallel = proj::orthographic(-half * ASPECT, half * ASPECT, -half, half, 0.0, 1e4);
    let orthographic = Projection::Orthographic { height: 2.0 * f64::from(half) };
    let cases = perspectives.map(|matrix| (perspective(), matrix)).into_iter();
    for (scene, matrix) in cases.chain([(scene(orthographic), parallel)]) {
        let own = Frame::new(&scene, SIZE).unwrap();
        let frame = own.seen_through(matrix, world_from_view(&scene), SIZE).unwrap();
        for sky in [false, true] {
            assert_alike(&taken(&frame, sky), &taken(&own, sky), ROUNDING);
        }
    }
}

/// A matrix for the quarter at the top left of a picture, whose middle is not on the axis.
fn quarter(clip_from_view: Mat4) -> Mat4 {
    Mat4::from_translation(vec3(1.0, -1.0, 0.0)) * Mat4::from_scale(vec3(2.0, 2.0, 1.0)) * clip_from_view
}

fn top_left(picture: &Picture) -> Picture {
    let (width, height) = (picture.width / 2, picture.height / 2);
    let rows = picture.pixels.chunks_exact(picture.width).take(height);
    Picture { width, height, pixels: rows.flat_map(|row| &row[..width]).copied().collect() }
}

#[test]
fn a_quarter_by_an_off_axis_matrix_is_that_quarter_of_the_whole() {
    let scene = perspective();
    // The middle of the cloud is in the middle of the picture.
    let turn = DAffine3::from_rotation_translation(DQuat::from_rotation_y(-0.1), DVec3::ZERO);
    let whole = proj::perspective_infinite_reverse(30f32.to_radians(), ASPECT, NEAR);
    let skew = Mat4::from_cols_array_2d(&[
        [1.0, 0.1, 0., 0.],
        [0.2, 1.1, 0., 0.],
        [0., 0., 1., 0.],
        [0., 0., 0., 1.],
    ]);
    let parallel = proj::orthographic(-1500.0, 1500.0, -900.0, 900.0, 0.0, 1e4);
    // Parallel lines of sight that meet the picture at a slant.
    let slanting = parallel
        * Mat4::from_cols_array_2d(&[
            [1., 0., 0., 0.],
            [0., 1., 0., 0.],
            [0.1, -0.2, 1., 0.],
            [0., 0., 0., 1.],
        ]);
    for (matrix, has_one_eye) in [(whole, true), (whole * skew, true), (parallel, false), (slanting, false)] {
        let own = Frame::new(&scene, SIZE).unwrap();
        let place = world_from_view(&scene) * turn;
        let frame = own.seen_through(matrix, place, SIZE).unwrap();
        let part = own.seen_through(quarter(matrix), place, SIZE.map(|n| n / 2)).unwrap();
        assert_alike(&taken(&part, false), &top_left(&taken(&frame, false)), ROUNDING);
        // Behind parallel lines of sight is the sky as the middle of the picture has it.
        if has_one_eye {
            assert_alike(&taken(&part, true), &top_left(&taken(&frame, true)), 2.0 * ROUNDING);
        }
    }
}

/// Clouds alone behind and before a wall, `distance` metres away along the axis.
fn before_a_wall(frame: &Frame, distance: f32) -> Picture {
    let mut renderer = renderer(in_coarse_light(Quality::PREVIEW), Transport::OCTAVES);
    renderer.settings.aerial = false;
    let color = renderer.picture("color", frame.size(), wgpu::TextureFormat::Rgba16Float);
    let depth = renderer.picture("depth", frame.size(), wgpu::TextureFormat::Depth32Float);
    let [color_view, depth_view] = [&color, &depth].map(|t| t.create_view(&Default::default()));
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(NEAR / distance),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    let depth = SceneDepth { view: &depth_view, near: NEAR, far: f32::INFINITY, reversed: true };
    renderer.render(&mut encoder, frame, &Target { color: &color_view, depth: Some(depth), sky: false });
    gpu().queue.submit([encoder.finish()]);
    Picture::read(gpu(), &color).unwrap()
}

#[test]
fn depth_is_along_the_axis_and_not_along_the_middle_of_the_picture() {
    // Wide, so that the middle of a quarter is far from the axis.
    let mut scene = perspective();
    let cloud = scene.clouds[0].bounds().unwrap();
    let middle = 0.5 * (cloud.0 + cloud.1);
    let position = middle + 0.35 * (cloud.1 - cloud.0).length() * DVec3::Z;
    scene.camera = Some(Camera {
        position,
        target: middle,
        roll_deg: 0.0,
        projection: Projection::default(),
        ..Camera::default()
    });
    let matrix = proj::perspective_infinite_reverse(100f32.to_radians(), ASPECT, NEAR);
    let own = Frame::new(&scene, SIZE).unwrap();
    let place = world_from_view(&scene);
    let frame = own.seen_through(matrix, place, SIZE).unwrap();
    let part = own.seen_through(quarter(matrix), place, SIZE.map(|n| n / 2)).unwrap();
    let distance = position.distance(middle) as f32;
    let [walled, free] = [before_a_wall(&frame, distance), taken(&frame, false)];
    let changed =
        top_left(&walled).pixels.iter().zip(&top_left(&free).pixels).filter(|(a, b)| a != b).count();
    assert!(changed > 20, "{changed} pixels see the wall");
    assert_alike(&before_a_wall(&part, distance), &top_left(&walled), ROUNDING);
}

#[test]
fn what_is_no_camera_is_refused_with_a_sentence() {
    let scene = perspective();
    let frame = Frame::new(&scene, SIZE).unwrap();
    let good = proj::perspective_infinite_reverse(1.0, ASPECT, NEAR);
    let flat = Mat4::from_scale(vec3(1.0, 0.0, 1.0)) * good;
    let alike =
        Mat4::from_cols_array_2d(&[[1., 1., 0., 0.], [2., 2., 0., 0.], [0., 0., 1., -1.], [0., 0., 1., 0.]]);
    for (matrix, word) in [
        (Mat4::ZERO, "last row must be"),
        (Mat4::NAN, "not finite"),
        (left_handed::perspective_infinite_reverse(1.0, ASPECT, NEAR), "along -Z"),
        (good.transpose(), "last row must be"),
        (good * Mat4::from_rotation_x(0.1), "last row must be"),
        (flat, "without width or height"),
        (alike, "without width or height"),
    ] {
        let told = frame.seen_through(matrix, world_from_view(&scene), SIZE).unwrap_err().to_string();
        assert!(told.contains("clip_from_view") && told.contains(word), "{told}");
    }
    let large = DAffine3::from_scale(DVec3::splat(2.0));
    let lost = DAffine3::from_translation(DVec3::new(0.0, f64::NAN, 0.0));
    for place in [large, lost, DAffine3::ZERO, DAffine3::NAN] {
        let told = frame.seen_through(good, place, SIZE).unwrap_err().to_string();
        assert!(told.contains("world_from_view must turn and move only"), "{told}");
    }
    let told = frame.seen_through(good, world_from_view(&scene), [0, 9]).unwrap_err().to_string();
    assert!(told.contains("a picture of 0 by 9 pixels"), "{told}");
}
