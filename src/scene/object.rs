//! What a scene stores of each object.

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::object::{ALL_LAYERS, Bounds, Motion, ObjectDesc, Occluder, Placed, Reports};
use crate::scene::home::{Hidden, Validity};
use crate::scene::opacity::OpacityPart;
use crate::view::View;

/// One object. What a report of a move asks for comes first, within two lines of the cache.
#[derive(Debug, Clone)]
#[repr(C)]
pub(crate) struct Object {
    pub(super) bounds: Bounds,
    /// The number of the move that last changed it.
    pub(super) moved: u64,
    is_static: bool,
    on_expiry: bool,
    /// Whether it is in a volume whose time is not over: queries ask it of each object.
    is_hidden: bool,
    /// Whether it is in one whose time is over.
    is_expired: bool,
    is_placed: bool,
    /// Whether its cells are in I; objects with too many cells are not.
    pub(super) in_cells: bool,
    /// Whether it is listed in a zone instead of cells.
    pub(super) in_zone: bool,
    /// Where the cells of its occluder are, if they are in O.
    pub(super) opacity: Option<OpacityPart>,
    /// What few static objects have, apart, so that the others stay small.
    rare: Option<Box<Rare>>,
    pub(super) layers: u64,
    /// The shape that hides others.
    occluder: Option<Occluder>,
}

/// A static object takes 194 bytes with its box and its places in the grid.
const _: () = assert!(size_of::<Object>() <= 128, "objects are small");

/// The parts of an object that few static ones have.
#[derive(Debug, Clone)]
enum Rare {
    Static {
        /// Its shapes in its own space, if it is placed by a transform.
        placed: Option<Placed>,
        idle: Option<Box<Occluder>>,
    },
    Dynamic {
        mover: Mover,
        placed: Option<Box<Placed>>,
        /// An occluder for whose surface there is no room. It hides nothing.
        idle: Option<Box<Occluder>>,
    },
}

/// The parts of an object that only dynamic ones have.
#[derive(Debug, Clone)]
pub(super) struct Mover {
    motion: Motion,
    /// None while it is listed.
    volume: Option<Hidden>,
    validity: Validity,
    /// Those that list it, while it is listed in bricks.
    bricks: CellBox,
}

impl Rare {
    const NONE: Self = Self::Static { placed: None, idle: None };

    fn placed(&self) -> Option<&Placed> {
        match self {
            Self::Static { placed, .. } => placed.as_ref(),
            Self::Dynamic { placed, .. } => placed.as_deref(),
        }
    }

    fn idle(&self) -> Option<&Occluder> {
        let (Self::Static { idle, .. } | Self::Dynamic { idle, .. }) = self;
        idle.as_deref()
    }

    fn mover(&self) -> Option<&Mover> {
        match self {
            Self::Static { .. } => None,
            Self::Dynamic { mover, .. } => Some(mover),
        }
    }

    /// Bytes on the heap, without those of shapes that objects may share.
    fn bytes(&self) -> usize {
        let placed = matches!(self, Self::Dynamic { placed: Some(_), .. });
        let idle = self.idle().map_or(0, |_| size_of::<Occluder>());
        size_of::<Self>() + idle + if placed { size_of::<Placed>() } else { 0 }
    }
}

