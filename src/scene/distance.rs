//! The nearest of many triangles, and what they enclose.
//!
//! Triangles are in a tree of boxes. The distance is that of the nearest triangle (Ericson 2005, 5.1.5). What is inside is
//! told by the winding number: the solid angles of all triangles over 4 pi, which is whole where they are closed; those of
//! triangles that are far away are that of their dipole (Barill et al. 2018, first order).

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

/// Triangles of a leaf.
const LEAF: usize = 4;
/// So many times as far as its own reach a node is its dipole: winding numbers are good to some hundredths.
const FAR: f64 = 2.0;
/// Distance of the places of a face at which that is asked, as a share of the extent.
const APART: f64 = 1.0 / 96.0;
/// How far from a face it is asked what is before and behind it, as a share of the extent.
const BESIDE: f64 = 1e-5;

/// A triangle.
type Triangle = [DVec3; 3];

/// Triangles in a tree.
#[derive(Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    /// What each node is from far away.
    dipoles: Vec<Dipole>,
    triangles: Vec<Triangle>,
    /// Those, and parts of those, that are between inside and outside, where that is not all of them.
    boundary: Option<Box<Self>>,
}

/// Some triangles.
#[derive(Debug)]
struct Node {
    low: DVec3,
    high: DVec3,
    first: u32,
    count: u32,
    /// The second of its parts, of which the first comes after itself; 0 where it is a leaf.
    second: u32,
}

/// Middle of the area of some triangles, the sum of their areas along normals, and how far they are from the middle at the
/// most.
#[derive(Debug)]
struct Dipole {
    middle: DVec3,
    area: DVec3,
    reach: f64,
}

impl Tree {
    /// A tree of triangles that are closed together.
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut tree = Self::of(triangles.to_vec());
        let seen: Vec<_> = tree.triangles.par_iter().map(|triangle| tree.seen(triangle)).collect();
        if seen.iter().zip(&tree.triangles).any(|(seen, own)| seen.as_slice() != [*own]) {
            tree.boundary = Some(Box::new(Self::of(seen.into_iter().flatten().collect())));
        }
        tree
    }

    fn of(mut triangles: Vec<Triangle>) -> Self {
        let mut nodes = Vec::with_capacity(triangles.len());
        build(&mut triangles, 0, &mut nodes);
        let dipoles = nodes.iter().map(|node| Dipole::of(node.triangles(&triangles))).collect();
        Self { nodes, dipoles, triangles, boundary: None }
    }

    /// What of a triangle has inside on one side and outside on the other: all, nothing, or of its quarters likewise.
    fn seen(&self, triangle: &Triangle) -> Vec<Triangle> {
        let [a, b, c] = *triangle;
        let extent = (self.nodes[0].high - self.nodes[0].low).max_element();
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
        let beside = BESIDE * extent * normal;
        let divides = |p: DVec3| self.holds(p + beside) != self.holds(p - beside);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let parts = (longest / (APART * extent)).ceil().max(1.0) as u32;
        let middle = (a + b + c) / 3.0;
        let place = |i: u32, j: u32| {
            let [u, v] = [i, j].map(|i| f64::from(i) / f64::from(parts));
            middle.lerp(a + u * (b - a) + v * (c - a), 0.9)
        };
        let first = divides(middle);
        // Of a small one all is seen where any of it is.
        let is_mixed = !(first && parts == 1)
            && (0..=parts).any(|i| (0..=parts - i).any(|j| divides(place(i, j)) != first));
        if is_mixed && parts > 1 {
            let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
            let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
            return quarters.iter().flat_map(|quarter| self.seen(quarter)).collect();
        }
        if first || is_mixed { vec![*triangle] } else { Vec::new() }
    }

    /// Whether a point is inside: in any of the parts.
    pub fn holds(&self, p: DVec3) -> bool {
        self.winding(p).abs() > 0.5
    }

    /// The winding number of a point, times the sign of how triangles look.
    fn winding(&self, p: DVec3) -> f64 {
        let (mut next, mut sum, mut later) = (Some(0), 0.0, Stack::new());
        while let Some(at) = next {
            let (node, dipole) = (&self.nodes[at as usize], &self.dipoles[at as usize]);
            let to = dipole.middle - p;
            let distance = to.length();
            next = None;
            if distance > FAR * dipole.reach {
                sum += dipole.area.dot(to) / (distance * distance * distance);
            } else if node.second > 0 {
                later.push(node.second);
                next = Some(at + 1);
            } else {
                sum += node.triangles(&self.triangles).iter().map(|t| solid_angle(t, p)).sum::<f64>();
            }
            next = next.or_else(|| later.pop());
        }
        sum / (4.0 * PI)
    }

    /// Distance of a point from what is between inside and outside. `near` is the number of the triangle that was found
    /// nearest to a point at hand, 0 at first.
    pub fn distance(&self, p: DVec3, near: &mut u32) -> f64 {
        self.boundary.as_deref().unwrap_or(self).nearest_to(p, near)
    }

    fn nearest_to(&self, p: DVec3, near: &mut u32) -> f64 {
        let away = |node: u32| (node, self.nodes[node as usize].away(p));
        let known = self.triangles.get(*near as usize);
        let mut least = known.map_or(f64::INFINITY, |known| nearest(known, p).distance_squared(p));
        let (mut next, mut later) = (Some(away(0)), Stack::new());
        while let Some((at, distance)) = next {
            let node = &self.nodes[at as usize];
            next = None;
            if distance < least && node.second > 0 {
                let [first, second] = [away(at + 1), away(node.second)];
                let (near, far) = if first.1 <= second.1 { (first, second) } else { (second, first) };
                later.push(far);
                next = Some(near);
            } else if distance < least {
                for (number, triangle) in (node.first..).zip(node.triangles(&self.triangles)) {
                    let distance = nearest(triangle, p).distance_squared(p);
                    if distance < least {
                        (least, *near) = (distance, number);
                    }
                }
            }
            next = next.or_else(|| later.pop());
        }
        least.sqrt()
    }
}

