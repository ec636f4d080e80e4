//! Keys and what is edited: numbers that have a track become keys, and tracks follow their objects.

use super::Document;
use crate::scene::{
    Ellipsoid, Scene, Timeline,
    timeline::{Curve, Key, Owner, Place, Track},
};

/// How a field stands with the timeline at the playhead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keyed {
    /// It has no track.
    No,
    /// It has a track, and no key here.
    Between,
    /// It has a key here.
    Here,
}

/// Where and when keys are set: what is seen, at the playhead.
#[derive(Debug, Clone, Copy)]
pub struct Now<'a> {
    scene: &'a Scene,
    timeline: &'a Timeline,
}

impl<'a> Now<'a> {
    /// Of a scene at its own time; nothing without a timeline.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        Some(Self { scene, timeline: scene.timeline.as_ref()? })
    }

    /// How the numbers `paths` of one field stand: as the one that has most.
    pub fn keyed(&self, paths: &[String]) -> Keyed {
        let tracks: Vec<&Track> =
            paths.iter().filter_map(|path| track(self.timeline, self.scene, path)).collect();
        match () {
            () if tracks.iter().any(|track| self.key_here(track).is_some()) => Keyed::Here,
            () if tracks.is_empty() => Keyed::No,
            () => Keyed::Between,
        }
    }

    /// The number of the key of `track` at the playhead: less than half a frame away.
    fn key_here(&self, track: &Track) -> Option<usize> {
        key_at(track, self.scene.time, self.timeline.fps)
    }
}

/// The number of the key of `track` that is less than half a frame from `time`, s.
fn key_at(track: &Track, time: f64, fps: f64) -> Option<usize> {
    track.keys.iter().position(|key| (key.time - time).abs() < 0.499 / fps)
}

/// The track of the number that `path` leads to, in whatever words the track's own path says it.
fn track<'a>(timeline: &'a Timeline, scene: &Scene, path: &str) -> Option<&'a Track> {
    let place = Place::find(path, scene).ok()?;
    timeline.tracks.iter().find(|track| Place::find(&track.path, scene).is_ok_and(|own| own == place))
}

impl Document {
    /// Sets keys of the numbers `paths` at the playhead, or takes those away that are there.
    pub fn toggle_keys(&mut self, paths: &[String]) {
        let Some(now) = Now::of(self.scene()) else { return };
        if now.keyed(paths) == Keyed::Here {
            self.edit("Remove key", |scene| each(scene, paths, remove_key));
        } else {
            self.set_keys(paths);
        }
    }

    /// Sets keys of the numbers `paths` at the playhead.
    pub fn set_keys(&mut self, paths: &[String]) {
        self.edit("Set key", |scene| each(scene, paths, set_key));
    }

    /// Sets keys of place, size, rotation and density of what is selected.
    pub fn key_selected(&mut self) {
        let scene = self.scene();
        let path = |id: &super::EllipsoidId| {
            crate::scene::timeline::owner_path(Owner::Ellipsoid(id.cloud, id.ellipsoid), scene)
        };
        let fields = [("center", 3), ("radii", 3), ("orientation", 4)];
        let of = |object: String| {
            let numbers = fields.iter().flat_map(|(field, n)| (0..*n).map(move |i| format!(".{field}[{i}]")));
            let all = numbers.chain([".density".to_owned()]);
            all.map(|rest| format!("{object}{rest}")).collect::<Vec<_>>()
        };
        let paths: Vec<String> = self.selection().ellipsoids.iter().map(path).flat_map(of).collect();
        self.set_keys(&paths);
    }
}

fn each(scene: &mut Scene, paths: &[String], change: fn(&mut Timeline, &Scene, Place)) {
    // A track of the exposure turns nothing on or off.
    let is_metered = scene.is_metered();
    let Some(mut timeline) = scene.timeline.take() else { return };
    if paths.iter().any(|path| path == "exposure") {
        scene.auto_exposure = Some(is_metered);
    }
    for path in paths {
        if let Ok(place) = Place::find(path, scene) {
            change(&mut timeline, scene, place);
        }
    }
    scene.timeline = Some(timeline);
}

/// Sets a key of the number at `place`, as it is, at the scene's time.
fn set_key(timeline: &mut Timeline, scene: &Scene, place: Place) {
    let Ok(value) = place.read(scene) else { return };
    let time = timeline.wrapped(scene.time).clamp(0.0, timeline.length);
    let (fps, path) = (timeline.fps, place.path(scene));
    let own = |track: &Track| Place::find(&track.path, scene).is_ok_and(|own| own == place);
    let Some(index) = timeline.tracks.iter().position(own) else {
        timeline.tracks.push(Track { path, keys: vec![Key::new(time, value)] });
        return;
    };
    let track = &mut timeline.tracks[index];
    if let Some(key) = key_at(track, time, fps) {
        track.keys[key].value = value;
        return;
    }
    let at = track.keys.partition_point(|key| key.time < time);
    // The way that a step or a line went on, the new key goes on, too.
    let interpolation = at.checked_sub(1).map(|before| track.keys[before].interpolation).unwrap_or_default();
    track.keys.insert(at, Key { interpolation, ..Key::new(time, value) });
}

