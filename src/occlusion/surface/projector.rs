//! Sides of patches projected to the pixels of a face, eight at a time in single precision.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::{DMat3, DVec3, Vec3};

use crate::geometry::Room;
use crate::mesh::surface::PatchIndex;
use crate::numeric::occlusion::{EDGE, FAR_PIXEL, FARTHEST_PIXEL, PLACED, PROJECTED, REACH_ROOM, SLACK_ROOM};
use crate::occlusion::face::Face;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::{PixelRect, floor};
use crate::occlusion::surface::deep::DeepSides;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::raster::{Edges, LANES, Lanes};
use crate::occlusion::surface::rim::Rims;
use crate::occlusion::surface::sides::{NO_TWIN, SeenSides, Sides, WholeSide};
use crate::occlusion::surface::viewpoint::Viewpoint;
use crate::occlusion::tiles::TILE;

/// Projects points to the pixels of a window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projector {
    face: Face,
    /// The first pixel of the window.
    first: (i64, i64),
    per_unit: f32,
    /// The pixel of the middle of the face, counted from the first one of the window.
    middle: (f32, f32),
    /// Edges are cut off where they are less deep.
    limit: f32,
    origin: DVec3,
    /// Where the eye may go, around the origin.
    room: Room,
}

/// How the points of a drawable come to the face.
struct FaceFrame {
    /// Subtracted first: the eye, in two parts.
    eye: (Vec3, Vec3),
    /// Rows of the matrix that turns them to the face, and the place of their origin there.
    rows: [Vec3; 3],
    at: Vec3,
    /// The slack of a side is multiplied by the first, and the second added.
    growth: f32,
    error: f32,
}

/// Sides as they are stored.
#[derive(Default)]
struct Ends {
    from: [Lanes; 3],
    to: [Lanes; 3],
    slack: Lanes,
}

impl Ends {
    #[inline(always)]
    fn set(&mut self, lane: usize, from: Vec3, to: Vec3, slack: f32) {
        for (axis, (a, b)) in from.to_array().into_iter().zip(to.to_array()).enumerate() {
            self.from[axis][lane] = a;
            self.to[axis][lane] = b;
        }
        self.slack[lane] = slack;
    }

    #[inline(always)]
    fn copy(&mut self, from: usize, to: usize) {
        for lanes in self.from.iter_mut().chain(&mut self.to).chain([&mut self.slack]) {
            lanes[to] = lanes[from];
        }
    }
}

/// Sides in coordinates of the face.
struct PlacedSides<S: Simd> {
    from: [f32x8<S>; 3],
    to: [f32x8<S>; 3],
    slack: f32x8<S>,
    /// Whether all coordinates are finite, as a sum of zeros.
    zero: f32x8<S>,
    /// Which edges may be drawn as they are.
    plain: mask32x8<S>,
}

/// A rectangle around points, lane by lane.
struct LaneRect<S: Simd> {
    least: [f32x8<S>; 2],
    most: [f32x8<S>; 2],
    /// The greatest width of an edge, and whether that is known of all of them.
    wide: f32x8<S>,
    known: mask32x8<S>,
}

impl<S: Simd> LaneRect<S> {
    #[inline(always)]
    fn empty(simd: S) -> Self {
        Self {
            least: [f32x8::splat(simd, f32::INFINITY); 2],
            most: [f32x8::splat(simd, f32::NEG_INFINITY); 2],
            wide: f32x8::splat(simd, 0.0),
            known: mask32x8::splat(simd, true),
        }
    }
}

impl FaceFrame {
    /// Moves points to the face, given by their coordinates.
    #[inline(always)]
    fn turn<S: Simd>(&self, simd: S, points: &[Lanes; 3]) -> [f32x8<S>; 3] {
        let (eye, rest, at) = (self.eye.0.to_array(), self.eye.1.to_array(), self.at.to_array());
        let off = |axis: usize| f32x8::from_slice(simd, &points[axis]) - eye[axis] - rest[axis];
        let (x, y, z) = (off(0), off(1), off(2));
        let turned = |axis: usize| {
            let (row, at) = (self.rows[axis], at[axis]);
            x * row.x + y * row.y + z * row.z + at
        };
        [turned(0), turned(1), turned(2)]
    }
}

