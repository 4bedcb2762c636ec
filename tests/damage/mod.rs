//! Files that were damaged, made from valid ones; and the limits that readers must keep on them.
//!
//! The crates that read files include this in a test of their own, for an allocator counts all of a
//! process.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

use std::time::{Duration, Instant};

use peak_alloc::PeakAlloc;

/// Bytes that a reader may have in use at once for a file of some kilobytes.
pub const MOST_BYTES: usize = 256 << 20;
/// The time that a reader may take for such a file.
const MOST_TIME: Duration = Duration::from_secs(20);
/// Repeated parts make no file longer than this.
const LONGEST: usize = 1 << 20;

/// Numbers that break sums, products and casts.
#[rustfmt::skip]
const EXTREMES: [u64; 14] = [
    0, 1, 0x7f, 0xff, 0x7fff, 0xffff, 0x0100_0000, 0x7fff_ffff, 0x8000_0000,
    0xffff_ffff, 0x1_0000_0000, 0x0fff_ffff_ffff_ffff, 0x7fff_ffff_ffff_ffff, u64::MAX,
];

/// The same in texts.
#[rustfmt::skip]
const WORDS: [&str; 14] = [
    "0", "-1", "1", "65536", "1000000", "16777216", "2147483647",
    "4294967295", "4294967296", "99999999999999", "9223372036854775807", "18446744073709551615", "1e308", "nan",
];

/// Numbers that look random, the same in every run (SplitMix64; Steele et al. 2014).
pub fn numbers(mut state: u64) -> impl FnMut() -> u64 {
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let a = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let b = (a ^ (a >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        b ^ (b >> 31)
    }
}

/// A number below `end`; 0 if there is none.
fn below(end: usize, next: &mut dyn FnMut() -> u64) -> usize {
    (next() % end.max(1) as u64) as usize
}

/// A file with one to four damages. `next` decides which; `others` are files that parts are taken
/// from.
pub fn damaged(whole: &[u8], others: &[Vec<u8>], next: &mut dyn FnMut() -> u64) -> Vec<u8> {
    let mut file = whole.to_vec();
    for _ in 0..=below(4, next) {
        let at = below(file.len(), next);
        // Short parts are fields, long ones sections.
        let length = 1 + below([4, 16, 64, 1024][below(4, next)], next);
        let end = (at + length).min(file.len());
        match below(12, next) {
            0 | 1 => {
                let bit = 1 << below(8, next);
                file.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= bit);
            }
            2..=4 => put(&mut file, at, next),
            5 => file.truncate(at),
            6 if !others.is_empty() => {
                let other = &others[below(others.len(), next)];
                let from = below(other.len(), next);
                let part = other[from..].iter().take(length).copied();
                file.splice(at..end, part);
            }
            7 => drop(file.drain(at..end)),
            8 => {
                let times = 1 << below(14, next);
                let part = file[at..end].repeat(times.min(LONGEST / length));
                file.splice(at..at, part);
            }
            _ => reword(&mut file, next),
        }
    }
    file.truncate(LONGEST + whole.len());
    file
}

/// Puts an extreme number over a field of 2, 4 or 8 bytes.
fn put(file: &mut [u8], at: usize, next: &mut dyn FnMut() -> u64) {
    let number = EXTREMES[below(EXTREMES.len(), next)].wrapping_sub(next() % 2);
    let width = [2, 4, 8][below(3, next)];
    let mut bytes = number.to_le_bytes();
    if next().is_multiple_of(4) {
        bytes[..width].reverse();
    }
    // Most fields are aligned in their files.
    let at = if next().is_multiple_of(2) { at } else { at - at % width };
    file.iter_mut().skip(at).zip(&bytes[..width]).for_each(|(to, from)| *to = *from);
}

/// Puts another number in the place of one that is text.
fn reword(file: &mut Vec<u8>, next: &mut dyn FnMut() -> u64) {
    let is_number = |i: usize| file[i].is_ascii_digit();
    let starts: Vec<usize> =
        (0..file.len()).filter(|&i| is_number(i) && (i == 0 || !is_number(i - 1))).collect();
    let Some(&start) = starts.get(below(starts.len(), next)) else { return };
    let end = (start..file.len()).find(|&i| !is_number(i)).unwrap_or(file.len());
    let word = WORDS[below(WORDS.len(), next)];
    file.splice(start..end, word.bytes());
}

/// Says which case a panic comes from.
struct Case<'a>(&'a str, u64, u64);

impl Drop for Case<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let Self(name, seed, number) = self;
            println!("{name}: case {number} of the seed {seed}");
        }
    }
}

/// Reads one file, and fails if that takes too much memory or time. Memory that was in use before
/// does not count.
pub fn check(heap: &PeakAlloc, name: &str, file: &[u8], read: &mut dyn FnMut(&[u8])) {
    heap.reset_peak_usage();
    let (before, start) = (heap.current_usage(), Instant::now());
    read(file);
    let (bytes, time) = (heap.peak_usage().saturating_sub(before), start.elapsed());
    assert!(bytes <= MOST_BYTES, "{name}: {bytes} bytes in use for a file of {}", file.len());
    assert!(time <= MOST_TIME, "{name}: {time:?} for a file of {} bytes", file.len());
}

/// Reads files as they are and damaged ones. `mend` sets checksums and lengths right in half of the
/// damaged ones. `CASCA_CASES` multiplies their number, `CASCA_SEED` gives others.
pub fn survive(
    heap: &PeakAlloc,
    name: &str,
    files: &[Vec<u8>],
    cases: u64,
    mend: &dyn Fn(&mut Vec<u8>),
    read: &mut dyn FnMut(&[u8]),
) {
    let variable = |name| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok()).unwrap_or(1);
    let (factor, seed) = (variable("CASCA_CASES"), variable("CASCA_SEED"));
    for file in files {
        check(heap, name, file, read);
    }
    for number in 0..cases.saturating_mul(factor) {
        let _case = Case(name, seed, number);
        let mut next = numbers(seed.rotate_left(32) ^ number);
        let mut file = damaged(&files[below(files.len(), &mut next)], files, &mut next);
        if next().is_multiple_of(2) {
            mend(&mut file);
        }
        check(heap, name, &file, read);
    }
}
