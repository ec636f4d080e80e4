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
    use wgpu::naga::{Module, back::pipeline_constants::process_overrides, compact, valid};
    let mut checked = 0;
    let modules = ENTRY_POINTS.iter().map(|(name, source)| (name, validate(&link(source)).unwrap()));
    let each =
        |(name, module): (_, Module)| (0..module.entry_points.len()).map(move |i| (name, module.clone(), i));
    for (name, mut module, i) in modules.flat_map(each) {
        // Alone, with the overrides that it uses: others make no difference.
        module.entry_points = vec![module.entry_points.swap_remove(i)];
        compact::compact(&mut module, compact::KeepUnused::No);
        let info = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty())
            .validate(&module)
            .unwrap();
        let entry = &module.entry_points[0];
        let names: Vec<_> = module.overrides.iter().map(|(_, o)| o.name.clone().unwrap()).collect();
        for combination in 0..1u32 << names.len() {
            // A pixel has one thread at the least.
            let least = |name: &str| u32::from(name == "LANES");
            let value = |(bit, name): (usize, &String)| {
                (name.clone(), f64::from(least(name) + (combination >> bit & 1)))
            };
            let constants = names.iter().enumerate().map(value).collect();
            let stage = Some((entry.stage, entry.name.as_str()));
            if let Err(error) = process_overrides(&module, &info, stage, &constants) {
                panic!("{name} {constants:?}: {error}");
            }
            checked += 1;
        }
    }
    assert!(checked > 500, "{checked}");
}
