//! What the menus and keys do to a scene. All of it goes through the document: one step of
//! undo each, and the selection follows.

use std::collections::BTreeSet;

use glam::{BVec3, DQuat, DVec3};

use super::{Document, EllipsoidId, Selection};
use crate::scene::{Cloud, Ellipsoid, Heaps, Preset, Scene};

/// Radius of an ellipsoid that has none beside it to take after, metres.
const RADIUS: f64 = 100.0;

impl Document {
    /// The selected ellipsoids that are not locked.
    pub fn free_selection(&self) -> BTreeSet<EllipsoidId> {
        self.selection().ellipsoids.iter().copied().filter(|id| !self.is_locked(*id)).collect()
    }

    /// Adds an ellipsoid around `center` (metres) to the active cloud, or to a new one, and
    /// selects it. It takes after the active one.
    pub fn add_ellipsoid(&mut self, center: DVec3) {
        let like = self.selection().active.and_then(|id| self.ellipsoid(id)).cloned();
        let ellipsoid = match like {
            Some(like) => Ellipsoid { name: None, center, hidden: false, locked: false, ..like },
            None => Ellipsoid::new(center, DVec3::splat(RADIUS)),
        };
        let into = self.active_cloud().map(|(index, _)| index);
        self.edit_and_select("Add ellipsoid", |scene, selection| {
            // A layer takes none, nor does a mesh or a volume.
            let takes = |index: &usize| {
                let cloud = &scene.clouds[*index];
                cloud.layer.is_none() && !cloud.is_of_file()
            };
            let found = into.or(scene.clouds.len().checked_sub(1)).filter(takes);
            let cloud = found.unwrap_or_else(|| push_cloud(scene));
            scene.clouds[cloud].ellipsoids.push(ellipsoid);
            let last = scene.clouds[cloud].ellipsoids.len() - 1;
            *selection = Selection::one(EllipsoidId { cloud, ellipsoid: last });
        });
    }

    /// Adds an empty cloud and selects it: what is added next goes into it.
    pub fn add_cloud(&mut self) {
        self.edit_and_select("Add cloud", |scene, selection| {
            *selection = Selection { cloud: Some(push_cloud(scene)), ..Selection::default() };
        });
    }

    /// Adds the clouds of a preset, moved by `offset` (metres), and selects the first of them.
    pub fn add_preset(&mut self, preset: Preset, seed: u64, offset: DVec3) {
        let mut clouds = preset.scene(seed).clouds;
        // Their lives are of another timeline.
        clouds.iter_mut().for_each(|cloud| cloud.life = None);
        clouds.iter_mut().for_each(|cloud| cloud.shift(offset));
        self.edit_and_select("Add preset", |scene, selection| {
            let first = scene.clouds.len();
            scene.clouds.extend(clouds);
            *selection = Selection::cloud(scene, first);
        });
    }

    /// Copies the selected ellipsoids, moved by `offset` (metres), and selects the copies. A
    /// cloud that is selected as a whole is copied as a whole.
    pub fn duplicate(&mut self, offset: DVec3) {
        let ids = self.selection().ellipsoids.clone();
        let whole = self.selection().cloud;
        self.edit_and_select("Duplicate", |scene, selection| match whole {
            Some(cloud) => *selection = duplicate_cloud(scene, cloud, offset),
            None => {
                let copies = ids.into_iter().map(|id| duplicate_ellipsoid(scene, id, offset));
                *selection = Selection::of(copies.collect::<Vec<_>>());
            }
        });
    }

    /// Deletes the selected ellipsoids that are not locked; a cloud that is selected as a
    /// whole goes, too, where nothing in it is locked.
    pub fn delete(&mut self) {
        let ids = self.free_selection();
        let whole = self.selection().cloud.filter(|cloud| {
            let cloud = &self.scene().clouds[*cloud];
            !cloud.locked && cloud.ellipsoids.iter().all(|ellipsoid| !ellipsoid.locked)
        });
        self.edit_and_select("Delete", |scene, selection| {
            take(scene, &ids);
            if let Some(cloud) = whole {
                scene.clouds.remove(cloud);
            }
            *selection = Selection::default();
        });
    }

    /// Mirrors what is selected along one of the world's axes (0 x, 1 y, 2 z), about the middle of it.
    pub fn mirror(&mut self, axis: usize) {
        let ids = self.free_selection();
        let Some(middle) = self.middle_of(&ids) else { return };
        self.edit("Mirror", |scene| {
            for id in ids {
                let ellipsoid = get_mut(scene, id);
                ellipsoid.center[axis] = 2.0 * middle[axis] - ellipsoid.center[axis];
                ellipsoid.orientation = mirrored(ellipsoid.orientation, axis);
            }
        });
    }

