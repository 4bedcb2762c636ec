//! A client as a server knows it, and how it is answered.

use std::collections::BTreeMap;

use casca::glam::DVec3;
use casca::{Aabb, Light, ObjectId, Query, Scene, Sight};
use casca_baked::{Baked, CellBox};
use casca_walls::{Eyes, Span, Walls};

use crate::answer::Answer;
use crate::baked::SeenCells;
use crate::client::ClientDesc;
use crate::entity::{Entity, span_of};
use crate::error::ServerError;
use crate::field::FieldOfView;
use crate::gaze::Gaze;
use crate::hook::Hook;
use crate::id::{ClientId, EntityId};
use crate::numeric::{ROUNDING, STEP};
use crate::options::ServerOptions;

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
    pub(crate) light: Option<Light>,
    pub(crate) hook: &'a H,
}

/// Where an entity may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) bounds: Aabb,
    /// The cells of the baked sets that it has points in, if all is known about them.
    pub(crate) cells: Option<CellBox>,
}

/// A client.
#[derive(Debug, Clone)]
pub(crate) struct ClientState {
    pub(crate) id: ClientId,
    pub(crate) desc: ClientDesc,
    /// When its last report came.
    pub(crate) time: f64,
    /// How the eye moved between the last two reports.
    pub(crate) step: DVec3,
    /// Whether the eye jumped since the last tick.
    pub(crate) jumped: bool,
    /// When it was last looked from its place, as the number of a tick.
    pub(crate) looked: u64,
    gaze: Gaze,
    sun: Option<Box<Query>>,
    casters: Vec<ObjectId>,
    /// Whether those are all.
    knows_casters: bool,
    /// The wall that hid each entity last, by slot.
    hints: Vec<u32>,
    pub(crate) seen_cells: SeenCells,
    /// What it was told of in the tick before.
    before: Vec<EntityId>,
    pub(crate) answer: Answer,
}

impl ClientState {
    pub(crate) fn new(id: ClientId, desc: ClientDesc, time: f64, gaze: Gaze, has_sun: bool) -> Self {
        Self {
            id,
            desc,
            time,
            step: DVec3::ZERO,
            jumped: true,
            looked: 0,
            gaze,
            sun: has_sun.then(|| Box::new(Query::new())),
            casters: Vec::new(),
            knows_casters: true,
            hints: Vec::new(),
            seen_cells: SeenCells::default(),
            before: Vec::new(),
            answer: Answer::new(id),
        }
    }

    /// For how long the eye and all entities may move until the next answer counts, in seconds; and
    /// whether the last report is too old.
    pub(crate) fn time_ahead(&self, now: f64, options: &ServerOptions) -> (f64, bool) {
        let (age, most) = ((now - self.time).max(0.0), f64::from(options.most_age));
        (f64::from(self.desc.latency) + f64::from(options.tick) + age.min(most), age > most)
    }

    /// How far the eye may be from where it was reported, and how much farther a new result
    /// reaches.
    fn reach(&self, now: f64, options: &ServerOptions) -> (f64, f64) {
        let reach = f64::from(self.desc.speed) * self.time_ahead(now, options).0 * (1.0 + ROUNDING);
        (reach, reach * f64::from(options.room))
    }

    /// Whether the level must be looked at again from its place.
    pub(crate) fn waits(&self, now: f64, options: &ServerOptions) -> bool {
        let (reach, room) = self.reach(now, options);
        !self.gaze.holds(self.desc.eye, reach, room)
    }

