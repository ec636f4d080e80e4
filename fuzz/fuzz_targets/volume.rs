//! Any bytes are a volume or the rest of a sentence.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephos::import::{Choice, Raw, parse_volume};

fuzz_target!(|bytes: &[u8]| {
    let told = |read: Result<_, String>| assert!(read.map_or_else(|problem| !problem.is_empty(), |_: nephos::import::Grid| true));
    told(parse_volume(bytes, &Choice::default()));
    told(parse_volume(bytes, &Choice { grid: Some("density"), ..Choice::default() }));
    let raw = Raw { size: [4, 3, 2], big_endian: bytes.first() == Some(&1), voxel: [1.0; 3].into() };
    told(parse_volume(bytes, &Choice { raw: Some(raw), ..Choice::default() }));
});
