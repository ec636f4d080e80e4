//! What an EXR file's header says of a picture, in the names of OpenEXR's standard attributes, which
//! compositors read: camera, frame, colours.

use exr::{
    meta::attribute::{AttributeValue, Chromaticities, TimeCode},
    prelude::{ImageAttributes, LayerAttributes, Vec2},
};
use glam::{DMat4, DVec3, DVec4};

use crate::scene::{Camera, Projection};

/// What the three numbers of a colour are shares of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ColorSpace {
    /// Linear light of the primaries of Rec. 709 and sRGB, white D65: that of scenes.
    #[default]
    Rec709,
    /// ACEScg (S-2014-004): linear light of the primaries AP1, white of ACES.
    AcesCg,
}

/// From linear Rec. 709 to ACEScg, rows first: primaries as above, adapted after Bradford (Lindbloom).
const ACESCG_FROM_REC709: [[f32; 3]; 3] = [
    [0.613_097_4, 0.339_523_15, 0.047_379_45],
    [0.070_193_72, 0.916_353_9, 0.013_452_4],
    [0.020_615_59, 0.109_569_77, 0.869_814_63],
];

impl ColorSpace {
    /// x and y of red, green, blue and white.
    fn chromaticities(self) -> [[f32; 2]; 4] {
        match self {
            Self::Rec709 => [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]],
            Self::AcesCg => [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]],
        }
    }

    /// A colour of a scene in this space.
    pub fn from_scene(self, color: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Rec709 => color,
            Self::AcesCg => ACESCG_FROM_REC709.map(|row| row.iter().zip(color).map(|(m, c)| m * c).sum()),
        }
    }
}

/// The lens of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Shutter {
    /// The camera.
    pub camera: Camera,
    /// Width over height of the picture.
    pub aspect: f64,
}

/// What there is to say; nothing is said of what is not known.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Header {
    /// What the picture's colours are, where it holds light.
    pub color: Option<ColorSpace>,
    /// Luminance of the colour 1, 1, 1 in cd/m2.
    pub white_luminance: Option<f64>,
    /// The camera that it was taken by.
    pub shutter: Option<Shutter>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Number of the frame, 1 at 0 seconds.
    pub frame: Option<i32>,
    /// Exposure of the scene, stops; the pixels are not exposed by it.
    pub exposure: Option<f64>,
}

impl Header {
    /// Puts it into the attributes of a file.
    pub(super) fn put_into(&self, layer: &mut LayerAttributes, image: &mut ImageAttributes) {
        layer.software_name = Some(concat!("nephos ", env!("CARGO_PKG_VERSION")).into());
        image.chromaticities = self.color.map(|color| {
            let [red, green, blue, white] = color.chromaticities().map(|[x, y]| Vec2(x, y));
            Chromaticities { red, green, blue, white }
        });
        layer.white_luminance = self.white_luminance.map(|nits| nits as f32);
        layer.frames_per_second = self.fps.map(rational);
        image.time_code = self.time_code();
        if let Some(stops) = self.exposure {
            layer.other.insert("exposure".into(), AttributeValue::F32(stops as f32));
        }
        if let Some(Shutter { camera, aspect }) = &self.shutter {
            let from_world = camera_from_world(camera);
            layer.world_to_camera = Some(rows(from_world));
            let screen = screen_from_camera(camera, *aspect);
            layer.world_to_normalized_device = screen.map(|screen| rows(screen * from_world));
            let vertical = camera.projection.vertical_fov(*aspect);
            let horizontal = vertical.map(|fov| 2.0 * ((0.5 * fov).tan() * aspect).atan());
            [layer.horizontal_field_of_view, layer.vertical_field_of_view] =
                [horizontal, vertical].map(|angle| angle.map(|angle| angle.to_degrees() as f32));
        }
    }

    /// Time of the frame since frame 1, as tape has it: frames count to 30 a second there at most.
    fn time_code(&self) -> Option<TimeCode> {
        let (index, rate) = (u32::try_from(self.frame?.checked_sub(1)?).ok()?, self.fps?.round() as u32);
        if !(1..=30).contains(&rate) {
            return None;
        }
        let seconds = index / rate;
        let [hours, minutes, seconds] =
            [seconds / 3600 % 24, seconds / 60 % 60, seconds % 60].map(|n| n as u8);
        Some(TimeCode {
            hours,
            minutes,
            seconds,
            frame: (index % rate) as u8,
            drop_frame: false,
            color_frame: false,
            field_phase: false,
            binary_group_flags: [false; 3],
            binary_groups: [0; 8],
        })
    }
}

/// A rate as a fraction: whole, of 1001 as television has them, or of a thousand.
fn rational(fps: f64) -> (i32, u32) {
    let exact = |under: f64| ((fps * under).round() / under - fps).abs() < 1e-9 * fps;
    let under = [1.0, 1001.0].into_iter().find(|under| exact(*under)).unwrap_or(1000.0);
    ((fps * under).round() as i32, under as u32)
}

/// From the world to the camera: x to the right, y up, -z along the line of sight, metres.
fn camera_from_world(camera: &Camera) -> DMat4 {
    DMat4::from_rotation_translation(camera.world_from_camera(), camera.position).inverse()
}

