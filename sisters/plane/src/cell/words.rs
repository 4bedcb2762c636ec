//! Runs of bits in packed words.

/// The first bit from `from` on, before `end`, that differs from those of `flip`; `end` if there is
/// none.
fn next(words: &[u64], from: usize, end: usize, flip: u64) -> usize {
    let mut at = from / 64;
    if from >= end || at >= words.len() {
        return end;
    }
    let mut word = (words[at] ^ flip) & u64::MAX << (from % 64);
    while word == 0 {
        at += 1;
        if at >= words.len() || at * 64 >= end {
            return end;
        }
        word = words[at] ^ flip;
    }
    (at * 64 + word.trailing_zeros() as usize).min(end)
}

/// The runs of set bits between two places, the second not included: each with its first bit and
/// the one past its last.
pub(super) fn runs(words: &[u64], from: usize, end: usize) -> impl Iterator<Item = (usize, usize)> {
    let mut at = from;
    std::iter::from_fn(move || {
        let first = next(words, at, end, 0);
        at = next(words, first, end, u64::MAX);
        (first < end).then_some((first, at))
    })
}

/// The bits that are set.
pub(super) fn bits(words: impl Iterator<Item = u64>) -> impl Iterator<Item = usize> {
    words.enumerate().flat_map(|(i, word)| {
        let rest = |w: &u64| Some(*w & (*w - 1)).filter(|w| *w != 0);
        std::iter::successors(Some(word).filter(|w| *w != 0), rest)
            .map(move |w| 64 * i + w.trailing_zeros() as usize)
    })
}

/// Sets the bits from `from` to before `end`.
pub(super) fn set_run(words: &mut [u64], from: usize, end: usize) {
    for_run(words, from, end, |word, mask| *word |= mask);
}

/// Clears the bits from `from` to before `end`.
pub(super) fn clear_run(words: &mut [u64], from: usize, end: usize) {
    for_run(words, from, end, |word, mask| *word &= !mask);
}

fn for_run(words: &mut [u64], from: usize, end: usize, apply: impl Fn(&mut u64, u64)) {
    let end = end.min(words.len() * 64);
    if from >= end {
        return;
    }
    let (first, last) = (from / 64, (end - 1) / 64);
    let (head, tail) = (u64::MAX << (from % 64), u64::MAX >> (63 - (end - 1) % 64));
    if first == last {
        apply(&mut words[first], head & tail);
        return;
    }
    apply(&mut words[first], head);
    words[first + 1..last].iter_mut().for_each(|word| apply(word, u64::MAX));
    apply(&mut words[last], tail);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_agree_with_single_bits() {
        let mut words = vec![0u64; 4];
        set_run(&mut words, 3, 200);
        clear_run(&mut words, 60, 130);
        set_run(&mut words, 250, 999);
        set_run(&mut words, 9, 9);
        assert_eq!(runs(&words, 0, 256).collect::<Vec<_>>(), [(3, 60), (130, 200), (250, 256)]);
        assert_eq!(runs(&words, 5, 150).collect::<Vec<_>>(), [(5, 60), (130, 150)]);
        assert_eq!(runs(&words, 70, 90).count(), 0);
        let single: Vec<_> = (0..256).filter(|&i| words[i / 64] >> (i % 64) & 1 == 1).collect();
        assert_eq!(bits(words.iter().copied()).collect::<Vec<_>>(), single);
        assert_eq!(single.len(), 57 + 70 + 6);
    }
}
