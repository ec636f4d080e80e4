//! Everything that is not a cloud: sun, sky, ground, noise, wind and time, camera, picture.

use eframe::egui::Ui;
use egui_phosphor::regular as icon;
use glam::DVec3;

use super::{LightsPanel, SunPanel, apply, hint, object::noise_rows, section};
use crate::{
    editor::{Document, form::Form, words::choice},
    scene::{
        Aperture, Atmosphere, Camera, Cloud, Ground, GroundKind, GroundPicture, Land, Noise, Projection,
        Scene, Sky, ToneCurve, Water,
    },
};

/// What this panel asks of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// The scene's camera shall stand where the view is seen from.
    CameraFromView,
    /// The view shall be seen from the scene's camera.
    ViewFromCamera,
}

/// Inspector of the world.
#[derive(Debug, Default)]
pub struct WorldPanel {
    sun: SunPanel,
    lights: LightsPanel,
}

impl WorldPanel {
    /// Shows all of it; `metered` is what auto exposure adds in the view, stops.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document, metered: Option<f64>) -> Option<Wish> {
        let mut wish = None;
        section(ui, "Sun", true, |ui| self.sun.ui(ui, document));
        section(ui, "Lights", !document.scene().lights.is_empty(), |ui| self.lights.ui(ui, document));
        section(ui, "Sky", true, |ui| sky(ui, document));
        section(ui, "Picture", true, |ui| picture(ui, document, metered));
        section(ui, "Camera", false, |ui| wish = camera(ui, document));
        section(ui, "Noise", true, |ui| noise(ui, document));
        section(ui, "Ground", false, |ui| ground(ui, document));
        section(ui, "Wind and time", false, |ui| wind(ui, document));
        wish
    }
}

fn sky(ui: &mut Ui, document: &mut Document) {
    let mut sky = document.scene().sky.clone();
    let mut form = Form::new(ui).keyed(document, "");
    let kinds = [
        ("Atmosphere", choice("Sky.atmosphere"), Sky::default()),
        ("Uniform", choice("Sky.uniform"), Sky::Uniform { radiance: [0.1; 3] }),
        ("None", choice("Sky.none"), Sky::None),
    ];
    form.choice("Scene.sky", "Kind", &mut sky, &kinds);
    match &mut sky {
        Sky::Atmosphere(air) => {
            let default = Atmosphere::default();
            form.slider("Atmosphere.haze", "Haze", &mut air.haze, default.haze, 0.0..=20.0);
            form.slider("Atmosphere.ozone", "Ozone", &mut air.ozone, default.ozone, 0.0..=4.0);
        }
        Sky::Uniform { radiance } => form.color("Sky.uniform.radiance", "Radiance", radiance, [0.1; 3]),
        Sky::None => {}
    }
    let change = form.changed();
    apply(document, change, |scene| scene.sky = sky);
}

fn picture(ui: &mut Ui, document: &mut Document, metered: Option<f64>) {
    let scene = document.scene();
    let (mut exposure, mut curve, mut name) = (scene.exposure, scene.tone_curve, scene.name.clone());
    let mut auto_exposure = scene.is_metered();
    let curves = [
        (
            "Photo",
            "As natural, with the contrast of a photograph: shades within clouds are told apart.",
            ToneCurve::Photo,
        ),
        (
            "Natural",
            "Keeps hue and the texture of bright clouds: low suns turn orange and rose, not yellow.",
            ToneCurve::Natural,
        ),
        ("Filmic", "Like film: more contrast in the middle, highlights roll off.", ToneCurve::Filmic),
        ("Soft", "Less contrast: shades in bright clouds stay apart.", ToneCurve::Soft),
        ("Linear", "None: what is brighter than white is cut.", ToneCurve::Linear),
    ];
    let mut form = Form::new(ui).keyed(document, "");
    form.text("Scene.name", "Name", &mut name, "no name");
    form.check("Scene.auto_exposure", "Auto exposure", &mut auto_exposure, true);
    form.slider("Scene.exposure", "Exposure", &mut exposure, 0.0, -6.0..=6.0);
    form.choice("Scene.tone_curve", "Tone curve", &mut curve, &curves);
    let change = form.changed();
    if let Some(metered) = metered {
        hint(ui, &format!("Metered: {metered:+.2} stops, and the exposure on top of that."));
    }
    apply(document, change, |scene| {
        (scene.exposure, scene.tone_curve, scene.name) = (exposure, curve, name);
        // An exposure of one's own turns nothing off here: the switch is in sight.
        scene.auto_exposure = Some(auto_exposure);
    });
}

