//! What a person chose for the viewport; kept between sessions.

use serde::{Deserialize, Serialize};

use super::{navigation::Navigation, stage::Stage};

/// What light the viewport shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// The picture.
    #[default]
    Beauty,
    /// Sunlight scattered once.
    Single,
    /// Sunlight scattered more often.
    Multiple,
    /// Light of sky and ground.
    Ambient,
    /// Light scattered by the air before the clouds.
    Air,
    /// How much of what is behind gets through.
    Transmittance,
    /// Which way the clouds face.
    Normal,
    /// Steps of each ray.
    Cost,
}

impl Layer {
    /// Every layer with its name and what it shows.
    pub const ALL: [(Self, &'static str, &'static str); 8] = [
        (Self::Beauty, "Beauty", "The picture with all its light."),
        (Self::Single, "Single scattering", "Sunlight that droplets turned once."),
        (Self::Multiple, "Multiple scattering", "Sunlight that droplets turned more often."),
        (Self::Ambient, "Light of the sky", "Light of sky and ground that droplets turned."),
        (Self::Air, "Air", "Light that the air before the clouds adds."),
        (
            Self::Transmittance,
            "Transmittance",
            "How much of the background gets through: white is all of it, black none.",
        ),
        (Self::Normal, "Normal", "Which way the cloud faces: red is east, green up, blue south."),
        (Self::Cost, "Cost", "Steps of each ray, from few (dark) to 1000 (bright)."),
    ];
}

/// Which gizmo is at the selected ellipsoids.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tool {
    /// None: clicks and boxes select.
    Select,
    /// Arrows and planes.
    #[default]
    Move,
    /// Rings.
    Rotate,
    /// Arms with boxes.
    Scale,
}

/// Along which axes things are moved, turned and scaled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// East, up, south.
    #[default]
    World,
    /// Those of the active ellipsoid.
    Local,
}

impl Axes {
    /// The other ones.
    pub fn other(self) -> Self {
        match self {
            Self::World => Self::Local,
            Self::Local => Self::World,
        }
    }
}

/// About what several ellipsoids turn and scale.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pivot {
    /// The mean of their centres.
    #[default]
    Middle,
    /// The active one's centre.
    Active,
    /// Each about its own centre.
    Each,
}

impl Pivot {
    /// The next of the three.
    pub fn next(self) -> Self {
        match self {
            Self::Middle => Self::Active,
            Self::Active => Self::Each,
            Self::Each => Self::Middle,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Middle => "Middle",
            Self::Active => "Active",
            Self::Each => "Each",
        }
    }
}

/// What a person chose for the viewport.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewSettings {
    /// Whether ellipsoids near the mouse have outlines too, not the selected ones alone.
    pub outlines: bool,
    /// Whether the ground's grid and the horizon are drawn.
    pub grid: bool,
    /// Whether the hints at the bottom are shown.
    pub hints: bool,
    /// What light is shown.
    pub layer: Layer,
    /// The gizmo.
    pub tool: Tool,
    /// Its axes.
    pub axes: Axes,
    /// Its centre.
    pub pivot: Pivot,
    /// Whether drags snap without Ctrl (and do not with it).
    pub snap: bool,
    /// Whether orbits turn about what is selected.
    pub orbit_selected: bool,
    /// Frames a second that moving pictures aim at, 5 to 120.
    pub frames_per_second: f64,
    /// Most pixels across the viewport's picture; 0 is as many as the screen has.
    pub largest: u32,
    /// What the picture comes to rest in.
    pub finest: Stage,
    /// Whether work is counted and passes are timed.
    pub measure: bool,
    /// Most pixels of the truth; 0 is what suits the adapter.
    pub truth_pixels: u32,
    /// Where the truth begins beside the preview, 0 to 1 from the left.
    pub split: f32,
    /// Whether the error is shown instead of the truth.
    pub error_map: bool,
    /// Views that were saved, by their number.
    pub views: [Option<Navigation>; 9],
}

impl Default for ViewSettings {
    fn default() -> Self {
        Self {
            outlines: true,
            grid: true,
            hints: true,
            layer: Layer::default(),
            tool: Tool::default(),
            axes: Axes::default(),
            pivot: Pivot::default(),
            snap: false,
            orbit_selected: true,
            frames_per_second: 30.0,
            largest: 0,
            finest: Stage::default(),
            measure: false,
            truth_pixels: 0,
            split: 0.5,
            error_map: false,
            views: Default::default(),
        }
    }
}