fn remove_key(timeline: &mut Timeline, scene: &Scene, place: Place) {
    let (time, fps) = (scene.time, timeline.fps);
    for track in &mut timeline.tracks {
        if Place::find(&track.path, scene).is_ok_and(|own| own == place)
            && let Some(key) = key_at(track, time, fps)
        {
            track.keys.remove(key);
        }
    }
    timeline.tracks.retain(|track| !track.keys.is_empty());
}

/// Makes of `edited`, which was `posed` before, the scene as its file shall have it: what changed of
/// numbers with a track becomes a key, and the numbers themselves are what `stored` has.
pub fn unpose(stored: &Scene, posed: &Scene, edited: &mut Scene) {
    // The playhead is no part of the file, unless there is no timeline any more.
    if edited.timeline.is_some() {
        edited.time = stored.time;
    }
    let Some(mut timeline) = edited.timeline.take() else { return };
    let moment = Scene { time: posed.time, ..edited.clone() };
    let mut back = Vec::new();
    timeline.tracks.retain_mut(|track| {
        let Ok(before) = Place::find(&track.path, posed) else { return true };
        let Some(after) = follow(&before, posed, edited) else { return false };
        track.path = after.path(edited);
        if let Ok(value) = before.read(stored)
            && has_track(posed, &before)
        {
            back.push((before, after, value));
        }
        true
    });
    for (before, after, value) in back {
        if before.read(posed) != after.read(&moment) {
            set_key(&mut timeline, &moment, after.clone());
        }
        // What could be read can be written.
        let _ = after.write(edited, value);
    }
    edited.timeline = Some(timeline);
}

/// Whether the number at `place` was one of those that curves move.
fn has_track(scene: &Scene, place: &Place) -> bool {
    let tracks = scene.timeline.iter().flat_map(|timeline| &timeline.tracks);
    tracks.into_iter().any(|track| Place::find(&track.path, scene).is_ok_and(|own| own == *place))
}

/// Where the number at `place` of `before` is in `after`; nothing where its object is gone.
fn follow(place: &Place, before: &Scene, after: &Scene) -> Option<Place> {
    let owner = match place.owner {
        Owner::Scene => Owner::Scene,
        Owner::Cloud(cloud) => Owner::Cloud(follow_cloud(cloud, before, after)?),
        Owner::Ellipsoid(cloud, number) => {
            let (cloud, number) = follow_ellipsoid((cloud, number), before, after)?;
            Owner::Ellipsoid(cloud, number)
        }
    };
    let place = place.in_object(owner);
    place.read(after).is_ok().then_some(place)
}

fn follow_cloud(index: usize, before: &Scene, after: &Scene) -> Option<usize> {
    let cloud = &before.clouds[index];
    let stays = after.clouds.get(index) == Some(cloud);
    let elsewhere = |i: &usize| after.clouds[*i] == *cloud && before.clouds.get(*i) != Some(cloud);
    if stays {
        return Some(index);
    }
    let same_count = before.clouds.len() == after.clouds.len();
    (0..after.clouds.len()).find(elsewhere).or(same_count.then_some(index)).or_else(|| {
        // Others went or came, and it was changed itself: by its name.
        let own = |i: &usize| !cloud.name.is_empty() && after.clouds[*i].name == cloud.name;
        (0..after.clouds.len()).find(own)
    })
}

fn follow_ellipsoid(
    (cloud, number): (usize, usize),
    before: &Scene,
    after: &Scene,
) -> Option<(usize, usize)> {
    // What a move to another cloud changes, or hiding, makes no other of it.
    let bare = |e: &Ellipsoid| Ellipsoid { edge: None, hidden: false, locked: false, ..e.clone() };
    let get = |scene: &Scene, (i, j): (usize, usize)| Some(bare(scene.clouds.get(i)?.ellipsoids.get(j)?));
    let own = get(before, (cloud, number))?;
    if get(after, (cloud, number)).as_ref() == Some(&own) {
        return Some((cloud, number));
    }
    let all = after.clouds.iter().enumerate().flat_map(|(i, c)| (0..c.ellipsoids.len()).map(move |j| (i, j)));
    let moved = |at: &(usize, usize)| {
        get(after, *at).as_ref() == Some(&own) && get(before, *at).as_ref() != Some(&own)
    };
    let counts = |scene: &Scene| scene.clouds.iter().map(|c| c.ellipsoids.len()).collect::<Vec<_>>();
    all.into_iter().find(moved).or_else(|| (counts(before) == counts(after)).then_some((cloud, number)))
}

/// The curve of a track of the scene's timeline.
pub fn curve(timeline: &Timeline, track: usize) -> Option<Curve> {
    Curve::new(&timeline.tracks.get(track)?.keys, timeline.period())
}
