//! A hash of four numbers, by operations that shaders have.

/// Four well-mixed words of four: `pcg4d` of Jarzynski & Olano, "Hash Functions for GPU Rendering"
/// (JCGT 9(3), 2020). Only products, sums and shifts of 32-bit words that wrap around, so that
/// shaders compute the same bits.
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
    fn words_are_pinned_even_and_independent() {
        // Shaders must give the same bits.
        assert_eq!(hash([1, 2, 3, 4]), [908_250_390, 4_044_648_920, 3_775_961_919, 45_698_095]);
        assert_eq!((unit(0), unit(u32::MAX)), (0.0, 1.0 - 1.0 / 16_777_216.0));
        let (mut counts, mut products, n) = ([[0_u32; 16]; 4], [0.0_f64; 4], 32_u32);
        for i in 0..n.pow(3) {
            let words = hash([i % n, i / n % n, i / n / n, 7]);
            let units = words.map(|w| f64::from(unit(w)) - 0.5);
            for k in 0..4 {
                counts[k][(words[k] >> 28) as usize] += 1;
                products[k] += units[k] * units[(k + 1) % 4];
            }
        }
        let (total, even) = (f64::from(n.pow(3)), f64::from(n.pow(3)) / 16.0);
        // 15 degrees of freedom: above 50 once in 100,000 times. A sum of n products has the
        // deviation sqrt(n) / 12.
        let chi2 = counts.map(|c| c.map(|c| (f64::from(c) - even).powi(2) / even).iter().sum::<f64>());
        assert!(
            chi2.iter().all(|&c| c < 50.0) && products.iter().all(|p| p.abs() < 5.0 * total.sqrt() / 12.0)
        );
    }
}
