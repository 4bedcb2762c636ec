//! Kinds of sets, none of which the library itself makes.

use std::f64::consts::TAU;

use casca_lines::glam::{DVec3, Vec3};
use casca_lines::sets::random::Random;
use casca_lines::sets::{LineError, LineSet};

/// Half of the way, in the parameter of a knot, over which its direction is taken: less than a
/// hundredth of a step from point to point.
const AHEAD: f64 = 1e-4;

/// A kind of set by its name.
pub struct Kind {
    pub name: &'static str,
    /// Constants of the method were chosen without it.
    pub is_held_out: bool,
    make: fn(&mut Random) -> Vec<Vec<DVec3>>,
}

pub const KINDS: [Kind; 10] = [
    Kind { name: "bundle of knots", is_held_out: false, make: knots },
    Kind { name: "streamlines", is_held_out: false, make: streamlines },
    Kind { name: "hair on a torus", is_held_out: false, make: torus_hair },
    Kind { name: "fan of tracts", is_held_out: false, make: fan },
    Kind { name: "helices", is_held_out: false, make: helices },
    Kind { name: "woven sheets", is_held_out: false, make: woven },
    Kind { name: "random walks", is_held_out: true, make: walks },
    Kind { name: "smoke rings", is_held_out: true, make: rings },
    Kind { name: "branching vessels", is_held_out: true, make: vessels },
    Kind { name: "lines at the viewer", is_held_out: false, make: at_viewer },
];

impl Kind {
    pub fn lines(&self, seed: u64) -> Result<LineSet, LineError> {
        let lines = (self.make)(&mut Random::new(seed));
        LineSet::new(lines.iter().map(|line| line.iter().map(|p| p.as_vec3()).collect::<Vec<Vec3>>()))
    }
}

fn direction(random: &mut Random) -> DVec3 {
    loop {
        let p = DVec3::from_array(std::array::from_fn(|_| random.within(-1.0, 1.0)));
        if (0.01..1.0).contains(&p.length_squared()) {
            return p.normalize();
        }
    }
}

/// A point of a disc, even.
fn in_disc(random: &mut Random) -> (f64, f64) {
    let (radius, angle) = (random.unit().sqrt(), random.within(0.0, TAU));
    (radius * angle.cos(), radius * angle.sin())
}

/// Strands around two torus knots, twisted about their middle lines.
fn knots(random: &mut Random) -> Vec<Vec<DVec3>> {
    let knot = |p: f64, q: f64, t: f64| {
        let radius = 0.6 + 0.25 * (q * t).cos();
        DVec3::new(radius * (p * t).cos(), radius * (p * t).sin(), 0.3 * (q * t).sin())
    };
    let strand = |(number, random): (usize, &mut Random)| {
        let (p, q) = if number % 2 == 0 { (2.0, 3.0) } else { (3.0, 5.0) };
        let (u, v) = in_disc(random);
        let line = (0..=500).map(|i| {
            let t = f64::from(i) / 500.0 * TAU;
            let ahead = (knot(p, q, t + AHEAD) - knot(p, q, t - AHEAD)).normalize();
            let side = ahead.cross(DVec3::Z).normalize();
            let up = side.cross(ahead);
            let (sine, cosine) = (4.0 * t).sin_cos();
            knot(p, q, t) + (side * (u * cosine - v * sine) + up * (u * sine + v * cosine)) * 0.07
        });
        line.collect()
    };
    (0..240).map(|number| strand((number, &mut *random))).collect()
}

/// Streamlines of the curl of a sum of waves.
fn streamlines(random: &mut Random) -> Vec<Vec<DVec3>> {
    let waves: Vec<(DVec3, DVec3, f64)> = (0..6)
        .map(|_| (direction(random) * random.within(2.0, 5.0), direction(random), random.within(0.0, TAU)))
        .collect();
    // The curl of a * sin(k p + phase) is k x a * cos(k p + phase).
    let field =
        |p: DVec3| -> DVec3 { waves.iter().map(|(k, a, f)| k.cross(*a) * (k.dot(p) + f).cos()).sum() };
    let mut line = |_| {
        let mut p = DVec3::from_array(std::array::from_fn(|_| random.within(-0.8, 0.8)));
        let mut points = vec![p];
        for _ in 0..200 {
            let middle = p + field(p).normalize_or_zero() * 0.005;
            p += field(middle).normalize_or_zero() * 0.01;
            if p.abs().max_element() > 1.0 {
                break;
            }
            points.push(p);
        }
        points
    };
    (0..1200).map(&mut line).collect()
}

/// Hairs that bend over a torus.
fn torus_hair(random: &mut Random) -> Vec<Vec<DVec3>> {
    let mut hair = |_| {
        let (around, across) = (random.within(0.0, TAU), random.within(0.0, TAU));
        let out = DVec3::new(around.cos(), around.sin(), 0.0);
        let normal = out * across.cos() + DVec3::Z * across.sin();
        let root = out * 0.6 + normal * 0.2;
        let along = DVec3::new(-around.sin(), around.cos(), 0.0);
        let (bend, long) = (random.within(0.1, 0.5), random.within(0.1, 0.22));
        let wild = direction(random) * 0.03;
        (0..24)
            .map(|i| {
                let s = f64::from(i) / 23.0;
                root + normal * (long * s) + (along * bend * long + wild) * (s * s)
            })
            .collect()
    };
    (0..5000).map(&mut hair).collect()
}

