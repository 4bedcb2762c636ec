//! Images of light as KTX 2 files, in the format RGB9E5: three channels of nine bits with a common
//! exponent, which each graphics processor filters. A zero stays zero.

use glam::Vec3;

/// What files start with.
const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// `VK_FORMAT_E5B9G9R9_UFLOAT_PACK32`.
const FORMAT: u32 = 123;
/// Bits of a channel, and what is added to exponents.
const BITS: i32 = 9;
const BIAS: i32 = 15;
/// The brightest light of a channel.
const BRIGHTEST: f32 = 65408.0;

/// A colour in 32 bits. What is no number or less than 0 becomes 0; the greatest channel errs by 1 in
/// 512 at most, and others by as much.
pub fn packed(color: Vec3) -> u32 {
    // Not so for what is no number.
    let channels = color.to_array().map(|c| if c > 0.0 { c.min(BRIGHTEST) } else { 0.0 });
    let most = channels.into_iter().fold(0.0, f32::max);
    // Whole exponents, as bits say them: logarithms round.
    let exponent = |x: f32| (((x.to_bits() >> 23) as i32 - 127) + 1 + BIAS).max(0);
    let steps = |x: f32, exponent: i32| (x * 2f32.powi(BITS + BIAS - exponent)).round() as u32;
    let mut shared = exponent(most);
    if steps(most, shared) == 1 << BITS {
        shared += 1;
    }
    let [r, g, b] = channels.map(|c| steps(c, shared));
    r | (g << 9) | (b << 18) | ((shared as u32) << 27)
}

/// The colour that 32 bits stand for.
pub fn unpacked(bits: u32) -> Vec3 {
    let scale = 2f32.powi((bits >> 27) as i32 - BIAS - BITS);
    Vec3::from_array([0, 9, 18].map(|shift| ((bits >> shift) & 0x1ff) as f32 * scale))
}

/// A file of texels, row by row from the top, and slice by slice if there is a depth.
pub(crate) fn file([width, height, depth]: [u32; 3], texels: &[Vec3]) -> Vec<u8> {
    const INDEX: u32 = 80 + 24;
    const BLOCK: u32 = 24 + 6 * 16;
    let length = 4 * texels.len() as u64;
    let mut words = vec![FORMAT, 4, width, height, depth, 0, 1, 1, 0];
    // The description of the format, and nothing else, stands between the index and the texels.
    words.extend([INDEX, 4 + BLOCK, 0, 0, 0, 0, 0, 0]);
    let start = u64::from(INDEX + 4 + BLOCK);
    for number in [start, length, length] {
        words.extend([number as u32, (number >> 32) as u32]);
    }
    // A basic block of version 2: linear light of the primaries of sRGB, four bytes a texel.
    words.extend([4 + BLOCK, 0, 2 | (BLOCK << 16), 1 | (1 << 8) | (1 << 16), 0, 4, 0]);
    for channel in 0..3 {
        // Its nine bits, and the five of the exponent; 8448 as the specification of descriptions has it.
        words.extend([(9 * channel) | (8 << 16) | (channel << 24), 0, 0, 8448]);
        words.extend([27 | (4 << 16) | ((channel | 0x20) << 24), 0, BIAS as u32, 31]);
    }
    words.extend(texels.iter().map(|t| packed(*t)));
    MAGIC.into_iter().chain(words.into_iter().flat_map(u32::to_le_bytes)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_err_by_half_a_step_and_zero_and_nonsense_are_black() {
        const RAMP: (f32, f32) = (1e-3, 1.0045); // From a dark room to beyond the brightest value.
        for i in 0..4000 {
            let most = RAMP.0 * RAMP.1.powi(i % 3900);
            let color = Vec3::new(most, most * (i % 7) as f32 / 7.0, most * (i % 11) as f32 / 11.0);
            let error = (unpacked(packed(color)) - color).abs().max_element();
            assert!(error <= most / 512.0, "{color}: {error}");
        }
        for (color, wanted) in [
            (Vec3::ZERO, Vec3::ZERO),
            (Vec3::new(f32::NAN, -1.0, 1.0), Vec3::Z),
            (Vec3::INFINITY, Vec3::splat(BRIGHTEST)),
            (Vec3::splat(f32::MIN_POSITIVE), Vec3::ZERO),
        ] {
            assert_eq!(unpacked(packed(color)), wanted);
        }
    }
}
