//! Temporal bounding volumes over time (section 3.3.2; Sudarsky & Gotsman 1996): hollow circles of
//! cells that hold hidden objects for a while, so that nobody needs to know where these are. If an eye
//! outside sees a point of the object, a cell of the circle is in sight.
//!
//! A volume is made to last longer than the one before if that was outlived unseen, and half as
//! long if it was seen. It holds no cell of the viewer.

use std::f64::consts::FRAC_1_SQRT_2;

use casca_plane::BitGrid;
use glam::{DVec2, IVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::caps::Walk;
use crate::{SIDE, place};

const FRAMES: u32 = 1200;
const OBJECTS: u32 = 2000;
/// Cells per second, and seconds of a frame.
const SPEED: f32 = 2.0;
const FRAME: f64 = 1.0 / 60.0;
/// The radius of an object, in cells.
const BODY: f64 = 0.3;
/// Seconds that the first volume of an object is made to last, the least and the most.
const VALIDITY: [f64; 3] = [0.5, 1.0 / 64.0, 64.0];
/// The factors of a volume that was outlived, and of one that was seen: a slow rise keeps most from
/// being seen at all.
const LONGER: f64 = 1.25;
const SHORTER: f64 = 0.5;
/// Far more than the rounding of sums of coordinates, far less than a cell.
const ROUNDING: f64 = 1e-5;

/// A moving object.
struct Walker {
    place: Vec2,
    direction: Vec2,
    /// Its volume, if it is hidden.
    volume: Option<Volume>,
    /// How long the next one is made to last, in seconds.
    validity: f64,
}

struct Volume {
    center: IVec2,
    radius: i32,
    /// Until then, in seconds, the object cannot have left it.
    expires: f64,
    /// Whether it lasts as long as was asked for: if not, it tells nothing about larger ones.
    full: bool,
}

impl Volume {
    /// A volume around an object that lasts as long as limits allow. `None` if the object is too
    /// close to the viewer.
    fn around(walker: &Walker, viewer: IVec2, now: f64) -> Option<Self> {
        let center = walker.place.floor().as_ivec2();
        let off = walker.place.as_dvec2().distance(center.as_dvec2() + 0.5);
        // The disc holds all cells that the object touches: their centres are within half a
        // diagonal of it.
        let needed = off + BODY + FRAC_1_SQRT_2 + ROUNDING;
        let fifth = DVec2::splat(f64::from(SIDE) / 5.0).length();
        // No cell of the disc is farther than radius + 1/2 from the middle.
        let most = fifth.min((viewer - center).as_dvec2().length() - 0.5 - ROUNDING);
        let wanted = (needed + f64::from(SPEED) * walker.validity).ceil();
        let radius = wanted.min(most.floor());
        let expires = now + (radius - needed) / f64::from(SPEED);
        (radius >= needed).then_some(Self { center, radius: radius as i32, expires, full: radius == wanted })
    }

    /// Whether its outline is in sight, or the viewer may be inside.
    fn is_seen(&self, seen: &BitGrid, viewer: IVec2) -> bool {
        let inside = (viewer - self.center).as_dvec2().length() <= f64::from(self.radius) + 1.0;
        let mut outline = circle(self.radius).map(|cell| self.center + cell);
        inside || outline.any(|cell| seen.get(cell.x as u32, cell.y as u32))
    }
}

/// The outline of the disc of cells whose centres are within `radius` + 1/2 of the middle: those that
/// have a neighbour beyond, corners included. No way from cell to neighbour gets inside without one.
fn circle(radius: i32) -> impl Iterator<Item = IVec2> {
    // The last cell of a column: (r + 1/2)² = r² + r + 1/4.
    let top = move |x: i32| (radius * radius + radius - x * x).checked_isqrt().unwrap_or(-1);
    (-radius..=radius).flat_map(move |x| {
        let first = top(x - 1).min(top(x + 1)).max(0);
        (first..=top(x)).flat_map(move |y| [IVec2::new(x, y), IVec2::new(x, -y)])
    })
}

/// Prints the table: means of 120 frames each.
pub fn print(map: &BitGrid) {
    println!(
        "Volumes: rooms, {SIDE}x{SIDE} cells, {OBJECTS} objects at {SPEED} cells a second, {FRAMES} frames at 60 Hz, a walking viewer.\n"
    );
    println!("| frames | hidden objects | volumes drawn | volumes seen | reports due | validity, s |");
    println!("|---|---|---|---|---|---|");
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut walkers: Vec<Walker> = (0..=OBJECTS)
        .map(|_| Walker {
            place: place(map, &mut random),
            direction: Vec2::from_angle(random.random_range(0.0..6.2)),
            volume: None,
            validity: VALIDITY[0],
        })
        .collect();
    let mut eye = walkers.remove(0);
    let mut sums = [0.0; 5];
    for frame in 1..=FRAMES {
        let now = f64::from(frame) * FRAME;
        step(map, &mut random, &mut eye);
        let viewer = eye.place.floor().as_ivec2();
        let seen = Walk::run(map, viewer, true).seen;
        for walker in &mut walkers {
            step(map, &mut random, walker);
            if let Some(volume) = walker.volume.take() {
                if volume.is_seen(&seen, viewer) {
                    sums[2] += 1.0;
                    walker.validity = (walker.validity * SHORTER).max(VALIDITY[1]);
                } else if volume.expires > now {
                    walker.volume = Some(volume);
                } else {
                    sums[3] += 1.0;
                    walker.validity *= if volume.full { LONGER } else { 1.0 };
                    walker.validity = walker.validity.min(VALIDITY[2]);
                }
            }
            let is_seen = touched(walker.place).any(|cell| seen.get(cell.x as u32, cell.y as u32));
            assert!(!is_seen || walker.volume.is_none(), "an object is seen whose volume is not");
            if !is_seen && walker.volume.is_none() {
                walker.volume = Volume::around(walker, viewer, now);
                sums[1] += f64::from(u32::from(walker.volume.is_some()));
            }
            sums[0] += f64::from(u32::from(!is_seen));
            sums[4] += walker.validity / f64::from(OBJECTS);
        }
        if frame % 120 == 0 {
            let [hidden, drawn, revealed, due, validity] = sums.map(|sum| sum / 120.0);
            let frames = format!("{} to {frame}", frame - 119);
            println!("| {frames} | {hidden:.0} | {drawn:.1} | {revealed:.1} | {due:.1} | {validity:.2} |");
            sums = [0.0; 5];
        }
    }
}

/// The cells that a body touches, and perhaps others of the square around it.
fn touched(place: Vec2) -> impl Iterator<Item = IVec2> {
    let [least, most] = [-BODY, BODY].map(|by| (place + by as f32).floor().as_ivec2());
    (least.y..=most.y).flat_map(move |y| (least.x..=most.x).map(move |x| IVec2::new(x, y)))
}

/// Walks straight on, and turns before walls.
fn step(map: &BitGrid, random: &mut Pcg64Mcg, walker: &mut Walker) {
    for _ in 0..8 {
        let next = walker.place + walker.direction * (SPEED * 0.999 * FRAME as f32);
        let front = next + walker.direction * 0.32;
        if !map.get(front.x.max(0.0) as u32, front.y.max(0.0) as u32) {
            walker.place = next;
            return;
        }
        walker.direction = Vec2::from_angle(random.random_range(0.0..6.2));
    }
}
