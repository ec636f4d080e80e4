//! Triangles of glTF files, where their nodes, instances and skins put them.

use std::path::Path;

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::{
    Gltf,
    accessor::Stored,
    document::{Node, Primitive, placed},
};
use crate::{Error, Result, import::Mesh};

/// Most corners of a mesh with all its copies.
const MOST_CORNERS: usize = 100_000_000;

/// All triangles of a file's scene.
pub(in crate::import) fn read_mesh(path: &Path) -> Result<Mesh> {
    let file = Gltf::open(path)?;
    let mut mesh = Mesh::default();
    for (node, world_from_node) in file.nodes() {
        let Some(number) = node.mesh else { continue };
        let Some(shape) = file.document.meshes.get(number) else {
            return Err(file.foreign(&format!("a node names mesh {number}, which is not there")));
        };
        let weights = node.weights.as_ref().unwrap_or(&shape.weights);
        for primitive in &shape.primitives {
            let Some(part) = Part::read(&file, primitive, weights)? else { continue };
            if let Some(bones) = Bones::read(&file, node, primitive)? {
                part.add_to(&mut mesh, |corner| bones.world_from_corner(corner));
                continue;
            }
            let copies = file.instances(node)?;
            if copies.len().saturating_mul(part.corners.len()) > MOST_CORNERS - mesh.positions.len() {
                let problem = format!("has more than {MOST_CORNERS} corners: export a part of it");
                return Err(Error::Format { path: path.to_owned(), problem });
            }
            copies.iter().for_each(|copy| part.add_to(&mut mesh, |_| world_from_node * *copy));
        }
    }
    Ok(mesh)
}

/// A primitive as it is stored.
struct Part {
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Part {
    /// Nothing where it has no triangles.
    fn read(file: &Gltf, primitive: &Primitive, weights: &[f64]) -> Result<Option<Self>> {
        let Some(&positions) = primitive.attributes.get("POSITION") else { return Ok(None) };
        const DRACO: &str = "KHR_draco_mesh_compression";
        let stored = file.document.accessors.get(positions);
        if primitive.extensions.contains_key(DRACO) && stored.is_some_and(|own| own.buffer_view.is_none()) {
            return Err(file.needs(DRACO));
        }
        let mut corners = file.points(positions)?;
        for (target, &weight) in primitive.targets.iter().zip(weights) {
            if let Some(&moves) = target.get("POSITION").filter(|_| weight != 0.0) {
                let moves = file.points(moves)?;
                corners.iter_mut().zip(moves).for_each(|(corner, by)| *corner += weight * by);
            }
        }
        let order: Vec<u32> = match primitive.indices {
            Some(indices) => {
                let numbers = file.numbers(indices, "SCALAR", Stored::Indices)?;
                numbers.into_iter().map(|number| number as u32).collect()
            }
            None => (0..corners.len() as u32).collect(),
        };
        let Some(mut triangles) = triangles(primitive.mode, &order) else { return Ok(None) };
        triangles.retain(|triangle| triangle.iter().all(|&i| (i as usize) < corners.len()));
        Ok(Some(Self { corners, triangles }))
    }

    /// Adds it to a mesh; a place that mirrors turns triangles round (glTF 2.0, 3.7.4).
    fn add_to(&self, mesh: &mut Mesh, world_from_corner: impl Fn(usize) -> DMat4) {
        let first = mesh.positions.len() as u32;
        let world = |(i, corner): (usize, &DVec3)| world_from_corner(i).transform_point3(*corner);
        mesh.positions.extend(self.corners.iter().enumerate().map(world));
        mesh.triangles.extend(self.triangles.iter().map(|&[a, b, c]| {
            let mirrored = world_from_corner(a as usize).determinant() < 0.0;
            let turned = if mirrored { [a, c, b] } else { [a, b, c] };
            turned.map(|i| first + i)
        }));
    }
}

/// Triangles of corners in the order of a mode of topology (glTF 2.0, 3.7.2.1); nothing for points and lines.
fn triangles(mode: Option<u32>, order: &[u32]) -> Option<Vec<[u32; 3]>> {
    let threes = order.windows(3).enumerate();
    Some(match mode {
        None | Some(4) => order.as_chunks::<3>().0.to_vec(),
        Some(5) => {
            threes.map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] }).collect()
        }
        Some(6) => order.windows(2).skip(1).map(|pair| [pair[0], pair[1], order[0]]).collect(),
        _ => return None,
    })
}

/// What moves the corners of a skinned mesh: its own node does not (glTF 2.0, 3.7.3.3).
struct Bones {
    /// By joint, from the mesh as it was bound to the world.
    world_from_bound: Vec<DMat4>,
    /// Of each corner, by set: joints and their shares.
    sets: Vec<(Vec<DVec4>, Vec<DVec4>)>,
}

