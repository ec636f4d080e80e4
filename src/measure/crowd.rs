//! Scenes of many clouds, to see what they cost.

use glam::DVec3;

use crate::scene::{
    Camera, Cloud, Edge, Ellipsoid, MAX_ELLIPSOIDS, Noise, Projection, Scene, Sun, SunPosition,
};

/// Ellipsoids of a cloud.
const EACH: usize = 16;
/// Most clouds of a crowd: more would be more ellipsoids than a scene may have.
pub const MOST_CLOUDS: usize = MAX_ELLIPSOIDS / EACH;

/// Cumuli of sixteen ellipsoids in front of the camera, about one on each 750 m by 750 m.
pub fn crowd(clouds: usize) -> Scene {
    let span = 750.0 * (clouds as f64).sqrt();
    let mut numbers = Numbers(1);
    let clouds = (0..clouds)
        .map(|_| {
            let place = DVec3::new(span * (numbers.next() - 0.5), 900.0, -900.0 - span * numbers.next());
            cloud(place, 0.6 + 0.8 * numbers.next(), EACH, &mut numbers)
        })
        .collect();
    seen(clouds)
}

/// One cloud of many ellipsoids, the smaller the more there are.
pub fn heap(count: usize) -> Scene {
    let mut numbers = Numbers(2);
    let size = (EACH as f64 / count as f64).cbrt();
    let mut heap = cloud(DVec3::new(0.0, 900.0, -1300.0), 1.0, count, &mut numbers);
    for ellipsoid in &mut heap.ellipsoids {
        ellipsoid.radii *= size;
    }
    heap.edge.boundary *= size;
    seen(vec![heap])
}

fn cloud(place: DVec3, size: f64, count: usize, numbers: &mut Numbers) -> Cloud {
    let ellipsoids = (0..count).map(|_| {
        let (angle, out) = (std::f64::consts::TAU * numbers.next(), numbers.next().sqrt());
        let up = numbers.next() * (1.0 - 0.9 * out) * 160.0;
        let around = 180.0 * out * DVec3::new(angle.cos(), 0.0, angle.sin());
        let radius = size * (45.0 + 45.0 * numbers.next());
        Ellipsoid::new(place + size * (around + up * DVec3::Y), radius * DVec3::new(1.0, 0.75, 1.0))
    });
    Cloud {
        ellipsoids: ellipsoids.collect(),
        edge: Edge { boundary: 28.0 * size, wispiness: 0.25 },
        ..Cloud::default()
    }
}

fn seen(clouds: Vec<Cloud>) -> Scene {
    let angles = SunPosition::Angles { azimuth_deg: 230.0, elevation_deg: 40.0 };
    Scene {
        clouds,
        noise: Noise { scale: Some(45.0), ..Noise::default() },
        sun: Sun { position: angles, ..Sun::default() },
        camera: Some(Camera {
            position: DVec3::new(0.0, 700.0, 300.0),
            target: DVec3::new(0.0, 800.0, -2000.0),
            roll_deg: 0.0,
            projection: Projection::Perspective { vertical_fov_deg: 40.0 },
            ..Camera::default()
        }),
        ..Scene::default()
    }
}

/// Evenly spread numbers in [0, 1), the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        // Steele, Lea and Flood (2014).
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowds_and_heaps_are_scenes_of_as_much_as_was_asked_for() {
        for count in [1, 10, MOST_CLOUDS] {
            let scene = crowd(count);
            assert_eq!(scene.clouds.len(), count);
            assert_eq!(scene.validate().map_err(|error| error.to_string()), Ok(()));
        }
        assert_eq!(heap(300).clouds[0].ellipsoids.len(), 300);
    }
}
