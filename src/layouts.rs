//! The structs that Rust and the shaders share, compared member by member.

use std::mem::{offset_of, size_of};

use wgpu::naga::{TypeInner, proc::Layouter};

use crate::{
    frame::{
        CameraUniform, MEDIA,
        medium::{BrickUniform, DepthVolumeUniform, EllipsoidUniform, NoiseFrame, SpeciesUniform},
    },
    gpu,
    reference::{PATH_BYTES, SUM_FLOATS, SceneUniform},
    render::{
        BlockUniform, CloudUniform, ComposeUniform, FieldUniform, LightBox, LightUniform, ResolveUniform,
        Tile, Transport, VoxelsUniform,
    },
};

/// Name, offset and size of each member, and the size of the whole.
type Layout = (Vec<(String, u32, u32)>, u32);

macro_rules! layout {
    ($type:ty: $($member:ident),+ $(,)?) => {{
        fn size<T, M>(_: fn(&T) -> &M) -> u32 {
            size_of::<M>() as u32
        }
        let members = vec![$((
            stringify!($member).to_owned(),
            offset_of!($type, $member) as u32,
            size(|value: &$type| &value.$member),
        )),+];
        (members, size_of::<$type>() as u32)
    }};
}

fn in_shader(entry_point: &str, name: &str) -> Layout {
    let roles = [&MEDIA[..1], Transport::default().roles()].concat();
    let module = gpu::validate(&gpu::entry_point(entry_point, &roles)).unwrap();
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap();
    let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
    let member = |m: &wgpu::naga::StructMember| (m.name.clone().unwrap(), m.offset, layouter[m.ty].size);
    // Padding is nobody's business.
    let named = members.iter().map(member).filter(|(name, ..)| !name.starts_with("padding"));
    (named.collect(), *span)
}

#[test]
fn structs_of_rust_and_shaders_agree() {
    let cases: [(&str, &str, Layout); 16] = [
        (
            "path",
            "Scene",
            layout!(SceneUniform: low, cell, size, samples, camera, seed, to_sun, sun_radius, sun_irradiance, altitude, first, rounds),
        ),
        (
            "march",
            "Camera",
            layout!(CameraUniform: right, projection, up, altitude, forward, pixel, axis, jitter, size),
        ),
        (
            "march",
            "Ellipsoid",
            layout!(EllipsoidUniform: row_x, row_y, row_z, center, extinction, displacement, rise, wispiness, core, species),
        ),
        (
            "march",
            "NoiseFrame",
            layout!(NoiseFrame: coarse_x, coarse_y, coarse_z, fine_x, fine_y, fine_z, fine_weight, texels_per_metre, frequency),
        ),
        (
            "march",
            "LightBox",
            layout!(LightBox: corner, texel, row_u, length, row_v, row_w, edge_u, edge_v, along),
        ),
        (
            "march",
            "Cloud",
            layout!(CloudUniform: camera, opaque, to_sun, sun_radius, sun_irradiance, aerial_range, base, top,
                first_step, longest_step, growth, lit_at_once, scene_depth),
        ),
        ("march", "Light", layout!(LightUniform: sun, sky, field_low, mean_free_path, field_scale)),
        ("march", "Species", layout!(SpeciesUniform: truncated, asymmetry, albedo, similarity, degrees)),
        (
            "moments_sweep",
            "Field",
            layout!(FieldUniform: low, directions, cell, lights, size, ahead, scattering, beam),
        ),
        (
            "depth_bake",
            "DepthVolume",
            layout!(DepthVolumeUniform: low, brick, size, core, texel, boundary, slots, rise),
        ),
        ("depth_bake", "Brick", layout!(BrickUniform: place, first, count)),
        ("march", "Tile", layout!(Tile: area, first, count)),
        ("compose", "Compose", layout!(ComposeUniform: exposure, curve)),
        ("voxels", "Voxels", layout!(VoxelsUniform: edge_x, samples, edge_y, blocks, edge_z)),
        ("voxels", "Block", layout!(BlockUniform: corner, first, count)),
        ("resolve", "Resolve", layout!(ResolveUniform: rays, shown, range, stops)),
    ];
    for (shader, name, rust) in cases {
        assert_eq!(in_shader(shader, name), rust, "{name}");
    }
}

#[test]
fn storage_of_paths_has_the_size_that_the_shader_takes() {
    assert_eq!(in_shader("path", "Path").1 as usize, PATH_BYTES);
    assert_eq!(in_shader("path", "Sum").1 as usize, 4 * SUM_FLOATS);
}
