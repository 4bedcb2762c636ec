//! Servers in space: the walls of a level hide and stop, and sets that were baked come before them.

use casca::glam::Vec3;
use casca::{Aabb, Scene};
use casca_baked::{Baked, CellBox};
use casca_walls::{Eyes, Span, Walls};

use crate::baked::{BakedFile, SeenCells, cells_of};
use crate::describe::ClientDesc;
use crate::error::{ServerError, within};
use crate::numeric::{EVERYWHERE, FARTHEST, LEAST_WALL, ROUNDING, at_least, at_most};
use crate::options::ServerOptions;
use crate::server::Server;
use crate::world::World;

/// A server in space.
pub type VisibilityServer = Server<Space>;

/// A level in space.
#[derive(Debug)]
pub struct Space {
    level: Scene,
    /// Its walls, as of the last tick; none while they do not count.
    walls: Walls,
    /// Whether the level changed since.
    is_changed: bool,
    /// What was found of the level ahead of time.
    baked: Option<BakedFile>,
    /// Whether walls and baked sets count.
    uses_walls: bool,
}

/// Where an entity may be.
#[derive(Debug)]
pub struct Reached {
    span: Span,
    /// The cells of the baked sets that it has points in, if all is known about them.
    cells: Option<CellBox>,
}

/// What is kept about an eye from tick to tick.
#[derive(Debug, Default)]
pub struct Kept {
    /// The wall that hid each entity last, by slot.
    hints: Vec<u32>,
    seen_cells: SeenCells,
}

/// What an eye may see.
#[derive(Debug)]
pub struct Look<'a> {
    walls: &'a Walls,
    baked: Option<Baked<'a>>,
    eyes: Eyes,
    kept: &'a mut Kept,
}

impl VisibilityServer {
    /// A server for a level: a scene whose static objects hide entities. Dynamic objects hide
    /// nothing. The objects of the level are not told of.
    ///
    /// # Errors
    /// Refuses options that are out of their ranges.
    pub fn new(level: Scene, options: ServerOptions) -> Result<Self, ServerError> {
        let (walls, uses_walls) = (Walls::default(), options.walls);
        Self::of(Space { level, walls, is_changed: true, baked: None, uses_walls }, options)
    }

    /// The level.
    pub fn level(&self) -> &Scene {
        &self.world.level
    }

    /// The level, to be changed: what comes, goes or moves counts from the next tick on, which
    /// costs a pass over all of it, and baked sets are given up. A door that closes is an object
    /// with an occluder that comes.
    pub fn level_mut(&mut self) -> &mut Scene {
        (self.world.is_changed, self.world.walls) = (true, Walls::default());
        self.forget_baked();
        &mut self.world.level
    }

    /// Takes a file of sets from cell to cell, by `casca-bake --cell-to-cell` or the library
    /// casca-bake, as a first filter: a pair of a client and an entity of which it tells that the
    /// cells of the one see none of those of the other is withheld without another test. All the
    /// file's occluders must be static objects of the level. It counts only with
    /// [`ServerOptions::walls`]: its eyes keep out of solid objects. Costs a check of all of it.
    ///
    /// # Errors
    /// Refuses bytes that are no such file; the server keeps the file that it had.
    pub fn set_baked(&mut self, file: Vec<u8>) -> Result<(), ServerError> {
        let file = BakedFile::read(file)?;
        self.forget_baked();
        self.world.baked = Some(file);
        Ok(())
    }

    /// Whether there are baked sets, and they count.
    pub fn has_baked(&self) -> bool {
        self.world.baked.is_some() && self.world.uses_walls
    }

    fn forget_baked(&mut self) {
        self.world.baked = None;
        self.clients.values_mut().for_each(|client| client.kept.seen_cells.forget());
    }

    /// How many walls the level has, since the last tick: see [`ServerOptions::walls`].
    pub fn wall_count(&self) -> usize {
        self.world.walls.len()
    }

    /// Whether a wall stands between two places, as far as known since the last tick: to refuse
    /// reports of eyes that went through one. Who is in the plane of a wall only touches it; from
    /// one face of a wall to the other is through it.
    pub fn has_wall_between(&self, from: Vec3, to: Vec3) -> bool {
        self.world.walls.part(from.as_dvec3(), to.as_dvec3())
    }
}

impl Space {
    fn sets(&self) -> Option<Baked<'_>> {
        self.baked.as_ref().filter(|_| self.uses_walls).and_then(BakedFile::sets)
    }
}

impl World for Space {
    type Eye = Vec3;
    type Bounds = Aabb;
    type Kept = Kept;
    type Reached = Reached;
    type Look<'a> = Look<'a>;

    fn check_eye(&self, eye: &Vec3) -> Result<(), ServerError> {
        check_place("the eye of a client", *eye)
    }

    fn check_bounds(&self, b: &Aabb) -> Result<(), ServerError> {
        check_place("the bounds of an entity", b.min)?;
        check_place("the bounds of an entity", b.max)?;
        if b.min.cmple(b.max).all() { Ok(()) } else { Err(ServerError::Inverted("the bounds of an entity")) }
    }

    fn apart(from: &Vec3, to: &Vec3) -> f64 {
        (to.as_dvec3() - from.as_dvec3()).length()
    }

    fn begin<'c>(
        &mut self,
        _: impl Iterator<Item = (&'c ClientDesc, f64, &'c mut Kept)>,
        _: u64,
        _: &ServerOptions,
    ) -> Result<(), ServerError> {
        if std::mem::take(&mut self.is_changed) && self.uses_walls {
            self.walls = Walls::of(&self.level, LEAST_WALL, |_| false);
        }
        Ok(())
    }

    /// The part that it can get to of a box around all places within reach.
    fn place(&self, bounds: &Aabb, reach: f64) -> Reached {
        let span = self.walls.reached(&span_of(bounds), span_of(&grown(bounds, reach)));
        Reached { span, cells: self.sets().and_then(|sets| cells_of(&sets, &span)) }
    }

    fn look<'a>(&'a self, eye: &Vec3, reach: f64, kept: &'a mut Kept) -> Look<'a> {
        let center = eye.as_dvec3();
        let span = Span { min: center - reach, max: center + reach };
        let span = self.walls.reached(&Span { min: center, max: center }, span);
        let baked = self.sets();
        kept.seen_cells.follow(baked.as_ref(), &span);
        Look { walls: &self.walls, baked, eyes: Eyes::new(center, reach, span), kept }
    }

    fn may_see(look: &mut Look<'_>, slot: usize, place: &Reached) -> bool {
        let Kept { hints, seen_cells } = &mut *look.kept;
        if hints.len() <= slot {
            hints.resize(slot + 1, 0);
        }
        look.baked.is_none_or(|sets| seen_cells.may_see(&sets, place.cells))
            && !look.walls.hide(&look.eyes, &place.span, 0.0, &mut hints[slot])
    }
}

fn check_place(what: &'static str, place: Vec3) -> Result<(), ServerError> {
    place.to_array().into_iter().try_for_each(|c| within(what, c, -FARTHEST, FARTHEST))
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
