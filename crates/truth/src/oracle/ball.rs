//! Exact visibility from anywhere in a ball of eyes.

use glam::{DVec3, Vec3};
use rand::RngExt;
use rayon::prelude::*;

use super::frustum::Frustum;
use super::item_buffer::ItemBuffer;
use super::{FalseNegative, FrameVerdict, Oracle, OracleOptions};
use crate::numeric::oracle::LEAST_IN_BALL;
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Camera, Object, Shape};

/// Rims of occluders that are looked past, in a frame.
const RIMS: usize = 512;

/// How much a [`BallOracle`] looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BallOptions {
    /// The item buffers, and the rays from each eye to each object that no eye has seen yet.
    pub each: OracleOptions,
    /// Eyes in a ball.
    pub eyes: usize,
    /// How many of those get an item buffer; the others look along rays only.
    pub buffers: usize,
    /// Rays from each eye past the rims of occluders.
    pub past_rims: usize,
}

impl Default for BallOptions {
    fn default() -> Self {
        let each =
            OracleOptions { width: 640, height: 360, samples_per_object: 4, max_candidates: 4000, seed: 1 };
        Self { each, eyes: 64, buffers: 64, past_rims: 512 }
    }
}

/// An object that an eye sees, beyond the doubt of rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallSighting {
    /// The object.
    pub object: usize,
    /// The eye.
    pub eye: Vec3,
    /// Where the ray starts: on the near plane of that eye.
    pub origin: DVec3,
    /// The point that is seen.
    pub target: DVec3,
}

/// How much was looked at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BallCounts {
    /// Eyes.
    pub eyes: u64,
    /// Rays aimed at objects and past rims.
    pub rays: u64,
    /// Rays of item buffers: their pixels.
    pub item_rays: u64,
}

/// What is known about an object.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Seen {
    #[default]
    Never,
    /// By an item buffer, where rounding leaves a doubt.
    Perhaps,
    Surely(BallSighting),
}

/// Finds the objects that can be seen from anywhere in balls around the eye of a camera, as far as
/// sampled.
///
/// [`BallOracle::begin`] looks from the centre, [`BallOracle::look`] from eyes in a ball; balls of
/// one frame that are asked for from the smallest to the greatest share their sightings. Of the
/// eyes, half are on the surface of the ball beside the rims of occluders, so that they look past
/// them; the others are anywhere on the surface or inside. The camera moves without turning, and
/// through walls: a solid that holds an eye hides nothing from it.
pub struct BallOracle {
    oracle: Oracle,
    options: BallOptions,
    random: Generator,
    camera: Option<Camera>,
    rims: Vec<Rim>,
    seen: Vec<Seen>,
    counts: BallCounts,
}

impl BallOracle {
    /// An oracle for these objects as they are now.
    pub fn new(objects: &[Object], options: BallOptions) -> Self {
        Self {
            oracle: Oracle::new(objects, options.each),
            options,
            random: generator(options.each.seed, 0xba11),
            camera: None,
            rims: Vec::new(),
            seen: Vec::new(),
            counts: BallCounts::default(),
        }
    }

    /// Looks from the eye of a camera. `moved` are the objects that have another shape than in the
    /// frame before.
    pub fn begin(&mut self, objects: &[Object], moved: &[usize], camera: &Camera) {
        self.seen.clear();
        self.seen.resize(objects.len(), Seen::Never);
        self.camera = Some(*camera);
        self.oracle.update(objects, moved);
        self.eye(objects, camera, true);
        let frustum = Frustum::new(camera);
        self.rims = rims(&self.oracle.buffer, &frustum, RIMS, &mut self.random);
        // The centre gets as many rays as a ball.
        for _ in 1..self.options.eyes {
            self.eye(objects, camera, false);
        }
    }

