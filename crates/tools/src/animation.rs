//! Pictures in a row, as one animated PNG.

use std::collections::HashMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use color_quant::NeuQuant;
use png::{BlendOp, Compression, DisposeOp, Encoder, Filter};

use crate::command_line::PathError;

/// Colours of an animation: flat colours need no more, and the file stays small.
const COLOURS: usize = 64;
/// The palette is found from at most this many frames.
const SAMPLES: usize = 8;

/// Writes frames of four bytes a pixel, all of one size, as an animated PNG that repeats for ever.
/// All frames share one palette, and a frame stores only the pixels that changed: the others cannot
/// flicker.
///
/// # Errors
/// There are no frames, or the file cannot be written.
pub fn write_animation(
    path: &Path,
    (width, height): (u32, u32),
    frames: &[Vec<u8>],
    milliseconds: u16,
) -> Result<(), PathError> {
    let write = || -> Result<(), png::EncodingError> {
        let mut encoder = Encoder::new(BufWriter::new(File::create(path)?), width, height);
        encoder.set_animated(frames.len() as u32, 0)?;
        let (palette, frames) = indexed(frames);
        let unchanged = (palette.len() / 3 - 1) as u8;
        let mut opacity = vec![255; palette.len() / 3 - 1];
        opacity.push(0);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette);
        encoder.set_trns(opacity);
        encoder.set_compression(Compression::High);
        encoder.set_filter(Filter::NoFilter);
        encoder.set_frame_delay(milliseconds, 1000)?;
        encoder.set_blend_op(BlendOp::Over)?;
        encoder.set_dispose_op(DisposeOp::None)?;
        let mut writer = encoder.write_header()?;
        let mut last: &[u8] = &[];
        for frame in &frames {
            let olds = last.iter().map(Some).chain(std::iter::repeat(None));
            let change = |(&new, old): (&u8, Option<&u8>)| if old == Some(&new) { unchanged } else { new };
            let changes: Vec<u8> = frame.iter().zip(olds).map(change).collect();
            writer.write_image_data(&changes)?;
            last = frame;
        }
        writer.finish()
    };
    write().map_err(|why| PathError::write(path)(why.into()))
}

/// A palette for all frames, with one more entry for pixels that do not change, and the frames in
/// its numbers.
fn indexed(frames: &[Vec<u8>]) -> (Vec<u8>, Vec<Vec<u8>>) {
    let step = frames.len().div_ceil(SAMPLES).max(1);
    let sample: Vec<u8> = frames.iter().step_by(step).flatten().copied().collect();
    let quantizer = NeuQuant::new(1, COLOURS, &sample);
    let mut known: HashMap<[u8; 4], u8> = HashMap::new();
    let mut number = |pixel: &[u8]| {
        let pixel = [pixel[0], pixel[1], pixel[2], 255];
        *known.entry(pixel).or_insert_with(|| quantizer.index_of(&pixel) as u8)
    };
    let frames = frames.iter().map(|frame| frame.chunks_exact(4).map(&mut number).collect()).collect();
    let mut palette = quantizer.color_map_rgb();
    palette.extend([0; 3]);
    (palette, frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of a dark square that moves over a light ground.
    fn frames() -> Vec<Vec<u8>> {
        let pixel = |i: usize, at: usize| if (at..at + 8).contains(&(i % 32)) { 40 } else { 220 };
        (0..5).map(|n| (0..32 * 16).flat_map(|i| [pixel(i, 3 * n), 90, 90, 255]).collect()).collect()
    }

    #[test]
    fn frames_are_read_back_as_they_were_written() {
        let path = std::env::temp_dir().join(format!("casca-animation-{}.png", std::process::id()));
        write_animation(&path, (32, 16), &frames(), 120).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(File::open(&path).unwrap()));
        reader.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
        let mut reader = reader.read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 5);
        let mut shown = vec![0u8; 32 * 16 * 4];
        for frame in frames() {
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut read).unwrap();
            for (old, new) in shown.chunks_mut(4).zip(read.chunks(4)).filter(|(_, new)| new[3] == 255) {
                old.copy_from_slice(new);
            }
            let off = shown.iter().zip(&frame).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(off <= Some(6), "{off:?}");
        }
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn no_frames_are_an_error() {
        let path = std::env::temp_dir().join(format!("casca-no-animation-{}.png", std::process::id()));
        assert!(write_animation(&path, (4, 4), &[], 100).is_err());
    }
}
