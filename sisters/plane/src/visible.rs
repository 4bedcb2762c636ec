//! The visible region by one call, for walls that are asked about once.

use glam::Vec2;

use crate::error::{Error, finite2};
use crate::geometry::Segment;
use crate::point::Query;
use crate::view::View;

/// The corners of the region that an eye sees between walls, up to `range` from it, in world units:
/// counter-clockwise around the eye, see [`Query::polygon`]. Costs all
/// walls within the range: of many walls, a [`Scene`](crate::Scene) looks only at those in sight.
///
/// ```
/// use casca_plane::glam::Vec2;
/// use casca_plane::{Segment, visible_region};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let wall = Segment::new(Vec2::new(-1.0, 2.0), Vec2::new(1.0, 2.0));
/// let corners = visible_region(&[wall], Vec2::ZERO, 10.0)?;
/// assert!(corners.iter().all(|at| at.length() < 10.5 && (at.x.abs() > 0.9 || at.y < 2.1)));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Refuses walls and an eye that are not finite, and a range that is not a positive number.
pub fn visible_region(walls: &[Segment], eye: Vec2, range: f32) -> Result<Vec<Vec2>, Error> {
    let view = View::all_round(eye)?.with_range(range)?;
    walls.iter().flat_map(|wall| [wall.a, wall.b]).try_for_each(|end| finite2("the end of a wall", end))?;
    let mut query = Query::new();
    query.run_among(walls, &view);
    Ok(query.polygon())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_kinds_are_refused_or_answered() {
        let wall = |a: f32, b: f32| Segment::new(Vec2::splat(a), Vec2::new(b, a));
        for bad in [f32::NAN, f32::INFINITY] {
            assert!(visible_region(&[wall(bad, 1.0)], Vec2::ZERO, 1.0).is_err());
            assert!(visible_region(&[], Vec2::splat(bad), 1.0).is_err());
            assert!(visible_region(&[], Vec2::ZERO, bad).is_err());
        }
        assert!(visible_region(&[], Vec2::ZERO, -1.0).is_err());
        // Near and far, with ranges of all sizes.
        for eye in [0.0, 1.0, 5e6, 1e9, -3e38] {
            for range in [1e-45, 1e-3, 10.0, 1e30, f32::MAX] {
                for far in [1.0, 1e9, f32::MAX] {
                    let corners = visible_region(&[wall(-far, far)], Vec2::splat(eye), range);
                    assert!(corners.is_ok(), "{eye} {range} {far}: {corners:?}");
                }
            }
        }
        // Walls on both sides of the eye, and through it.
        /// From nothing to almost the greatest float.
        const FAR: [f32; 4] = [0.0, 1e-20, 1.0, 1e30];
        for far in FAR {
            let corners = visible_region(&[wall(1.0, 2.0), wall(far, -far)], Vec2::ZERO, 3.0).unwrap();
            assert!(corners.len() >= 2, "{far}");
        }
    }
}
