//! The viewport as a person drives it, without a window, on the software adapter too.

use crate::patience;
use crate::window::{App, at, lump, open, rest, rest_until, run, shoot, sketch, two_lumps};
use eframe::egui::{Event, Key, Modifiers, PointerButton, vec2};
use glam::DVec3;
use nephos::{
    editor::{
        EllipsoidId, Selection,
        viewport::{Axes, Layer, Side, Stage, Tool, ViewCommand},
    },
    export::Picture,
    render::{Frame, Renderer, Target},
    scene::{Phase, Scene, Tone},
};

const TINY: eframe::egui::Vec2 = vec2(160.0, 90.0);

fn selected(app: &App) -> Vec<usize> {
    app.document.selection().ellipsoids.iter().map(|id| id.ellipsoid).collect()
}

fn center(app: &App, ellipsoid: usize) -> DVec3 {
    app.document.scene().clouds[0].ellipsoids[ellipsoid].center
}

#[test]
fn comes_to_rest_in_final_quality_and_then_does_nothing() {
    let mut window = open(two_lumps(), TINY);
    rest(&mut window);
    let statistics = window.state().viewport.statistics().clone();
    assert_eq!((statistics.quality, statistics.rays, statistics.resolution), ("final", 2, [160, 90]));
    for _ in 0..5 {
        window.step();
    }
    let asked = window.output().viewport_output[&eframe::egui::ViewportId::ROOT].repaint_delay;
    assert!(asked > std::time::Duration::from_secs(3600), "asks to be drawn again in {asked:?}");
    // Moving the mouse over the picture draws outlines, but no clouds.
    window.hover_at(at(&window, 0));
    window.step();
    let after = window.state().viewport.statistics();
    assert_eq!((after.pictures, after.light_updates), (statistics.pictures, statistics.light_updates));
}

#[test]
fn moving_the_camera_makes_pictures_but_no_light_and_edits_make_both() {
    let mut window = open(two_lumps(), TINY);
    window.state_mut().viewport.settings.finest = Stage::Preview;
    rest(&mut window);
    let before = window.state().viewport.statistics().clone();
    run(&mut window, ViewCommand::LookFrom(Side::Back));
    // The first picture: later ones may find the hand at rest.
    rest_until(&mut window, |app| app.viewport.statistics().pictures > before.pictures);
    let turned = window.state().viewport.statistics().clone();
    assert_eq!(turned.quality, "draft");
    rest(&mut window);
    // Tables of the air in front of the camera are made anew; the light in clouds is not.
    let rested = window.state().viewport.statistics().clone();
    assert!(rested.light_updates - before.light_updates <= 3, "{before:?} {rested:?}");
    window.state_mut().document.edit("Move", |scene| scene.clouds[0].ellipsoids[0].center.y += 20.0);
    rest(&mut window);
    let edited = window.state().viewport.statistics().clone();
    assert!(edited.light_updates - rested.light_updates > rested.light_updates - before.light_updates);
    window.state_mut().document.edit("Expose", |scene| scene.exposure = 1.0);
    rest(&mut window);
    assert_eq!(window.state().viewport.statistics().pictures, edited.pictures);
}

#[test]
fn the_picture_is_exposed_when_the_hand_rests_and_holds_still_while_it_moves() {
    let mut window = open(two_lumps(), TINY);
    window.state_mut().viewport.settings.finest = Stage::Preview;
    rest(&mut window);
    let before = window.state().viewport.metered().unwrap();
    let dim = |scene: &mut Scene| scene.sun.irradiance = scene.sun.irradiance.map(|x| x / 8.0);
    window.state_mut().document.edit("Dim", dim);
    let pictures = window.state().viewport.statistics().pictures;
    rest_until(&mut window, |app| app.viewport.statistics().pictures > pictures);
    assert_eq!(window.state().viewport.metered(), Some(before), "the hand may go on");
    rest(&mut window);
    let after = window.state().viewport.metered().unwrap();
    // An eighth of the light is three stops, and half floats have 11 bits.
    assert!((after - before - 3.0).abs() < 0.01, "{before} {after}");
    // Its switch is followed at once, and back again.
    window.state_mut().document.edit("Switch", |scene| scene.auto_exposure = Some(false));
    rest_until(&mut window, |app| app.viewport.metered().is_none());
    window.state_mut().document.edit("Switch", |scene| scene.auto_exposure = Some(true));
    window.step();
    rest_until(&mut window, |app| app.viewport.metered() == Some(after));
}

