//! The jobs of a study that are done, in a file that grows.
//!
//! Records of job, length, checksum and bytes follow a head with the seed. What an interrupted
//! write left at the end doesn't add up and is cut off.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::{axes, moments, samples, walks};
use crate::tables::checksum;
use crate::{Error, Result};

/// Begins the file. A change of what jobs are needs another one.
const MAGIC: [u8; 8] = *b"nephoST1";

/// Length of a record before its bytes.
const HEAD: usize = 16;

/// Jobs that are done.
pub(super) struct Partial {
    path: PathBuf,
    file: Mutex<File>,
    done: HashMap<usize, Vec<u8>>,
}

impl Partial {
    /// The jobs that the file at `path` has, if it is there and of the same study.
    pub fn open(path: &Path, seed: u64) -> Result<Self> {
        let opened = || -> io::Result<(File, HashMap<usize, Vec<u8>>)> {
            let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes)?;
            let head = head(seed);
            let (done, length) = match bytes.strip_prefix(&head[..]) {
                Some(records) => {
                    let (done, length) = read(records);
                    (done, head.len() + length)
                }
                None => (HashMap::new(), 0),
            };
            file.set_len(length as u64)?;
            file.seek(SeekFrom::End(0))?;
            if length == 0 {
                file.write_all(&head)?;
            }
            Ok((file, done))
        };
        let (file, done) = opened().map_err(failed(path))?;
        Ok(Self { path: path.to_owned(), file: Mutex::new(file), done })
    }

    /// What job `job` gave, if it is done.
    pub fn record(&self, job: usize) -> Option<Vec<u8>> {
        self.done.get(&job).cloned()
    }

    /// Keeps what job `job` gave.
    pub fn keep(&self, job: usize, bytes: &[u8]) -> Result<()> {
        let mut record = Vec::with_capacity(HEAD + bytes.len());
        record.extend((job as u32).to_le_bytes());
        record.extend((bytes.len() as u32).to_le_bytes());
        record.extend(checksum(bytes).to_le_bytes());
        record.extend(bytes);
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(&record).map_err(failed(&self.path))
    }

    /// Removes the file.
    pub fn remove(self) -> Result<()> {
        fs::remove_file(&self.path).map_err(failed(&self.path))
    }
}

/// What tells studies apart: the seed and the sizes of their slabs.
fn head(seed: u64) -> Vec<u8> {
    let sizes = [
        samples::SLABS,
        samples::NUMBERS,
        walks::THICKNESSES,
        walks::SUNS,
        walks::PHOTONS,
        axes::THICKNESSES,
        axes::DEPTHS,
        axes::SUNS,
        moments::COEFFICIENTS,
    ];
    let mut head = MAGIC.to_vec();
    head.extend(seed.to_le_bytes());
    head.extend(sizes.iter().flat_map(|size| (*size as u64).to_le_bytes()));
    head
}

/// The whole records, and their length together.
fn read(bytes: &[u8]) -> (HashMap<usize, Vec<u8>>, usize) {
    let mut done = HashMap::new();
    let mut rest = bytes;
    while let Some((job, record, left)) = next(rest) {
        done.insert(job, record);
        rest = left;
    }
    (done, bytes.len() - rest.len())
}

fn next(bytes: &[u8]) -> Option<(usize, Vec<u8>, &[u8])> {
    let (job, rest) = bytes.split_first_chunk()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (sum, rest) = rest.split_first_chunk()?;
    let (record, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    let whole = checksum(record) == u64::from_le_bytes(*sum);
    whole.then(|| (u32::from_le_bytes(*job) as usize, record.to_vec(), rest))
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> Error {
    |source| Error::File { action: "write", path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_is_there_again_and_a_torn_end_is_not() {
        let path = std::env::temp_dir().join(format!("nephos-partial-{}", std::process::id()));
        let partial = Partial::open(&path, 7).unwrap();
        partial.keep(3, b"three").unwrap();
        partial.keep(1, b"one").unwrap();
        let length = fs::metadata(&path).unwrap().len();
        File::options().write(true).open(&path).unwrap().set_len(length - 1).unwrap();
        let again = Partial::open(&path, 7).unwrap();
        assert_eq!(again.record(3).as_deref(), Some(&b"three"[..]));
        assert_eq!(again.record(1), None, "torn");
        again.keep(1, b"once more").unwrap();
        let third = Partial::open(&path, 7).unwrap();
        assert_eq!(third.record(1).as_deref(), Some(&b"once more"[..]));
        let other = Partial::open(&path, 8).unwrap();
        assert_eq!(other.record(3), None, "another seed is another study");
        other.remove().unwrap();
        assert!(!path.exists());
    }
}
