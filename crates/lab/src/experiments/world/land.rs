//! A land of towns, woods and hills, made page by page from a seed. All corners are multiples of a
//! sixteenth of a metre, so that exact visibility may use single precision anywhere near the eye.

use casca::{Aabb, ObjectDesc, PageId, Sphere};
use casca_scenes::random::{Generator, generator, spread};
use casca_scenes::world::Shape;
use glam::{DVec3, IVec2, Vec3};
use rand::RngExt;

/// Edge length of a page in metres.
pub(super) const PAGE: i32 = 512;
/// Edge length of a square of ground: a street runs along its borders.
pub(super) const SQUARE: i32 = 64;
/// The ground reaches down to this.
const FLOOR: f32 = -64.0;

/// Something on the land, relative to a place.
#[derive(Debug, Clone)]
pub(super) struct Thing {
    pub(super) shape: Shape,
    pub(super) hides: bool,
}

/// The land of a seed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Land {
    pub(super) seed: u64,
    /// How much stands on the ground: 1 is some two thousand things in a page of a town.
    pub(super) density: f32,
}

/// A coordinate with few digits.
fn sixteenths(v: f32) -> f32 {
    (v * 16.0).round() / 16.0
}

fn whole(v: Vec3) -> Vec3 {
    Vec3::from_array(v.to_array().map(sixteenths))
}

/// Random numbers of one part of the land.
struct Dice(Generator);

impl Dice {
    fn range(&mut self, lo: f32, hi: f32) -> f32 {
        sixteenths(lo + (hi - lo) * self.0.random::<f32>())
    }

    fn below(&mut self, n: u32) -> u32 {
        self.0.random_range(0..n)
    }
}

impl Land {
    fn dice(&self, x: i32, z: i32, stream: u64) -> Dice {
        let place = u64::from(x as u32) << 32 | u64::from(z as u32);
        Dice(generator(spread(self.seed) ^ spread(spread(place)), stream))
    }

    /// The height of a square of ground: hills some hundred metres wide.
    pub(super) fn height(&self, square: IVec2) -> f32 {
        let mut sum = 0.0;
        for (wide, high) in [(32, 40.0), (8, 12.0)] {
            let corner = |x: i32, z: i32| self.dice(x, z, wide as u64).range(-high, high);
            let (cell, part) = (square.div_euclid(IVec2::splat(wide)), square.rem_euclid(IVec2::splat(wide)));
            let share = part.as_vec2() / wide as f32;
            let row = |z: i32| corner(cell.x, z) * (1.0 - share.x) + corner(cell.x + 1, z) * share.x;
            sum += row(cell.y) * (1.0 - share.y) + row(cell.y + 1) * share.y;
        }
        (sum * 2.0).round() / 2.0
    }

    /// The highest ground around a place.
    pub(super) fn ground(&self, at: DVec3) -> f32 {
        let corner =
            IVec2::new((at.x / f64::from(SQUARE)).round() as i32, (at.z / f64::from(SQUARE)).round() as i32);
        let around = [(0, 0), (-1, 0), (0, -1), (-1, -1)];
        around.iter().map(|&(x, z)| self.height(corner + IVec2::new(x, z))).fold(FLOOR, f32::max)
    }

    /// The things of a page, relative to its corner; its height is 0.
    pub(super) fn things(&self, page: PageId) -> Vec<Thing> {
        let mut things = Vec::new();
        // Towns and woods cover several pages each.
        let kind = self.dice(page.x.div_euclid(3), page.z.div_euclid(2), 7).below(3);
        let squares = PAGE / SQUARE;
        for z in 0..squares {
            for x in 0..squares {
                let square = IVec2::new(page.x * squares + x, page.z * squares + z);
                let corner = Vec3::new((x * SQUARE) as f32, self.height(square), (z * SQUARE) as f32);
                let ground = Vec3::new(SQUARE as f32, 0.0, SQUARE as f32);
                boxed(&mut things, Vec3 { y: FLOOR, ..corner }, corner + ground, true);
                let mut dice = self.dice(square.x, square.y, 3);
                match kind {
                    0 => self.town(&mut dice, corner, &mut things),
                    1 => self.wood(&mut dice, corner, &mut things),
                    _ => self.hills(&mut dice, corner, &mut things),
                }
            }
        }
        things
    }

