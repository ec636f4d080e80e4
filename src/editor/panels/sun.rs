//! The sun: by dial, by vector, by place and time.

use chrono::{DateTime, Datelike, FixedOffset, TimeDelta, Timelike};
use eframe::egui::{DragValue, Slider, TextEdit, Ui};
use glam::DVec3;

use super::{hint, sun_dial::SunDial};
use crate::{
    editor::{Document, form::Form, labels::name_widget, words::choice},
    scene::{LightSource, Scene, Sun, SunPosition},
};

/// Where a sun by place begins: a summer's evening in Utrecht.
const PLACE: (f64, f64, &str) = (52.09, 5.12, "2026-06-21T18:30:00+02:00");

/// Stands for the dial where fields are told apart.
const DIAL: u64 = 1;

/// Inspector of the sun.
#[derive(Debug, Default)]
pub struct SunPanel {
    /// The time as it is being typed; not a time until it is whole.
    typed: Option<String>,
    complaint: Option<String>,
}

impl SunPanel {
    /// Shows the sun.
    pub fn ui(&mut self, ui: &mut Ui, document: &mut Document) {
        self.ui_of(ui, document, None);
    }

    /// Shows the sun, or a light beside it that stands as far away.
    pub fn ui_of(&mut self, ui: &mut Ui, document: &mut Document, light: Option<usize>) {
        let Some((mut sun, object)) = of(document.scene(), light) else { return };
        let before = sun.clone();
        let heading = heading_deg(document.scene().camera().forward());
        let (azimuth, elevation) = angles_deg(sun.to_sun());
        let kinds = [
            ("Compass and height", choice("SunPosition.angles"), angles(azimuth, elevation)),
            (
                "Place and time",
                choice("SunPosition.place"),
                SunPosition::Place {
                    latitude_deg: PLACE.0,
                    longitude_deg: PLACE.1,
                    time: PLACE.2.to_owned(),
                    hours: 0.0,
                },
            ),
            ("Direction", choice("SunPosition.direction"), SunPosition::Direction(sun.to_sun())),
        ];
        let mut form = Form::new(ui).keyed(document, &object);
        form.choice("Sun.position", "Position", &mut sun.position, &kinds);
        let dial = SunDial { azimuth_deg: azimuth, elevation_deg: elevation, heading_deg: heading };
        if let Some((azimuth, elevation)) = dial.ui(form.ui()) {
            sun.position = angles(azimuth, elevation);
        }
        match &mut sun.position {
            SunPosition::Angles { azimuth_deg, elevation_deg } => {
                let path = "SunPosition.angles.azimuth_deg";
                form.slider(path, "Azimuth", azimuth_deg, 225.0, 0.0..=360.0);
                let path = "SunPosition.angles.elevation_deg";
                form.slider(path, "Elevation", elevation_deg, 45.0, -10.0..=90.0);
            }
            SunPosition::Direction(v) => {
                form.vector("SunPosition.direction", "Direction", v, DVec3::new(-0.5, 0.7, 0.5));
            }
            SunPosition::Place { latitude_deg, longitude_deg, time, hours } => {
                let path = "SunPosition.place.latitude_deg";
                form.slider(path, "Latitude", latitude_deg, PLACE.0, -90.0..=90.0);
                let path = "SunPosition.place.longitude_deg";
                form.slider(path, "Longitude", longitude_deg, PLACE.1, -180.0..=180.0);
                self.time(form.ui(), time);
                form.slider("SunPosition.place.hours", "Hours after", hours, 0.0, -12.0..=12.0);
                hint(form.ui(), &format!("Azimuth {azimuth:.1}°, elevation {elevation:.1}°"));
            }
        }
        brightness(&mut form, &mut sun);
        // Dial and time are no rows of the form.
        let change = form.changed();
        if let Some(paths) = change.as_ref().and_then(|change| change.keys.as_ref()) {
            document.toggle_keys(paths);
            return;
        }
        let own = DIAL + light.map_or(0, |light| 1 + light as u64);
        let name = if light.is_none() { "Move the sun" } else { "Move the light" };
        let change = change.map_or((name, own), |change| (change.name, change.field));
        if sun != before {
            document.adjust(change.0, change.1, |scene| put(scene, light, sun));
        }
    }

