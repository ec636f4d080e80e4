//! Frames that follow one another: nothing is made anew that did not change, and what is kept makes no other picture.
#![cfg(feature = "measure")]

use crate::common;

use common::{gpu, picture::renderer};
use glam::DVec3;
use nephos::{
    export::Picture,
    gpu::Made,
    measure::crowd,
    render::{Frame, Quality, Renderer, Target, Transport},
    scene::{Camera, GroundKind, Land, Scene, Water},
};

const SIZE: [u32; 2] = [64, 36];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A renderer with the texture that it draws into.
struct Window {
    renderer: Renderer,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Window {
    fn new() -> Self {
        let mut renderer = renderer(Quality::DRAFT, Transport::MOMENTS);
        renderer.settings.quality.light_cells = 8;
        renderer.settings.quality.light_resolution = 16;
        let texture = renderer.picture("window", SIZE, FORMAT);
        let view = texture.create_view(&Default::default());
        Self { renderer, texture, view }
    }

    fn target(&self) -> Target<'_> {
        Target { color: &self.view, depth: None, sky: true }
    }

    fn shows(&self, frame: &Frame) -> bool {
        self.renderer.shows(frame, &self.target())
    }

    /// Draws a frame; tells what was made for it.
    fn draw(&mut self, frame: &Frame) -> Made {
        let before = Made::so_far();
        let target = Target { color: &self.view, depth: None, sky: true };
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        self.renderer.render(&mut encoder, frame, &target);
        gpu().queue.submit([encoder.finish()]);
        Made::so_far() - before
    }

    fn picture(&self) -> Picture {
        Picture::read(gpu(), &self.texture).unwrap()
    }
}

fn ahead(camera: &Camera, metres: f64) -> Camera {
    let step = metres * DVec3::NEG_Z;
    Camera { position: camera.position + step, target: camera.target + step, ..camera.clone() }
}

fn frame(scene: &Scene, metres: f64) -> Frame {
    Frame::new(&Scene { camera: Some(ahead(&scene.camera(), metres)), ..scene.clone() }, SIZE).unwrap()
}

#[test]
fn a_still_frame_makes_nothing_and_need_not_be_drawn() {
    let mut scene = crowd(5);
    let mut window = Window::new();
    for kind in [GroundKind::Even, GroundKind::Land(Land::default()), GroundKind::Water(Water::default())] {
        scene.ground.kind = kind;
        assert!(!window.shows(&frame(&scene, 0.0)), "nothing is drawn yet");
        assert_ne!(window.draw(&frame(&scene, 0.0)), Made::default(), "else the test would prove nothing");
        let (first, light) = (window.picture(), window.renderer.light_updates());
        // A frame of the same scene, made anew.
        assert!(window.shows(&frame(&scene, 0.0)));
        assert_eq!(window.draw(&frame(&scene, 0.0)), Made::default());
        assert_eq!((window.picture(), window.renderer.light_updates()), (first, light));
    }
}

#[test]
fn what_changed_is_not_shown_yet() {
    let scene = crowd(2);
    let mut window = Window::new();
    window.draw(&frame(&scene, 0.0));
    let still = frame(&scene, 0.0);
    assert!(window.shows(&still));
    assert!(!window.shows(&frame(&scene, 1.0)), "the camera moved");
    let mut later = scene.clone();
    later.clouds[0].ellipsoids[0].radii *= 1.01;
    assert!(!window.shows(&frame(&later, 0.0)), "a cloud grew");
    let other = window.texture.create_view(&Default::default());
    let target = Target { color: &other, depth: None, sky: true };
    assert!(!window.renderer.shows(&still, &target), "another view");
    assert!(!window.renderer.shows(&still, &Target { sky: false, ..window.target() }), "no sky");
    window.renderer.settings.aerial = false;
    assert!(!window.shows(&still), "other settings");
    window.renderer.settings.aerial = true;
    window.draw(&frame(&scene, 1.0));
    assert!(!window.shows(&still), "another frame was drawn there");
}

#[test]
fn what_a_flight_makes_for_a_frame_does_not_depend_on_how_many_clouds_there_are() {
    let made = |clouds| {
        let scene = crowd(clouds);
        let mut window = Window::new();
        for metres in [0.0, 1.0, 2.0] {
            window.draw(&frame(&scene, metres));
        }
        let light = window.renderer.light_updates();
        let made = window.draw(&frame(&scene, 3.0));
        // The shadow in the air before the camera, and nothing in the clouds.
        assert_eq!(window.renderer.light_updates() - light, 1);
        made
    };
    let (few, many) = (made(2), made(12));
    // Of many some cross: what they hide is drawn by numbers of its own.
    assert_eq!(Made { writes: 0, ..few }, Made { writes: 0, ..many });
    assert!(many.writes <= few.writes + 4, "{few:?} {many:?}");
    assert!(many.groups <= 1 && many.buffers + many.textures + many.pipelines == 0, "{many:?}");
}

#[test]
fn pictures_of_a_flight_are_those_of_a_fresh_renderer() {
    let scene = crowd(3);
    let places = [0.0, 40.0, 300.0];
    let fresh = places.map(|metres| {
        let mut fresh = Window::new();
        fresh.draw(&frame(&scene, metres));
        fresh.picture()
    });
    let mut window = Window::new();
    // The last one back.
    for i in [0, 1, 2, 1] {
        window.draw(&frame(&scene, places[i]));
        assert!(window.picture() == fresh[i], "{} m ahead", places[i]);
    }
}
