//! The visible region by one call, for walls that are asked about once.

use glam::Vec2;

use crate::error::{Error, finite2};
use crate::geometry::{Rect, Segment};
use crate::grid::GridSpec;
use crate::object::ObjectDesc;
use crate::point::Query;
use crate::scene::Scene;
use crate::view::View;

/// Room around the walls and the eye, as a share of their extent: none lies on the border of the
/// grid.
const ROOM: f32 = 0.01;

/// Cells along the longer side: as many as there are walls in a row of a square, from 4 to 1024.
const CELLS: [f32; 2] = [4.0, 1024.0];

/// The corners of the region that an eye sees between walls, up to `range` from it, in world units:
/// counter-clockwise around the eye, see [`Query::polygon`]. Costs as much as a scene of these
/// walls and one query of it; keep a [`Scene`] to ask more than once.
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
    // Walls that cannot be seen have no part in it.
    let reach = |at: Vec2| at.clamp(eye - range, eye + range);
    let (mut min, mut max) = (eye, eye);
    for wall in walls {
        for end in [wall.a, wall.b] {
            finite2("the end of a wall", end)?;
            (min, max) = (min.min(reach(end)), max.max(reach(end)));
        }
    }
    // Half of it: all of it may be more than the greatest number.
    let extent = (max * 0.5 - min * 0.5).max_element().max(f32::MIN_POSITIVE.sqrt());
    let room = Vec2::splat(extent * (2.0 * ROOM));
    let [fewest, most] = CELLS;
    // No finer than numbers are there.
    let finest = min.abs().max(max.abs()).max_element() * f32::EPSILON;
    let cell = (extent / ((walls.len() as f32).sqrt().clamp(fewest, most) * 0.5)).max(finest);
    let end = Vec2::splat(f32::MAX);
    let grid = GridSpec::covering(Rect::new((min - room).max(-end), (max + room).min(end)), cell)?;
    let mut scene = Scene::new(&grid)?;
    for &wall in walls {
        scene.insert(ObjectDesc::new(wall).occluder(wall))?;
    }
    let mut query = Query::new();
    query.run(&scene, &view);
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
        // Far walls do not make the grid coarse, nor an eye alone make it empty.
        /// From nothing to almost the greatest float.
        const FAR: [f32; 4] = [0.0, 1e-20, 1.0, 1e30];
        for far in FAR {
            let corners = visible_region(&[wall(1.0, 2.0), wall(far, -far)], Vec2::ZERO, 3.0).unwrap();
            assert!(corners.len() >= 2, "{far}");
        }
    }
}
