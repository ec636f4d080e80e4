//! Ellipsoids as the shaders see them.

use glam::{DMat3, DVec3, Vec3, Vec4};

use crate::scene::{Cloud, Ellipsoid};

/// `Ellipsoid` of `shaders/lib/ellipsoid.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct EllipsoidUniform {
    pub(crate) row_x: Vec4,
    pub(crate) row_y: Vec4,
    pub(crate) row_z: Vec4,
    pub(crate) center: Vec3,
    pub(crate) extinction: f32,
    pub(crate) boundary: f32,
    pub(crate) wispiness: f32,
    pub(crate) core: f32,
    pub(crate) body: u32,
}

/// Distances that are nothing, m: what rounding leaves of differences of coordinates up to 10 000 km.
const NOTHING: f64 = 1e-7;

/// A place in a cloud's frame: 0 where it is but for rounding, so that a cloud that drifts stays the same.
fn place(p: DVec3) -> Vec3 {
    let exact = |x: f64| if x.abs() < NOTHING { 0.0 } else { x };
    DVec3::new(exact(p.x), exact(p.y), exact(p.z)).as_vec3()
}

impl EllipsoidUniform {
    /// `ellipsoid` of `cloud` in a frame whose origin is at `origin`, whose core begins `steady` metres
    /// below the surface.
    pub fn new(cloud: &Cloud, ellipsoid: &Ellipsoid, origin: DVec3, steady: f64) -> Self {
        let edge = cloud.edge_of(ellipsoid);
        let axes = DMat3::from_quat(ellipsoid.orientation);
        let row = |axis: DVec3, radius: f64| (axis / radius).extend(1.0 / radius).as_vec4();
        Self {
            row_x: row(axes.x_axis, ellipsoid.radii.x),
            row_y: row(axes.y_axis, ellipsoid.radii.y),
            row_z: row(axes.z_axis, ellipsoid.radii.z),
            center: place(ellipsoid.center - origin),
            extinction: (cloud.droplets.extinction() * ellipsoid.density) as f32,
            boundary: edge.boundary as f32,
            wispiness: edge.wispiness as f32,
            core: (1.0 - steady / ellipsoid.radii.min_element()).max(0.0) as f32,
            body: 0,
        }
    }

    /// The same ellipsoid with its middle at `center`, m, in body `body` of a table.
    pub(crate) fn placed(self, center: DVec3, body: u32) -> Self {
        Self { center: place(center), body, ..self }
    }

    /// Half the extent of `axis . p`: along a unit vector, half the width in metres.
    pub(crate) fn support(&self, axis: Vec3) -> f32 {
        [self.row_x, self.row_y, self.row_z]
            .map(|row| row.truncate().dot(axis) / (row.w * row.w))
            .map(|half| half * half)
            .iter()
            .sum::<f32>()
            .sqrt()
    }

    /// Half the extents along the axes of the frame, m.
    pub(crate) fn half(&self) -> Vec3 {
        Vec3::new(self.support(Vec3::X), self.support(Vec3::Y), self.support(Vec3::Z))
    }

    /// The smallest radius, m.
    pub(crate) fn smallest_radius(&self) -> f32 {
        1.0 / [self.row_x, self.row_y, self.row_z].map(|row| row.w).into_iter().fold(1e-9, f32::max)
    }

    /// The largest radius, m.
    pub(crate) fn largest_radius(&self) -> f32 {
        1.0 / [self.row_x, self.row_y, self.row_z].map(|row| row.w).into_iter().fold(f32::INFINITY, f32::min)
    }

    /// Whether the homogeneous core holds a whole cube.
    pub(crate) fn core_holds(&self, corner: Vec3, edge: f32) -> bool {
        let rows = [self.row_x, self.row_y, self.row_z];
        let inside = |i: u32| {
            let p =
                corner + edge * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - self.center;
            Vec3::from(rows.map(|row| row.truncate().dot(p))).length() <= self.core
        };
        self.core > 0.0 && (0..8).all(inside)
    }

    /// Least and greatest corner of the box around ellipsoids, m; of the unit cube where there are none.
    pub(crate) fn bounds(ellipsoids: &[Self]) -> (Vec3, Vec3) {
        ellipsoids
            .iter()
            .map(|e| (e.center - e.half(), e.center + e.half()))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or((Vec3::ZERO, Vec3::ONE))
    }

    /// Whether a ball may touch the ellipsoid: never wrongly no.
    pub(crate) fn reaches(&self, center: Vec3, radius: f32) -> bool {
        let q = center - self.center;
        let rows = [self.row_x, self.row_y, self.row_z];
        let unit = Vec3::from(rows.map(|row| row.truncate().dot(q)));
        let steepest = rows.map(|row| row.w).into_iter().fold(0.0, f32::max);
        q.abs().cmple(self.half() + radius).all() && unit.length() <= 1.0 + radius * steepest
    }
}
