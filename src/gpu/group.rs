//! The bind groups of a shader, as its text declares them. Layouts are made from the text, so that
//! pipelines of different roles can share a group: two shaders that declare the same bindings in a
//! group have the same layout for it.

use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages,
    StorageTextureAccess, TextureFormat, TextureSampleType, TextureViewDimension,
};

use super::made::Made;

/// Group of the vertex stage alone; others are seen by all stages.
const OF_VERTICES: u32 = 3;

/// Bindings of group 0 whose place in their buffer is told anew with each draw or dispatch: by shader, what of a
/// thousand clouds lies in one buffer.
const MOVING: [(&str, u32); 2] = [("march", 1), ("moments_view", 1)];

/// Layouts of all groups that the linked WGSL of shader `name` declares, from group 0 on; none for one that is left out.
pub(super) fn layouts(device: &wgpu::Device, name: &str, linked: &str) -> Vec<Option<BindGroupLayout>> {
    let mut declared: Vec<_> = linked.split([';', '\n']).filter_map(declaration).collect();
    for (group, entry) in &mut declared {
        if let BindingType::Buffer { has_dynamic_offset, .. } = &mut entry.ty {
            *has_dynamic_offset = *group == 0 && MOVING.contains(&(name, entry.binding));
        }
    }
    let groups = declared.iter().map(|(group, _)| group + 1).max().unwrap_or(0);
    let layout = |group| {
        let mut entries: Vec<_> =
            declared.iter().filter(|(of, _)| *of == group).map(|(_, entry)| *entry).collect();
        entries.sort_by_key(|entry| entry.binding);
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        (!entries.is_empty()).then(|| device.create_bind_group_layout(&descriptor))
    };
    (0..groups).map(layout).collect()
}

/// What a statement declares: `@group(0) @binding(1) var<uniform> name: Type`.
fn declaration(statement: &str) -> Option<(u32, BindGroupLayoutEntry)> {
    let (group, rest) = statement.trim_start().strip_prefix("@group(")?.split_once(") @binding(")?;
    let (binding, rest) = rest.split_once(") var")?;
    let (space, kind) = rest.split_once(": ")?;
    let (group, ty) = (group.parse().ok()?, binding_type(space, kind));
    let visibility = match group {
        OF_VERTICES => ShaderStages::VERTEX,
        // Vertices have textures in their own group alone, so that all others count for fragments only.
        _ if is_written(ty) || matches!(ty, BindingType::Texture { .. }) => {
            ShaderStages::FRAGMENT | ShaderStages::COMPUTE
        }
        _ => ShaderStages::VERTEX_FRAGMENT | ShaderStages::COMPUTE,
    };
    Some((group, BindGroupLayoutEntry { binding: binding.parse().ok()?, visibility, ty, count: None }))
}

/// How many bindings linked WGSL declares.
#[cfg(test)]
pub(crate) fn declared_bindings(linked: &str) -> usize {
    linked.split([';', '\n']).filter_map(declaration).count()
}

fn is_written(ty: BindingType) -> bool {
    match ty {
        BindingType::Buffer { ty, .. } => ty == BufferBindingType::Storage { read_only: false },
        BindingType::StorageTexture { .. } => true,
        _ => false,
    }
}

fn binding_type(space: &str, kind: &str) -> BindingType {
    let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let dimension = match kind {
        kind if kind.contains("_3d") => TextureViewDimension::D3,
        kind if kind.contains("_2d_array") => TextureViewDimension::D2Array,
        _ => TextureViewDimension::D2,
    };
    let sampled =
        |sample_type| BindingType::Texture { sample_type, view_dimension: dimension, multisampled: false };
    if space.starts_with("<uniform>") {
        buffer(BufferBindingType::Uniform)
    } else if space.starts_with("<storage") {
        buffer(BufferBindingType::Storage { read_only: !space.starts_with("<storage, read_write>") })
    } else if kind == "sampler" {
        BindingType::Sampler(wgpu::SamplerBindingType::Filtering)
    } else if kind.starts_with("texture_storage") {
        BindingType::StorageTexture {
            access: StorageTextureAccess::WriteOnly,
            format: storage_format(kind),
            view_dimension: dimension,
        }
    } else if kind.starts_with("texture_depth") {
        sampled(TextureSampleType::Depth)
    } else if kind.contains("<u32>") {
        sampled(TextureSampleType::Uint)
    } else {
        sampled(TextureSampleType::Float { filterable: true })
    }
}

fn storage_format(kind: &str) -> TextureFormat {
    if kind.contains("r32uint") { TextureFormat::R32Uint } else { TextureFormat::Rgba16Float }
}

/// A bind group whose entry `i` goes to binding `i`; bindings that are not declared are `None`.
pub(crate) fn bind_group(
    device: &wgpu::Device,
    label: &str,
    layout: &BindGroupLayout,
    resources: &[Option<wgpu::BindingResource<'_>>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .filter_map(|(binding, resource)| {
            Some(wgpu::BindGroupEntry { binding: binding as u32, resource: resource.clone()? })
        })
        .collect();
    Made::one(|made| &mut made.groups);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_of_bindings_are_told_apart() {
        let of = |line| declaration(line).unwrap().1.ty;
        let storage = |read_only| BindingType::Buffer {
            ty: BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        assert_eq!(of("@group(0) @binding(3) var<storage, read> list: array<u32>"), storage(true));
        assert_eq!(of("@group(0) @binding(3) var<storage, read_write> list: array<u32>"), storage(false));
        let depth = of("@group(1) @binding(0) var depth: texture_depth_2d");
        assert!(matches!(depth, BindingType::Texture { sample_type: TextureSampleType::Depth, .. }));
        assert!(declaration("let x = 1u").is_none());
    }
}
