//! A hash of four numbers, by operations that shaders have.

/// Four well-mixed words of four: `pcg4d` of Jarzynski & Olano, "Hash Functions for GPU Rendering" (JCGT 9(3), 2020). Only products,
/// sums and shifts of 32-bit words that wrap around, so that shaders compute the same bits.
#[inline]
pub fn hash(words: [u32; 4]) -> [u32; 4] {
    let mut v = words.map(|w| w.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    mix(&mut v);
    v = v.map(|w| w ^ w >> 16);
    mix(&mut v);
    v
}

#[inline]
fn mix(v: &mut [u32; 4]) {
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
}

/// A word as a number from 0 to below 1, by its upper 24 bits: exact in single precision.
#[inline]
pub fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_pinned_and_even() {
        // Shaders must give the same bits.
        assert_eq!(hash([1, 2, 3, 4]), [908_250_390, 4_044_648_920, 3_775_961_919, 45_698_095]);
        assert_eq!((unit(0), unit(u32::MAX)), (0.0, 1.0 - 1.0 / 16_777_216.0));
    }

    #[test]
    fn each_word_is_even_and_no_two_depend() {
        let mut counts = [[0_u32; 16]; 4];
        let mut products = [0.0_f64; 6];
        let n = 32;
        for i in 0..n * n * n {
            let words = hash([i % n, i / n % n, i / n / n, 7]);
            let units = words.map(|w| f64::from(unit(w)) - 0.5);
            for (count, word) in counts.iter_mut().zip(words) {
                count[(word >> 28) as usize] += 1;
            }
            let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
            products.iter_mut().zip(pairs).for_each(|(sum, (a, b))| *sum += units[a] * units[b]);
        }
        let total = f64::from(n * n * n);
        let even = total / 16.0;
        for count in counts {
            // 15 degrees of freedom: above 50 once in 100,000 times.
            let chi2: f64 = count.iter().map(|&c| (f64::from(c) - even).powi(2) / even).sum();
            assert!(chi2 < 50.0, "{chi2}");
        }
        // The sum of n products of two even numbers has the deviation sqrt(n) / 12.
        assert!(products.iter().all(|p| p.abs() < 5.0 * total.sqrt() / 12.0), "{products:?}");
    }
}
