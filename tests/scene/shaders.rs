//! Every shader links, parses and validates with every module that can fill its roles; names are unique.

use nephos::{
    frame::{GroundShader, MEDIA},
    gpu::{ENTRY_POINTS, LIBRARY, Role, in_place_of, link, validate},
    render::Transport,
};

/// What a map that shades a cloud puts in place of a part.
fn shade_map() -> Role<'static> {
    in_place_of("shade", "shade_map")
}

/// Every way to fill the roles of shaders.
fn roles() -> impl Iterator<Item = Vec<Role<'static>>> {
    let usual = MEDIA
        .iter()
        .flat_map(|medium| Transport::all().map(move |light| [&[*medium], light.roles()].concat()));
    let shaded = usual.flat_map(|roles| [[roles.as_slice(), &[shade_map()]].concat(), roles]);
    let ground = |roles: &[Role<'static>], kind: GroundShader| [roles, &[kind.role()]].concat();
    shaded.flat_map(move |roles| GroundShader::ALL.map(|kind| ground(&roles, kind)))
}

/// Ways to link an entry point that differ.
fn linked(source: &str) -> Vec<String> {
    let mut all: Vec<_> = roles().map(|roles| link(source, &roles)).collect();
    all.dedup();
    all
}

#[test]
fn every_shader_validates_with_whatever_fills_its_roles() {
    for (name, source) in LIBRARY.iter().chain(ENTRY_POINTS) {
        for text in linked(source) {
            if let Err(message) = validate(&text) {
                panic!("{name}: {message}");
            }
        }
    }
}

#[test]
fn all_library_modules_link_into_one() {
    let names: Vec<_> = LIBRARY.iter().map(|(name, _)| *name).collect();
    let all = link(&format!("// @use {}\n", names.join(" ")), &[]);
    if let Err(message) = validate(&all) {
        panic!("{message}");
    }
}

#[test]
fn functions_of_the_roles_are_there_as_they_are_told() {
    let text = include_str!("../../ARCHITECTURE.md");
    let (_, roles) = text.split_once("\n## Roles").unwrap();
    let (roles, _) = roles.split_once("\n## ").unwrap();
    let march = ENTRY_POINTS.iter().find(|(name, _)| *name == "march").unwrap().1;
    let linked: Vec<String> =
        MEDIA.iter().map(|m| link(march, &[&[*m], Transport::MOMENTS.roles()].concat())).collect();
    let rows = roles.lines().filter_map(|line| line.strip_prefix("| `")?.split_once(" | "));
    let told = rows.flat_map(|(names, _)| names.split('`').filter(|name| name.contains('(')));
    let names: Vec<&str> = told.map(|name| name.split('(').next().unwrap()).collect();
    assert!(names.len() > 12, "{names:?}");
    for name in names {
        let head = format!("fn {name}(");
        assert!(linked.iter().all(|text| text.contains(&head)), "{name}");
    }
}

#[test]
fn no_stage_binds_more_textures_than_leave_six_free() {
    let march = ENTRY_POINTS.iter().find(|(name, _)| *name == "march").unwrap().1;
    // Group 3 is the vertex stage's.
    let is_texture = |line: &&str| {
        line.starts_with("@group") && !line.starts_with("@group(3)") && line.contains(": texture_")
    };
    let textures = |roles: &[Role<'static>]| link(march, roles).lines().filter(is_texture).count();
    // WebGPU grants 16.
    for roles in roles() {
        assert!(textures(&roles) <= 16, "{}", textures(&roles));
    }
    for medium in MEDIA {
        let roles = [&[*medium], Transport::MOMENTS.roles()].concat();
        assert!(textures(&roles) <= 10, "{}: {}", medium.1, textures(&roles));
        // A map that shades, as it does layers alone, is one more.
        assert_eq!(textures(&[&roles[..], &[shade_map()]].concat()), textures(&roles) + 1);
    }
}

#[test]
fn every_combination_of_overrides_validates() {
    use wgpu::naga::{back::pipeline_constants::process_overrides, valid};
    let mut checked = 0;
    for (name, source) in ENTRY_POINTS {
        for text in linked(source) {
            let module = validate(&text).unwrap();
            let info = valid::Validator::new(
                valid::ValidationFlags::all(),
                valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
            )
            .validate(&module)
            .unwrap();
            let names: Vec<_> = module.overrides.iter().map(|(_, o)| o.name.clone().unwrap()).collect();
            let all = 1u32 << names.len();
            // One by one and all but one where there are many.
            let combinations: Vec<u32> = if names.len() <= 6 {
                (0..all).collect()
            } else {
                (0..names.len()).flat_map(|i| [1 << i, (all - 1) & !(1 << i)]).chain([0, all - 1]).collect()
            };
            for combination in combinations {
                // A pixel has one thread at the least.
                let least = |name: &str| u32::from(name == "LANES");
                let value = |(bit, name): (usize, &String)| {
                    (name.clone(), f64::from(least(name) + (combination >> bit & 1)))
                };
                let constants = names.iter().enumerate().map(value).collect();
                for entry in &module.entry_points {
                    let stage = Some((entry.stage, entry.name.as_str()));
                    if let Err(error) = process_overrides(&module, &info, stage, &constants) {
                        panic!("{name} {constants:?}: {error}");
                    }
                    checked += 1;
                }
            }
            checked += 1;
        }
    }
    assert!(checked > 500, "{checked}");
}
