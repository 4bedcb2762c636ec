//! Objects that move: which rays must be sent again.
//!
//! Only cells that what moved touches or touched are made anew. A state stays if its entry has the
//! same triangles and its starts did not change; a ray of such a state stays if it met neither the
//! old nor the new box of the object, and if what stands for its hit cannot have changed.

use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;

use crate::cache::{Block, Cache, Glow, Links, StartTable};
use crate::direct::Lamps;
use crate::error::LightError;
use crate::input::Object;
use crate::lattice::{Cell, Lattice};
use crate::numeric::{MOVED, MOVED_HITS, MOVED_LINKS, MOVED_STARTS};
use crate::queues::Wish;
use crate::states::{Bundle, DARK, Ray, SKY, Start};
use crate::surfaces::{Skipped, Surface, surfaces};
use crate::tree::within;
use crate::voxels::{NONE, Voxels};

/// What a move cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Moved {
    /// States that stay.
    pub kept: usize,
    /// States that were gathered and are no more, or have other starts.
    pub dropped: usize,
    /// Rays of states that stay.
    pub rays: usize,
    /// Those of them that were sent again.
    pub sent: usize,
    /// States that wait for rays now: gather next.
    pub waiting: usize,
}

/// A box, in cells of the grid.
pub(crate) type Bounds = (DVec3, DVec3);

/// What changed.
pub(crate) enum Change {
    /// Triangles, in these boxes before and after.
    Triangles(Vec<Bounds>),
    /// The size of cells in these boxes.
    Windows(Vec<Bounds>),
}

impl Change {
    fn boxes(&self) -> &[Bounds] {
        let (Self::Triangles(boxes) | Self::Windows(boxes)) = self;
        boxes
    }

    /// The boxes that rays may meet.
    fn solid(&self) -> &[Bounds] {
        match self {
            Self::Triangles(boxes) => boxes,
            Self::Windows(_) => &[],
        }
    }
}

/// The boxes of some objects' triangles, whose numbers are sorted. O(triangles log objects).
fn bounds_of(surfaces: &[Surface], objects: &[u32]) -> Vec<Bounds> {
    let mut boxes: Vec<Option<Bounds>> = vec![None; objects.len()];
    for s in surfaces {
        let Ok(at) = objects.binary_search(&s.object) else { continue };
        for p in s.corners {
            boxes[at] = Some(boxes[at].map_or((p, p), |(l, h)| (l.min(p), h.max(p))));
        }
    }
    boxes.into_iter().flatten().collect()
}

/// Whether a point is nearer to a box than so many cells, of which so many are along an edge of one
/// of the grid.
fn is_near(boxes: &[Bounds], p: DVec3, cells: f64, fine: f64) -> bool {
    let margin = cells / fine + MOVED;
    boxes.iter().any(|(l, h)| p.cmpge(*l - margin).all() && p.cmple(*h + margin).all())
}

/// Whether a cell comes nearer to a box than a margin in cells of its size.
fn is_cell_near(boxes: &[Bounds], lattice: &Lattice, cell: Cell, margin: f64) -> bool {
    let fine = lattice.fine(cell);
    is_near(boxes, (cell.at.as_dvec3() + 0.5) / fine, margin + 0.5, fine)
}

impl Cache {
    /// Replaces the triangles of objects, by their numbers, wherever they go: of all that move in a
    /// frame at once, since cells are copied once. Of two with one number the last counts. Rays that
    /// can have changed are sent again; light stays, and passes bring it up to date. Call
    /// [`Cache::gather`], [`Cache::direct`] and passes next.
    ///
    /// The states then have the same rays as those of a cache that is made anew. Costs a copy of
    /// the cells, making those anew that the objects touch and touched, a look at each stored ray,
    /// and the rays that are sent; for an object that moves for the first time, also the tree of
    /// all triangles.
    ///
    /// # Errors
    /// If there is no such object, a triangle names no material, or the triangles touch too many
    /// cells; then nothing changes.
    pub fn set_objects(&mut self, new: Vec<(usize, Object)>) -> Result<Moved, LightError> {
        let count = self.objects.len();
        for (object, new) in &new {
            if *object >= count {
                let of = "a change".to_owned();
                return Err(LightError::Missing { of, what: "object", number: *object, count });
            }
            new.check(*object, self.materials.len())?;
        }
        let mut objects = self.objects.clone();
        let mut changed = Vec::new();
        for (object, new) in new {
            objects[object] = new;
            changed.push(object as u32);
        }
        changed.sort_unstable();
        changed.dedup();
        let mut skipped = Skipped::default();
        let all = surfaces(&objects, (&self.materials, &self.textures), &self.voxels.lattice, &mut skipped);
        let voxels = self.voxels.moved(all, &changed)?;
        self.objects = objects;
        self.skipped = skipped;
        self.lamps = Lamps::new(&voxels, &self.materials);
        let boxes = [bounds_of(&self.voxels.surfaces, &changed), bounds_of(&voxels.surfaces, &changed)];
        Ok(self.replace(voxels, &Change::Triangles(boxes.concat())))
    }