impl Projector {
    pub(crate) fn new(buffer: &FaceBuffer, viewpoint: Viewpoint) -> Self {
        let Viewpoint { origin, limit, room } = viewpoint;
        let (face, per_unit) = (*buffer.face(), buffer.window().per_unit());
        let (tx, ty) = buffer.window().first_tile();
        let first = (tx * TILE, ty * TILE);
        Self {
            face,
            first,
            per_unit: per_unit as f32,
            middle: ((per_unit - first.0 as f64) as f32, (per_unit - first.1 as f64) as f32),
            limit: if face.parallel { 0.0 } else { (limit as f32).max(f32::MIN_POSITIVE) },
            origin,
            room,
        }
    }

    /// The face that it projects to.
    pub(super) fn face(&self) -> &Face {
        &self.face
    }

    /// The pixel that coordinates are counted from.
    pub(super) fn first(&self) -> (i64, i64) {
        self.first
    }

    /// Draws sides that [`Projector::project`] does not make single edges.
    pub(super) fn deep_sides(&self) -> DeepSides {
        let middle = (self.middle.0.into(), self.middle.1.into());
        DeepSides { per_unit: self.per_unit.into(), middle, limit: self.limit.into(), finer: 1.0 }
    }

    /// Draws the rims of components, if the eye may go some way.
    pub(super) fn rims(&self) -> Option<Rims> {
        let axes = [self.face.right, self.face.up, self.face.forward];
        (self.room.radius() > 0.0).then(|| Rims { sides: self.deep_sides(), room: self.room.turned(axes) })
    }

    /// How the points of a drawable come to the face. Parallel rays have the depth 1 everywhere,
    /// and lengths in units of the face.
    #[inline(always)]
    fn frame(&self, d: &Drawable) -> FaceFrame {
        let origin = self.origin;
        let Face { right, up, forward, parallel } = self.face;
        let axes = DMat3::from_cols(right, up, if parallel { DVec3::ZERO } else { forward }).transpose();
        let depth = if parallel { DVec3::Z } else { DVec3::ZERO };
        let (min, max) = d.surface.extent(PatchIndex::FIRST);
        let unit = if parallel { right.length() } else { 1.0 };
        let frame = |eye: (Vec3, Vec3), turn: DMat3, at: DVec3, growth: f64, error: f64| {
            let rows = turn.transpose();
            FaceFrame {
                eye,
                rows: [rows.x_axis.as_vec3(), rows.y_axis.as_vec3(), rows.z_axis.as_vec3()],
                at: at.as_vec3(),
                growth: (growth * unit) as f32,
                error: ((d.error + error) * unit) as f32,
            }
        };
        let reach = min.abs().max(max.abs()).as_dvec3();
        match d.placement {
            None => {
                let eye = origin.as_vec3();
                let rest = (origin - eye.as_dvec3()).as_vec3();
                // The axes of a cube's side only choose and turn coordinates.
                let error = if parallel { PLACED * (reach + origin.abs()).length() } else { 0.0 };
                frame((eye, rest), axes, depth, 1.0, error)
            }
            Some(p) => {
                let at = p.affine.translation - origin;
                let error = PLACED * (p.growth * reach.length() + at.length());
                frame((Vec3::ZERO, Vec3::ZERO), axes * p.affine.matrix3, axes * at + depth, p.growth, error)
            }
        }
    }