    /// Puts the selected ellipsoids into a new cloud with the water of the active one. They
    /// keep the edges that they had.
    pub fn group(&mut self) {
        let ids = self.free_selection();
        let Some((_, like)) = self.active_cloud().or_else(|| {
            let cloud = ids.first()?.cloud;
            Some((cloud, &self.scene().clouds[cloud]))
        }) else {
            return;
        };
        let mut cloud = Cloud { name: String::new(), ellipsoids: Vec::new(), hidden: false, ..like.clone() };
        if ids.is_empty() {
            return;
        }
        self.edit_and_select("Group into a cloud", |scene, selection| {
            cloud.name = free_name(scene);
            let index = scene.clouds.len();
            scene.clouds.push(cloud);
            move_into(scene, &ids, index);
            // Clouds that gave all they had are of no more use.
            let emptied: BTreeSet<usize> = ids.iter().map(|id| id.cloud).collect();
            let gone = emptied.iter().rev().filter(|cloud| scene.clouds[**cloud].ellipsoids.is_empty());
            let gone: Vec<usize> = gone.copied().collect();
            for cloud in &gone {
                scene.clouds.remove(*cloud);
            }
            *selection = Selection::cloud(scene, index - gone.len());
        });
    }

    /// Moves the selected ellipsoids to the end of cloud `to`. They keep the edges that they had.
    pub fn move_to_cloud(&mut self, to: usize) {
        let mut ids = self.free_selection();
        ids.retain(|id| id.cloud != to);
        if ids.is_empty() || to >= self.scene().clouds.len() {
            return;
        }
        self.edit_and_select("Move to another cloud", |scene, selection| {
            let first = scene.clouds[to].ellipsoids.len();
            move_into(scene, &ids, to);
            let moved = first..scene.clouds[to].ellipsoids.len();
            *selection = Selection::of(moved.map(|ellipsoid| EllipsoidId { cloud: to, ellipsoid }));
        });
    }

    /// Moves cloud `from` before cloud `before` of the present order.
    pub fn move_cloud(&mut self, from: usize, before: usize) {
        let count = self.scene().clouds.len();
        if from >= count || before > count {
            return;
        }
        self.edit_and_select("Reorder clouds", |scene, selection| {
            let cloud = scene.clouds.remove(from);
            let to = if before > from { before - 1 } else { before };
            scene.clouds.insert(to, cloud);
            let place = |cloud: usize| match cloud {
                c if c == from => to,
                c if c > from && c <= to => c - 1,
                c if c < from && c >= to => c + 1,
                c => c,
            };
            let follow = |id: EllipsoidId| EllipsoidId { cloud: place(id.cloud), ..id };
            selection.ellipsoids = selection.ellipsoids.iter().copied().map(follow).collect();
            selection.active = selection.active.map(follow);
            selection.cloud = selection.cloud.map(place);
        });
    }

    /// Moves one ellipsoid before another place of the present order, maybe of another cloud,
    /// and selects it. It keeps the edge that it had.
    pub fn move_ellipsoid(&mut self, from: EllipsoidId, before: EllipsoidId) {
        let room = self.scene().clouds.get(before.cloud).map(|cloud| cloud.ellipsoids.len());
        if self.ellipsoid(from).is_none() || room.is_none_or(|room| before.ellipsoid > room) {
            return;
        }
        self.edit_and_select("Reorder ellipsoids", |scene, selection| {
            let ellipsoid = scene.clouds[from.cloud].ellipsoids.remove(from.ellipsoid);
            let ellipsoid = at_home(scene, ellipsoid, from.cloud, before.cloud);
            let skipped = from.cloud == before.cloud && before.ellipsoid > from.ellipsoid;
            let to = EllipsoidId { ellipsoid: before.ellipsoid - usize::from(skipped), ..before };
            scene.clouds[to.cloud].ellipsoids.insert(to.ellipsoid, ellipsoid);
            *selection = Selection::one(to);
        });
    }

    /// Grows heaps on the selected ellipsoids, in their clouds, and selects what grew.
    pub fn grow(&mut self, heaps: &Heaps) {
        let ids = self.selection().ellipsoids.clone();
        self.edit_and_select("Grow heaps", |scene, selection| {
            let mut grown = Vec::new();
            let clouds: BTreeSet<usize> = ids.iter().map(|id| id.cloud).collect();
            for cloud in clouds {
                let mine = ids.iter().filter(|id| id.cloud == cloud);
                let parents: Vec<_> = mine.map(|id| get_mut(scene, *id).clone()).collect();
                let list = &mut scene.clouds[cloud].ellipsoids;
                let first = list.len();
                list.extend(heaps.on(&parents));
                grown.extend((first..list.len()).map(|ellipsoid| EllipsoidId { cloud, ellipsoid }));
            }
            *selection = Selection::of(grown);
        });
    }

    /// Hides what is selected.
    pub fn hide(&mut self) {
        let ids = self.selection().ellipsoids.clone();
        let whole = self.selection().cloud;
        self.edit_and_select("Hide", |scene, selection| {
            match whole {
                Some(cloud) => scene.clouds[cloud].hidden = true,
                None => ids.iter().for_each(|id| get_mut(scene, *id).hidden = true),
            }
            *selection = Selection::default();
        });
    }

