//! Kept patches drawn once more into a group of 4x4 pixels, each divided into 8x8 finer ones.
//!
//! The edges are those of the first pass, scaled; their errors scale alike. Only those that come
//! near the group are drawn; of those left of it the rows are kept that they pass, and all others
//! change nothing. So patches are joined along the sides only that come near: the sides of a set of
//! patches that no two of them share may be open wherever they are drawn.

use fearless_simd::Simd;

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::joined::{DrawPlace, Joined};
use crate::occlusion::surface::kept::{Kept, KeptPatches};
use crate::occlusion::surface::near::{Choice, FINER, GROUP, GROUP_PIXELS, GroupBorders, draw_edges};
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::{Area, LANES, Raster, Windings, rows_passed};
use crate::occlusion::surface::scratch::Ids;
use crate::occlusion::surface::sheet::{Joint, Sheet};
use crate::occlusion::surface::sides::{Sides, WholeSide};
use crate::simd::vectorized;

/// A group of pixels.
pub(crate) struct Spot<'a> {
    pub(crate) projector: Projector,
    /// Its first pixel.
    pub(crate) at: (i64, i64),
    /// The tiles of finer pixels, one for each pixel.
    pub(crate) sheet: Sheet<'a>,
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
    /// The first of its groups of sides in the list of choices.
    first: u32,
    /// The edges left of the group.
    passed: Windings,
}