    /// Appends the sides of a patch as the face sees them. Returns the pixels of `within` that the
    /// patch may touch; `None` if there are none, or if it cannot be drawn.
    #[inline(always)]
    pub(super) fn project<S: Simd>(
        &self,
        simd: S,
        d: &Drawable,
        within: PixelRect,
        out: &mut SeenSides,
    ) -> Option<PixelRect> {
        let frame = self.frame(d);
        let mut extent = LaneRect::empty(simd);
        let (mut ends, mut finite) = (Ends::default(), true);
        let mut outline = d.outline();
        while outline.len() > 0 {
            let (mut twins, mut opposite, mut count) = ([NO_TWIN; LANES], 0, 0);
            if d.links.is_empty()
                && let Some(ring) = outline.take_ring()
            {
                let [a, b, c] = ring.map(|v| d.surface.positions[v as usize]);
                [(a, b), (b, c), (c, a)]
                    .into_iter()
                    .zip(0..)
                    .for_each(|((p, q), at)| ends.set(at, p, q, 0.0));
                count = 3;
            }
            for (number, side) in outline.by_ref().take(LANES) {
                let [from, to] = d.surface.ends(&side);
                ends.set(count, from, to, side.slack);
                if let Some((twin, turned)) = d.beyond(number, &side) {
                    twins[count] = twin;
                    opposite |= u8::from(turned) << count;
                }
                count += 1;
            }
            // The rest repeats the first.
            for lane in count..LANES {
                ends.copy(0, lane);
            }
            let placed = self.place(simd, &frame, &ends);
            let mut edges = self.edges(&placed, &mut extent);
            finite &= placed.zero.simd_eq(0.0).to_bitmask() == 0xff;
            let used = (0xff_u32 >> (LANES - count)) as u8;
            let deep = !edges.plain & used;
            edges.plain &= used;
            if deep != 0 {
                let group = out.groups.len() as u32;
                for lane in (0..LANES).filter(|lane| deep >> lane & 1 == 1) {
                    out.deep.push(whole_side(&placed, &edges, group, lane));
                }
            }
            if self.room.radius() > 0.0 {
                let group = out.groups.len() as u32;
                out.rims.extend((0..count).map(|lane| whole_side(&placed, &edges, group, lane)));
            }
            out.groups.push(Sides { edges, twins, opposite });
        }
        if finite { self.tighter(&extent, within) } else { None }
    }

    /// The pixels of a rectangle within the extent of a patch, if that is known: where the patch is
    /// deep enough.
    #[inline(always)]
    fn tighter<S: Simd>(&self, extent: &LaneRect<S>, within: PixelRect) -> Option<PixelRect> {
        if extent.known.to_bitmask() != 0xff {
            return Some(within);
        }
        let most = |lanes: f32x8<S>| f64::from(lanes.reduce_max());
        let least = |lanes: f32x8<S>| f64::from(lanes.reduce_min());
        let wide = most(extent.wide);
        let narrow = |(lo, hi): (i64, i64), axis: usize, first: i64| {
            let at = |v: f64| first + floor(v.clamp(-FARTHEST_PIXEL, FARTHEST_PIXEL));
            let (a, b) = (at(least(extent.least[axis]) - wide), at(most(extent.most[axis]) + wide));
            (lo.max(a), hi.min(b + 1))
        };
        let pixels = PixelRect { x: narrow(within.x, 0, self.first.0), y: narrow(within.y, 1, self.first.1) };
        (!pixels.is_empty()).then_some(pixels)
    }

    /// Moves points to the face.
    #[inline(always)]
    fn place<S: Simd>(&self, simd: S, f: &FaceFrame, ends: &Ends) -> PlacedSides<S> {
        let (from, to) = (f.turn(simd, &ends.from), f.turn(simd, &ends.to));
        let slack = f32x8::from_slice(simd, &ends.slack) * f.growth + f.error;
        let zeros = |[x, y, z]: [f32x8<S>; 3]| x * 0.0 + y * 0.0 + z * 0.0;
        let (near, far) = (from[2].min(to[2]), from[2].max(to[2]));
        // One width serves all of the edge, or there is no slack.
        let even = slack.simd_eq(0.0) | (far.simd_le(near * 2.0) & far.simd_gt(slack * 2.0));
        let plain = near.simd_ge(self.limit) & even;
        PlacedSides { from, to, slack, zero: slack * 0.0 + (zeros(from) + zeros(to)), plain }
    }

