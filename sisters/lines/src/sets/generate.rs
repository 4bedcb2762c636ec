//! Seeded sets of lines, which move with a time: stand-ins for the models of the thesis, and
//! streamlines.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::sets::random::{Random, hash};
use crate::sets::{LineError, LineSet, MOST_VERTICES};

/// A kind of set. All lie within -1 to 1 in each direction, or very nearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Helices of mixed radii around one axis.
    Spiral,
    /// Field lines of a dipole: closed arcs from its middle.
    Dipole,
    /// Curved hairs from a ball outwards.
    PomPom,
    /// Streamlines of the Arnold-Beltrami-Childress flow (Dombre et al. 1986, "Chaotic streamlines
    /// in the ABC flows").
    Abc,
    /// Streamlines between wells in thin layers of ground: dense bundles that part and meet.
    Reservoir,
    /// Straight lines along z: the case that columns along the view serve worst.
    Parallel,
}

/// How a set is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Its kind.
    pub family: Family,
    /// The number of lines.
    pub lines: u32,
    /// The vertices of a line.
    pub vertices: u32,
    /// Seed of all that is random.
    pub seed: u64,
    /// Seconds since the start: sets turn, sway or drift slowly.
    pub time: f64,
}

impl Family {
    /// All kinds.
    pub const ALL: [Self; 6] =
        [Self::Spiral, Self::Dipole, Self::PomPom, Self::Abc, Self::Reservoir, Self::Parallel];

    /// The name on command lines.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spiral => "spiral",
            Self::Dipole => "dipole",
            Self::PomPom => "pompom",
            Self::Abc => "abc",
            Self::Reservoir => "reservoir",
            Self::Parallel => "parallel",
        }
    }

    /// The usual number of lines and of vertices of a line.
    pub fn usual(self) -> (u32, u32) {
        match self {
            Self::Spiral => (900, 200),
            Self::Dipole => (1500, 150),
            Self::PomPom => (3000, 60),
            Self::Abc => (600, 400),
            Self::Reservoir => (5000, 100),
            Self::Parallel => (1500, 2),
        }
    }
}

impl Recipe {
    /// A set of the usual size at time 0.
    pub fn new(family: Family, seed: u64) -> Self {
        let (lines, vertices) = family.usual();
        Self { family, lines, vertices, seed, time: 0.0 }
    }

    /// Makes the set. Each line depends on its own number and the seed only. Time: proportional to
    /// the vertices.
    ///
    /// # Errors
    /// If there are more than [`MOST_VERTICES`]. A time that is not finite is taken as 0.
    pub fn make(&self) -> Result<LineSet, LineError> {
        if u64::from(self.lines) * u64::from(self.vertices.max(1)) > MOST_VERTICES as u64 {
            return Err(LineError::TooMany);
        }
        let time = if self.time.is_finite() { self.time } else { 0.0 };
        let wells = Wells::new(self.seed);
        let line = |i: u32| {
            let mut random = Random::new(hash(self.seed).wrapping_add(u64::from(i)));
            let points = match self.family {
                Family::Spiral => self.curve(spiral(&mut random, time)),
                Family::Dipole => self.curve(dipole(&mut random, time)),
                Family::PomPom => self.curve(hair(&mut random, time)),
                Family::Parallel => self.curve(parallel(&mut random, time)),
                Family::Abc => self.abc(&mut random, time),
                Family::Reservoir => self.streamline(&wells, &mut random, time),
            };
            points.into_iter().map(|p| p.as_vec3())
        };
        LineSet::new((0..self.lines).map(line))
    }

    /// A curve sampled at even parameters from 0 to 1.
    fn curve(&self, at: impl Fn(f64) -> DVec3) -> Vec<DVec3> {
        let last = f64::from(self.vertices.max(2) - 1);
        (0..self.vertices).map(|i| at(f64::from(i) / last)).collect()
    }

