//! Kept patches drawn once more into a group of 4x4 pixels, each divided into 8x8 finer ones.
//!
//! The edges are those of the first pass, scaled; their errors scale alike. Only those that come
//! near the group are drawn; of those left of it the rows are kept that they pass, and all others
//! change nothing. So patches are joined along the sides only that come near: the sides of a set of
//! patches that no two of them share may be open wherever they are drawn.

use crate::numeric::occlusion::below;
use crate::numeric::{greater, lesser};
use crate::occlusion::coverage::Coverage;
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::surface::components::farness;
use crate::occlusion::surface::kept::{Kept, KeptPatches};
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::{
    Area, Edges, LANES, Lanes, Passed, Raster, SQUARE, SquareMarks, TileWords, each,
};
use crate::occlusion::surface::scratch::Ids;
use crate::occlusion::surface::sides::{NO_TWIN, Sides, WholeSide};
use crate::occlusion::tiles::TILE;

/// How many times finer.
pub(crate) const FINER: i64 = TILE;

/// Pixels along each side of a group. Larger groups need fewer drawings, and fill more pixels that
/// no target asks for.
pub(crate) const GROUP: i64 = 4;

/// Tiles of finer pixels in a group.
pub(crate) const GROUP_TILES: usize = (GROUP * GROUP) as usize;

const _: () = assert!(GROUP * FINER == SQUARE as i64, "a group fills a square of the rasteriser");

/// A group of pixels.
pub(crate) struct Spot<'a> {
    pub(crate) projector: Projector<'a>,
    pub(crate) window: &'a Window,
    /// Its first pixel.
    pub(crate) at: (i64, i64),
    /// Its pixels that lie in the window.
    pub(crate) pixels: PixelRect,
    /// Tiles of finer pixels, one for each pixel, and the first of those of the group.
    pub(crate) coverage: &'a mut Coverage,
    pub(crate) tiles: usize,
}

/// A patch that may be drawn into a group.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Listing {
    /// Its number in the order of first drawing.
    pub(crate) id: u32,
    /// No point of it is nearer.
    pub(crate) near: f32,
    /// The pixels that it may touch.
    pub(crate) pixels: PixelRect,
}

/// Where patches are kept: those that the first pass drew, and those that were too narrow for it.
#[derive(Clone, Copy)]
pub(crate) struct Stores<'a> {
    pub(crate) ids: &'a Ids,
    pub(crate) drawn: &'a KeptPatches,
    pub(crate) late: &'a KeptPatches,
}

impl<'a> Stores<'a> {
    /// Whether a patch was too narrow, and its place among those that are kept.
    #[inline]
    fn find(&self, id: u32) -> Option<(bool, u32)> {
        let late = || Some((true, self.late.find(id)?));
        self.drawn.find(id).map(|place| (false, place)).or_else(late)
    }

    /// How many sides a patch has.
    pub(crate) fn side_count(&self, id: u32) -> Option<u32> {
        self.find(id).map(|(is_late, place)| self.store(is_late).patch(place).side_count)
    }

    fn patch(&self, member: &Member) -> &'a Kept {
        self.store(member.is_late).patch(member.place)
    }

    fn groups(&self, member: &Member) -> &'a [Sides] {
        self.store(member.is_late).groups(member.place)
    }

    #[inline]
    fn store(&self, is_late: bool) -> &'a KeptPatches {
        if is_late { self.late } else { self.drawn }
    }
}

/// A patch that is drawn into the group.
#[derive(Debug, Clone)]
struct Member {
    id: u32,
    /// Where it is kept.
    is_late: bool,
    place: u32,
    near: f32,
    /// The index of another patch of its component, or its own.
    parent: u32,
    /// For the root of a component, no point of the component is nearer.
    nearest: f32,
    /// The pixels of the group that it may touch.
    pixels: PixelRect,
    /// The first of its groups of sides in the list of choices.
    first: u32,
    /// The edges left of the group.
    passed: Passed,
}

/// Those of eight sides that come near the group, and the seams among them, one bit each.
#[derive(Debug, Default, Clone, Copy)]
struct Choice {
    near: u8,
    seams: u8,
}

/// Memory for drawing into groups.
#[derive(Debug, Default, Clone)]
pub(crate) struct Local {
    members: Vec<Member>,
    choices: Vec<Choice>,
    /// For each patch by its number in the order of first drawing, the last group that it was drawn
    /// into, and its index among the members.
    places: Vec<(u32, u32)>,
    drawing: u32,
    /// Farness of the component, its root, index of the member.
    order: Vec<(u32, u32, u32)>,
    marks: SquareMarks,
    joint: Joint,
    /// Sides that are drawn in pieces, and rims.
    raster: Raster,
    rims: Raster,
}

