//! The solid of an animal: round cones that melt into each other, and the coat of each part.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::mesh::Coat;

/// A cone with round ends.
struct Part {
    from: Vec3,
    to: Vec3,
    radii: [f32; 2],
    /// The length of the fur on it, 0 to 1.
    length: f32,
    tint: Tint,
}

#[derive(Clone, Copy, PartialEq)]
enum Tint {
    Coat,
    Belly,
    Dark,
    Eye,
}

/// A body in its own space: it stands on the plane y = 0 and looks along x. One unit is about its length.
pub(super) struct Body {
    parts: Vec<Part>,
    main: Vec3,
    second: Vec3,
    belly: Vec3,
    /// How far patches of the second colour spread: above 1 there are none.
    patches: f32,
    phase: Vec3,
}

/// How smoothly parts melt into each other, in units.
const MELT: f32 = 0.028;

/// Coats: main, second and belly colour (linear), and how far patches spread.
const COATS: [([f32; 3], [f32; 3], [f32; 3], f32); 6] = [
    ([0.42, 0.20, 0.07], [0.62, 0.40, 0.20], [0.75, 0.62, 0.45], 1.2),
    ([0.52, 0.23, 0.05], [0.08, 0.05, 0.04], [0.85, 0.75, 0.62], 1.2),
    ([0.70, 0.66, 0.60], [0.16, 0.11, 0.08], [0.80, 0.78, 0.74], 0.25),
    ([0.20, 0.19, 0.18], [0.45, 0.43, 0.40], [0.50, 0.48, 0.45], 0.7),
    ([0.55, 0.40, 0.20], [0.22, 0.11, 0.04], [0.80, 0.70, 0.52], 0.3),
    ([0.10, 0.06, 0.04], [0.35, 0.20, 0.10], [0.30, 0.20, 0.13], 0.8),
];