    /// Looks at the level anew if it is its turn, and lists all that the client is told of.
    pub(crate) fn see<H: Hook + ?Sized>(
        &mut self,
        moment: &Moment<H>,
        turn: bool,
    ) -> Result<(), ServerError> {
        let Moment { now, level, options, .. } = *moment;
        let (time, is_stale) = self.time_ahead(now, options);
        let (reach, room) = self.reach(now, options);
        if turn {
            self.gaze.look(level, self.desc.eye, reach, room, self.step)?;
        }
        let holds = self.gaze.holds(self.desc.eye, reach, room);
        if holds {
            self.gaze.follow(level)?;
        }
        self.find_casters(moment, holds)?;
        std::mem::swap(&mut self.before, &mut self.answer.told);
        let mut told = std::mem::take(&mut self.answer.told);
        told.clear();
        let mut hints = std::mem::take(&mut self.hints);
        let slots = moment.entities.last().map_or(0, |(id, _)| id.slot().index() + 1);
        hints.resize(slots.max(hints.len()), 0);
        let eyes = self.eyes(moment, reach);
        self.seen_cells.follow(moment.baked.as_ref(), eyes.span());
        let look =
            Look { client: self, sight: holds.then(|| self.gaze.query().sight(level)).flatten(), eyes, time };
        let places = moment.places.get(&steps(time)).into_iter().flatten();
        let all = moment.entities.iter().zip(places);
        let all = all.filter(|((id, entity), place)| {
            look.is_told(moment, *id, entity, place, &mut hints[id.slot().index()])
        });
        told.extend(all.map(|((id, _), _)| *id));
        let is_fresh = std::mem::take(&mut self.jumped);
        (self.answer.told, self.hints) = (told, hints);
        let answer = &mut self.answer;
        (answer.reach, answer.is_fresh, answer.is_stale, answer.looked) = (reach, is_fresh, is_stale, turn);
        Ok(())
    }

    /// Where the eye may be.
    fn eyes<H: Hook + ?Sized>(&self, moment: &Moment<H>, reach: f64) -> Eyes {
        let center = self.desc.eye.as_dvec3();
        let span = Span { min: center - reach, max: center + reach };
        Eyes::new(center, reach, moment.walls.reached(&Span { min: center, max: center }, span))
    }

    /// Finds the objects in the scene whose shadows the client may see.
    fn find_casters<H: Hook + ?Sized>(&mut self, moment: &Moment<H>, holds: bool) -> Result<(), ServerError> {
        let (Some(light), Some(sun)) = (&moment.light, &mut self.sun) else { return Ok(()) };
        self.knows_casters = holds;
        if !holds {
            return Ok(());
        }
        self.gaze.look_again(moment.level)?;
        sun.shadow_casters(moment.level, self.gaze.query(), light, &mut self.casters)?;
        self.casters.sort_unstable();
        Ok(())
    }

    /// Finds what changed since the tick before.
    pub(crate) fn compare(&mut self) {
        self.answer.compare(&self.before);
    }
}

/// The number of steps that a time is rounded up to.
pub(crate) fn steps(seconds: f64) -> u64 {
    (seconds / STEP).ceil() as u64
}

/// One look of a client.
struct Look<'a> {
    client: &'a ClientState,
    /// What was found of the level, as far as it holds.
    sight: Option<Sight<'a>>,
    eyes: Eyes,
    /// For how long all may move until the next answer counts, in seconds.
    time: f64,
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
        let ClientState { id: own, desc, casters, knows_casters, .. } = self.client;
        let of_team = desc.team.is_some() && desc.team == entity.side;
        entity.desc.owner == Some(*own)
            || of_team
            || self.may_see(moment, place, hint)
            || entity.caster().is_some_and(|caster| !knows_casters || casters.binary_search(&caster).is_ok())
            || moment.hook.tells((*own, desc), (id, entity))
    }

    /// Whether an eye may see a point of a box until the next answer counts; in doubt, yes.
    fn may_see<H: Hook + ?Sized>(&self, moment: &Moment<H>, place: &Place, hint: &mut u32) -> bool {
        let ClientState { desc: ClientDesc { eye, field, .. }, seen_cells, .. } = self.client;
        let bounds = &place.bounds;
        let in_field = |f: FieldOfView| f.may_see(eye.as_dvec3(), self.eyes.reach(), self.time, bounds);
        field.is_none_or(in_field)
            && moment.baked.is_none_or(|sets| seen_cells.may_see(&sets, place.cells))
            && !moment.walls.hide(&self.eyes, &span_of(bounds), 0.0, hint)
            && self.sight.as_ref().is_none_or(|sight| sight.may_see_box(bounds))
    }
}
