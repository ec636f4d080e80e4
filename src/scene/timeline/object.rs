//! The objects that numbers belong to, each by itself, and the numbers in them.

use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;

use super::path::{Place, Step};
use crate::scene::{
    Cloud, Ellipsoid, Scene,
    explain::nearest,
    validate::{At, unit},
};

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

/// An object of a scene by itself: a copy without the lists in it, and where it belongs.
pub enum Object {
    /// The scene without its clouds.
    World(Box<Scene>),
    /// A cloud without its ellipsoids.
    Cloud(usize, Box<Cloud>),
    /// An ellipsoid.
    Ellipsoid(usize, usize, Box<Ellipsoid>),
}

impl Object {
    /// The object `owner` of `scene`.
    pub fn of(owner: Owner, scene: &Scene) -> Self {
        #[cfg(test)]
        tests::COPIES.set(tests::COPIES.get() + 1);
        match owner {
            Owner::Scene => Self::World(Box::new(world(scene))),
            Owner::Cloud(i) => Self::Cloud(i, Box::new(shell(&scene.clouds[i]))),
            Owner::Ellipsoid(i, j) => Self::Ellipsoid(i, j, Box::new(scene.clouds[i].ellipsoids[j].clone())),
        }
    }

    /// The number that `steps` lead to from here; 0 where the file leaves it out.
    pub fn number(&self, steps: &[Step]) -> Result<f64, String> {
        let value = self.json();
        let mut value = &value;
        for (i, step) in steps.iter().enumerate() {
            value = match follow(value, step) {
                Some(inside) => inside,
                None if i + 1 == steps.len() && value.is_object() => return Ok(0.0),
                None => return Err(missing(value, step)),
            };
        }
        value.as_f64().ok_or_else(|| no_number(value))
    }

    /// The same object with numbers put into it; its quaternions become unit length again. Ranges
    /// are not looked at.
    pub fn with<'a>(&self, numbers: impl IntoIterator<Item = (&'a [Step], f64)>) -> Result<Self, String> {
        let mut value = self.json();
        for (steps, number) in numbers {
            set(&mut value, steps, number)?;
        }
        Ok(match self {
            Self::World(_) => {
                let mut world: Box<Scene> = read(value)?;
                world.noise.rotation = unit(world.noise.rotation);
                Self::World(world)
            }
            Self::Cloud(i, _) => {
                let mut cloud: Box<Cloud> = read(value)?;
                if let Some(noise) = &mut cloud.noise {
                    noise.rotation = unit(noise.rotation);
                }
                if let Some(volume) = &mut cloud.volume {
                    volume.orientation = unit(volume.orientation);
                }
                if let Some(mesh) = &mut cloud.mesh {
                    mesh.orientation = unit(mesh.orientation);
                }
                Self::Cloud(*i, cloud)
            }
            Self::Ellipsoid(i, j, _) => {
                let mut ellipsoid: Box<Ellipsoid> = read(value)?;
                ellipsoid.orientation = unit(ellipsoid.orientation);
                Self::Ellipsoid(*i, *j, ellipsoid)
            }
        })
    }

    /// Puts it where it belongs, around the lists that are there.
    pub fn put_into(self, scene: &mut Scene) {
        match self {
            Self::World(world) => {
                let (clouds, timeline) = (std::mem::take(&mut scene.clouds), scene.timeline.take());
                let old = std::mem::take(&mut scene.ground.kind);
                *scene = Scene { clouds, timeline, ..*world };
                if let (Some(new), Some(old)) = (scene.ground.kind.picture_mut(), old.picture()) {
                    new.take_colors_of(old);
                }
            }
            Self::Cloud(i, shell) => {
                let old = &mut scene.clouds[i];
                let grows_otherwise = old.growth != shell.growth;
                let (ellipsoids, volume) = (std::mem::take(&mut old.ellipsoids), old.volume.take());
                let mesh = old.mesh.take();
                let map = old.layer.take().and_then(|layer| layer.map);
                *old = Cloud { ellipsoids, ..*shell };
                if let (Some(new), Some(old)) = (&mut old.volume, &volume) {
                    new.take_grid_of(old);
                }
                if let (Some(new), Some(old)) = (&mut old.mesh, &mesh) {
                    new.take_surface_of(old);
                }
                let new = old.layer.as_mut().and_then(|layer| layer.map.as_mut());
                if let (Some(new), Some(old)) = (new, &map) {
                    new.take_cover_of(old);
                }
                if grows_otherwise {
                    old.grow();
                }
            }
            Self::Ellipsoid(i, j, ellipsoid) => scene.clouds[i].ellipsoids[j] = *ellipsoid,
        }
    }

    /// Checks its own values.
    pub fn check(&self) -> crate::Result<()> {
        let root = At::Root;
        let clouds = root.field("clouds");
        match self {
            Self::World(world) => world.check_world(),
            Self::Cloud(i, cloud) => cloud.check_own(clouds.index(*i)),
            Self::Ellipsoid(i, j, ellipsoid) => {
                ellipsoid.check(clouds.index(*i).field("ellipsoids").index(*j))
            }
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::World(world) => json(world),
            Self::Cloud(_, cloud) => json(cloud),
            Self::Ellipsoid(_, _, ellipsoid) => json(ellipsoid),
        }
    }
}

