//! Paths to the numbers of a scene, as its file writes them: `sun.position.angles.azimuth_deg`,
//! `clouds[0].ellipsoids[2].center[1]`, or by name, which no new order can mislead:
//! `clouds['anvil'].ellipsoids['top'].density`.
//!
//! No list of what can be animated: the last steps are taken in the JSON of the smallest object
//! around the number, and that object's reader says whether it likes what it finds.

use std::fmt;

use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::scene::{Cloud, Scene, explain::nearest, validate::unit};

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Field(String),
    Index(usize),
    /// An element by its own name.
    Name(String),
}

/// What a number belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// The scene itself.
    Scene,
    /// A cloud.
    Cloud(usize),
    /// An ellipsoid: its cloud's number and its own.
    Ellipsoid(usize, usize),
}

/// A number in a scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The object that it belongs to.
    pub owner: Owner,
    /// The way from there.
    steps: Vec<Step>,
}

impl Place {
    /// Follows `path` through `scene`; what is wrong with it, in a sentence, where it leads nowhere.
    pub fn find(path: &str, scene: &Scene) -> Result<Self, String> {
        let steps = parse(path)?;
        let [Step::Field(first), cloud, rest @ ..] = steps.as_slice() else {
            return Ok(Self { owner: Owner::Scene, steps });
        };
        if first != "clouds" {
            return Ok(Self { owner: Owner::Scene, steps });
        }
        let clouds: Vec<&str> = scene.clouds.iter().map(|cloud| cloud.name.as_str()).collect();
        let index = element(cloud, &clouds, "cloud")?;
        let [Step::Field(second), ellipsoid, rest_of_it @ ..] = rest else {
            return Ok(Self { owner: Owner::Cloud(index), steps: rest.to_vec() });
        };
        if second != "ellipsoids" {
            return Ok(Self { owner: Owner::Cloud(index), steps: rest.to_vec() });
        }
        let names: Vec<&str> =
            scene.clouds[index].ellipsoids.iter().map(|e| e.name.as_deref().unwrap_or_default()).collect();
        let number = element(ellipsoid, &names, "ellipsoid")?;
        Ok(Self { owner: Owner::Ellipsoid(index, number), steps: rest_of_it.to_vec() })
    }

    /// The number as it is; 0 where the file leaves it out.
    pub fn read(&self, scene: &Scene) -> Result<f64, String> {
        let value = match self.owner {
            Owner::Scene => json(&world(scene)),
            Owner::Cloud(cloud) => json(&shell(&scene.clouds[cloud])),
            Owner::Ellipsoid(cloud, e) => json(&scene.clouds[cloud].ellipsoids[e]),
        };
        let mut value = &value;
        for (i, step) in self.steps.iter().enumerate() {
            value = match follow(value, step) {
                Some(inside) => inside,
                None if i + 1 == self.steps.len() && value.is_object() => return Ok(0.0),
                None => return Err(missing(value, step)),
            };
        }
        value.as_f64().ok_or_else(|| no_number(value))
    }

    /// The same number of another object of its kind.
    pub fn in_object(&self, owner: Owner) -> Self {
        Self { owner, steps: self.steps.clone() }
    }

    /// Puts `value` there; what is wrong with it, in a sentence, where it can't be. Its range is not looked at.
    pub fn write(&self, scene: &mut Scene, value: f64) -> Result<(), String> {
        write(scene, &[(self.clone(), value)])
    }

    /// The path that says this to people and files: by name where there is one that no other has.
    pub fn path(&self, scene: &Scene) -> String {
        let mut path = owner_path(self.owner, scene);
        for step in &self.steps {
            match step {
                Step::Field(name) if path.is_empty() => path.push_str(name),
                step => path += &step.to_string(),
            }
        }
        path
    }
}

/// The path of an object: by name where there is one that no other has. The scene's is empty.
pub fn owner_path(owner: Owner, scene: &Scene) -> String {
    let of = |index: usize, names: Vec<&str>| {
        let own = names[index];
        let alone = !own.is_empty() && names.iter().filter(|name| **name == own).count() == 1;
        if alone { Step::Name(own.to_owned()).to_string() } else { Step::Index(index).to_string() }
    };
    let cloud = |index: usize| {
        format!("clouds{}", of(index, scene.clouds.iter().map(|cloud| cloud.name.as_str()).collect()))
    };
    match owner {
        Owner::Scene => String::new(),
        Owner::Cloud(index) => cloud(index),
        Owner::Ellipsoid(index, number) => {
            let names = scene.clouds[index].ellipsoids.iter().map(|e| e.name.as_deref().unwrap_or_default());
            format!("{}.ellipsoids{}", cloud(index), of(number, names.collect()))
        }
    }
}