fn camera(ui: &mut Ui, document: &mut Document) -> Option<Wish> {
    let mut wish = None;
    ui.horizontal(|ui| {
        let set = ui.button(format!("{} Set from view", icon::CAMERA));
        if set.on_hover_text("The picture is taken from where you look now.").clicked() {
            wish = Some(Wish::CameraFromView);
        }
        let go = ui.button(format!("{} Look through", icon::EYE));
        if go.on_hover_text("You look from where the picture is taken.").clicked() {
            wish = Some(Wish::ViewFromCamera);
        }
    });
    let mut own = document.scene().camera.is_some();
    let mut camera = document.scene().camera();
    let mut form = Form::new(ui).keyed(document, "");
    form.check("Scene.camera", "Its own place", &mut own, false);
    if own {
        camera_rows(&mut form, &mut camera);
    }
    let change = form.changed();
    if !own {
        hint(ui, "It stands on the ground in the south and frames all clouds.");
    }
    apply(document, change, |scene| scene.camera = own.then_some(camera));
    wish
}

fn camera_rows(form: &mut Form<'_>, camera: &mut Camera) {
    let default = Camera::default();
    form.vector("Camera.position", "Position", &mut camera.position, default.position);
    form.vector("Camera.target", "Target", &mut camera.target, default.target);
    form.slider("Camera.roll_deg", "Roll", &mut camera.roll_deg, 0.0, -180.0..=180.0);
    let kinds = [
        ("Perspective", choice("Projection.perspective"), Projection::default()),
        (
            "Lens",
            choice("Projection.lens"),
            Projection::Lens { focal_length_mm: 35.0, sensor_width_mm: 36.0 },
        ),
        ("Orthographic", choice("Projection.orthographic"), Projection::Orthographic { height: 1000.0 }),
        ("Whole sphere", choice("Projection.equirectangular"), Projection::Equirectangular),
    ];
    form.choice("Camera.projection", "Projection", &mut camera.projection, &kinds);
    match &mut camera.projection {
        Projection::Perspective { vertical_fov_deg } => {
            let path = "Projection.perspective.vertical_fov_deg";
            form.slider(path, "Field of view", vertical_fov_deg, 40.0, 5.0..=120.0);
        }
        Projection::Lens { focal_length_mm, sensor_width_mm } => {
            form.slider(
                "Projection.lens.focal_length_mm",
                "Focal length",
                focal_length_mm,
                35.0,
                10.0..=300.0,
            );
            form.slider("Projection.lens.sensor_width_mm", "Sensor width", sensor_width_mm, 36.0, 5.0..=70.0);
        }
        Projection::Orthographic { height } => {
            form.number("Projection.orthographic.height", "Height", height, 1000.0);
        }
        Projection::Equirectangular => {}
    }
    if camera.projection == Projection::Equirectangular {
        // It has no lens.
        (camera.shift_x, camera.shift_y) = (0.0, 0.0);
    } else {
        form.slider("Camera.shift_x", "Shift right", &mut camera.shift_x, 0.0, -0.5..=0.5);
        form.slider("Camera.shift_y", "Shift up", &mut camera.shift_y, 0.0, -0.5..=0.5);
    }
    aperture_rows(form, camera);
}

/// Depth of field, which lenses have.
fn aperture_rows(form: &mut Form<'_>, camera: &mut Camera) {
    if matches!(camera.projection, Projection::Orthographic { .. } | Projection::Equirectangular) {
        camera.aperture = None;
        return;
    }
    let focus = camera.position.distance(camera.target).clamp(0.01, 1e6);
    let default = Aperture { radius: Some(1.0), f_stop: None, focus };
    let (mut is_open, mut aperture) = (camera.aperture.is_some(), camera.aperture.unwrap_or(default));
    if matches!(camera.projection, Projection::Perspective { .. }) && aperture.f_stop.is_some() {
        // It has no focal length.
        aperture = Aperture { focus: aperture.focus, ..default };
    }
    form.check("Camera.aperture", "Depth of field", &mut is_open, false);
    if is_open {
        if let Some(radius) = &mut aperture.radius {
            form.number("Aperture.radius", "Opening", radius, 1.0);
        }
        if let Some(f_stop) = &mut aperture.f_stop {
            form.number("Aperture.f_stop", "f-stop", f_stop, 2.8);
        }
        form.number("Aperture.focus", "Focus", &mut aperture.focus, focus);
    }
    camera.aperture = is_open.then_some(aperture);
}