/// The marks of the patches of one component.
#[derive(Debug, Default, Clone)]
struct Joint {
    marks: SquareMarks,
    /// The least nearness of the patches in each tile.
    nears: [f32; GROUP_TILES],
}

impl Local {
    /// Draws patches into a group. Appends the numbers of those that hid more than before.
    pub(crate) fn draw(
        &mut self,
        spot: &mut Spot,
        stores: Stores,
        listed: &[Listing],
        useful: &mut Vec<u32>,
    ) {
        self.choose(spot, stores, listed);
        self.join(spot, stores);
        self.order();
        let mut first = 0;
        while first < self.order.len() {
            let root = self.order[first].1;
            let last = first + self.order[first..].iter().take_while(|o| o.1 == root).count();
            let hidden = |&(_, _, i): &(u32, u32, u32)| {
                let m = &self.members[i as usize];
                spot.hides(&m.pixels, m.near)
            };
            if !self.order[first..last].iter().all(hidden) {
                self.draw_component(spot, stores, first..last, useful);
            }
            first = last;
        }
    }

    /// Collects the patches with edges near the group, or around it.
    fn choose(&mut self, spot: &Spot, stores: Stores, listed: &[Listing]) {
        self.members.clear();
        self.choices.clear();
        self.drawing = self.drawing.wrapping_add(1);
        if self.drawing == 0 {
            self.places.clear();
            self.drawing = 1;
        }
        let bounds = spot.bounds();
        let corner = spot.corner();
        // The rims of a component are all of its sides that are not seams.
        let is_still = spot.projector.rims().is_none();
        for &Listing { id, near, pixels } in listed {
            let Some((is_late, place)) = stores.find(id) else { continue };
            let store = stores.store(is_late);
            let patch = store.patch(place);
            if patch.pixels.is_none() {
                continue;
            }
            let (first, mut passed, mut any) = (self.choices.len() as u32, Passed::default(), 0);
            for sides in store.groups(place) {
                let (near, left) = bounds.near_and_left(&sides.edges);
                any |= near;
                self.choices.push(Choice { near, seams: 0 });
                if left != 0 {
                    passed.add(&scaled(&sides.edges), left, corner, patch.turned);
                }
            }
            // It neither covers the group nor ends in it.
            if any == 0 && passed.is_zero() && store.deep(place).is_empty() && is_still {
                self.choices.truncate(first as usize);
                continue;
            }
            let place_here = self.members.len() as u32;
            if self.places.len() <= id as usize {
                self.places.resize(id as usize + 1, (0, 0));
            }
            self.places[id as usize] = (self.drawing, place_here);
            let pixels = pixels.intersect(&spot.pixels);
            let (parent, nearest) = (place_here, near);
            self.members.push(Member { id, is_late, place, near, parent, nearest, pixels, first, passed });
        }
    }

    /// The index of a patch of the group by its number in the order of first drawing.
    #[inline]
    fn find(&self, id: u32) -> Option<u32> {
        let &(drawing, place) = self.places.get(id as usize)?;
        (drawing == self.drawing).then_some(place)
    }