/// Puts numbers into the scene, all those of one object together; quaternions become unit length again.
pub fn write(scene: &mut Scene, numbers: &[(Place, f64)]) -> Result<(), String> {
    let mut owners: Vec<Owner> = numbers.iter().map(|(place, _)| place.owner).collect();
    owners.sort_unstable();
    owners.dedup();
    for owner in owners {
        let own = numbers.iter().filter(|(place, _)| place.owner == owner);
        match owner {
            Owner::Scene => {
                let (clouds, timeline) = (std::mem::take(&mut scene.clouds), scene.timeline.take());
                let written = put(scene, own);
                (scene.clouds, scene.timeline) = (clouds, timeline);
                written?;
                scene.noise.rotation = unit(scene.noise.rotation);
            }
            Owner::Cloud(index) => {
                let cloud = &mut scene.clouds[index];
                let ellipsoids = std::mem::take(&mut cloud.ellipsoids);
                let written = put(cloud, own);
                cloud.ellipsoids = ellipsoids;
                written?;
            }
            Owner::Ellipsoid(cloud, e) => {
                let ellipsoid = &mut scene.clouds[cloud].ellipsoids[e];
                put(ellipsoid, own)?;
                ellipsoid.orientation = unit(ellipsoid.orientation);
            }
        }
    }
    Ok(())
}

fn put<'a, T: Serialize + DeserializeOwned>(
    object: &mut T,
    numbers: impl Iterator<Item = &'a (Place, f64)>,
) -> Result<(), String> {
    let mut value = json(object);
    for (place, number) in numbers {
        set(&mut value, &place.steps, *number)?;
    }
    *object = serde_json::from_value(value).map_err(|error| error.to_string())?;
    Ok(())
}

fn set(value: &mut Value, steps: &[Step], number: f64) -> Result<(), String> {
    let [step, rest @ ..] = steps else {
        *value = match value {
            // Seeds are whole numbers.
            Value::Number(old) if old.is_u64() => Value::from(number.round().max(0.0) as u64),
            Value::Number(_) => Value::from(number),
            other => return Err(no_number(other)),
        };
        return Ok(());
    };
    if rest.is_empty()
        && let (Value::Object(fields), Step::Field(name)) = (&mut *value, step)
    {
        // What files leave out may be put in: the reader knows its fields.
        fields.entry(name).or_insert(Value::from(0.0));
    }
    if follow(value, step).is_none() {
        return Err(missing(value, step));
    }
    let inside = match step {
        Step::Field(name) | Step::Name(name) => value.get_mut(name),
        Step::Index(index) => value.get_mut(index),
    };
    inside.map_or(Ok(()), |inside| set(inside, rest, number))
}

fn follow<'a>(value: &'a Value, step: &Step) -> Option<&'a Value> {
    match step {
        Step::Field(name) => value.get(name),
        Step::Index(index) => value.get(index),
        Step::Name(_) => None,
    }
}

fn no_number(value: &Value) -> String {
    match value {
        Value::Array(_) => "a list is no number: add [0] for its first, [1] for its second".to_owned(),
        other => format!("{} is not a number", kind(other)),
    }
}

