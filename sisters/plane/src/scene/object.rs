//! An object as a scene keeps it.

use crate::geometry::Shape;
use crate::object::{Motion, ObjectDesc, Reports};
use crate::scene::state::{Hidden, Mover, State};

/// An object in its slot.
#[derive(Debug, Clone)]
pub(crate) struct Object {
    pub(crate) bounds: Shape,
    pub(crate) occluder: Option<Shape>,
    pub(crate) motion: Motion,
    pub(crate) user_data: u64,
    /// A bit for each layer that it is on.
    pub(crate) layers: u64,
    /// 1 + its place in the list of objects that are in no cells, or 0.
    pub(super) outer: u32,
    /// Whether the cells inside its occluder are opaque by it.
    pub(super) fills: bool,
    pub(super) mover: Option<Box<Mover>>,
}

impl Object {
    pub(super) fn new(desc: ObjectDesc, now: f64) -> Self {
        let ObjectDesc { bounds, occluder, motion, user_data, layers, .. } = desc;
        let mover = (motion != Motion::Static).then(|| Box::new(Mover::new(now)));
        Self { bounds, occluder, motion, user_data, layers, outer: 0, fills: false, mover }
    }

    /// A shape that surely contains the object now: its bounds, or the volume of an object that
    /// goes unreported.
    pub(crate) fn place(&self) -> &Shape {
        self.hidden().and_then(|hidden| hidden.region.as_ref()).unwrap_or(&self.bounds)
    }

    /// Whether its motion goes unreported while it is hidden.
    pub(crate) fn on_expiry(&self) -> bool {
        matches!(self.motion, Motion::Dynamic { reports: Reports::OnExpiry, .. })
    }

    /// Whether the cells inside its occluder are opaque by it.
    pub(crate) fn fills(&self) -> bool {
        self.fills
    }

    /// Whether it is in a volume.
    pub(crate) fn is_hidden(&self) -> bool {
        self.hidden().is_some()
    }

    /// Whether its place is unknown: it counts as visible and hides nothing.
    pub(crate) fn is_lost(&self) -> bool {
        self.mover.as_ref().is_some_and(|mover| matches!(mover.state, State::Overdue | State::Lost))
    }

    /// Whether it surely is where it was last reported: only then it hides others.
    pub(crate) fn is_certain(&self) -> bool {
        !self.is_lost() && self.hidden().is_none_or(|hidden| hidden.region.is_none())
    }

    pub(super) fn hidden(&self) -> Option<&Hidden> {
        match &self.mover.as_ref()?.state {
            State::Hidden(hidden) => Some(hidden),
            _ => None,
        }
    }

    /// The promised greatest speed, in world units per second.
    pub(super) fn promised_speed(&self) -> Option<f64> {
        match self.motion {
            Motion::Dynamic { max_speed: Some(speed), .. } => Some(f64::from(speed)),
            _ => None,
        }
    }
}
