//! A cloud as others see it from afar: the even ellipsoid with the second moments of its lumps.

use glam::{DMat3, DVec3, Vec4};

use super::between::{moved, rise_of};
use crate::frame::{
    CloudFrame, Shared,
    medium::{EllipsoidUniform, Species},
};

/// Steps of a body's radius in which it moves: what moves less changes no light.
const STEPS: f64 = 32.0;
/// Bodies that let more than this of a beam through are none.
const CLEAR: f64 = 0.999;

/// A cloud as others see it from afar.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub species: Shared<Species>,
    /// From the middle of the cloud that it shines on, m.
    pub middle: DVec3,
    /// p . inverse p is 1 where p, m from its middle, is on its surface, 1/m^2.
    inverse: DMat3,
    /// Without the forward peak, 1/m.
    pub extinction: f64,
}

/// Where a ray meets a body.
pub(super) struct Meeting {
    /// Distance to where it enters, and length of the way through, m.
    pub enters: f64,
    pub chord: f64,
}

/// A lump of a cloud, or a mean of some.
struct Lump {
    /// Mean and mean square of the place, m.
    middle: DVec3,
    square: DMat3,
    /// How far below its surface the edge is, m.
    lost: f64,
    /// 1/m.
    extinction: f64,
}

impl Lump {
    /// An ellipsoid, and its optical depth times its face, m^2.
    fn of(ellipsoid: &EllipsoidUniform) -> (Self, f64) {
        let rows = [ellipsoid.row_x, ellipsoid.row_y, ellipsoid.row_z].map(Vec4::as_dvec4);
        let middle = ellipsoid.center.as_dvec3();
        // An even ball spreads by a fifth of its radius squared.
        let spread = rows.map(|row| outer(row.truncate() / (row.w * row.w)));
        let square = 0.2 * (spread[0] + spread[1] + spread[2]) + outer(middle);
        let [boundary, wispiness, extinction] =
            [ellipsoid.boundary, ellipsoid.wispiness, ellipsoid.extinction].map(f64::from);
        let lump = Self { middle, square, lost: edge(boundary, wispiness), extinction };
        (lump, extinction / rows.map(|row| row.w).iter().product::<f64>())
    }

    fn add(&mut self, other: &Self, share: f64) {
        self.middle += share * other.middle;
        self.square += share * other.square;
        self.lost += share * other.lost;
        self.extinction += share * other.extinction;
    }
}

/// Mean depth of the edge that noise makes of a boundary, m.
fn edge(boundary: f64, wispiness: f64) -> f64 {
    let rise = rise_of(boundary, wispiness);
    moved(boundary, rise) + 0.5 * rise
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v.x * v, v.y * v, v.z * v)
}

impl Body {
    /// That of a cloud in its own frame; none of what has no end or is too thin.
    pub fn of(cloud: &CloudFrame) -> Option<Self> {
        let lumps: Vec<_> = cloud.medium.ellipsoids.iter().map(Lump::of).collect();
        let mass: f64 = lumps.iter().map(|(_, mass)| mass).sum();
        if mass <= 0.0 {
            return None;
        }
        let mut mean = Lump { middle: DVec3::ZERO, square: DMat3::ZERO, lost: 0.0, extinction: 0.0 };
        for (lump, own) in &lumps {
            mean.add(lump, own / mass);
        }
        let whole = 5.0 * (mean.square - outer(mean.middle));
        let radius = whole.determinant().max(0.0).powf(1.0 / 6.0);
        let kept = (1.0 - mean.lost / radius).max(0.1);
        let inverse = (kept * kept * whole).inverse();
        let species = &cloud.medium.species;
        let transported = f64::from((1.0 - species.truncated) * (1.0 - species.albedo * species.ahead));
        let extinction = transported * mean.extinction;
        let is_there = inverse.is_finite() && (-extinction * kept * radius).exp() < CLEAR;
        is_there.then(|| Self { species: species.clone(), middle: mean.middle, inverse, extinction })
    }

    /// The same in the frame of a cloud from which its own is at `offset`, m.
    pub fn at(&self, offset: DVec3) -> Self {
        Self { middle: self.middle + self.rounded(offset), ..self.clone() }
    }

    /// Metres in whole steps of it.
    pub fn rounded(&self, offset: DVec3) -> DVec3 {
        let step = self.radius() / STEPS;
        step * (offset / step).round()
    }

    /// Mean radius, m.
    pub fn radius(&self) -> f64 {
        self.inverse.determinant().powf(-1.0 / 6.0)
    }

    /// How long the longest way through it is along a unit vector, m.
    pub fn width(&self, along: DVec3) -> f64 {
        2.0 / along.dot(self.inverse * along).sqrt()
    }

