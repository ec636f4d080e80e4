//! What layers above and below a cloud do to the light that comes to it: they take of the sky's and send it back, and scatter
//! down, or up, what they take of the sun's.
//!
//! How it works. On the scale of a cloud's surroundings a layer is a slab. Radiance goes along the six levels of the
//! directions that light is solved for ([`super::field`]), its mean over the azimuth; a column of a layer is a slab found by
//! doubling a thin one, a layer the mean of its columns, for the rank of its field tells how many there are of each
//! thickness, and what is above a cloud, or below it, is found by adding layers, with all that goes to and fro between them
//! (van de Hulst, "Multiple Light Scattering", 1980, chapter 4; Grant and Hunt 1969). A cloud that a layer goes around has the
//! part of it above its middle above itself. So the light that enters a cloud is a matrix times that of sky and ground, and a
//! vector times the sun's: the grid of the cloud has it at its faces.
//!
//! Why not the two-stream formulas that shadows on the ground take: thin layers shine most at their horizon, and half of what
//! comes to a ball comes from there.

use glam::DVec3;

use super::{
    super::field::levels,
    slab::{LEVELS, Meeting, Scattering, Slab},
};
use crate::{
    frame::{
        CloudFrame,
        medium::{LayerShape, Medium, smooth_rise},
    },
    optics::slab::angles::Quadrature,
};

/// Columns of a layer, and heights in each.
const COLUMNS: usize = 16;
const HEIGHTS: usize = 24;
/// Least cosine of the sun to the vertical: the light of one that grazes is no longer that of a plane.
const LEAST_COSINE: f64 = 0.02;
/// Mean of the noise that moves boundaries.
const MEAN_NOISE: f64 = 0.5;

/// What layers make of the light that comes to a cloud, by level of the directions that light is solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    /// What of the mean over the azimuth of each level is scattered to each: rows by the level that it goes to.
    pub rows: [[f32; LEVELS]; LEVELS],
    /// What of sky and ground comes straight through.
    pub through: [f32; LEVELS],
    /// Of the sun's light what is scattered to each, for each unit of its irradiance, 1/sr, and what comes straight through.
    pub sun: [f32; LEVELS],
    pub beam: f32,
}

impl Between {
    /// No layers.
    pub const NONE: Self =
        Self { rows: [[0.0; LEVELS]; LEVELS], through: [1.0; LEVELS], sun: [0.0; LEVELS], beam: 1.0 };

    /// Whether no number differs by more than `share`.
    pub fn is_near(&self, other: &Self, share: f64) -> bool {
        let numbers = |b: &Self| {
            let rows = b.rows.into_iter().flatten();
            rows.chain(b.through).chain(b.sun).chain([b.beam]).collect::<Vec<_>>()
        };
        numbers(self).into_iter().zip(numbers(other)).all(|(a, b)| f64::from((a - b).abs()) <= share)
    }

    /// The same for light of the sky, to which the sun is nothing.
    pub fn of_sky(self) -> Self {
        Self { sun: [0.0; LEVELS], beam: 0.0, ..self }
    }
}

/// A part of a layer that lies above or below a cloud.
struct Part<'a> {
    cloud: &'a CloudFrame,
    shape: &'a LayerShape,
    /// Between these heights in its frame, m.
    heights: [f64; 2],
}

/// A layer among the clouds of a frame.
struct Stratum<'a> {
    number: usize,
    cloud: &'a CloudFrame,
    shape: &'a LayerShape,
    /// All of it.
    slab: Slab,
}

/// Layers among the clouds of a frame, from the top, in the light of a sun at the sine `elevation`.
pub(super) struct Strata<'a> {
    elevation: f64,
    strata: Vec<Stratum<'a>>,
}

impl<'a> Strata<'a> {
    /// Those of `clouds`; none where no other cloud is there for them.
    pub fn of(clouds: &'a [CloudFrame], elevation: f64) -> Self {
        let mu0 = elevation.abs().max(LEAST_COSINE);
        let stratum = |(number, cloud): (usize, &'a CloudFrame)| {
            let shape = cloud.medium.layer.as_ref()?;
            let slab = Part::whole(cloud, shape).slab(mu0);
            Some(Stratum { number, cloud, shape, slab })
        };
        let several = clouds.len() > 1;
        let mut strata: Vec<_> = clouds.iter().enumerate().filter(|_| several).filter_map(stratum).collect();
        strata.sort_by(|a, b| b.cloud.origin.y.total_cmp(&a.cloud.origin.y));
        Self { elevation, strata }
    }

    /// What they do to the light that comes to cloud `number`; none where there are no others.
    pub fn around(&self, number: usize, cloud: &CloudFrame) -> Option<Between> {
        let [mut above, mut below] = [true, false].map(|above| self.slabs(number, cloud, above));
        if above.is_empty() && below.is_empty() {
            return None;
        }
        // Down is the way that the sun's light goes.
        let is_turned = self.elevation < 0.0;
        if is_turned {
            std::mem::swap(&mut above, &mut below);
            above.reverse();
            below.reverse();
        }
        let stack = |slabs: Vec<Slab>| slabs.into_iter().fold(Slab::NONE, |above, slab| above.over(&slab));
        let (mut above, below) = (stack(above), stack(below));
        let Some(own) = self.strata.iter().find(|stratum| stratum.number == number) else {
            return Some(Meeting::of(&above, &below).told(&above, &below, is_turned));
        };
        // What stands before a layer is in a map, with what it scatters on.
        (above.beam, above.down) = (1.0, DVec3::ZERO);
        let over = Meeting::of(&above, &own.slab.over(&below));
        let meeting = Meeting { up: Meeting::of(&above.over(&own.slab), &below).up, ..over };
        Some(meeting.told(&above, &below, is_turned))
    }

