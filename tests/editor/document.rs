//! The document of the editor: undo, selection, what counts as saved, operations.

use glam::{DQuat, DVec3};
use nephos::{
    editor::{Document, EllipsoidId, Selection},
    scene::{Cloud, Edge, Ellipsoid, Growth, GrowthKind, Heaps, Preset, Scene},
};
use proptest::prelude::*;

fn id(cloud: usize, ellipsoid: usize) -> EllipsoidId {
    EllipsoidId { cloud, ellipsoid }
}

/// Two clouds of three and two ellipsoids, named a to e, with edges of their own.
fn two_clouds() -> Document {
    let ellipsoid = |name: &str, x: f64| Ellipsoid {
        name: Some(name.to_owned()),
        ..Ellipsoid::new(DVec3::new(x, 1000.0, 0.0), DVec3::new(100.0, 50.0, 80.0))
    };
    let cloud = |name: &str, wispiness: f64, ellipsoids: Vec<Ellipsoid>| Cloud {
        name: name.to_owned(),
        ellipsoids,
        edge: Edge { boundary: 20.0, wispiness },
        ..Cloud::default()
    };
    let left = vec![ellipsoid("a", -200.0), ellipsoid("b", -100.0), ellipsoid("c", 0.0)];
    let right = vec![ellipsoid("d", 100.0), ellipsoid("e", 200.0)];
    let clouds = vec![cloud("left", 0.0, left), cloud("right", 1.0, right)];
    Document::new(Scene { clouds, ..Scene::default() })
}

/// Names of the ellipsoids, cloud by cloud.
fn order(document: &Document) -> String {
    let name = |e: &Ellipsoid| e.name.clone().unwrap_or_else(|| "?".to_owned());
    let cloud = |cloud: &Cloud| cloud.ellipsoids.iter().map(name).collect::<String>();
    document.scene().clouds.iter().map(cloud).collect::<Vec<_>>().join("|")
}

/// Names of what is selected.
fn selected(document: &Document) -> String {
    let name = |id: &EllipsoidId| document.ellipsoid(*id).and_then(|e| e.name.clone()).unwrap_or_default();
    document.selection().ellipsoids.iter().map(name).collect()
}

// --- Undo ----------------------------------------------------------------------------

#[test]
fn a_drag_is_one_step_and_cancelling_it_none() {
    let mut document = two_clouds();
    let before = document.scene().clone();
    document.begin("Move");
    for x in 1..=5 {
        document.edit("Move", |scene| scene.clouds[0].ellipsoids[0].center.x = f64::from(x));
    }
    document.end();
    assert_eq!(document.undo_name(), Some("Move"));
    document.undo();
    assert_eq!((document.scene(), document.undo_name()), (&before, None));
    document.redo();
    assert_eq!(document.scene().clouds[0].ellipsoids[0].center.x, 5.0);

    document.begin("Move");
    document.edit("Move", |scene| scene.clouds[0].ellipsoids[0].center.x = 9.0);
    document.cancel();
    assert_eq!(document.scene().clouds[0].ellipsoids[0].center.x, 5.0);
    assert!(!document.is_grouping());
    document.undo();
    assert_eq!(document.scene(), &before);
}

#[test]
fn what_changes_nothing_is_no_step() {
    let mut document = two_clouds();
    document.edit("Nothing", |_| {});
    document.begin("Move there and back");
    document.edit("Move", |scene| scene.exposure = 1.0);
    document.edit("Move", |scene| scene.exposure = 0.0);
    document.end();
    assert_eq!(document.undo_name(), None);
    assert!(!document.is_dirty());
}

#[test]
fn one_field_is_one_step_until_the_hand_rests() {
    let mut document = two_clouds();
    for stops in [0.1, 0.2, 0.3] {
        document.adjust("Exposure", 1, |scene| scene.exposure = stops);
    }
    document.adjust("Time", 2, |scene| scene.time = 1.0);
    document.settle();
    document.adjust("Time", 2, |scene| scene.time = 2.0);
    let mut steps = Vec::new();
    while let Some(name) = document.undo_name() {
        document.undo();
        steps.push((name, document.scene().exposure, document.scene().time));
    }
    assert_eq!(steps, [("Time", 0.3, 1.0), ("Time", 0.3, 0.0), ("Exposure", 0.0, 0.0)]);
}

#[test]
fn history_is_bounded_and_a_new_edit_ends_what_could_be_done_again() {
    let mut document = two_clouds();
    for i in 1..=1000 {
        document.edit("Time", |scene| scene.time = f64::from(i));
    }
    let mut steps = 0;
    while document.undo_name().is_some() {
        document.undo();
        steps += 1;
    }
    // Bounded, but long enough for an afternoon's second thoughts.
    assert!((100..1000).contains(&steps), "{steps}");
    document.edit("Time", |scene| scene.time = -1.0);
    assert_eq!(document.redo_name(), None);
}