impl Object {
    /// A listed object as described, but without its occluder and its number for the application:
    /// the scene adds those.
    pub(super) fn new(desc: ObjectDesc, placed: Option<Placed>, moved: u64) -> Self {
        let motion = desc.motion;
        let is_static = motion == Motion::Static;
        let mover = Mover { motion, volume: None, validity: Validity::first(), bricks: CellBox::default() };
        let mut object = Self {
            bounds: desc.bounds,
            moved,
            is_static,
            on_expiry: matches!(motion, Motion::Dynamic { reports: Reports::OnExpiry, .. }),
            is_hidden: false,
            is_expired: false,
            is_placed: false,
            in_cells: false,
            in_zone: false,
            opacity: None,
            rare: (!is_static).then(|| Box::new(Rare::Dynamic { mover, placed: None, idle: None })),
            layers: desc.layers,
            occluder: None,
        };
        object.set_placed(placed);
        object
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

    /// The number of the move that last changed it.
    #[inline]
    pub(crate) fn last_move(&self) -> u64 {
        self.moved
    }

    /// Whether queries find it by the cells that it touches.
    #[inline]
    pub(crate) fn in_cells(&self) -> bool {
        self.in_cells
    }

    /// The bounds as last reported.
    #[inline]
    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Gives it other bounds, and tells whether they are others than before, for certain only if
    /// they are a sphere or a box as before.
    #[inline]
    pub(super) fn replace_bounds(&mut self, new: &Bounds) -> bool {
        match (&mut self.bounds, new) {
            (Bounds::Sphere(old), Bounds::Sphere(new)) => std::mem::replace(old, *new) != *new,
            (Bounds::Box(old), Bounds::Box(new)) => std::mem::replace(old, *new) != *new,
            (bounds, _) => {
                *bounds = new.clone();
                true
            }
        }
    }

    /// The shape that hides others.
    #[inline]
    pub(crate) fn occluder(&self) -> Option<&Occluder> {
        self.occluder.as_ref()
    }

    /// The occluder that the application gave, also if it hides nothing.
    pub(crate) fn given_occluder(&self) -> Option<&Occluder> {
        self.occluder.as_ref().or_else(|| self.rare.as_ref()?.idle())
    }

    /// Gives it another occluder.
    pub(super) fn set_occluder(&mut self, occluder: Option<Occluder>) {
        self.occluder = occluder;
        self.set_idle(None);
    }

    /// Whether positions of an occluder's triangles are shared with other objects: those that are
    /// drawn where they are.
    pub(super) fn shares_positions(&self, occluder: &Occluder) -> bool {
        self.is_static() && occluder.placement().is_none()
    }

    /// Whether it keeps the numbers of its patches with another occluder.
    pub(super) fn keeps_surface(&self, occluder: Option<&Occluder>) -> bool {
        let drawn = |o: Option<&Occluder>| {
            o.and_then(|o| Some((std::ptr::from_ref(o.surface()?), self.shares_positions(o))))
        };
        drawn(self.occluder()) == drawn(occluder)
    }

    /// Keeps the occluder, but hides nothing with it.
    pub(super) fn idle(&mut self) {
        let occluder = self.occluder.take();
        self.set_idle(occluder);
    }

    fn set_idle(&mut self, occluder: Option<Occluder>) {
        if self.rare.is_none() && occluder.is_none() {
            return;
        }
        let rare = self.rare.get_or_insert_with(|| Box::new(Rare::NONE));
        let (Rare::Static { idle, .. } | Rare::Dynamic { idle, .. }) = &mut **rare;
        *idle = occluder.map(Box::new);
        self.drop_empty();
    }

    /// Gives back the memory of a static object that has nothing rare any more.
    fn drop_empty(&mut self) {
        if matches!(self.rare.as_deref(), Some(Rare::Static { placed: None, idle: None })) {
            self.rare = None;
        }
    }

    /// Whether it is placed by a transform.
    #[inline]
    pub(super) fn is_placed(&self) -> bool {
        self.is_placed
    }

    /// Its shapes in its own space, if it is placed by a transform.
    pub(super) fn placed(&self) -> Option<&Placed> {
        self.rare.as_ref()?.placed()
    }

    /// As [`Object::placed`], to change them.
    pub(super) fn placed_mut(&mut self) -> Option<&mut Placed> {
        match self.rare.as_deref_mut()? {
            Rare::Static { placed, .. } => placed.as_mut(),
            Rare::Dynamic { placed, .. } => placed.as_deref_mut(),
        }
    }

    /// Places it by a transform, or no longer.
    pub(super) fn set_placed(&mut self, shapes: Option<Placed>) {
        if !self.is_placed && shapes.is_none() {
            return;
        }
        self.is_placed = shapes.is_some();
        match &mut **self.rare.get_or_insert_with(|| Box::new(Rare::NONE)) {
            Rare::Static { placed, .. } => *placed = shapes,
            Rare::Dynamic { placed, .. } => *placed = shapes.map(Box::new),
        }
        self.drop_empty();
    }

    /// Whether it moves, and how.
    pub(super) fn motion(&self) -> Motion {
        self.mover().map_or(Motion::Static, |mover| mover.motion)
    }

    /// Whether a view shows the layers that it is on.
    #[inline]
    pub(crate) fn is_shown(&self, view: &View) -> bool {
        self.layers & view.layers() != 0
    }

    /// The parts that only a dynamic object has.
    #[inline]
    fn mover(&self) -> Option<&Mover> {
        self.rare.as_ref()?.mover()
    }

    #[inline]
    fn mover_mut(&mut self) -> Option<&mut Mover> {
        match self.rare.as_deref_mut()? {
            Rare::Static { .. } => None,
            Rare::Dynamic { mover, .. } => Some(mover),
        }
    }

    /// The volume that it is in, or was in before that expired; none if it is listed.
    #[inline]
    pub(super) fn volume(&self) -> Option<&Hidden> {
        self.mover()?.volume.as_ref()
    }

    /// Puts a mover into a volume whose time is not over, or into none.
    pub(super) fn set_volume(&mut self, volume: Option<Hidden>) {
        if let Some(mover) = self.mover_mut() {
            mover.volume = volume;
            (self.is_hidden, self.is_expired) = (volume.is_some(), false);
        }
    }

    /// The bricks that list a mover, if it is listed in bricks.
    pub(super) fn bricks(&self) -> CellBox {
        self.mover().map_or(CellBox::default(), |mover| mover.bricks)
    }

    /// A mover is listed in bricks from now on.
    pub(super) fn set_bricks(&mut self, bricks: CellBox) {
        if let Some(mover) = self.mover_mut() {
            mover.bricks = bricks;
        }
    }

    /// The time of its volume is over.
    pub(super) fn expire(&mut self) {
        (self.is_hidden, self.is_expired) = (false, true);
    }

    /// For how long its next volume is made to last.
    pub(super) fn validity(&self) -> Validity {
        self.mover().map_or(Validity::first(), |mover| mover.validity)
    }

    /// Adapts the validity of its next volume.
    pub(super) fn adapt(&mut self, change: impl FnOnce(&mut Validity)) {
        if let Some(mover) = self.mover_mut() {
            change(&mut mover.validity);
        }
    }

    /// Whether it is in a volume whose time is over.
    #[inline]
    pub(super) fn is_expired(&self) -> bool {
        self.is_expired
    }

    /// Whether it is in a volume whose time is not over.
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
        if self.is_hidden_unreported() { self.volume().map(|hidden| &hidden.tbv.block) } else { None }
    }

    /// Bytes on the heap, without those of shapes that objects may share.
    pub(super) fn bytes(&self) -> usize {
        self.rare.as_ref().map_or(0, |rare| rare.bytes())
    }

    #[inline]
    pub(crate) fn is_static(&self) -> bool {
        self.is_static
    }

    /// Whether its motion goes unreported while it is hidden.
    #[inline]
    pub(crate) fn on_expiry(&self) -> bool {
        self.on_expiry
    }

    /// The promised greatest speed, in world units per second.
    pub(super) fn promised_speed(&self) -> Option<f64> {
        match self.motion() {
            Motion::Dynamic { max_speed: Some(v), .. } => Some(f64::from(v)),
            _ => None,
        }
    }
}