#[test]
fn a_click_selects_shift_adds_and_the_sky_selects_nothing() {
    let mut window = sketch(two_lumps(), TINY);
    // In so small a window the gizmo would cover the other lump.
    window.state_mut().viewport.settings.tool = Tool::Select;
    let (left, right) = (at(&window, 0), at(&window, 1));
    let click = |window: &mut crate::window::Window<'_>, place, modifiers| {
        window.hover_at(place);
        window.step();
        for pressed in [true, false] {
            let event =
                Event::PointerButton { pos: place, button: PointerButton::Primary, pressed, modifiers };
            window.event_modifiers(event, modifiers);
            window.step();
        }
    };
    click(&mut window, left, Modifiers::NONE);
    assert_eq!(selected(window.state()), [0]);
    click(&mut window, right, Modifiers::SHIFT);
    assert_eq!(selected(window.state()), [0, 1]);
    click(&mut window, left, Modifiers::SHIFT);
    assert_eq!(selected(window.state()), [1]);
    click(&mut window, vec2(10.0, 10.0).to_pos2(), Modifiers::NONE);
    assert_eq!(selected(window.state()), [] as [usize; 0]);
    assert!(window.state().document.undo_name().is_none());
}

#[test]
fn a_second_click_at_one_place_selects_what_is_behind() {
    let mut scene = two_lumps();
    scene.clouds[0].ellipsoids = vec![lump([0.0, 1000.0, 0.0]), lump([0.0, 1000.0, -900.0])];
    let mut window = sketch(scene, TINY);
    window.state_mut().viewport.settings.tool = Tool::Select;
    let place = at(&window, 0);
    for expected in [0, 1, 0] {
        window.hover_at(place);
        window.step();
        window.drag_at(place);
        window.step();
        window.drop_at(place);
        window.step();
        assert_eq!(selected(window.state()), [expected]);
    }
}

#[test]
fn a_box_selects_the_centres_in_it() {
    let mut window = sketch(two_lumps(), TINY);
    let (left, right) = (at(&window, 0), at(&window, 1));
    let reach = vec2(12.0, 12.0);
    for (from, to, expected) in
        [(left - reach, left + reach, vec![0]), (left - reach, right + reach, vec![0, 1])]
    {
        window.state_mut().document.select(Selection::default());
        window.hover_at(from);
        window.step();
        window.drag_at(from);
        window.step();
        for share in [0.3, 0.7, 1.0] {
            window.hover_at(from + share * (to - from));
            window.step();
        }
        window.drop_at(to);
        window.step();
        assert_eq!(selected(window.state()), expected);
    }
}

#[test]
fn dragging_an_arrow_moves_along_its_axis_in_one_step_of_undo() {
    let mut window = sketch(two_lumps(), vec2(480.0, 270.0));
    window.state_mut().viewport.settings.largest = 96;
    window.state_mut().document.select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 1 }));
    window.step();
    let before = center(window.state(), 1);
    // On the arrow that points up.
    let from = at(&window, 1) - vec2(0.0, 60.0);
    window.hover_at(from);
    window.step();
    window.drag_at(from);
    window.step();
    for up in [10.0, 22.0, 40.0] {
        window.hover_at(from - vec2(0.0, up));
        window.step();
    }
    let during = center(window.state(), 1);
    window.drop_at(from - vec2(0.0, 40.0));
    window.step();
    let after = center(window.state(), 1);
    assert_eq!(during, after);
    assert!(after.y > before.y + 10.0, "{before} {after}");
    assert!((after - before).with_y(0.0).length() < 1e-9);
    let document = &mut window.state_mut().document;
    assert_eq!(document.undo_name(), Some("Move"));
    document.undo();
    assert_eq!(document.undo_name(), None);
    assert_eq!(center(window.state(), 1), before);
}

