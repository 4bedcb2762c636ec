//! What a scene stores of each object.

use crate::geometry::Block;
use crate::object::{ALL_LAYERS, Bounds, Motion, ObjectDesc, Occluder, Placed, Reports};
use crate::scene::opacity::OpacityPart;
use crate::scene::state::{Event, State};
use crate::scene::validity::Validity;
use crate::view::View;

/// One object. What a report of a move asks for comes first, within two lines of the cache.
#[derive(Debug, Clone)]
#[repr(C)]
pub(crate) struct Object {
    pub(super) bounds: Bounds,
    /// The number of the move that last changed it.
    pub(super) moved: u64,
    pub(super) motion: Motion,
    /// Whether its place is unknown, by the state of the mover: queries ask it of each object.
    is_unlocated: bool,
    /// Whether it is in a volume, by the same state.
    is_hidden: bool,
    /// Whether its cells are in I; objects with too many cells are not.
    pub(super) in_cells: bool,
    /// Its shapes in its own space, if it is placed by a transform.
    pub(super) placed: Option<Box<Placed>>,
    /// Of a dynamic object. Apart, so that static ones stay small.
    mover: Option<Box<Mover>>,
    pub(super) layers: u64,
    /// Whether it is listed in a zone instead of cells.
    pub(super) in_zone: bool,
    /// Where the cells of its occluder are, if they are in O.
    pub(super) opacity: Option<OpacityPart>,
    /// The shape that hides others.
    occluder: Option<Occluder>,
    /// An occluder for whose surface there is no room. It hides nothing.
    idle_occluder: Option<Box<Occluder>>,
    pub(super) user_data: u64,
}

/// The parts of an object that only dynamic ones have.
#[derive(Debug, Clone)]
pub(super) struct Mover {
    state: State,
    validity: Validity,
}

impl Object {
    /// A listed object as described, but without its occluder: the scene adds that.
    pub(super) fn new(desc: ObjectDesc, placed: Option<Placed>, moved: u64) -> Self {
        let mover = || Mover { state: State::Listed, validity: Validity::first() };
        Self {
            bounds: desc.bounds,
            occluder: None,
            idle_occluder: None,
            layers: desc.layers,
            opacity: None,
            motion: desc.motion,
            user_data: desc.user_data,
            placed: placed.map(Box::new),
            mover: (desc.motion != Motion::Static).then(|| Box::new(mover())),
            is_unlocated: false,
            is_hidden: false,
            in_cells: false,
            in_zone: false,
            moved,
        }
    }

    /// Whether a query that has its box needs nothing else of it: all views that show anything show
    /// it, and its bounds contain the middle of the box.
    #[inline]
    pub(super) fn is_plain(&self) -> bool {
        self.layers == ALL_LAYERS && self.bounds.kind().is_centered()
    }

    /// A copy of a static object, in no matrix and without its occluder.
    pub(super) fn unlisted(&self) -> Self {
        let mut copy = self.clone();
        copy.set_occluder(None);
        (copy.opacity, copy.in_cells, copy.in_zone) = (None, false, false);
        copy
    }

    /// The bounds as last reported.
    #[inline]
    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The shape that hides others.
    #[inline]
    pub(crate) fn occluder(&self) -> Option<&Occluder> {
        self.occluder.as_ref()
    }

    /// The occluder that the application gave, also if it hides nothing.
    pub(crate) fn given_occluder(&self) -> Option<&Occluder> {
        self.occluder.as_ref().or(self.idle_occluder.as_deref())
    }

    /// Gives it another occluder.
    pub(super) fn set_occluder(&mut self, occluder: Option<Occluder>) {
        (self.occluder, self.idle_occluder) = (occluder, None);
    }

    /// Keeps the occluder, but hides nothing with it.
    pub(super) fn idle(&mut self) {
        self.idle_occluder = self.occluder.take().map(Box::new);
    }

    /// Whether a view shows the layers that it is on.
    #[inline]
    pub(crate) fn is_shown(&self, view: &View) -> bool {
        self.layers & view.layers() != 0
    }

    /// The parts that only a dynamic object has.
    #[inline]
    pub(super) fn mover(&mut self) -> Option<&mut Mover> {
        self.mover.as_deref_mut()
    }

    /// Where it is. Static objects are always listed.
    #[inline]
    pub(super) fn state(&self) -> State {
        self.mover.as_ref().map_or(State::Listed, |mover| mover.state)
    }

    /// For how long its next volume is made to last.
    pub(super) fn validity(&self) -> Validity {
        self.mover.as_ref().map_or(Validity::first(), |mover| mover.validity)
    }

    /// Adapts the validity of its next volume.
    pub(super) fn adapt(&mut self, change: impl FnOnce(&mut Validity)) {
        if let Some(mover) = self.mover() {
            change(&mut mover.validity);
        }
    }

    /// Changes the state as the table of [`crate::scene::state`] says; false if the event does not
    /// apply.
    pub(super) fn apply(&mut self, event: Event) -> bool {
        let next = self.state().after(event);
        if let (Some(mover), Some(next)) = (self.mover.as_deref_mut(), next) {
            self.is_unlocated = matches!(next, State::Overdue | State::Unlocated { .. });
            self.is_hidden = matches!(next, State::Hidden(_));
            mover.state = next;
        }
        next.is_some()
    }

    /// Whether its place is unknown by its state. [`Scene::is_unlocated`](crate::scene::Scene)
    /// also knows those that are overdue in a zone.
    #[inline]
    pub(super) fn is_unlocated(&self) -> bool {
        self.is_unlocated
    }

    #[inline]
    pub(super) fn is_overdue(&self) -> bool {
        self.mover.as_ref().is_some_and(|mover| matches!(mover.state, State::Overdue))
    }

    /// Whether it is in a volume.
    #[inline]
    pub(crate) fn is_hidden(&self) -> bool {
        self.is_hidden
    }

    /// Whether it is in a volume and its bounds are old.
    #[inline]
    pub(crate) fn is_hidden_unreported(&self) -> bool {
        self.on_expiry() && self.is_hidden()
    }

    /// The volume of an object whose bounds are old: it may be anywhere in there.
    #[inline]
    pub(crate) fn unreported_volume(&self) -> Option<&Block> {
        match &self.mover.as_ref()?.state {
            State::Hidden(hidden) if self.on_expiry() => Some(&hidden.tbv.block),
            _ => None,
        }
    }

    /// Bytes on the heap, without those of shapes that objects may share.
    pub(super) fn bytes(&self) -> usize {
        let idle = self.idle_occluder.as_ref().map_or(0, |_| size_of::<Occluder>());
        let placed = self.placed.as_ref().map_or(0, |_| size_of::<Placed>());
        idle + placed + self.mover.as_ref().map_or(0, |_| size_of::<Mover>())
    }

    #[inline]
    pub(crate) fn is_static(&self) -> bool {
        self.motion == Motion::Static
    }

    /// Whether its motion goes unreported while it is hidden.
    #[inline]
    pub(crate) fn on_expiry(&self) -> bool {
        matches!(self.motion, Motion::Dynamic { reports: Reports::OnExpiry, .. })
    }

    /// The promised greatest speed, in world units per second.
    pub(super) fn promised_speed(&self) -> Option<f64> {
        match self.motion {
            Motion::Dynamic { max_speed: Some(v), .. } => Some(f64::from(v)),
            _ => None,
        }
    }
}
