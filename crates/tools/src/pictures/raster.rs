//! Pictures made of pixels, with text, as PNG.

use std::path::Path;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use plotters::style::RGBColor;

use super::PictureError;
use crate::image::write_rgb;

/// An RGB picture.
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Canvas {
    /// A picture of one colour.
    pub fn new(width: usize, height: usize, color: RGBColor) -> Self {
        let pixels = [color.0, color.1, color.2].repeat(width * height);
        Self { width, height, pixels }
    }

    /// Mixes a colour into a pixel; those outside are left out.
    fn mix(&mut self, x: i64, y: i64, color: RGBColor, share: f32) {
        let inside = x >= 0 && y >= 0 && x < self.width as i64 && y < self.height as i64;
        if !inside || share <= 0.0 {
            return;
        }
        let at = (y as usize * self.width + x as usize) * 3;
        let share = share.min(1.0);
        for (old, new) in self.pixels[at..at + 3].iter_mut().zip([color.0, color.1, color.2]) {
            *old = (f32::from(*old) + (f32::from(new) - f32::from(*old)) * share).round() as u8;
        }
    }

    /// Sets a pixel.
    pub fn set(&mut self, x: usize, y: usize, color: RGBColor) {
        self.mix(x as i64, y as i64, color, 1.0);
    }

    /// Fills a rectangle.
    pub fn rect(&mut self, (x, y): (usize, usize), (width, height): (usize, usize), color: RGBColor) {
        for row in y..y + height {
            (x..x + width).for_each(|column| self.set(column, row, color));
        }
    }

    /// Fills what lies within a distance of its border, negative inside.
    fn shape(&mut self, at: (f32, f32), reach: f32, color: RGBColor, distance: impl Fn(f32, f32) -> f32) {
        let span = |c: f32| (c - reach - 1.0).floor() as i64..=(c + reach + 1.0).ceil() as i64;
        for y in span(at.1) {
            for x in span(at.0) {
                let (dx, dy) = (x as f32 + 0.5 - at.0, y as f32 + 0.5 - at.1);
                self.mix(x, y, color, (0.5 - distance(dx, dy)).clamp(0.0, 1.0));
            }
        }
    }

    /// A disc.
    pub fn disc(&mut self, at: (f32, f32), r: f32, color: RGBColor) {
        self.shape(at, r, color, |dx, dy| dx.hypot(dy) - r);
    }

    /// A square on its tip.
    pub fn diamond(&mut self, at: (f32, f32), r: f32, color: RGBColor) {
        self.shape(at, r, color, |dx, dy| (dx.abs() + dy.abs() - r) * 0.7);
    }

    /// A cross of two slanting bars.
    pub fn cross(&mut self, at: (f32, f32), r: f32, width: f32, color: RGBColor) {
        self.shape(at, r, color, |dx, dy| {
            let (a, b) = ((dx + dy).abs() * 0.7, (dx - dy).abs() * 0.7);
            (a.min(b) - width).max(a.max(b) - r)
        });
    }

    /// Text from the left, with its middle at this height; returns where it ends.
    pub fn text(&mut self, at: (f32, f32), size: f32, color: RGBColor, text: &str) -> f32 {
        let Ok(font) = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT) else { return at.0 };
        let font = font.into_scaled(PxScale::from(size));
        let baseline = at.1 + (font.ascent() + font.descent()) * 0.5;
        let (mut x, mut last) = (at.0, None);
        for c in text.chars() {
            let id = font.glyph_id(c);
            x += last.map_or(0.0, |l| font.kern(l, id));
            let glyph = id.with_scale_and_position(font.scale(), point(x, baseline));
            if let Some(outline) = font.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|dx, dy, share| {
                    let (x, y) = (corner.x as i64 + i64::from(dx), corner.y as i64 + i64::from(dy));
                    // The font is a light one: a little more of it reads better.
                    self.mix(x, y, color, share * 1.3);
                });
            }
            x += font.h_advance(id);
            last = Some(id);
        }
        x
    }

    /// Writes the picture.
    pub fn save(&self, path: &Path) -> Result<(), PictureError> {
        let size = (self.width as u32, self.height as u32);
        write_rgb(path, size, &self.pixels).map_err(|e| PictureError::at(path)(e.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: RGBColor = RGBColor(0, 0, 0);
    const WHITE: RGBColor = RGBColor(255, 255, 255);

    fn ink(canvas: &Canvas) -> usize {
        canvas.pixels.chunks(3).filter(|p| p[0] < 128).count()
    }

    #[test]
    fn shapes_fill_their_areas_and_stay_in_the_picture() {
        let mut canvas = Canvas::new(40, 40, WHITE);
        canvas.disc((20.0, 20.0), 10.0, BLACK);
        assert!((300..=330).contains(&ink(&canvas)), "{}", ink(&canvas));
        canvas.disc((0.0, -5.0), 20.0, BLACK);
        canvas.diamond((40.0, 40.0), 9.0, BLACK);
        canvas.cross((-3.0, 60.0), 9.0, 2.0, BLACK);
        canvas.rect((35, 0), (20, 10), BLACK);
        assert_eq!(canvas.pixels.len(), 40 * 40 * 3);
    }

    #[test]
    fn text_is_as_wide_as_its_letters() {
        let mut canvas = Canvas::new(200, 30, WHITE);
        let end = canvas.text((4.0, 15.0), 20.0, BLACK, "visible");
        assert!(ink(&canvas) > 60 && end > 40.0 && end < 90.0);
        assert!(canvas.text((0.0, 15.0), 20.0, BLACK, "visible objects") > end);
    }
}