    /// Distances at which the line through `from` along a unit vector enters and leaves it, m.
    fn ends(&self, from: DVec3, along: DVec3) -> Option<[f64; 2]> {
        let from = from - self.middle;
        let (through, slope) = (self.inverse * along, self.inverse * from);
        let (a, b, c) = (along.dot(through), along.dot(slope), from.dot(slope) - 1.0);
        let square = b * b - a * c;
        (square > 0.0).then(|| [-1.0, 1.0].map(|side| (-b + side * square.sqrt()) / a))
    }

    /// Where a ray meets it ahead; none from within.
    pub fn meet(&self, from: DVec3, along: DVec3) -> Option<Meeting> {
        let [enters, leaves] = self.ends(from, along).filter(|[enters, _]| *enters > 0.0)?;
        Some(Meeting { enters, chord: leaves - enters })
    }

    /// Optical depth of what a ray from `from` has of it ahead.
    pub fn depth(&self, from: DVec3, along: DVec3) -> f64 {
        self.ends(from, along)
            .map_or(0.0, |[enters, leaves]| self.extinction * (leaves - enters.max(0.0)).max(0.0))
    }

    /// Unit vector out of its surface at a point, m.
    pub fn facing(&self, p: DVec3) -> DVec3 {
        (self.inverse * (p - self.middle)).normalize()
    }

    /// So many points in it, m, the same every time.
    pub fn points(&self, count: usize) -> Vec<DVec3> {
        let from_ball = lower_root(self.inverse.inverse());
        let ball = (1..).map(|i| 2.0 * halton(i) - 1.0).filter(|p| p.length_squared() < 1.0);
        ball.take(count).map(|p| self.middle + from_ball * p).collect()
    }
}

/// The lower triangle L whose L times its transpose is a symmetric positive matrix (Cholesky).
fn lower_root(m: DMat3) -> DMat3 {
    let [x, y, z] = m.to_cols_array_2d();
    let a = x[0].sqrt();
    let (b, c) = (x[1] / a, x[2] / a);
    let d = (y[1] - b * b).max(0.0).sqrt();
    let e = if d > 0.0 { (y[2] - b * c) / d } else { 0.0 };
    let f = (z[2] - c * c - e * e).max(0.0).sqrt();
    DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(0.0, d, e), DVec3::new(0.0, 0.0, f))
}

/// A point of the unit cube: any number of them fill it evenly (Halton 1960).
fn halton(i: u32) -> DVec3 {
    let turned = |base: u32| {
        let (mut left, mut share, mut sum) = (i, 1.0, 0.0);
        while left > 0 {
            share /= f64::from(base);
            sum += share * f64::from(left % base);
            left /= base;
        }
        sum
    };
    DVec3::new(turned(2), turned(3), turned(5))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::{frame::Frame, scene::Scene};

    pub fn frame(clouds: &[String]) -> Frame {
        let scene: Scene = serde_json::from_str(&format!(r#"{{"clouds": [{}]}}"#, clouds.join(","))).unwrap();
        Frame::new(&scene, [8, 8]).unwrap()
    }

    #[test]
    fn the_body_of_an_ellipsoid_is_itself() {
        let cloud = r#"{"edge": {"boundary": 0}, "ellipsoids": [{"center": [500, 900, -40], "radii": [300, 100, 200]}]}"#;
        let frame = frame(&[cloud.to_owned()]);
        let body = Body::of(&frame.clouds[0]).unwrap();
        assert!(body.middle.length() < 1e-3);
        for (axis, radius) in [(DVec3::X, 300.0), (DVec3::Y, 100.0), (DVec3::Z, 200.0)] {
            let width = body.width(axis);
            assert!((width / (2.0 * radius) - 1.0).abs() < 1e-5, "{width} for {radius}");
            let meeting = body.meet(-1000.0 * axis, axis).unwrap();
            assert!((meeting.enters - (1000.0 - radius)).abs() < 0.01);
            assert!((body.facing(radius * axis) - axis).length() < 1e-5);
        }
        let points = body.points(64);
        assert!(points.iter().all(|p| p.dot(body.inverse * *p) < 1.0));
        assert!(points.iter().any(|p| p.x > 200.0) && points.iter().any(|p| p.y < -60.0));
        // From within, only what is ahead.
        assert!(
            (body.depth(DVec3::ZERO, DVec3::X) / body.depth(-500.0 * DVec3::X, DVec3::X) - 0.5).abs() < 1e-6
        );
        assert_eq!(body.depth(500.0 * DVec3::X, DVec3::X), 0.0);
    }

    #[test]
    fn a_needle_across_all_axes_is_full_of_points() {
        let needle = r#"{"edge": {"boundary": 0}, "ellipsoids": [{"center": [0, 9000, 0], "radii": [5000, 0.5, 0.5],
            "orientation": [0.5, 0.5, 0.1, 0.7]}]}"#;
        let body = Body::of(&frame(&[needle.to_owned()]).clouds[0]).unwrap();
        assert!(
            body.points(64).iter().all(|p| (p - body.middle).dot(body.inverse * (p - body.middle)) < 1.01)
        );
    }
}
