//! A plain sweep in double precision around an eye, among walls that do not cross: what exactness is
//! compared with.

use casca_plane::Segment;
use glam::{DVec2, Vec2};

/// The memory of a sweep.
#[derive(Default)]
pub struct Sweep {
    /// The walls from the eye, counterclockwise.
    walls: Vec<[DVec2; 2]>,
    /// The ends: their angles, whether the wall begins there, and its number.
    ends: Vec<(f64, bool, usize)>,
    /// The walls in the direction at hand, the nearest first.
    open: Vec<usize>,
    corners: Vec<Vec2>,
}

impl Sweep {
    /// The corners of the visible region.
    pub fn run(&mut self, walls: &[Segment], eye: Vec2) -> &[Vec2] {
        self.walls.clear();
        self.ends.clear();
        self.open.clear();
        self.corners.clear();
        for wall in walls {
            let [a, b] = [wall.a, wall.b].map(|p| p.as_dvec2() - eye.as_dvec2());
            let number = self.walls.len();
            self.walls.push(if a.perp_dot(b) > 0.0 { [a, b] } else { [b, a] });
            let [first, last] = self.walls[number].map(|p| p.y.atan2(p.x));
            self.ends.extend([(first, true, number), (last, false, number)]);
            if first > last {
                self.begin(number);
            }
        }
        self.ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for i in 0..self.ends.len() {
            let (_, begins, number) = self.ends[i];
            let before = self.open.first().copied();
            match begins {
                true => self.begin(number),
                false => self.open.retain(|&other| other != number),
            }
            let now = self.open.first().copied();
            let along = self.walls[number][usize::from(!begins)];
            for wall in [before, now].into_iter().flatten().filter(|_| before != now) {
                let [a, b] = self.walls[wall];
                let hit = along * (a.perp_dot(b) / along.perp_dot(b - a));
                self.corners.push(eye + hit.as_vec2());
            }
        }
        &self.corners
    }

    fn begin(&mut self, number: usize) {
        let [a, b] = self.walls[number];
        // Ends that touch count as apart.
        let is_left = |[a, b]: [DVec2; 2], [p, q]: [DVec2; 2]| {
            let side = |p: DVec2, q: DVec2| (b - a).perp_dot(p.lerp(q, 0.01) - a) > 0.0;
            [side(p, q), side(q, p)]
        };
        let is_before = |&other: &usize| {
            let wall = self.walls[other];
            is_left(wall, [a, b]) == [true; 2] || is_left([a, b], wall) == [false; 2]
        };
        let place = self.open.iter().position(is_before).unwrap_or(self.open.len());
        self.open.insert(place, number);
    }
}
