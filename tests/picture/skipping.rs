//! What a scene does not use costs nothing: told by the counts of work, by what is made, and by what is
//! left of the shader.
#![cfg(feature = "export")]

use crate::common;

use common::{
    compiled::{Compiled, compiled},
    gpu,
    picture::{draw, renderer, scene},
    random::white,
};
use nephos::{
    frame::MEDIA,
    gpu::{ENTRY_POINTS, Role, link},
    render::{Counts, Quality, Renderer, Transport},
    scene::{Noise, Phase, Scene, Sky, SunPosition},
};

const SIZE: [u32; 2] = [32, 18];

fn one(edge: &str) -> Scene {
    scene(&format!(
        r#"{{"sky": "none", "clouds": [{{"edge": {edge}, "droplets": {{"phase": "isotropic"}}, "ellipsoids": [
            {{"center": [0, 900, 0], "radii": [100, 100, 100]}}]}}]}}"#
    ))
}

fn counted(scene: &Scene, transport: Transport) -> Counts {
    let mut renderer = renderer(Quality::DRAFT, transport);
    renderer.settings.counting = true;
    draw(&mut renderer, scene, SIZE, false);
    renderer.counts(gpu()).unwrap()
}

#[test]
fn homogeneous_clouds_read_no_noise() {
    let smooth = counted(&one(r#"{"boundary": 0}"#), Transport::SINGLE);
    assert_eq!((smooth.density_evaluations, smooth.noise_reads), (0, 0));
    assert!(smooth.rays_hit > 0 && smooth.steps > 0);
    let noisy = counted(&one(r#"{"boundary": 40}"#), Transport::SINGLE);
    assert!(noisy.noise_reads > 0, "else the test would prove nothing");
}

#[test]
fn light_that_is_not_asked_for_is_not_read() {
    let cloud = one(r#"{"boundary": 40}"#);
    let reads = |transport| counted(&cloud, transport).map_reads;
    assert_eq!(reads(Transport::EMITTER), 0, "an emitter has no shadows");
    assert!(reads(Transport::SINGLE) < reads(Transport::MOMENTS));
    let mut lit = cloud.clone();
    lit.sky = white();
    assert!(counted(&lit, Transport::SINGLE).map_reads > reads(Transport::SINGLE), "the sky is read");
}

#[test]
fn pixels_without_clouds_are_not_launched() {
    let empty = scene(r#"{"sky": "none", "clouds": [{}]}"#);
    assert_eq!(counted(&empty, Transport::SINGLE), Counts::default());
    let mut away = one(r#"{"boundary": 40}"#);
    away.camera = Some(away.camera());
    away.clouds[0].ellipsoids[0].center.z += 1e5;
    let counts = counted(&away, Transport::SINGLE);
    assert_eq!(counts, Counts::default(), "behind the camera");
}

#[test]
fn clouds_out_of_the_picture_get_no_light_and_keep_what_they_have() {
    let cloud = one(r#"{"boundary": 40}"#);
    let mut away = cloud.clone();
    let camera = cloud.camera();
    away.camera = Some(nephos::scene::Camera { target: 2.0 * camera.position - camera.target, ..camera });
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let mut made = |scene: &Scene| {
        draw(&mut renderer, scene, SIZE, false);
        (renderer.light_updates(), renderer.light_bytes())
    };
    assert_eq!(made(&away), (0, 0));
    let seen = made(&cloud);
    assert!(seen.0 > 0 && seen.1 > 0);
    assert_eq!(made(&away), seen);
    assert_eq!(made(&cloud), seen, "what was made once is found again");
}

#[test]
fn ellipsoids_that_a_ray_does_not_meet_are_not_asked_at_its_points() {
    // A row of many across the view: each ray meets few of them.
    let mut row = one(r#"{"boundary": 40}"#);
    row.camera = Some(row.camera());
    let first = row.clouds[0].ellipsoids[0].clone();
    let alone = counted(&row, Transport::SINGLE);
    for i in 0..400 {
        let mut next = first.clone();
        next.center.x += 250.0 * f64::from(i + 1);
        row.clouds[0].ellipsoids.push(next);
    }
    let many = counted(&row, Transport::SINGLE);
    let each = |counts: Counts| counts.ellipsoids as f64 / counts.density_evaluations as f64;
    assert!(each(many) < 4.0 * each(alone), "{} for {}", each(many), each(alone));
}

#[test]
fn only_models_of_slabs_have_maps_seen_from_the_sun() {
    let mut lit = one(r#"{"boundary": 40}"#);
    lit.sky = white();
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let mut made = |scene: &Scene, transport| {
        renderer.settings.transport = transport;
        let before = renderer.light_updates();
        draw(&mut renderer, scene, SIZE, false);
        (renderer.light_updates() - before, renderer.light_bytes())
    };
    let (_, single) = made(&lit, Transport::SINGLE);
    let (_, slabs) = made(&lit, Transport::DELTA_EDDINGTON);
    // Depths and normals, half floats of four channels, with their mips.
    let texels = |resolution: u64| (4 * resolution * resolution - 1) / 3;
    let maps = texels(Quality::DRAFT.light_resolution.into());
    assert_eq!(slabs - single, 2 * 8 * maps);
    // The volume of the sun is that of single scattering.
    lit.sky = Sky::None;
    made(&lit, Transport::SINGLE);
    assert_eq!(made(&lit, Transport::MOMENTS).0, 1, "the moments alone are made");
}

#[test]
fn the_first_cloud_after_pictures_without_any_has_its_noise() {
    let cloud = one(r#"{"boundary": 40}"#);
    let empty = Scene { clouds: Vec::new(), camera: Some(cloud.camera()), ..cloud.clone() };
    let mut late = renderer(Quality::DRAFT, Transport::SINGLE);
    draw(&mut late, &empty, SIZE, false);
    let first = draw(&mut late, &cloud, SIZE, false);
    let at_once = draw(&mut renderer(Quality::DRAFT, Transport::SINGLE), &cloud, SIZE, false);
    assert_eq!(first.pixels, at_once.pixels);
}

#[test]
fn light_is_made_anew_once_for_each_change_of_sun_or_noise() {
    let mut cloud = one(r#"{"boundary": 40}"#);
    let mut renderer = renderer(Quality::DRAFT, Transport::SINGLE);
    let mut made = |scene: &Scene| {
        draw(&mut renderer, scene, SIZE, false);
        renderer.light_updates()
    };
    assert_eq!((made(&cloud), made(&cloud)), (1, 1));
    cloud.sun.position = SunPosition::Angles { azimuth_deg: 30.0, elevation_deg: 10.0 };
    assert_eq!((made(&cloud), made(&cloud)), (2, 2));
    let changes: [fn(&mut Noise); 5] = [
        |noise| noise.evolution = 1.0,
        |noise| noise.scale = Some(70.0),
        |noise| noise.seed = 3,
        |noise| noise.dimension = 2.6,
        |noise| noise.offset.x = 9.0,
    ];
    for (change, count) in changes.iter().zip(3..) {
        change(&mut cloud.noise);
        assert_eq!((made(&cloud), made(&cloud)), (count, count));
    }
    cloud.clouds[0].noise = Some(cloud.noise.clone());
    assert_eq!(made(&cloud), 7, "the same noise, its own or the scene's");
    cloud.noise.seed = 4;
    assert_eq!(made(&cloud), 7, "the scene's is not its own");
}

#[test]
fn only_clouds_that_pass_through_one_another_are_looked_through_first() {
    // Towers that lean: the boxes of those side by side meet.
    let tower = |x: f64, lean: f64| {
        let lump = |i: i32| {
            let i = f64::from(i);
            format!(r#"{{"center": [{}, {}, 0], "radii": [40, 40, 40]}}"#, x + lean * i, 800.0 + 60.0 * i)
        };
        format!(r#"{{"ellipsoids": [{}]}}"#, [0, 1, 2, 3].map(lump).join(","))
    };
    let looks = |clouds: &str| {
        let scene = scene(&format!(
            r#"{{"sky": "none", "clouds": [{clouds}],
            "camera": {{"position": [0, 900, 900], "target": [0, 900, 0]}}}}"#
        ));
        let mut renderer = renderer(Quality::DRAFT, Transport::EMITTER);
        draw(&mut renderer, &scene, SIZE, false);
        renderer.variants().any(|variant| variant.entry == "visibility")
    };
    let behind = tower(-60.0, -30.0).replace(", 0]", ", -700]");
    let (one, through) = (tower(-60.0, -30.0), tower(0.0, -30.0));
    assert!(!looks(&format!("{one}, {behind}")), "one behind the other");
    assert!(!looks(&one) && looks(&format!("{one}, {through}")));
    assert!(!looks(&format!("{}, {}", tower(-200.0, 30.0), tower(0.0, 30.0))), "side by side");
}

/// What is left of the shader of the clouds for a scene, as `prepare` wants it drawn.
fn left(scene: &Scene, transport: Transport, prepare: impl Fn(&mut Renderer)) -> Compiled {
    let mut renderer = renderer(Quality::DRAFT, transport);
    prepare(&mut renderer);
    draw(&mut renderer, scene, SIZE, false);
    let variants: Vec<_> = renderer.variants().collect();
    let [variant] = variants.as_slice() else { panic!("one cloud has one variant: {variants:?}") };
    compiled(&source("march", &variant.roles()), variant.entry, &variant.overrides())
}

fn source(name: &str, roles: &[Role<'_>]) -> String {
    link(ENTRY_POINTS.iter().find(|(known, _)| *known == name).unwrap().1, roles)
}

/// The march of single scattering.
fn march() -> String {
    source("march", &[MEDIA, Transport::SINGLE.roles()].concat())
}

/// Tables and maps of light that are left: what is bound in the group of the model of light.
fn tables(compiled: &Compiled, transport: Transport) -> Vec<&str> {
    let bound = source("march", &[MEDIA, transport.roles()].concat());
    let is_bound = |name: &str| {
        bound.lines().any(|line| line.starts_with("@group(2)") && line.contains(&format!(" {name}:")))
    };
    let all = compiled.globals.iter().map(String::as_str);
    all.filter(|name| is_bound(name) && !["light", "linear"].contains(name)).collect()
}

#[test]
fn each_model_of_light_reads_its_own_tables_only() {
    let cloud = one(r#"{"boundary": 40}"#);
    let sun = ["phase_table", "sun_volume"];
    let maps = ["phase_table", "sun_depths", "sun_normals", "sun_volume"];
    for (transport, expected) in [
        (Transport::EMITTER, [].to_vec()),
        (Transport::SINGLE, sun.to_vec()),
        (Transport::FORWARD, sun.to_vec()),
        (Transport::POWDER, sun.to_vec()),
        (Transport::OCTAVES, sun.to_vec()),
        (Transport::MOMENTS, ["phase_table", "remainder", "sun_field", "sun_volume"].to_vec()),
        (Transport::DELTA_EDDINGTON, [&["phase_table", "sky_volume"], &maps[1..]].concat()),
        (Transport::SLAB, [&["phase_table", "remainder", "sky_volume", "slab_table"], &maps[1..]].concat()),
        (
            Transport::SLAB_KOL,
            [&["phase_table", "slab_angles", "slab_suns", "slab_views"], &maps[1..]].concat(),
        ),
        (Transport::SLAB_KOL_DIRECT, [&["phase_table", "slab_modes", "slab_phases"], &maps[1..]].concat()),
        (
            Transport::SLAB_BOUTHORS,
            [
                &["phase_table", "slab_angles", "slab_entries", "slab_offsets", "slab_suns", "slab_views"],
                &maps[1..],
            ]
            .concat(),
        ),
    ] {
        let left = left(&cloud, transport, |_| ());
        assert_eq!(tables(&left, transport), expected, "{transport:?}");
        assert_eq!(left.functions.contains("octave_phases"), transport == Transport::OCTAVES);
        assert!(left.samples > 0, "it reads noise");
    }
}

#[test]
fn what_a_scene_does_not_use_is_compiled_out() {
    let plain = one(r#"{"boundary": 40}"#);
    let changed = |change: &dyn Fn(&mut Scene), prepare: &dyn Fn(&mut Renderer)| {
        let mut scene = plain.clone();
        change(&mut scene);
        left(&scene, Transport::SINGLE, prepare)
    };
    let bare = changed(&|_| (), &|_| ());
    for (what, with) in [
        ("sky_volume", changed(&|scene| scene.sky = white(), &|_| ())),
        ("conductances_at", changed(&|scene| scene.sky = white(), &|_| ())),
        ("aerial", changed(&|scene| scene.sky = Sky::default(), &|_| ())),
        ("counters", changed(&|_| (), &|renderer| renderer.settings.counting = true)),
        ("counts", changed(&|_| (), &|renderer| renderer.settings.counting = true)),
        ("recovered_peak", changed(&|scene| scene.clouds[0].droplets.phase = Phase::Mie, &|_| ())),
        ("sees_disc", changed(&|scene| scene.clouds[0].droplets.phase = Phase::Mie, &|_| ())),
        (
            "absorbed",
            changed(
                &|scene| {
                    scene.sky = white();
                    scene.clouds[0].droplets.albedo = 0.9;
                },
                &|_| (),
            ),
        ),
    ] {
        let has = |compiled: &Compiled| compiled.globals.contains(what) || compiled.functions.contains(what);
        assert!(has(&with) && !has(&bare), "{what}");
    }
    let dry = changed(&|scene| scene.sky = Sky::default(), &|renderer| renderer.settings.aerial = false);
    assert!(!dry.globals.contains("aerial"), "air that is not asked for");
    let [air, no_air] = [1.0, 0.0].map(|on| compiled(&march(), "quad", &[("ATMOSPHERE", on)]).globals);
    assert!(air.contains("transmittance") && !no_air.contains("transmittance"));
    let [drawn, alone] = [1.0, 0.0].map(|on| compiled(&march(), "beauty", &[("SCENE_DEPTH", on)]).globals);
    assert!(drawn.contains("scene_depth") && !alone.contains("scene_depth"));
    assert!(!bare.globals.contains("scene_depth"));
    let [crossed, alone] = [1.0, 0.0].map(|on| compiled(&march(), "beauty", &[("CROSSES", on)]).globals);
    assert!(crossed.contains("visibilities") && !alone.contains("visibilities"));
    assert!(!bare.globals.contains("visibilities"));
    let [mapped, unmapped] =
        [1.0, 0.0].map(|on| compiled(&source("sun_maps", MEDIA), "main", &[("MAPPED", on)]).globals);
    assert!(mapped.contains("depths") && !unmapped.contains("depths"));
}