    /// Other layers as far as they are above the middle of a cloud, or below it, from the top. Layers do not part each other.
    fn slabs(&self, number: usize, cloud: &CloudFrame, above: bool) -> Vec<Slab> {
        let mu0 = self.elevation.abs().max(LEAST_COSINE);
        let slab = |layer: &Stratum<'_>| {
            let half = layer.cloud.half.y;
            let middle = cloud.origin.y - layer.cloud.origin.y;
            let cut =
                if cloud.medium.layer.is_some() { half.copysign(middle) } else { middle.clamp(-half, half) };
            let heights = if above { [cut, half] } else { [-half, cut] };
            if heights[0] >= heights[1] {
                None
            } else if heights == [-half, half] {
                Some(layer.slab.clone())
            } else {
                Some(Part { cloud: layer.cloud, shape: layer.shape, heights }.slab(mu0))
            }
        };
        self.strata.iter().filter(|layer| layer.number != number).filter_map(slab).collect()
    }
}

impl<'a> Part<'a> {
    fn whole(cloud: &'a CloudFrame, shape: &'a LayerShape) -> Self {
        Self { cloud, shape, heights: [-cloud.half.y, cloud.half.y] }
    }

    /// The mean of its columns.
    fn slab(&self, mu0: f64) -> Slab {
        let coverage = self.shape.covered();
        let species = &self.cloud.medium.species;
        let medium = Scattering::of(species, mu0);
        let transported = f64::from((1.0 - species.truncated) * (1.0 - species.albedo * species.ahead));
        let columns = Quadrature::new(COLUMNS);
        let mut mean = Slab::NONE.times(1.0 - coverage);
        for (place, weight) in columns.mu.iter().zip(&columns.weight) {
            let length = column(self.shape, &self.cloud.medium, self.shape.excess(*place), self.heights);
            let depth = transported * f64::from(self.shape.uniform.extinction) * length;
            mean = mean.plus(&medium.slab(depth).times(coverage * weight));
        }
        mean
    }
}

/// Length of a column of full extinction that has as much of it as a layer has between two heights in its frame, m, where its
/// field is `excess` above where it begins.
fn column(shape: &LayerShape, medium: &Medium, excess: f64, [low, high]: [f64; 2]) -> f64 {
    let u = &shape.uniform;
    let [boundary, wispiness] = [u.boundary, u.wispiness].map(f64::from);
    let [above, below] = shape.heights(excess);
    let rim = f64::from(u.rim);
    let boundary = boundary.min(0.5 * (above + below));
    let rise = rise_of(boundary, wispiness).max(1e-3);
    let moved = moved(boundary, rise);
    let (low, high) = (low.max(rim - below), high.min(rim + above));
    let step = (high - low).max(0.0) / HEIGHTS as f64;
    let share = |i: usize| {
        let y = low + (i as f64 + 0.5) * step;
        let depth = (rim + above - y).min(y - rim + below) - moved;
        medium.body.kept(y, depth, boundary) * smooth_rise(depth / rise)
    };
    step * (0..HEIGHTS).map(share).sum::<f64>()
}

/// How deep density rises behind the edge of a boundary, m.
pub(super) fn rise_of(boundary: f64, wispiness: f64) -> f64 {
    boundary * (0.06 + 0.34 * wispiness)
}

/// How far noise moves that edge inwards on average, m.
pub(super) fn moved(boundary: f64, rise: f64) -> f64 {
    0.5 * (boundary - rise).max(0.0) * (1.0 - MEAN_NOISE)
}

impl Meeting {
    /// The same by level; `above` and `below` are what is between the place and the outside, and down is up where all `is_turned`.
    fn told(&self, above: &Slab, below: &Slab, is_turned: bool) -> Between {
        let all = levels();
        let mut told = Between { beam: above.beam as f32, ..Between::NONE };
        // Whether a level's light goes down, and its number in its hemisphere.
        let place = |level: usize| ((all[level].0 < 0.0) != is_turned, level.min(LEVELS - 1 - level));
        for to in 0..LEVELS {
            let (goes_down, row) = place(to);
            let (ways, through) = if goes_down { (&self.down, above) } else { (&self.up, below) };
            for from in 0..LEVELS {
                let (came_down, column) = place(from);
                let matrix = if came_down { ways.above } else { ways.below };
                let straight = if from == to { through.through[row] } else { 0.0 };
                told.rows[to][from] = (matrix.col(column)[row] - straight) as f32;
            }
            told.through[to] = through.through[row] as f32;
            told.sun[to] = ways.sun[row] as f32;
        }
        told
    }
}