    /// Looks from eyes within `reach` of the centre.
    pub fn look(&mut self, objects: &[Object], reach: f32) {
        let Some(center) = self.camera else { return };
        for i in 0..self.options.eyes {
            let camera = center.at(self.place(center.eye, f64::from(reach), i));
            self.eye(objects, &camera, i < self.options.buffers);
            self.look_past_rims(objects, &camera);
        }
    }

    /// An eye in the ball.
    fn place(&mut self, center: Vec3, reach: f64, number: usize) -> Vec3 {
        let random = &mut self.random;
        let any = loop {
            let p = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
            if p.length_squared() <= 1.0 && p.length() > LEAST_IN_BALL {
                break p;
            }
        };
        let step = match number % 4 {
            0 | 1 if !self.rims.is_empty() => self.rims[random.random_range(0..self.rims.len())].out,
            3 => any,
            _ => any.normalize(),
        };
        within(center, step, reach)
    }

    /// Looks from an eye at all objects that none has seen yet.
    fn eye(&mut self, objects: &[Object], camera: &Camera, draws: bool) {
        if draws {
            self.oracle.buffer.draw(&self.oracle.rays, objects, camera);
        }
        let seen = &self.seen;
        let FrameVerdict { rays, item_rays, false_negatives, unconfirmed, .. } =
            self.oracle.judge(objects, camera, draws, &|i| matches!(seen[i], Seen::Surely(_)));
        self.counts.eyes += 1;
        self.counts.rays += rays;
        self.counts.item_rays += item_rays;
        for object in unconfirmed {
            self.seen[object] = Seen::Perhaps;
        }
        for FalseNegative { object, origin, target, .. } in false_negatives {
            self.seen[object] = Seen::Surely(BallSighting { object, eye: camera.eye, origin, target });
        }
    }

    /// Looks along rays that pass the rims of occluders closely.
    fn look_past_rims(&mut self, objects: &[Object], camera: &Camera) {
        if self.rims.is_empty() {
            return;
        }
        let (rims, random) = (&self.rims, &mut self.random);
        let aims: Vec<DVec3> = (0..self.options.past_rims)
            .map(|_| {
                let rim = rims[random.random_range(0..rims.len())];
                let room =
                    10f64.powf(random.random_range(-6.0..-1.5)) * rim.point.distance(camera.eye.as_dvec3());
                rim.point + rim.out * room
            })
            .collect();
        let (frustum, oracle, seen) = (Frustum::new(camera), &self.oracle, &self.seen);
        let found: Vec<BallSighting> = aims
            .par_iter()
            .filter_map(|aim| {
                let origin = frustum.start(*aim);
                let step = *aim - frustum.eye();
                let (object, t) = oracle.rays.first_hit(origin, step)?;
                let target = origin + step * t;
                let new = objects[object].tested && !matches!(seen[object], Seen::Surely(_));
                let is_mesh = matches!(objects[object].shape, Shape::Mesh { .. });
                (new && frustum.surely_contains(target)
                    && oracle.rays.surely_sees(origin, target, object, is_mesh))
                .then_some(BallSighting { object, eye: camera.eye, origin, target })
            })
            .collect();
        self.counts.rays += aims.len() as u64;
        for sighting in found {
            self.seen[sighting.object] = Seen::Surely(sighting);
        }
    }

    /// The tested objects seen from the centre or the balls of this frame, ascending.
    pub fn exact(&self) -> Vec<usize> {
        (0..self.seen.len()).filter(|&i| self.seen[i] != Seen::Never).collect()
    }

    /// The objects seen beyond doubt that a set lacks, ascending.
    pub fn missing(&self, set: impl Fn(usize) -> bool) -> Vec<BallSighting> {
        let sure = self.seen.iter().filter_map(|seen| match seen {
            Seen::Surely(sighting) => Some(*sighting),
            _ => None,
        });
        sure.filter(|s| !set(s.object)).collect()
    }

    /// How much was looked at in all frames.
    pub fn counts(&self) -> BallCounts {
        self.counts
    }
}