    /// A path through a flow by steps of equal length (midpoint rule), until the flow or the box
    /// ends.
    fn path(
        &self,
        start: DVec3,
        step: f64,
        flow: impl Fn(DVec3) -> DVec3,
        ends: impl Fn(DVec3) -> bool,
    ) -> Vec<DVec3> {
        let mut points = Vec::with_capacity(self.vertices as usize);
        let mut at = start;
        for _ in 0..self.vertices {
            points.push(at);
            let middle = at + flow(at).normalize_or_zero() * step / 2.0;
            at += flow(middle).normalize_or_zero() * step;
            if ends(at) {
                break;
            }
        }
        points
    }

    fn abc(&self, random: &mut Random, time: f64) -> Vec<DVec3> {
        let start = DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
        let flow = move |p: DVec3| {
            let p = p * PI + DVec3::splat(time * 0.2);
            let (a, b, c) = (3f64.sqrt(), 2f64.sqrt(), 1.0);
            DVec3::new(
                a * p.z.sin() + c * p.y.cos(),
                b * p.x.sin() + a * p.z.cos(),
                c * p.y.sin() + b * p.x.cos(),
            )
        };
        self.path(start, 2.5 / f64::from(self.vertices.max(1)), flow, |p| p.abs().max_element() > 1.0)
    }

    fn streamline(&self, wells: &Wells, random: &mut Random, time: f64) -> Vec<DVec3> {
        let source = wells.sources[(random.unit() * wells.sources.len() as f64) as usize];
        let (sine, cosine) = (random.unit() * TAU).sin_cos();
        // Eight layers, with lines spread thinly in each.
        let layer = (random.unit() * 8.0).floor() / 8.0;
        let height = -0.3 + 0.6 * (layer + random.within(0.0, 0.06));
        let start = source + DVec2::new(cosine, sine) * 0.02;
        let flow = |p: DVec3| wells.flow(p.truncate(), layer, time).extend(0.0);
        let ends = |p: DVec3| {
            p.truncate().abs().max_element() > 1.0
                || wells.sinks.iter().any(|s| s.distance(p.truncate()) < 0.015)
        };
        let flat = self.path(start.extend(height), 3.0 / f64::from(self.vertices.max(1)), flow, ends);
        // Layers are warped, and lie flat: y is up.
        let bulge = |p: DVec3| 0.08 * (2.0 * p.x + layer * 9.0).sin() * (3.0 * p.y + time * 0.3).cos();
        flat.into_iter().map(|p| DVec3::new(p.x, p.z + bulge(p), p.y)).collect()
    }
}

fn spiral(random: &mut Random, time: f64) -> impl Fn(f64) -> DVec3 + use<> {
    let (radius, phase) = (random.within(0.15, 0.95).sqrt(), random.unit() * TAU + time * 0.4);
    let (turns, wave) = (random.within(2.0, 3.0), random.within(0.0, TAU));
    move |t| {
        let (sine, cosine) = (phase + t * turns * TAU).sin_cos();
        let r = radius * (0.9 + 0.1 * (wave + 4.0 * t * TAU).sin());
        DVec3::new(r * cosine, (2.0 * t - 1.0) * 0.9, r * sine)
    }
}

fn dipole(random: &mut Random, time: f64) -> impl Fn(f64) -> DVec3 + use<> {
    let (azimuth, reach) = (random.unit() * TAU + time * 0.3, random.within(0.03, 1.0).sqrt());
    move |t| {
        let (sine, cosine) = (0.15 + t * (PI - 0.3)).sin_cos();
        let r = reach * sine * sine;
        DVec3::new(r * sine * azimuth.cos(), r * cosine * 1.6, r * sine * azimuth.sin())
    }
}

