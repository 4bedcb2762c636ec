//! Corners of an intersection of half-spaces, none of them outside.
//!
//! Everything is computed relative to a point inside, where numbers are as small as the solid is.
//! Planes are points of the dual space: the triangles of their hull are the corners of the solid.
//! In the end corners are pulled towards the point inside until each is proven to lie in every
//! half-space.

use glam::{DMat3, DVec3};

use crate::error::Error;
use crate::geometry::Plane;
use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::{ASKEW, CORNER, FLAT, MAX_PULL, TWICE};
use crate::shape::convex::hull;

/// How often the middle is looked for, from ever nearer. Twice suffices for planes that all bound
/// the solid, once more helps where far planes mislead the first guess.
const PASSES: usize = 3;

pub(crate) const NO_SOLID: Error = Error::Convex("its half-spaces bound no solid");
const TOO_THIN: Error = Error::Convex(
    "between its half-spaces is less room than double precision resolves so far from the origin",
);

/// Corners of a solid.
pub(crate) struct Corners {
    /// Proven to lie in every half-space.
    pub(crate) inside: Vec<DVec3>,
    /// As computed, possibly outside by a rounding.
    pub(crate) found: Vec<DVec3>,
}

/// `normal . x + offset` as if computed in twice the precision, and a bound of its error: zero if
/// nothing was rounded.
fn value(plane: &Plane, x: DVec3) -> (f64, f64) {
    let n = plane.normal.as_dvec3();
    let (mut sum, mut rest, mut all) = (f64::from(plane.offset), 0.0, f64::from(plane.offset).abs());
    let mut exact = true;
    for i in 0..3 {
        let product = n[i] * x[i];
        let low = n[i].mul_add(x[i], -product);
        let next = sum + product;
        let back = next - sum;
        let lost = (sum - (next - back)) + (product - back);
        exact &= low == 0.0 && lost == 0.0;
        (sum, rest, all) = (next, rest + (low + lost), all + product.abs());
    }
    (sum + rest, if exact { 0.0 } else { TWICE * all })
}

fn surely_holds(plane: &Plane, x: DVec3) -> bool {
    let (value, error) = value(plane, x);
    value >= error
}

/// The half-spaces with normals of length 1, relative to a point.
fn around(planes: &[Plane], center: DVec3) -> Vec<HalfSpace> {
    let scaled = |p: &Plane| {
        let n = p.normal.as_dvec3();
        HalfSpace { normal: n / n.length(), offset: value(p, center).0 / n.length() }
    };
    planes.iter().map(scaled).collect()
}

/// The common point of three planes.
fn meet(planes: [HalfSpace; 3], askew: f64) -> Option<DVec3> {
    let [a, b, c] = planes.map(|plane| plane.normal);
    let (u, v, w) = (b.cross(c), c.cross(a), a.cross(b));
    let volume = -a.dot(u);
    if volume.abs() <= askew {
        return None;
    }
    let solve = |p: f64, q: f64, r: f64| (u * p + v * q + w * r) / volume;
    let [p, q, r] = planes.map(|plane| plane.offset);
    let x = solve(p, q, r);
    // Once more for the distances that remain: then x is on all three planes but for rounding,
    // however askew they are.
    let [p, q, r] = planes.map(|plane| plane.distance(x));
    Some(x + solve(p, q, r)).filter(|x| x.is_finite())
}

/// The middle of the corners, counted as often as three planes meet there; `None` if there are
/// none.
fn middle(near: &[HalfSpace]) -> Option<DVec3> {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for k in 2..near.len() {
        for j in 1..k {
            for i in 0..j {
                let Some(x) = meet([near[i], near[j], near[k]], ASKEW) else { continue };
                let largest = x.abs().max_element();
                if near.iter().all(|plane| plane.beyond(x) <= FLAT * (largest + plane.offset.abs())) {
                    (sum, count) = (sum + x, count + 1.0);
                }
            }
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// The point with the least sum of squares of distances from all planes: near the solid, unless
/// some planes are far from it.
fn first_guess(planes: &[Plane]) -> DVec3 {
    let (mut m, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for HalfSpace { normal: n, offset } in around(planes, DVec3::ZERO) {
        m += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        right -= n * offset;
    }
    let guess = m.inverse() * right;
    if guess.is_finite() { guess } else { DVec3::ZERO }
}

/// The corners of the intersection of half-spaces that the origin lies inside of, but for rounding.
pub(crate) fn corners_around(near: &[HalfSpace]) -> Option<Vec<DVec3>> {
    let depth = near.iter().map(|p| p.offset).fold(f64::INFINITY, f64::min);
    // The hull of the dual points has no tolerance: a plane that is left out would let corners
    // stick out.
    let dual: Vec<DVec3> = near.iter().map(|p| -p.normal * (depth / p.offset)).collect();
    let triangles = hull::triangles(&dual, 0.0)?;
    hull::surrounds(&dual, &triangles, DVec3::ZERO)
        .then(|| triangles.iter().filter_map(|t| meet(t.map(|i| near[i]), 0.0)).collect())
}

/// The corners of the intersection of half-spaces, each of which has a direction.
pub(crate) fn corners(planes: &[Plane]) -> Result<Corners, Error> {
    let mut center = first_guess(planes);
    for _ in 0..PASSES {
        center += middle(&around(planes, center)).ok_or(NO_SOLID)?;
    }
    let near = around(planes, center);
    let depth = near.iter().map(|p| p.offset).fold(f64::INFINITY, f64::min);
    if depth.is_nan() || depth <= 0.0 || !center.is_finite() {
        return Err(NO_SOLID);
    }
    let found = corners_around(&near).ok_or(NO_SOLID)?;
    // Whatever rounding made of a corner, on its way to the middle it enters the solid.
    let entered = |&x: &DVec3| {
        let share = |p: &HalfSpace| {
            let along = -p.normal.dot(x);
            if along > p.offset { p.offset / along } else { 1.0 }
        };
        let shares = near.iter().map(share);
        x * shares.fold(1.0, f64::min)
    };
    let drawn_in: Vec<DVec3> = found.iter().map(entered).collect();
    let largest = drawn_in.iter().map(|x| (center.abs() + x.abs()).max_element()).fold(0.0, f64::max);
    let mut pull = 0.0;
    loop {
        let inside: Vec<DVec3> = drawn_in.iter().map(|&x| center + x * (1.0 - pull)).collect();
        if inside.iter().all(|&x| planes.iter().all(|p| surely_holds(p, x))) {
            return Ok(Corners { inside, found: found.iter().map(|&x| center + x).collect() });
        }
        pull = f64::max(2.0 * pull, CORNER * largest / depth);
        if pull.is_nan() || pull > MAX_PULL {
            return Err(TOO_THIN);
        }
    }
}