#[test]
fn an_edit_that_would_break_the_scene_is_refused_with_the_reason() {
    let mut document = two_clouds();
    let (before, revision) = (document.scene().clone(), document.revision());
    document.edit("Scale", |scene| scene.clouds[0].ellipsoids[1].radii.y = -3.0);
    document.edit("Scale", |scene| scene.exposure = f64::NAN);
    assert_eq!((document.scene(), document.revision()), (&before, revision));
    assert!(document.take_refusal().unwrap().contains("exposure"));
    assert_eq!((document.take_refusal(), document.undo_name()), (None, None));
}

#[test]
fn dirty_is_what_differs_from_the_file() {
    let mut document = two_clouds();
    assert!(!document.is_dirty());
    document.edit("Time", |scene| scene.time = 5.0);
    assert!(document.is_dirty());
    document.mark_saved(document.shared_scene());
    assert!(!document.is_dirty());
    document.undo();
    assert!(document.is_dirty());
    document.redo();
    assert!(!document.is_dirty());
    assert!(Document::unsaved(Preset::Kol.scene(1), Scene::default()).is_dirty());
}

// --- Operations ----------------------------------------------------------------------

#[test]
fn deleting_takes_what_is_selected_and_not_locked() {
    let mut document = two_clouds();
    document.edit("Lock", |scene| scene.clouds[0].ellipsoids[2].locked = true);
    document.select(Selection::of([id(0, 0), id(0, 2), id(1, 1)]));
    document.delete();
    assert_eq!((order(&document).as_str(), document.selection().is_empty()), ("bc|d", true));
    document.undo();
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("abc|de", "ace"));
    document.select(Selection::cloud(document.scene(), 1));
    document.delete();
    assert_eq!(order(&document), "abc");
}

#[test]
fn duplicates_are_selected_and_stand_beside_the_originals() {
    let mut document = two_clouds();
    document.select(Selection::of([id(0, 1), id(1, 0)]));
    document.duplicate(DVec3::Y * 10.0);
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("abcb|ded", "bd"));
    assert_eq!(document.selection().active, Some(id(1, 2)));
    assert_eq!(document.ellipsoid(id(0, 3)).unwrap().center.y, 1010.0);
    document.select(Selection::cloud(document.scene(), 1));
    document.duplicate(DVec3::ZERO);
    assert_eq!((order(&document).as_str(), document.selection().cloud), ("abcb|ded|ded", Some(2)));
}

#[test]
fn mirroring_twice_is_nothing_and_once_is_the_mirror_image() {
    let mut document = two_clouds();
    let turned = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    document.edit("Turn", |scene| scene.clouds[0].ellipsoids[0].orientation = turned);
    document.select(Selection::of([id(0, 0), id(1, 1)]));
    for axis in 0..3 {
        let before = document.scene().clone();
        let middle = document.middle_of(&document.selection().ellipsoids).unwrap();
        document.mirror(axis);
        // The mirror image of a body has the mirror image of its bounds.
        let image = |bounds: (DVec3, DVec3)| {
            let (mut low, mut high) = bounds;
            (low[axis], high[axis]) =
                (2.0 * middle[axis] - bounds.1[axis], 2.0 * middle[axis] - bounds.0[axis]);
            (low, high)
        };
        let expected = image(before.clouds[0].ellipsoids[0].bounds());
        let found = document.scene().clouds[0].ellipsoids[0].bounds();
        // Rounding of coordinates of some 1000 m.
        assert!((expected.0 - found.0).abs().max_element() < 1e-9, "{axis}: {expected:?} {found:?}");
        assert!((expected.1 - found.1).abs().max_element() < 1e-9, "{axis}: {expected:?} {found:?}");
        document.mirror(axis);
        let back = document.scene().clouds[0].ellipsoids[0].orientation;
        assert!(back.angle_between(before.clouds[0].ellipsoids[0].orientation) < 1e-6);
    }
}

#[test]
fn what_moves_between_clouds_keeps_its_edge() {
    let mut document = two_clouds();
    document.select(Selection::of([id(0, 0), id(1, 0)]));
    document.move_to_cloud(1);
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("bc|dea", "a"));
    assert_eq!(document.ellipsoid(id(1, 2)).unwrap().edge, Some(Edge { boundary: 20.0, wispiness: 0.0 }));

    document.select(Selection::of([id(0, 0), id(0, 1), id(1, 0)]));
    document.group();
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("ea|bcd", "bcd"));
    let cloud = &document.scene().clouds[1];
    let wispiness: Vec<_> = cloud.ellipsoids.iter().map(|e| cloud.edge_of(e).wispiness).collect();
    assert_eq!((wispiness, cloud.name.as_str()), (vec![0.0, 0.0, 1.0], "cloud 1"));
}

