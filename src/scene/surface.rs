//! A closed surface of triangles: what of a mesh bounds a cloud, and how deep below it a point is.

use std::{
    collections::HashMap,
    hash::{DefaultHasher, Hasher},
    sync::{Mutex, OnceLock, PoisonError},
};

use glam::{DMat3, DVec3};

use super::Bounds;
use super::distance::Tree;

/// Most triangles of a surface: 1 GiB of them with what finds the nearest one.
const MOST_TRIANGLES: usize = 4_000_000;
/// Corners that are nearer to each other than this share of the mesh's extent are one.
const SAME: f64 = 1e-6;
/// The greatest [`Surface::openness`] that is closed: half a ball without its base has 0.5, a sheet 1.
const MOST_OPEN: f64 = 0.75;
/// Least volume, as a share of the cube of the extent.
const LEAST_VOLUME: f64 = 1e-12;

/// A closed surface, in its file's lengths: the triangles of a mesh, and others over its openings.
///
/// Edges that only one triangle has make closed loops, over each of which a fan is spread. Whatever is open, or looks the
/// other way than what is around it, is closed by that, and winding numbers are whole.
#[derive(Debug)]
pub struct Surface {
    corners: Vec<[DVec3; 3]>,
    bounds: Bounds,
    openness: f64,
    volume: f64,
    fingerprint: u64,
    tree: OnceLock<Tree>,
    turned: Mutex<Option<(DMat3, Bounds)>>,
}

impl Surface {
    /// The triangles of a mesh, by the numbers of their corners among `positions`, closed.
    ///
    /// # Errors
    /// Where they enclose nothing, are more open than closed, or too many, as the rest of a sentence about the file.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, String> {
        if triangles.len() > MOST_TRIANGLES {
            return Err(format!(
                "has {} triangles, and the boundary of a cloud has at most {MOST_TRIANGLES}: reduce it (in Blender: \
                 Decimate)",
                triangles.len()
            ));
        }
        let welded = Welded::new(positions, triangles)?;
        let mut corners = welded.corners();
        let area = |corners: &[[DVec3; 3]]| -> f64 {
            corners.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum()
        };
        let own = area(&corners);
        let fans = welded.fans();
        let openness = area(&fans) / own.max(f64::MIN_POSITIVE);
        if openness > MOST_OPEN {
            return Err(format!(
                "is open: what would close it has {:.0} % of its surface, and at most {:.0} % are closed: fill its \
                 holes, or have all its faces look outwards (in Blender: Recalculate Outside)",
                100.0 * openness,
                100.0 * MOST_OPEN
            ));
        }
        corners.extend(fans);
        let nothing = "encloses nothing: export a solid, or give the sheet a thickness";
        if corners.is_empty() {
            return Err(nothing.to_owned());
        }
        let (low, high) = bounds(corners.iter().flatten().copied());
        let middle = 0.5 * (low + high);
        let volume: f64 = corners
            .iter()
            .map(|[a, b, c]| (*a - middle).dot((*b - middle).cross(*c - middle)) / 6.0)
            .sum::<f64>()
            .abs();
        if volume <= LEAST_VOLUME * (high - low).max_element().powi(3) {
            return Err(nothing.to_owned());
        }
        let mut hasher = DefaultHasher::new();
        corners.iter().flatten().for_each(|p| hasher.write(bytemuck::bytes_of(p)));
        let fingerprint = hasher.finish();
        let (tree, turned) = Default::default();
        Ok(Self { corners, bounds: (low, high), openness, volume, fingerprint, tree, turned })
    }

    /// Number of triangles, those that close it among them.
    pub fn count(&self) -> usize {
        self.corners.len()
    }

    /// Least and greatest corner of the box around it, in its file's lengths.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The same of the box around it after a rotation, a scale or both: the last one is kept.
    pub(crate) fn bounds_turned(&self, turned: &DMat3) -> Bounds {
        let mut known = self.turned.lock().unwrap_or_else(PoisonError::into_inner);
        match *known {
            Some((of, bounds)) if of == *turned => bounds,
            _ => {
                let bounds = bounds(self.corners.iter().flatten().map(|p| *turned * *p));
                *known = Some((*turned, bounds));
                bounds
            }
        }
    }

    /// Area of what closes it over that of the mesh: 0 where that was closed.
    pub fn openness(&self) -> f64 {
        self.openness
    }

    /// How thick it is: the radius that a ball would have of the same volume over area, in its file's lengths.
    pub fn thickness(&self) -> f64 {
        let area: f64 = self.corners.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum();
        3.0 * self.volume / area
    }

    /// Differs where the triangles do, but for a chance of 2^-64.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Distance of a point from the surface in its file's lengths: above 0 inside, below 0 outside. What is in any of its
    /// parts is inside, and faces within others are no boundary.
    pub fn depth(&self, p: DVec3) -> f64 {
        let tree = self.tree();
        let distance = tree.distance(p, &mut 0);
        if tree.holds(p) { distance } else { -distance }
    }

    /// What finds the nearest triangle.
    pub(crate) fn tree(&self) -> &Tree {
        self.tree.get_or_init(|| Tree::new(&self.corners))
    }
}

