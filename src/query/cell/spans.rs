//! Runs of bits in slices of words.

/// The first clear bit in `from..end`, or `end`.
#[inline]
pub(super) fn next_clear(bits: &[u64], from: usize, end: usize) -> usize {
    scan(bits, from, end, u64::MAX)
}

#[inline]
fn scan(bits: &[u64], from: usize, end: usize, flip: u64) -> usize {
    if from >= end {
        return end;
    }
    let mut i = from / 64;
    let mut word = (bits[i] ^ flip) & (u64::MAX << (from % 64));
    let last = (end - 1) / 64;
    while word == 0 {
        if i == last {
            return end;
        }
        i += 1;
        word = bits[i] ^ flip;
    }
    (i * 64 + word.trailing_zeros() as usize).min(end)
}

/// Calls `run` with the runs of set, or of clear bits in `from..end`.
#[inline]
pub(super) fn for_runs(bits: &[u64], set: bool, from: usize, end: usize, mut run: impl FnMut(usize, usize)) {
    let (mut from, flip) = (from, if set { 0 } else { u64::MAX });
    while from < end {
        let start = scan(bits, from, end, flip);
        from = scan(bits, start, end, !flip);
        if start < from {
            run(start, from);
        }
    }
}

/// Sets the bits `from..to`.
#[inline]
pub(super) fn set_span(bits: &mut [u64], from: usize, to: usize) {
    for_span(bits, from, to, |word, mask| *word |= mask);
}

/// Clears the bits `from..to`.
#[inline]
pub(super) fn clear_span(bits: &mut [u64], from: usize, to: usize) {
    for_span(bits, from, to, |word, mask| *word &= !mask);
}

#[inline]
fn for_span(bits: &mut [u64], from: usize, to: usize, apply: impl Fn(&mut u64, u64)) {
    if from >= to {
        return;
    }
    let (a, b) = (from / 64, (to - 1) / 64);
    let (head, tail) = (u64::MAX << (from % 64), u64::MAX >> (63 - (to - 1) % 64));
    if a == b {
        apply(&mut bits[a], head & tail);
        return;
    }
    apply(&mut bits[a], head);
    bits[a + 1..b].iter_mut().for_each(|w| apply(w, u64::MAX));
    apply(&mut bits[b], tail);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans() {
        let mut bits = vec![0u64; 4];
        set_span(&mut bits, 3, 200);
        clear_span(&mut bits, 60, 130);
        assert_eq!(bits.iter().map(|w| w.count_ones()).sum::<u32>(), 197 - 70);
        let mut runs = Vec::new();
        for_runs(&bits, true, 0, 256, |from, to| runs.push((from, to)));
        for_runs(&bits, false, 2, 150, |from, to| runs.push((from, to)));
        assert_eq!(runs, [(3, 60), (130, 200), (2, 3), (60, 130)]);
        assert_eq!(next_clear(&bits, 3, 256), 60);
        assert_eq!(next_clear(&bits, 130, 150), 150);
    }
}
