//! Clouds of points: what is read of them, and ellipsoids that are where they are.

use glam::DVec3;
use nephos::import::{Point, fill_points, parse_points};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{RngCore, SeedableRng},
};

const MIDDLES: [DVec3; 2] = [DVec3::new(-200.0, 900.0, 50.0), DVec3::new(150.0, 950.0, 0.0)];
const RADII: [DVec3; 2] = [DVec3::new(120.0, 60.0, 90.0), DVec3::new(80.0, 80.0, 70.0)];

/// Points all over two ellipsoids.
fn cloud(radius: f64) -> Vec<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut uniform = || 2.0 * f64::from(random.next_u32()) / 2f64.powi(32) - 1.0;
    let mut points = Vec::new();
    while points.len() < 6000 {
        let p = DVec3::new(uniform(), uniform(), uniform());
        // Each as dense as the other.
        let i = usize::from(uniform() > 0.18);
        if p.length() < 1.0 {
            points.push(Point { place: MIDDLES[i] + RADII[i] * p, radius });
        }
    }
    points
}

#[test]
fn two_ellipsoids_of_points_become_two_ellipsoids() {
    // Points alone, and small balls.
    for radius in [0.0, 8.0] {
        let filled = fill_points(&cloud(radius), 2, 3).unwrap();
        assert!(filled.overlap >= 0.95, "{}", filled.overlap);
        assert_eq!(filled.ellipsoids.len(), 2);
        for (middle, radii) in MIDDLES.iter().zip(RADII) {
            let found = filled
                .ellipsoids
                .iter()
                .min_by(|a, b| a.center.distance(*middle).total_cmp(&b.center.distance(*middle)));
            let found = found.unwrap();
            assert!(found.center.distance(*middle) < 6.0, "{}", found.center);
            let mut sizes = [found.radii.to_array(), radii.to_array()];
            sizes.iter_mut().for_each(|sizes| sizes.sort_by(f64::total_cmp));
            for (size, wanted) in sizes[0].iter().zip(sizes[1]) {
                assert!((size / wanted - 1.0).abs() < 0.08, "{size} for {wanted}");
            }
        }
    }
    assert_eq!(fill_points(&cloud(0.0), 5, 3).unwrap(), fill_points(&cloud(0.0), 5, 3).unwrap());
}

#[test]
fn points_that_say_nothing_are_told() {
    let told = |points: &[Point]| fill_points(points, 3, 1).unwrap_err().to_string();
    assert!(told(&cloud(0.0)[..5]).contains("5 points say nothing of a shape"));
    let one = [Point { place: DVec3::ONE, radius: 0.0 }; 20];
    assert!(told(&one).contains("all points are in one place"));
    assert!(fill_points(&[Point { radius: 5.0, ..one[0] }; 20], 3, 1).is_ok());
}

const PLACES: [[f32; 3]; 3] = [[1.5, -2.0, 3.0], [4.0, 5.5, -6.25], [0.0, 7.0, 8.0]];

/// A file with faces before its vertices, which have a colour, places and a radius.
fn header(format: &str) -> Vec<u8> {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n\
         property uchar red\nproperty float x\nproperty double y\nproperty float z\nproperty short age\nproperty float pscale\nend_header\n"
    )
    .into_bytes()
}

fn expected() -> Vec<Point> {
    let point =
        |(i, place): (usize, &[f32; 3])| Point { place: DVec3::from(place.map(f64::from)), radius: i as f64 };
    PLACES.iter().enumerate().map(point).collect()
}

#[test]
fn ply_comes_in_as_text_and_in_either_order_of_bytes() {
    let mut text = header("ascii");
    text.extend(b"3 0 1 2\n");
    for (i, [x, y, z]) in PLACES.iter().enumerate() {
        text.extend(format!("255 {x} {y} {z} -3 {i}\n").bytes());
    }
    assert_eq!(parse_points(&text), Ok(expected()));
    let mut little = header("binary_little_endian");
    let mut big = header("binary_big_endian");
    for (bytes, is_big) in [(&mut little, false), (&mut big, true)] {
        let mut number = |mut raw: Vec<u8>| {
            if is_big {
                raw.reverse();
            }
            bytes.extend(raw);
        };
        number(vec![3]);
        (0..3i32).for_each(|i| number(i.to_le_bytes().to_vec()));
        for (i, [x, y, z]) in PLACES.iter().enumerate() {
            number(vec![255]);
            number(x.to_le_bytes().to_vec());
            number(f64::from(*y).to_le_bytes().to_vec());
            number(z.to_le_bytes().to_vec());
            number((-3i16).to_le_bytes().to_vec());
            number((i as f32).to_le_bytes().to_vec());
        }
    }
    assert_eq!((parse_points(&little), parse_points(&big)), (Ok(expected()), Ok(expected())));
    let told = |bytes: &[u8]| parse_points(bytes).unwrap_err();
    assert!(told(&little[..little.len() - 3]).contains("ends early"));
    assert!(told(&text[..text.len() - 12]).contains("ends early"));
    assert!(told(b"ply\nformat ascii 1.0\nelement vertex 1\n").contains("no end of its header"));
    assert!(
        told(b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")
            .contains("without x, y and z")
    );
    assert!(told(b"ply\nformat odd 1.0\nelement vertex 1\nend_header\n").contains("`odd`"));
    assert!(
        told(b"ply\nformat ascii 1.0\nelement vertex two\nend_header\n").contains("`element vertex two`")
    );
    assert!(told(b"ply\nformat ascii 1.0\nend_header\n").contains("no element `vertex`"));
    let nan = String::from_utf8(text.clone()).unwrap().replace("1.5", "nan");
    assert!(told(nan.as_bytes()).contains("point 1 at no place"));
}

#[test]
fn csv_comes_in_with_names_or_without() {
    let named = "\u{feff}Radius; z;\"y\";X\n0;3;-2;1.5\n\n1;-6.25;5.5;4\n2;8;7;0\n";
    let plain = "1.5,-2,3,0\r\n4, 5.5, -6.25, 1\r\n0,7,8,2\r\n";
    assert_eq!(
        (parse_points(named.as_bytes()), parse_points(plain.as_bytes())),
        (Ok(expected()), Ok(expected()))
    );
    assert_eq!(parse_points(b"1,2,3\n").unwrap()[0].radius, 0.0);
    let told = |text: &str| parse_points(text.as_bytes()).unwrap_err();
    assert!(told("1,2\n").contains("fewer than three numbers in line 1"));
    assert!(told("1,2,3\n4,five,6\n").contains("`five` in line 2"));
    assert!(told("a,b,c\n1,2,3\n").contains("the columns a, b, c"));
    assert!(told("1,2,3,-1\n").contains("point 1"));
    assert!(told("").contains("has no points"));
    assert!(parse_points(&[0xff, 0xfe, 0x00]).unwrap_err().contains("neither PLY nor text"));
}
