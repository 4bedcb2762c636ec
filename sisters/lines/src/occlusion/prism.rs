//! Columns clipped to the hemisphere of a receiver (Benevides 2015, sections 3.3.1 and 3.3.2).
//!
//! Lengths are in radii of the hemisphere, so that no product under- or overflows in scenes of very
//! small or very large units.

use glam::{Vec2, Vec3};

use super::options::BasePlane;
use crate::buffers::Fragment;
use crate::numeric::{ALONG_VIEW, PARALLEL};
use crate::view::View;

/// The hemisphere around a point of a line: its base is tangent to the line, its pole is turned to
/// the viewer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hemisphere {
    /// The receiver in eye space, in units of the scene.
    pub(crate) middle: Vec3,
    pub(crate) pole: Vec3,
    /// In units of the scene.
    pub(crate) radius: f32,
    /// Directions of the disc of samples, normal to the direction of view.
    pub(super) across: [Vec3; 2],
    perspective: bool,
}

/// A column in the hemisphere. Its points are `start + t * step` from the receiver, for `t` from
/// `from` to `to`; `t` is a depth, counted from that of `start`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prism {
    /// The sampled point of the disc, from the receiver.
    pub(crate) start: Vec3,
    /// The motion along the column for each unit of depth.
    pub(crate) step: Vec3,
    pub(crate) from: f32,
    pub(crate) to: f32,
}

impl Hemisphere {
    /// `None` for a receiver at or behind the eye of a perspective view.
    pub(crate) fn new(at: &Fragment, radius: f32, view: &View) -> Option<Self> {
        let perspective = view.is_perspective();
        if !at.position.is_finite() || (perspective && at.position.z >= 0.0) {
            return None;
        }
        let away = view.away(at.position);
        let pole = -away - at.tangent * at.tangent.dot(-away);
        // A line along the view: every direction is normal to it but the one to the eye, which
        // shows best.
        let pole = if pole.length() > ALONG_VIEW { pole.normalize() } else { -away };
        let right = (Vec3::X - away * away.x).normalize_or(Vec3::Y);
        Some(Self { middle: at.position, pole, radius, across: [right, right.cross(away)], perspective })
    }

    /// The column through a sample of the disc; `None` where it lies outside of the hemisphere. The
    /// base is raised by `lift`.
    pub(crate) fn prism(&self, sample: Vec2, plane: BasePlane, lift: f32) -> Option<Prism> {
        let start = self.across[0] * sample.x + self.across[1] * sample.y;
        let step = match self.perspective {
            true => {
                let place = self.place(start);
                place / -place.z
            }
            false => Vec3::NEG_Z,
        };
        let (a, b) = (step.length_squared(), step.dot(start));
        let root = b * b - a * (start.length_squared() - 1.0);
        if root.is_nan() || root <= 0.0 {
            return None;
        }
        let (mut from, mut to) = ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a);
        let (height, slope) = (self.pole.dot(start) - lift, self.pole.dot(step));
        if slope.abs() < PARALLEL {
            return (height >= 0.0).then_some(Prism { start, step, from, to });
        }
        let crossing = match plane {
            BasePlane::Tangent => -height / slope,
            BasePlane::ThesisSign => height / slope,
        };
        // The pole may turn away from the viewer in perspective: the column then enters the
        // hemisphere through its base.
        if slope < 0.0 {
            to = to.min(crossing)
        } else {
            from = from.max(crossing)
        }
        (from < to).then_some(Prism { start, step, from, to })
    }

    /// The place in eye space, in units of the scene, of a point that is given from the receiver.
    pub(crate) fn place(&self, from: Vec3) -> Vec3 {
        self.middle + from * self.radius
    }

    /// The range of depths of a prism, in units of the scene.
    pub(crate) fn depths(&self, prism: &Prism) -> [f64; 2] {
        [prism.from, prism.to].map(|t| self.base(prism) + f64::from(t) * f64::from(self.radius))
    }

    /// The depth from which the parameters of a prism are counted, in units of the scene.
    pub(crate) fn base(&self, prism: &Prism) -> f64 {
        -f64::from(self.middle.z) - f64::from(prism.start.z) * f64::from(self.radius)
    }
}

impl Prism {
    /// A point of the column, from the receiver.
    pub(crate) fn at(&self, t: f32) -> Vec3 {
        self.start + self.step * t
    }

    /// The integral of cos(angle to the pole) / (pi distance^2) along the column: with the area
    /// across, the share of all cosine-weighted directions times the way that they have in the
    /// column. The shares of a hemisphere add up to 1.
    pub(crate) fn weight(&self, pole: Vec3) -> f32 {
        // The integral of (g + m t) / (c + 2 b t + a t^2)^(3/2).
        let (g, m) = (pole.dot(self.start), pole.dot(self.step));
        let (a, b, c) = (self.step.length_squared(), self.start.dot(self.step), self.start.length_squared());
        let d = a * c - b * b;
        if d <= f32::MIN_POSITIVE {
            return 0.0;
        }
        let primitive = |t: f32| ((a * g - m * b) * t + b * g - m * c) / (d * self.at(t).length());
        let weight = (primitive(self.to) - primitive(self.from)) * a.sqrt() / std::f32::consts::PI;
        if weight.is_finite() { weight.max(0.0) } else { 0.0 }
    }
}