/// Memory for drawing into groups.
#[derive(Debug, Default, Clone)]
pub(crate) struct Local {
    members: Vec<Member>,
    choices: Vec<Choice>,
    joined: Joined,
    joint: Joint,
    raster: Raster,
    rims: Raster,
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
        vectorized!(simd => self.draw_with(simd, spot, stores, listed, useful));
    }

    #[inline(always)]
    fn draw_with<S: Simd>(
        &mut self,
        simd: S,
        spot: &mut Spot,
        stores: Stores,
        listed: &[Listing],
        useful: &mut Vec<u32>,
    ) {
        self.choose(simd, spot, stores, listed);
        self.join(spot, stores);
        self.joined.sort();
        let order = std::mem::take(&mut self.joined.order);
        for component in order.chunk_by(|a, b| a.1 == b.1) {
            self.draw_component(simd, spot, stores, component, useful);
        }
        self.joined.order = order;
    }

    /// Collects the patches with edges near the group, or around it.
    #[inline(always)]
    fn choose<S: Simd>(&mut self, simd: S, spot: &Spot, stores: Stores, listed: &[Listing]) {
        self.members.clear();
        self.choices.clear();
        self.joined.begin();
        let bounds = spot.bounds();
        let rows = (spot.first_row(), GROUP_PIXELS);
        // The rims of a component are all of its sides that are not seams.
        let is_still = spot.projector.rims().is_none();
        for &Listing { id, near, .. } in listed {
            let Some((is_late, place)) = stores.find(id) else { continue };
            let store = stores.store(is_late);
            let patch = store.patch(place);
            if patch.pixels.is_none() {
                continue;
            }
            let (first, mut passed, mut any) = (self.choices.len() as u32, Windings::default(), 0);
            for sides in store.groups(place) {
                let (near, left) = bounds.near_and_left(&sides.edges(simd, 1.0));
                any |= near;
                self.choices.push(Choice { near, seams: 0 });
                if left != 0 {
                    passed.add(rows_passed(&sides.edges(simd, FINER as f32), left, rows, patch.turned));
                }
            }
            // It neither covers the group nor ends in it.
            if any == 0 && passed.is_zero() && store.deep(place).is_empty() && is_still {
                self.choices.truncate(first as usize);
                continue;
            }
            self.joined.push(id, near);
            self.members.push(Member { id, is_late, place, near, first, passed });
        }
    }

    /// Joins patches that share sides near the group, and marks those sides as seams; all sides if
    /// the eye may go some way.
    #[inline(always)]
    fn join(&mut self, spot: &Spot, stores: Stores) {
        let has_rims = spot.projector.rims().is_some();
        for i in 0..self.members.len() {
            let member = &self.members[i];
            let (patch, first) = (stores.patch(member), member.first);
            for (sides, at) in stores.groups(member).iter().zip(first as usize..) {
                // Those that are drawn in pieces are not chosen by place.
                let mut lanes = if has_rims { u8::MAX } else { self.choices[at].near | !sides.plain };
                lanes &= sides.shared;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % LANES;
                    lanes &= lanes - 1;
                    let place = stores.ids.get(sides.twins[lane]).and_then(|id| self.joined.find(id));
                    let Some(place) = place.filter(|&place| place as usize != i) else { continue };
                    let other = stores.patch(&self.members[place as usize]);
                    let runs_opposite = sides.opposite >> lane & 1 == 1;
                    if runs_opposite != (patch.turned == other.turned)
                        || has_rims && !(patch.faces_eye && other.faces_eye)
                    {
                        continue;
                    }
                    self.joined.unite(i as u32, place);
                    self.choices[at].seams |= 1 << lane;
                }
            }
        }
    }

    /// Draws the patches of one component.
    #[inline(always)]
    fn draw_component<S: Simd>(
        &mut self,
        simd: S,
        spot: &mut Spot,
        stores: Stores,
        component: &[DrawPlace],
        useful: &mut Vec<u32>,
    ) {
        let Self { members, choices, joint, raster, rims, .. } = self;
        let patches = || component.iter().map(|place| &members[place.2 as usize]);
        let (area, first) = (spot.area(), spot.fine_first());
        let mut joint = (component.len() > 1).then(|| {
            joint.clear(area);
            joint
        });
        let seams = |m: &Member, side: &WholeSide| {
            let first = stores.store(m.is_late).first_group(m.place);
            choices[(m.first + side.group - first) as usize].seams >> side.lane & 1 == 1
        };
        // Nothing is covered before all rims of the component are known.
        let rims = spot.projector.rims().map(|widened| {
            let widened = widened.finer(FINER as f64);
            rims.begin(area, first);
            for m in patches() {
                let own = stores.store(m.is_late).rims(m.place).iter();
                own.filter(|side| !seams(m, side)).for_each(|side| widened.draw(rims, side));
            }
            &*rims
        });
        let deep = spot.projector.deep_sides().finer(FINER as f64);
        for m in patches() {
            let patch = stores.patch(m);
            raster.begin(area, first);
            draw_edges(simd, raster, stores.groups(m), &choices[m.first as usize..], patch.turned);
            let sides = stores.store(m.is_late).deep(m.place);
            deep.draw(simd, raster, (sides, patch.turned), |side| seams(m, side));
            raster.pass_left(&m.passed);
            if spot.sheet.cover_patch(simd, raster, (m.near, &patch.back), rims, joint.as_deref_mut()).0 {
                useful.push(m.id);
            }
        }
        if let Some(joint) = joint
            && spot.sheet.cover_seams(rims, joint)
        {
            useful.extend(patches().map(|m| m.id));
        }
    }
}

impl Spot<'_> {
    /// The first pixel that edges are counted from, in finer pixels.
    fn fine_first(&self) -> (i64, i64) {
        let (x, y) = self.projector.first();
        (x * FINER, y * FINER)
    }

    /// The group's first row of finer pixels, as edges are counted.
    fn first_row(&self) -> i32 {
        ((self.at.1 - self.projector.first().1) * FINER) as i32
    }

    fn bounds(&self) -> GroupBorders {
        let (x, y) = self.projector.first();
        let (left, low) = ((self.at.0 - x) as f32, (self.at.1 - y) as f32);
        GroupBorders { left, low, right: left + GROUP as f32, high: low + GROUP as f32 }
    }

    /// Its finer pixels.
    fn area(&self) -> Area {
        Area { x: self.at.0 * FINER, y: self.at.1 * FINER, nx: 1, ny: GROUP }
    }
}
