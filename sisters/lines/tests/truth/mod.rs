//! The occlusion by rays in double precision, tested against each tube near the receiver. It shares
//! no code with the library: the quadratic equations of a cylinder and of two balls, no grid. The
//! example `thesis` uses it, too.

use std::f64::consts::TAU;

use casca_lines::buffers::Fragment;
use casca_lines::glam::DVec3;
use casca_lines::sets::random::Random;
use casca_lines::sets::{LineSet, Segment};
use casca_lines::view::View;

/// Rays start this many radii of a tube above the middle of the receiver's own.
const LIFT: f64 = 1.01;

/// The segments of a set in double precision.
pub struct Tubes {
    /// With the number of the line.
    ends: Vec<([DVec3; 2], u32)>,
    radius: f64,
    /// Whether rays stop at once in tubes of other lines that hold their start.
    solid: bool,
}

impl Tubes {
    pub fn new(lines: &LineSet, radius: f64, solid: bool) -> Self {
        let points = lines.points();
        let ends = |s: Segment| ([s.a, s.b].map(|v| points[v as usize].as_dvec3()), s.line);
        Self { ends: lines.segments().map(ends).collect(), radius, solid }
    }

    /// The share of cosine-weighted rays of a length that stop, around the direction that is normal
    /// to the line and turned most to the viewer: `side * side` rays, one in each cell of the
    /// square that they come from.
    pub fn occlusion(&self, view: &View, at: &Fragment, length: f64, side: u32, random: &mut Random) -> f64 {
        let viewer = match view.is_perspective() {
            true => -at.position.as_dvec3().normalize(),
            false => DVec3::Z,
        };
        let tangent = at.tangent.as_dvec3();
        let pole = (viewer - tangent * tangent.dot(viewer)).normalize_or(viewer);
        let pole = view.eye_from_world().matrix3.transpose() * pole;
        let start = view.to_world(at.position) + pole * self.radius * LIFT;
        let reach = length + self.radius;
        let mut near: Vec<[DVec3; 2]> = Vec::new();
        for ([a, b], line) in &self.ends {
            let ends = [*a - start, *b - start];
            let nearest = from_origin(ends);
            if nearest > self.radius && nearest <= reach {
                near.push(ends);
            } else if nearest <= self.radius && self.solid && *line != at.line && a != b {
                return 1.0;
            }
        }
        let right = pole.any_orthonormal_vector();
        let up = pole.cross(right);
        let mut stopped = 0;
        for i in 0..side * side {
            let u = (f64::from(i % side) + random.unit()) / f64::from(side);
            let angle = (f64::from(i / side) + random.unit()) / f64::from(side) * TAU;
            let way = (right * angle.cos() + up * angle.sin()) * u.sqrt() + pole * (1.0 - u).sqrt();
            stopped += u32::from(near.iter().any(|&ends| self.meets(ends, way, length)));
        }
        f64::from(stopped) / f64::from(side * side)
    }

    /// Whether a ray from the origin, outside of a tube, meets it.
    fn meets(&self, [a, b]: [DVec3; 2], way: DVec3, length: f64) -> bool {
        let within = |t: f64| t >= 0.0 && t <= length;
        let ball = |centre: DVec3| {
            let half = way.dot(centre);
            let root = half * half - centre.length_squared() + self.radius * self.radius;
            root >= 0.0 && within(half - root.sqrt())
        };
        let long = a.distance(b);
        if long <= 0.0 {
            return ball(a);
        }
        let axis = (b - a) / long;
        let (flat_way, flat_a) = (way - axis * way.dot(axis), a - axis * a.dot(axis));
        let (square, half) = (flat_way.length_squared(), flat_way.dot(flat_a));
        let root = half * half - square * (flat_a.length_squared() - self.radius * self.radius);
        if root < 0.0 {
            return false;
        }
        let t = (half - root.sqrt()) / square;
        let along = (way * t - a).dot(axis);
        (within(t) && (0.0..=long).contains(&along)) || ball(a) || ball(b)
    }
}

/// The distance of a segment from the origin.
fn from_origin([a, b]: [DVec3; 2]) -> f64 {
    let axis = b - a;
    let square = axis.length_squared();
    let share = if square > 0.0 { (-a.dot(axis) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + axis * share).length()
}

/// Pearson correlation, and the root of the mean square of differences.
pub fn agreement(a: &[f64], b: &[f64]) -> [f64; 2] {
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        a.iter().zip(b).map(|(a, b)| of(*a, *b)).sum::<f64>() / a.len().max(1) as f64
    };
    let (ma, mb) = (mean(&|a, _| a), mean(&|_, b| b));
    let spread = (mean(&|a, _| (a - ma).powi(2)) * mean(&|_, b| (b - mb).powi(2))).sqrt();
    let pearson = if spread > 0.0 { mean(&|a, b| (a - ma) * (b - mb)) / spread } else { 0.0 };
    [pearson, mean(&|a, b| (a - b).powi(2)).sqrt()]
}
