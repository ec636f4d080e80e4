//! Bytes of a file, read one after the other: what is not there is a sentence.

use std::result::Result;

/// What is wrong with a file, as the rest of a sentence that its name begins.
pub(super) type Problem = String;

/// Reads on from a place in a file.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    pub fn new(all: &'a [u8]) -> Self {
        Self { all, at: 0 }
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Problem> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.all.len());
        let taken = end.and_then(|end| self.all.get(self.at..end)).ok_or_else(|| {
            format!(
                "ends early: at byte {} there should be {count} more, and it has {} bytes in all: copy or export it again",
                self.at,
                self.all.len()
            )
        })?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let taken = self.take(N)?;
        Ok(std::array::from_fn(|i| taken[i]))
    }

    pub fn byte(&mut self) -> Result<u8, Problem> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32, Problem> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, Problem> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, Problem> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, Problem> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, Problem> {
        self.array().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, Problem> {
        self.array().map(f64::from_le_bytes)
    }

    /// Text with its length before it.
    pub fn text(&mut self) -> Result<String, Problem> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// Goes on at a place.
    pub fn seek(&mut self, place: u64) -> Result<(), Problem> {
        let place = usize::try_from(place).ok().filter(|place| *place <= self.all.len());
        self.at = place.ok_or_else(|| {
            format!("ends early: it points behind its {} bytes: copy or export it again", self.all.len())
        })?;
        Ok(())
    }
}
