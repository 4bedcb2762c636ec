//! Places of scanners as evidence: a point faces its scanner, and nothing is between both.
//!
//! So the sign of a normal is known, and discs that reach over the segment between a point and its
//! scanner end before it, as free space does in maps of robots (Moravec & Elfes 1985, "High
//! Resolution Maps from Wide Angle Sonar").

use super::disc::{Disc, Discs, Frame};
use super::fan::{self, SECTORS, axes};
use crate::PointCloud;
use crate::numeric::FARTHEST_EYE;
use crate::spacing::Places;
use glam::{DVec3, Vec2, Vec3A};
use rayon::prelude::*;

/// Where a disc ends before a free segment, as a part of the segment's distance from its middle:
/// the edge is anywhere between both.
const END: f32 = 0.5;
/// Discs are larger by this factor when segments are sought that end them.
const LARGER: f32 = 1.0 / END;
/// A segment that crosses more discs tells nothing: so many cover a place of a whole wall, and the
/// point behind it is the image in a mirror or window.
const MOST: usize = 16;
/// The least part of a scanner's points that it sees, or its place is not believed. It sees two
/// thirds of them at a noise of 0.3 spacings.
const SEEN: f64 = 0.5;

/// The scanners of a cloud, in its frame.
pub(super) struct Scanners {
    /// None if it is not finite, or not believed.
    places: Vec<Option<DVec3>>,
    /// The scanner of each disc.
    of: Vec<u32>,
}

/// The evidence of segments from scanners to their points.
pub(super) struct Evidence {
    /// For each disc and sector, how far away the nearest segment crosses its plane.
    nearest: Vec<[f32; SECTORS]>,
    /// For each scanner, its points and those that discs hide from it.
    hidden: Vec<[u64; 2]>,
}

/// A disc that a segment crosses: its number, the sector, and how far from its middle.
type Crossing = (u32, u32, f32);

impl Scanners {
    pub fn new(cloud: &PointCloud, unique: &Places, frame: &Frame) -> Self {
        let place = |&place: &DVec3| {
            let way = (place - frame.middle) * frame.scale;
            // The difference may be infinite.
            (way.abs().max_element() < FARTHEST_EYE).then_some(way)
        };
        let places: Vec<Option<DVec3>> = cloud.scanners.iter().map(place).collect();
        let known = |&i: &u32| {
            let scanner = *cloud.seen_by.get(i as usize)?;
            (*places.get(scanner as usize)?).map(|_| scanner)
        };
        let of = |group: &[u32]| group.iter().find_map(known).unwrap_or(u32::MAX);
        let of = if cloud.seen_by.is_empty() { Vec::new() } else { unique.groups().map(of).collect() };
        Self { places, of }
    }

    /// The place of the scanner that saw a disc, if it is known.
    pub fn of(&self, i: usize) -> Option<DVec3> {
        *self.places.get(*self.of.get(i)? as usize)?
    }

    /// A normal or its opposite, whichever points to the scanner.
    pub fn facing(&self, normal: Vec3A, at: Vec3A, i: usize) -> Vec3A {
        let away = |scanner: DVec3| normal.as_dvec3().dot(scanner - at.as_dvec3()) < 0.0;
        if self.of(i).is_some_and(away) { -normal } else { normal }
    }

    /// The evidence for discs; none if no scanner is known.
    pub fn evidence(&self, discs: &Discs) -> Option<Evidence> {
        let count = discs.discs.len();
        if !(0..count).any(|i| self.of(i).is_some()) {
            return None;
        }
        let larger = |disc: &Disc| Disc { reach: disc.reach.map(|far| LARGER * far), ..*disc };
        let mut large = discs.clone();
        large.replace(discs.discs.iter().map(larger).collect());
        let crossings: Vec<(Vec<Crossing>, bool)> = (0..count)
            .into_par_iter()
            .map(|i| self.of(i).map_or_else(Default::default, |from| crossings(discs, &large, i, from)))
            .collect();
        let mut evidence = Evidence {
            nearest: vec![[f32::INFINITY; SECTORS]; count],
            hidden: vec![[0; 2]; self.places.len()],
        };
        for (i, (crossings, hidden)) in crossings.iter().enumerate() {
            if self.of(i).is_some() {
                let [points, behind] = &mut evidence.hidden[self.of[i] as usize];
                *points += 1;
                *behind += u64::from(*hidden);
            }
            for &(disc, sector, far) in crossings {
                let nearest = &mut evidence.nearest[disc as usize][sector as usize];
                *nearest = nearest.min(far);
            }
        }
        Some(evidence)
    }

