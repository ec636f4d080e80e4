//! Pictures in pieces are the pictures; the work of pixels adds up; heat maps have their colours.
#![cfg(feature = "export")]

use crate::common;

use common::{gpu, picture};
use nephos::{
    export::Picture,
    render::{Frame, HeatMap, Pieces, Quality, Renderer, Resolve, Shown, Target, Transport},
    scene::{Preset, Scene},
};

const SIZE: [u32; 2] = [80, 45];

fn scene() -> Scene {
    Preset::Kol.scene(1)
}

fn renderer() -> Renderer {
    picture::renderer(picture::in_coarse_light(Quality::DRAFT), Transport::DELTA_EDDINGTON)
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

fn read(texture: &wgpu::Texture) -> Picture {
    Picture::read(gpu(), texture).unwrap()
}

/// Draws three tiles at a time.
fn finish(renderer: &mut Renderer, begun: wgpu::CommandEncoder, mut pieces: Pieces) {
    gpu().queue.submit([begun.finish()]);
    assert!(pieces.tiles() > 3, "one piece would prove nothing");
    let mut share = -1.0;
    while !pieces.finished() {
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        renderer.draw_pieces(&mut encoder, &mut pieces, 3);
        gpu().queue.submit([encoder.finish()]);
        assert!(pieces.share() > share);
        share = pieces.share();
    }
    assert_eq!(share, 1.0);
}

#[test]
fn a_picture_in_pieces_is_the_picture() {
    let mut renderer = renderer();
    let whole = picture::draw(&mut renderer, &scene(), SIZE, true);
    let texture = renderer.picture("pieces", SIZE, wgpu::TextureFormat::Rgba16Float);
    let target = Target { color: &view(&texture), depth: None, sky: true };
    let frame = Frame::new(&scene(), SIZE).unwrap();
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    let pieces = renderer.begin_pieces(&mut encoder, &frame, &target);
    finish(&mut renderer, encoder, pieces);
    assert_eq!(read(&texture), whole);
}

#[test]
fn layers_in_pieces_are_the_layers() {
    let mut renderer = renderer();
    let frame = Frame::new(&scene(), SIZE).unwrap();
    let whole = renderer.render_layers(gpu(), &frame, &mut |_| ()).unwrap();
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    let (layers, pieces) = renderer.begin_layers(&mut encoder, &frame);
    finish(&mut renderer, encoder, pieces);
    for (a, b) in [
        (&layers.sun.sky, &whole.sun.sky),
        (&layers.sun.single, &whole.sun.single),
        (&layers.sun.multiple, &whole.sun.multiple),
        (&layers.sun.ambient, &whole.sun.ambient),
        (&layers.sun.air, &whole.sun.air),
        (&layers.distance, &whole.distance),
        (&layers.normal, &whole.normal),
    ] {
        assert_eq!(read(a), read(b));
    }
}

#[test]
fn the_work_of_all_pixels_is_what_is_counted() {
    let mut scene = scene();
    // Two clouds behind each other: their work adds up.
    let mut behind = scene.clouds[0].clone();
    behind.ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center.z -= 400.0);
    scene.clouds.push(behind);
    let mut renderer = renderer();
    renderer.settings.counting = true;
    picture::draw(&mut renderer, &scene, SIZE, false);
    let counts = renderer.counts(gpu()).unwrap();
    renderer.settings.counting = false;
    let frame = Frame::new(&scene, SIZE).unwrap();
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    let (cost, pieces) = renderer.begin_cost(&mut encoder, &frame);
    finish(&mut renderer, encoder, pieces);
    // Half floats hold whole numbers up to 2048; few pixels of a draft have more.
    let sum = |channel: usize| read(&cost).pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>();
    assert!(counts.steps > 1000);
    for (channel, expected) in
        [counts.steps, counts.density_evaluations, counts.map_reads].into_iter().enumerate()
    {
        let error = sum(channel) / expected as f64 - 1.0;
        assert!(error.abs() < 1e-3, "channel {channel}: {} for {expected}", sum(channel));
    }
}

#[test]
fn rays_become_their_mean_and_numbers_their_colours() {
    let values = [0.0f32, 1.0, 7.0, 60.0, 300.0, 999.0, 5000.0, 20.0];
    // Four rays a pixel, whose mean is the value.
    let pixels = (0..4 * values.len()).map(|i| {
        let (x, y) = (i % (2 * values.len()), i / (2 * values.len()));
        let share = [[0.0, 2.0], [0.5, 1.5]][y][x % 2];
        [share * values[x / 2], 0.0, 0.0, 1.0]
    });
    let rays = Picture { width: 2 * values.len(), height: 2, pixels: pixels.collect() }.upload(gpu());
    let renderer = renderer();
    let mut resolve = Resolve::default();
    let mut draw = |shown, format| {
        let target = renderer.picture("resolved", [values.len() as u32, 1], format);
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        let from = view(&rays);
        resolve.draw(&gpu().device, &mut encoder, (&from, 2, shown), &view(&target), format);
        gpu().queue.submit([encoder.finish()]);
        target
    };
    let mean = read(&draw(Shown::Beauty, wgpu::TextureFormat::Rgba16Float));
    for (pixel, value) in mean.pixels.iter().zip(values) {
        // Half floats before and after.
        assert!((pixel[0] - value).abs() <= 2e-3 * value, "{} for {value}", pixel[0]);
    }
    let heat = draw(Shown::Heat(1000.0), wgpu::TextureFormat::Rgba8Unorm);
    let bytes = nephos::gpu::read_texture(gpu(), &heat, 0).unwrap();
    for (pixel, value) in bytes.chunks(4).zip(values) {
        let expected = HeatMap::color(HeatMap::place(value, 1000.0)).map(|c| 255.0 * c);
        for c in 0..3 {
            assert!((f32::from(pixel[c]) - expected[c]).abs() < 2.0, "{value}: {pixel:?} {expected:?}");
        }
    }
}
