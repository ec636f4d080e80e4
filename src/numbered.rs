//! Names of numbered files, such as `storm.####.vdb`: of frames that are written, and of steps that are read.

#[cfg(unix)]
use std::ffi::OsStr;
use std::{
    ffi::OsString,
    fs, io,
    path::{Path, PathBuf},
};

/// Most digits that a name may ask for by a number of its own.
const MOST_DIGITS: usize = 32;

/// The name of a file, with a place where a number goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    folder: PathBuf,
    before: OsString,
    digits: usize,
    after: OsString,
}

/// Why a name is no pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unfit {
    /// It has no place for a number.
    NoPlace,
    /// It has two.
    TwoPlaces,
}

impl Pattern {
    /// Reads `path`, such as `out/frame.####.exr`: `%04d` and `$F4` stand for the number, too.
    pub fn of(path: &Path) -> Result<Self, Unfit> {
        let name = path.file_name().unwrap_or_default().as_encoded_bytes();
        let (start, end, digits) = place(name, 0).ok_or(Unfit::NoPlace)?;
        if place(name, end).is_some() {
            return Err(Unfit::TwoPlaces);
        }
        Ok(Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            before: part(&name[..start]),
            digits,
            after: part(&name[end..]),
        })
    }

    /// The file of `number`.
    pub fn file(&self, number: i32) -> PathBuf {
        let mut name = self.before.clone();
        name.push(format!("{number:0digits$}", digits = self.digits));
        name.push(&self.after);
        self.folder.join(name)
    }

    /// The numbers of the files that there are, least first.
    ///
    /// # Errors
    /// Where its folder can't be read.
    pub fn numbers(&self) -> io::Result<Vec<i32>> {
        let folder = if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder };
        let names = fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.file_name()));
        let names = names.collect::<io::Result<Vec<_>>>()?;
        let mut numbers: Vec<i32> =
            names.iter().filter_map(|name| self.number(name.as_encoded_bytes())).collect();
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// The number in a name that this pattern would give it.
    fn number(&self, name: &[u8]) -> Option<i32> {
        let middle = name.strip_prefix(self.before.as_encoded_bytes())?;
        let digits = str::from_utf8(middle.strip_suffix(self.after.as_encoded_bytes())?).ok()?;
        let number: i32 = digits.parse().ok()?;
        (format!("{number:0width$}", width = self.digits) == digits).then_some(number)
    }
}

/// What a file is called without its ending and, in a pattern, without the place of its number.
#[cfg(any(feature = "cli", feature = "editor"))]
pub fn stem(path: &Path) -> String {
    let before = Pattern::of(path).ok().map(|pattern| pattern.before.to_string_lossy().into_owned());
    let before = before.map(|before| before.trim_end_matches(['.', '_', '-']).to_owned());
    let whole = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    before.filter(|before| !before.is_empty()).unwrap_or_else(whole)
}

/// The pattern, as text, of the files beside `path` that are numbered as it is, where there are others: of
/// `storm.0007.vdb` that is `storm.####.vdb`.
#[cfg(feature = "editor")]
pub fn siblings(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str()?;
    let (before, digits) = stem.split_at(stem.trim_end_matches(|c: char| c.is_ascii_digit()).len());
    if digits.is_empty() || digits.len() > MOST_DIGITS {
        return None;
    }
    let ending = path.extension()?.to_str()?;
    // Numbers of one length may have zeros before them.
    let pattern = path.with_file_name(format!("{before}{}.{ending}", "#".repeat(digits.len())));
    let others = Pattern::of(&pattern).ok()?.numbers().ok()?;
    (others.len() > 1).then_some(pattern)
}