    /// Joins patches that share sides near the group, and marks those sides as seams; all sides if
    /// the eye may go some way.
    fn join(&mut self, spot: &Spot, stores: Stores) {
        let has_rims = spot.projector.rims().is_some();
        for i in 0..self.members.len() {
            let member = &self.members[i];
            let (patch, first) = (stores.patch(member), member.first);
            for (sides, at) in stores.groups(member).iter().zip(first as usize..) {
                // Those that are drawn in pieces are not chosen by place.
                let mut lanes = if has_rims { u8::MAX } else { self.choices[at].near | !sides.edges.plain };
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % LANES;
                    lanes &= lanes - 1;
                    let number = sides.twins[lane];
                    if number == NO_TWIN {
                        continue;
                    }
                    let place = stores.ids.get(number).and_then(|id| self.find(id));
                    let Some(place) = place.filter(|&place| place as usize != i) else { continue };
                    let other = stores.patch(&self.members[place as usize]);
                    let runs_opposite = sides.opposite >> lane & 1 == 1;
                    if runs_opposite != (patch.turned == other.turned)
                        || has_rims && !(patch.faces_eye && other.faces_eye)
                    {
                        continue;
                    }
                    self.unite(i as u32, place);
                    self.choices[at].seams |= 1 << lane;
                }
            }
        }
    }

    /// The root of the component of a patch. Shortens the way for the next call.
    fn root(&mut self, mut i: u32) -> u32 {
        while self.members[i as usize].parent != i {
            let up = self.members[self.members[i as usize].parent as usize].parent;
            self.members[i as usize].parent = up;
            i = up;
        }
        i
    }

    /// Makes one component of those of two patches.
    fn unite(&mut self, i: u32, k: u32) {
        let (a, b) = (self.root(i), self.root(k));
        self.members[a.max(b) as usize].parent = a.min(b);
    }

    /// Puts the patches in order: nearest components first, since they may hide the rest.
    fn order(&mut self) {
        for i in 0..self.members.len() as u32 {
            let root = self.root(i);
            let near = self.members[i as usize].near;
            let nearest = &mut self.members[root as usize].nearest;
            *nearest = nearest.max(near);
            self.members[i as usize].parent = root;
        }
        self.order.clear();
        for (m, i) in self.members.iter().zip(0..) {
            let nearest = self.members[m.parent as usize].nearest;
            self.order.push((farness(nearest), m.parent, i));
        }
        self.order.sort_unstable();
    }

    /// Draws the patches of one component, a range of the order of drawing.
    fn draw_component(
        &mut self,
        spot: &mut Spot,
        stores: Stores,
        range: std::ops::Range<usize>,
        useful: &mut Vec<u32>,
    ) {
        let Self { members, choices, order, marks, joint, raster, rims, .. } = self;
        let component = || order[range.clone()].iter().map(|&(_, _, i)| &members[i as usize]);
        let mut joint = (range.len() > 1).then(|| {
            *joint = Joint { marks: SquareMarks::default(), nears: [f32::INFINITY; GROUP_TILES] };
            joint
        });
        let (area, corner) = (spot.area(), spot.corner());
        let fine_first = spot.fine_first();
        let seams = |m: &Member, side: &WholeSide| {
            let first = stores.store(m.is_late).first_group(m.place);
            choices[(m.first + side.group - first) as usize].seams >> side.lane & 1 == 1
        };
        // Nothing is covered before all rims of the component are known.
        let rims = spot.projector.rims().map(|widened| {
            let widened = widened.finer(FINER as f64);
            rims.begin(area, fine_first);
            for m in component() {
                let own = stores.store(m.is_late).rims(m.place).iter();
                own.filter(|side| !seams(m, side)).for_each(|side| widened.draw(rims, side));
            }
            &*rims
        });
        let deep = spot.projector.deep_sides().finer(FINER as f64);
        for m in component() {
            let patch = stores.patch(m);
            *marks = SquareMarks::default();
            let groups = stores.groups(m);
            draw_edges(marks, groups, &choices[m.first as usize..], corner, patch.turned);
            marks.pass(&m.passed);
            let own = stores.store(m.is_late).deep(m.place);
            if !own.is_empty() {
                raster.begin(area, fine_first);
                deep.draw(raster, own, patch.turned, |side| seams(m, side));
                raster.finish();
                marks.add_raster(raster);
            }
            if cover_patch(spot, marks, (m.near, patch), rims, joint.as_deref_mut()) {
                useful.push(m.id);
            }
        }
        if let Some(joint) = joint
            && cover_seams(spot, rims, joint)
        {
            useful.extend(component().map(|m| m.id));
        }
    }
}

/// Draws the edges of a patch that were chosen.
fn draw_edges(
    marks: &mut SquareMarks,
    groups: &[Sides],
    choices: &[Choice],
    corner: (i32, i32),
    turned: bool,
) {
    let (mut few, mut count) = (Edges::default(), 0);
    for (sides, choice) in groups.iter().zip(choices) {
        let mut lanes = choice.near;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            few.take(count, &sides.edges, lane, choice.seams >> lane & 1 == 1);
            count += 1;
            if count == LANES {
                marks.edges(&scaled(&few), corner, turned);
                (few, count) = (Edges::default(), 0);
            }
        }
    }
    if count > 0 {
        marks.edges(&scaled(&few), corner, turned);
    }
}

