//! Rays between discs.

use super::disc::{Disc, Discs};
use super::fan::covers;
use crate::numeric::ALONG;
use glam::{DVec3, Vec2, Vec3A};
use obvhs::ray::Ray;
use rayon::prelude::*;
use std::f32::consts::FRAC_PI_3;

/// Rays start at most so far from their points: the cloud is within the cube from -1 to 1.
const START: f64 = 8.0;

// Lengths in spacings.
/// Discs and points nearer than this may be parts of one surface that bends.
const NEAR: f32 = 3.0;
/// How far behind a disc that faces the eye a point may be that faces away as the surface folds, and not be
/// hidden.
const TURNED: f32 = 0.02;
/// How far the two sides of a plate may be apart.
const PLATE: f32 = 1.5;

/// Normals of larger cosine are of one smooth surface.
const SMOOTH: f32 = 0.5;
/// The least cosine of the normals of a plate's sides.
const PARALLEL: f32 = 0.9;

/// A visible point is hidden if less than this part of its peers is visible, and a hidden one
/// visible if more than that is: rays that slip through an edge see few points. More by peers hides
/// what is seen through narrow gaps.
const FEWEST: f32 = 0.25;
const MOST: f32 = 0.8;
/// Fewer peers do not count.
const LEAST_PEERS: usize = 4;
/// Peers are neighbours on the same part of the surface, so near by place, by height over the plane, as a part
/// of [`Margins::layer`](super::disc::Margins), and by the cosine of normals. They are sought among discs so
/// many places away in the order of the tree.
const PEER: f32 = 1.6;
const PEER_LAYER: f32 = 0.5;
const PEER_TURN: f32 = 0.8;
const PLACES: usize = 32;

/// The least cosine by which a point of a solid is turned away from an eye that does not see it.
const TURNED_AWAY: f32 = 0.05;

/// The rays that tell whether a point is on a closed body: one along the normal and others around
/// it, the tangent of their angle to it, and the least part of a spacing that a hit is away.
const AROUND: usize = 6;
const SLANT: f32 = 0.5;
const AWAY: f32 = 0.02;
/// Discs nearer than a spacing with normals of a larger cosine are the point's own face.
const OWN_FACE: f32 = 0.7;

/// Where the ray from an eye to a point starts: at the eye, or nearer.
fn start(eye: DVec3, at: Vec3A) -> Vec3A {
    let way = eye - at.as_dvec3();
    at + (way * (START / way.length()).min(1.0)).as_vec3a()
}

impl Disc {
    /// Whether it covers a place of its plane, relative to its middle.
    #[inline]
    fn covers(&self, hit: Vec3A) -> bool {
        let (u, v) = self.normal.any_orthonormal_pair();
        covers(|sector| self.reach(sector), Vec2::new(hit.dot(u), hit.dot(v)))
    }

    /// Where a ray meets it, and the cosine of the ray's direction and its normal.
    fn hit(&self, from: Vec3A, direction: Vec3A) -> Option<(f32, f32)> {
        let down = self.normal.dot(direction);
        if down.abs() < ALONG {
            return None;
        }
        let far = self.normal.dot(self.at - from) / down;
        (far > 0.0 && self.covers(from + direction * far - self.at)).then_some((far, down))
    }
}

impl Discs {
    /// Whether each disc can be seen from `eye`.
    pub(super) fn visible(&self, eye: DVec3) -> Vec<bool> {
        let first: Vec<bool> = (0..self.discs.len()).into_par_iter().map(|i| self.is_seen(eye, i)).collect();
        let judged = |i: usize| {
            let disc = self.discs[i].disc();
            if disc.oriented {
                return first[i];
            }
            let level = PEER_LAYER * self.margins.layer * disc.spacing.max(self.margins.grain);
            let is_peer = |&j: &usize| {
                let away = Vec3A::from(self.discs[j].at) - disc.at;
                j != i
                    && away.length() < PEER * disc.spacing
                    && away.dot(disc.normal).abs() < level
                    && self.discs[j].disc().normal.dot(disc.normal).abs() > PEER_TURN
            };
            let peers = (i.saturating_sub(PLACES)..first.len().min(i + PLACES + 1)).filter(is_peer);
            let (count, visible) =
                peers.fold((0, 0), |(count, visible), j| (count + 1, visible + usize::from(first[j])));
            let share = visible as f32 / count as f32;
            match first[i] {
                seen if count < LEAST_PEERS => seen,
                true => share >= FEWEST,
                false => share > MOST,
            }
        };
        (0..first.len()).into_par_iter().map(judged).collect()
    }