#[test]
fn keys_move_by_a_typed_number_and_escape_takes_it_back() {
    let mut window = sketch(two_lumps(), TINY);
    window.state_mut().document.select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 0 }));
    let place = at(&window, 0);
    window.hover_at(place);
    window.step();
    let before = center(window.state(), 0);
    for end in [Key::Escape, Key::Enter] {
        window.key_press(Key::G);
        window.step();
        window.step();
        assert!(window.state().viewport.takes_keys());
        for key in [Key::Y, Key::Num1, Key::Num2, Key::Period, Key::Num5] {
            window.key_press(key);
            window.step();
        }
        assert_eq!(center(window.state(), 0), before + 12.5 * DVec3::Y);
        window.key_press(end);
        window.step();
        assert!(!window.state().viewport.takes_keys());
        let moved = if end == Key::Enter { 12.5 } else { 0.0 };
        assert_eq!(center(window.state(), 0), before + moved * DVec3::Y);
    }
    let document = &mut window.state_mut().document;
    assert_eq!(document.undo_name(), Some("Move"));
    document.undo();
    assert_eq!(center(window.state(), 0), before);
}

#[test]
fn the_middle_button_orbits_and_the_wheel_comes_nearer() {
    let mut window = sketch(two_lumps(), TINY);
    let place = at(&window, 0);
    let before = window.state().viewport.camera();
    window.hover_at(place);
    window.step();
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Middle,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(button(place, true));
    window.step();
    window.hover_at(place + vec2(30.0, 0.0));
    window.step();
    window.event(button(place + vec2(30.0, 0.0), false));
    window.step();
    let orbited = window.state().viewport.camera();
    assert!(orbited.position.distance(before.position) > 100.0);
    let focus = window.state().viewport.focus();
    let far = |camera: &nephos::scene::Camera| camera.position.distance(focus);
    assert!((far(&orbited) / far(&before) - 1.0).abs() < 1e-6);
    window.event(Event::MouseWheel {
        unit: eframe::egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 100.0),
        modifiers: Modifiers::NONE,
        phase: eframe::egui::TouchPhase::Move,
    });
    for _ in 0..20 {
        window.step();
    }
    assert!(far(&window.state().viewport.camera()) < 0.9 * far(&orbited));
    assert!(window.state().document.undo_name().is_none());
}

#[test]
#[ignore = "makes pictures to look at"]
fn pictures() {
    let scene = nephos::scene::Preset::Congestus.scene(7);
    let mut window = open(scene, vec2(900.0, 560.0));
    window.state_mut().viewport.settings.largest = 450;
    rest(&mut window);
    shoot(&mut window, "plain");
    let ids = [2, 5].map(|ellipsoid| EllipsoidId { cloud: 0, ellipsoid });
    window.state_mut().document.select(Selection::of(ids));
    rest(&mut window);
    shoot(&mut window, "move");
    window.state_mut().viewport.settings.tool = Tool::Rotate;
    window.state_mut().viewport.settings.axes = Axes::Local;
    run(&mut window, ViewCommand::FrameSelected);
    rest(&mut window);
    shoot(&mut window, "rotate");
    window.state_mut().viewport.settings.tool = Tool::Scale;
    window.hover_at(vec2(600.0, 300.0).to_pos2());
    window.step();
    window.key_press(Key::S);
    window.step();
    window.key_press(Key::Z);
    window.hover_at(vec2(640.0, 200.0).to_pos2());
    window.step();
    window.step();
    shoot(&mut window, "scaling");
    window.key_press(Key::Escape);
    window.step();
    run(&mut window, ViewCommand::LookFrom(Side::Top));
    rest(&mut window);
    shoot(&mut window, "top");
    window.set_size(vec2(430.0, 300.0));
    window.state_mut().document.select(Selection::default());
    run(&mut window, ViewCommand::FrameAll);
    rest(&mut window);
    shoot(&mut window, "narrow");
    window.set_size(vec2(700.0, 620.0));
    run(&mut window, ViewCommand::LookThroughSceneCamera);
    rest(&mut window);
    shoot(&mut window, "framed");
    let mut window = open(two_lumps(), vec2(900.0, 560.0));
    window.state_mut().viewport.settings.largest = 300;
    rest(&mut window);
    run(&mut window, ViewCommand::LookFrom(Side::Right));
    window.run_steps(30);
    let place = vec2(450.0, 300.0).to_pos2();
    window.hover_at(place);
    window.step();
    for pressed in [true, false] {
        let button = PointerButton::Middle;
        window.event(Event::PointerButton { pos: place, button, pressed, modifiers: Modifiers::NONE });
        window.step();
        window.hover_at(place + vec2(60.0, 30.0));
        window.step();
    }
    rest(&mut window);
    window.state_mut().document.select(Selection::one(EllipsoidId { cloud: 0, ellipsoid: 0 }));
    window.key_press(Key::G);
    window.step();
    window.key_press(Key::Y);
    window.key_press(Key::Num9);
    window.key_press(Key::Num0);
    window.step();
    window.step();
    rest(&mut window);
    shoot(&mut window, "typing");
}