#[test]
fn selection_follows_what_is_reordered() {
    let mut document = two_clouds();
    document.add_cloud();
    document.select(Selection::of([id(0, 1), id(1, 0)]));
    document.move_cloud(0, 3);
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("de||abc", "db"));
    document.move_cloud(2, 0);
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("abc|de|", "bd"));
    document.move_ellipsoid(id(0, 0), id(0, 3));
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("bca|de|", "a"));
    document.move_ellipsoid(id(0, 2), id(1, 1));
    assert_eq!((order(&document).as_str(), selected(&document).as_str()), ("bc|dae|", "a"));
}

#[test]
fn what_is_added_goes_into_the_active_cloud() {
    let mut document = Document::default();
    document.add_ellipsoid(DVec3::Y);
    assert_eq!(document.scene().clouds[0].name, "cloud 1");
    document.add_cloud();
    document.add_ellipsoid(DVec3::Y);
    assert_eq!(document.selection().active, Some(id(1, 0)));
    document.select(Selection::one(id(0, 0)));
    document.add_ellipsoid(DVec3::Z);
    assert_eq!(document.selection().active, Some(id(0, 1)));
    document.add_preset(Preset::Kol, 1, DVec3::X * 500.0);
    assert_eq!(document.selection().ellipsoids.len(), 8);
}

#[test]
fn heaps_grow_on_what_is_selected_the_same_for_the_same_seed() {
    let grown = |seed: u64| {
        let mut document = two_clouds();
        document.select(Selection::of([id(0, 1), id(1, 0)]));
        document.grow(&Heaps { seed, children: (2, 2), generations: 2 });
        document
    };
    let document = grown(7);
    // Two children each, and two on each of those, in both clouds.
    assert_eq!(document.selection().ellipsoids.len(), 2 * (2 + 4));
    let (base, _) = document.ellipsoid(id(0, 1)).unwrap().bounds();
    for id in &document.selection().ellipsoids {
        let child = document.ellipsoid(*id).unwrap();
        assert!(child.bounds().0.y > base.y - 0.1, "{child:?}");
    }
    assert_eq!(document.scene(), grown(7).scene());
    assert_ne!(document.scene(), grown(8).scene());
}

#[test]
fn hidden_and_shown_again_is_as_before() {
    let mut document = two_clouds();
    let before = document.scene().clone();
    document.select(Selection::one(id(0, 0)));
    document.hide();
    document.select(Selection::cloud(document.scene(), 1));
    document.hide();
    let seen: usize = document.scene().clouds.iter().map(|cloud| cloud.visible().count()).sum();
    assert_eq!((seen, document.selection().is_empty()), (2, true));
    assert_eq!(Selection::all(document.scene()).ellipsoids.len(), 2);
    document.show_all();
    assert_eq!(document.scene(), &before);
}

// --- Any sequence --------------------------------------------------------------------

#[derive(Debug, Clone)]
enum Step {
    Select(Vec<(usize, usize)>),
    SelectCloud(usize),
    Add,
    AddCloud,
    Duplicate,
    Delete,
    Mirror(usize),
    Group,
    MoveToCloud(usize),
    MoveCloud(usize, usize),
    MoveEllipsoid((usize, usize), (usize, usize)),
    Grow(u64),
    Hide,
    ShowAll,
    Break,
    Drag(bool),
}

fn any_step() -> impl Strategy<Value = Step> {
    let place = || (0..4usize, 0..6usize);
    prop_oneof![
        prop::collection::vec(place(), 0..4).prop_map(Step::Select),
        (0..4usize).prop_map(Step::SelectCloud),
        Just(Step::Add),
        Just(Step::AddCloud),
        Just(Step::Duplicate),
        Just(Step::Delete),
        (0..3usize).prop_map(Step::Mirror),
        Just(Step::Group),
        (0..4usize).prop_map(Step::MoveToCloud),
        (0..4usize, 0..5usize).prop_map(|(from, to)| Step::MoveCloud(from, to)),
        (place(), place()).prop_map(|(from, to)| Step::MoveEllipsoid(from, to)),
        (0..9u64).prop_map(Step::Grow),
        Just(Step::Hide),
        Just(Step::ShowAll),
        Just(Step::Break),
        any::<bool>().prop_map(Step::Drag),
    ]
}

