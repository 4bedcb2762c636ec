//! Plays the attack of `casca-truth` by the bytes of the fuzzer: no set lacks an object that a ray reaches.
#![no_main]

use casca_truth::attack::play_bytes;
use libfuzzer_sys::fuzz_target;

/// Operations of one play, at most.
const OPS: usize = 300;

fuzz_target!(|bytes: &[u8]| {
    if let Err(report) = play_bytes(bytes, OPS) {
        panic!("{report}");
    }
});
