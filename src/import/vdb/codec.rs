//! Values as OpenVDB packs them: only those that differ, as half floats or not, by zip or Blosc.

use std::io::Read;

use flate2::read::ZlibDecoder;
use half::f16;

use super::super::bytes::{Bytes, Problem};
use crate::vdb::{ACTIVE_MASK, BLOSC, ONLY_ACTIVE, ZIP};

/// Version from which arrays tell which values they leave out.
pub(super) const NODE_MASKS: u32 = 222;

/// How an array of values tells which of them are there, beyond [`ONLY_ACTIVE`]: inactive ones are the background
/// negated, or one value, or two by a mask; or all are there.
const ONE_INACTIVE: u8 = 2;
const MASK: u8 = 3;
const MASK_AND_ONE: u8 = 4;
const MASK_AND_TWO: u8 = 5;
const ALL: u8 = 6;

/// Kinds of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Half,
    Float,
    Double,
}

/// A value in a file: a number, or one of the three of a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Number {
    pub kind: Kind,
    /// How many there are together, and which one is read.
    pub lanes: usize,
    pub lane: usize,
}

impl Number {
    /// One by itself.
    pub const fn of(kind: Kind) -> Self {
        Self { kind, lanes: 1, lane: 0 }
    }

    fn bytes(self) -> usize {
        self.lanes * self.kind.bytes()
    }

    fn in_bytes(self, bytes: &[u8]) -> f32 {
        self.kind.number(bytes.get(self.lane * self.kind.bytes()..).unwrap_or_default())
    }

    /// One of them.
    pub fn read(self, bytes: &mut Bytes<'_>) -> Result<f32, Problem> {
        Ok(self.in_bytes(bytes.take(self.bytes())?))
    }
}

impl Kind {
    fn bytes(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn number(self, bytes: &[u8]) -> f32 {
        let at = |i: usize| bytes.get(i).copied().unwrap_or_default();
        match self {
            Self::Half => f16::from_le_bytes([at(0), at(1)]).to_f32(),
            Self::Float => f32::from_le_bytes([0, 1, 2, 3].map(at)),
            Self::Double => f64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(at)) as f32,
        }
    }
}

/// How the values of a grid are written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packing {
    pub version: u32,
    pub compression: u32,
    /// Numbers of the tree, and those that arrays hold in their place.
    pub number: Number,
    pub packed: Number,
    pub background: f32,
}

/// Whether a bit of a mask is set.
pub(super) fn is_on(mask: &[u8], i: usize) -> bool {
    mask.get(i / 8).is_some_and(|byte| byte >> (i % 8) & 1 == 1)
}

impl Packing {
    /// The next array of `count` values, of which `active` tells by bits which are active.
    pub fn values(&self, bytes: &mut Bytes<'_>, count: usize, active: &[u8]) -> Result<Vec<f32>, Problem> {
        let told = if self.version >= NODE_MASKS { bytes.byte()? } else { ALL };
        if told > ALL {
            return Err(format!("has values of an unknown kind ({told}): it is damaged; export it again"));
        }
        let mut first = if told == ONLY_ACTIVE { self.background } else { -self.background };
        let mut second = self.background;
        if matches!(told, ONE_INACTIVE | MASK_AND_ONE | MASK_AND_TWO) {
            first = self.number.read(bytes)?;
            if told == MASK_AND_TWO {
                second = self.number.read(bytes)?;
            }
        }
        let choice =
            if matches!(told, MASK | MASK_AND_ONE | MASK_AND_TWO) { bytes.take(active.len())? } else { &[] };
        let is_short = self.compression & ACTIVE_MASK != 0 && told != ALL;
        if !is_short {
            return self.array(bytes, count);
        }
        let some = self.array(bytes, (0..count).filter(|i| is_on(active, *i)).count())?;
        let mut some = some.into_iter();
        let inactive = |i: usize| if is_on(choice, i) { second } else { first };
        let value = |i: usize| if is_on(active, i) { some.next().unwrap_or_default() } else { inactive(i) };
        Ok((0..count).map(value).collect())
    }

    /// `count` numbers, unpacked.
    fn array(&self, bytes: &mut Bytes<'_>, count: usize) -> Result<Vec<f32>, Problem> {
        // Nothing is written for no half floats.
        if count == 0 && self.packed != self.number {
            return Ok(Vec::new());
        }
        let width = self.packed.bytes();
        let size = count * width;
        let numbers =
            |raw: &[u8]| raw.chunks_exact(width).map(|number| self.packed.in_bytes(number)).collect();
        if self.compression & (ZIP | BLOSC) == 0 {
            return bytes.take(size).map(numbers);
        }
        let packed = bytes.i64()?;
        // What does not get smaller is left as it is, which a negative size tells.
        if packed <= 0 {
            let raw = bytes.take(usize::try_from(packed.unsigned_abs()).unwrap_or(usize::MAX))?;
            return if raw.len() == size { Ok(numbers(raw)) } else { Err(wrong_size(raw.len(), size)) };
        }
        let packed = bytes.take(usize::try_from(packed).unwrap_or(usize::MAX))?;
        let raw = if self.compression & BLOSC != 0 { blosc(packed, size)? } else { unzipped(packed, size)? };
        Ok(numbers(&raw))
    }
}

