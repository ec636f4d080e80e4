//! What the rows of tracks are called: the object by its name, and the field in words.

use crate::{
    editor::{
        EllipsoidId,
        panels::outliner_row::{Row, name},
    },
    scene::{
        Scene,
        timeline::{Owner, Place, owner_path},
    },
};

/// The title of the track of `path`: "turret 3: center Y". A path that leads nowhere is its own.
pub fn title(path: &str, scene: &Scene) -> String {
    let Ok(place) = Place::find(path, scene) else { return path.to_owned() };
    let whole = place.path(scene);
    let field = whole.strip_prefix(&owner_path(place.owner, scene)).unwrap_or(&whole);
    match place.owner {
        Owner::Scene => words(field),
        Owner::Cloud(cloud) => format!("{}: {}", name(scene, Row::Cloud(cloud)), words(field)),
        Owner::Ellipsoid(cloud, ellipsoid) => {
            format!("{}: {}", name(scene, Row::Ellipsoid(EllipsoidId { cloud, ellipsoid })), words(field))
        }
    }
}

/// ".sun.position.azimuth_deg" as "sun position azimuth deg", ".center[1]" as "center Y".
fn words(field: &str) -> String {
    let axes = [("[0]", " X"), ("[1]", " Y"), ("[2]", " Z"), ("[3]", " W")];
    let named = axes.iter().fold(field.to_owned(), |field, (index, axis)| field.replace(index, axis));
    named.replace(['.', '_'], " ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn rows_say_what_is_moved_and_which_number_of_it() {
        let scene = Preset::Congestus.scene(1);
        let lump = scene.clouds[0].ellipsoids[0].name.clone().unwrap();
        assert_eq!(title("clouds[0].ellipsoids[0].center[1]", &scene), format!("{lump}: center Y"));
        assert_eq!(title("clouds[0].edge.boundary", &scene), "congestus: edge boundary");
        assert_eq!(title("sun.position.angles.azimuth_deg", &scene), "sun position angles azimuth deg");
        assert_eq!(title("clouds[9].dilution", &scene), "clouds[9].dilution");
    }
}