/// Edges in finer pixels.
#[inline(always)]
fn scaled(e: &Edges) -> Edges {
    let by = |lanes: &Lanes| -> Lanes { each(|i| lanes[i] * FINER as f32) };
    let (x0, y0, x1, y1) = (by(&e.x0), by(&e.y0), by(&e.x1), by(&e.y1));
    Edges { x0, y0, x1, y1, wide: by(&e.wide), unsure: by(&e.unsure), ..*e }
}

/// Covers the pixels of one patch, and adds its marks to those of its component.
#[inline]
fn cover_patch(
    spot: &mut Spot,
    marks: &SquareMarks,
    (near, patch): (f32, &Kept),
    rims: Option<&Raster>,
    mut joint: Option<&mut Joint>,
) -> bool {
    let mut changed = false;
    for row in 0..GROUP as usize {
        let words = marks.covered(row);
        let marked = if joint.is_some() { marks.marked(row) } else { 0 };
        if marked == 0 && words == TileWords::default() {
            continue;
        }
        for (column, &word) in words.iter().enumerate() {
            let at = row * GROUP as usize + column;
            let mask = word & !open_rims(rims, at);
            if mask == 0 && marked >> column & 1 == 0 {
                continue;
            }
            let closed = spot.coverage.closed(spot.tiles + at);
            if closed >= near {
                if let Some(joint) = &mut joint {
                    // Seams with it need not be closed.
                    joint.nears[at] = f32::NEG_INFINITY;
                }
                continue;
            }
            let rect = spot.window.square(spot.at.0 + column as i64, spot.at.1 + row as i64, 1);
            let (near, plane) = patch.back.behind(&rect);
            let near = below(near);
            if mask != 0 && closed < near {
                changed |= spot.coverage.cover_plane(spot.tiles + at, mask, near, plane);
            }
            if let Some(joint) = &mut joint {
                joint.nears[at] = joint.nears[at].min(near);
            }
        }
    }
    if let Some(joint) = joint {
        joint.marks.add(marks);
    }
    changed
}

/// Covers the pixels that only seams between the patches of a component touch.
fn cover_seams(spot: &mut Spot, rims: Option<&Raster>, joint: &Joint) -> bool {
    let mut changed = false;
    for row in 0..GROUP as usize {
        for (column, &word) in joint.marks.covered_seams(row).iter().enumerate() {
            let at = row * GROUP as usize + column;
            let (mask, near) = (word & !open_rims(rims, at), joint.nears[at]);
            if mask != 0 && spot.coverage.closed(spot.tiles + at) < near {
                changed |= spot.coverage.cover(spot.tiles + at, mask, near);
            }
        }
    }
    changed
}

/// The pixels that rims touch in a tile.
#[inline]
fn open_rims(rims: Option<&Raster>, tile: usize) -> u64 {
    rims.map_or(0, |rims| rims.marks(tile).open())
}

/// The borders of a group, counted in pixels as edges are.
struct Bounds {
    left: f32,
    right: f32,
    low: f32,
    high: f32,
}

impl Bounds {
    /// Those of some edges that come near the group, and those that pass it on the left, one bit
    /// each.
    ///
    /// An edge stays within its width of the rectangle around its ends; one that stays outside of
    /// the group's rows passes the middles of none of them.
    #[inline(always)]
    fn near_and_left(&self, e: &Edges) -> (u8, u8) {
        let low: Lanes = each(|i| lesser(e.y0[i], e.y1[i]) - e.wide[i]);
        let high: Lanes = each(|i| greater(e.y0[i], e.y1[i]) + e.wide[i]);
        let left: Lanes = each(|i| lesser(e.x0[i], e.x1[i]) - e.wide[i]);
        let right: Lanes = each(|i| greater(e.x0[i], e.x1[i]) + e.wide[i]);
        let beside = |i: usize| (low[i] <= self.high) & (high[i] >= self.low) & (left[i] <= self.right);
        let bits = |is: &dyn Fn(usize) -> bool| (0..LANES).fold(0, |bits, i| bits | u8::from(is(i)) << i);
        let beside = bits(&beside) & e.plain;
        let left = bits(&|i| right[i] < self.left);
        (beside & !left, beside & left)
    }
}

