//! What exact rays see of bots, for the example and the tests.

use casca_scenes::world::{Motion, Object, Shape};
use casca_server::bots::{Level, Moment};
use casca_server::casca::glam::Vec3;
use casca_truth::oracle::RayOracle;

/// Rays from an eye to a body, at one moment.
const RAYS: usize = 8;

/// The level with all bots in it, for rays.
pub struct Truth {
    objects: Vec<Object>,
    walls: usize,
    oracle: RayOracle,
}

impl Truth {
    /// All that hides, and the bots.
    pub fn new(level: &Level, moment: &Moment) -> Self {
        let mut objects: Vec<Object> = level.objects.clone();
        let walls = objects.len();
        objects.extend(moment.bodies.iter().map(|body| Object {
            name: String::new(),
            shape: Shape::Box { min: body.min, max: body.max },
            motion: Motion::Dynamic { max_speed: 5.0 },
            occludes: false,
            tested: true,
        }));
        let oracle = RayOracle::new(&objects);
        Self { objects, walls, oracle }
    }

    /// Moves the bots.
    pub fn set(&mut self, moment: &Moment) {
        for (object, body) in self.objects[self.walls..].iter_mut().zip(&moment.bodies) {
            object.shape = Shape::Box { min: body.min, max: body.max };
        }
        let moved: Vec<usize> = (self.walls..self.objects.len()).collect();
        self.oracle.update(&self.objects, &moved);
    }

    /// Marks those of some bots that an eye sees.
    pub fn look(&self, eye: Vec3, bots: &[usize], seed: u64, seen: &mut [bool]) {
        let candidates: Vec<usize> = bots.iter().map(|bot| self.walls + bot).collect();
        let report = self.oracle.probe(&self.objects, eye.as_dvec3(), &candidates, RAYS, seed, |_| true);
        report.seen.iter().for_each(|sighting| seen[sighting.object - self.walls] = true);
    }
}
