//! Pictures apart: light by what it comes from, places and motion, and clouds by their names.
#![cfg(feature = "export")]

use std::{collections::HashMap, path::Path};

use exr::prelude::*;
use glam::DVec3;
use nephos::{
    export::{LayerKind, Layered, Notes, Picture, write_layers_of},
    gpu::Gpu,
    render::{Blur, Film, Frame, Quality, Renderer, Transport},
    scene::{Aperture, Movement, Scene},
};

use crate::common::{
    gpu,
    picture::{in_coarse_light, renderer, scene},
};

const SIZE: [u32; 2] = [32, 24];
const ALL: [LayerKind; 7] = [
    LayerKind::Light,
    LayerKind::Distance,
    LayerKind::Normal,
    LayerKind::Depth,
    LayerKind::Position,
    LayerKind::Motion,
    LayerKind::Clouds,
];

fn sharp() -> Quality {
    in_coarse_light(Quality { jitter: false, ..Quality::DRAFT })
}

/// A picture in the file of its layers, and what its header tells.
struct File {
    channels: HashMap<String, Vec<f32>>,
    texts: HashMap<String, String>,
}

impl File {
    fn of(&self, name: &str) -> &[f32] {
        self.channels.get(name).unwrap_or_else(|| panic!("no channel {name}"))
    }

    /// The light of a layer, three numbers a pixel.
    fn light(&self, layer: &str) -> Vec<f32> {
        let [r, g, b] = ["R", "G", "B"].map(|c| self.of(&format!("{layer}.{c}")));
        r.iter().zip(g).zip(b).flat_map(|((r, g), b)| [*r, *g, *b]).collect()
    }

    fn alpha(&self) -> Vec<f32> {
        self.of("transmittance.Y").iter().map(|through| 1.0 - through).collect()
    }
}

/// Draws and writes them all, and reads them back.
fn apart(gpu: &Gpu, renderer: &mut Renderer, scene: &Scene, kinds: &[LayerKind], rays: u32) -> File {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("apart.exr");
    let film = Film::new(SIZE, rays);
    let frame = film.frame(scene).unwrap();
    let next = next(scene, &frame);
    let layers = renderer.render_layers_and_mattes(gpu, &frame, &mut |_| ()).unwrap();
    let moment = scene.at(scene.time).unwrap();
    let names: Vec<_> = moment.clouds.iter().enumerate().map(|(i, cloud)| cloud.label(i)).collect();
    let of = Layered {
        layers: &layers,
        frame: &frame,
        next: Some((&next.0, &next.1)),
        names: &names,
        reduce: rays as usize,
    };
    write_layers_of(&path, gpu, of, kinds, false, &Notes::default()).unwrap();
    read(&path)
}

const FPS: f64 = 24.0;

fn next(scene: &Scene, frame: &Frame) -> (Frame, Movement) {
    let camera = scene.at(scene.time + 1.0 / FPS).unwrap().camera();
    (frame.seen_by(&camera, frame.size()).unwrap(), scene.movement(scene.time, 1.0 / FPS).unwrap())
}

fn read(path: &Path) -> File {
    let image = read_first_flat_layer_from_file(path).unwrap();
    let channel = |channel: &AnyChannel<FlatSamples>| {
        (channel.name.to_string(), channel.sample_data.values_as_f32().collect())
    };
    let text = |(name, value): (Text, AttributeValue)| match value {
        AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    };
    File {
        channels: image.layer_data.channel_data.list.iter().map(channel).collect(),
        texts: image.layer_data.attributes.other.into_iter().filter_map(text).collect(),
    }
}

/// A heap under a sky that does not follow the sun.
fn lit_by(sun: [f64; 3], sky: &str) -> Scene {
    scene(&format!(
        r#"{{"clouds":[{{"edge":{{"boundary":30}},"ellipsoids":[{{"center":[0,900,0],"radii":[120,70,100]}}]}}],
            "camera":{{"position":[0,700,600],"target":[0,900,0]}},
            "sun":{{"position":{{"angles":{{"azimuth_deg":230,"elevation_deg":40}}}},"irradiance":{sun:?}}},
            "sky":{sky}}}"#
    ))
}

