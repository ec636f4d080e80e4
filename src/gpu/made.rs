//! What was made on the device so far, so that tests and benchmarks can hold frames to making nothing anew.

use std::{cell::Cell, ops::Sub};

/// How many things were made and uploads asked for by this thread, on whatever device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Made {
    /// Buffers.
    pub buffers: u64,
    /// Textures.
    pub textures: u64,
    /// Bind groups.
    pub groups: u64,
    /// Pipelines.
    pub pipelines: u64,
    /// Writes into buffers that are kept.
    pub writes: u64,
}

thread_local! {
    static MADE: Cell<Made> = const { Cell::new(Made { buffers: 0, textures: 0, groups: 0, pipelines: 0, writes: 0 }) };
}

impl Made {
    /// What this thread has made so far.
    pub fn so_far() -> Self {
        MADE.get()
    }

    /// Counts one more of what `count` is.
    pub(crate) fn one(count: fn(&mut Self) -> &mut u64) {
        let mut made = MADE.get();
        *count(&mut made) += 1;
        MADE.set(made);
    }
}

impl Sub for Made {
    type Output = Self;

    /// What was made since `earlier`.
    fn sub(self, earlier: Self) -> Self {
        Self {
            buffers: self.buffers - earlier.buffers,
            textures: self.textures - earlier.textures,
            groups: self.groups - earlier.groups,
            pipelines: self.pipelines - earlier.pipelines,
            writes: self.writes - earlier.writes,
        }
    }
}