    fn count(&self, n: f32) -> usize {
        (n * self.density).round() as usize
    }

    /// A block of houses with things in the streets around it.
    fn town(&self, dice: &mut Dice, corner: Vec3, things: &mut Vec<Thing>) {
        for (x, z, wide, deep) in [
            (8.0, 8.0, 48.0, 12.0),
            (8.0, 44.0, 48.0, 12.0),
            (8.0, 20.0, 12.0, 24.0),
            (44.0, 20.0, 12.0, 24.0),
        ] {
            let min = corner + Vec3::new(x, 0.0, z);
            let size = Vec3::new(wide, dice.range(6.0, 30.0), deep);
            boxed(things, min, min + size, true);
        }
        for _ in 0..self.count(28.0) {
            let at = corner + Vec3::new(dice.range(0.0, 63.0), 0.0, dice.range(0.0, 63.0));
            let size = Vec3::new(dice.range(0.2, 1.0), dice.range(0.3, 2.0), dice.range(0.2, 1.0));
            boxed(things, at, at + size, false);
        }
    }

    /// Trees: trunks hide, crowns do not.
    fn wood(&self, dice: &mut Dice, corner: Vec3, things: &mut Vec<Thing>) {
        for _ in 0..self.count(14.0) {
            let at = corner + Vec3::new(dice.range(8.0, 56.0), 0.0, dice.range(8.0, 56.0));
            let high = dice.range(4.0, 12.0);
            boxed(things, at, at + Vec3::new(0.5, high, 0.5), true);
            let radius = dice.range(1.0, 3.0);
            let center = whole(at + Vec3::new(0.25, high + radius, 0.25));
            things.push(Thing { shape: Shape::Sphere { center, radius }, hides: false });
        }
    }

    /// Rocks.
    fn hills(&self, dice: &mut Dice, corner: Vec3, things: &mut Vec<Thing>) {
        for _ in 0..self.count(8.0) {
            let at = corner + Vec3::new(dice.range(8.0, 54.0), 0.0, dice.range(8.0, 54.0));
            let size = Vec3::new(dice.range(1.0, 8.0), dice.range(0.5, 5.0), dice.range(1.0, 8.0));
            boxed(things, at, at + size, true);
        }
    }
}

fn boxed(things: &mut Vec<Thing>, min: Vec3, max: Vec3, hides: bool) {
    things.push(Thing { shape: Shape::Box { min, max }, hides });
}

impl Thing {
    /// As the library takes it.
    pub(super) fn desc(&self) -> ObjectDesc {
        match self.shape {
            Shape::Sphere { center, radius } => {
                let ball = Sphere::new(center, radius);
                let desc = ObjectDesc::fixed(ball);
                if self.hides { desc.occluder(ball) } else { desc }
            }
            Shape::Box { min, max } => {
                let b = Aabb::new(min, max);
                let desc = ObjectDesc::fixed(b);
                if self.hides { desc.occluder(b) } else { desc }
            }
            Shape::Mesh { .. } => unreachable!("the land has no meshes"),
        }
    }

    /// The shape relative to the eye, of a thing at a place: exact where both have few digits.
    pub(super) fn seen_from(&self, place: DVec3, eye: DVec3) -> Shape {
        let by = (place - eye).as_vec3();
        match self.shape {
            Shape::Sphere { center, radius } => Shape::Sphere { center: center + by, radius },
            Shape::Box { min, max } => Shape::Box { min: min + by, max: max + by },
            Shape::Mesh { .. } => unreachable!("the land has no meshes"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_the_same_again_and_all_its_corners_have_few_digits() {
        let land = Land { seed: 1, density: 1.0 };
        let mut counts = Vec::new();
        for x in 0..9 {
            let things = land.things(PageId::new(x, 0, 4));
            assert_eq!(format!("{things:?}"), format!("{:?}", land.things(PageId::new(x, 0, 4))));
            for thing in &things {
                let Shape::Box { min, max } = thing.shape else { continue };
                assert!(whole(min) == min && whole(max) == max && min.cmplt(max).all());
            }
            counts.push(things.len());
        }
        counts.sort_unstable();
        counts.dedup();
        assert!(counts.len() > 1 && counts[0] > 64, "{counts:?}");
    }
}