impl Bones {
    /// Nothing where the node has no skin, or the mesh no joints.
    fn read(file: &Gltf, node: &Node, primitive: &Primitive) -> Result<Option<Self>> {
        let Some(skin) = node.skin.and_then(|skin| file.document.skins.get(skin)) else { return Ok(None) };
        let attributes = &primitive.attributes;
        let names = (0..)
            .map(|set| (attributes.get(&format!("JOINTS_{set}")), attributes.get(&format!("WEIGHTS_{set}"))));
        let mut sets = Vec::new();
        for (joints, weights) in names.map_while(|(joints, weights)| joints.zip(weights)) {
            let four = |index: &usize, stored| -> Result<Vec<DVec4>> {
                let numbers = file.numbers(*index, "VEC4", stored)?;
                Ok(numbers.as_chunks::<4>().0.iter().copied().map(DVec4::from).collect())
            };
            sets.push((four(joints, Stored::Indices)?, four(weights, Stored::Quantized)?));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let inverse = match skin.inverse_bind_matrices {
            Some(index) => file.numbers(index, "MAT4", Stored::Floats)?,
            None => Vec::new(),
        };
        let inverse: Vec<_> = inverse.as_chunks::<16>().0.iter().map(DMat4::from_cols_array).collect();
        let worlds = file.walk();
        let bone = |(i, joint): (usize, &usize)| {
            let world =
                worlds.iter().find(|(node, _)| node == joint).map_or(DMat4::IDENTITY, |(_, world)| *world);
            world * inverse.get(i).copied().unwrap_or(DMat4::IDENTITY)
        };
        Ok(Some(Self { world_from_bound: skin.joints.iter().enumerate().map(bone).collect(), sets }))
    }

    fn world_from_corner(&self, corner: usize) -> DMat4 {
        let of_set = |(joints, shares): &(Vec<DVec4>, Vec<DVec4>)| {
            let (joints, shares) = (joints.get(corner)?.to_array(), shares.get(corner)?.to_array());
            let bone =
                |joint: f64| self.world_from_bound.get(joint as usize).copied().unwrap_or(DMat4::IDENTITY);
            Some(joints.iter().zip(shares).map(|(&joint, share)| bone(joint) * share).sum::<DMat4>())
        };
        let sum: DMat4 = self.sets.iter().filter_map(of_set).sum();
        // Shares add up to 1 but for the rounding of small whole numbers.
        if sum.w_axis.w > 0.0 { sum * sum.w_axis.w.recip() } else { DMat4::IDENTITY }
    }
}

impl Gltf {
    fn points(&self, accessor: usize) -> Result<Vec<DVec3>> {
        let quantized = self.document.extensions_used.iter().chain(&self.document.extensions_required);
        let stored = match quantized.into_iter().any(|name| name == "KHR_mesh_quantization") {
            true => Stored::Quantized,
            false => Stored::Floats,
        };
        let numbers = self.numbers(accessor, "VEC3", stored)?;
        Ok(numbers.as_chunks::<3>().0.iter().copied().map(DVec3::from).collect())
    }

    /// From each copy of a node's mesh to the node (EXT_mesh_gpu_instancing); of most, the one that is it.
    fn instances(&self, node: &Node) -> Result<Vec<DMat4>> {
        let told = node.extensions.get("EXT_mesh_gpu_instancing").and_then(|told| told.get("attributes"));
        let Some(told) = told else { return Ok(vec![DMat4::IDENTITY]) };
        let numbers = |name: &str, kind: &str, stored| {
            let accessor = told.get(name).and_then(serde_json::Value::as_u64);
            accessor.map(|accessor| self.numbers(accessor as usize, kind, stored)).transpose()
        };
        let threes = |numbers: Option<Vec<f64>>| -> Option<Vec<DVec3>> {
            Some(numbers?.as_chunks::<3>().0.iter().copied().map(DVec3::from).collect())
        };
        let moves = threes(numbers("TRANSLATION", "VEC3", Stored::Floats)?);
        let scales = threes(numbers("SCALE", "VEC3", Stored::Floats)?);
        let turns: Option<Vec<DQuat>> = numbers("ROTATION", "VEC4", Stored::Quantized)?
            .map(|numbers| numbers.as_chunks::<4>().0.iter().copied().map(DQuat::from_array).collect());
        let counts =
            [moves.as_ref().map(Vec::len), scales.as_ref().map(Vec::len), turns.as_ref().map(Vec::len)];
        // One that has no places is where its node is.
        let count = counts.into_iter().flatten().min().unwrap_or(1);
        let at = |list: &Option<Vec<DVec3>>, i: usize| list.as_ref().map(|list| list[i]);
        Ok((0..count)
            .map(|i| placed(at(&moves, i), turns.as_ref().map(|turns| turns[i]), at(&scales, i)))
            .collect())
    }
}
