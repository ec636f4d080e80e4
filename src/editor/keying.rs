//! Diamonds beside fields: which numbers of the scene a field holds, and how they are keyed.

use std::sync::Arc;

use eframe::egui::{self, Color32, Painter, Pos2, Rect, Ui, vec2};

use super::{
    Document,
    labels::name_widget,
    tracks::{Keyed, Now},
};
use crate::scene::Scene;

/// What the rows of a form are about.
pub struct Keying {
    scene: Arc<Scene>,
    /// Path of the cloud, the ellipsoid or the light; empty for the world.
    object: String,
}

impl Keying {
    /// For rows about `object`; nothing where the document has no timeline.
    pub fn of(document: &Document, object: &str) -> Option<Self> {
        let scene = document.shared_scene();
        scene.timeline.is_some().then(|| Self { scene, object: object.to_owned() })
    }

    /// Paths in the scene of the numbers of the field `path` of the schema, and how they are keyed.
    pub fn keys(&self, path: &str, numbers: &[&str]) -> Option<(Vec<String>, Keyed)> {
        let (kind, field) = path.split_once('.')?;
        let object = &self.object;
        // The sun, or a light beside it.
        let sun = || if object.is_empty() { "sun".to_owned() } else { object.clone() };
        let home = match kind {
            "Scene" => String::new(),
            "SunPosition" => format!("{}.position", sun()),
            "Atmosphere" => "sky.atmosphere".to_owned(),
            "Land" | "Water" => format!("ground.kind.{}", kind.to_lowercase()),
            "GroundPicture" => "ground.kind.picture".to_owned(),
            "Projection" => "camera.projection".to_owned(),
            "Sun" => sun(),
            "Sky" | "Ground" | "Wind" | "Noise" | "Camera" => kind.to_lowercase(),
            "Cloud" | "Ellipsoid" | "Lightning" => object.clone(),
            "Edge" | "Droplets" | "Life" | "Growth" | "Volume" => format!("{object}.{}", kind.to_lowercase()),
            "Phase" => format!("{object}.droplets.phase"),
            "Sequence" => format!("{object}.volume.sequence"),
            _ => return None,
        };
        let field = if home.is_empty() { field.to_owned() } else { format!("{home}.{field}") };
        let paths: Vec<String> = numbers.iter().map(|number| format!("{field}{number}")).collect();
        let keyed = Now::of(&self.scene)?.keyed(&paths);
        // Time is the playhead's.
        (!paths.is_empty() && field != "time").then_some((paths, keyed))
    }
}

/// A diamond: hollow and faint without a track, hollow between keys, filled on a key.
pub fn key_button(ui: &Ui, room: Rect, name: &str, keyed: Keyed) -> bool {
    let response = ui.interact(room, ui.id().with("key"), egui::Sense::click());
    let help = match keyed {
        Keyed::No => "Sets the first key: from now on it changes over time",
        Keyed::Between => "Sets a key here",
        Keyed::Here => "Takes the key here away",
    };
    let response = response.on_hover_text(help);
    let visuals = ui.visuals();
    let color = match keyed {
        Keyed::No if !response.hovered() => visuals.weak_text_color().gamma_multiply(0.5),
        _ => visuals.hyperlink_color,
    };
    diamond(ui.painter(), room.center(), 4.5, color, keyed == Keyed::Here);
    name_widget(ui, &response, &format!("Key {name}"));
    response.clicked()
}

/// The mark of a key.
pub fn diamond(painter: &Painter, at: Pos2, radius: f32, color: Color32, filled: bool) {
    let corners = [vec2(0.0, -radius), vec2(radius, 0.0), vec2(0.0, radius), vec2(-radius, 0.0)];
    let points = corners.map(|corner| at + corner).to_vec();
    let fill = if filled { color } else { Color32::TRANSPARENT };
    painter.add(egui::Shape::convex_polygon(points, fill, egui::Stroke::new(1.2, color)));
}