/// The place a step of length 1 or less from a centre, in units of `reach`; rounded, but no farther
/// than `reach`.
fn within(center: Vec3, step: DVec3, reach: f64) -> Vec3 {
    let from = center.as_dvec3();
    let mut share = 1.0;
    // The rounding of the coordinates may be a large part of a small reach.
    for _ in 0..20 {
        let place = (from + step * (reach * share)).as_vec3();
        if place.as_dvec3().distance(from) <= reach {
            return place;
        }
        share -= 0.05 * (1.05 - share);
    }
    center
}

/// Depths that differ by a smaller share belong to one surface.
const STEP: f64 = 0.01;

/// A point at the rim of an occluder.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rim {
    /// The point, on the occluder.
    point: DVec3,
    /// The unit vector across the way to the point, away from the occluder.
    out: DVec3,
}

/// Points at rims that an item buffer shows, at most this many. Nearer rims, and those with more
/// room behind them, come more often: an eye that moves sees more past them.
fn rims(buffer: &ItemBuffer, frustum: &Frustum, most: usize, random: &mut Generator) -> Vec<Rim> {
    let (width, items, depths) = (buffer.width(), buffer.items(), buffer.depths());
    let mut kept: Vec<(f64, usize, usize)> = Vec::new();
    let mut offer = |a: usize, b: usize| {
        let (near, far) = if depths[a] < depths[b] { (a, b) } else { (b, a) };
        if items[a] == items[b] || depths[far] < depths[near] * (1.0 + STEP) {
            return;
        }
        // The greatest keys are a sample with these weights (Efraimidis & Spirakis 2006).
        let weight = 1.0 / depths[near] - 1.0 / depths[far];
        let key = random.random::<f64>().ln() / weight;
        kept.push((key, near, far));
        if kept.len() >= 4 * most.max(1) {
            keep(&mut kept, most);
        }
    };
    for pixel in 0..items.len() {
        if pixel % width + 1 < width {
            offer(pixel, pixel + 1);
        }
        if pixel + width < items.len() {
            offer(pixel, pixel + width);
        }
    }
    keep(&mut kept, most);
    let rim = |&(_, near, far): &(f64, usize, usize)| {
        let (origin, step) = buffer.pixel_ray(frustum, near);
        let (_, beside) = buffer.pixel_ray(frustum, far);
        let across = beside - step;
        let out = (across - step * (across.dot(step) / step.length_squared())).normalize_or_zero();
        Rim { point: origin + step * (depths[near] - frustum.near()), out }
    };
    kept.iter().map(rim).filter(|r| r.out != DVec3::ZERO && r.point.is_finite()).collect()
}

