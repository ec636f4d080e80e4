//! Lights beside the sun: a row each, what they are, and their numbers.

use eframe::egui::Ui;
use egui_phosphor::regular as icon;

use super::{SunPanel, apply, hint};
use crate::{
    editor::{Document, form::Form, labels::name_widget, words::choice},
    scene::{Light, LightSource, Lightning, MAX_LIGHTS, Scene, Sun, SunPosition},
};

/// Inspector of the lights.
#[derive(Debug, Default)]
pub struct LightsPanel {
    /// Of those that stand far away.
    suns: [SunPanel; MAX_LIGHTS],
}

impl LightsPanel {
    /// Shows all of them.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        let count = document.scene().lights.len();
        for index in 0..count {
            ui.push_id(("light", index), |ui| self.light(ui, document, index));
            if document.scene().lights.len() < count {
                // It was taken away.
                return;
            }
            ui.separator();
        }
        if count < MAX_LIGHTS {
            add(ui, document);
        } else {
            hint(ui, "There is room for no more lights.");
        }
    }

    fn light(&mut self, ui: &mut Ui, document: &mut Document, index: usize) {
        let mut light = document.scene().lights[index].clone();
        let label = light.label(index);
        let taken = ui
            .horizontal(|ui| {
                ui.strong(&label);
                let remove = ui.small_button(icon::TRASH).on_hover_text("Takes this light away");
                name_widget(ui, &remove, &format!("Remove {label}"));
                remove.clicked()
            })
            .inner;
        if taken {
            document.adjust("Remove light", index as u64, |scene| remove(scene, index));
            return;
        }
        let mut form = Form::new(ui).keyed(document, "");
        form.text("Light.name", "Name", &mut light.name, "no name");
        let mut shines = !light.hidden;
        form.check("Light.hidden", "Shines", &mut shines, true);
        let kinds = kinds(&light.source);
        form.choice("Light.source", "What shines", &mut light.source, &kinds);
        let change = form.changed();
        light.hidden = !shines;
        apply(document, change, |scene| put(scene, index, light));
        match &document.scene().lights[index].source {
            LightSource::Moon(_) | LightSource::Key(_) => self.suns[index].ui_of(ui, document, Some(index)),
            LightSource::Lightning(flash) => lightning(ui, document, index, flash.clone()),
        }
    }
}

/// Puts a light in its place; keys go on where it is of another kind with the same numbers, else they go.
fn put(scene: &mut Scene, index: usize, light: Light) {
    let [before, after] = [&scene.lights[index], &light].map(|light| light.source.kind());
    if let Some(timeline) = scene.timeline.as_mut().filter(|_| before != after) {
        let [old, new] = [before, after].map(|kind| format!("lights[{index}].source.{kind}"));
        let both_far = ![before, after].contains(&"lightning");
        timeline.tracks.retain_mut(|track| match track.path.strip_prefix(&old).map(str::to_owned) {
            Some(rest) if both_far => {
                track.path = new.clone() + &rest;
                true
            }
            found => found.is_none(),
        });
    }
    scene.lights[index] = light;
}

/// What a light can be made: of suns the numbers stay.
fn kinds(source: &LightSource) -> [(&'static str, &'static str, LightSource); 3] {
    let (sun, flash) = match source {
        LightSource::Moon(sun) | LightSource::Key(sun) => (sun.clone(), Lightning::default()),
        LightSource::Lightning(flash) => (key(), flash.clone()),
    };
    [
        ("Moon", choice("LightSource.moon"), LightSource::Moon(sun.clone())),
        ("Key", choice("LightSource.key"), LightSource::Key(sun)),
        ("Lightning", choice("LightSource.lightning"), LightSource::Lightning(flash)),
    ]
}

/// A rim light: low in the north-east, warm.
fn key() -> Sun {
    let position = SunPosition::Angles { azimuth_deg: 45.0, elevation_deg: 15.0 };
    Sun { position, irradiance: [0.6, 0.4, 0.25], ..Sun::default() }
}

fn add(ui: &mut Ui, document: &mut Document) {
    let button = ui.button(format!("{} Add a light", icon::PLUS));
    if button.on_hover_text("A key or rim light on the clouds; make it a moon or lightning then.").clicked() {
        let light = Light { name: String::new(), source: LightSource::Key(key()), hidden: false };
        document.adjust("Add light", document.scene().lights.len() as u64, |scene| scene.lights.push(light));
    }
}

/// Takes a light away, and its keys with it; those of lights after it go on with theirs.
fn remove(scene: &mut Scene, index: usize) {
    scene.lights.remove(index);
    let Some(timeline) = &mut scene.timeline else { return };
    let path = |index: usize| format!("lights[{index}]");
    timeline.tracks.retain(|track| !track.path.starts_with(&path(index)));
    for track in &mut timeline.tracks {
        for later in index + 1..=MAX_LIGHTS {
            if let Some(rest) = track.path.strip_prefix(&path(later)) {
                track.path = path(later - 1) + rest;
                break;
            }
        }
    }
}

fn lightning(ui: &mut Ui, document: &mut Document, index: usize, mut flash: Lightning) {
    let usual = Lightning::default();
    let mut form = Form::new(ui).keyed(document, &format!("lights[{index}].source.lightning"));
    form.vector("Lightning.position", "Position", &mut flash.position, usual.position);
    form.slider("Lightning.radius", "Radius", &mut flash.radius, usual.radius, 10.0..=1000.0);
    form.color("Lightning.irradiance", "Irradiance", &mut flash.irradiance, usual.irradiance);
    let change = form.changed();
    hint(ui, "It lights the cloud that it is in, and only where light is solved for (model `moments`).");
    apply(document, change, |scene| scene.lights[index].source = LightSource::Lightning(flash));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::timeline::{Key, Timeline, Track};

    #[test]
    fn keys_of_a_light_go_with_it_and_those_of_later_ones_stay_theirs() {
        let light = |name: &str| Light {
            name: name.to_owned(),
            source: LightSource::Lightning(Lightning::default()),
            hidden: false,
        };
        let track = |index: usize| Track {
            path: format!("lights[{index}].source.lightning.radius"),
            keys: vec![Key::new(0.0, 10.0 + index as f64)],
        };
        let mut scene = Scene {
            lights: vec![light("a"), light("b"), light("c")],
            timeline: Some(Timeline { tracks: (0..3).map(track).collect(), ..Timeline::default() }),
            ..Scene::default()
        };
        remove(&mut scene, 1);
        let names: Vec<_> = scene.lights.iter().map(|light| light.name.as_str()).collect();
        assert_eq!(names, ["a", "c"]);
        let tracks = &scene.timeline.as_ref().unwrap().tracks;
        let found: Vec<_> = tracks.iter().map(|track| (track.path.as_str(), track.keys[0].value)).collect();
        let path = |index: usize| format!("lights[{index}].source.lightning.radius");
        assert_eq!(found, [(path(0).as_str(), 10.0), (path(1).as_str(), 12.0)]);
        assert!(scene.validate().is_ok());
    }
}
