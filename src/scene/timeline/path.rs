//! Paths to the numbers of a scene, as its file writes them: `sun.position.angles.azimuth_deg`,
//! `clouds[0].ellipsoids[2].center[1]`, or by name, which no new order can mislead:
//! `clouds['anvil'].ellipsoids['top'].density`.
//!
//! No list of what can be animated: the last steps are taken in the JSON of the smallest object
//! around the number, and that object's reader says whether it likes what it finds.

use std::{collections::HashMap, fmt};

use super::object::{self, Object, Owner};
use crate::scene::{Scene, explain::nearest};

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    Field(String),
    Index(usize),
    /// An element by its own name.
    Name(String),
}

/// A number in a scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The object that it belongs to.
    pub owner: Owner,
    /// The way from there.
    pub(super) steps: Vec<Step>,
}

impl Place {
    /// Follows `path` through `scene`; what is wrong with it, in a sentence, where it leads nowhere.
    pub fn find(path: &str, scene: &Scene) -> Result<Self, String> {
        Paths::new(scene).find(path)
    }

    /// The cloud that grows, where the number is of one of its ellipsoids.
    pub(super) fn grown_with(&self, scene: &Scene) -> Option<usize> {
        match self.owner {
            Owner::Ellipsoid(cloud, _) if scene.clouds[cloud].growth.is_some() => Some(cloud),
            _ => None,
        }
    }

    /// The number as it is; 0 where the file leaves it out.
    pub fn read(&self, scene: &Scene) -> Result<f64, String> {
        Object::of(self.owner, scene).number(&self.steps)
    }

    /// The same number of another object of its kind.
    pub fn in_object(&self, owner: Owner) -> Self {
        Self { owner, steps: self.steps.clone() }
    }

    /// Puts `value` there; what is wrong with it, in a sentence, where it can't be. Its range is not looked at.
    pub fn write(&self, scene: &mut Scene, value: f64) -> Result<(), String> {
        object::write(scene, vec![(self.clone(), value)])
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

/// Finds places in a scene by their paths: names are looked up in lists that are made once.
pub(super) struct Paths<'a> {
    scene: &'a Scene,
    clouds: Option<Names<'a>>,
    /// By cloud.
    ellipsoids: HashMap<usize, Names<'a>>,
}

impl<'a> Paths<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, clouds: None, ellipsoids: HashMap::new() }
    }

    /// The scene in which it finds.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Follows `path`; what is wrong with it, in a sentence, where it leads nowhere.
    pub fn find(&mut self, path: &str) -> Result<Place, String> {
        let steps = parse(path)?;
        let [Step::Field(first), cloud, rest @ ..] = steps.as_slice() else {
            return Ok(Place { owner: Owner::Scene, steps });
        };
        if first != "clouds" {
            return Ok(Place { owner: Owner::Scene, steps });
        }
        let scene = self.scene;
        let clouds = || scene.clouds.iter().map(|cloud| cloud.name.as_str()).collect();
        let index = self.clouds.get_or_insert_with(|| Names::new("cloud", clouds())).find(cloud)?;
        let [Step::Field(second), ellipsoid, rest_of_it @ ..] = rest else {
            return Ok(Place { owner: Owner::Cloud(index), steps: rest.to_vec() });
        };
        if second != "ellipsoids" {
            return Ok(Place { owner: Owner::Cloud(index), steps: rest.to_vec() });
        }
        let named = || {
            let own = &scene.clouds[index].ellipsoids;
            Names::new("ellipsoid", own.iter().map(|e| e.name.as_deref().unwrap_or_default()).collect())
        };
        let number = self.ellipsoids.entry(index).or_insert_with(named).find(ellipsoid)?;
        Ok(Place { owner: Owner::Ellipsoid(index, number), steps: rest_of_it.to_vec() })
    }
}

/// The elements of a list by their names.
struct Names<'a> {
    /// What an element is called.
    what: &'static str,
    names: Vec<&'a str>,
    /// The element of each name; none where several have it. Made when the first name is asked for.
    by_name: Option<HashMap<&'a str, Option<usize>>>,
}

impl<'a> Names<'a> {
    fn new(what: &'static str, names: Vec<&'a str>) -> Self {
        Self { what, names, by_name: None }
    }

    /// The number of the element that `step` says.
    fn find(&mut self, step: &Step) -> Result<usize, String> {
        let (what, count) = (self.what, self.names.len());
        match step {
            Step::Index(index) if *index < count => Ok(*index),
            Step::Index(index) => Err(format!("there is no {what} [{index}]: there are {count}")),
            Step::Field(name) => Err(format!("`.{name}` can't follow a list: write [0] or ['name']")),
            Step::Name(name) => match self.by_name().get(name.as_str()) {
                Some(Some(index)) => Ok(*index),
                Some(None) => {
                    Err(format!("more than one {what} is called '{name}': give them names of their own"))
                }
                None => {
                    let hint = nearest(name, &self.names).map(|near| format!("; did you mean '{near}'?"));
                    Err(format!("no {what} is called '{name}'{}", hint.unwrap_or_default()))
                }
            },
        }
    }

    fn by_name(&mut self) -> &HashMap<&'a str, Option<usize>> {
        let names = &self.names;
        self.by_name.get_or_insert_with(|| {
            let mut by_name = HashMap::with_capacity(names.len());
            for (index, name) in names.iter().enumerate() {
                by_name.entry(*name).and_modify(|alone| *alone = None).or_insert(Some(index));
            }
            by_name
        })
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