fn hair(random: &mut Random, time: f64) -> impl Fn(f64) -> DVec3 + use<> {
    let z = random.within(-1.0, 1.0);
    let (y, x) = (random.unit() * TAU).sin_cos();
    let root = DVec3::new(x * (1.0 - z * z).sqrt(), y * (1.0 - z * z).sqrt(), z);
    let side = root.any_orthonormal_vector();
    let (curl, turn) = (random.within(0.1, 0.35), random.unit() * TAU);
    let sway = DVec3::new(0.1 * (time + root.y * 3.0).sin(), -0.2, 0.0);
    move |t| {
        let (sine, cosine) = (turn + t * 4.0).sin_cos();
        let bend = (side * cosine + root.cross(side) * sine) * curl * t;
        (root * (0.3 + 0.6 * t) + bend + sway * t * t).clamp(-DVec3::ONE, DVec3::ONE)
    }
}

fn parallel(random: &mut Random, time: f64) -> impl Fn(f64) -> DVec3 + use<> {
    let (x, y) = (random.within(-1.0, 1.0), random.within(-1.0, 1.0));
    let (middle, half) = (random.within(-0.5, 0.5), random.within(0.1, 0.5));
    let drift = 0.05 * (time + 5.0 * x).sin();
    move |t| DVec3::new(x, (y + drift).clamp(-1.0, 1.0), middle + (2.0 * t - 1.0) * half)
}

/// Where fluid is pressed into the ground, and where it is taken out.
struct Wells {
    sources: Vec<DVec2>,
    sinks: Vec<DVec2>,
}

impl Wells {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(hash(seed ^ 0x7765_6c6c));
        let mut some =
            |n| (0..n).map(|_| DVec2::new(random.within(-0.85, 0.85), random.within(-0.85, 0.85))).collect();
        Self { sources: some(5), sinks: some(6) }
    }

    /// The flow at a place: away from sources, to sinks, bent by ground that each layer has
    /// otherwise.
    fn flow(&self, p: DVec2, layer: f64, time: f64) -> DVec2 {
        let pull = |well: &DVec2| (p - *well) / ((p - *well).length_squared() + 1e-6);
        let away: DVec2 = self.sources.iter().map(pull).sum();
        let towards: DVec2 = self.sinks.iter().map(pull).sum();
        let bent =
            DVec2::new((7.0 * p.y + 20.0 * layer + time * 0.2).sin(), (6.0 * p.x - 13.0 * layer).cos());
        away / self.sources.len() as f64 - towards / self.sinks.len() as f64 + bent * 0.8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_fill_their_box_repeat_by_seed_and_move_smoothly() {
        for family in Family::ALL {
            let recipe = Recipe { lines: 300, ..Recipe::new(family, 4) };
            let set = recipe.make().unwrap();
            assert_eq!(set.len(), 300, "{family:?}");
            assert!(
                set.points().len() > 300 * recipe.vertices as usize / 8,
                "{family:?}: {}",
                set.points().len()
            );
            let [min, max] = set.bounds();
            assert!(min.min_element() >= -1.1 && max.max_element() <= 1.1, "{family:?}: {min} {max}");
            assert!((max - min).max_element() > 1.5, "{family:?}");
            assert_eq!(set, recipe.make().unwrap());
            assert_ne!(set, Recipe { seed: 5, ..recipe }.make().unwrap());
            let later = Recipe { time: 0.01, ..recipe }.make().unwrap();
            assert_ne!(set, later, "{family:?}");
            // First vertices; some lines of a flow may take another way around a well.
            let step = |(a, b): (&[glam::Vec3], &[glam::Vec3])| a[0].distance(b[0]);
            assert!(set.iter().zip(later.iter()).map(step).all(|d| d < 0.02), "{family:?}");
        }
    }

    #[test]
    fn sets_that_are_too_large_are_refused_and_small_ones_made() {
        let most = Recipe { lines: u32::MAX, vertices: u32::MAX, ..Recipe::new(Family::Abc, 1) };
        assert_eq!(most.make(), Err(LineError::TooMany));
        for (lines, vertices) in [(0, 9), (9, 0), (9, 1)] {
            let few =
                Recipe { lines, vertices, time: f64::NAN, ..Recipe::new(Family::Spiral, 1) }.make().unwrap();
            assert_eq!((few.len(), few.points().len()), (lines as usize, (lines * vertices) as usize));
        }
    }
}