/// Tight parallel tracts that part into a fan.
fn fan(random: &mut Random) -> Vec<Vec<DVec3>> {
    let mut fibre = |number: usize| {
        let tract = (number % 5) as f64 - 2.0;
        let (u, v) = in_disc(random);
        (0..120)
            .map(|i| {
                let s = f64::from(i) / 119.0;
                let open = 1.0 + 3.0 * s * s;
                let middle =
                    DVec3::new(tract * (0.12 + 0.25 * s * s), -0.8 + 1.6 * s, 0.3 * (tract + 3.0 * s).sin());
                middle + DVec3::new(u * open, 0.0, v * open) * 0.05
            })
            .collect()
    };
    (0..2500).map(&mut fibre).collect()
}

/// Bunches of helices around slanted axes.
fn helices(random: &mut Random) -> Vec<Vec<DVec3>> {
    let axes: Vec<[DVec3; 2]> = (0..12).map(|_| [direction(random) * 0.5, direction(random)]).collect();
    let mut helix = |number: usize| {
        let [middle, axis] = axes[number % 12];
        let (side, up) = axis.any_orthonormal_pair();
        let (radius, phase, turns) =
            (random.within(0.03, 0.14), random.within(0.0, TAU), random.within(2.0, 5.0));
        (0..150)
            .map(|i| {
                let s = f64::from(i) / 149.0 - 0.5;
                let (sine, cosine) = (turns * TAU * s + phase).sin_cos();
                middle + axis * s + (side * cosine + up * sine) * radius
            })
            .collect()
    };
    (0..480).map(&mut helix).collect()
}

/// Sheets of threads that go over and under each other.
fn woven(_: &mut Random) -> Vec<Vec<DVec3>> {
    let thread = |sheet: usize, is_warp: bool, number: i32| {
        let across = (f64::from(number) - 39.5) / 45.0;
        let lift = f64::from(number % 2) * TAU / 2.0;
        let tilt = sheet as f64 * 0.4 - 0.4;
        (0..160)
            .map(|i| {
                let s = f64::from(i) / 159.0 * 1.8 - 0.9;
                let wave = 0.008 * (s * 45.0 * TAU / 2.0 + lift).cos() * if is_warp { 1.0 } else { -1.0 };
                let (x, y) = if is_warp { (s, across) } else { (across, s) };
                DVec3::new(x, y * tilt.cos(), y * tilt.sin() + wave + sheet as f64 * 0.25 - 0.25)
            })
            .collect::<Vec<DVec3>>()
    };
    let sheets = (0..3).flat_map(|s| [(s, false), (s, true)]);
    sheets.flat_map(|(s, w)| (0..80).map(move |n| thread(s, w, n))).collect()
}

/// Smooth random walks that are drawn back to the middle.
fn walks(random: &mut Random) -> Vec<Vec<DVec3>> {
    let mut walk = |_| {
        let (mut p, mut way) = (direction(random) * random.unit() * 0.7, direction(random));
        (0..300)
            .map(|_| {
                way = (way + direction(random) * 0.35 - p * 0.15).normalize();
                p += way * 0.012;
                p
            })
            .collect()
    };
    (0..500).map(&mut walk).collect()
}

/// Rings around a thick ring, as vortex lines in smoke.
fn rings(random: &mut Random) -> Vec<Vec<DVec3>> {
    let mut ring = |number: usize| {
        let middle = DVec3::new(0.0, 0.0, (number % 4) as f64 * 0.4 - 0.6);
        let (radius, thick) = (0.55 + 0.1 * (number % 4) as f64, random.within(0.02, 0.16));
        let (phase, slope) = (random.within(0.0, TAU), random.within(3.0, 9.0));
        (0..240)
            .map(|i| {
                let t = f64::from(i) / 239.0 * TAU;
                let (sine, cosine) = (slope.floor() * t + phase).sin_cos();
                middle
                    + DVec3::new(t.cos(), t.sin(), 0.0) * (radius + thick * cosine)
                    + DVec3::Z * (thick * sine)
            })
            .collect()
    };
    (0..400).map(&mut ring).collect()
}

/// Crooked vessels that part in two again and again, with short segments near the trunk and long
/// ones at the tips.
fn vessels(random: &mut Random) -> Vec<Vec<DVec3>> {
    let mut lines = Vec::new();
    let root = |random: &mut Random| (direction(random) * 0.15, direction(random), 0);
    let mut open: Vec<(DVec3, DVec3, u32)> = (0..12).map(|_| root(random)).collect();
    while let Some((mut p, mut way, level)) = open.pop() {
        let mut line = vec![p];
        for _ in 0..24 {
            way = (way + direction(random) * 0.4).normalize();
            p += way * (0.006 + 0.0015 * f64::from(level));
            line.push(p);
        }
        lines.push(line);
        if level < 7 {
            open.extend([0.7, -0.7].map(|turn| {
                let side = way.cross(direction(random)).normalize_or_zero();
                (p, (way + side * turn).normalize(), level + 1)
            }));
        }
    }
    lines
}

/// Nearly straight lines that point at the viewer.
fn at_viewer(random: &mut Random) -> Vec<Vec<DVec3>> {
    let way = DVec3::new(0.5, 0.6, 1.0).normalize();
    let (side, up) = way.any_orthonormal_pair();
    let mut line = |_| {
        let (u, v) = in_disc(random);
        let (from, long) = (random.within(-0.7, 0.2), random.within(0.2, 0.5));
        let slant = direction(random) * 0.03;
        let at = |s: f64| (side * u + up * v) * 0.7 + (way + slant) * (from + long * s);
        (0..8).map(|i| at(f64::from(i) / 7.0)).collect()
    };
    (0..3000).map(&mut line).collect()
}