/// Keeps those with the greatest keys.
fn keep(kept: &mut Vec<(f64, usize, usize)>, most: usize) {
    kept.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    kept.truncate(most);
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;

    use super::super::tests::{cuboid, object};
    use super::*;
    use casca_scenes::world::Mesh;

    fn ball(center: [f32; 3], radius: f32) -> Object {
        object(Shape::Sphere { center: center.into(), radius })
    }

    fn camera() -> Camera {
        Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 16.0 / 9.0, 0.1, 200.0)
    }

    fn options() -> BallOptions {
        let each = OracleOptions { width: 320, height: 180, ..BallOptions::default().each };
        BallOptions { each, buffers: 8, ..BallOptions::default() }
    }

    /// The least of these reaches at which an object is seen.
    fn first_seen(objects: &[Object], object: usize, reaches: &[f32]) -> Option<f32> {
        let mut oracle = BallOracle::new(objects, options());
        oracle.begin(objects, &[], &camera());
        assert!(!oracle.exact().contains(&object), "hidden from the centre");
        let found = reaches.iter().copied().find(|&reach| {
            oracle.look(objects, reach);
            oracle.missing(|_| false).iter().any(|s| s.object == object)
        });
        for s in oracle.missing(|_| false) {
            let far = (s.eye - camera().eye).as_dvec3().length();
            assert!(far <= f64::from(found.unwrap_or(reaches[reaches.len() - 1])), "{s:?}");
        }
        found
    }

    #[test]
    fn an_object_behind_a_rim_is_seen_as_soon_as_an_eye_can_look_past_it() {
        // The line that touches the ball and the wall's edge at (1, 0, -4.1) passes the centre at a
        // distance of 1.49 m.
        let wall = cuboid([-6.0, -9.0, -4.1], [1.0, 9.0, -4.0]);
        let reaches = [0.5, 1.0, 1.4, 2.0];
        assert_eq!(first_seen(&[wall, ball([0.5, 0.0, -8.0], 0.02)], 1, &reaches), Some(2.0));
    }

    #[test]
    fn a_sheet_hides_less_through_a_hole_than_from_its_rim() {
        // A sheet with a square hole; the object is 0.3 m beside the line through it.
        let sheet = Mesh {
            positions: [-9.0, -0.05, 0.05, 9.0]
                .into_iter()
                .flat_map(|y| [-9.0, -0.05, 0.05, 9.0].map(|x| Vec3::new(x, y, -2.0)))
                .collect(),
            triangles: (0..9u32)
                .filter(|&i| i != 4)
                .flat_map(|i| {
                    let a = i / 3 * 4 + i % 3;
                    [[a, a + 1, a + 5], [a, a + 5, a + 4]]
                })
                .collect(),
            ..Mesh::default()
        };
        let sheet = object(Shape::Mesh { mesh: sheet.into(), transform: Affine3A::IDENTITY });
        // At twice the distance of the sheet, the eye has to go 0.4 - 2 * 0.05 = 0.3 m.
        let behind = ball([0.42, 0.0, -4.0], 0.02);
        assert_eq!(first_seen(&[sheet, behind], 1, &[0.1, 0.2, 0.28, 0.33, 0.5]), Some(0.33));
    }

    #[test]
    fn what_no_eye_sees_is_never_missing_and_known_objects_stay_known() {
        let wall = cuboid([-9.0, -9.0, -6.0], [9.0, 9.0, -5.0]);
        let objects = [wall, ball([0.0, 0.0, -8.0], 0.5), ball([0.3, 0.0, -3.0], 0.2)];
        let mut oracle = BallOracle::new(&objects, options());
        oracle.begin(&objects, &[], &camera());
        assert_eq!(oracle.exact(), [0, 2]);
        for reach in [0.0, 0.01, 0.5, 1.0] {
            oracle.look(&objects, reach);
            assert_eq!(oracle.exact(), [0, 2], "{reach}");
        }
        assert_eq!(oracle.missing(|i| i == 0).iter().map(|s| s.object).collect::<Vec<_>>(), [2]);
        assert!(oracle.missing(|_| true).is_empty());
        let counts = oracle.counts();
        assert_eq!((counts.eyes, counts.item_rays), (64 * 5, (1 + 4 * 8) * 320 * 180));
        assert!(counts.rays > 4 * 64 * 512);
        oracle.begin(&objects[..2], &[], &camera());
        assert_eq!(oracle.exact(), [0], "a new frame knows nothing of the last");
    }

    #[test]
    fn eyes_stay_in_the_ball_wherever_it_is() {
        for center in [Vec3::ZERO, Vec3::new(100.3, -7.7, 3.3), Vec3::splat(20_000.1)] {
            for reach in [0.0, 0.001, 0.01, 0.5, 3.0] {
                let mut far = 0f64;
                for i in 0..100 {
                    let (sin, cos) = (f64::from(i) * 0.7).sin_cos();
                    let place = within(center, DVec3::new(sin * 0.6, cos, sin * 0.8), reach);
                    far = far.max(place.as_dvec3().distance(center.as_dvec3()));
                }
                assert!(far <= reach && (far >= 0.9 * reach || reach < 0.01), "{center} {reach}: {far}");
            }
        }
    }
}