fn wrong_size(found: usize, expected: usize) -> Problem {
    format!(
        "is damaged: {found} bytes of values are not the {expected} that there should be; export it again"
    )
}

/// Zip: just `size` bytes.
fn unzipped(packed: &[u8], size: usize) -> Result<Vec<u8>, Problem> {
    let mut raw = Vec::with_capacity(size);
    let read = ZlibDecoder::new(packed).take(size as u64 + 1).read_to_end(&mut raw);
    match read {
        Ok(_) if raw.len() == size => Ok(raw),
        Ok(_) => Err(wrong_size(raw.len(), size)),
        Err(error) => Err(format!("is damaged: values do not unzip ({error}); export it again")),
    }
}

/// Flags of a Blosc buffer: bytes of numbers are shuffled; it is a copy; their bits are; a block is one stream.
const SHUFFLED: u8 = 1;
const COPIED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const ONE_STREAM: u8 = 16;
/// Codecs, in the three highest bits.
const CODECS: [&str; 5] = ["BloscLZ", "LZ4", "Snappy", "Zlib", "Zstandard"];
/// Fewest bytes of a stream where blocks are split, and most streams.
const LEAST_SPLIT: usize = 128;
const MOST_SPLIT: usize = 16;

/// A buffer of Blosc 1 (`README_CHUNK_FORMAT.rst` of c-blosc): a head of 16 bytes, where blocks begin, and blocks of
/// as many streams as numbers have bytes.
fn blosc(packed: &[u8], size: usize) -> Result<Vec<u8>, Problem> {
    let mut head = Bytes::new(packed);
    let [version, _, flags, width] = [head.byte()?, head.byte()?, head.byte()?, head.byte()?];
    let (raw_size, block, _) = (head.u32()? as usize, head.u32()? as usize, head.u32()?);
    if version != 2 || raw_size != size || (block == 0 && size > 0) || width == 0 {
        return Err(wrong_size(raw_size, size));
    }
    if flags & COPIED != 0 {
        return head.take(size).map(<[u8]>::to_vec);
    }
    if flags & BITS_SHUFFLED != 0 {
        return Err(other_codec("shuffled bits"));
    }
    let codec = CODECS.get(usize::from(flags >> 5)).copied().unwrap_or("another codec");
    if !matches!(codec, "LZ4" | "Zlib") {
        return Err(other_codec(codec));
    }
    let width = usize::from(width);
    let mut raw = Vec::with_capacity(size);
    for number in 0..size.div_ceil(block.max(1)) {
        let begin = head.u32()?;
        let length = block.min(size - number * block);
        let mut stream = Bytes::new(packed);
        stream.seek(begin.into())?;
        let splits =
            flags & ONE_STREAM == 0 && length == block && width <= MOST_SPLIT && block / width >= LEAST_SPLIT;
        let count = if splits { width } else { 1 };
        let mut shuffled = Vec::with_capacity(length);
        for _ in 0..count {
            let part = stream.i32()?;
            let part = stream.take(usize::try_from(part).unwrap_or(usize::MAX))?;
            shuffled.extend(unpacked(codec, part, length / count)?);
        }
        let is_shuffled = flags & SHUFFLED != 0 && width > 1;
        raw.extend(if is_shuffled { in_order(&shuffled, width) } else { shuffled });
    }
    if raw.len() == size { Ok(raw) } else { Err(wrong_size(raw.len(), size)) }
}

fn other_codec(name: &str) -> Problem {
    format!(
        "is packed by Blosc with {name}, which is not read: save it with zip or Blosc's LZ4, as OpenVDB does"
    )
}

/// A stream of `size` bytes.
fn unpacked(codec: &str, packed: &[u8], size: usize) -> Result<Vec<u8>, Problem> {
    if packed.len() == size {
        return Ok(packed.to_vec());
    }
    if codec == "Zlib" {
        return unzipped(packed, size);
    }
    let mut raw = vec![0; size];
    match lz4_flex::block::decompress_into(packed, &mut raw) {
        Ok(found) if found == size => Ok(raw),
        Ok(found) => Err(wrong_size(found, size)),
        Err(error) => Err(format!("is damaged: values do not unpack ({error}); export it again")),
    }
}

/// Numbers of `width` bytes, of which first all first bytes came, then all second ones. What is left over is as it was.
fn in_order(shuffled: &[u8], width: usize) -> Vec<u8> {
    let count = shuffled.len() / width;
    let whole = count * width;
    let byte = |i: usize| shuffled[(i % width) * count + i / width];
    (0..whole).map(byte).chain(shuffled[whole..].iter().copied()).collect()
}
