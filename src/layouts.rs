//! What Rust and the shaders share: structs, compared member by member, and constants.

use std::mem::{offset_of, size_of};

use wgpu::naga::{Expression, Literal, Module, TypeInner, proc::Layouter};

use crate::{
    frame::{
        CameraUniform, GroundShader, GroundUniform, LARGER, MEDIA, MIXED, PATTERN_SCALE,
        medium::{
            BodyUniform, BrickUniform, CELLS, DepthVolumeUniform, EllipsoidUniform, FINE, LAYER,
            LayerUniform, MIXED_ROW, MOST_LAYERS, MOST_MESHES, MOST_VOLUMES, MixedUniform, NoiseFrame, PEAKS,
            PlacedLayerUniform, PlacedMeshUniform, PlacedVolumeUniform, SQUARES, SpeciesUniform, VOLUME,
            VOLUME_CELLS, VOLUME_LEVELS, VolumeUniform,
        },
    },
    gpu,
    optics::slab::{SETS, axes, samples},
    reference::{self, GridUniform, MOST_GRIDS, PATH_BYTES, SUM_FLOATS, SceneUniform},
    render::{
        AroundUniform, BRICK, BlockUniform, CROSSING_CELL, CasterUniform, CloudUniform, ComposeUniform,
        FieldUniform, LightBox, LightUniform, MOST_NODES, ResolveUniform, Shown, SunMapUniform, Tile,
        Transport, VoxelsUniform, resolve_uniform,
    },
    scene::{BLOCK_EDGE, BLOCK_VOXELS, Tone, ToneCurve},
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

/// A shader whose roles are filled by ellipsoids and a model of light.
fn module(entry_point: &str, light: Transport) -> Module {
    let roles = [&[MEDIA[0], GroundShader::Even.role()], light.roles()].concat();
    gpu::validate(&gpu::entry_point(entry_point, &roles)).unwrap()
}

fn in_shader(entry_point: &str, name: &str) -> Layout {
    let medium = match name {
        "Layer" => LAYER,
        "Volume" => VOLUME,
        "PlacedLayer" | "PlacedMesh" | "PlacedVolume" | "Mixed" => MIXED,
        _ => MEDIA[0],
    };
    let roles = [&[medium, GroundShader::Land.role()], Transport::default().roles()].concat();
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
    let cases: [(&str, &str, Layout); 28] = [
        ("path", "Grid", layout!(GridUniform: low, cell, size, first, repeats, more)),
        ("path", "PlacedLayer", layout!(PlacedLayerUniform: layer, origin, body)),
        ("path", "PlacedVolume", layout!(PlacedVolumeUniform: volume, origin, body)),
        ("path", "PlacedMesh", layout!(PlacedMeshUniform: volume, origin, body, first)),
        (
            "path",
            "Mixed",
            layout!(MixedUniform: layers, volumes, meshes, layer_count, volume_count, mesh_count),
        ),
        ("sun_map", "Caster", layout!(CasterUniform: light_box, tiles, turning)),
        (
            "sky",
            "SunMap",
            layout!(SunMapUniform: across, squares, aside, sun_radius, along, reach, place, planes, endless),
        ),
        (
            "path",
            "Scene",
            layout!(SceneUniform: grids, camera, samples, to_sun, sun_radius, sun_irradiance, altitude, first, rounds, seed, curvature, flash),
        ),
        (
            "march",
            "Camera",
            layout!(CameraUniform: right, projection, up, altitude, forward, pixel, axis, jitter, size),
        ),
        (
            "march",
            "Ellipsoid",
            layout!(EllipsoidUniform: row_x, row_y, row_z, center, extinction, boundary, wispiness, core, body),
        ),
        (
            "march",
            "NoiseFrame",
            layout!(NoiseFrame: coarse_x, coarse_y, coarse_z, fine_x, fine_y, fine_z, amplitudes, scale, texels_per_metre, frequency, flow, first, second),
        ),
        (
            "march",
            "LightBox",
            layout!(LightBox: corner, texel, row_u, length, row_v, repeat, row_w, edge_u, edge_v, along),
        ),
        (
            "march",
            "Cloud",
            layout!(CloudUniform: camera, opaque, to_sun, sun_radius, sun_irradiance, aerial_range, base, top,
                first_step, longest_step, growth, lit_at_once, shadow_range, curvature, scene_depth, moons),
        ),
        (
            "march",
            "Volume",
            layout!(VolumeUniform: row_x, row_y, row_z, texel, extinction, slots, voxel, count, widest, mixed, levels),
        ),
        ("sky", "Ground", layout!(GroundUniform: offset, edge, variation, slope_variance, height)),
        ("march", "Light", layout!(LightUniform: sun, sky, field_low, mean_free_path, field_scale, flash)),
        (
            "march",
            "Body",
            layout!(BodyUniform: noise, species, power, reach, base, inverse_height, stratification, dilution, level, uneven, table),
        ),
        (
            "march",
            "Species",
            layout!(SpeciesUniform: truncated, asymmetry, albedo, similarity, degrees, ahead),
        ),
        ("moments_around", "Around", layout!(AroundUniform: rows, through, weights, open, returned, shaded)),
        (
            "moments_sweep",
            "Field",
            layout!(FieldUniform: low, directions, cell, lights, size, truncated, scattering, beam, flash, repeats),
        ),
        (
            "march",
            "Layer",
            layout!(LayerUniform: rim, top, bottom, ground, frequency, texel, begin, rise, sheet, flat, round, steepest,
                extinction, boundary, wispiness),
        ),
        (
            "depth_bake",
            "DepthVolume",
            layout!(DepthVolumeUniform: low, brick, size, core, texel, boundary, slots, power, reach),
        ),
        ("depth_bake", "Brick", layout!(BrickUniform: place, first, count)),
        ("march", "Tile", layout!(Tile: area, first, count, block, others)),
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
    assert_eq!(in_shader("path", "StoredPath").1 as usize, PATH_BYTES);
    assert_eq!(in_shader("path", "Sum").1 as usize, 4 * SUM_FLOATS);
}

/// A number at the head of a linked shader.
fn constant(entry_point: &str, name: &str) -> f32 {
    let module = module(entry_point, Transport::SLAB_KOL_DIRECT);
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
    let shown = |shown| resolve_uniform(1, shown).shown as f32;
    let cases = [
        ("sky", "SUN_MAP_SQUARES", SunMapUniform::SQUARES as f32),
        ("sky", "SUN_MAP_LAYERS", SunMapUniform::LAYERS as f32),
        ("march", "CROSSING_CELL", CROSSING_CELL as f32),
        ("march", "PEAKS", PEAKS as f32),
        ("march", "BRICK", BRICK as f32),
        ("march", "MOST_NODES", MOST_NODES as f32),
        ("march", "FINE", FINE as f32),
        ("march", "PERSPECTIVE", CameraUniform::PERSPECTIVE as f32),
        ("march", "ORTHOGRAPHIC", CameraUniform::ORTHOGRAPHIC as f32),
        ("march", "EQUIRECTANGULAR", CameraUniform::EQUIRECTANGULAR as f32),
        ("march", "SLAB_SETS", SETS as f32),
        ("march", "SLAB_THINNEST", axes::THICKNESS[0] as f32),
        ("march", "SLAB_THICKEST", axes::THICKNESS[1] as f32),
        ("march", "SLAB_LOWEST_SUN", axes::LOWEST_SUN as f32),
        ("march", "SLAB_FACE", axes::FACE as f32),
        ("march", "SLAB_DIRECT_THICKNESSES", samples::THICKNESSES as f32),
        ("depth_bake", "DEPTH_CELLS", CELLS as f32),
        ("path", "ANGLES", reference::ANGLES as f32),
        ("compose", "TONE_FILMIC", tone(ToneCurve::Filmic)),
        ("compose", "TONE_SOFT", tone(ToneCurve::Soft)),
        ("compose", "TONE_LINEAR", tone(ToneCurve::Linear)),
        ("compose", "TONE_NATURAL", tone(ToneCurve::Natural)),
        ("compose", "TONE_PHOTO", tone(ToneCurve::Photo)),
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

#[test]
fn squares_of_layers_are_as_many_as_the_shader_takes() {
    let text = gpu::entry_point("march", &[&[LAYER], Transport::default().roles()].concat());
    assert!(text.contains(&format!("const LAYER_SQUARES: u32 = {SQUARES}u;")));
    assert!(text.contains(&format!("const SQUARE_SIZES: u32 = {}u;", SQUARES.ilog2() + 1)));
}

#[test]
fn bricks_of_volumes_are_as_the_shader_takes_them() {
    let text = gpu::entry_point("march", &[&[VOLUME], Transport::default().roles()].concat());
    assert!(text.contains(&format!("const VOLUME_CELLS: u32 = {VOLUME_CELLS}u;")));
    assert!(text.contains(&format!("const VOLUME_LEVELS: u32 = {VOLUME_LEVELS}u;")));
}

#[test]
fn a_mixture_has_the_room_that_the_shader_takes() {
    let text = gpu::entry_point("path", &[MIXED]);
    for (name, count) in [
        ("MOST_LAYERS", MOST_LAYERS),
        ("MOST_MESHES", MOST_MESHES),
        ("MOST_VOLUMES", MOST_VOLUMES),
        ("MIXED_ROW", MIXED_ROW as usize),
    ] {
        assert!(text.contains(&format!("const {name}: u32 = {count}u;")), "{name}");
    }
    assert_eq!(MOST_GRIDS, 1 + MOST_LAYERS);
    assert!(text.contains(&format!("const MOST_GRIDS: u32 = {MOST_GRIDS}u;")));
}

#[test]
fn the_pattern_of_land_is_as_the_shader_takes_it() {
    let (_, text) = GroundShader::Land.role();
    assert!(text.contains(&format!("const LARGER: f32 = {LARGER}.0;")));
    assert!(text.contains(&format!("const PATTERN_SCALE: f32 = {PATTERN_SCALE:.1};")));
}

#[test]
fn every_binding_is_declared_in_a_statement_of_its_own() {
    for (name, _) in gpu::ENTRY_POINTS {
        for transport in Transport::all() {
            let roles = [&[MEDIA[0], GroundShader::Land.role()], transport.roles()].concat();
            let text = gpu::entry_point(name, &roles);
            assert_eq!(gpu::declared_bindings(&text), text.matches("@binding(").count(), "{name}");
        }
    }
}

#[test]
fn workgroup_sizes_are_those_that_naga_reads() {
    let mut compute = 0;
    for (name, _) in gpu::ENTRY_POINTS {
        let roles = [&[MEDIA[0], GroundShader::Even.role()], Transport::default().roles()].concat();
        let linked = gpu::entry_point(name, &roles);
        for point in gpu::validate(&linked).unwrap().entry_points {
            if point.stage == wgpu::naga::ShaderStage::Compute {
                assert_eq!(gpu::workgroup_size(&linked), point.workgroup_size, "{name}");
                compute += 1;
            }
        }
    }
    assert!(compute > 10, "{compute}");
}