    /// The edges in pixels. Those that leave the range of pixels are no longer plain.
    #[inline(always)]
    fn edges<S: Simd>(&self, p: &PlacedSides<S>, extent: &mut LaneRect<S>) -> Edges {
        let shift = self.middle.0.abs() + self.middle.1.abs();
        let one = f32x8::splat(p.slack.simd, 1.0);
        let (a, b) = (one / p.from[2], one / p.to[2]);
        let column = |p: &[f32x8<S>; 3], inverse: f32x8<S>| p[0] * inverse * self.per_unit + self.middle.0;
        let row = |p: &[f32x8<S>; 3], inverse: f32x8<S>| p[1] * inverse * self.per_unit + self.middle.1;
        let (x0, y0, x1, y1) = (column(&p.from, a), row(&p.from, a), column(&p.to, b), row(&p.to, b));
        let sum = (x0.abs() + y0.abs()) + (x1.abs() + y1.abs());
        let unsure = (sum + shift) * PROJECTED + EDGE as f32;
        // At depth z, points of the face move by at most slack (1 + |u|) / z, with |u| <= 1.
        let grow = SLACK_ROOM * self.per_unit;
        let wide = unsure * 2.0 + p.slack * a.max(b) * grow;
        // Also if it is NaN.
        let small = sum.simd_lt(FAR_PIXEL);
        let plain = p.plain & small & wide.simd_lt(FAR_PIXEL);
        extent.least = [x0.min(x1).min(extent.least[0]), y0.min(y1).min(extent.least[1])];
        extent.most = [x0.max(x1).max(extent.most[0]), y0.max(y1).max(extent.most[1])];
        extent.wide = extent.wide.max(wide);
        if self.room.radius() > 0.0 {
            let room = REACH_ROOM * self.room.radius() as f32 * self.per_unit;
            extent.wide = extent.wide.max(wide + a.max(b) * room);
        }
        let near = p.from[2].min(p.to[2]);
        extent.known = extent.known & near.simd_ge(p.slack * 2.0 + 2.0 * self.limit) & small;
        let plain = plain.to_bitmask() as u8;
        Edges {
            x0: x0.into(),
            y0: y0.into(),
            x1: x1.into(),
            y1: y1.into(),
            wide: wide.into(),
            unsure: unsure.into(),
            plain,
            seams: 0,
        }
    }
}

