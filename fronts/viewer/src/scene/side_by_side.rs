//! One frame as two methods draw it, side by side, with the pixels that each loses in red.

use std::error::Error;
use std::path::Path;

use casca_stage::canvas::Canvas;
use casca_stage::egui::{self, Align2, Color32, ColorImage, FontId, Pos2, Rect, Stroke, StrokeKind, Vec2};
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::panel::Panel;
use casca_tools::compare::{MARK, Shot, marked};
use casca_tools::image::write_png;

use crate::scene::playback::Method;

/// How much the enlarged part is enlarged.
const ZOOM: u32 = 6;
/// The enlarged part takes one in so many pixels of the picture's width and height, enlarged.
const PART: u32 = 3;

const RED: Color32 = Color32::from_rgb(MARK[0], MARK[1], MARK[2]);
const TEXT: Color32 = Color32::from_rgb(30, 30, 34);

/// A frame as a method draws it.
pub struct Drawn {
    /// The method.
    pub method: Method,
    /// Its picture.
    pub shot: Shot,
    /// The pixels in which it differs from the picture of everything.
    pub lost: Vec<bool>,
}

impl Drawn {
    fn count(&self) -> usize {
        self.lost.iter().filter(|lost| **lost).count()
    }

    /// The number of lost pixels, as a title.
    fn title(&self) -> String {
        let name = match self.method {
            Method::Hzb => "sampled depth buffer",
            Method::Rays => "depth buffer of rays",
            Method::All | Method::Frustum | Method::Point | Method::Cell => "casca",
        };
        match self.count() {
            0 => format!("{name}: none lost"),
            1 => format!("{name}: 1 visible pixel lost"),
            n => format!("{name}: {n} visible pixels lost"),
        }
    }

    /// The picture with the lost pixels alone in red.
    fn exact(&self) -> Vec<u8> {
        let pixels = self.shot.pixels.chunks_exact(4).zip(&self.lost);
        pixels.flat_map(|(p, &lost)| if lost { MARK } else { [p[0], p[1], p[2], p[3]] }).collect()
    }
}

/// Where a page has its parts, in pixels.
struct Layout {
    width: f32,
    height: f32,
    gap: f32,
    title: f32,
}

impl Layout {
    fn new((width, height): (u32, u32)) -> Self {
        let (width, height) = (width as f32, height as f32);
        Self { width, height, gap: width * 0.02, title: width * 0.075 }
    }

    fn size(&self) -> Vec2 {
        egui::vec2(2.0 * self.width + 3.0 * self.gap, self.height + 2.0 * self.title)
    }

    fn picture(&self, side: usize) -> Rect {
        let left = self.gap + side as f32 * (self.width + self.gap);
        Rect::from_min_size(Pos2::new(left, self.title), egui::vec2(self.width, self.height))
    }

    /// The enlarged part of a picture, in its lower corner away from the place that it enlarges.
    fn inset(&self, picture: Rect, place: Rect) -> Rect {
        let size = place.size() * ZOOM as f32;
        let gap = 0.6 * self.gap;
        let left = if place.center().x > picture.center().x {
            picture.left() + gap
        } else {
            picture.right() - gap - size.x
        };
        let top = if place.center().y > picture.center().y + 0.1 * picture.height() {
            picture.top() + gap
        } else {
            picture.bottom() - gap - size.y
        };
        Rect::from_min_size(Pos2::new(left, top), size)
    }
}

/// The part of a picture with the most lost pixels: its left upper corner and its size.
fn densest(lost: &[bool], (width, height): (u32, u32)) -> ([u32; 2], [u32; 2]) {
    let size = [width, height].map(|side| (side / PART / ZOOM).max(1));
    let count = |[x, y]: [u32; 2], [w, h]: [u32; 2]| {
        let row = |y: u32| &lost[(y * width + x) as usize..][..w as usize];
        (y..y + h).map(|y| row(y).iter().filter(|lost| **lost).count()).sum::<usize>()
    };
    // Among equals, the one with most of them in its middle.
    let score = |[x, y]: [u32; 2]| {
        let [w, h] = size;
        (count([x, y], size), count([x + w / 4, y + h / 4], [w / 2, h / 2]))
    };
    let steps = |side: u32, part: u32| (0..=side - part).step_by((part / 8).max(1) as usize);
    let places = steps(height, size[1]).flat_map(|y| steps(width, size[0]).map(move |x| [x, y]));
    (places.max_by_key(|&place| score(place)).unwrap_or([0, 0]), size)
}

fn cropped(pixels: &[u8], width: u32, ([x, y], [w, h]): ([u32; 2], [u32; 2])) -> ColorImage {
    let row = |y: u32| &pixels[((y * width + x) * 4) as usize..][..(w * 4) as usize];
    let part: Vec<u8> = (y..y + h).flat_map(row).copied().collect();
    ColorImage::from_rgba_unmultiplied([w as usize, h as usize], &part)
}

