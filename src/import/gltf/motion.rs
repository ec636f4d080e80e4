//! Animations of nodes (glTF 2.0, 3.11): where nodes are at a time.

use glam::{DMat4, DQuat, DVec4};

use super::{
    Gltf,
    accessor::Stored,
    document::{Node, Sampler, placed},
};
use crate::Result;

/// What of a node moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Translation,
    Rotation,
    Scale,
}

/// How values go from key to key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Linear,
    Step,
    Cubic,
}

/// A part of a node over time.
struct Track {
    node: usize,
    part: Part,
    way: Way,
    times: Vec<f64>,
    /// One a key; three, with tangents around it, where the way is cubic.
    values: Vec<DVec4>,
}

/// All that moves a node of a file. Of several animations of one node the first counts.
pub(in crate::import) struct Motion(Vec<Track>);

impl Gltf {
    /// Reads the animations of node `index` and of those that it hangs on; what else moves is not looked at.
    pub fn motion(&self, index: usize) -> Result<Motion> {
        let chain = self.chain(index);
        let mut tracks: Vec<Track> = Vec::new();
        for animation in &self.document.animations {
            for channel in &animation.channels {
                let part = match channel.target.path.as_str() {
                    "translation" => Part::Translation,
                    "rotation" => Part::Rotation,
                    "scale" => Part::Scale,
                    // Weights of meshes move no camera.
                    _ => continue,
                };
                let Some(node) = channel.target.node.filter(|node| chain.contains(node)) else { continue };
                if tracks.iter().any(|track| (track.node, track.part) == (node, part)) {
                    continue;
                }
                let Some(sampler) = animation.samplers.get(channel.sampler) else {
                    let number = channel.sampler;
                    return Err(
                        self.foreign(&format!("an animation names sampler {number}, which is not there"))
                    );
                };
                tracks.push(self.track(node, part, sampler)?);
            }
        }
        Ok(Motion(tracks))
    }

    /// A node and those that it hangs on.
    fn chain(&self, index: usize) -> Vec<usize> {
        let mut chain = vec![index];
        let parent = |of: usize| self.document.nodes.iter().position(|node| node.children.contains(&of));
        while let Some(above) = parent(chain[chain.len() - 1]).filter(|above| !chain.contains(above)) {
            chain.push(above);
        }
        chain
    }

    fn track(&self, node: usize, part: Part, sampler: &Sampler) -> Result<Track> {
        let way = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Way::Linear,
            Some("STEP") => Way::Step,
            Some("CUBICSPLINE") => Way::Cubic,
            Some(other) => return Err(self.foreign(&format!("it has an interpolation `{other}`"))),
        };
        let (kind, width) = if part == Part::Rotation { ("VEC4", 4) } else { ("VEC3", 3) };
        let times = self.numbers(sampler.input, "SCALAR", Stored::Floats)?;
        let numbers = self.numbers(sampler.output, kind, Stored::Quantized)?;
        let value = |n: &[f64]| DVec4::new(n[0], n[1], n[2], n.get(3).copied().unwrap_or(0.0));
        let values: Vec<_> = numbers.chunks_exact(width).map(value).collect();
        let each = if way == Way::Cubic { 3 } else { 1 };
        let is_ordered = times.windows(2).all(|pair| pair[0] < pair[1]);
        let is_finite = times.iter().chain(&numbers).all(|number| number.is_finite());
        if values.len() != each * times.len() || !is_ordered || !is_finite {
            return Err(self.foreign(&"the keys of an animation do not go with its values"));
        }
        Ok(Track { node, part, way, times, values })
    }

    /// The map from node `index` to the world at `time`, s; nothing where it is not shown.
    pub fn world_at(&self, index: usize, motion: &Motion, time: f64) -> Option<DMat4> {
        let pose = |index: usize, node: &Node| motion.pose(index, node, time);
        self.walk_by(pose).into_iter().find(|(found, _)| *found == index).map(|(_, world)| world)
    }
}