#[test]
fn truth_converges_beside_the_preview_and_tells_how_far_that_is() {
    // Without the peak of droplets, whose rare bright paths need thousands of samples.
    let mut scene = two_lumps();
    scene.clouds[0].droplets.phase = Phase::HenyeyGreenstein { g: 0.5 };
    let mut window = open(scene, vec2(320.0, 180.0));
    let settings = &mut window.state_mut().viewport.settings;
    (settings.truth_pixels, settings.finest) = (64 * 36, Stage::Preview);
    run(&mut window, ViewCommand::ToggleTruth);
    rest_until(&mut window, |app| app.viewport.comparison().is_some());
    let first = window.state().viewport.comparison().unwrap();
    assert!(first.numbers.pixels > 20 && first.samples >= 9);
    rest_until(&mut window, |app| {
        app.viewport.comparison().is_some_and(|now| now.samples >= 4 * first.samples)
    });
    let later = window.state().viewport.comparison().unwrap();
    // Noise goes with the root of the samples: half of it at four times as many. Early
    // errors of errors are large.
    assert!(later.numbers.noise < 0.7 * first.numbers.noise, "{first:?} {later:?}");
    // The preview's error against truth that the README tells is about a tenth.
    assert!(later.numbers.without_noise() < 0.35 && later.numbers.bias.abs() < 0.3, "{later:?}");
    // The line between them is dragged without moving anything else.
    let camera = window.state().viewport.camera();
    let line = vec2(160.0, 60.0).to_pos2();
    window.hover_at(line);
    window.step();
    window.drag_at(line);
    window.step();
    window.hover_at(line + vec2(64.0, 0.0));
    window.step();
    window.drop_at(line + vec2(64.0, 0.0));
    window.step();
    let viewport = &window.state().viewport;
    assert!((viewport.settings.split - 0.7).abs() < 0.03, "{}", viewport.settings.split);
    assert_eq!(viewport.camera(), camera);
    run(&mut window, ViewCommand::ToggleTruth);
    rest(&mut window);
    assert!(window.state().viewport.comparison().is_none());
    assert_eq!(window.state().viewport.statistics().resolution, [320, 180]);
}

#[test]
#[ignore = "makes pictures to look at"]
fn pictures_of_layers() {
    let scene = nephos::scene::Preset::Congestus.scene(7);
    let mut window = open(scene, vec2(800.0, 500.0));
    window.state_mut().viewport.settings.largest = 320;
    window.state_mut().viewport.settings.outlines = false;
    for (layer, name, _) in Layer::ALL {
        run(&mut window, ViewCommand::Show(layer));
        rest(&mut window);
        shoot(&mut window, &format!("layer {name}"));
    }
}

