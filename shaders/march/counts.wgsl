// What `--stats` counts: work of one thread, compiled out where nobody asks.

override COUNTING: bool = false;

const RAYS: u32 = 0u;
const HITS: u32 = 1u;
const STEPS: u32 = 2u;
const DENSITY: u32 = 3u;
const NOISE_READS: u32 = 4u;
const MAP_READS: u32 = 5u;
const ELLIPSOIDS: u32 = 6u;
// Reads of a baked volume of depths, and of its index.
const VOLUME_READS: u32 = 7u;
const COUNTERS: u32 = 8u;
var<private> counts: array<u32, COUNTERS>;

fn count(what: u32, amount: u32) {
    if COUNTING {
        counts[what] += amount;
    }
}