    /// Date and time: as text, and by sliders over the day and the year.
    fn time(&mut self, ui: &mut Ui, time: &mut String) {
        let shown = self.typed.get_or_insert_with(|| time.clone());
        ui.horizontal(|ui| {
            let label = ui.label("Time");
            let response = ui.add(TextEdit::singleline(shown).desired_width(ui.available_width()));
            let response = response.labelled_by(label.id);
            if response.lost_focus() {
                match DateTime::parse_from_rfc3339(shown) {
                    Ok(_) => (*time, self.complaint) = (shown.clone(), None),
                    Err(reason) => {
                        self.complaint = Some(format!(
                            "`{shown}` is no time ({reason}): write date, time and zone, such as {}",
                            PLACE.2
                        ));
                    }
                }
            } else if !response.has_focus() && self.complaint.is_none() {
                shown.clone_from(time);
            }
        });
        if let Some(complaint) = &self.complaint {
            ui.colored_label(ui.visuals().error_fg_color, complaint);
        }
        if let Ok(when) = DateTime::parse_from_rfc3339(time)
            && let Some(when) = by_sliders(ui, when)
        {
            (*time, self.complaint, self.typed) = (when.to_rfc3339(), None, None);
        }
    }
}

/// The sun, or a light beside it, and the path of its keys.
fn of(scene: &Scene, light: Option<usize>) -> Option<(Sun, String)> {
    let Some(index) = light else { return Some((scene.sun.clone(), String::new())) };
    let source = &scene.lights.get(index)?.source;
    match source {
        LightSource::Moon(sun) | LightSource::Key(sun) => {
            Some((sun.clone(), format!("lights[{index}].source.{}", source.kind())))
        }
        LightSource::Lightning(_) => None,
    }
}

fn put(scene: &mut Scene, light: Option<usize>, sun: Sun) {
    let place = match light {
        None => Some(&mut scene.sun),
        Some(index) => scene.lights[index].source.as_sun_mut(),
    };
    if let Some(place) = place {
        *place = sun;
    }
}

/// The brightness and the size of the disc.
fn brightness(form: &mut Form<'_>, sun: &mut Sun) {
    let default = Sun::default();
    form.color("Sun.irradiance", "Irradiance", &mut sun.irradiance, default.irradiance);
    let diameter = &mut sun.angular_diameter_deg;
    form.slider("Sun.angular_diameter_deg", "Diameter", diameter, default.angular_diameter_deg, 0.0..=5.0);
}

/// Hour of the day and day of the year; the new time where one was moved.
fn by_sliders(ui: &mut Ui, when: DateTime<FixedOffset>) -> Option<DateTime<FixedOffset>> {
    let midnight = when - TimeDelta::seconds(i64::from(when.num_seconds_from_midnight()));
    let mut hours = f64::from(when.num_seconds_from_midnight()) / 3600.0;
    let mut day = when.ordinal();
    ui.horizontal(|ui| {
        ui.label("Hour");
        ui.spacing_mut().slider_width = 110.0;
        let slider = Slider::new(&mut hours, 0.0..=23.99).show_value(false);
        let moved = ui.add(slider);
        name_widget(ui, &moved, "Hour of the day");
        ui.label("Day");
        let dragged = ui.add(DragValue::new(&mut day).range(1..=365));
        name_widget(ui, &dragged, "Day of the year");
        if moved.changed() {
            // To the minute: nobody means the seconds of a slider.
            return Some(midnight + TimeDelta::minutes((hours * 60.0).round() as i64));
        }
        dragged.changed().then(|| when.with_ordinal(day)).flatten()
    })
    .inner
}

fn angles(azimuth_deg: f64, elevation_deg: f64) -> SunPosition {
    SunPosition::Angles { azimuth_deg, elevation_deg }
}

/// Compass direction, degrees clockwise from north in 0 to 360.
fn heading_deg(v: DVec3) -> f64 {
    // Adding zero makes -0 a 0.
    v.x.atan2(-v.z).to_degrees().rem_euclid(360.0) + 0.0
}

/// Azimuth and elevation of a unit vector, degrees.
fn angles_deg(v: DVec3) -> (f64, f64) {
    (heading_deg(v), v.y.clamp(-1.0, 1.0).asin().to_degrees())
}