fn missing(value: &Value, step: &Step) -> String {
    let known: Vec<&str> = value.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
    match (step, value) {
        (Step::Field(name), Value::Object(_)) => {
            let hint = nearest(name, &known).map(|near| format!("; did you mean `{near}`?"));
            format!("there is no `{name}` here{} Known: {}", hint.as_deref().unwrap_or("."), known.join(", "))
        }
        (Step::Index(index), Value::Array(list)) => {
            format!("there is no [{index}]: the list ends at [{}]", list.len().saturating_sub(1))
        }
        (Step::Field(name), Value::Array(_)) if ["x", "y", "z"].contains(&name.as_str()) => {
            "x, y and z are [0], [1] and [2]".to_owned()
        }
        (step, value) => format!("`{step}` can't follow: {} is there", kind(value)),
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "nothing",
        Value::Bool(_) => "yes or no",
        Value::Number(_) => "a number",
        Value::String(_) => "text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// The number of the element that `step` says, of those with these names.
fn element(step: &Step, names: &[&str], what: &str) -> Result<usize, String> {
    match step {
        Step::Index(index) if *index < names.len() => Ok(*index),
        Step::Index(index) => Err(format!("there is no {what} [{index}]: there are {}", names.len())),
        Step::Field(name) => Err(format!("`.{name}` can't follow a list: write [0] or ['name']")),
        Step::Name(name) => {
            let mut found = names.iter().enumerate().filter(|(_, own)| *own == name);
            match (found.next(), found.next()) {
                (Some((index, _)), None) => Ok(index),
                (Some(_), Some(_)) => {
                    Err(format!("more than one {what} is called '{name}': give them names of their own"))
                }
                (None, _) => {
                    let hint = nearest(name, names).map(|near| format!("; did you mean '{near}'?"));
                    Err(format!("no {what} is called '{name}'{}", hint.unwrap_or_default()))
                }
            }
        }
    }
}

/// The scene without its lists.
fn world(scene: &Scene) -> Scene {
    Scene {
        clouds: Vec::new(),
        timeline: None,
        format: scene.format,
        name: String::new(),
        noise: scene.noise.clone(),
        sun: scene.sun.clone(),
        sky: scene.sky.clone(),
        ground: scene.ground.clone(),
        wind: scene.wind.clone(),
        time: scene.time,
        camera: scene.camera.clone(),
        exposure: scene.exposure,
        tone_curve: scene.tone_curve,
    }
}

/// The cloud without its ellipsoids.
fn shell(cloud: &Cloud) -> Cloud {
    Cloud {
        name: String::new(),
        ellipsoids: Vec::new(),
        droplets: cloud.droplets.clone(),
        edge: cloud.edge.clone(),
        life: cloud.life.clone(),
        hidden: cloud.hidden,
        locked: cloud.locked,
    }
}

fn json(object: &impl Serialize) -> Value {
    serde_json::to_value(object).expect("a scene holds only numbers, text and lists, with text as keys")
}

fn parse(path: &str) -> Result<Vec<Step>, String> {
    let mut steps = Vec::new();
    let mut rest = path;
    while !rest.is_empty() {
        let (step, after) = match rest.strip_prefix('[') {
            Some(inside) => bracket(inside),
            None => field(rest, steps.is_empty()),
        }
        .ok_or_else(|| {
            format!(
                "it can't be read from `{rest}` on: write it like clouds['anvil'].droplets.albedo or \
                 camera.position[1]"
            )
        })?;
        steps.push(step);
        rest = after;
    }
    if steps.is_empty() { Err("it is empty".to_owned()) } else { Ok(steps) }
}

/// A field's name; a dot stands before all but the first.
fn field(text: &str, first: bool) -> Option<(Step, &str)> {
    let text = if first { text } else { text.strip_prefix('.')? };
    let end = text.find(['.', '[']).unwrap_or(text.len());
    (end > 0).then(|| (Step::Field(text[..end].to_owned()), &text[end..]))
}

/// What is in brackets: a number, or a name in single quotes, with `\` before quotes and `\` (RFC 9535).
fn bracket(text: &str) -> Option<(Step, &str)> {
    let Some(quoted) = text.strip_prefix('\'') else {
        let (index, rest) = text.split_once(']')?;
        return Some((Step::Index(index.parse().ok()?), rest));
    };
    let mut name = String::new();
    let mut characters = quoted.char_indices();
    while let Some((at, character)) = characters.next() {
        match character {
            '\\' => name.push(characters.next()?.1),
            '\'' => return Some((Step::Name(name), quoted[at + 1..].strip_prefix(']')?)),
            other => name.push(other),
        }
    }
    None
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Field(name) => write!(f, ".{name}"),
            Self::Index(index) => write!(f, "[{index}]"),
            Self::Name(name) => write!(f, "['{}']", name.replace('\\', "\\\\").replace('\'', "\\'")),
        }
    }
}
