//! A plain sweep around the eye in floating point, as programs without a library have it: it looks
//! at all walls, takes none to cross another, and knows of no rounding.

use casca_plane::Segment;
use glam::Vec2;

/// The walls in sight and the visible polygon of the last run.
#[derive(Default)]
pub struct Sweep {
    ends: Vec<(f32, u32, bool)>,
    /// The walls that the sweep line meets, the nearest first.
    active: Vec<u32>,
    walls: Vec<(Vec2, Vec2)>,
    pub in_sight: Vec<bool>,
    pub polygon: Vec<Vec2>,
}

/// A number that grows with the angle, from -2 to 2.
fn angle(d: Vec2) -> f32 {
    let share = d.x / (d.x.abs() + d.y.abs());
    if d.y < 0.0 { share - 1.0 } else { 1.0 - share }
}

/// Whether wall `a` is before wall `b`, for walls that do not cross and that one ray from the
/// origin meets.
fn before(a: (Vec2, Vec2), b: (Vec2, Vec2)) -> bool {
    let side = |w: (Vec2, Vec2), p: Vec2| (w.1 - w.0).perp_dot(p - w.0);
    let (of_a, of_b) = ([side(b, a.0), side(b, a.1)], [side(a, b.0), side(a, b.1)]);
    // The origin lies at the positive side of both.
    if of_a[0] >= 0.0 && of_a[1] >= 0.0 {
        return true;
    }
    !(of_b[0] >= 0.0 && of_b[1] >= 0.0) && of_a[0] + of_a[1] > of_b[0] + of_b[1]
}

/// The point of a wall in a direction.
fn hit(wall: (Vec2, Vec2), along: Vec2) -> Vec2 {
    let u = wall.1 - wall.0;
    along * (wall.0.perp_dot(u) / along.perp_dot(u))
}

impl Sweep {
    /// The number of walls in sight from an eye.
    pub fn run(&mut self, walls: &[Segment], eye: Vec2) -> usize {
        self.ends.clear();
        self.walls.clear();
        self.active.clear();
        self.polygon.clear();
        self.in_sight.clear();
        self.in_sight.resize(walls.len(), false);
        for (wall, number) in walls.iter().zip(0..) {
            let (a, b) = (wall.a - eye, wall.b - eye);
            let (a, b) = if a.perp_dot(b) > 0.0 { (a, b) } else { (b, a) };
            let (from, to) = (angle(a), angle(b));
            self.walls.push((a, b));
            self.ends.push((from, number, true));
            self.ends.push((to, number, false));
            if to < from {
                self.enter(number);
            }
        }
        self.ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        self.active.first().into_iter().for_each(|&first| self.in_sight[first as usize] = true);
        for i in 0..self.ends.len() {
            let (_, number, begins) = self.ends[i];
            let before = self.active.first().copied();
            let (a, b) = self.walls[number as usize];
            if begins {
                self.enter(number);
            } else {
                let place = self.active.iter().position(|&active| active == number);
                if let Some(place) = place {
                    self.active.remove(place);
                }
            }
            let after = self.active.first().copied();
            if before != after {
                let along = if begins { a } else { b };
                for wall in [before, after].into_iter().flatten() {
                    self.polygon.push(eye + hit(self.walls[wall as usize], along));
                    self.in_sight[wall as usize] = true;
                }
            }
        }
        self.in_sight.iter().filter(|seen| **seen).count()
    }

    fn enter(&mut self, number: u32) {
        let wall = self.walls[number as usize];
        if !self.active.contains(&number) {
            let place = self.active.iter().position(|&other| before(wall, self.walls[other as usize]));
            self.active.insert(place.unwrap_or(self.active.len()), number);
        }
    }
}