/// From the camera to the picture: x to the right and y up from -1 to 1; z from -1 at [`NEAR`] to 1 at [`FAR`].
fn screen_from_camera(camera: &Camera, aspect: f64) -> Option<DMat4> {
    let depth = FAR - NEAR;
    let [right, up] = camera.shift(aspect);
    match (camera.projection.vertical_fov(aspect), camera.projection) {
        (Some(fov), _) => {
            let y = 1.0 / (0.5 * fov).tan();
            Some(DMat4::from_cols(
                DVec4::new(y / aspect, 0.0, 0.0, 0.0),
                DVec4::new(0.0, y, 0.0, 0.0),
                DVec4::new(right, up, -(FAR + NEAR) / depth, -1.0),
                DVec4::new(0.0, 0.0, -2.0 * FAR * NEAR / depth, 0.0),
            ))
        }
        (None, Projection::Orthographic { height }) => {
            let scale = DVec3::new(2.0 / (height * aspect), 2.0 / height, -2.0 / depth);
            let middle = DVec3::new(-right, -up, -(FAR + NEAR) / depth);
            Some(DMat4::from_translation(middle) * DMat4::from_scale(scale))
        }
        _ => None,
    }
}

/// Planes that other programs cut pictures at, m: those of exported cameras.
pub(super) const NEAR: f64 = 0.1;
pub(super) const FAR: f64 = 200_000.0;

/// The numbers of a matrix as OpenEXR has them: points are rows that stand before it, so that its rows are our
/// columns.
fn rows(matrix: DMat4) -> [f32; 16] {
    matrix.to_cols_array().map(|number| number as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    /// From colours to CIE XYZ, and the white, by primaries and white.
    fn xyz([red, green, blue, white]: [[f32; 2]; 4]) -> (DMat3, DVec3) {
        let of = |[x, y]: [f32; 2]| {
            let (x, y) = (f64::from(x), f64::from(y));
            DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
        };
        let (primaries, white) = (DMat3::from_cols(of(red), of(green), of(blue)), of(white));
        (primaries * DMat3::from_diagonal(primaries.inverse() * white), white)
    }

    #[test]
    fn acescg_follows_from_its_primaries_and_keeps_white() {
        let bradford = DMat3::from_cols(
            DVec3::new(0.8951, -0.7502, 0.0389),
            DVec3::new(0.2664, 1.7135, -0.0685),
            DVec3::new(-0.1614, 0.0367, 1.0296),
        );
        let (from_rec709, d65) = xyz(ColorSpace::Rec709.chromaticities());
        let (from_acescg, d60) = xyz(ColorSpace::AcesCg.chromaticities());
        let scale = DMat3::from_diagonal((bradford * d60) / (bradford * d65));
        let adapted = bradford.inverse() * scale * bradford;
        let whole = from_acescg.inverse() * adapted * from_rec709;
        for (r, row) in ACESCG_FROM_REC709.iter().enumerate() {
            for (c, number) in row.iter().enumerate() {
                // Seven digits are written, and chromaticities are rounded to f32.
                assert!((whole.row(r)[c] - f64::from(*number)).abs() < 3e-7, "{r} {c}");
            }
        }
        let white = ColorSpace::AcesCg.from_scene([1.0; 3]);
        assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-6), "{white:?}");
    }

    #[test]
    fn rates_are_fractions() {
        let rates = [(24.0, (24, 1)), (24000.0 / 1001.0, (24000, 1001)), (12.5, (12_500, 1000))];
        rates.iter().for_each(|(fps, expected)| assert_eq!(rational(*fps), *expected));
    }

    #[test]
    fn tape_counts_from_frame_one_and_knows_no_frame_before_it() {
        let code = |frame, fps| {
            let code = Header { frame: Some(frame), fps: Some(fps), ..Header::default() }.time_code()?;
            Some((code.hours, code.minutes, code.seconds, code.frame))
        };
        assert_eq!(code(1, 24.0), Some((0, 0, 0, 0)));
        assert_eq!(code(90_000 + 25, 25.0), Some((1, 0, 0, 24)));
        assert_eq!(code(48, 24000.0 / 1001.0), Some((0, 0, 1, 23)));
        assert_eq!((code(0, 24.0), code(7, 60.0)), (None, None));
    }

    #[test]
    fn what_is_on_the_rim_of_the_picture_is_at_one() {
        let (shift_x, shift_y) = (0.1, -0.3);
        let camera = Camera { position: DVec3::new(10.0, 20.0, 30.0), shift_x, shift_y, ..Camera::default() };
        for projection in [Projection::default(), Projection::Orthographic { height: 80.0 }] {
            let camera = Camera { projection, ..camera.clone() };
            let half = match projection.vertical_fov(2.0) {
                Some(fov) => 100.0 * (0.5 * fov).tan(),
                None => 40.0,
            };
            // The width is four times half the height.
            let corner = DVec3::new(2.0 * half + shift_x * 4.0 * half, -half + shift_y * 4.0 * half, -100.0);
            let world = camera.world_from_camera() * corner + camera.position;
            let screen = screen_from_camera(&camera, 2.0).unwrap() * camera_from_world(&camera);
            let at = screen.project_point3(world);
            assert!((at.x - 1.0).abs() < 1e-9 && (at.y + 1.0).abs() < 1e-9, "{at}");
            assert!(at.z > -1.0 && at.z < 1.0, "{at}");
        }
    }
}
