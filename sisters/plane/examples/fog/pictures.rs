//! A recorded walk, as a picture of its end or as an animation.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, Rgba, RgbaImage};

use crate::explore::next_step;
use crate::game::Game;
use crate::look::look;

/// The side of a tile, in pixels.
const TILE: u32 = 8;
/// Milliseconds of a frame.
const DELAY: u32 = 70;

/// Lets the walker explore for some steps, or until all is known, and writes files.
pub fn record(
    game: &mut Game,
    frames: u32,
    png: Option<&str>,
    gif: Option<&str>,
) -> Result<(), Box<dyn Error>> {
    let mut animation = match gif {
        Some(file) => {
            let mut encoder = GifEncoder::new_with_speed(BufWriter::new(File::create(file)?), 10);
            encoder.set_repeat(Repeat::Infinite)?;
            Some(encoder)
        }
        None => None,
    };
    for _ in 0..frames {
        let Some(step) = next_step(game) else { break };
        game.step(step);
        game.end_turn()?;
        if let Some(encoder) = &mut animation {
            let delay = Delay::from_numer_denom_ms(DELAY, 1);
            encoder.encode_frame(Frame::from_parts(draw(game), 0, 0, delay))?;
        }
    }
    if let Some(file) = png {
        draw(game).save(file)?;
    }
    Ok(())
}

/// The map as the walker knows it.
fn draw(game: &Game) -> RgbaImage {
    let (width, height) = game.size();
    let mut image = RgbaImage::new(width * TILE, height * TILE);
    for tile in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let look = look(game, tile);
        for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
            // Twice the distance from the middle, in pixels.
            let aside = |at: u32| (2 * at + 1).abs_diff(TILE);
            let figure = look.figure && aside(x).pow(2) + aside(y).pow(2) <= (TILE - 1).pow(2);
            let [red, green, blue] = if figure { look.ink } else { look.ground };
            image.put_pixel(tile.0 * TILE + x, tile.1 * TILE + y, Rgba([red, green, blue, 255]));
        }
    }
    image
}
