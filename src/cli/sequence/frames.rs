//! Which frames, whose, and into which files.

use std::{path::Path, str::FromStr};

use crate::{
    Error, Result,
    numbered::{Pattern, Unfit},
    scene::{Scene, Timeline},
};

/// Most frames of one sequence: more than a day at 60 frames a second.
const MOST: usize = 10_000_000;
/// Most frames a second.
const FASTEST: f64 = 1e6;

/// Frames by number: ranges and single ones, `1-240:2,300`, as the Open Job Description has them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames(Vec<i32>);

impl Frames {
    /// The numbers, in the order that they were given in, each once.
    pub fn numbers(&self) -> Vec<i32> {
        self.0.clone()
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let mut numbers = Vec::new();
        for part in text.split(',') {
            let (first, last, step) = range(part.trim()).ok_or_else(|| {
                format!("`{part}` is no range of frames: write 7, 1-240, 1-240:2 or -10-240")
            })?;
            if first > last {
                return Err(format!("`{part}` runs backwards: write {last}-{first}"));
            }
            if (i64::from(last) - i64::from(first)) as usize / step + numbers.len() >= MOST {
                return Err(format!("`{part}` has too many frames: give at most {MOST}"));
            }
            numbers.extend((first..=last).step_by(step));
        }
        let mut seen = std::collections::HashSet::new();
        numbers.retain(|number| seen.insert(*number));
        Ok(Self(numbers))
    }
}

/// First, last and step of `7`, `1-240` or `1-240:2`; numbers may be below 0.
fn range(text: &str) -> Option<(i32, i32, usize)> {
    let (ends, step) = match text.split_once(':') {
        Some((ends, step)) => (ends, step.parse().ok().filter(|step| *step > 0)?),
        None => (text, 1),
    };
    let between = ends.char_indices().skip(1).find(|(_, letter)| *letter == '-');
    let (first, last) = between.map_or((ends, ends), |(at, _)| (&ends[..at], &ends[at + 1..]));
    Some((first.parse().ok()?, last.parse().ok()?, step))
}

/// Every n-th frame from the i-th on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// Whether the frame that comes `index`-th in the whole range, from 0 on, is of this shard.
    pub fn has(self, index: usize) -> bool {
        index % self.of == self.number - 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((number, of)) if number >= 1 && number <= of => Ok(Self { number, of }),
            _ => Err(format!("`{text}` is no shard: write I/N with I from 1 to N, such as 2/8")),
        }
    }
}

/// Frames a second: a number, or a fraction such as 24000/1001.
pub fn rate(text: &str) -> std::result::Result<f64, String> {
    let (over, under) = text.split_once('/').unwrap_or((text, "1"));
    let rate = over.trim().parse::<f64>().ok().zip(under.trim().parse::<f64>().ok()).map(|(a, b)| a / b);
    rate.filter(|rate| *rate > 0.0 && *rate <= FASTEST).ok_or_else(|| {
        format!("give a number above 0 and at most {FASTEST}, or a fraction such as 24000/1001")
    })
}

/// Sets the frames per second of a scene, where any are given; what they are.
///
/// # Errors
/// Where its timeline can't have so many.
pub fn set_fps(scene: &mut Scene, fps: Option<f64>) -> Result<f64> {
    match (&mut scene.timeline, fps) {
        (Some(timeline), Some(fps)) => {
            timeline.fps = fps;
            scene.validate()?;
            Ok(fps)
        }
        (Some(timeline), None) => Ok(timeline.fps),
        (None, fps) => Ok(fps.unwrap_or(Timeline::default().fps)),
    }
}

/// The numbers of frames and their times, s: those that are asked for, or else all of the timeline of the scene,
/// whose file is `path`.
///
/// # Errors
/// [`Error::Argument`] where nothing says how many there are.
pub fn numbered(scene: &Scene, frames: Option<&Frames>, fps: f64, path: &Path) -> Result<Vec<(i32, f64)>> {
    let all = match (frames, &scene.timeline) {
        (Some(frames), _) => frames.numbers(),
        (None, Some(timeline)) => (1..=i32::try_from(timeline.frames()).unwrap_or(i32::MAX)).collect(),
        (None, None) => {
            return Err(Error::Argument(format!(
                "`{}` has no timeline that says how long it is: say which frames, such as --frames 1-240",
                path.display()
            )));
        }
    };
    let time = |index: i64| match &scene.timeline {
        Some(timeline) => timeline.time_of(index),
        None => index as f64 / fps,
    };
    Ok(all.into_iter().map(|number| (number, time(i64::from(number) - 1))).collect())
}

/// The names of files of frames, such as `out/frame.####.exr`: `%04d` and `$F4` stand for the number, too.
///
/// # Errors
/// [`Error::Argument`] where the name of `output` has no such place, or two.
pub fn pattern(output: &Path) -> Result<Pattern> {
    Pattern::of(output).map_err(|unfit| {
        Error::Argument(format!(
            "`{}` {}",
            output.display(),
            match unfit {
                Unfit::NoPlace =>
                    "has no place for the frame's number: write #### there, such as frame.####.png, or name a movie, \
                     .mp4 or .webm",
                Unfit::TwoPlaces => "has two places for the frame's number: leave one",
            }
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_and_bad_ones_told() {
        let read = |text: &str| text.parse::<Frames>().map(|frames| frames.numbers());
        assert_eq!(read("7"), Ok(vec![7]));
        assert_eq!(read("1-5"), Ok(vec![1, 2, 3, 4, 5]));
        assert_eq!(read("1-9:4, 3,5"), Ok(vec![1, 5, 9, 3]));
        for bad in ["", "a", "1-", "-", "--3", "1---3", "1-5:0", "1,,2", "99999999999", "0-4000000000"] {
            assert!(read(bad).is_err(), "{bad}");
        }
        assert!(read("9-3").unwrap_err().contains("write 3-9"));
        assert_eq!(read("-3"), Ok(vec![-3]));
        assert_eq!(read("-3-2:2"), Ok(vec![-3, -1, 1]));
        assert_eq!(read("-8--7,0"), Ok(vec![-8, -7, 0]));
        assert!(read("-7--8").unwrap_err().contains("write -8--7"));
    }

    #[test]
    fn shards_share_out_every_frame_once() {
        for of in 1..=5 {
            let shards: Vec<Shard> = (1..=of).map(|i| format!("{i}/{of}").parse().unwrap()).collect();
            assert!((0..40).all(|index| shards.iter().filter(|shard| shard.has(index)).count() == 1));
        }
        for bad in ["0/4", "5/4", "1", "1/0", "a/b", "-1/4"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }

    #[test]
    fn rates_are_numbers_or_fractions() {
        assert_eq!(rate("24"), Ok(24.0));
        assert_eq!(rate("12.5"), Ok(12.5));
        assert_eq!(rate("30000/1001"), Ok(30000.0 / 1001.0));
        for bad in ["", "0", "-24", "24/0", "nan", "inf", "1e300", "24/", "/3", "1/2/3", "24fps"] {
            assert!(rate(bad).unwrap_err().contains("24000/1001"), "{bad}");
        }
    }
}