impl Motion {
    /// When the last key is, s; 0 where nothing moves.
    pub fn length(&self) -> f64 {
        self.0.iter().filter_map(|track| track.times.last()).fold(0.0, |last, time| last.max(*time))
    }

    /// From a node to its parent.
    fn pose(&self, index: usize, node: &Node, time: f64) -> DMat4 {
        let at =
            |part| self.0.iter().find(|track| (track.node, track.part) == (index, part)).map(|t| t.at(time));
        let [translation, rotation, scale] = [Part::Translation, Part::Rotation, Part::Scale].map(at);
        if translation.or(rotation).or(scale).is_none() {
            return node.transform();
        }
        placed(
            translation.map(DVec4::truncate).or(node.translation),
            rotation.map(DQuat::from_vec4).or(node.rotation),
            scale.map(DVec4::truncate).or(node.scale),
        )
    }
}

impl Track {
    /// The value at `time`, s: that of the first key before it, that of the last behind it.
    fn at(&self, time: f64) -> DVec4 {
        let key = |i: usize| self.values[if self.way == Way::Cubic { 3 * i + 1 } else { i }];
        let next = self.times.partition_point(|own| *own <= time);
        if next == 0 || next == self.times.len() {
            return key(next.saturating_sub(1));
        }
        let (from, to) = (next - 1, next);
        let span = self.times[to] - self.times[from];
        let share = (time - self.times[from]) / span;
        match (self.way, self.part) {
            (Way::Step, _) => key(from),
            (Way::Linear, Part::Rotation) => {
                let [a, b] = [key(from), key(to)].map(|value| DQuat::from_vec4(value).normalize());
                a.slerp(b, share).into()
            }
            (Way::Linear, _) => key(from).lerp(key(to), share),
            (Way::Cubic, _) => {
                let (leaving, coming) = (span * self.values[3 * from + 2], span * self.values[3 * to]);
                hermite(key(from), leaving, coming, key(to), share)
            }
        }
    }
}

/// The cubic from `a` to `b` that leaves and comes by these tangents (glTF 2.0, appendix C.5).
fn hermite(a: DVec4, leaving: DVec4, coming: DVec4, b: DVec4, t: f64) -> DVec4 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * a
        + (t3 - 2.0 * t2 + t) * leaving
        + (3.0 * t2 - 2.0 * t3) * b
        + (t3 - t2) * coming
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(part: Part, way: Way, values: Vec<DVec4>) -> Track {
        Track { node: 0, part, way, times: vec![1.0, 3.0], values }
    }

    #[test]
    fn values_go_from_key_to_key_in_their_ways_and_stay_beyond_them() {
        let (a, b) = (DVec4::X, DVec4::new(5.0, 8.0, 0.0, 0.0));
        let line = track(Part::Translation, Way::Linear, vec![a, b]);
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|t| line.at(t).y), [0.0, 0.0, 4.0, 8.0, 8.0]);
        let step = track(Part::Scale, Way::Step, vec![a, b]);
        assert_eq!([1.0, 2.9, 3.0].map(|t| step.at(t).x), [1.0, 1.0, 5.0]);
        // Tangents of the straight line between the keys, a second: the cubic is that line.
        let slope = (b - a) / 2.0;
        let cubic = track(Part::Translation, Way::Cubic, vec![DVec4::ZERO, a, slope, slope, b, DVec4::ZERO]);
        for time in [1.0, 1.3, 2.0, 2.9, 3.0] {
            assert!((cubic.at(time) - line.at(time)).length() < 1e-12);
        }
    }

    #[test]
    fn half_way_of_a_turn_is_half_the_angle_by_the_shorter_way() {
        let turn = |angle: f64| DQuat::from_rotation_y(angle);
        // The same turn with the other sign.
        let track = track(Part::Rotation, Way::Linear, vec![turn(0.2).into(), (-turn(1.0)).into()]);
        let half = DQuat::from_vec4(track.at(2.0));
        assert!(half.angle_between(turn(0.6)) < 1e-7);
    }
}