/// How far two lights are from one another, as a share of the brightest.
fn off(a: &[f32], b: &[f32]) -> f32 {
    let brightest = b.iter().fold(0f32, |most, c| most.max(*c));
    assert!(brightest > 1e-3, "nothing would be compared: {brightest}");
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / brightest).fold(0.0, f32::max)
}

#[test]
fn the_light_of_the_sun_is_regraded_as_if_it_were_another_one() {
    const RED: [f32; 3] = [1.0, 0.5, 0.2];
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    for transport in Transport::all() {
        renderer.settings.transport = transport;
        let mut draw = |sun: [f64; 3]| {
            let scene = lit_by(sun, r#"{"uniform":{"radiance":[0.01,0.016,0.03]}}"#);
            apart(gpu(), &mut renderer, &scene, &[LayerKind::Light], 1)
        };
        let (white, red) = (draw([1.0; 3]), draw(RED.map(f64::from)));
        let all = |file: &File| {
            let [single, multiple] = ["single", "multiple"].map(|layer| file.light(layer));
            single.iter().zip(multiple).map(|(a, b)| a + b).collect::<Vec<_>>()
        };
        let (sun, sky) = (white.light("lit.sun"), white.light("lit.sky"));
        let graded: Vec<_> = sun.iter().zip(&sky).enumerate().map(|(i, (a, b))| RED[i % 3] * a + b).collect();
        let found = off(&graded, &all(&red));
        assert!(found < 0.01, "{transport}: {found}");
        assert!(off(&graded, &all(&white)) > 0.05, "{transport}: the colour shows");
        // To the rounding of half floats.
        let sum: Vec<_> = sun.iter().zip(&sky).map(|(a, b)| a + b).collect();
        assert!(off(&sum, &all(&white)) < 2e-3, "{transport}");
    }
}

#[test]
fn under_an_atmosphere_sun_and_sky_are_of_one_colour_and_take_it_together() {
    const RED: [f32; 3] = [1.0, 0.5, 0.2];
    let mut renderer = renderer(sharp(), Transport::default());
    let sky = r#"{"atmosphere":{}}"#;
    let mut draw = |sun| apart(gpu(), &mut renderer, &lit_by(sun, sky), &[LayerKind::Light], 1);
    let (white, red) = (draw([1.0; 3]), draw(RED.map(f64::from)));
    for layer in ["lit.sun", "lit.sky"] {
        let graded: Vec<_> = white.light(layer).iter().enumerate().map(|(i, c)| RED[i % 3] * c).collect();
        let found = off(&graded, &red.light(layer));
        assert!(found < 0.01, "{layer}: {found}");
    }
}

/// Two balls, the nearer of which hides the farther in part; they drift as they are told.
fn balls(camera: &str, wind: &str) -> Scene {
    scene(&format!(
        r#"{{"clouds":[
            {{"name":"far","edge":{{"boundary":0}},"ellipsoids":[{{"center":[-40,1000,-400],"radii":[120,120,120]}}]}},
            {{"name":"near","edge":{{"boundary":0}},"droplets":{{"concentration_per_cm3":8}},
              "ellipsoids":[{{"center":[60,1000,0],"radii":[90,90,90]}}]}}],
            "noise":{{"detail":0}},"wind":{wind},"sky":"none","camera":{camera}}}"#
    ))
}

const PINHOLE: &str =
    r#"{"position":[0,1000,700],"target":[0,1000,0],"projection":{"perspective":{"vertical_fov_deg":40}}}"#;

#[test]
fn depth_is_along_the_axis_and_places_are_where_they_are_seen() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let file = apart(gpu(), &mut renderer, &balls(PINHOLE, "{}"), &ALL, 2);
    let (distance, depth) = (file.of("depth.Z"), file.of("planar.Z"));
    let half = (20f64).to_radians().tan();
    let mut clouds = 0;
    for i in 0..distance.len() {
        let place = ["X", "Y", "Z"].map(|axis| f64::from(file.of(&format!("position.{axis}"))[i]));
        if distance[i] == 1e10 {
            assert_eq!((depth[i], place), (1e10, [0.0; 3]));
            continue;
        }
        clouds += 1;
        let [x, y] = [(i % 32) as f64 + 0.5, (i / 32) as f64 + 0.5];
        let ray = DVec3::new((x / 16.0 - 1.0) * half * 32.0 / 24.0, (1.0 - y / 12.0) * half, -1.0);
        let (distance, depth) = (f64::from(distance[i]), f64::from(depth[i]));
        assert!((depth * ray.length() / distance - 1.0).abs() < 1e-5, "{i}: {depth} {distance}");
        let expected = DVec3::new(0.0, 1000.0, 700.0) + depth * ray;
        assert!(expected.distance(DVec3::from(place)) < 1e-2, "{i}: {expected} {place:?}");
    }
    assert!(clouds > 50, "{clouds}");
}