/// Writes a page with both pictures, a title for each, the place with the most losses enlarged, and
/// a legend that ends with `place`.
///
/// # Errors
/// The page cannot be drawn or written.
pub fn write_page(
    gpu: &Gpu,
    path: &Path,
    size: (u32, u32),
    (everything, sides): (&Shot, [&Drawn; 2]),
    place: &str,
) -> Result<(), Box<dyn Error>> {
    let layout = Layout::new(size);
    let page = Canvas::new(gpu, (layout.size().x as u32, layout.size().y as u32));
    let mut panel = Panel::new(gpu, COLOUR);
    let focus = densest(&sides[0].lost, size);
    let whole = ([0, 0], [size.0, size.1]);
    let images = sides.map(|side| {
        let pale = cropped(&marked(&everything.pixels, &side.lost, size), size.0, whole);
        [panel.image("picture", pale), panel.image("part", cropped(&side.exact(), size.0, focus))]
    });
    let font = |share: f32| FontId::proportional(layout.width * share);
    panel.draw(gpu, &page.picture(), 1.0, &|context| {
        let painter = context.layer_painter(egui::LayerId::background());
        painter.rect_filled(context.content_rect(), 0.0, Color32::WHITE);
        let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        for (side, (drawn, [picture, part])) in sides.iter().zip(&images).enumerate() {
            let frame = layout.picture(side);
            let colour = if drawn.count() > 0 { RED } else { TEXT };
            let title = Pos2::new(frame.left(), layout.title * 0.5);
            painter.text(title, Align2::LEFT_CENTER, drawn.title(), font(0.042), colour);
            painter.image(picture.id(), frame, uv, Color32::WHITE);
            let [x, y, w, h] = [focus.0[0], focus.0[1], focus.1[0], focus.1[1]].map(|v| v as f32);
            let source = Rect::from_min_size(frame.min + egui::vec2(x, y), egui::vec2(w, h));
            let inset = layout.inset(frame, source);
            let stroke = Stroke::new(layout.width * 0.0035, TEXT);
            let (a, b) = nearest_corners(source, inset);
            painter.line_segment([a, b], stroke);
            painter.image(part.id(), inset, uv, Color32::WHITE);
            painter.rect_stroke(source, 0.0, stroke, StrokeKind::Outside);
            painter.rect_stroke(inset, 0.0, stroke, StrokeKind::Outside);
            let label = format!("enlarged {ZOOM} times");
            let label = painter.layout_no_wrap(label, font(0.026), TEXT);
            let place = inset.left_top() - egui::vec2(stroke.width, label.size().y + stroke.width);
            painter.rect_filled(Rect::from_min_size(place, label.size()), 0.0, Color32::WHITE);
            painter.galley(place, label, TEXT);
        }
        let bottom = layout.title * 1.5 + layout.height;
        let high = layout.width * 0.026;
        let sample = Rect::from_min_size(Pos2::new(layout.gap, bottom - 0.5 * high), Vec2::splat(high));
        let mut left = layout.gap;
        let mut text = String::new();
        if sides.iter().any(|side| side.count() > 0) {
            painter.rect_filled(sample, 0.0, RED);
            left += 1.5 * high;
            text.push_str("pixel of a visible object that the method left out.  ");
        }
        text.push_str(place);
        painter.text(Pos2::new(left, bottom), Align2::LEFT_CENTER, text, font(0.03), TEXT);
    });
    write_png(path, page.size(), &page.read_picture(gpu)?)?;
    Ok(())
}

/// The corners of two rectangles that are nearest to each other.
fn nearest_corners(a: Rect, b: Rect) -> (Pos2, Pos2) {
    let corners = |r: Rect| [r.left_top(), r.right_top(), r.left_bottom(), r.right_bottom()];
    let pairs = corners(a).into_iter().flat_map(|p| corners(b).map(|q| (p, q)));
    let nearest = pairs.min_by(|(p, q), (r, s)| p.distance(*q).total_cmp(&r.distance(*s)));
    nearest.unwrap_or((a.center(), b.center()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(method: Method, lost: Vec<bool>) -> Drawn {
        let shot = Shot { pixels: vec![9; lost.len() * 4], items: vec![0; lost.len()] };
        Drawn { method, shot, lost }
    }

    #[test]
    fn titles_count_the_pixels_lost() {
        assert_eq!(
            drawn(Method::Hzb, vec![true, false, true]).title(),
            "sampled depth buffer: 2 visible pixels lost"
        );
        assert_eq!(drawn(Method::Rays, vec![true]).title(), "depth buffer of rays: 1 visible pixel lost");
        assert_eq!(drawn(Method::Point, vec![false]).title(), "casca: none lost");
    }

    #[test]
    fn the_part_with_the_most_losses_is_enlarged() {
        let (width, height) = (180, 90);
        let mut lost = vec![false; width * height];
        for (x, y) in [(3, 3), (150, 60), (151, 61), (152, 62), (179, 89)] {
            lost[y * width + x] = true;
        }
        let ([x, y], [w, h]) = densest(&lost, (width as u32, height as u32));
        assert_eq!([w, h], [10, 5]);
        assert!((143..=150).contains(&x) && (58..=60).contains(&y), "{x} {y}");
        assert_eq!(densest(&[true], (1, 1)), ([0, 0], [1, 1]));
    }

    #[test]
    fn parts_of_a_page_lie_in_it_and_the_inset_beside_its_place() {
        let layout = Layout::new((800, 450));
        let page = Rect::from_min_size(Pos2::ZERO, layout.size());
        for side in 0..2 {
            let picture = layout.picture(side);
            assert!(page.contains_rect(picture));
            for (x, y) in [(0.0, 0.0), (700.0, 0.0), (300.0, 400.0), (700.0, 400.0), (380.0, 200.0)] {
                let place = Rect::from_min_size(picture.min + egui::vec2(x, y), egui::vec2(44.0, 25.0));
                let inset = layout.inset(picture, place);
                assert!(picture.contains_rect(inset) && !inset.intersects(place), "{x} {y}");
            }
        }
    }
}