fn bounds(corners: impl Iterator<Item = DVec3>) -> Bounds {
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// Triangles whose corners are one where they are in one place.
struct Welded {
    places: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Welded {
    fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, String> {
        let known = |i: &u32| positions.get(*i as usize).is_some_and(|p| p.is_finite());
        if !triangles.iter().flatten().all(known) {
            return Err("has corners that are no numbers: export it anew".to_owned());
        }
        let used: Vec<DVec3> = triangles.iter().flatten().map(|i| positions[*i as usize]).collect();
        let (low, high) = bounds(used.iter().copied());
        let cell = SAME * (high - low).max_element().max(f64::MIN_POSITIVE);
        let (mut places, mut numbers) = (Vec::new(), HashMap::new());
        let mut number = |p: DVec3| {
            let key = ((p - low) / cell).round().as_i64vec3();
            *numbers.entry(key).or_insert_with(|| {
                places.push(p);
                places.len() as u32 - 1
            })
        };
        let welded = used.chunks_exact(3).map(|corners| [0, 1, 2].map(|i| number(corners[i])));
        let triangles =
            welded.collect::<Vec<_>>().into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect();
        Ok(Self { places, triangles })
    }

    fn corners(&self) -> Vec<[DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|i| self.places[i as usize])).collect()
    }

    /// Triangles that close it: a fan from the middle of each loop of edges that have no counterpart.
    fn fans(&self) -> Vec<[DVec3; 3]> {
        let fan = |ring: &Vec<u32>| {
            let ring: Vec<DVec3> = ring.iter().map(|i| self.places[*i as usize]).collect();
            let middle = ring.iter().sum::<DVec3>() / ring.len() as f64;
            (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()], middle]).collect::<Vec<_>>()
        };
        self.rings().iter().flat_map(fan).collect()
    }

    /// Loops of edges that are gone round once more one way than the other, against the way of the triangles. Of each
    /// corner as many begin as end, so that who follows them comes back.
    fn rings(&self) -> Vec<Vec<u32>> {
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &self.triangles {
            for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
                let (edge, way) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *edges.entry(edge).or_default() += way;
            }
        }
        let mut open: Vec<_> = edges.into_iter().filter(|(_, ways)| *ways != 0).collect();
        open.sort_unstable();
        let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
        for ([a, b], ways) in open {
            let (from, to) = if ways > 0 { (b, a) } else { (a, b) };
            next.entry(from).or_default().extend(std::iter::repeat_n(to, ways.unsigned_abs() as usize));
        }
        let mut starts: Vec<u32> = next.keys().copied().collect();
        starts.sort_unstable();
        let mut rings = Vec::new();
        for start in starts {
            // The way so far, no corner of which is there twice: what comes back to one is a ring.
            let (mut way, mut places) = (vec![start], HashMap::from([(start, 0)]));
            while let Some(to) = way.last().and_then(|at| next.get_mut(at)?.pop()) {
                if let Some(&place) = places.get(&to) {
                    let ring = way.split_off(place);
                    ring.iter().for_each(|corner| {
                        places.remove(corner);
                    });
                    rings.push(ring);
                }
                places.insert(to, way.len());
                way.push(to);
            }
        }
        rings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube from 0 to `edge`, without the faces of these numbers.
    fn cube(edge: f64, without: &[usize]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner = |i: u32| edge * DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let kept = faces.iter().enumerate().filter(|(i, _)| !without.contains(i));
        let triangles = kept.flat_map(|(_, [a, b, c, d])| [[*a, *b, *c], [*a, *c, *d]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    #[test]
    fn depths_in_a_cube_are_those_to_its_nearest_face_edge_or_corner() {
        let (positions, triangles) = cube(2.0, &[]);
        let cube = Surface::new(&positions, &triangles).unwrap();
        assert_eq!((cube.openness(), cube.count()), (0.0, 12));
        assert!((cube.thickness() - 1.0).abs() < 1e-12);
        for (p, depth) in [
            ([1.0, 1.0, 1.0], 1.0),
            ([0.25, 1.0, 1.0], 0.25),
            ([1.0, 1.0, 2.5], -0.5),
            ([3.0, 3.0, 1.0], -(2f64.sqrt())),
            ([3.0, 3.0, 3.0], -(3f64.sqrt())),
        ] {
            assert!((cube.depth(p.into()) - depth).abs() < 1e-12, "{p:?}");
        }
    }

    #[test]
    fn openings_are_closed_and_faces_that_look_the_other_way_turned() {
        let (positions, triangles) = cube(2.0, &[3]);
        let open = Surface::new(&positions, &triangles).unwrap();
        assert!((open.openness() - 0.2).abs() < 1e-12);
        assert!((open.depth([1.0, 1.75, 1.0].into()) - 0.25).abs() < 1e-12);
        assert!((open.depth([1.0, 2.5, 1.0].into()) + 0.5).abs() < 1e-12);
        let (positions, mut triangles) = cube(2.0, &[]);
        triangles[5].swap(0, 1);
        let turned = Surface::new(&positions, &triangles).unwrap();
        assert!(turned.depth([1.0; 3].into()) > 0.99 && turned.depth([1.0, 1.0, 2.1].into()) < 0.0);
        triangles[5].swap(0, 1);
        triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        let inside_out = Surface::new(&positions, &triangles).unwrap();
        assert!((inside_out.depth([1.0; 3].into()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn seams_between_parts_that_are_not_joined_are_no_openings() {
        let (positions, triangles) = cube(2.0, &[]);
        let apart: Vec<DVec3> = triangles.iter().flatten().map(|i| positions[*i as usize]).collect();
        let own: Vec<[u32; 3]> = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert_eq!(Surface::new(&apart, &own).unwrap().openness(), 0.0);
    }

    #[test]
    fn faces_within_other_parts_are_no_boundary() {
        let (mut positions, mut triangles) = cube(2.0, &[]);
        let (inner, more) = cube(0.5, &[]);
        positions.extend(inner.iter().map(|p| *p + 0.75));
        triangles.extend(more.iter().map(|triangle| triangle.map(|i| i + 8)));
        let both = Surface::new(&positions, &triangles).unwrap();
        assert!((both.depth([0.75, 1.0, 1.0].into()) - 0.75).abs() < 1e-12);
        // Two cubes that overlap by a half: one beam, but for what is left where faces pass through others.
        let (mut positions, triangles) = cube(2.0, &[]);
        positions.extend_from_within(..);
        positions[8..].iter_mut().for_each(|p| *p += DVec3::new(1.0, 0.1, 0.1));
        let second = triangles.iter().map(|triangle| triangle.map(|i| i + 8));
        let all: Vec<_> = triangles.iter().copied().chain(second).collect();
        let both = Surface::new(&positions, &all).unwrap();
        let depth = both.depth([1.0, 1.05, 1.05].into());
        assert!((0.9..1.0).contains(&depth), "{depth}");
    }

    #[test]
    fn what_encloses_nothing_is_refused_with_the_way_out() {
        let (positions, triangles) = cube(2.0, &[1, 2, 3, 4, 5]);
        let sheet = Surface::new(&positions, &triangles).unwrap_err();
        assert!(
            sheet.contains("is open") && sheet.contains("100 %") && sheet.contains("fill its holes"),
            "{sheet}"
        );
        let both: Vec<_> = triangles.iter().flat_map(|[a, b, c]| [[*a, *b, *c], [*a, *c, *b]]).collect();
        assert!(Surface::new(&positions, &both).unwrap_err().contains("encloses nothing"));
        assert!(Surface::new(&[DVec3::NAN; 3], &[[0, 1, 2]]).unwrap_err().contains("no numbers"));
    }
}