#[test]
fn clouds_apart_have_the_numbers_of_their_names_and_hide_what_all_together_hide() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    for rays in [1, 2] {
        let file = apart(gpu(), &mut renderer, &balls(PINHOLE, "{}"), &ALL, rays);
        let text = |ending: &str| {
            let found = file
                .texts
                .iter()
                .find(|(name, _)| name.starts_with("cryptomatte/") && name.ends_with(ending));
            found.unwrap_or_else(|| panic!("no {ending}: {:?}", file.texts)).1.clone()
        };
        assert_eq!([text("/name"), text("/hash")], ["CryptoCloud", "MurmurHash3_32"]);
        assert_eq!(text("/conversion"), "uint32_to_float32");
        let manifest: HashMap<String, String> = serde_json::from_str(&text("/manifest")).unwrap();
        let id = |name: &str| u32::from_str_radix(&manifest[name], 16).unwrap();
        let (near, far) = (id("near"), id("far"));
        let ranks: Vec<_> = (0..6)
            .map(|rank| {
                let [id, share] = [["R", "G"], ["B", "A"]][rank % 2];
                [id, share].map(|channel| file.of(&format!("CryptoCloud0{}.{channel}", rank / 2)))
            })
            .collect();
        let share_of = |name: u32, i: usize| {
            ranks.iter().filter(|[id, _]| id[i].to_bits() == name).map(|[_, share]| share[i]).sum::<f32>()
        };
        let alpha = file.alpha();
        let mut both = 0;
        for (i, alpha) in alpha.iter().enumerate() {
            let sum: f32 = ranks.iter().map(|[_, share]| share[i]).sum();
            assert!((sum - alpha).abs() < 2e-3, "{i}: {sum} {alpha}");
            assert!((share_of(near, i) + share_of(far, i) - sum).abs() < 1e-6);
            assert!(ranks.windows(2).all(|pair| pair[0][1][i] >= pair[1][1][i]), "{i}");
            both += u32::from(share_of(near, i) > 0.1 && share_of(far, i) > 0.1);
        }
        assert!(both > 10, "{both}");
        // The nearer one hides as much as it does alone, what is behind it or not.
        let mut alone = balls(PINHOLE, "{}");
        alone.clouds.remove(0);
        let alone = apart(gpu(), &mut renderer, &alone, &[LayerKind::Light], rays).alpha();
        for (i, alone) in alone.iter().enumerate() {
            assert!((share_of(near, i) - alone).abs() < 2e-3, "{i}: {} {alone}", share_of(near, i));
        }
    }
}

/// The largest distance of motion from what is expected, pixels, over pixels that this cloud alone hides.
fn motion_off(file: &File, of: impl Fn(usize) -> Option<[f64; 2]>) -> f64 {
    let (x, y) = (file.of("motion.X"), file.of("motion.Y"));
    let seen = (0..x.len()).filter(|&i| file.of("depth.Z")[i] < 1e9);
    let found = seen
        .filter_map(|i| Some((i, of(i)?)))
        .map(|(i, [right, up])| (f64::from(x[i]) - right).abs().max((f64::from(y[i]) - up).abs()));
    let all: Vec<_> = found.collect();
    assert!(all.len() > 20, "{}", all.len());
    all.into_iter().fold(0.0, f64::max)
}

const PARALLEL: &str =
    r#"{"position":[0,1000,700],"target":[0,1000,0],"projection":{"orthographic":{"height":480}}}"#;

