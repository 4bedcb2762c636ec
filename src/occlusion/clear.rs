//! Where nothing was drawn: a bit for each square of some pixels of each side of the cube around an
//! eye.
//!
//! A point inside the view whose direction passes such a square is before all occluders. That is
//! asked of very many small objects, in single precision: rounding may take a point for one of the
//! next square, and an object for visible that is not, but never for hidden.

use glam::Vec3A;

use crate::grid::side::Side;
use crate::occlusion::bins::BIN;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::tiles::TILE;

/// The squares of one side.
#[derive(Debug, Clone, Default)]
struct Squares {
    clear: Vec<bool>,
    /// Squares for one unit of the face, whose width is two.
    per_unit: f32,
    /// The first square, and how many there are along each axis.
    first: [f32; 2],
    count: [u32; 2],
}

impl Squares {
    #[inline]
    fn is_clear(&self, u: f32, v: f32) -> bool {
        let x = (u + 1.0) * self.per_unit - self.first[0];
        let y = (v + 1.0) * self.per_unit - self.first[1];
        // Negative numbers and NaN become a place that is not there.
        let place = |at: f32, count: u32| if at >= 0.0 { (at as u32).min(count) } else { count };
        let (x, y) = (place(x, self.count[0]), place(y, self.count[1]));
        x < self.count[0] && y < self.count[1] && self.clear[(y * self.count[0] + x) as usize]
    }

    /// Whether all squares that a rectangle of the face touches are clear.
    fn are_clear(&self, rect: &Rect) -> bool {
        // Numbers that are not finite, or outside, become places that are not there.
        let place = |at: f64, axis: usize| (at + 1.0) as f32 * self.per_unit - self.first[axis];
        let (x0, x1) = (place(rect.u0, 0), place(rect.u1, 0));
        let (y0, y1) = (place(rect.v0, 1), place(rect.v1, 1));
        let within = |least: f32, most: f32, count: u32| least >= 0.0 && most < count as f32;
        within(x0, x1, self.count[0]) && within(y0, y1, self.count[1]) && {
            let row = |y: u32| {
                let first = (y * self.count[0]) as usize;
                &self.clear[first + x0 as usize..=first + x1 as usize]
            };
            (y0 as u32..=y1 as u32).all(|y| row(y).iter().all(|&clear| clear))
        }
    }
}

/// The squares of all sides.
#[derive(Debug, Clone, Default)]
pub(crate) struct Clear {
    /// In the order of [`Side::ALL`].
    sides: [Squares; 6],
}

impl Clear {
    /// Forgets all squares: no point is found before all occluders.
    pub(crate) fn reset(&mut self) {
        for side in &mut self.sides {
            side.count = [0; 2];
        }
    }

    /// Reads the squares of one side.
    pub(crate) fn read(&mut self, side: usize, face: &FaceBuffer) {
        let squares = &mut self.sides[side];
        squares.clear.clear();
        let (first, count) = face.squares(|is_clear| squares.clear.push(is_clear));
        let square = |tile: i64| (tile as f64 / BIN as f64) as f32;
        squares.first = [square(first.0), square(first.1)];
        squares.count = [count.0 as u32, count.1 as u32];
        squares.per_unit = (face.window().per_unit() / (BIN * TILE) as f64) as f32;
    }

    /// Whether nothing was drawn around all directions to the points of a rectangle on a side.
    pub(crate) fn holds_all(&self, side: usize, rect: &Rect) -> bool {
        self.sides[side].are_clear(rect)
    }

    /// Whether the direction to a point, which is relative to the eye, passes a square in which
    /// nothing was drawn.
    #[inline]
    pub(crate) fn holds(&self, point: Vec3A) -> bool {
        let (size, at) = (point.abs().to_array(), point.to_array());
        let axis = if size[0] >= size[1].max(size[2]) { 0 } else { 1 + usize::from(size[2] > size[1]) };
        let side = 2 * axis + usize::from(at[axis] < 0.0);
        let axes = Side::ALL[side].axes;
        let inverse = 1.0 / size[axis];
        self.sides[side].is_clear(at[axes.col] * inverse, at[axes.row] * inverse)
    }
}

#[cfg(test)]
mod tests {
    use casca_slots::Slot;
    use glam::{DVec3, Vec3};

    use crate::geometry::Block;
    use crate::geometry::body::Body;
    use crate::occlusion::buffers::OcclusionBuffers;
    use crate::occlusion::pitch::Pitch;
    use crate::random::Random;
    use crate::view::View;

    #[test]
    fn what_is_before_all_occluders_is_shown_and_nothing_behind_one_is() {
        let view = View::omnidirectional(Vec3::ZERO).unwrap();
        let pitch = Pitch { pixels: 128.0, least: 0.0, nearest: 1e-3, radius: 40.0, middle: DVec3::ZERO };
        let mut buffers = OcclusionBuffers::default();
        buffers.begin(&view, &pitch);
        let wall = Block { min: DVec3::new(3.0, -4.0, -1.5), max: DVec3::new(4.0, 1.0, 2.0) };
        buffers.draw_body(&Body::Block(wall), Slot::new(0)).unwrap();
        buffers.read_clear();
        let mut random = Random::new(5);
        let (mut clear, mut shown) = (0, 0);
        for _ in 0..20_000 {
            let p = random.point(20.0);
            let shows = buffers.shows_plainly(p, Slot::new(1));
            let is_clear = buffers.is_clear(p.as_vec3a());
            assert!(shows || !is_clear, "{p}");
            (clear, shown) = (clear + usize::from(is_clear), shown + usize::from(shows));
        }
        assert!(clear > 15_000 && shown > clear && shown < 19_900, "{clear} {shown}");
        assert!(!buffers.is_clear(glam::Vec3A::NAN));
        buffers.begin(&view, &pitch);
        assert!(!buffers.is_clear(glam::Vec3A::X), "it was not read again");
    }
}
