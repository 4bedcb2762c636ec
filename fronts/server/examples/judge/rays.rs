//! What rays say: exact ones, and those that servers cast to boxes.

use std::time::Instant;

use casca_scenes::world::{Motion, Object, Shape};
use casca_server::bots::{Level, Match, Moment};
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

/// What rays to boxes say from where eyes were reported, by client and bot: from the eye, and from
/// the middle and the corners of the square that it may be in.
pub fn by_rays(game: &Match, rays: &RayOracle, n: usize, seconds: &mut [f64; 3]) -> Vec<[bool; 2]> {
    let server = &game.server;
    let clients: Vec<_> = server.clients().map(|(id, desc)| (id, *desc)).collect();
    let boxes: Vec<_> = server.entities().map(|(_, entity)| entity.desc().bounds).collect();
    let mut told = vec![[false; 2]; n * n];
    let begin = Instant::now();
    for (i, (_, desc)) in clients.iter().enumerate() {
        for (j, b) in boxes.iter().enumerate() {
            told[i * n + j][0] = rays.nine_rays(desc.eye, b.min, b.max);
        }
    }
    seconds[1] += begin.elapsed().as_secs_f64();
    let begin = Instant::now();
    for (i, (id, desc)) in clients.iter().enumerate() {
        let reach = server.answer(*id).map_or(0.0, |answer| answer.reach) as f32;
        let corner = |x: f32, z: f32| desc.eye + Vec3::new(x, 0.0, z) * reach;
        let places = [desc.eye, corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)];
        for (j, b) in boxes.iter().enumerate() {
            told[i * n + j][1] = places.iter().any(|&eye| rays.nine_rays(eye, b.min, b.max));
        }
    }
    seconds[2] += begin.elapsed().as_secs_f64();
    told
}
