//! Pictures of four bytes a pixel: their sizes on command lines, their halves, and PNG files.

use std::fs::File;
use std::io::BufWriter;
use std::ops::RangeInclusive;
use std::path::Path;

use crate::command_line::PathError;

/// The size of a picture on a command line, such as `1280x720`: width and height in pixels, each
/// within `sides`.
///
/// # Errors
/// Says what is expected.
pub fn parse_size(text: &str, sides: RangeInclusive<u32>) -> Result<(u32, u32), String> {
    let (width, height) = text.split_once('x').ok_or("expected a size such as 1280x720")?;
    let pixels = |n: &str| {
        let found = n.parse::<u32>().ok().filter(|n| sides.contains(n));
        found.ok_or_else(|| format!("{n} is no number of pixels from {} to {}", sides.start(), sides.end()))
    };
    Ok((pixels(width)?, pixels(height)?))
}

/// Linear light, 0 to 1, as a byte of sRGB (IEC 61966-2-1). Light outside of that range gives
/// the nearest end of it.
pub fn srgb(light: f32) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let stored = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * stored).round() as u8
}

/// A picture of four bytes a pixel at half its width and height: each pixel is the mean of four.
pub fn halved(pixels: &[u8], (width, height): (u32, u32)) -> Vec<u8> {
    let (row, halves) = (width as usize * 4, (width as usize / 2, height as usize / 2));
    let mut small = Vec::with_capacity(halves.0 * halves.1 * 4);
    for y in 0..halves.1 {
        for x in 0..halves.0 * 4 {
            let at = 2 * y * row + x / 4 * 8 + x % 4;
            let sum: u32 = [at, at + 4, at + row, at + row + 4].iter().map(|&i| u32::from(pixels[i])).sum();
            small.push((sum / 4) as u8);
        }
    }
    small
}

/// Writes a picture of four bytes a pixel as a PNG, without its opacity.
///
/// # Errors
/// The file cannot be written.
pub fn write_png(path: &Path, size: (u32, u32), pixels: &[u8]) -> Result<(), PathError> {
    let opaque: Vec<u8> = pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    write_rgb(path, size, &opaque)
}

/// Writes a picture of three bytes a pixel as a PNG.
pub(crate) fn write_rgb(path: &Path, (width, height): (u32, u32), rgb: &[u8]) -> Result<(), PathError> {
    let write = || -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width, height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(rgb)?;
        writer.finish()
    };
    write().map_err(|why| PathError::write(path)(why.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_on_a_command_line_are_read_within_limits() {
        let read = |text| parse_size(text, 16..=2000);
        assert_eq!(read("640x480"), Ok((640, 480)));
        for wrong in ["640", "640x", "15x640", "640x2001", "-640x480", "1e2x100", "640x480x2"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn half_a_picture_has_the_mean_of_four_pixels() {
        let grey = |v: u8| [v, v, v, 255];
        let pixels: Vec<u8> = [0, 100, 8, 8, 50, 50, 8, 8].into_iter().flat_map(grey).collect();
        assert_eq!(halved(&pixels, (4, 2)), [grey(50), grey(8)].concat());
        // An odd row or column is cut off.
        assert_eq!(halved(&pixels[..24], (3, 2)).len(), 4);
    }
}