impl Spot<'_> {
    /// The first pixel that edges are counted from, in finer pixels.
    fn fine_first(&self) -> (i64, i64) {
        let (x, y) = self.projector.first();
        (x * FINER, y * FINER)
    }

    /// The group's first finer pixel, as edges are counted.
    fn corner(&self) -> (i32, i32) {
        let (x, y) = self.projector.first();
        (((self.at.0 - x) * FINER) as i32, ((self.at.1 - y) * FINER) as i32)
    }

    fn bounds(&self) -> Bounds {
        let (x, y) = self.projector.first();
        let (left, low) = ((self.at.0 - x) as f32, (self.at.1 - y) as f32);
        Bounds { left, low, right: left + GROUP as f32, high: low + GROUP as f32 }
    }

    /// Its finer pixels.
    fn area(&self) -> Area {
        Area { x: self.at.0 * FINER, y: self.at.1 * FINER, nx: GROUP, ny: GROUP }
    }

    /// Whether some of its pixels are covered as wholes, nearer than a nearness.
    fn hides(&self, pixels: &PixelRect, near: f32) -> bool {
        let (x, y) = self.at;
        let columns = ((pixels.x.0 - x) as usize, (pixels.x.1 - x) as usize);
        columns.0 >= columns.1
            || (pixels.y.0..pixels.y.1).all(|row| {
                let first = self.tiles + ((row - y) * GROUP) as usize;
                self.coverage.all_closed(first + columns.0, first + columns.1 - 1, near)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Edges with ends in a wide rectangle around a group, some of them flat, steep or short.
    fn random_edges(random: &mut Random, bounds: &Bounds) -> Edges {
        let mut byte = || (random.next() * 256.0) as u8;
        let plain = byte();
        let seams = plain & byte();
        let mut edges = Edges { plain, seams, ..Edges::default() };
        for i in 0..LANES {
            let spread = [1.0, 6.0, 40.0][i % 3];
            let mut end = |middle: f32| middle + random.within(-spread, spread) as f32;
            let (x, y) = (bounds.left + 2.0, bounds.low + 2.0);
            (edges.x0[i], edges.y0[i]) = (end(x), end(y));
            (edges.x1[i], edges.y1[i]) = (end(x), end(y));
            match i {
                5 => edges.y1[i] = edges.y0[i],
                6 => edges.y1[i] = edges.y0[i] + 1e-4,
                7 => edges.x1[i] = edges.x0[i],
                _ => {}
            }
            edges.unsure[i] = 1e-5;
            edges.wide[i] = if i % 2 == 0 { 2e-5 } else { random.within(0.01, 0.6) as f32 };
        }
        edges
    }

    #[test]
    fn chosen_edges_leave_the_marks_of_all() {
        let mut random = Random(17);
        let corner = (40 * FINER as i32, 12 * FINER as i32);
        let bounds = Bounds { left: 40.0, low: 12.0, right: 44.0, high: 16.0 };
        let area = Area { x: corner.0.into(), y: corner.1.into(), nx: GROUP, ny: GROUP };
        let (mut raster, mut covered, mut chosen, mut left_of_it) = (Raster::default(), 0, 0, 0);
        for round in 0..2000 {
            let turned = round % 2 == 0;
            let groups: Vec<Edges> = (0..3).map(|_| random_edges(&mut random, &bounds)).collect();
            raster.begin(area, (0, 0));
            let (mut marks, mut passed) = (SquareMarks::default(), Passed::default());
            let mut choices = Vec::new();
            let mut sides = Vec::new();
            for edges in groups {
                raster.edges(&scaled(&edges), turned);
                let (near, left) = bounds.near_and_left(&edges);
                chosen += near.count_ones();
                left_of_it += left.count_ones();
                passed.add(&scaled(&edges), left, corner, turned);
                choices.push(Choice { near, seams: edges.seams });
                sides.push(Sides { edges, twins: [NO_TWIN; LANES], opposite: 0 });
            }
            raster.finish();
            draw_edges(&mut marks, &sides, &choices, corner, turned);
            marks.pass(&passed);
            let mut whole = SquareMarks::default();
            whole.add_raster(&raster);
            assert_eq!(marks, whole, "{round}");
            for row in 0..GROUP as usize {
                let words = marks.covered(row);
                for (column, word) in words.into_iter().enumerate() {
                    let tile = raster.marks(row * GROUP as usize + column);
                    assert_eq!(word, tile.covered(), "{round}");
                    assert_eq!(marks.covered_seams(row)[column], tile.covered_seams());
                    assert_eq!(marks.marked(row) >> column & 1 == 1, !tile.is_empty());
                    covered += word.count_ones();
                }
            }
        }
        assert!(covered > 100_000 && chosen > 10_000 && left_of_it > 1000, "{covered} {chosen} {left_of_it}");
    }
}
