//! Every shader links, parses and validates; names are unique.

use nephos::gpu::{ENTRY_POINTS, LIBRARY, link, validate};

#[test]
fn every_module_links_and_validates_alone() {
    for (name, source) in LIBRARY.iter().chain(ENTRY_POINTS) {
        if let Err(message) = validate(&link(source)) {
            panic!("{name}: {message}");
        }
    }
}

#[test]
fn all_library_modules_link_into_one() {
    let names: Vec<_> = LIBRARY.iter().map(|(name, _)| *name).collect();
    let all = link(&format!("// @use {}\n", names.join(" ")));
    if let Err(message) = validate(&all) {
        panic!("{message}");
    }
}

#[test]
fn every_combination_of_overrides_validates() {
    use wgpu::naga::{back::pipeline_constants::process_overrides, valid};
    let mut checked = 0;
    for (name, source) in ENTRY_POINTS {
        let module = validate(&link(source)).unwrap();
        let info = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty())
            .validate(&module)
            .unwrap();
        let names: Vec<_> = module.overrides.iter().map(|(_, o)| o.name.clone().unwrap()).collect();
        for combination in 0..1u32 << names.len() {
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
    }
    assert!(checked > 500, "{checked}");
}