#[test]
#[ignore = "makes pictures to look at"]
fn pictures_of_truth() {
    let scene = nephos::scene::Preset::Congestus.scene(7);
    let mut window = open(scene, vec2(800.0, 500.0));
    window.state_mut().viewport.settings.outlines = false;
    run(&mut window, ViewCommand::ToggleTruth);
    rest_until(&mut window, |app| app.viewport.comparison().is_some_and(|now| now.samples >= 48));
    shoot(&mut window, "truth");
    run(&mut window, ViewCommand::ToggleErrorMap);
    window.step();
    shoot(&mut window, "error");
}

#[test]
fn the_right_button_flies_by_letters_that_are_no_shortcuts_then() {
    let mut window = sketch(two_lumps(), TINY);
    let place = at(&window, 0);
    window.hover_at(place);
    window.step();
    let before = window.state().viewport.camera();
    let tool = window.state().viewport.settings.tool;
    let button = |pressed| Event::PointerButton {
        pos: place,
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(button(true));
    window.step();
    window.key_down(Key::W);
    window.run_steps(5);
    window.key_up(Key::W);
    window.event(button(false));
    window.run_steps(2);
    let after = window.state().viewport.camera();
    let way = after.position - before.position;
    assert!(way.length() > 10.0 && way.normalize().dot(before.forward()) > 0.999, "{way}");
    assert_eq!(window.state().viewport.settings.tool, tool);
    // The same letter without the button is the tool's.
    window.state_mut().viewport.settings.tool = Tool::Select;
    window.key_press(Key::W);
    window.step();
    assert_eq!(window.state().viewport.settings.tool, Tool::Move);
}

#[test]
fn a_shortcut_counts_with_the_modifiers_of_its_moment() {
    let mut window = sketch(two_lumps(), TINY);
    window.hover_at(at(&window, 0));
    window.step();
    // Shift is let go within the same slow frame.
    window.key_press_modifiers(Modifiers::SHIFT, Key::P);
    window.step();
    let error_map = window.state().viewport.settings.error_map;
    assert!(error_map);
}

#[test]
fn the_final_picture_is_what_the_renderer_gives() {
    let mut window = open(two_lumps(), vec2(96.0, 54.0));
    let settings = &mut window.state_mut().viewport.settings;
    (settings.outlines, settings.grid) = (false, false);
    rest(&mut window);
    let device = window.state().viewport.gpu().device.clone();
    let seen = patience::picture(&mut window, &device);
    // As `nephos render` does it in final quality: four rays a pixel, made one, composed.
    let app = window.state();
    let gpu = app.viewport.gpu();
    let scene = Scene { camera: Some(app.viewport.camera()), ..app.document.scene().clone() };
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, wgpu::TextureFormat::Rgba16Float);
    let frame = Frame::new(&scene, [192, 108]).unwrap();
    let linear = renderer.picture("linear", frame.size(), wgpu::TextureFormat::Rgba16Float);
    let target = Target { color: &linear.create_view(&Default::default()), depth: None, sky: true };
    renderer.render_in_pieces(gpu, &frame, &target, &mut |_| ()).unwrap();
    let picture = Picture::read(gpu, &linear).unwrap().reduced(2).upload(gpu);
    let screen = renderer.picture("screen", [96, 54], wgpu::TextureFormat::Rgba8Unorm);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let [from, to] = [&picture, &screen].map(|texture| texture.create_view(&Default::default()));
    let own = scene.tone();
    let tone = Tone { stops: own.stops + renderer.meter(gpu, &frame).unwrap(), ..own };
    renderer.compose(&mut encoder, &from, &to, wgpu::TextureFormat::Rgba8Unorm, tone);
    gpu.queue.submit([encoder.finish()]);
    let expected = nephos::gpu::read_texture(gpu, &screen, 0).unwrap();
    // Half floats between the passes, and egui's own rounding: a step of 255 each.
    let worst = seen.as_raw().iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(worst <= 2, "{worst}");
    // The cloud is there.
    assert!(seen.pixels().any(|pixel| pixel[0] > 150));
}