fn take(document: &mut Document, step: Step) {
    match step {
        Step::Select(ids) => document.select(Selection::of(ids.into_iter().map(|(c, e)| id(c, e)))),
        Step::SelectCloud(cloud) => document.select(Selection::cloud(document.scene(), cloud)),
        Step::Add => document.add_ellipsoid(DVec3::Y),
        Step::AddCloud => document.add_cloud(),
        Step::Duplicate => document.duplicate(DVec3::X),
        Step::Delete => document.delete(),
        Step::Mirror(axis) => document.mirror(axis),
        Step::Group => document.group(),
        Step::MoveToCloud(to) => document.move_to_cloud(to),
        Step::MoveCloud(from, to) => document.move_cloud(from, to),
        Step::MoveEllipsoid(from, to) => document.move_ellipsoid(id(from.0, from.1), id(to.0, to.1)),
        Step::Grow(seed) => document.grow(&Heaps { seed, children: (0, 1), generations: 1 }),
        Step::Hide => document.hide(),
        Step::ShowAll => document.show_all(),
        Step::Break => document.edit("Break", |scene| scene.time = f64::INFINITY),
        Step::Drag(cancelled) => {
            document.begin("Drag");
            document.edit("Drag", |scene| scene.time += 1.0);
            document.edit("Drag", |scene| scene.time += 1.0);
            if cancelled { document.cancel() } else { document.end() }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn any_sequence_keeps_the_scene_valid_and_can_be_taken_back(
        steps in prop::collection::vec(any_step(), 1..25),
    ) {
        let mut document = two_clouds();
        let first = document.scene().clone();
        for step in steps {
            take(&mut document, step);
            prop_assert!(document.scene().validate().is_ok());
            let selection = document.selection().clone();
            prop_assert_eq!(&selection.clone().within(document.scene()), &selection);
        }
        let last = document.scene().clone();
        while document.undo_name().is_some() {
            document.undo();
        }
        prop_assert_eq!(document.scene(), &first);
        prop_assert!(!document.is_dirty());
        while document.redo_name().is_some() {
            document.redo();
        }
        prop_assert_eq!(document.scene(), &last);
    }
}

/// A document of one cloud that grows.
fn growing() -> Document {
    let cloud = Cloud::grown("one", Growth { detail: 0.3, ..Growth::new(GrowthKind::Humilis, 1) });
    Document::new(Scene { clouds: vec![cloud], ..Scene::default() })
}

#[test]
fn a_cloud_grows_anew_with_its_numbers() {
    let mut document = growing();
    document.edit("Width", |scene| scene.clouds[0].growth.as_mut().unwrap().width = 900.0);
    assert!(document.scene().clouds[0].is_as_grown() && document.take_news().is_none());
    let (low, high) = document.scene().bounds().unwrap();
    assert!((high - low).x > 450.0);
    document.undo();
    assert_eq!(*document.scene(), *growing().scene());
}

#[test]
fn a_hand_that_changes_an_ellipsoid_ends_the_growth_and_undo_brings_it_back() {
    let mut document = growing();
    document.edit("Density", |scene| scene.clouds[0].ellipsoids[2].density = 0.25);
    assert_eq!(document.scene().clouds[0].growth, None);
    assert_eq!(document.scene().clouds[0].ellipsoids[2].density, 0.25);
    let news = document.take_news().unwrap();
    assert!(news.contains("`one` was changed by hand and grows no more"), "{news}");
    document.undo();
    assert!(document.scene().clouds[0].is_as_grown());
}

#[test]
fn a_cloud_that_is_carried_copied_or_ordered_goes_on_to_grow() {
    let mut document = growing();
    let offset = DVec3::new(120.0, 0.0, -30.0);
    document.edit("Move", |scene| {
        scene.clouds[0].ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center += offset);
    });
    let growth = document.scene().clouds[0].growth.clone().unwrap();
    assert!(growth.place.distance(DVec3::new(120.0, 1000.0, -30.0)) < 1e-6);
    document.select(Selection::cloud(document.scene(), 0));
    document.duplicate(DVec3::X * 700.0);
    document.move_cloud(1, 0);
    assert_eq!(document.scene().clouds.len(), 2);
    assert!(document.scene().clouds.iter().all(Cloud::is_as_grown));
    assert!(document.take_news().is_none());
}

#[test]
fn to_let_a_cloud_grow_takes_the_place_of_its_ellipsoids() {
    let mut document = Document::new(Preset::Kol.scene(1));
    document.edit("Grows", |scene| scene.clouds[0].growth = Some(Growth::new(GrowthKind::Humilis, 2)));
    assert!(document.scene().clouds[0].is_as_grown());
    document.undo();
    assert_eq!(*document.scene(), Preset::Kol.scene(1));
}
