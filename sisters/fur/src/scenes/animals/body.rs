//! The solid of an animal: round cones that melt into each other, and the coat of each part.

use casca_scenes::random::generator;
use glam::Vec3;
use rand::RngExt;

use crate::mesh::Coat;

/// The joints that a part follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limb {
    Trunk,
    /// Head and neck.
    Head,
    /// The first or the second piece of the tail.
    Tail(usize),
    /// A leg, by its number.
    Leg(usize),
}

/// Legs of an animal.
pub(super) const LEGS: usize = 4;

/// A cone with round ends.
struct Part {
    limb: Limb,
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
    Foot,
    /// Nose and eyes, with a sharp edge.
    Bald,
}

/// A body in its own space: it stands on the plane y = 0 and looks along x. One unit is about its
/// length.
pub(super) struct Body {
    parts: Vec<Part>,
    main: Vec3,
    second: Vec3,
    belly: Vec3,
    /// How far patches of the second colour spread: above 1 there are none.
    patches: f32,
    phase: Vec3,
    /// Where the neck leaves the trunk.
    pub(super) neck: Vec3,
    /// Where the pieces of the tail begin.
    pub(super) tail: [Vec3; 2],
    /// Hip and foot of each leg: for each side the one behind, then the one before.
    pub(super) legs: [[Vec3; 2]; LEGS],
}

/// How smoothly parts melt into each other, in units.
const MELT: f32 = 0.028;

/// How softly coats of parts blend, and how sharply noses and eyes end, in units.
const SOFT: f32 = 0.02;
const SHARP: f32 = 0.012;

/// Limbs that move a place by less than this share do not move it.
const LEAST_SHARE: f32 = 0.02;

/// The colour of feet; noses and eyes are darker.
const DARK: Vec3 = Vec3::splat(0.02);

/// Coats: main, second and belly colour (linear), and how far patches spread.
const COATS: [([[f32; 3]; 3], f32); 6] = [
    ([[0.42, 0.20, 0.07], [0.62, 0.40, 0.20], [0.75, 0.62, 0.45]], 1.2),
    ([[0.52, 0.23, 0.05], [0.08, 0.05, 0.04], [0.85, 0.75, 0.62]], 1.2),
    ([[0.70, 0.66, 0.60], [0.16, 0.11, 0.08], [0.80, 0.78, 0.74]], 0.25),
    ([[0.20, 0.19, 0.18], [0.45, 0.43, 0.40], [0.50, 0.48, 0.45]], 0.7),
    ([[0.55, 0.40, 0.20], [0.22, 0.11, 0.04], [0.80, 0.70, 0.52]], 0.3),
    ([[0.10, 0.06, 0.04], [0.35, 0.20, 0.10], [0.30, 0.20, 0.13]], 0.8),
];

