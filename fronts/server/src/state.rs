//! A client in space: what its eye may see, and the answer to it.

use std::collections::BTreeMap;

use casca::glam::DVec3;
use casca::{Aabb, Scene, Sight};
use casca_baked::{Baked, CellBox};
use casca_walls::{Eyes, Span, Walls};

use crate::baked::SeenCells;
use crate::client::ClientDesc;
use crate::entity::span_of;
use crate::error::ServerError;
use crate::gaze::Gaze;
use crate::hook::Hook;
use crate::id::EntityId;
use crate::numeric::ROUNDING;
use crate::options::ServerOptions;
use crate::roster::{Client, Entity, steps};

/// What all clients share in a tick.
pub(crate) struct Moment<'a, H: ?Sized> {
    pub(crate) now: f64,
    pub(crate) level: &'a Scene,
    pub(crate) walls: &'a Walls,
    pub(crate) options: &'a ServerOptions,
    pub(crate) entities: &'a [(EntityId, &'a Entity)],
    /// Where each of these entities may be, by the time that it may move for.
    pub(crate) places: &'a BTreeMap<u64, Vec<Place>>,
    /// Sets from cell to cell, if there are some and they count.
    pub(crate) baked: Option<Baked<'a>>,
    pub(crate) hook: &'a H,
}

/// Where an entity may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) bounds: Aabb,
    /// The cells of the baked sets that it has points in, if all is known about them.
    pub(crate) cells: Option<CellBox>,
}

/// What a server keeps about the eye of a client from tick to tick.
#[derive(Debug, Clone)]
pub(crate) struct Eye {
    /// How it moved between the last two reports.
    pub(crate) step: DVec3,
    /// When it was last looked from its place, as the number of a tick.
    pub(crate) looked: u64,
    gaze: Gaze,
    /// The wall that hid each entity last, by slot.
    hints: Vec<u32>,
    pub(crate) seen_cells: SeenCells,
}

impl Eye {
    pub(crate) fn new(gaze: Gaze) -> Self {
        Self { step: DVec3::ZERO, looked: 0, gaze, hints: Vec::new(), seen_cells: SeenCells::default() }
    }
}

/// A client.
pub(crate) type ClientState = Client<ClientDesc, Eye>;

impl ClientState {
    /// How far the eye may be from where it was reported, and how much farther a new result
    /// reaches.
    fn reach(&self, now: f64, options: &ServerOptions) -> (f64, f64) {
        let (seconds, _) = self.time_ahead(now, options.tick, options.most_age);
        let reach = f64::from(self.desc.speed) * seconds * (1.0 + ROUNDING);
        (reach, reach * f64::from(options.room))
    }

    /// Whether the level must be looked at again from its place.
    pub(crate) fn waits(&self, now: f64, options: &ServerOptions) -> bool {
        let (reach, room) = self.reach(now, options);
        !self.own.gaze.holds(self.desc.eye, reach, room)
    }

    /// Looks at the level anew if it is its turn, and lists all that the client is told of.
    pub(crate) fn see<H: Hook + ?Sized>(
        &mut self,
        moment: &Moment<H>,
        turn: bool,
    ) -> Result<(), ServerError> {
        let Moment { now, level, options, .. } = *moment;
        let (time, is_stale) = self.time_ahead(now, options.tick, options.most_age);
        let (reach, room) = self.reach(now, options);
        let eye = self.desc.eye;
        if turn {
            self.own.gaze.look(level, eye, reach, room, self.own.step)?;
        }
        let holds = self.own.gaze.holds(eye, reach, room);
        if holds {
            self.own.gaze.follow(level)?;
        }
        let mut hints = std::mem::take(&mut self.own.hints);
        let slots = moment.entities.last().map_or(0, |(id, _)| id.slot().index() + 1);
        hints.resize(slots.max(hints.len()), 0);
        let eyes = self.eyes(moment, reach);
        self.own.seen_cells.follow(moment.baked.as_ref(), eyes.span());
        let sight = holds.then(|| self.own.gaze.query().sight(level)).flatten();
        let look = Look { client: self, sight, eyes };
        let places = moment.places.get(&steps(time)).into_iter().flatten();
        let all = moment.entities.iter().zip(places).filter(|((id, entity), place)| {
            look.is_told(moment, *id, entity, place, &mut hints[id.slot().index()])
        });
        let told = all.map(|((id, _), _)| *id).collect();
        self.own.hints = hints;
        self.tell(told, reach, is_stale);
        self.answer.looked = turn;
        Ok(())
    }

    /// Where the eye may be.
    fn eyes<H: Hook + ?Sized>(&self, moment: &Moment<H>, reach: f64) -> Eyes {
        let center = self.desc.eye.as_dvec3();
        let span = Span { min: center - reach, max: center + reach };
        Eyes::new(center, reach, moment.walls.reached(&Span { min: center, max: center }, span))
    }
}

/// One look of a client.
struct Look<'a> {
    client: &'a ClientState,
    /// What was found of the level, as far as it holds.
    sight: Option<Sight<'a>>,
    eyes: Eyes,
}

impl Look<'_> {
    fn is_told<H: Hook + ?Sized>(
        &self,
        moment: &Moment<H>,
        id: EntityId,
        entity: &Entity,
        place: &Place,
        hint: &mut u32,
    ) -> bool {
        let (own, desc) = (self.client.answer.client, &self.client.desc);
        let of_team = desc.team.is_some() && desc.team == entity.side;
        entity.desc.owner == Some(own)
            || of_team
            || self.may_see(moment, place, hint)
            || moment.hook.tells((own, desc), (id, entity))
    }

    /// Whether an eye may see a point of a box until the next answer counts; in doubt, yes.
    fn may_see<H: Hook + ?Sized>(&self, moment: &Moment<H>, place: &Place, hint: &mut u32) -> bool {
        moment.baked.is_none_or(|sets| self.client.own.seen_cells.may_see(&sets, place.cells))
            && !moment.walls.hide(&self.eyes, &span_of(&place.bounds), 0.0, hint)
            && self.sight.as_ref().is_none_or(|sight| sight.may_see_box(&place.bounds))
    }
}
