//! Kept patches drawn once more into a group of 4x4 pixels, each divided into 8x8 finer ones.
//!
//! The edges are those of the first pass, scaled; their errors scale alike. Only those that come
//! near the group are drawn; of those left of it the rows are kept that they pass, and all others
//! change nothing. So patches are joined along the sides only that come near: the sides of a set of
//! patches that no two of them share may be open wherever they are drawn.

use fearless_simd::Simd;

use crate::occlusion::face_buffer::ListedPatch;
use crate::occlusion::surface::joined::{DrawPlace, Joined};
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::near::{Choice, FINER, GROUP, GROUP_PIXELS, GroupBorders, draw_edges};
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::{Area, LANES, Raster, Windings, rows_passed};
use crate::occlusion::surface::scratch::Ids;
use crate::occlusion::surface::sheet::{Joint, Sheet};
use crate::occlusion::surface::sides::WholeSide;
use crate::simd::vectorized;

/// A group of pixels.
pub(crate) struct Spot<'a> {
    pub(crate) projector: Projector,
    /// Its first pixel.
    pub(crate) at: (i64, i64),
    /// The tiles of finer pixels, one for each pixel.
    pub(crate) sheet: Sheet<'a>,
}

/// A patch that is drawn into the group.
#[derive(Debug, Clone)]
struct Member {
    id: u32,
    /// Where it is kept.
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
        kept: (&Ids, &KeptPatches),
        listed: &[ListedPatch],
        useful: &mut Vec<u32>,
    ) {
        vectorized!(simd => self.draw_with(simd, spot, kept, listed, useful));
    }

    #[inline(always)]
    fn draw_with<S: Simd>(
        &mut self,
        simd: S,
        spot: &mut Spot,
        (ids, kept): (&Ids, &KeptPatches),
        listed: &[ListedPatch],
        useful: &mut Vec<u32>,
    ) {
        self.choose(simd, spot, kept, listed);
        self.join(spot, ids, kept);
        self.joined.sort();
        let order = std::mem::take(&mut self.joined.order);
        for component in order.chunk_by(|a, b| a.1 == b.1) {
            self.draw_component(simd, spot, kept, component, useful);
        }
        self.joined.order = order;
    }

    /// Collects the patches with edges near the group, or around it.
    #[inline(always)]
    fn choose<S: Simd>(&mut self, simd: S, spot: &Spot, kept: &KeptPatches, listed: &[ListedPatch]) {
        self.members.clear();
        self.choices.clear();
        self.joined.begin();
        let bounds = spot.bounds();
        let rows = (spot.first_row(), GROUP_PIXELS);
        // The rims of a component are all of its sides that are not seams.
        let is_still = spot.projector.rims().is_none();
        for &ListedPatch { id, near, .. } in listed {
            let Some(place) = kept.find(id) else { continue };
            let patch = kept.patch(place);
            let (first, mut passed, mut any) = (self.choices.len() as u32, Windings::default(), 0);
            for sides in kept.groups(place) {
                let (near, left) = bounds.near_and_left(&sides.edges(simd, 1.0));
                any |= near;
                self.choices.push(Choice { near, seams: 0 });
                if left != 0 {
                    passed.add(rows_passed(&sides.edges(simd, FINER as f32), left, rows, patch.turned));
                }
            }
            // It neither covers the group nor ends in it.
            if any == 0 && passed.is_zero() && kept.deep(place).is_empty() && is_still {
                self.choices.truncate(first as usize);
                continue;
            }
            self.joined.push(id, near);
            self.members.push(Member { id, place, near, first, passed });
        }
    }

    /// Joins patches that share sides near the group, and marks those sides as seams; all sides if
    /// the eye may go some way.
    #[inline(always)]
    fn join(&mut self, spot: &Spot, ids: &Ids, kept: &KeptPatches) {
        let has_rims = spot.projector.rims().is_some();
        for i in 0..self.members.len() {
            let member = &self.members[i];
            let (patch, first) = (kept.patch(member.place), member.first);
            for (sides, at) in kept.groups(member.place).iter().zip(first as usize..) {
                // Those that are drawn in pieces are not chosen by place.
                let mut lanes = if has_rims { u8::MAX } else { self.choices[at].near | !sides.plain };
                lanes &= sides.shared;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % LANES;
                    lanes &= lanes - 1;
                    let place = ids.get(sides.twins[lane]).and_then(|id| self.joined.find(id));
                    let Some(place) = place.filter(|&place| place as usize != i) else { continue };
                    let other = kept.patch(self.members[place as usize].place);
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
        kept: &KeptPatches,
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
            let first = kept.first_group(m.place);
            choices[(m.first + side.group - first) as usize].seams >> side.lane & 1 == 1
        };
        // Nothing is covered before all rims of the component are known.
        let rims = spot.projector.rims().map(|widened| {
            let widened = widened.finer(FINER as f64);
            rims.begin(area, first);
            for m in patches() {
                let own = kept.rims(m.place).iter();
                own.filter(|side| !seams(m, side)).for_each(|side| widened.draw(rims, side));
            }
            &*rims
        });
        let deep = spot.projector.deep_sides().finer(FINER as f64);
        for m in patches() {
            let patch = kept.patch(m.place);
            raster.begin(area, first);
            draw_edges(simd, raster, kept.groups(m.place), &choices[m.first as usize..], patch.turned);
            deep.draw(simd, raster, (kept.deep(m.place), patch.turned), |side| seams(m, side));
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