    /// Believes no scanner any more that sees few of its points. Whether there are some.
    pub fn disbelieve(&mut self, evidence: &Evidence) -> bool {
        let mut some = false;
        for (place, &[points, hidden]) in self.places.iter_mut().zip(&evidence.hidden) {
            if hidden as f64 > (1.0 - SEEN) * points as f64 {
                (*place, some) = (None, true);
            }
        }
        some
    }
}

impl Evidence {
    /// The discs, ended before the segments.
    pub fn carved(&self, mut discs: Discs) -> Discs {
        let mut ended = std::mem::take(&mut discs.discs);
        for (disc, nearest) in ended.iter_mut().zip(&self.nearest) {
            for (k, far) in nearest.iter().enumerate() {
                for k in [k, (k + 1) % SECTORS] {
                    disc.reach[k] = disc.reach[k].min(END * far);
                }
            }
        }
        discs.replace(ended);
        discs
    }
}

/// The larger discs that the segment from a scanner to its point crosses, and whether it crosses
/// one of the others.
fn crossings(discs: &Discs, large: &Discs, i: usize, scanner: DVec3) -> (Vec<Crossing>, bool) {
    let start = discs.start(scanner, i);
    let (mut found, mut hidden) = (Vec::new(), false);
    if start == discs.discs[i].at {
        return (found, hidden);
    }
    large.hiders(start, i, |j, hit| {
        let (u, v) = axes(discs.discs[j].normal);
        let hit = Vec2::new(hit.dot(u), hit.dot(v));
        hidden |= fan::covers(&discs.discs[j].reach, hit);
        found.push((j as u32, fan::sector(hit) as u32, hit.length()));
        found.len() > MOST
    });
    if found.len() > MOST {
        // Whether a wall hides it can be taken for granted.
        return (Vec::new(), true);
    }
    (found, hidden)
}

#[cfg(test)]
mod tests {
    use super::super::{Surface, visible};
    use super::*;
    use glam::Vec3;

    /// Points of a square of side 20 around the z axis, a unit apart.
    fn square(z: f32) -> impl Iterator<Item = Vec3> + Clone {
        (0..441).map(move |i| Vec3::new((i % 21) as f32 - 10.0, (i / 21) as f32 - 10.0, z))
    }

    fn cloud(parts: &[(f32, DVec3)]) -> PointCloud {
        let mut cloud = PointCloud::default();
        for (number, &(z, scanner)) in parts.iter().enumerate() {
            cloud.scanners.push(scanner);
            cloud.seen_by.extend(square(z).map(|_| number as u32));
            cloud.positions.extend(square(z));
        }
        cloud
    }

    const ABOVE: DVec3 = DVec3::new(3.0, 2.0, 30.0);
    const BELOW: DVec3 = DVec3::new(3.0, 2.0, -30.0);

    #[test]
    fn normals_point_to_scanners() {
        let cloud = cloud(&[(0.0, ABOVE), (40.0, ABOVE)]);
        let surface = Surface::new(&cloud).unwrap();
        for (i, normal) in surface.normals().enumerate() {
            assert!(normal.z * if i < 441 { 1.0 } else { -1.0 } > 0.99, "{i}: {normal}");
        }
        // Given ones are turned, too: those that point away are wrong.
        let given = PointCloud { normals: vec![Vec3::NEG_Z; 882], ..cloud };
        assert!(Surface::new(&given).unwrap().normals().take(441).all(|normal| normal == Vec3::Z));
    }

    #[test]
    fn nobody_sees_a_solid_from_behind_but_a_sheet() {
        let solid = cloud(&[(0.0, ABOVE)]);
        let surface = Surface::new(&solid).unwrap();
        // Flat ways of looking at its front, too.
        for eye in [ABOVE, DVec3::new(100.0, 0.0, 30.0), DVec3::new(0.0, -100.0, 15.0)] {
            assert!(surface.visible(eye).unwrap().all(), "{eye}");
        }
        assert!(!surface.visible(BELOW).unwrap().any());
        // Points whose scanner is not told are seen from both sides.
        let unknown = PointCloud { seen_by: vec![crate::UNKNOWN_SCANNER; 441], ..cloud(&[(0.0, ABOVE)]) };
        assert!(visible(&unknown, BELOW).unwrap().all());
        // A scanner below it has seen the same points, so that it is a sheet.
        let mut sheet = cloud(&[(0.0, ABOVE), (0.02, BELOW)]);
        assert!(visible(&sheet, BELOW).unwrap().all());
        // The sides of a board are farther apart: each is seen from its side.
        sheet.positions.iter_mut().skip(441).for_each(|p| p.z = -0.4);
        let seen = visible(&sheet, BELOW).unwrap();
        assert!(!seen[..441].any() && seen[441..].all());
        // Through a hole in the lower side one sees the upper one from behind, up to the border.
        let in_hole = |p: &Vec3| p.x.abs() < 5.5 && p.y.abs() < 5.5;
        let kept = |i: &usize| *i < 441 || !in_hole(&sheet.positions[*i]);
        let kept: Vec<usize> = (0..sheet.len()).filter(kept).collect();
        let holed = PointCloud {
            positions: kept.iter().map(|&i| sheet.positions[i]).collect(),
            seen_by: kept.iter().map(|&i| sheet.seen_by[i]).collect(),
            ..sheet
        };
        let found = visible(&holed, BELOW).unwrap();
        let near_border = |p: &Vec3| in_hole(p) && p.x.abs().max(p.y.abs()) > 3.5;
        let seen = (0..441).filter(|&i| near_border(&holed.positions[i]));
        let seen: Vec<bool> = seen.map(|i| found[i]).collect();
        assert!(seen.len() > 30 && !seen.contains(&true), "{seen:?}");
    }