    /// Locks what is selected; unlocks it where all of it is locked.
    pub fn lock(&mut self) {
        let ids = self.selection().ellipsoids.clone();
        let whole = self.selection().cloud;
        self.edit("Lock or unlock", |scene| match whole {
            Some(cloud) => scene.clouds[cloud].locked ^= true,
            None => {
                let lock = ids.iter().any(|id| !get_mut(scene, *id).locked);
                ids.iter().for_each(|id| get_mut(scene, *id).locked = lock);
            }
        });
    }

    /// Shows everything that was hidden.
    pub fn show_all(&mut self) {
        self.edit("Show all", |scene| {
            for cloud in &mut scene.clouds {
                cloud.hidden = false;
                cloud.ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.hidden = false);
            }
        });
    }

    /// Middle of the bounds of `ids`, metres; nothing for none.
    pub fn middle_of(&self, ids: &BTreeSet<EllipsoidId>) -> Option<DVec3> {
        let bounds = ids.iter().filter_map(|id| self.ellipsoid(*id)).map(Ellipsoid::bounds);
        let (low, high) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        Some(0.5 * (low + high))
    }
}

/// Adds an empty cloud with a name of its own; returns its index.
fn push_cloud(scene: &mut Scene) -> usize {
    let name = free_name(scene);
    scene.clouds.push(Cloud { name, ..Cloud::default() });
    scene.clouds.len() - 1
}

/// The first of "cloud 1", "cloud 2" and so on that no cloud has.
fn free_name(scene: &Scene) -> String {
    let taken = |name: &String| scene.clouds.iter().any(|cloud| cloud.name == *name);
    let mut names = (1..).map(|n| format!("cloud {n}"));
    names.find(|name| !taken(name)).unwrap_or_default()
}

/// `name` with a number behind it that no other has, where there is a number behind it.
fn next_name(list: &[Ellipsoid], name: &str) -> String {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
    if stem == name || stem.is_empty() {
        return name.to_owned();
    }
    let number = |e: &Ellipsoid| e.name.as_deref()?.strip_prefix(stem)?.trim_start().parse::<u64>().ok();
    let last = list.iter().filter_map(number).max().unwrap_or(1);
    format!("{stem} {}", last.saturating_add(1))
}

fn get_mut(scene: &mut Scene, id: EllipsoidId) -> &mut Ellipsoid {
    &mut scene.clouds[id.cloud].ellipsoids[id.ellipsoid]
}

fn duplicate_ellipsoid(scene: &mut Scene, id: EllipsoidId, offset: DVec3) -> EllipsoidId {
    let list = &mut scene.clouds[id.cloud].ellipsoids;
    let mut copy = list[id.ellipsoid].clone();
    (copy.center, copy.locked) = (copy.center + offset, false);
    copy.name = copy.name.map(|name| next_name(list, &name));
    list.push(copy);
    EllipsoidId { ellipsoid: list.len() - 1, ..id }
}

fn duplicate_cloud(scene: &mut Scene, cloud: usize, offset: DVec3) -> Selection {
    let name = free_name(scene);
    let mut copy = Cloud { name, locked: false, ..scene.clouds[cloud].clone() };
    copy.shift(offset);
    scene.clouds.push(copy);
    Selection::cloud(scene, scene.clouds.len() - 1)
}

/// Takes `ids` out of the scene, in order.
fn take(scene: &mut Scene, ids: &BTreeSet<EllipsoidId>) -> Vec<Ellipsoid> {
    let from_the_end = ids.iter().rev();
    let mut taken: Vec<_> =
        from_the_end.map(|id| scene.clouds[id.cloud].ellipsoids.remove(id.ellipsoid)).collect();
    taken.reverse();
    taken
}

/// Moves `ids` to the end of cloud `to`.
fn move_into(scene: &mut Scene, ids: &BTreeSet<EllipsoidId>, to: usize) {
    let taken = take(scene, ids);
    for (id, ellipsoid) in ids.iter().zip(taken) {
        let ellipsoid = at_home(scene, ellipsoid, id.cloud, to);
        scene.clouds[to].ellipsoids.push(ellipsoid);
    }
}

/// `ellipsoid` of cloud `from` as it looks the same in cloud `to`: with the edge that it had.
fn at_home(scene: &Scene, mut ellipsoid: Ellipsoid, from: usize, to: usize) -> Ellipsoid {
    if ellipsoid.edge.is_none() && scene.clouds[from].edge != scene.clouds[to].edge {
        ellipsoid.edge = Some(scene.clouds[from].edge.clone());
    }
    ellipsoid
}

/// `q` as a mirror across the plane of normal `axis` shows it: M R M. An ellipsoid is its own
/// mirror image along its axes, so that this turns its mirror image, too.
fn mirrored(q: DQuat, axis: usize) -> DQuat {
    let across = BVec3::new(axis == 0, axis == 1, axis == 2);
    let turn = DVec3::select(across, q.xyz(), -q.xyz());
    DQuat::from_xyzw(turn.x, turn.y, turn.z, q.w)
}