#[test]
fn motion_is_what_the_wind_does_in_a_frame() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let mut draw = |scene: &Scene| apart(gpu(), &mut renderer, scene, &ALL, 1);
    // A pixel is 20 m: the wind of 480 m/s goes one in a frame, and one against z is not seen.
    let file = draw(&balls(PARALLEL, r#"{"velocity":[480,-240,100]}"#));
    assert!(motion_off(&file, |_| Some([1.0, -0.5])) < 1e-4);
    let still = draw(&balls(PARALLEL, "{}"));
    assert!(still.of("motion.X").iter().chain(still.of("motion.Y")).all(|motion| *motion == 0.0));
    // Through a pinhole it is as much larger as things are nearer: f / z.
    let file = draw(&balls(PINHOLE, r#"{"velocity":[48,0,0]}"#));
    let focal = 12.0 / (20f64).to_radians().tan();
    let depth = file.of("planar.Z").to_vec();
    assert!(motion_off(&file, |i| Some([focal * 2.0 / f64::from(depth[i]), 0.0])) < 1e-3);
}

#[test]
fn motion_of_a_camera_is_the_other_way_round() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let mut scene = balls(PINHOLE, "{}");
    let track = |path: &str, to: f64| {
        format!(
            r#"{{"path":"{path}","keys":[{{"time":0,"value":0,"interpolation":"linear"}},{{"time":1,"value":{to}}}]}}"#
        )
    };
    let tracks = [track("camera.position[0]", 48.0), track("camera.target[0]", 48.0)].join(",");
    let timeline = format!(r#"{{"length":1,"fps":24,"tracks":[{tracks}]}}"#);
    scene.timeline = Some(serde_json::from_str(&timeline).unwrap());
    let file = apart(gpu(), &mut renderer, &scene, &ALL, 1);
    let focal = 12.0 / (20f64).to_radians().tan();
    let depth = file.of("planar.Z").to_vec();
    assert!(motion_off(&file, |i| Some([-focal * 2.0 / f64::from(depth[i]), 0.0])) < 1e-3);
}

#[test]
fn clouds_that_go_different_ways_have_motions_of_their_own() {
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let mut scene = balls(PARALLEL, "{}");
    let track = r#"{"length":1,"fps":24,"tracks":[{"path":"clouds[1].ellipsoids[0].center[1]","keys":[
        {"time":0,"value":1000,"interpolation":"linear"},{"time":1,"value":1480}]}]}"#;
    scene.timeline = Some(serde_json::from_str(track).unwrap());
    let file = apart(gpu(), &mut renderer, &scene, &ALL, 1);
    let manifest = file.texts.iter().find(|(name, _)| name.ends_with("/manifest")).unwrap().1;
    let manifest: HashMap<String, String> = serde_json::from_str(manifest).unwrap();
    let near = u32::from_str_radix(&manifest["near"], 16).unwrap();
    let alpha = file.alpha();
    let share = |i: usize| {
        let ranks = [["CryptoCloud00.R", "CryptoCloud00.G"], ["CryptoCloud00.B", "CryptoCloud00.A"]];
        let own = ranks.into_iter().filter(|[id, _]| file.of(id)[i].to_bits() == near);
        own.map(|[_, share]| f64::from(file.of(share)[i])).sum::<f64>() / f64::from(alpha[i])
    };
    // It goes up by a pixel a frame, what is behind it stands still: what is seen of both is between.
    let mixed = (0..alpha.len()).filter(|&i| alpha[i] > 0.1 && (0.1..0.9).contains(&share(i))).count();
    assert!(mixed > 5, "{mixed}");
    assert!(motion_off(&file, |i| (alpha[i] > 0.1).then(|| [0.0, share(i)])) < 1e-2);
}

/// Sum, middle and variance of opacity across a picture, pixels.
fn across(picture: &Picture) -> [f64; 3] {
    let moment = |power: i32, about: f64| -> f64 {
        let places = picture.pixels.iter().enumerate();
        places.map(|(i, p)| f64::from(p[3]) * ((i % picture.width) as f64 - about).powi(power)).sum()
    };
    let sum = moment(0, 0.0);
    let middle = moment(1, 0.0) / sum;
    [sum, middle, moment(2, middle) / sum]
}

