//! A map, the guards that walk on it, and what the eye sees.

use casca_maps::Drawing;
use casca_plane::{
    BitGrid, Disc, FieldOfView, FovOptions, GridSpec, ObjectDesc, ObjectId, Query, Scene, TileLayer,
    TilePoint, View,
};
use casca_scenes::world::FRAME_SECONDS;
use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::common::Failed;

/// The radius of guards in tiles, and how far they walk in a second.
pub const RADIUS: f32 = 0.36;
const SPEED: f32 = 1.6;
/// How near the eye comes to walls, in tiles.
const MARGIN: f32 = 0.2;
/// Guards on maps that place none.
const GUARDS: u32 = 14;
/// Of so many doors one is closed.
const CLOSED: usize = 3;

/// A guard walks along an axis, through the middles of tiles.
struct Guard {
    id: ObjectId,
    at: Vec2,
    /// A direction; none before it walks.
    way: Vec2,
}

/// A map, the guards that walk on it, and what the eye sees.
pub struct Level {
    /// Its name.
    pub name: String,
    /// The walls and closed doors.
    pub layer: TileLayer,
    /// The closed doors.
    pub doors: Vec<(u32, u32)>,
    scene: Scene,
    guards: Vec<Guard>,
    /// Where the eye is.
    pub eye: Vec2,
    query: Query,
    fov: FieldOfView,
    /// The tiles that the eye sees.
    pub seen: BitGrid,
    random: Pcg64Mcg,
}

fn middle((x, y): (u32, u32)) -> Vec2 {
    Vec2::new(x as f32, y as f32) + 0.5
}

