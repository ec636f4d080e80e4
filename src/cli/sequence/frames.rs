//! Which frames, whose, and into which files.

use std::{
    path::{Path, PathBuf},
    str::FromStr,
};

use crate::{Error, Result};

/// Most frames of one sequence: more than a day at 60 frames a second.
const MOST: usize = 10_000_000;

/// Frames by number: ranges and single ones, `1-240:2,300`, as the Open Job Description has them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames(Vec<u32>);

impl Frames {
    /// The numbers, in the order that they were given in, each once.
    pub fn numbers(&self) -> Vec<u32> {
        self.0.clone()
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let mut numbers = Vec::new();
        for part in text.split(',') {
            let (first, last, step) = range(part.trim())
                .ok_or_else(|| format!("`{part}` is no range of frames: write 7, 1-240 or 1-240:2"))?;
            if first > last {
                return Err(format!("`{part}` runs backwards: write {last}-{first}"));
            }
            if (last - first) as usize / step + numbers.len() >= MOST {
                return Err(format!("`{part}` has too many frames: give at most {MOST}"));
            }
            numbers.extend((first..=last).step_by(step));
        }
        let mut seen = std::collections::HashSet::new();
        numbers.retain(|number| seen.insert(*number));
        Ok(Self(numbers))
    }
}

/// First, last and step of `7`, `1-240` or `1-240:2`.
fn range(text: &str) -> Option<(u32, u32, usize)> {
    let (ends, step) = match text.split_once(':') {
        Some((ends, step)) => (ends, step.parse().ok().filter(|step| *step > 0)?),
        None => (text, 1),
    };
    let (first, last) = ends.split_once('-').unwrap_or((ends, ends));
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

/// The name of a frame's file, with hashes where its number goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// Reads `output`, such as `out/frame.####.exr`.
    ///
    /// # Errors
    /// [`Error::Argument`] where its name has no hashes, or hashes in two places.
    pub fn of(output: &Path) -> Result<Self> {
        let refuse = |problem: &str| Err(Error::Argument(format!("`{}` {problem}", output.display())));
        let name = output.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let Some(start) = name.find('#') else {
            return refuse(
                "has no place for the frame's number: write #### there, such as frame.####.png, or name a \
                 movie, .mp4 or .webm",
            );
        };
        let (before, rest) = name.split_at(start);
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return refuse("has hashes in two places: leave one for the frame's number");
        }
        Ok(Self {
            folder: output.parent().unwrap_or(Path::new("")).to_owned(),
            before: before.to_owned(),
            digits: rest.len() - after.len(),
            after: after.to_owned(),
        })
    }

    /// The file of frame `number`.
    pub fn file(&self, number: u32) -> PathBuf {
        self.folder.join(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }
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
        for bad in ["", "a", "1-", "-3", "1-5:0", "1,,2", "99999999999", "0-4000000000"] {
            assert!(read(bad).is_err(), "{bad}");
        }
        assert!(read("9-3").unwrap_err().contains("write 3-9"));
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
    fn hashes_become_the_number() {
        let file = |text: &str, number| Pattern::of(Path::new(text)).map(|p| p.file(number)).ok();
        assert_eq!(file("out/a.####.exr", 7), Some("out/a.0007.exr".into()));
        assert_eq!(file("a#.png", 123), Some("a123.png".into()));
        assert_eq!(file("a.png", 1), None);
        assert_eq!(file("a#b#.png", 1), None);
    }
}
