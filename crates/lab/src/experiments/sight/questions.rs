//! Boxes and points to ask about.

use casca::Aabb;
use glam::Vec3;
use rand::{Rng, RngExt};

use casca_scenes::random::generator;
use casca_scenes::world::{Camera, GridHint};
use casca_truth::oracle::Frustum;

/// The longest edge of a box, as a share of the diagonal of the scene's region: from small things
/// to large rooms.
const EDGES: (f32, f32) = (0.001, 0.05);

/// The shortest edge of a box over its longest one, at least.
const FLATTEST: f32 = 0.3;

/// Places tried for one question. A camera that looks out of the region would have none.
const TRIES: usize = 10_000;

/// So many boxes and as many points in a scene's region, the middles of the boxes and the points
/// inside the frustum. Fewer if the frustum holds next to nothing of the region.
pub(super) fn questions(
    region: &GridHint,
    camera: &Camera,
    count: usize,
    seed: u64,
) -> (Vec<Aabb>, Vec<Vec3>) {
    let mut random = generator(seed, 0);
    let frustum = Frustum::new(camera);
    let diagonal = (region.max - region.min).length();
    let boxes = (0..count).filter_map(|_| {
        let longest = diagonal * EDGES.0 * (EDGES.1 / EDGES.0).powf(random.random());
        let half = (Vec3::splat(FLATTEST) + (1.0 - FLATTEST) * unit(&mut random)) * longest * 0.5;
        let middle = place(region, &frustum, &mut random, |p| (camera.eye - p).abs().cmpgt(half).any())?;
        Some(Aabb::new(middle - half, middle + half))
    });
    let boxes = boxes.collect();
    let points = (0..count).filter_map(|_| place(region, &frustum, &mut random, |_| true));
    (boxes, points.collect())
}

/// Three numbers from 0 to 1.
fn unit(random: &mut impl Rng) -> Vec3 {
    Vec3::new(random.random(), random.random(), random.random())
}

/// A point of the region inside the frustum, as `fits` wants it.
fn place(
    region: &GridHint,
    frustum: &Frustum,
    random: &mut impl Rng,
    fits: impl Fn(Vec3) -> bool,
) -> Option<Vec3> {
    let anywhere = (0..TRIES).map(|_| region.min + (region.max - region.min) * unit(random));
    anywhere.into_iter().find(|&p| frustum.contains(p.as_dvec3()) && fits(p))
}