    /// Whether the ray to a disc is free, and the disc does not face away on a closed body or on the
    /// rim of a plate, nor is the far side of a plate.
    fn is_seen(&self, eye: DVec3, i: usize) -> bool {
        let disc = &self.discs[i].disc();
        if disc.stray && !self.show_strays {
            return false;
        }
        let start = start(eye, disc.at);
        if start == disc.at {
            return true;
        }
        let ray = Ray::new(start, disc.at - start, 0.0, 1.0);
        if self.any(ray, |j, other| j != i && self.hides(other, start, disc)) {
            return false;
        }
        let facing = disc.normal.dot(start - disc.at);
        if disc.solid && facing < -TURNED_AWAY * (start - disc.at).length() {
            return false;
        }
        if disc.oriented {
            !(facing < 0.0 && self.is_on_body(i, disc))
        } else {
            !self.is_in_plate(start, i, disc)
        }
    }

    /// Whether one of the discs near a ray has a property.
    fn any(&self, ray: Ray, mut is: impl FnMut(usize, &Disc) -> bool) -> bool {
        let mut found = false;
        self.tree.ray_traverse_miss(ray, |_, j| {
            found = found || self.discs[j].is_near(&ray) && is(j, &self.discs[j].disc());
            if found { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }

    /// Whether `disc` is between `start` and the point of `to`, which is not a part of the same surface.
    #[inline]
    fn hides(&self, disc: &Disc, start: Vec3A, to: &Disc) -> bool {
        let above = disc.normal.dot(start - disc.at);
        let below = disc.normal.dot(to.at - disc.at);
        if above * below >= 0.0 {
            return false;
        }
        let step = to.at - start;
        let away = to.at - disc.at;
        let near = away.length() < NEAR * disc.spacing.max(to.spacing).max(self.margins.grain);
        let cosine = disc.normal.dot(to.normal);
        let facing = to.normal.dot(step);
        let fold = near && cosine.abs() > SMOOTH && above * facing * cosine > 0.0;
        let straight = self.margins.behind * disc.spacing.max(self.margins.grain);
        let behind = if fold { TURNED * disc.spacing } else { straight + 2.0 * disc.rough };
        if below.abs() <= behind {
            return false;
        }
        // Two planes of which each is behind the other meet at an edge that hides neither.
        if near && !fold && to.normal.dot(away) * facing.signum() <= straight {
            return false;
        }
        disc.covers(start + step * (above / (above - below)) - disc.at)
    }

    /// Whether a parallel surface is close before the point on the eye's side, so that the point is
    /// on the far side of a plate: rays slip past the edges of plates, which have few points.
    fn is_in_plate(&self, start: Vec3A, i: usize, disc: &Disc) -> bool {
        let direction = disc.normal * disc.normal.dot(start - disc.at).signum();
        let most = PLATE * disc.spacing;
        self.any(Ray::new(disc.at, direction, 0.0, most), |j, other| {
            let least =
                self.margins.plate * disc.spacing.max(self.margins.grain) + 2.0 * (disc.rough + other.rough);
            let parallel = j != i && other.normal.dot(direction).abs() >= PARALLEL;
            parallel && other.hit(disc.at, direction).is_some_and(|(far, _)| far > least && far <= most)
        })
    }

    /// Whether most rays from the back of the point first meet a surface from within: it is on a
    /// closed body, and not on a sheet.
    fn is_on_body(&self, i: usize, disc: &Disc) -> bool {
        let (u, v) = disc.normal.any_orthonormal_pair();
        let slanted = |k: usize| {
            let turn = Vec2::from_angle(k as f32 * FRAC_PI_3);
            (SLANT * (u * turn.x + v * turn.y) - disc.normal).normalize()
        };
        let rays = (0..AROUND).map(slanted).chain([-disc.normal]);
        let inside = rays.filter(|&direction| self.leaves(i, disc, direction)).count();
        2 * inside > AROUND + 1
    }

    /// Whether the first disc that a ray from a point meets is met from behind.
    fn leaves(&self, i: usize, disc: &Disc, direction: Vec3A) -> bool {
        let mut first = (f32::INFINITY, usize::MAX, false);
        self.any(Ray::new(disc.at, direction, 0.0, f32::INFINITY), |j, other| {
            let own = |far: f32| other.normal.dot(disc.normal) > OWN_FACE && far < disc.spacing;
            if j != i
                && other.oriented
                && let Some((far, down)) = other.hit(disc.at, direction)
                && far > AWAY * disc.spacing
                && !own(far)
                && (far, j) < (first.0, first.1)
            {
                first = (far, j, down > 0.0);
            }
            false
        });
        first.2
    }
}
