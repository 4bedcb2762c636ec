//! Hollow circles of cells whose neighbours share sides (thesis, section 3.3.2; Bresenham 1977).
//!
//! In each column x from 0 to where x passes y, the circle of radius r has the cell at y =
//! round(sqrt(r² - x²)); the other seven eighths are its mirror images. Where two cells that follow
//! each other share a corner only, the cell below the first one joins them. So the circle is
//! 4-connected: no way from cell to neighbour, corners included, gets inside without a cell of the
//! circle.
//!
//! Let the *disc* be the cells of the circle and those inside of it.
//!
//! - It has each cell whose centre is at most r from the middle: in its column, |y| <=
//!   floor(sqrt(r² - x²)), which is not beyond the circle.
//! - It has no cell whose centre is more than r + 1/2 from the middle: y <= s + 1/2 with s =
//!   sqrt(r² - x²), so x² + y² <= r² + s + 1/4 <= (r + 1/2)².
//!
//! If the disc holds all cells that an object touches, and an eye outside of the disc sees a point
//! of the object, then the way there enters the disc through a cell of the circle, and that cell is
//! in sight.

use glam::{IVec2, Vec2Swizzles as _};

/// Each cell of a circle of at least radius 0 once, relative to its middle.
pub fn circle(radius: i32) -> impl Iterator<Item = IVec2> {
    let wide = i64::from(radius.max(0));
    let top = move |x: i64| rounded_root(wide * wide - x * x);
    let eighth = (0..).map(move |x| (x, top(x))).take_while(|&(x, y)| x <= y);
    let joined = eighth.flat_map(move |(x, y)| {
        // The next column of this eighth is one lower: its first cell joins on from below this one.
        let (next, below) = (top((x + 1).min(wide)), (x, y - 1));
        let steps = x < y && next < y && below.1 >= x;
        [Some((x, y)), Some(below).filter(|_| steps)].into_iter().flatten()
    });
    joined.flat_map(|(x, y)| mirrored(IVec2::new(x as i32, y as i32)))
}

/// The nearest whole number to the square root of one that is not negative.
fn rounded_root(square: i64) -> i64 {
    let root = square.max(0).isqrt();
    // (root + 1/2)² = root² + root + 1/4.
    root + i64::from(square > root * root + root)
}

/// A cell of the first eighth and its mirror images, each once.
fn mirrored(c: IVec2) -> impl Iterator<Item = IVec2> {
    let all = [c, c.perp(), -c, -c.perp(), c.yx(), c.yx().perp(), -c.yx(), -c.yx().perp()];
    (0..8).filter(move |&i| !all[..i].contains(&all[i])).map(move |i| all[i])
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// The cells that a flood from outside cannot reach over sides and corners.
    fn disc(circle: &HashSet<IVec2>, radius: i32) -> HashSet<IVec2> {
        let far = radius + 2;
        let inside = |c: IVec2| c.abs().max_element() <= far;
        let (mut outside, mut open) = (HashSet::from([IVec2::splat(far)]), vec![IVec2::splat(far)]);
        while let Some(c) = open.pop() {
            for d in (0..9).map(|i| IVec2::new(i % 3 - 1, i / 3 - 1)) {
                if inside(c + d) && !circle.contains(&(c + d)) && outside.insert(c + d) {
                    open.push(c + d);
                }
            }
        }
        let all = (-far..=far).flat_map(|x| (-far..=far).map(move |y| IVec2::new(x, y)));
        all.filter(|c| !outside.contains(c)).collect()
    }

    #[test]
    fn circles_are_closed_against_diagonal_steps_and_hold_what_they_should() {
        for radius in 0..70 {
            let cells: Vec<IVec2> = circle(radius).collect();
            let set: HashSet<IVec2> = cells.iter().copied().collect();
            assert_eq!(set.len(), cells.len(), "{radius}: each cell once");
            let disc = disc(&set, radius);
            for c in (-75..=75).flat_map(|x| (-75..=75).map(move |y| IVec2::new(x, y))) {
                let (square, radius) = (c.length_squared(), radius);
                assert!(square > radius * radius || disc.contains(&c), "{radius} {c}");
                assert!(4 * square <= (2 * radius + 1).pow(2) || !disc.contains(&c), "{radius} {c}");
            }
            // It is hollow: the cells grow with the radius only.
            assert!(cells.len() as i32 <= 8 * radius + 4, "{radius} {}", cells.len());
        }
    }
}