fn noise(ui: &mut Ui, document: &mut Document) {
    let mut noise = document.scene().noise.clone();
    let default = Noise::default();
    let clouds = &document.scene().clouds;
    let is_used = clouds.is_empty() || clouds.iter().any(|cloud| cloud.noise.is_none());
    let mut form = Form::new(ui).keyed(document, "");
    form.works(is_used, "All clouds have noise of their own.");
    noise_rows(&mut form, &mut noise);
    form.vector("Noise.offset", "Offset", &mut noise.offset, default.offset);
    form.rotation("Noise.rotation", "Rotation", &mut noise.rotation);
    let change = form.changed();
    apply(document, change, |scene| scene.noise = noise);
}

fn ground(ui: &mut Ui, document: &mut Document) {
    let mut ground = document.scene().ground.clone();
    let default = Ground::default();
    let mut form = Form::new(ui).keyed(document, "");
    form.color("Ground.albedo", "Albedo", &mut ground.albedo, default.albedo);
    form.number("Ground.altitude", "Altitude", &mut ground.altitude, default.altitude);
    let mut kinds = vec![
        ("Even", choice("GroundKind.even"), GroundKind::Even),
        ("Land", choice("GroundKind.land"), GroundKind::Land(Land::default())),
        ("Water", choice("GroundKind.water"), GroundKind::Water(Water::default())),
    ];
    if ground.kind.picture().is_some() {
        kinds.push(("Picture", choice("GroundKind.picture"), ground.kind.clone()));
    }
    form.choice("Ground.kind", "Kind", &mut ground.kind, &kinds);
    match &mut ground.kind {
        GroundKind::Even => {}
        GroundKind::Picture(picture) => {
            let default = GroundPicture::default();
            form.number("GroundPicture.width", "Width", &mut picture.width, default.width);
            form.number("GroundPicture.x", "East", &mut picture.x, default.x);
            form.number("GroundPicture.z", "South", &mut picture.z, default.z);
        }
        GroundKind::Land(land) => {
            let default = Land::default();
            form.slider("Land.variation", "Variation", &mut land.variation, default.variation, 0.0..=1.0);
            form.number("Land.field_width", "Field width", &mut land.field_width, default.field_width);
        }
        GroundKind::Water(water) => {
            form.slider("Water.wind", "Wind", &mut water.wind, Water::default().wind, 0.0..=20.0);
        }
    }
    let change = form.changed();
    hint(ui, &ground_told(&ground.kind));
    apply(document, change, |scene| scene.ground = ground);
}

/// Whether anything is otherwise at another time.
fn moves(scene: &Scene) -> bool {
    let blows = scene.wind.velocity != DVec3::ZERO || scene.wind.shear != DVec3::ZERO;
    let renews = |noise: &Noise| noise.rate > 0.0;
    let lives = |cloud: &Cloud| cloud.life.is_some() || cloud.noise.as_ref().is_some_and(renews);
    blows || scene.timeline.is_some() || renews(&scene.noise) || scene.clouds.iter().any(lives)
}

/// Where a picture of the ground comes from.
fn ground_told(kind: &GroundKind) -> String {
    let Some(picture) = kind.picture() else {
        return "Drop a PNG or EXR picture into the window to lay it on the ground, seen from above."
            .to_owned();
    };
    let size = picture.colors().map_or_else(String::new, |colors| {
        let [width, height] = colors.size();
        format!(", kept as {width} x {height} pixels")
    });
    format!("It is {}{size}. Drop another picture into the window to take that.", picture.file)
}

fn wind(ui: &mut Ui, document: &mut Document) {
    let (mut wind, mut time) = (document.scene().wind.clone(), document.scene().time);
    let mut form = Form::new(ui).keyed(document, "");
    form.vector("Wind.velocity", "Velocity", &mut wind.velocity, DVec3::ZERO);
    form.vector("Wind.shear", "Shear", &mut wind.shear, DVec3::ZERO);
    form.works(moves(document.scene()), "Nothing moves: there is no wind, no noise with renewals, no life.");
    form.slider("Scene.time", "Time", &mut time, 0.0, 0.0..=600.0);
    let change = form.changed();
    apply(document, change, |scene| (scene.wind, scene.time) = (wind, time));
}