impl Body {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = generator(seed, 0);
        let mut vary =
            |middle: f32, share: f32| middle * (1.0 + share * (2.0 * random.random::<f32>() - 1.0));
        let (long, fat, tall) = (vary(0.30, 0.15), vary(0.19, 0.18), vary(0.34, 0.22));
        let (head, muzzle, ear, fluff) =
            (vary(0.15, 0.12), vary(0.15, 0.25), vary(0.15, 0.45), vary(0.07, 0.3));
        let (neck, tail, curl) = (vary(0.19, 0.3), vary(0.34, 0.4), vary(0.12, 0.9));
        let back = tall + fat * 0.75;
        let skull = Vec3::new(long + 0.17, back + neck, 0.0);
        let nose = skull + Vec3::new(head + muzzle * 0.7, -0.05, 0.0);
        let mut parts = Vec::new();
        let mut add = |limb: Limb, from: Vec3, to: Vec3, radii: [f32; 2], length: f32, tint: Tint| {
            parts.push(Part { limb, from, to, radii, length, tint });
        };
        let mut legs = [[Vec3::ZERO; 2]; LEGS];
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        add(Limb::Trunk, at(-long, back), at(long, back + 0.02), [fat * 0.95, fat * 1.05], 1.0, Tint::Coat);
        let chest = back - fat * 0.3;
        add(Limb::Trunk, at(-long * 0.6, chest), at(long * 0.8, chest), [fat * 0.8; 2], 1.0, Tint::Belly);
        add(Limb::Head, at(long, back + 0.05), skull, [fat * 0.75, head * 0.75], 1.0, Tint::Coat);
        add(Limb::Head, skull, skull + at(0.03, 0.0), [head, head * 0.95], 0.7, Tint::Coat);
        add(Limb::Head, skull + at(head * 0.5, 0.0), nose, [head * 0.6, head * 0.34], 0.35, Tint::Belly);
        let tip = nose + at(head * 0.3, 0.01);
        add(Limb::Head, tip, tip, [head * 0.22; 2], 0.0, Tint::Bald);
        let rump = at(-long - fat * 0.6, back + fat * 0.3);
        let bow = rump + at(-tail * 0.5, tail * 0.1);
        add(Limb::Tail(0), rump, bow, [fluff * 0.8, fluff], 1.0, Tint::Coat);
        add(
            Limb::Tail(1),
            bow,
            bow + at(-tail * 0.4, tail * (0.2 + curl * 2.0)),
            [fluff, fluff * 0.55],
            1.0,
            Tint::Coat,
        );
        for (pair, side) in [-1.0, 1.0].into_iter().enumerate() {
            let z = Vec3::Z * side;
            let root = skull + at(-0.02, head * 0.75) + z * head * 0.6;
            add(Limb::Head, root, root + at(-0.03, ear) + z * 0.05, [0.055, 0.03], 0.4, Tint::Coat);
            let eye = skull + at(head * 0.9, head * 0.34) + z * head * 0.48;
            add(Limb::Head, eye, eye, [head * 0.2; 2], 0.0, Tint::Bald);
            for (end, x) in [-long, long].into_iter().enumerate() {
                let leg = 2 * pair + end;
                let hip = at(x, back - fat * 0.25) + z * fat * 0.62;
                let foot = at(x + 0.01, 0.06) + z * fat * 0.72;
                legs[leg] = [hip, foot];
                add(Limb::Leg(leg), hip, foot, [fat * 0.5, 0.055], 0.6, Tint::Coat);
                add(
                    Limb::Leg(leg),
                    foot - at(0.0, 0.01),
                    foot + at(0.06, -0.012),
                    [0.05, 0.045],
                    0.15,
                    Tint::Foot,
                );
            }
        }
        let (colors, patches) = COATS[random.random_range(0..COATS.len())];
        let [main, second, belly] = colors.map(Vec3::from_array);
        let phase = Vec3::from_array(std::array::from_fn(|_| random.random::<f32>() * std::f32::consts::TAU));
        let neck = at(long, back + 0.05);
        Self { parts, main, second, belly, patches, phase, neck, tail: [rump, bow], legs }
    }

    /// About the distance to the surface, in units; negative inside. The soft least distance of all
    /// parts.
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
        let nearest = |bald: bool| {
            let parts = self.parts.iter().filter(|part| (part.tint == Tint::Bald) == bald);
            parts.map(|part| part.distance(p)).fold(f32::INFINITY, f32::min)
        };
        let (least, bald) = (nearest(false), nearest(true));
        for part in &self.parts {
            let tint = match part.tint {
                Tint::Coat => coat,
                Tint::Belly => self.belly,
                Tint::Foot => DARK,
                Tint::Bald => continue,
            };
            let weight = (-(part.distance(p) - least) / SOFT).exp();
            color += tint * weight;
            length += part.length * weight;
            sum += weight;
        }
        let mask = (0.5 + (least - bald) / SHARP).clamp(0.0, 1.0);
        let color = (color / sum).lerp(DARK * 0.3, mask);
        Coat {
            color: color.clamp(Vec3::ZERO, Vec3::ONE),
            length: (length / sum * (1.0 - mask)).clamp(0.0, 1.0),
        }
    }

    /// The limbs near a point of the surface, and how near they are as shares of 1: limbs farther
    /// than the nearest one lose by a factor of e each `soft` units.
    pub(super) fn nearness(&self, p: Vec3, soft: f32) -> Vec<(Limb, f32)> {
        let mut near: Vec<(Limb, f32)> = Vec::new();
        for part in &self.parts {
            let distance = part.distance(p);
            match near.iter_mut().find(|(limb, _)| *limb == part.limb) {
                Some((_, least)) => *least = least.min(distance),
                None => near.push((part.limb, distance)),
            }
        }
        let least = near.iter().map(|n| n.1).fold(f32::INFINITY, f32::min);
        near.iter_mut().for_each(|n| n.1 = (-(n.1 - least) / soft).exp());
        let sum: f32 = near.iter().map(|n| n.1).sum();
        // What is far away is rounding, and would widen the bounds of its joint.
        near.retain_mut(|n| {
            n.1 /= sum;
            n.1 > LEAST_SHARE
        });
        near
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
