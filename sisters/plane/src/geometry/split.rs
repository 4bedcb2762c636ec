//! Polygons of any form as convex ones.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};

use crate::error::{Error, finite2};
use crate::geometry::{ConvexPolygon, orient};

/// Corners of a polygon that is split, at most: the cost grows with their square.
pub const MAX_SPLIT_CORNERS: usize = 256;

impl ConvexPolygon {
    /// Splits a polygon that need not be convex into convex ones, whose corners are its corners:
    /// together they fill it without gaps. The corners come in order, in either direction; those on
    /// a side or given twice in a row do not matter.
    ///
    /// The parts are at most four times as many as are needed (ears are cut off and put together
    /// again: Meisters 1975, Hertel and Mehlhorn 1983). Costs the square of the corners, all
    /// decisions in exact arithmetic.
    ///
    /// ```
    /// use casca_plane::ConvexPolygon;
    /// use glam::Vec2;
    ///
    /// # fn main() -> Result<(), casca_plane::Error> {
    /// let corner = [(0., 0.), (4., 0.), (4., 1.), (1., 1.), (1., 4.), (0., 4.)].map(Vec2::from);
    /// assert_eq!(ConvexPolygon::split(&corner)?.len(), 2);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Refuses points that are not finite, more than [`MAX_SPLIT_CORNERS`] corners, points on one
    /// line, and polygons whose sides cross or touch.
    pub fn split(corners: &[Vec2]) -> Result<Vec<Self>, Error> {
        let (mut ring, least) = simple_ring(corners)?;
        if orient(before(&ring, least), ring[least], after(&ring, least)) < 0.0 {
            ring.reverse();
        }
        let parts = joined(&ring, ears(&ring).ok_or(Error::NotSimple { corners: ring.len() })?);
        parts.into_iter().map(|part| Self::new(&part.map_to(&ring))).collect()
    }
}

/// Refuses what [`ConvexPolygon::split`] refuses.
#[cfg(feature = "tiled")]
pub(crate) fn check_split(corners: &[Vec2]) -> Result<(), Error> {
    simple_ring(corners).map(drop)
}

/// The corners of a polygon whose sides do not cross, and the place of one that is convex.
fn simple_ring(corners: &[Vec2]) -> Result<(Vec<DVec2>, usize), Error> {
    corners.iter().try_for_each(|&p| finite2("a corner of the polygon", p))?;
    let mut ring: Vec<DVec2> = corners.iter().map(|corner| corner.as_dvec2()).collect();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() > MAX_SPLIT_CORNERS {
        return Err(Error::ManyCorners { corners: ring.len(), max: MAX_SPLIT_CORNERS });
    }
    let Some(least) = lowest(&ring).filter(|_| ring.iter().any(|&p| orient(ring[0], ring[1], p) != 0.0))
    else {
        return Err(Error::FlatPolygon { points: corners.len() });
    };
    match is_simple(&ring) {
        true => Ok((ring, least)),
        false => Err(Error::NotSimple { corners: ring.len() }),
    }
}

/// Corners of a part, by their places in the polygon, counterclockwise.
#[derive(Debug, Clone, PartialEq)]
struct Part(Vec<usize>);

impl Part {
    fn map_to(&self, ring: &[DVec2]) -> Vec<Vec2> {
        self.0.iter().map(|&i| ring[i].as_vec2()).collect()
    }

    fn sides(&self) -> impl Iterator<Item = (usize, usize)> {
        self.0.iter().copied().zip(self.0.iter().copied().cycle().skip(1))
    }

    /// Its corners from one of them on.
    fn from(&self, corner: usize) -> impl Iterator<Item = usize> {
        let start = self.0.iter().position(|&c| c == corner).unwrap_or(0);
        self.0.iter().copied().cycle().skip(start).take(self.0.len())
    }

    /// Both parts on the two sides of `(a, b)` together, if that is convex.
    fn joined(&self, other: &Self, (a, b): (usize, usize), ring: &[DVec2]) -> Option<Self> {
        // Around this part from `b` to `a`, and on around the other.
        let mut union: Vec<usize> = self.from(b).collect();
        let end = union.len() - 1;
        union.extend(other.from(a).skip(1).take(other.0.len() - 2));
        let count = union.len();
        let corner = |k: usize| ring[union[k % count]];
        let turn = |k: usize| orient(corner(k + count - 1), corner(k), corner(k + 1));
        (turn(0) >= 0.0 && turn(end) >= 0.0).then_some(Self(union))
    }
}

