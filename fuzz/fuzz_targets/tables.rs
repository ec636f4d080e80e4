//! Any bytes are a table or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephos::tables::{Grids, MieTables};

fuzz_target!(|bytes: &[u8]| {
    let _ = Grids::decode("fuzzed", bytes);
    let _ = MieTables::decode(bytes);
});