/// Puts numbers into the scene, all those of one object together.
pub fn write(scene: &mut Scene, mut numbers: Vec<(Place, f64)>) -> Result<(), String> {
    // Stable: of two numbers in one place the later one counts.
    numbers.sort_by_key(|(place, _)| place.owner);
    for own in numbers.chunk_by(|(a, _), (b, _)| a.owner == b.owner) {
        let object = Object::of(own[0].0.owner, scene);
        object.with(own.iter().map(|(place, number)| (place.steps.as_slice(), *number)))?.put_into(scene);
    }
    Ok(())
}

fn read<T: DeserializeOwned>(value: Value) -> Result<T, String> {
    serde_json::from_value(value).map_err(|error| error.to_string())
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

/// The scene without its lists.
fn world(scene: &Scene) -> Scene {
    Scene {
        clouds: Vec::new(),
        timeline: None,
        schema: scene.schema.clone(),
        format: scene.format,
        name: scene.name.clone(),
        noise: scene.noise.clone(),
        sun: scene.sun.clone(),
        lights: scene.lights.clone(),
        sky: scene.sky.clone(),
        ground: scene.ground.clone(),
        wind: scene.wind.clone(),
        time: scene.time,
        camera: scene.camera.clone(),
        exposure: scene.exposure,
        auto_exposure: scene.auto_exposure,
        tone_curve: scene.tone_curve,
    }
}

/// The cloud without its ellipsoids.
fn shell(cloud: &Cloud) -> Cloud {
    Cloud {
        name: cloud.name.clone(),
        growth: cloud.growth.clone(),
        ellipsoids: Vec::new(),
        layer: cloud.layer.clone(),
        mesh: cloud.mesh.clone(),
        volume: cloud.volume.clone(),
        droplets: cloud.droplets.clone(),
        edge: cloud.edge.clone(),
        blend: cloud.blend,
        level: cloud.level,
        stratification: cloud.stratification,
        dilution: cloud.dilution,
        evaporation: cloud.evaporation.clone(),
        noise: cloud.noise.clone(),
        life: cloud.life.clone(),
        hidden: cloud.hidden,
        locked: cloud.locked,
    }
}

fn json(object: &impl Serialize) -> Value {
    serde_json::to_value(object).expect("a scene holds only numbers, text and lists, with text as keys")
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::DVec3;

    use crate::scene::timeline::{Key, Track};
    use crate::scene::{Camera, Cloud, Ellipsoid, Scene, Timeline};

    thread_local! {
        /// Objects of scenes copied by this thread so far.
        pub static COPIES: Cell<usize> = const { Cell::new(0) };
    }

    /// `count` ellipsoids, each with keys for all coordinates of its centre.
    fn moving(count: usize) -> Scene {
        let ellipsoids = vec![Ellipsoid::new(DVec3::Y, DVec3::ONE); count];
        let keys = vec![Key::new(0.0, 0.0), Key::new(5.0, 10.0)];
        let paths = (0..count).flat_map(|i| (0..3).map(move |axis| (i, axis)));
        let path = |(i, axis)| format!("clouds[0].ellipsoids[{i}].center[{axis}]");
        let tracks = paths.map(|place| Track { path: path(place), keys: keys.clone() }).collect();
        Scene {
            clouds: vec![Cloud { ellipsoids, ..Cloud::default() }],
            camera: Some(Camera::default()),
            timeline: Some(Timeline { tracks, ..Timeline::default() }),
            ..Scene::default()
        }
    }

    /// Objects copied by `work`.
    fn copies(work: impl FnOnce()) -> usize {
        let before = COPIES.get();
        work();
        COPIES.get() - before
    }

    #[test]
    fn a_moment_copies_each_moving_object_once_and_validation_one_a_track() {
        for count in [1, 40] {
            let scene = moving(count);
            assert_eq!(copies(|| assert!(scene.at(2.0).is_ok())), count);
            assert_eq!(copies(|| drop(scene.posed(2.0))), count);
            assert_eq!(copies(|| assert!(scene.validate().is_ok())), 3 * count);
        }
    }
}