/// A side that is not drawn as one edge.
fn whole_side<S: Simd>(p: &PlacedSides<S>, e: &Edges, group: u32, lane: usize) -> WholeSide {
    let at = |of: &[f32x8<S>; 3]| DVec3::new(of[0][lane].into(), of[1][lane].into(), of[2][lane].into());
    WholeSide {
        group,
        lane: lane as u32,
        ends: [at(&p.from), at(&p.to)],
        pixels: [(e.x0[lane].into(), e.y0[lane].into()), (e.x1[lane].into(), e.y1[lane].into())],
        slack: p.slack[lane].into(),
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat};

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::offset::Offset;
    use crate::geometry::placement::Placement;
    use crate::mesh::surface::{Rules, Surface};
    use crate::occlusion::face::Rect;
    use crate::random::Random;
    use crate::simd::vectorized;

    /// A point with coordinates in single precision.
    fn single(random: &mut Random, reach: f32) -> Vec3 {
        random.point(f64::from(reach)).as_vec3()
    }

    /// The pixel of a point in double precision.
    fn exact(face: &Face, per_unit: f64, first: (i64, i64), p: DVec3) -> (f64, f64) {
        let at = face.local(p);
        let scale = if face.parallel { per_unit } else { per_unit / at.z };
        (at.x * scale + per_unit - first.0 as f64, at.y * scale + per_unit - first.1 as f64)
    }

    #[test]
    fn edges_are_where_double_precision_puts_them() {
        let mut random = Random::new(5);
        let eyed = Face { right: DVec3::X, up: DVec3::Z, forward: DVec3::Y, parallel: false };
        let along = DVec3::new(0.3, 0.8, -0.5).normalize();
        let (mut edges, mut deep) = (0, 0);
        for round in 0..400 {
            let face =
                if round % 4 == 3 { Face::across(along, along.any_orthonormal_vector(), 30.0) } else { eyed };
            let mut buffer = FaceBuffer::new(face);
            buffer.clear(Some(Rect { u0: -0.4, v0: -0.9, u1: 0.7, v1: 0.2 }), [360, 2880][round % 2]);
            // Far from the middle of the world coordinates lose digits.
            let far = [0.0, 3e3][round / 2 % 2];
            let eye = (single(&mut random, far).as_dvec3() + single(&mut random, 1.0).as_dvec3() * 1e-3)
                * f64::from(far.min(1.0));
            let placement = (round % 3 == 1).then(|| {
                let turn = Quat::from_euler(
                    glam::EulerRot::XYZ,
                    random.within(-3.0, 3.0) as f32,
                    random.within(-3.0, 3.0) as f32,
                    1.0,
                );
                let to = eye.as_vec3() + single(&mut random, 20.0);
                let scale = Vec3::splat(random.within(0.5, 3.0) as f32);
                let place = Affine3A::from_scale_rotation_translation(scale, turn, to);
                Placement::new("a test", place, 10.0, &Offset::NONE).unwrap()
            });
            let (around, reach) = match &placement {
                Some(_) => (Vec3::ZERO, 6.0),
                None => (eye.as_vec3() + single(&mut random, 8.0), 12.0),
            };
            let corners: Vec<Vec3> = (0..60).map(|_| around + single(&mut random, reach)).collect();
            let triangles: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let rules = Rules { tolerance: 0.0, cosine: 0.9, least: 0.0, front: false };
            let surface = Surface::new(&corners, &triangles, &rules);
            let projector = Projector::new(&buffer, Viewpoint { origin: eye, limit: 0.01, room: Room::NONE });
            for (patch, _) in surface.indexed().filter(|(i, p)| p.next == i.after()) {
                let drawable = Drawable {
                    surface: &surface,
                    placement: placement.as_ref(),
                    patch,
                    id: 0,
                    number: crate::mesh::surface::PatchNumber::new(patch.get()),
                    links: &[],
                    block: Block { min: DVec3::ZERO, max: DVec3::ZERO },
                    normal: DVec3::X,
                    slab: (0.0, 0.0),
                    again: false,
                    alone: false,
                    turned: false,
                    faces_eye: true,
                    error: 0.0,
                };
                let mut out = SeenSides::default();
                let within = *buffer.window().pixels();
                vectorized!(simd => projector.project(simd, &drawable, within, &mut out));
                let place = |v: Vec3| {
                    let v = v.as_dvec3();
                    placement.as_ref().map_or(v, |p| p.affine.transform_point3(v)) - eye
                };
                deep += out.deep.len();
                for (i, (_, side)) in drawable.outline().enumerate() {
                    let Edges { x0, y0, x1, y1, wide, unsure, plain, .. } = out.groups[i / LANES].edges;
                    let i = i % LANES;
                    if plain >> i & 1 == 0 {
                        continue;
                    }
                    edges += 1;
                    let [from, to] = drawable.surface.ends(&side);
                    for (p, (x, y)) in [(from, (x0[i], y0[i])), (to, (x1[i], y1[i]))] {
                        let (u, v) = exact(&face, buffer.window().per_unit(), projector.first(), place(p));
                        let off = (f64::from(x) - u).abs().max((f64::from(y) - v).abs());
                        let within = if face.parallel || placement.is_some() { wide[i] } else { unsure[i] };
                        assert!(off <= f64::from(within), "{round}: {off} {within} {u} {v}");
                        assert!(within < 0.5, "{within}");
                    }
                }
            }
        }
        assert!(edges > 5000 && deep > 500, "{edges} {deep}");
    }
}