/// The lowest of the leftmost corners whose two sides do not lie on a line: it is convex.
fn lowest(ring: &[DVec2]) -> Option<usize> {
    let bends = |&i: &usize| orient(before(ring, i), ring[i], after(ring, i)) != 0.0;
    let key = |&i: &usize| (ring[i].x, ring[i].y);
    (0..ring.len())
        .filter(bends)
        .min_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)))
}

fn before(ring: &[DVec2], i: usize) -> DVec2 {
    ring[(i + ring.len() - 1) % ring.len()]
}

fn after(ring: &[DVec2], i: usize) -> DVec2 {
    ring[(i + 1) % ring.len()]
}

/// Whether no two sides of a ring meet, but neighbours at their common corner.
fn is_simple(ring: &[DVec2]) -> bool {
    let count = ring.len();
    for i in 0..count {
        // A side that leads back along the one before it ends on that, where the next one begins.
        let (a, b) = (ring[i], after(ring, i));
        let others = (i + 2..count).filter(|&j| (j + 1) % count != i);
        for j in others {
            if meet((a, b), (ring[j], after(ring, j))) {
                return false;
            }
        }
    }
    true
}

/// Whether two segments have a point in common. Exact.
fn meet((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    if a.max(b).cmplt(c.min(d)).any() || c.max(d).cmplt(a.min(b)).any() {
        return false;
    }
    let apart = |p: f64, q: f64| p > 0.0 && q > 0.0 || p < 0.0 && q < 0.0;
    !apart(orient(a, b, c), orient(a, b, d)) && !apart(orient(c, d, a), orient(c, d, b))
}

/// Triangles that fill a counterclockwise ring; `None` if it is not simple.
fn ears(ring: &[DVec2]) -> Option<Vec<Part>> {
    let mut open: Vec<usize> = (0..ring.len()).collect();
    let mut parts = Vec::new();
    let mut is_ear: Vec<bool> = (0..open.len()).map(|place| tip(ring, &open, place)).collect();
    while open.len() > 3 {
        let place = is_ear.iter().position(|&ear| ear)?;
        let around = neighbours(&open, place);
        let [a, b, c] = around;
        if orient(ring[a], ring[b], ring[c]) > 0.0 {
            parts.push(Part(around.to_vec()));
        }
        open.remove(place);
        is_ear.remove(place);
        // No other corner becomes an ear or stops being one (O'Rourke 1998, 1.4).
        for place in [(place + open.len() - 1) % open.len(), place % open.len()] {
            is_ear[place] = tip(ring, &open, place);
        }
    }
    if orient(ring[open[0]], ring[open[1]], ring[open[2]]) > 0.0 {
        parts.push(Part(open));
    }
    Some(parts)
}

fn neighbours(open: &[usize], place: usize) -> [usize; 3] {
    let count = open.len();
    [open[(place + count - 1) % count], open[place], open[(place + 1) % count]]
}

/// Whether a corner can be cut off: it lies on a line with its neighbours, or the triangle of them
/// has no other corner in it.
fn tip(ring: &[DVec2], open: &[usize], place: usize) -> bool {
    let around = neighbours(open, place);
    let [a, b, c] = around.map(|i| ring[i]);
    let turn = orient(a, b, c);
    let inside = |p: DVec2| orient(a, b, p) >= 0.0 && orient(b, c, p) >= 0.0 && orient(c, a, p) >= 0.0;
    turn == 0.0 || turn > 0.0 && !open.iter().any(|i| !around.contains(i) && inside(ring[*i]))
}

/// Puts parts together where the result is convex, over each side that two parts have in common
/// once: a side that must stay does so whatever else is put together.
fn joined(ring: &[DVec2], mut parts: Vec<Part>) -> Vec<Part> {
    let mut owners: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (number, part) in parts.iter().enumerate() {
        part.sides().for_each(|side| _ = owners.insert(side, number));
    }
    let shared: Vec<_> =
        owners.keys().copied().filter(|&(a, b)| a < b && owners.contains_key(&(b, a))).collect();
    for (a, b) in shared {
        let (Some(&first), Some(&second)) = (owners.get(&(a, b)), owners.get(&(b, a))) else { continue };
        let Some(union) = parts[first].joined(&parts[second], (a, b), ring) else { continue };
        union.sides().for_each(|side| _ = owners.insert(side, first));
        parts[first] = union;
        parts[second].0.clear();
    }
    parts.retain(|part| !part.0.is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f32, f32)]) -> Vec<Vec2> {
        all.iter().map(|&p| p.into()).collect()
    }

    fn area(ring: &[Vec2]) -> f64 {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| a.as_dvec2().perp_dot(b.as_dvec2())).sum::<f64>() / 2.0
    }

    /// Rings around the origin of random radii: simple, whatever the radii.
    fn star(seed: u32, count: usize) -> Vec<Vec2> {
        let mut state = seed;
        (0..count)
            .map(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let angle = std::f32::consts::TAU * i as f32 / count as f32;
                Vec2::from_angle(angle) * (1.0 + (state >> 16) as f32 / 8192.0)
            })
            .collect()
    }

    #[test]
    fn parts_fill_the_polygon_and_do_not_overlap() {
        for seed in 0..60 {
            let count = 4 + seed as usize * 4;
            let mut ring = star(seed, count);
            if seed % 2 == 1 {
                ring.reverse();
            }
            let parts = ConvexPolygon::split(&ring).unwrap();
            let sum: f64 = parts.iter().map(|part| area(part.corners())).sum();
            assert!((sum - area(&ring).abs()).abs() < 1e-9 * sum, "{seed}: {sum} {}", area(&ring));
            assert!(parts.len() < count - 2 || count < 6, "{seed}: {} parts", parts.len());
            assert!(parts.iter().all(|part| part.corners().iter().all(|corner| ring.contains(corner))));
            // A grid of points: in one part at most, and in one if inside.
            for p in (-40..40).flat_map(|x| (-40..40).map(move |y| DVec2::new(x.into(), y.into()) * 0.25)) {
                assert!(parts.iter().filter(|part| part.surrounds(p)).count() <= 1, "{seed} {p}");
                let sides = ring.iter().zip(ring.iter().cycle().skip(1));
                let crossed = sides.filter(|(a, b)| {
                    let (a, b) = (a.as_dvec2(), b.as_dvec2());
                    (a.y > p.y) != (b.y > p.y) && (orient(a, b, p) > 0.0) == (b.y > a.y)
                });
                let inside = crossed.count() % 2 == 1;
                assert!(!inside || parts.iter().any(|part| part.contains(p)), "{seed} {p}");
            }
        }
    }

    #[test]
    fn corners_on_sides_and_twice_do_not_matter() {
        let square =
            points(&[(0., 0.), (0., 0.), (2., 0.), (4., 0.), (4., 4.), (0., 4.), (0., 2.), (0., 0.)]);
        let whole = ConvexPolygon::split(&square).unwrap();
        assert_eq!(whole, [ConvexPolygon::new(&square).unwrap()]);
        // A comb, whose notch ends on the line of its foot's corners.
        let comb = points(&[(0., 0.), (6., 0.), (6., 3.), (4., 3.), (4., 1.), (2., 1.), (2., 3.), (0., 3.)]);
        let parts = ConvexPolygon::split(&comb).unwrap();
        assert!(parts.len() <= 4, "{}", parts.len());
        assert_eq!(parts.iter().map(|part| area(part.corners())).sum::<f64>(), 14.0);
    }

    #[test]
    fn other_polygons_are_refused() {
        let split = |all: &[(f32, f32)]| ConvexPolygon::split(&points(all)).unwrap_err();
        let bow = [(0., 0.), (2., 2.), (2., 0.), (0., 2.)];
        assert_eq!(split(&bow), Error::NotSimple { corners: 4 });
        let back = [(0., 0.), (4., 0.), (2., 0.), (2., 2.)];
        assert_eq!(split(&back), Error::NotSimple { corners: 4 });
        let spike = [(0., 0.), (4., 0.), (4., 4.), (4., 8.), (4., 4.), (0., 4.)];
        assert_eq!(split(&spike), Error::NotSimple { corners: 6 });
        let touching = [(0., 0.), (4., 0.), (4., 4.), (2., 0.), (0., 4.)];
        assert_eq!(split(&touching), Error::NotSimple { corners: 5 });
        for flat in
            [&[(0., 0.), (1., 1.), (2., 2.)][..], &[(1., 1.); 5], &[(1., 1.)], &[], &[(0., 0.), (1., 0.)]]
        {
            assert_eq!(split(flat), Error::FlatPolygon { points: flat.len() });
        }
        assert!(matches!(split(&[(0., f32::NAN)]), Error::NotFinite { .. }));
        let many = ConvexPolygon::split(&star(1, MAX_SPLIT_CORNERS + 1)).unwrap_err();
        assert_eq!(many, Error::ManyCorners { corners: MAX_SPLIT_CORNERS + 1, max: MAX_SPLIT_CORNERS });
    }
}