    /// A strip of points before a wall: those of the wall that are not near its shadow.
    fn strip(reach: f32) -> PointCloud {
        let mut cloud = cloud(&[(0.0, ABOVE)]);
        let far = |p: &Vec3| p.x.abs() > reach;
        let mut wall: Vec<Vec3> = square(0.0).filter(far).collect();
        let count = wall.len();
        // Points near the front in a strip of width 2.
        wall.extend((0..63).map(|i| Vec3::new((i % 3) as f32 - 1.0, (i / 3) as f32 - 10.0, 10.0)));
        cloud.scanners = vec![DVec3::new(0.0, 0.0, 200.0)];
        cloud.seen_by = vec![0; count + 63];
        cloud.positions = wall;
        cloud
    }

    /// How far the discs of the last points of the strip reach along x, at least.
    fn overhang(cloud: &PointCloud) -> f32 {
        let discs = Surface::new(cloud).unwrap().0;
        let last = |p: Vec3| p.z == 10.0 && p.x == 1.0 && p.y.abs() < 5.0;
        let ends = (0..cloud.len()).filter(|&i| last(cloud.positions[i]));
        let reaches = ends.map(|i| {
            let disc = &discs.discs[discs.disc_of[i] as usize];
            let (u, v) = axes(disc.normal);
            let along = |d: Vec2| (u * d.x + v * d.y).x;
            let k = (0..SECTORS)
                .max_by(|&a, &b| along(fan::DIRECTIONS[a]).total_cmp(&along(fan::DIRECTIONS[b])))
                .unwrap();
            disc.reach[k] / discs.frame.scale as f32
        });
        reaches.fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn discs_end_half_way_to_free_segments() {
        // Segments to the nearest points of the wall pass the strip at x = 1.9 and 1.33, which is
        // 0.9 and 0.33 beyond the last points of the strip.
        for (shift, least, most) in [(0.0, 0.4, 0.46), (0.6, 0.14, 0.18)] {
            let mut cloud = strip(1.5);
            let wall = cloud.positions.iter_mut().filter(|p| p.z == 0.0);
            wall.for_each(|p| p.x -= shift * p.x.signum());
            let bare = PointCloud { seen_by: Vec::new(), ..cloud.clone() };
            let found = [overhang(&cloud), overhang(&bare)];
            assert!(found[0] > least && found[0] < most && found[1] > 0.5, "{shift}: {found:?}");
        }
    }

    #[test]
    fn a_scanner_that_sees_few_of_its_points_is_not_believed() {
        // Seen from the other side, a wall would hide all of the other.
        let mut cloud = cloud(&[(0.0, ABOVE), (20.0, ABOVE)]);
        cloud.scanners[1] = BELOW;
        let surface = Surface::new(&cloud).unwrap();
        let none = PointCloud {
            seen_by: cloud.seen_by.iter().map(|&s| if s == 1 { 9 } else { s }).collect(),
            ..cloud.clone()
        };
        let without = Surface::new(&none).unwrap();
        for eye in [ABOVE, BELOW, DVec3::new(40.0, 3.0, 10.0)] {
            assert_eq!(surface.visible(eye).unwrap(), without.visible(eye).unwrap(), "{eye}");
        }
    }

    #[test]
    fn places_that_are_not_finite_are_unknown() {
        let cloud = cloud(&[(0.0, DVec3::NAN), (5.0, DVec3::splat(f64::INFINITY)), (9.0, DVec3::MAX)]);
        let bare = PointCloud { scanners: Vec::new(), ..cloud.clone() };
        let answers = |cloud: &PointCloud| visible(cloud, BELOW).unwrap();
        assert_eq!(answers(&cloud), answers(&bare));
    }
}
