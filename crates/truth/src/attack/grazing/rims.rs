//! Outlines: where eyes look closely past a solid.

use glam::DVec3;

use super::super::dice::Dice;
use super::super::solid::{Edge, Solid};
use crate::numeric::attack::ALONG_EDGE;

/// Where rays start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At an eye.
    Eye(DVec3),
    /// This far before each point, along a direction of length 1.
    Before(DVec3, f64),
}

impl Start {
    /// The direction of the ray to a point, of any length.
    pub fn toward(&self, point: DVec3) -> DVec3 {
        match *self {
            Self::Eye(eye) => point - eye,
            Self::Before(along, far) => along * far,
        }
    }
}

impl Solid {
    /// Whether it has an outline.
    pub fn has_rim(&self) -> bool {
        self.is_ball() || !self.edges.is_empty()
    }

    /// A point of it where a line touches it and a ball of eyes on the other side, and the
    /// direction from the middle of the ball to the eye that looks along that line, of length 1: no
    /// eye of the ball sees more past that point.
    pub fn rim_of_ball(&self, eye: DVec3, reach: f64, dice: &mut Dice) -> Option<(DVec3, DVec3)> {
        // The unit vector `n` across the line, with `n . (middle - eye) = reach - radius`.
        let across = |ahead: DVec3, aside: DVec3, radius: f64| {
            let sine = (reach - radius) / ahead.length();
            let out = ahead.normalize() * sine + aside * (1.0 - sine * sine).sqrt();
            (sine.abs() < 1.0).then_some(out)
        };
        let (point, aside) = self.rim(&Start::Eye(eye), dice)?;
        if self.is_ball() {
            let ahead = self.middle - eye;
            let aside = (point - eye).reject_from(ahead).try_normalize()?;
            let out = across(ahead, aside, self.radius)?;
            return Some((self.middle + out * self.radius, out));
        }
        // Across the edge, which is at right angles to `aside` and to the part of the ray across
        // it.
        let near = self.edges.iter().min_by(|p, q| {
            let far = |e: &Edge| {
                let along = (e.ends[1] - e.ends[0]).normalize();
                (point - e.ends[0]).reject_from_normalized(along).length()
            };
            far(p).total_cmp(&far(q))
        })?;
        let along = (near.ends[1] - near.ends[0]).try_normalize()?;
        let out = across((point - eye).reject_from_normalized(along), aside, 0.0)?;
        Some((point, out))
    }

    /// A point of its outline, as seen from a start, and the direction away from it across the ray,
    /// of length 1.
    pub fn rim(&self, start: &Start, dice: &mut Dice) -> Option<(DVec3, DVec3)> {
        if self.is_ball() {
            let toward = start.toward(self.middle).normalize();
            let (a, b) = toward.any_orthonormal_pair();
            let angle = dice.real() * std::f64::consts::TAU;
            let across = a * angle.cos() + b * angle.sin();
            let Start::Eye(eye) = start else { return Some((self.middle + across * self.radius, across)) };
            let far = (self.middle - *eye).length();
            let sine = self.radius / far;
            if sine >= 1.0 {
                return None;
            }
            let cosine = (1.0 - sine * sine).sqrt();
            let out = across * cosine - toward * sine;
            return Some((self.middle + out * self.radius, out));
        }
        let count = self.edges.len() as u32;
        (0..if count > 0 { 12 } else { 0 }).find_map(|_| {
            let edge = &self.edges[dice.below(count) as usize];
            let [a, b] = edge.ends;
            let ray = start.toward(a);
            if let [Some(m), Some(n)] = edge.normals
                && (m.dot(ray) > 0.0) == (n.dot(ray) > 0.0)
            {
                return None;
            }
            let point = a + (b - a) * share(dice);
            let ray = start.toward(point).normalize();
            let out = ray.cross((b - a).normalize());
            if out.length() < ALONG_EDGE {
                return None;
            }
            let out = out.normalize();
            let inwards = out.dot(edge.inner - point);
            // A face that is seen from its edge does not tell the sides apart.
            if inwards.abs() < ALONG_EDGE * edge.inner.distance(point) {
                return None;
            }
            Some((point, if inwards > 0.0 { -out } else { out }))
        })
    }
}

/// Where on an edge: often at its middle, or next to an end.
fn share(dice: &mut Dice) -> f64 {
    match dice.below(8) {
        0 => 10f64.powf(-1.0 - 6.0 * dice.real()),
        1 => 0.5,
        _ => dice.real(),
    }
}