/// What goes a way L while the shutter is open is spread by the box of that width, whose variance is L^2 / 12.
#[test]
fn an_open_shutter_spreads_what_moves_by_its_way() {
    let mut scene = balls(PARALLEL, r#"{"velocity":[1000,0,0]}"#);
    scene.clouds.truncate(1);
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let film = Film::new(SIZE, 1);
    let mut expose = |samples, open| {
        let blur = Blur { samples, open };
        across(&film.expose(gpu(), &mut renderer, &scene, blur, false, &mut |_| ()).unwrap())
    };
    let still = expose(1, 0.0);
    // A pixel is 20 m, and in a tenth of a second it goes 100 m: 5 pixels.
    let moved = expose(32, 0.1);
    // The rim of a ball of 12 pixels with a ray each is good to a percent or two.
    assert!((moved[0] / still[0] - 1.0).abs() < 0.02, "{moved:?} {still:?}");
    assert!((moved[1] - still[1]).abs() < 0.1, "{moved:?} {still:?}");
    let spread = moved[2] - still[2];
    assert!((spread / (25.0 / 12.0) - 1.0).abs() < 0.05, "{spread}");
    let frame = film.frame(&scene).unwrap();
    let taken = across(&film.take(gpu(), &mut renderer, &frame, false, &mut |_| ()).unwrap());
    assert_eq!(taken, still);
}

/// A disc of confusion of radius r spreads by r^2 / 4 across.
#[test]
fn an_open_lens_spreads_what_is_out_of_focus() {
    let mut scene = balls(PINHOLE, "{}");
    scene.clouds.remove(0);
    let mut renderer = renderer(sharp(), Transport::SINGLE);
    let film = Film::new(SIZE, 1);
    let mut expose = |focus: f64| {
        let aperture = Aperture { radius: Some(40.0), f_stop: None, focus };
        scene.camera.as_mut().unwrap().aperture = Some(aperture);
        let blur = Blur { samples: 64, open: 0.0 };
        across(&film.expose(gpu(), &mut renderer, &scene, blur, false, &mut |_| ()).unwrap())
    };
    let focal = 12.0 / (20f64).to_radians().tan();
    let (sharp, blurred) = (expose(700.0), expose(1e6));
    let radius = focal * 40.0 * (1.0 / 700.0 - 1e-6);
    let spread = blurred[2] - sharp[2];
    // The ball is 90 m deep, of 700 m.
    assert!((spread / (radius * radius / 4.0) - 1.0).abs() < 0.15, "{spread} {radius}");
    assert!((blurred[0] / sharp[0] - 1.0).abs() < 0.03, "{blurred:?} {sharp:?}");
}

#[test]
fn a_device_with_room_for_less_in_a_pass_draws_the_same_in_two() {
    let least = pollster::block_on(async {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let wanted = std::env::var("NEPHOS_ADAPTER").unwrap_or_default().to_lowercase();
        let all = instance.enumerate_adapters(wgpu::Backends::PRIMARY).await;
        let adapter = all.into_iter().find(|a| a.get_info().name.to_lowercase().contains(&wanted)).unwrap();
        let (device, queue) = adapter.request_device(&Default::default()).await.unwrap();
        Gpu::from_device(device, queue, adapter.get_info())
    });
    assert_eq!(least.device.limits().max_color_attachment_bytes_per_sample, 32);
    assert!(gpu().device.limits().max_color_attachment_bytes_per_sample > 32, "both ways would be one");
    let scene = balls(PINHOLE, "{}");
    let mut one = renderer(sharp(), Transport::SINGLE);
    let mut two = Renderer::new(&least.device, &least.queue, wgpu::TextureFormat::Rgba16Float);
    two.settings = one.settings;
    let (one, two) = (apart(gpu(), &mut one, &scene, &ALL, 1), apart(&least, &mut two, &scene, &ALL, 1));
    assert_eq!(one.channels.len(), two.channels.len());
    for (name, values) in &one.channels {
        // What does not look for the sun's disc may go less deep.
        let same = |(a, b): (&f32, &f32)| a == b || (a - b).abs() <= 4e-3 * a.abs().max(1e-2);
        assert!(values.iter().zip(two.of(name)).all(same), "{name}");
    }
}
