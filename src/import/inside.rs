//! Which points of a grid are inside a mesh.
//!
//! A line along each axis through a point crosses the surface; how often outwards less how often
//! inwards beyond the point is 0 outside. Two of the three axes decide, so that a hole or a stray
//! face does not: the winding numbers of closed parts that overlap add up, and what is in any of them
//! is inside. A line that has gone in more often than out where it ends proves the surface open, and
//! tells nothing of its points.

use glam::{DVec3, IVec3, UVec3};

use super::Mesh;

/// Points of a grid that are inside a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Inside {
    /// Distance of points, m.
    pub step: f64,
    /// The first point of the grid, m.
    low: DVec3,
    size: UVec3,
    /// Area of the openings that lines go through, over that of the surface: 0 where none is found, and 1 for a sheet.
    pub openness: f64,
    /// How many axes call a point inside; x fastest.
    votes: Vec<u8>,
}

impl Inside {
    /// A grid with `most` points along the longest edge of the mesh's box.
    pub fn new(mesh: &Mesh, most: u32) -> Self {
        let (low, high) = mesh.bounds();
        let extent = high - low;
        let step = (extent.max_element() / f64::from(most)).max(1e-9);
        let size = (extent / step).ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(most + 1));
        // Not on the round numbers that corners and edges like to lie on.
        let low = low + step * DVec3::new(0.503_1, 0.497_3, 0.501_7);
        let votes = vec![0; (size.x * size.y * size.z) as usize];
        let mut inside = Self { step, low, size, openness: 0.0, votes };
        let open = DVec3::from([0, 1, 2].map(|axis| inside.vote(mesh, axis)));
        let surface: f64 = mesh.corners().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
        if surface > 0.0 {
            inside.openness = step * step * open.length() / surface;
        }
        inside
    }

    /// The points inside, m.
    pub fn points(&self) -> Vec<DVec3> {
        let filled = self.votes.iter().enumerate().filter(|(_, votes)| **votes >= 2);
        filled.map(|(i, _)| self.point(i as u32)).collect()
    }

    /// All points of the grid and whether they are inside; those around the mesh too, `around` steps far.
    pub fn each(&self, around: i32) -> impl Iterator<Item = (DVec3, bool)> {
        let size = self.size.as_ivec3();
        let range = move |n: i32| -around..n + around;
        let places = range(size.z).flat_map(move |z| {
            range(size.y).flat_map(move |y| range(size.x).map(move |x| IVec3::new(x, y, z)))
        });
        places.map(move |at| {
            let known = at.cmpge(IVec3::ZERO).all() && at.cmplt(size).all();
            let inside = known && self.votes[((at.z * size.y + at.y) * size.x + at.x) as usize] >= 2;
            (self.low + self.step * at.as_dvec3(), inside)
        })
    }

    fn point(&self, index: u32) -> DVec3 {
        let row = index / self.size.x;
        let at = UVec3::new(index % self.size.x, row % self.size.y, row / self.size.y);
        self.low + self.step * at.as_dvec3()
    }

    /// Has the lines along `axis` that end outside vote for the points that they have inside; tells what winding all
    /// others end with, together.
    fn vote(&mut self, mesh: &Mesh, axis: usize) -> f64 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let size = self.size.to_array().map(|n| n as usize);
        // Crossings of each line: where, and +1 into the mesh or -1 out of it.
        let mut lines: Vec<Vec<(f64, i32)>> = vec![Vec::new(); size[u] * size[v]];
        for corners in mesh.corners() {
            let corners = corners.map(|corner| ((corner - self.low) / self.step).to_array());
            let normal = cross(corners, u, v);
            if normal == 0.0 {
                continue;
            }
            let range = |i: usize| {
                let (low, high) =
                    corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| {
                        (low.min(corner[i]), high.max(corner[i]))
                    });
                (low.ceil().max(0.0) as usize)..((high.floor() + 1.0).clamp(0.0, size[i] as f64) as usize)
            };
            for j in range(v) {
                for i in range(u) {
                    if let Some(at) = crossing(corners, [axis, u, v], [i as f64, j as f64], normal) {
                        lines[j * size[u] + i].push((at, if normal < 0.0 { 1 } else { -1 }));
                    }
                }
            }
        }
        let mut open = 0.0;
        let stride = [1, size[0], size[0] * size[1]];
        for (line, crossings) in lines.iter_mut().enumerate() {
            let end: i32 = crossings.iter().map(|(_, turn)| turn).sum();
            if end != 0 {
                open += f64::from(end.abs());
                continue;
            }
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            let first = line % size[u] * stride[u] + line / size[u] * stride[v];
            let (mut winding, mut next) = (0, 0);
            for k in 0..size[axis] {
                while let Some((_, turn)) = crossings.get(next).filter(|(at, _)| *at < k as f64) {
                    winding += turn;
                    next += 1;
                }
                self.votes[first + k * stride[axis]] += u8::from(winding != 0);
            }
        }
        open
    }
}

/// Twice the area of a triangle seen along the axis across `u` and `v`, above 0 where it goes round from u to v.
fn cross(corners: [[f64; 3]; 3], u: usize, v: usize) -> f64 {
    let [a, b, c] = corners;
    (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])
}

/// Where a line along the first of `axes` at `place` on the others crosses a triangle.
fn crossing(corners: [[f64; 3]; 3], [axis, u, v]: [usize; 3], place: [f64; 2], area: f64) -> Option<f64> {
    let mut point = [0.0; 3];
    (point[u], point[v]) = (place[0], place[1]);
    let [a, b, c] = corners;
    let shares = [[point, b, c], [a, point, c], [a, b, point]].map(|part| cross(part, u, v) / area);
    let inside = shares.iter().all(|share| *share >= 0.0);
    inside.then(|| shares[0] * a[axis] + shares[1] * b[axis] + shares[2] * c[axis])
}
