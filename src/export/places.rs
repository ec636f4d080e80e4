//! Where the clouds of a picture are, pixel by pixel, and where they go.

use glam::{DVec2, DVec3, Vec2};

use super::{
    cryptomatte::shares,
    layers::{Layered, NOTHING, metres, read},
};
use crate::{Error, Result, frame::CameraUniform, gpu::Gpu, render::Frame};

/// Where the clouds of a picture are.
pub(super) struct Places {
    /// The frame in pixels rather than rays.
    frame: Frame,
    /// Distance in each pixel, m, where there is a cloud.
    distances: Vec<Option<f32>>,
}

impl Places {
    pub fn read(gpu: &Gpu, of: Layered<'_>) -> Result<Self> {
        let distance = read(gpu, &of.layers.distance, of.reduce)?;
        let size = [distance.width as u32, distance.height as u32];
        Ok(Self { frame: of.frame.resized(size), distances: distance.pixels.iter().map(metres).collect() })
    }

    /// Depth along the camera's axis, m.
    ///
    /// # Errors
    /// [`Error::Argument`] where the camera has no axis.
    pub fn depths(&self) -> Result<Vec<f32>> {
        if self.frame.camera.projection == CameraUniform::EQUIRECTANGULAR {
            return Err(Error::Argument(
                "the layer `depth` is along the camera's axis, and an equirectangular camera sees all around: leave \
                 it out, `distance` is from the eye"
                    .to_owned(),
            ));
        }
        let axis = self.frame.camera.axis.as_dvec3();
        let depth = |(i, distance): (usize, &Option<f32>)| {
            distance.map_or(NOTHING, |distance| (f64::from(distance) * self.ray(i).1.dot(axis)) as f32)
        };
        Ok(self.distances.iter().enumerate().map(depth).collect())
    }

    /// Places in the world, m.
    pub fn positions(&self) -> Vec<[f32; 3]> {
        let place = |i: usize| self.place(i).map_or([0.0; 3], |place| place.as_vec3().to_array());
        (0..self.distances.len()).map(place).collect()
    }

    /// How far what is there goes until the next frame, pixels to the right and up.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the device fails.
    pub fn motions(&self, gpu: &Gpu, of: Layered<'_>) -> Result<Vec<[f32; 2]>> {
        let Some((next, movement)) = of.next else { return Ok(vec![[0.0; 2]; self.distances.len()]) };
        let next = next.resized(self.frame.size());
        let ways = match movement.of_all() {
            Some(way) => vec![way; self.distances.len()],
            None => self.ways(gpu, of)?,
        };
        let motion = |(i, way): (usize, DVec3)| {
            let moved = self.place(i).and_then(|p| Some(pixel(&next, p + way)? - pixel(&self.frame, p)?));
            moved.map_or([0.0; 2], |moved| moved.as_vec2().to_array())
        };
        Ok(ways.into_iter().enumerate().map(motion).collect())
    }

    /// The mean of the ways of all clouds in each pixel, m, weighted by what is seen of them.
    fn ways(&self, gpu: &Gpu, of: Layered<'_>) -> Result<Vec<DVec3>> {
        let Some((_, movement)) = of.next else { return Ok(Vec::new()) };
        let mut sums = vec![(0.0, DVec3::ZERO); self.distances.len()];
        let width = self.frame.size()[0] as usize;
        for share in shares(gpu, of)? {
            for (x, y, weight, distance) in share.pixels() {
                let i = y * width + x;
                let (origin, direction) = self.ray(i);
                let way = movement.at(share.cloud, origin + f64::from(distance) * direction);
                sums[i].0 += f64::from(weight);
                sums[i].1 += f64::from(weight) * way;
            }
        }
        Ok(sums.into_iter().map(|(weight, way)| if weight > 0.0 { way / weight } else { way }).collect())
    }

    /// Where in the world what is seen in pixel `i` is, m.
    fn place(&self, i: usize) -> Option<DVec3> {
        let (origin, direction) = self.ray(i);
        self.distances[i].map(|distance| origin + f64::from(distance) * direction)
    }

    /// The ray through the middle of pixel `i`, in the world.
    fn ray(&self, i: usize) -> (DVec3, DVec3) {
        let [width, height] = self.frame.size().map(|n| n as usize);
        let at = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let (origin, direction) = self.frame.camera.ray(at / Vec2::new(width as f32, height as f32));
        let [origin, direction] = [origin, direction].map(|v| glam::Vec3::from(v).as_dvec3());
        (self.frame.camera_position + origin, direction.normalize())
    }
}

/// Where a point of the world is seen, pixels from the left and from below; none where it is behind the camera.
fn pixel(frame: &Frame, point: DVec3) -> Option<DVec2> {
    let ndc = frame.camera.place_of(point - frame.camera_position)?;
    let size = DVec2::from(frame.camera.size.map(f64::from));
    Some(0.5 * (ndc + 1.0) * size)
}