    /// Takes over other cells, in which only so much changed.
    pub(crate) fn replace(&mut self, voxels: Voxels, change: &Change) -> Moved {
        let map = self.map_states(&voxels, change);
        let boxes = change.boxes();
        let states = voxels.states() as usize;
        let old = std::mem::replace(&mut self.voxels, voxels);
        let old_blocks = std::mem::replace(&mut self.blocks, vec![Block::default(); states]);
        let old_glow = std::mem::replace(&mut self.glow, vec![Glow::default(); states]);
        let old_rays = std::mem::take(&mut self.rays);
        let old_gathered = std::mem::take(&mut self.gathered);
        let old_waiting = std::mem::take(&mut self.waiting);
        self.waiting = old_waiting.renewed(states);
        let old_links = std::mem::replace(&mut self.links, vec![None; states]);
        self.smoothed.clear();
        let mut moved = Moved::default();
        for &state in &old_gathered {
            let Some(new) = known(map.states[state as usize]) else {
                moved.dropped += 1;
                continue;
            };
            let block = old_blocks[state as usize];
            let first = self.rays.len() as u32;
            self.rays.extend(&old_rays[block.range()]);
            self.blocks[new as usize] = Block { first, count: block.count };
            self.glow[new as usize] = old_glow[state as usize];
            self.links[new as usize] =
                old_links[state as usize].and_then(|l| self.kept_links(new, l, &map.states, boxes));
            self.gathered.push(new);
        }
        self.gathered.sort_unstable();
        self.inherit(&map, &old, &old_glow);
        moved.kept = self.gathered.len();
        // A state that lost its starts is gathered anew, if it is still there.
        let old_gathered = old_gathered.iter().map(|s| (*s, Wish::Asked));
        for (state, wish) in old_gathered.chain(old_waiting.all()) {
            if let Some(new) = known(map.entries[state as usize]) {
                self.want(new, wish);
            }
        }
        // Balls around boxes and all hits that count as near to them.
        let ball = |(low, high): &Bounds| {
            (0.5 * (*low + *high), 0.5 * (*high - *low + 2.0 * (MOVED_HITS + MOVED)).length())
        };
        let balls: Vec<(DVec3, f64)> = map.near.iter().map(ball).collect();
        let of = |state: &u32| self.mended(*state, &map, change, &balls);
        let mended: Vec<_> = self.gathered.par_iter().map(of).collect();
        for (i, (rays, sent)) in mended.into_iter().enumerate() {
            moved.sent += sent;
            let state = self.gathered[i];
            self.rays[self.blocks[state as usize].range()].copy_from_slice(&rays);
            rays.iter().filter(|r| r.target < DARK).for_each(|ray| self.want(ray.target, Wish::Hit));
            self.sum_sky(state);
        }
        moved.rays = self.rays.len();
        // What new surfaces hide or show is read by rays; new surfaces themselves may be asked for.
        drop(old);
        moved.waiting = self.waiting.count();
        self.unlit = self.unlit.renumbered(|s| known(map.states[s as usize]));
        self.unlit.add_all(&self.gathered, states);
        moved
    }