impl Body {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut vary =
            |middle: f32, share: f32| middle * (1.0 + share * (2.0 * random.random::<f32>() - 1.0));
        let (long, fat, tall) = (vary(0.30, 0.15), vary(0.19, 0.18), vary(0.34, 0.22));
        let (head, muzzle, ear, fluff) =
            (vary(0.15, 0.12), vary(0.15, 0.25), vary(0.15, 0.45), vary(0.07, 0.3));
        let (neck, tail, curl) = (vary(0.19, 0.3), vary(0.34, 0.4), vary(0.12, 0.9));
        let back = tall + fat * 0.75;
        let skull = Vec3::new(long + 0.17, back + neck, 0.0);
        let nose = skull + Vec3::new(head + muzzle * 0.7, -0.05, 0.0);
        let part =
            |from: Vec3, to: Vec3, radii: [f32; 2]| Part { from, to, radii, length: 1.0, tint: Tint::Coat };
        let mut parts = vec![
            part(Vec3::new(-long, back, 0.0), Vec3::new(long, back + 0.02, 0.0), [fat * 0.95, fat * 1.05]),
            Part {
                tint: Tint::Belly,
                ..part(
                    Vec3::new(-long * 0.6, back - fat * 0.3, 0.0),
                    Vec3::new(long * 0.8, back - fat * 0.28, 0.0),
                    [fat * 0.8; 2],
                )
            },
            part(Vec3::new(long, back + 0.05, 0.0), skull, [fat * 0.75, head * 0.75]),
            part(skull, skull + Vec3::new(0.03, 0.0, 0.0), [head, head * 0.95]),
            Part {
                length: 0.45,
                tint: Tint::Belly,
                ..part(skull + Vec3::X * head * 0.5, nose, [head * 0.6, head * 0.34])
            },
            Part {
                length: 0.0,
                tint: Tint::Dark,
                ..part(
                    nose + Vec3::X * head * 0.27,
                    nose + Vec3::new(head * 0.3, 0.015, 0.0),
                    [head * 0.22; 2],
                )
            },
        ];
        let rump = Vec3::new(-long - fat * 0.6, back + fat * 0.3, 0.0);
        let bow = rump + Vec3::new(-tail * 0.5, tail * 0.1, 0.0);
        parts.push(part(rump, bow, [fluff * 0.8, fluff]));
        parts.push(part(
            bow,
            bow + Vec3::new(-tail * 0.4, tail * (0.2 + curl * 2.0), 0.0),
            [fluff, fluff * 0.55],
        ));
        for side in [-1.0, 1.0] {
            let z = Vec3::Z * side;
            let root = skull + Vec3::new(-0.02, head * 0.75, 0.0) + z * head * 0.6;
            parts.push(Part {
                length: 0.5,
                ..part(root, root + Vec3::new(-0.03, ear, 0.0) + z * 0.05, [0.055, 0.03])
            });
            let eye = skull + Vec3::new(head * 0.82, head * 0.32, 0.0) + z * head * 0.5;
            parts.push(Part { length: 0.0, tint: Tint::Eye, ..part(eye, eye, [head * 0.24; 2]) });
            for x in [-long, long] {
                let hip = Vec3::new(x, back - fat * 0.25, 0.0) + z * fat * 0.62;
                let foot = Vec3::new(x + 0.01, 0.06, 0.0) + z * fat * 0.72;
                parts.push(Part { length: 0.7, ..part(hip, foot, [fat * 0.5, 0.055]) });
                parts.push(Part {
                    length: 0.15,
                    tint: Tint::Dark,
                    ..part(foot - Vec3::Y * 0.01, foot + Vec3::new(0.06, -0.012, 0.0), [0.05, 0.045])
                });
            }
        }
        let coat = COATS[random.random_range(0..COATS.len())];
        let [main, second, belly] = [coat.0, coat.1, coat.2].map(Vec3::from_array);
        let phase = Vec3::from_array(std::array::from_fn(|_| random.random::<f32>() * std::f32::consts::TAU));
        Self { parts, main, second, belly, patches: coat.3, phase }
    }

    /// About the distance to the surface, in units; negative inside. The soft least distance of all parts.
    pub(super) fn field(&self, p: Vec3) -> f32 {
        let distances: [f32; 32] =
            std::array::from_fn(|i| self.parts.get(i).map_or(f32::INFINITY, |part| part.distance(p)));
        let least = distances.iter().copied().fold(f32::INFINITY, f32::min);
        let sum: f32 = distances.iter().map(|d| (-(d - least) / MELT).exp()).sum();
        least - MELT * sum.ln()
    }

    /// The unit normal of the surface, by differences of the field.
    pub(super) fn normal(&self, p: Vec3) -> Vec3 {
        let h = 1e-3;
        let along = |axis: Vec3| self.field(p + axis * h) - self.field(p - axis * h);
        Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or(Vec3::Y)
    }

    /// The coat at a point of the surface: of its parts, by their nearness.
    pub(super) fn coat(&self, p: Vec3) -> Coat {
        let wave = |scale: f32| {
            let w = (p * scale + self.phase).to_array().map(f32::sin);
            w[0] * w[1] + w[1] * w[2] + w[2] * w[0]
        };
        let spread = ((wave(9.0) + 0.4 * wave(23.0) - self.patches) * 6.0).clamp(0.0, 1.0);
        let coat = self.main.lerp(self.second, spread);
        let (mut color, mut length, mut sum) = (Vec3::ZERO, 0.0, 0.0);
        let least = self.parts.iter().map(|part| part.distance(p)).fold(f32::INFINITY, f32::min);
        for part in &self.parts {
            // Bald parts and eyes end sharply.
            let sharp = if matches!(part.tint, Tint::Eye | Tint::Dark) { 0.006 } else { 0.02 };
            let weight = (-(part.distance(p) - least) / sharp).exp();
            let tint = match part.tint {
                Tint::Coat => coat,
                Tint::Belly => self.belly,
                Tint::Dark => Vec3::splat(0.02),
                Tint::Eye => Vec3::splat(0.004),
            };
            color += tint * weight;
            length += part.length * weight;
            sum += weight;
        }
        Coat { color: (color / sum).clamp(Vec3::ZERO, Vec3::ONE), length: (length / sum).clamp(0.0, 1.0) }
    }

    /// A box around the surface.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        // Melting adds the logarithm of the number of parts.
        let extra = MELT * (self.parts.len() as f32).ln();
        let ends = self.parts.iter().flat_map(|part| [(part.from, part.radii[0]), (part.to, part.radii[1])]);
        ends.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), (p, r)| {
            (lo.min(p - (r + extra)), hi.max(p + (r + extra)))
        })
    }
}

impl Part {
    fn distance(&self, p: Vec3) -> f32 {
        let way = self.to - self.from;
        let t = ((p - self.from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
        p.distance(self.from + way * t) - (self.radii[0] + (self.radii[1] - self.radii[0]) * t)
    }
}