/// What is to be looked at later. A tree that is halved is never deeper: 2^32 triangles.
struct Stack<T>([T; 32], usize);

impl<T: Copy + Default> Stack<T> {
    fn new() -> Self {
        Self([T::default(); 32], 0)
    }

    fn push(&mut self, item: T) {
        self.0[self.1] = item;
        self.1 += 1;
    }

    fn pop(&mut self) -> Option<T> {
        self.1 = self.1.checked_sub(1)?;
        Some(self.0[self.1])
    }
}

impl Node {
    /// Squared distance of a point from its box.
    fn away(&self, p: DVec3) -> f64 {
        p.clamp(self.low, self.high).distance_squared(p)
    }

    fn triangles<'a>(&self, all: &'a [Triangle]) -> &'a [Triangle] {
        &all[self.first as usize..][..self.count as usize]
    }
}

impl Dipole {
    fn of(triangles: &[Triangle]) -> Self {
        let (mut area, mut middle, mut whole) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for [a, b, c] in triangles {
            let own = 0.5 * (*b - *a).cross(*c - *a);
            area += own;
            middle += own.length() * (*a + *b + *c) / 3.0;
            whole += own.length();
        }
        let corners = || triangles.iter().flatten();
        let middle = if whole > 0.0 { middle / whole } else { corners().next().copied().unwrap_or_default() };
        Self { middle, area, reach: corners().map(|p| p.distance(middle)).fold(0.0, f64::max) }
    }
}

/// Sorts triangles into a tree, and adds its nodes: the number of its first triangle is `first`.
fn build(triangles: &mut [Triangle], first: u32, nodes: &mut Vec<Node>) {
    let corners = triangles.iter().flatten();
    let (low, high) =
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let at = nodes.len();
    nodes.push(Node { low, high, first, count: triangles.len() as u32, second: 0 });
    if triangles.len() <= LEAF {
        return;
    }
    let extent = high - low;
    let axis = extent.to_array().iter().position(|x| *x >= extent.max_element()).unwrap_or(0);
    let half = triangles.len() / 2;
    let key = |[a, b, c]: &Triangle| a[axis] + b[axis] + c[axis];
    triangles.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)));
    let (left, right) = triangles.split_at_mut(half);
    build(left, first, nodes);
    nodes[at].second = nodes.len() as u32;
    build(right, first + half as u32, nodes);
}

/// Solid angle of a triangle as seen from a point, above 0 where it looks away (van Oosterom and Strackee 1983).
fn solid_angle(triangle: &Triangle, p: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|corner| corner - p);
    let [x, y, z] = [a, b, c].map(DVec3::length);
    2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
}

/// The point of a triangle that is nearest to another one.
fn nearest(triangle: &Triangle, p: DVec3) -> DVec3 {
    let [a, b, c] = *triangle;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    let whole = va + vb + vc;
    if whole <= 0.0 { a } else { a + vb / whole * ab + vc / whole * ac }
}