    /// Lets states of entries that are new, or have other starts, send the light of the nearest old
    /// state that faces like them on the same object, if the way between both is free of what stood
    /// there or of what stands there: what moves would be dark until its turn.
    fn inherit(&mut self, map: &StateMap, old: &Voxels, glow: &[Glow]) {
        let object = |voxels: &Voxels, e: u32| voxels.surfaces[voxels.members_of(e)[0] as usize].object;
        let nearest = |number: u32| {
            let entry = self.voxels.entries[number as usize];
            let own = object(&self.voxels, number);
            let is_like = |e: &u32| old.entries[*e as usize].bin == entry.bin && object(old, *e) == own;
            let far = |e: &u32| old.entries[*e as usize].middle.distance_squared(entry.middle);
            let cells = old.lattice.all_at(entry.middle.as_dvec3()).flat_map(|c| old.lattice.around(c));
            let near = cells.flat_map(|c| old.entries_of(c)).filter(is_like);
            near.min_by(|a, b| far(a).total_cmp(&far(b)))
        };
        let before = |state: u32| match known(map.states[state as usize]) {
            Some(kept) => self.starts(kept),
            None => map.starts.of(old, state),
        };
        let heir = |&state: &u32| {
            let from = 2 * nearest(state / 2)? + state % 2;
            if self.blocks[state as usize].count > 0 || glow[from as usize] == Glow::default() {
                return None;
            }
            let to = self.starts(state).first()?.at.as_dvec3();
            let is_free = |s: &Start| [old, &self.voxels].iter().any(|v| v.free(s.at.as_dvec3(), to));
            before(from).iter().any(is_free).then_some((state, glow[from as usize]))
        };
        let states: Vec<u32> = map.fresh.iter().flat_map(|entry| [2 * entry, 2 * entry + 1]).collect();
        let heirs: Vec<_> = states.par_iter().filter_map(heir).collect();
        for (state, glow) in heirs {
            self.glow[state as usize] = glow;
            self.send(state);
        }
    }

    /// The links of a kept state by new numbers, if they cannot have changed. Those that gathering
    /// changes are dropped then.
    fn kept_links(&self, state: u32, links: Links, map: &[u32], boxes: &[Bounds]) -> Option<Links> {
        let cell = self.voxels.lattice.place(self.voxels.entries[state as usize / 2].cell);
        if is_cell_near(boxes, &self.voxels.lattice, cell, MOVED_LINKS) {
            return None;
        }
        let mut kept = links;
        for link in kept.iter_mut().take_while(|l| **l != NONE) {
            *link = known(map[*link as usize])?;
        }
        Some(kept)
    }

    /// The rays of a kept state, of which those were sent again that can have changed, and how many
    /// these are.
    fn mended(
        &self,
        state: u32,
        map: &StateMap,
        change: &Change,
        balls: &[(DVec3, f64)],
    ) -> (Vec<Ray>, usize) {
        let (boxes, solid) = (&map.near[..], change.solid());
        let block = self.blocks[state as usize];
        let mut rays = self.rays[block.range()].to_vec();
        let starts = self.starts(state);
        if starts.is_empty() {
            return (rays, 0);
        }
        let bundle = Bundle::new(starts, block.count, self.voxels.key(state));
        let towards = bundle.towards(balls);
        let mut sent = 0;
        for (i, ray) in (0..).zip(&mut rays) {
            let target = if ray.target < DARK { map.states[ray.target as usize] } else { ray.target };
            let is_lost = ray.target < DARK && target == NONE;
            // Most rays pass what changed, and their directions need not be known.
            if !is_lost && !towards[i as usize % starts.len()].iter().any(|range| range.contains(&i)) {
                ray.target = target;
                continue;
            }
            let (start, direction) = bundle.ray(i);
            let from = start.at.as_dvec3();
            let length = ray.distance();
            let meets = |(l, h): &Bounds| {
                within(from, direction, *l - MOVED, *h + MOVED).is_some_and(|(t, _)| t <= length + MOVED)
            };
            let end = from + direction * length;
            // Most hits are far from all, also in cells of the grid.
            let is_read_anew = ray.target != SKY
                && is_near(boxes, end, MOVED_HITS, 1.0)
                && (solid.is_empty() || {
                    let boxes = if ray.is_own() { solid } else { boxes };
                    is_near(boxes, end, MOVED_HITS, self.voxels.lattice.coarsest_around(end))
                });
            ray.target = target;
            if is_lost || is_read_anew || solid.iter().any(meets) {
                *ray = self.voxels.trace(start, direction, &|s| self.starts(s));
                sent += 1;
            }
        }
        (rays, sent)
    }