/// The first place for a number from `from` on: where it begins and ends, and its digits. Hashes, as printf
/// has it (`%04d`), or as Houdini has it (`$F4`).
fn place(name: &[u8], from: usize) -> Option<(usize, usize, usize)> {
    (from..name.len()).find_map(|start| {
        let rest = &name[start + 1..];
        let digits = |bytes: &[u8]| bytes.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = |bytes: &[u8]| match str::from_utf8(bytes) {
            Ok("") => Some(1),
            text => text.ok()?.parse().ok().filter(|digits| *digits <= MOST_DIGITS),
        };
        match name[start] {
            b'#' => {
                let more = rest.iter().take_while(|byte| **byte == b'#').count();
                Some((start, start + 1 + more, 1 + more))
            }
            b'%' => {
                let count = digits(rest);
                let is_number = rest.get(count) == Some(&b'd');
                Some((start, start + 2 + count, number(&rest[..count]).filter(|_| is_number)?))
            }
            b'$' if rest.first() == Some(&b'F') => {
                let count = digits(&rest[1..]);
                let ends = !rest.get(1 + count).is_some_and(u8::is_ascii_alphanumeric);
                Some((start, start + 2 + count, number(&rest[1..=count]).filter(|_| ends)?))
            }
            _ => None,
        }
    })
}

/// A part of a name, which need be no UTF-8 where the system has it so.
#[cfg(unix)]
fn part(bytes: &[u8]) -> OsString {
    <OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(bytes).to_owned()
}

/// A part of a name.
#[cfg(not(unix))]
fn part(bytes: &[u8]) -> OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_become_the_number() {
        let file = |text: &str, number| Pattern::of(Path::new(text)).map(|p| p.file(number)).ok();
        assert_eq!(file("out/a.####.exr", 7), Some("out/a.0007.exr".into()));
        assert_eq!(file("a#.png", 123), Some("a123.png".into()));
        assert_eq!(file("a.png", 1), None);
        assert_eq!(file("a#b#.png", 1), None);
        assert_eq!(file("out/a.%04d.exr", 7), Some("out/a.0007.exr".into()));
        assert_eq!(file("a%d.png", 12345), Some("a12345.png".into()));
        assert_eq!(file("a.$F4.exr", 7), Some("a.0007.exr".into()));
        assert_eq!(file("a_$F_b.exr", 7), Some("a_7_b.exr".into()));
        assert_eq!(file("a.####.exr", -7), Some("a.-007.exr".into()));
        assert_eq!(file("50%.$FF.##.png", 7), Some("50%.$FF.07.png".into()));
        for bad in ["a.%04d.##.exr", "a%f.png", "a$G4.png", "%99999999999d.png", "a%"] {
            assert_eq!(file(bad, 1), None, "{bad}");
        }
        let (long, short) = ("#".repeat(40), "#".repeat(32));
        assert_eq!(
            (file(&long, 1), file(&short, 1)),
            (Some(format!("{:040}", 1).into()), Some(format!("{:032}", 1).into()))
        );
    }

    #[test]
    fn files_that_are_numbered_otherwise_are_none_of_a_pattern() {
        let folder = tempfile::tempdir().unwrap();
        let names = [
            "a.0003.vdb",
            "a.-001.vdb",
            "a.12345.vdb",
            "a.0010.vdb",
            "a.7.vdb",
            "a.0004.vol",
            "b.0005.vdb",
            "a.00x1.vdb",
        ];
        for name in names {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let numbers = |name: &str| Pattern::of(&folder.path().join(name)).unwrap().numbers().unwrap();
        assert_eq!(numbers("a.####.vdb"), [-1, 3, 10, 12345]);
        assert_eq!(numbers("a.$F.vdb"), [7, 12345]);
        assert!(numbers("c.####.vdb").is_empty());
        assert!(Pattern::of(&folder.path().join("none/a.#.vdb")).unwrap().numbers().is_err());
    }

    #[cfg(feature = "editor")]
    #[test]
    fn one_of_several_numbered_files_tells_their_pattern() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.0003.vdb", "a.0010.vdb", "alone7.vdb", "plain.vdb"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let of = |name: &str| siblings(&folder.path().join(name));
        assert_eq!(of("a.0003.vdb"), Some(folder.path().join("a.####.vdb")));
        assert_eq!((of("alone7.vdb"), of("plain.vdb")), (None, None));
        let names = ["b/a.####.vdb", "a_%04d.vdb", "####.vdb", "a.b.vdb"].map(|name| stem(Path::new(name)));
        assert_eq!(names, ["a", "a", "####", "a.b"]);
    }
}
