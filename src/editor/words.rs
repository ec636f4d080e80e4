//! What the scene's schema says of each field: its help, its range, its unit. The schema is
//! the one home of these words.

use std::{
    collections::BTreeMap,
    sync::{LazyLock, Mutex, PoisonError},
};

use serde_json::Value;

use crate::scene::schema;

/// What the schema says of one field.
#[derive(Debug, Clone, PartialEq)]
pub struct Word {
    /// A sentence or two for people.
    pub help: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Symbol of the unit, with the space before it where it takes one; empty for pure numbers.
    pub unit: &'static str,
}

static SCHEMA: LazyLock<Value> = LazyLock::new(schema);
static KNOWN: Mutex<BTreeMap<&'static str, &'static Word>> = Mutex::new(BTreeMap::new());

/// What the schema says of `path`: a type, then the names of fields and choices, such as
/// `SunPosition.angles.azimuth_deg`. A path that the schema does not have is a mistake of
/// the program, which the tests of the panels find.
pub fn word(path: &'static str) -> &'static Word {
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.entry(path).or_insert_with(|| {
        let found = find(path);
        debug_assert!(found.is_some(), "the schema has no `{path}`");
        // Once a path: there are as many as the panels have fields.
        Box::leak(Box::new(found.map_or_else(Word::none, Word::read)))
    })
}

impl Word {
    fn none() -> Self {
        Self { help: String::new(), min: f64::NEG_INFINITY, max: f64::INFINITY, unit: "" }
    }

    fn read(value: &Value) -> Self {
        let text = |name: &str| value.get(name).and_then(Value::as_str).unwrap_or_default();
        let number = value.get("items").unwrap_or(value);
        let limit = |name: &str| number.get(name).and_then(Value::as_f64);
        Self {
            help: text("description").split_whitespace().collect::<Vec<_>>().join(" "),
            min: limit("minimum").unwrap_or(f64::NEG_INFINITY),
            max: limit("maximum").unwrap_or(f64::INFINITY),
            unit: symbol(text("unit")),
        }
    }
}

fn find(path: &str) -> Option<&'static Value> {
    let mut steps = path.split('.');
    let mut value = match steps.next()? {
        "Scene" => &*SCHEMA,
        kind => SCHEMA.get("$defs")?.get(kind)?,
    };
    for name in steps {
        value = follow(value, name)?;
    }
    Some(value)
}

/// The field or the choice `name` of `value`.
fn follow(value: &'static Value, name: &str) -> Option<&'static Value> {
    let value = resolved(value);
    if let Some(field) = value.get("properties").and_then(|fields| fields.get(name)) {
        return Some(field);
    }
    let choices = value.get("oneOf").or_else(|| value.get("anyOf"))?.as_array()?;
    choices.iter().find_map(|choice| match choice.get("const") {
        Some(constant) if constant == name => Some(choice),
        _ => follow(choice, name),
    })
}

fn resolved(value: &'static Value) -> &'static Value {
    let kind = value.get("$ref").and_then(Value::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
    kind.and_then(|kind| SCHEMA.get("$defs")?.get(kind)).unwrap_or(value)
}

/// What the choice `path` of several is, in a sentence: a choice with values inside has its
/// description beside it.
pub fn choice(path: &'static str) -> &'static str {
    let (kind, name) = path.split_once('.').unwrap_or((path, ""));
    let choices = SCHEMA.get("$defs").and_then(|defs| defs.get(kind)?.get("oneOf")?.as_array());
    let choices = choices.map(Vec::as_slice).unwrap_or_default();
    let is_it = |choice: &&Value| {
        choice.get("const").is_some_and(|constant| constant == name)
            || choice.get("properties").is_some_and(|fields| fields.get(name).is_some())
    };
    let found = choices.iter().find(is_it).and_then(|choice| choice.get("description")?.as_str());
    debug_assert!(found.is_some(), "the schema has no choice `{path}`");
    found.unwrap_or_default()
}

fn symbol(unit: &str) -> &'static str {
    match unit {
        "metres" => " m",
        "millimetres" => " mm",
        "micrometres" => " µm",
        "degrees" => "°",
        "seconds" => " s",
        "hours" => " h",
        "frames per second" => " fps",
        "stops" => " stops",
        "metres per second" => " m/s",
        "per cubic centimetre" => " /cm³",
        "grams per cubic metre" => " g/m³",
        "per metre" => " /m",
        "per minute" => " /min",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_has_words_for_fields_and_choices() {
        let boundary = word("Edge.boundary");
        assert_eq!((boundary.min, boundary.max, boundary.unit), (0.0, 1e4, " m"));
        assert!(boundary.help.starts_with("Thickness of the boundary that noise shapes, metres"));
        let azimuth = word("SunPosition.angles.azimuth_deg");
        assert_eq!((azimuth.min, azimuth.max, azimuth.unit), (-360.0, 360.0, "°"));
        assert_eq!(word("Ellipsoid.center").max, 1e7);
        assert_eq!(word("Sky.atmosphere.haze").max, 20.0);
        assert!(choice("Phase.mie").contains("Lorenz"));
        assert!(choice("Sky.uniform").contains("every direction"));
    }

    #[test]
    fn every_unit_of_the_schema_has_a_symbol() {
        fn walk(value: &Value, units: &mut Vec<String>) {
            units.extend(value.get("unit").and_then(Value::as_str).map(str::to_owned));
            value.as_object().into_iter().flatten().for_each(|(_, part)| walk(part, units));
            value.as_array().into_iter().flatten().for_each(|part| walk(part, units));
        }
        let mut units = Vec::new();
        walk(&SCHEMA, &mut units);
        assert!(units.len() > 15, "{units:?}");
        let bare: Vec<_> = units.iter().filter(|unit| symbol(unit).is_empty()).collect();
        assert!(bare.is_empty(), "{bare:?}");
    }
}