    /// Which old state is which new one, and takes over the starts that stay.
    fn map_states(&mut self, new: &Voxels, change: &Change) -> StateMap {
        let solid = change.solid();
        let old = &self.voxels;
        let mut map = StateMap {
            states: vec![NONE; old.states() as usize],
            entries: vec![NONE; old.states() as usize],
            fresh: Vec::new(),
            near: change.boxes().to_vec(),
            starts: StartTable::default(),
        };
        let mut table = StartTable::new(new.states());
        // States near what moved: old and new numbers, and starts that may be others now.
        let mut doubtful: Vec<(u32, u32, Box<[Start]>)> = Vec::new();
        for (i, entry) in (0..).zip(&new.entries) {
            let cell = new.lattice.place(entry.cell);
            let before = old.entries_of(cell);
            let twin = before.start + u32::from(entry.rank);
            if twin >= before.end || !is_same(old, twin, new, i) {
                map.fresh.push(i);
                continue;
            }
            let is_close = is_cell_near(solid, &new.lattice, cell, MOVED_STARTS);
            for side in 0..2 {
                let (from, to) = (2 * twin + side, 2 * i + side);
                map.entries[from as usize] = to;
                let Some(starts) = self.starts.0[from as usize].take() else {
                    // Not asked for, so that no ray read it.
                    map.states[from as usize] = to;
                    continue;
                };
                if is_close {
                    doubtful.push((from, to, starts));
                } else {
                    map.states[from as usize] = to;
                    table.0[to as usize] = OnceLock::from(starts);
                }
            }
        }
        let is_kept = |(_, to, starts): &(u32, u32, Box<[Start]>)| new.starts(*to)[..] == starts[..];
        let kept: Vec<_> = doubtful.par_iter().map(is_kept).collect();
        for ((from, to, starts), is_kept) in doubtful.into_iter().zip(kept) {
            let entry = to / 2;
            if is_kept {
                map.states[from as usize] = to;
                table.0[to as usize] = OnceLock::from(starts);
            } else if map.fresh.last() != Some(&entry) {
                map.fresh.push(entry);
                map.stretch(solid, &new.lattice, new.lattice.place(new.entries[entry as usize].cell));
            }
        }
        map.starts = std::mem::replace(&mut self.starts, table);
        map
    }
}

/// Old states as new ones, or [`NONE`]; and which entries are new.
struct StateMap {
    /// Those with the same starts.
    states: Vec<u32>,
    /// Those of the same entry, whatever its starts.
    entries: Vec<u32>,
    /// New entries that are no old ones, or have other starts.
    fresh: Vec<u32>,
    /// The boxes of what changed, stretched over the cells of entries with other starts.
    near: Vec<Bounds>,
    /// Those of old states that did not stay.
    starts: StartTable,
}

impl StateMap {
    /// Stretches the boxes that changed the starts of an entry over its cell.
    fn stretch(&mut self, solid: &[Bounds], lattice: &Lattice, cell: Cell) {
        let low = cell.at.as_dvec3() / lattice.fine(cell);
        let high = (cell.at + 1).as_dvec3() / lattice.fine(cell);
        for (bounds, near) in solid.iter().zip(&mut self.near) {
            if is_cell_near(&[*bounds], lattice, cell, MOVED_STARTS) {
                *near = (near.0.min(low), near.1.max(high));
            }
        }
    }
}

fn known(state: u32) -> Option<u32> {
    (state != NONE).then_some(state)
}

/// Whether two entries of a cell are of the same triangles.
fn is_same(old: &Voxels, twin: u32, new: &Voxels, entry: u32) -> bool {
    let (a, b) = (&old.entries[twin as usize], &new.entries[entry as usize]);
    let [of_a, of_b] = [old.members_of(twin), new.members_of(entry)];
    let same = |(x, y): (&u32, &u32)| old.surfaces[*x as usize].is_same(&new.surfaces[*y as usize]);
    a.bin == b.bin && of_a.len() == of_b.len() && of_a.iter().zip(of_b).all(same)
}
