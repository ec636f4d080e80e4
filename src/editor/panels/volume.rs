//! A volume of a file: its numbers.

use eframe::egui::Ui;

use super::{apply, hint, object::path};
use crate::{
    editor::{Document, form::Form, words::choice},
    scene::{Between, Beyond, Cloud, Grid, Sequence, Timeline, Up, Volume, timeline::Owner},
};

/// The numbers of a cloud that is a volume.
pub(super) fn volume(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let Some(mut volume) = cloud.volume.clone() else { return };
    hint(ui, &told(&volume));
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    let usual = Volume::default();
    let extinction = volume.read_grid().map_or(usual.extinction, |grid| Volume::usual_extinction(grid));
    let most = (10.0 * extinction).max(2.0 * volume.extinction);
    form.slider("Volume.extinction", "Extinction at 1", &mut volume.extinction, extinction, 0.0..=most);
    form.number("Volume.scale", "Metres per unit", &mut volume.scale, usual.scale);
    let ups = [("Y", choice("Up.y"), Up::Y), ("Z", choice("Up.z"), Up::Z)];
    form.choice("Volume.up", "Axis that goes up", &mut volume.up, &ups);
    form.vector("Volume.place", "Place", &mut volume.place, usual.place);
    form.rotation("Volume.orientation", "Rotation", &mut volume.orientation);
    let change = form.changed();
    if let Some(depth) = thickness(&volume) {
        hint(ui, &format!("Optical thickness across, were it as dense as at the most: {depth:.1}."));
    }
    apply(document, change, |scene| scene.clouds[index].volume = Some(volume));
}

/// How a cloud that is a volume goes through its steps.
pub(super) fn sequence(ui: &mut Ui, document: &mut Document, index: usize, cloud: &Cloud) {
    let Some(mut volume) = cloud.volume.clone() else { return };
    let mut sequence = volume.sequence.clone().unwrap_or_default();
    let rate = document.scene().timeline.as_ref().map_or(Timeline::default().fps, |timeline| timeline.fps);
    let mut fps = sequence.fps.unwrap_or(rate);
    let usual = Sequence::default();
    let mut form = Form::new(ui).keyed(document, &path(document, Owner::Cloud(index)));
    form.slider("Sequence.fps", "Steps per second", &mut fps, rate, 1.0..=60.0);
    form.number("Sequence.start", "Start", &mut sequence.start, usual.start);
    let beyond = [
        ("Hold", choice("Beyond.hold"), Beyond::Hold),
        ("Loop", choice("Beyond.loop"), Beyond::Loop),
        ("Nothing", choice("Beyond.nothing"), Beyond::Nothing),
    ];
    form.choice("Sequence.before", "Before the first", &mut sequence.before, &beyond);
    form.choice("Sequence.after", "After the last", &mut sequence.after, &beyond);
    let between = [
        ("Auto", choice("Between.auto"), Between::Auto),
        ("Nearest", choice("Between.nearest"), Between::Nearest),
        ("Blend", choice("Between.blend"), Between::Blend),
        ("Flow", choice("Between.flow"), Between::Flow),
    ];
    form.choice("Sequence.between", "Between steps", &mut sequence.between, &between);
    let change = form.changed();
    // Without a number of its own it goes on following the timeline.
    sequence.fps = sequence.fps.map(|_| fps).or((fps != rate).then_some(fps));
    volume.sequence = Some(sequence);
    apply(document, change, |scene| scene.clouds[index].volume = Some(volume));
}

/// What the file holds.
fn told(volume: &Volume) -> String {
    let Some(grid) = volume.read_grid() else {
        return format!("{} was not read: open the scene anew.", volume.file);
    };
    let size = grid.size();
    let of = match volume.steps() {
        Some((first, last, count)) => format!("{count} steps, {first} to {last}, the first one of"),
        None => format!("{:.1} MiB,", grid.bytes() as f64 / f64::from(1 << 20)),
    };
    format!(
        "`{}` of {}: {of} {} x {} x {} voxels. Drop another file into the window to add it.",
        grid.name, volume.file, size.x, size.y, size.z
    )
}

/// Optical thickness of its shortest edge where all of it is as dense as at the most.
fn thickness(volume: &Volume) -> Option<f64> {
    let grid: &Grid = volume.read_grid()?;
    let edges = volume.scale * grid.voxel() * grid.size().as_dvec3();
    Some(volume.extinction * f64::from(grid.most) * edges.min_element())
}
