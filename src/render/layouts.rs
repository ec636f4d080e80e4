//! What Rust and the shaders share: structs, compared member by member, and constants.

use std::mem::{offset_of, size_of};

use wgpu::naga::{Expression, Literal, TypeInner, proc::Layouter};

use super::{
    bricks::BRICK,
    camera::CameraUniform,
    clouds::{CloudUniform, MOST_NODES},
    compose::ComposeUniform,
    ellipsoids::EllipsoidUniform,
    light_box::LightBox,
    moments::FieldUniform,
    noise::{FINE, NoiseFrame},
    resolve::{ResolveUniform, Shown, uniform},
    tiles::Tile,
    voxels::{BLOCK_EDGE, BLOCK_VOXELS, BlockUniform, VoxelsUniform},
};
use crate::{
    gpu,
    optics::slab::{SETS, axes, samples},
    reference::{self, PATH_BYTES, SUM_FLOATS, SceneUniform},
    scene::{Tone, ToneCurve},
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
    let module = gpu::validate(&gpu::entry_point(entry_point)).unwrap();
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
    let cases: [(&str, &str, Layout); 12] = [
        (
            "path",
            "Scene",
            layout!(SceneUniform: low, cell, size, samples, camera, seed, to_sun, sun_radius, sun_irradiance, altitude, first, rounds),
        ),
        (
            "clouds",
            "Camera",
            layout!(CameraUniform: right, projection, up, altitude, forward, pixel, size, jitter),
        ),
        (
            "clouds",
            "Ellipsoid",
            layout!(EllipsoidUniform: row_x, row_y, row_z, center, extinction, displacement, rise, wispiness, core),
        ),
        (
            "clouds",
            "NoiseFrame",
            layout!(NoiseFrame: coarse_x, coarse_y, coarse_z, fine_x, fine_y, fine_z, fine_weight, texels_per_metre, frequency),
        ),
        (
            "clouds",
            "LightBox",
            layout!(LightBox: corner, texel, row_u, before, row_v, own, row_w, all, edge_u, chop, edge_v, asymmetry,
                along, length),
        ),
        (
            "clouds",
            "Cloud",
            layout!(CloudUniform: camera, chop, to_sun, asymmetry, sun_irradiance, albedo, base, top, mean_free_path,
                aerial_range, first_step, growth, opaque, longest_step, lit_at_once, sun_radius, similarity, scene_depth,
                degrees, field_low, field_scale, sun, sky),
        ),
        (
            "moments_sweep",
            "Field",
            layout!(FieldUniform: low, directions, cell, lights, size, ahead, scattering, beam),
        ),
        ("clouds", "Tile", layout!(Tile: area, first, count)),
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

/// A number at the head of a linked shader.
fn constant(entry_point: &str, name: &str) -> f32 {
    let module = gpu::validate(&gpu::entry_point(entry_point)).unwrap();
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
    let (_, found) = found.unwrap_or_else(|| panic!("{entry_point} has no {name}"));
    match module.global_expressions[found.init] {
        Expression::Literal(Literal::U32(number)) => number as f32,
        Expression::Literal(Literal::F32(number)) => number,
        ref other => panic!("{name} is no number: {other:?}"),
    }
}

#[test]
fn constants_of_rust_and_shaders_agree() {
    let tone = |curve| ComposeUniform::new(Tone { stops: 0.0, curve }).curve as f32;
    let shown = |shown| uniform(1, shown).shown as f32;
    let cases = [
        ("clouds", "BRICK", BRICK as f32),
        ("clouds", "MOST_NODES", MOST_NODES as f32),
        ("clouds", "FINE", FINE as f32),
        ("clouds", "PERSPECTIVE", CameraUniform::PERSPECTIVE as f32),
        ("clouds", "ORTHOGRAPHIC", CameraUniform::ORTHOGRAPHIC as f32),
        ("clouds", "EQUIRECTANGULAR", CameraUniform::EQUIRECTANGULAR as f32),
        ("clouds", "SLAB_SETS", SETS as f32),
        ("clouds", "SLAB_THINNEST", axes::THICKNESS[0] as f32),
        ("clouds", "SLAB_THICKEST", axes::THICKNESS[1] as f32),
        ("clouds", "SLAB_LOWEST_SUN", axes::LOWEST_SUN as f32),
        ("clouds", "SLAB_FACE", axes::FACE as f32),
        ("clouds", "SLAB_DIRECT_THICKNESSES", samples::THICKNESSES as f32),
        ("path", "ANGLES", reference::ANGLES as f32),
        ("compose", "TONE_FILMIC", tone(ToneCurve::Filmic)),
        ("compose", "TONE_SOFT", tone(ToneCurve::Soft)),
        ("compose", "TONE_LINEAR", tone(ToneCurve::Linear)),
        ("resolve", "BEAUTY", shown(Shown::Beauty)),
        ("resolve", "LIGHT", shown(Shown::Light)),
        ("resolve", "TRANSMITTANCE", shown(Shown::Transmittance)),
        ("resolve", "NORMAL", shown(Shown::Normal)),
        ("resolve", "HEAT", shown(Shown::Heat(1.0))),
        ("voxels", "EDGE", BLOCK_EDGE as f32),
        ("voxels", "VOXELS", BLOCK_VOXELS as f32),
    ];
    for (shader, name, rust) in cases {
        assert_eq!(constant(shader, name), rust, "{name} of {shader}");
    }
}
