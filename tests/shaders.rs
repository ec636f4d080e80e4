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
