//! Files of tables: little-endian numbers between magic bytes and a checksum.

use half::f16;

/// The bytes with their checksum after them.
pub(super) fn seal(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(checksum(&bytes).to_le_bytes());
    bytes
}

/// The bytes of a file without its checksum, if they begin with `magic` and add up.
pub(super) fn whole<'a>(bytes: &'a [u8], magic: &[u8; 8]) -> Result<&'a [u8], String> {
    if !bytes.starts_with(magic) {
        return Err(format!("does not begin with \"{}\"", magic.escape_ascii()));
    }
    let (content, stored) = bytes.split_last_chunk().ok_or("has no checksum")?;
    let (stored, computed) = (u64::from_le_bytes(*stored), checksum(content));
    if stored != computed {
        return Err(format!("is damaged: its checksum is {stored:016x}, not {computed:016x}"));
    }
    Ok(content)
}

/// FNV-1a, 64 bit: Fowler, Noll and Vo, offset basis and prime as in RFC 9923.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// What is left to read; `None` at its end.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    pub fn f16(&mut self) -> Option<f16> {
        self.take().map(f16::from_le_bytes)
    }

    /// As many bytes as a number before them says, as text.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()? as usize;
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        std::str::from_utf8(text).ok()
    }
}