impl Level {
    /// A map with its guards, or some if it places none, which walk as a seed has it.
    ///
    /// # Errors
    /// It has no free tile.
    pub fn new(name: &str, mut map: Drawing, seed: u64) -> Result<Self, Failed> {
        let (width, height) = (map.walls.width(), map.walls.height());
        let doors: Vec<_> = map.doors.iter().step_by(CLOSED).copied().collect();
        doors.iter().for_each(|&(x, y)| map.walls.set(x, y, true));
        let mut free: Vec<_> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
        free.retain(|&(x, y)| !map.walls.get(x, y));
        if free.is_empty() {
            return Err("the map has no free tile".into());
        }
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        if map.guards.is_empty() {
            map.guards = (0..GUARDS).map(|_| free[random.random_range(0..free.len())]).collect();
        }
        let start = map.start.filter(|at| free.contains(at));
        let start = start.unwrap_or_else(|| free[random.random_range(0..free.len())]);
        let layer = TileLayer::new(Vec2::ZERO, 1.0, map.walls)?;
        let dims = UVec2::new(width, height);
        let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims })?;
        scene.insert_tiles(&layer)?;
        let mut placed = Vec::new();
        for at in map.guards.into_iter().filter(|at| free.contains(at)) {
            let id = scene.insert(ObjectDesc::new(Disc::new(middle(at), RADIUS)))?;
            placed.push(Guard { id, at: middle(at), way: Vec2::ZERO });
        }
        let mut level = Self {
            name: name.to_owned(),
            seen: BitGrid::new(width, height),
            layer,
            doors,
            scene,
            guards: placed,
            eye: middle(start),
            query: Query::new(),
            fov: FieldOfView::new(),
            random,
        };
        level.look()?;
        Ok(level)
    }

    /// A floor plan with guards.
    pub fn floor_plan(seed: u64) -> Result<Self, Failed> {
        Self::new(&format!("rooms-{seed}"), Drawing::rooms(72, 40, seed), seed)
    }

    /// The map's size in tiles.
    pub fn size(&self) -> (u32, u32) {
        (self.layer.opaque().width(), self.layer.opaque().height())
    }

    /// The visible region.
    pub fn region(&self) -> Vec<Vec2> {
        self.query.polygon()
    }

    /// Where each guard is, and whether the eye can see it.
    pub fn guards(&self) -> impl Iterator<Item = (Vec2, bool)> {
        self.guards.iter().map(|guard| (guard.at, self.query.pvs().contains(guard.id)))
    }

    /// What there is to say.
    pub fn lines(&self) -> Vec<String> {
        let visible = self.guards().filter(|(_, visible)| *visible).count();
        let (width, height) = self.size();
        let tiles = self.seen.cells().count();
        vec![
            format!("{}: {visible} of {} guards are visible", self.name, self.guards.len()),
            format!("{tiles} of {} tiles are visible", width * height),
        ]
    }

    /// A frame passes, and the eye goes to a place, or as near as walls let it.
    pub fn step(&mut self, to: Vec2) -> Result<(), Failed> {
        self.eye = self.slide(to);
        for i in 0..self.guards.len() {
            self.walk(i);
            let Guard { id, at, .. } = self.guards[i];
            self.scene.update(id, Disc::new(at, RADIUS), None)?;
        }
        self.look()
    }

    fn look(&mut self) -> Result<(), Failed> {
        self.query.run(&self.scene, &View::all_round(self.eye)?);
        let at = TilePoint::new(self.eye.x.into(), self.eye.y.into())?;
        self.seen.clone_from(self.fov.run(self.layer.opaque(), at, &FovOptions::default()));
        Ok(())
    }

    fn is_free(&self, at: Vec2) -> bool {
        let (width, height) = self.size();
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < width as f32 && at.y < height as f32;
        inside && !self.layer.opaque().get(at.x as u32, at.y as u32)
    }

    /// The last free place on the way to `to`, along one axis after the other, so that the eye
    /// slides along walls and passes none.
    fn slide(&self, to: Vec2) -> Vec2 {
        let mut at = self.eye;
        if !to.is_finite() {
            return at;
        }
        let (width, height) = self.size();
        let to = to.clamp(Vec2::ZERO, Vec2::new(width as f32, height as f32));
        for axis in [Vec2::X, Vec2::Y] {
            let way = (to - at) * axis;
            // Shorter than the margin, so that no wall is passed over.
            let steps = (way.length() / (0.5 * MARGIN)).ceil().max(1.0);
            for _ in 0..steps as u32 {
                let next = at + way / steps;
                let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
                if !corners.iter().all(|&(x, y)| self.is_free(next + Vec2::new(x, y) * MARGIN)) {
                    break;
                }
                at = next;
            }
        }
        at
    }

    /// Lets a guard go on; before a wall it stops on the middle of its tile and turns.
    fn walk(&mut self, i: usize) {
        let Guard { at, way, .. } = self.guards[i];
        let next = at + way * (SPEED * FRAME_SECONDS as f32);
        if way != Vec2::ZERO && self.is_free(next + 0.5 * way) {
            self.guards[i].at = next;
            return;
        }
        let at = at.floor() + 0.5;
        let free = [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y].into_iter().filter(|way| self.is_free(at + *way));
        let free: Vec<Vec2> = free.collect();
        let turned = (!free.is_empty()).then(|| free[self.random.random_range(0..free.len())]);
        (self.guards[i].at, self.guards[i].way) = (at, turned.unwrap_or(Vec2::ZERO));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_maps::HARBOUR;

    #[test]
    fn the_eye_passes_no_wall_and_hidden_guards_are_behind_walls() {
        let mut level = Level::new("harbour", Drawing::read(HARBOUR), 1).unwrap();
        let (width, height) = level.size();
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let (mut seen, mut hidden) = (0, 0);
        for _ in 0..400 {
            let far = Vec2::new(width as f32, height as f32);
            let to = far * Vec2::new(random.random_range(-0.2..1.2), random.random_range(-0.2..1.2));
            let from = level.eye;
            level.step(to).unwrap();
            assert!(level.is_free(level.eye), "{to}");
            // Along each axis alone, no wall lies between.
            let corner = Vec2::new(level.eye.x, from.y);
            for (a, b) in [(from, corner), (corner, level.eye)] {
                assert!((0..=1000).all(|i| level.is_free(a.lerp(b, i as f32 / 1000.0))), "{from} {to}");
            }
            for (at, visible) in level.guards() {
                assert!(level.is_free(at), "guards walk on free tiles");
                // A line of sight to the middle of a guard that no wall touches.
                let sees = (0..=4000).all(|i| level.is_free(level.eye.lerp(at, i as f32 / 4000.0)));
                assert!(visible || !sees, "{at} from {}", level.eye);
                *if visible { &mut seen } else { &mut hidden } += 1;
            }
        }
        assert!(seen > 100 && hidden > 100, "{seen} {hidden}");
        let before = level.eye;
        level.step(Vec2::NAN).unwrap();
        assert_eq!(level.eye, before);
    }
}
