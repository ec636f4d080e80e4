//! What is selected.

use std::collections::BTreeSet;

use crate::scene::Scene;

/// One ellipsoid of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EllipsoidId {
    /// Index into the scene's clouds.
    pub cloud: usize,
    /// Index into the cloud's ellipsoids.
    pub ellipsoid: usize,
}

/// What is selected.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// The ellipsoids, in the order of the scene.
    pub ellipsoids: BTreeSet<EllipsoidId>,
    /// The one that the inspector shows and that local axes come from: the last one clicked.
    pub active: Option<EllipsoidId>,
    /// The cloud that was chosen as a whole; its ellipsoids are selected, too.
    pub cloud: Option<usize>,
}

impl Selection {
    /// One ellipsoid alone.
    pub fn one(id: EllipsoidId) -> Self {
        Self { ellipsoids: [id].into(), active: Some(id), cloud: None }
    }

    /// Several ellipsoids, the last of them active.
    pub fn of(ids: impl IntoIterator<Item = EllipsoidId>) -> Self {
        let ids: Vec<_> = ids.into_iter().collect();
        Self { active: ids.last().copied(), ellipsoids: ids.into_iter().collect(), cloud: None }
    }

    /// A cloud as a whole.
    pub fn cloud(scene: &Scene, cloud: usize) -> Self {
        let count = scene.clouds.get(cloud).map_or(0, |cloud| cloud.ellipsoids.len());
        let ellipsoids = (0..count).map(|ellipsoid| EllipsoidId { cloud, ellipsoid }).collect();
        Self { ellipsoids, active: None, cloud: Some(cloud) }
    }

    /// Everything that can be seen and is not locked.
    pub fn all(scene: &Scene) -> Self {
        let free = scene.clouds.iter().enumerate().filter(|(_, cloud)| !cloud.hidden && !cloud.locked);
        Self::of(free.flat_map(|(index, cloud)| {
            let free = cloud.ellipsoids.iter().enumerate().filter(|(_, e)| !e.hidden && !e.locked);
            free.map(move |(ellipsoid, _)| EllipsoidId { cloud: index, ellipsoid })
        }))
    }

    /// Whether nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.ellipsoids.is_empty() && self.cloud.is_none()
    }

    /// Whether `id` is selected.
    pub fn contains(&self, id: EllipsoidId) -> bool {
        self.ellipsoids.contains(&id)
    }

    /// Adds `id` and makes it active, or takes it out.
    pub fn toggle(&mut self, id: EllipsoidId) {
        self.cloud = None;
        if self.ellipsoids.remove(&id) {
            self.active = self.ellipsoids.last().copied();
        } else {
            self.ellipsoids.insert(id);
            self.active = Some(id);
        }
    }

    /// The cloud that is selected, or that the active ellipsoid belongs to.
    pub fn active_cloud(&self) -> Option<usize> {
        self.active.map(|id| id.cloud).or(self.cloud)
    }

    /// What `scene` has of it.
    pub fn within(mut self, scene: &Scene) -> Self {
        let exists = |id: &EllipsoidId| {
            scene.clouds.get(id.cloud).is_some_and(|cloud| id.ellipsoid < cloud.ellipsoids.len())
        };
        self.ellipsoids.retain(exists);
        self.active = self.active.filter(|id| self.ellipsoids.contains(id));
        self.cloud = self.cloud.filter(|cloud| *cloud < scene.clouds.len());
        self
    }
}
