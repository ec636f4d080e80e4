//! Figures of shaders as they stand in their text, so that no test repeats them.

use nephos::gpu::LIBRARY;

/// The numbers of `const NAME: type = value;` in a module of `shaders/lib`.
pub fn constants(module: &str, name: &str) -> Vec<f64> {
    let (_, source) = LIBRARY.iter().find(|(known, _)| *known == module).expect("the module is known");
    let start = format!("const {name}: ");
    let line = source.lines().find(|line| line.starts_with(&start)).expect("the constant is there");
    let value = line.split_once(" = ").expect("a constant has a value").1;
    let value = value.split_once('(').map_or(value, |(_, inside)| inside);
    let numbers = value.split([',', ')', ';']).map(|word| word.trim().trim_end_matches(['u', 'f']));
    numbers.filter_map(|word| word.parse().ok()).collect()
}

/// One of a single number, as the shader holds it.
pub fn constant(module: &str, name: &str) -> f64 {
    let numbers = constants(module, name);
    assert_eq!(numbers.len(), 1, "{name} is one number");
    f64::from(numbers[0] as f32)
}

#[test]
fn constants_are_read_from_the_text_of_shaders() {
    assert_eq!(constants("depth_volume", "DEPTH_CELLS"), [8.0]);
    assert_eq!(constants("density", "RISE").len(), 2);
    assert!(constant("density", "DILUTED") > 1.0);
}
