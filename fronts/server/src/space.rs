//! Space: the walls of a level hide and stop, and sets that were baked come before them.

use casca::glam::Vec3;
use casca::{Aabb, Scene};
use casca_baked::{Baked, CellBox};
use casca_walls::{Eyes, Span, Walls};

use crate::baked::{BakedFile, SeenCells, cells_of};
use crate::error::{ServerError, within};
use crate::numeric::{EVERYWHERE, FARTHEST, LEAST_WALL, ROUNDING, at_least, at_most};

/// A level in space.
#[derive(Debug)]
pub(crate) struct Space {
    pub(crate) level: Scene,
    /// Its walls, as of the last tick; none while they do not count.
    pub(crate) walls: Walls,
    /// Whether the level changed since.
    pub(crate) is_changed: bool,
    /// The walls before that change, until the next tick; and the last tick that had others.
    old: Option<Walls>,
    since: f64,
    /// What was found of the level ahead of time.
    pub(crate) baked: Option<BakedFile>,
    /// Whether walls and baked sets count.
    pub(crate) uses_walls: bool,
}

/// Where an entity may be.
#[derive(Debug)]
pub(crate) struct Reached {
    span: Span,
    /// The cells of the baked sets that it has points in, if all is known about them.
    cells: Option<CellBox>,
}

/// What is kept about an eye from tick to tick.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    /// The wall that hid each entity last, by slot.
    hints: Vec<u32>,
    pub(crate) seen_cells: SeenCells,
}

impl Space {
    pub(crate) fn new(level: Scene, uses_walls: bool) -> Self {
        let (walls, old, since) = (Walls::default(), None, f64::MIN);
        Self { level, walls, is_changed: true, old, since, baked: None, uses_walls }
    }

    /// The level is to be changed: until the next tick no wall is known.
    pub(crate) fn change(&mut self) {
        let walls = std::mem::take(&mut self.walls);
        self.old.get_or_insert(walls);
        self.is_changed = true;
    }

    /// Finds the walls anew if the level changed. Returns those before, if there were others.
    pub(crate) fn find_walls(&mut self, now: f64) -> Option<Walls> {
        if std::mem::take(&mut self.is_changed) && self.uses_walls {
            self.walls = Walls::of(&self.level, LEAST_WALL);
        }
        self.old.take().inspect(|_| self.since = now)
    }

    fn sets(&self) -> Option<Baked<'_>> {
        self.baked.as_ref().filter(|_| self.uses_walls).and_then(BakedFile::sets)
    }

    /// Where an entity may be that went `reach` at most.
    pub(crate) fn place(&self, bounds: &Aabb, reach: f64) -> Reached {
        let span = reached(&self.walls, bounds, reach);
        Reached { span, cells: self.sets().and_then(|sets| cells_of(&sets, &span)) }
    }

    /// Tells of entities, by their slots and where they may be, whether one of the eyes that went `reach`
    /// at most since a time may see a point of it; in doubt, yes.
    pub(crate) fn look(
        &self,
        eye: Vec3,
        (reach, time): (f64, f64),
        Kept { hints, seen_cells }: &mut Kept,
    ) -> impl FnMut(usize, &Reached) -> bool {
        let center = eye.as_dvec3();
        let span = Span { min: center - reach, max: center + reach };
        // It may have got past a wall before that came.
        let from = if time < self.since { span } else { Span { min: center, max: center } };
        let span = self.walls.reached(&from, span);
        let (baked, eyes) = (self.sets(), Eyes::new(center, reach, span));
        seen_cells.follow(baked.as_ref(), &span);
        move |slot, place| {
            if hints.len() <= slot {
                hints.resize(slot + 1, 0);
            }
            baked.is_none_or(|sets| seen_cells.may_see(&sets, place.cells))
                && !self.walls.hide(&eyes, &place.span, 0.0, &mut hints[slot])
        }
    }
}

/// Refuses places that are too far or not finite.
pub(crate) fn check_place(what: &'static str, place: Vec3) -> Result<(), ServerError> {
    place.to_array().into_iter().try_for_each(|c| within(what, c, -FARTHEST, FARTHEST))
}

/// Refuses boxes with such corners, and inverted ones.
pub(crate) fn check_bounds(b: &Aabb) -> Result<(), ServerError> {
    let what = "the bounds of an entity";
    check_place(what, b.min)?;
    check_place(what, b.max)?;
    if b.min.cmple(b.max).all() { Ok(()) } else { Err(ServerError::Inverted(what)) }
}

/// The part that an entity can get to of a box around all places within reach.
pub(crate) fn reached(walls: &Walls, bounds: &Aabb, reach: f64) -> Span {
    walls.reached(&span_of(bounds), span_of(&grown(bounds, reach)))
}

/// A box in double precision.
pub(crate) fn span_of(b: &Aabb) -> Span {
    Span { min: b.min.as_dvec3(), max: b.max.as_dvec3() }
}

/// A box grown by a length in all directions, rounded outwards, up to [`EVERYWHERE`].
fn grown(b: &Aabb, by: f64) -> Aabb {
    if by == 0.0 {
        return *b;
    }
    let by = by * (1.0 + ROUNDING);
    let (min, max) = (b.min.as_dvec3() - by, b.max.as_dvec3() + by);
    let min = min.to_array().map(|v| at_most(v).max(-EVERYWHERE));
    let max = max.to_array().map(|v| at_least(v).min(EVERYWHERE));
    Aabb::new(min.into(), max.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_grow_outwards() {
        let b = Aabb::new(Vec3::splat(1.0), Vec3::splat(2.0));
        assert_eq!(grown(&b, 0.0), b);
        for by in [1e-9, 0.1, 3.0, 1e7] {
            let g = grown(&b, by);
            assert!(f64::from(g.min.x) <= 1.0 - by && f64::from(g.max.z) >= 2.0 + by, "{by}");
        }
    }
}
