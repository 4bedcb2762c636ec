//! Sides of patches projected to the pixels of a face, eight at a time in single precision.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};
use glam::{DMat3, DVec3, Vec3};

use crate::geometry::Room;
use crate::mesh::surface::{Patch, PatchIndex};
use crate::numeric::occlusion::{EDGE, FAR_PIXEL, FARTHEST_PIXEL, PLACED, PROJECTED, REACH_ROOM, SLACK_ROOM};
use crate::occlusion::face::Face;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::{PixelRect, floor};
use crate::occlusion::surface::deep::DeepSides;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::raster::{EdgeVectors, LANES};
use crate::occlusion::surface::rim::Rims;
use crate::occlusion::surface::sides::{PlacedPoints, SeenSides, Sides, WholeSide};
use crate::occlusion::tiles::TILE;

/// How surfaces are seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Viewpoint {
    /// The origin of the rays.
    pub(crate) origin: DVec3,
    /// Surfaces are cut at this depth: nothing nearer is drawn.
    pub(crate) limit: f64,
    /// Where the eye may go, around the origin.
    pub(crate) room: Room,
}

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

/// A rectangle around points, lane by lane.
struct LaneRect<S: Simd> {
    least: [f32x8<S>; 2],
    most: [f32x8<S>; 2],
    /// The greatest width of an edge, and the lanes of which it is not known.
    wide: f32x8<S>,
    unknown: u8,
}

impl<S: Simd> LaneRect<S> {
    #[inline(always)]
    fn empty(simd: S) -> Self {
        Self {
            least: [f32x8::splat(simd, f32::INFINITY); 2],
            most: [f32x8::splat(simd, f32::NEG_INFINITY); 2],
            wide: f32x8::splat(simd, 0.0),
            unknown: 0,
        }
    }
}

impl FaceFrame {
    /// Moves eight points to the face, given by their coordinates.
    #[inline(always)]
    fn turn<S: Simd>(&self, simd: S, points: &[[f32; LANES + 1]; 3]) -> [f32x8<S>; 3] {
        let (eye, rest, at) = (self.eye.0.to_array(), self.eye.1.to_array(), self.at.to_array());
        let off = |axis: usize| f32x8::from_slice(simd, &points[axis][..LANES]) - eye[axis] - rest[axis];
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
        let &Patch { min, max, .. } = d.surface.patch(PatchIndex::FIRST);
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
        let (frame, first) = (self.frame(d), out.groups.len());
        gather(d, out);
        if !self.place(simd, &frame, &mut out.groups[first..], &mut out.placed) {
            return None;
        }
        let mut extent = LaneRect::empty(simd);
        for i in 0..out.placed.len() {
            self.edges(simd, (first, i), out, &mut extent);
        }
        self.tighter(&extent, within)
    }

    /// Moves points to the face and to its pixels. Returns whether all coordinates are finite.
    #[inline(always)]
    fn place<S: Simd>(
        &self,
        simd: S,
        frame: &FaceFrame,
        groups: &mut [Sides],
        placed: &mut [PlacedPoints],
    ) -> bool {
        let one = f32x8::splat(simd, 1.0);
        let mut zeros = f32x8::splat(simd, 0.0);
        for (sides, points) in groups.iter_mut().zip(placed.iter_mut()) {
            let [x, y, z] = frame.turn(simd, &points.at);
            let (inverse, slack) =
                (one / z, f32x8::from_slice(simd, &points.slack) * frame.growth + frame.error);
            zeros += slack * 0.0 + (x * 0.0 + y * 0.0 + z * 0.0);
            slack.store_slice(&mut points.slack);
            inverse.store_slice(&mut points.inverse[..LANES]);
            for (to, from) in points.at.iter_mut().zip([x, y, z]) {
                from.store_slice(&mut to[..LANES]);
            }
            (x * inverse * self.per_unit + self.middle.0).store_slice(&mut sides.x[..LANES]);
            (y * inverse * self.per_unit + self.middle.1).store_slice(&mut sides.y[..LANES]);
        }
        for i in 1..groups.len().min(placed.len()) {
            (groups[i - 1].x[LANES], groups[i - 1].y[LANES]) = (groups[i].x[0], groups[i].y[0]);
            placed[i - 1].inverse[LANES] = placed[i].inverse[0];
            for axis in 0..3 {
                placed[i - 1].at[axis][LANES] = placed[i].at[axis][0];
            }
        }
        zeros.simd_eq(0.0).to_bitmask() == 0xff
    }

    /// Finds the sides of eight points of a patch, as edges in pixels.
    #[inline(always)]
    fn edges<S: Simd>(
        &self,
        simd: S,
        (first, i): (usize, usize),
        out: &mut SeenSides,
        extent: &mut LaneRect<S>,
    ) {
        let load = |of: &[f32]| f32x8::from_slice(simd, of);
        let (sides, points) = (&mut out.groups[first + i], &out.placed[i]);
        let EdgeVectors { x0, y0, x1, y1, .. } = sides.edges(simd, 1.0);
        let (from, to) = (load(&points.at[2][..LANES]), load(&points.at[2][1..]));
        let inverse = load(&points.inverse[..LANES]).max(load(&points.inverse[1..]));
        let slack = load(&points.slack);
        let (near, far) = (from.min(to), from.max(to));
        // One width serves all of the edge, or there is no slack.
        let even = slack.simd_eq(0.0) | (far.simd_le(near * 2.0) & far.simd_gt(slack * 2.0));
        let shift = self.middle.0.abs() + self.middle.1.abs();
        let sum = (x0.abs() + y0.abs()) + (x1.abs() + y1.abs());
        let unsure = (sum + shift) * PROJECTED + EDGE as f32;
        // At depth z, points of the face move by at most slack (1 + |u|) / z, with |u| <= 1.
        let wide = unsure * 2.0 + slack * inverse * (SLACK_ROOM * self.per_unit);
        wide.store_slice(&mut sides.wide);
        unsure.store_slice(&mut sides.unsure);
        // Also if it is NaN.
        let small = sum.simd_lt(FAR_PIXEL);
        let plain = near.simd_ge(self.limit) & even & small & wide.simd_lt(FAR_PIXEL);
        let known = near.simd_ge(slack * 2.0 + 2.0 * self.limit) & small;
        sides.plain = plain.to_bitmask() as u8 & sides.begins;
        extent.unknown |= !(known.to_bitmask() as u8) & sides.begins;
        extent.least = [x0.min(extent.least[0]), y0.min(extent.least[1])];
        extent.most = [x0.max(extent.most[0]), y0.max(extent.most[1])];
        let has_room = self.room.radius() > 0.0;
        let room = if has_room { REACH_ROOM * self.room.radius() as f32 * self.per_unit } else { 0.0 };
        let bits = u32x8::from_slice(simd, &[1, 2, 4, 8, 16, 32, 64, 128]);
        let begins = (bits & u32x8::splat(simd, sides.begins.into())).simd_eq(bits);
        let widest = if has_room { wide + inverse * room } else { wide };
        extent.wide = begins.select(extent.wide.max(widest), extent.wide);
        if sides.plain != sides.begins || has_room {
            whole_sides((first + i) as u32, (sides, points), has_room, (&mut out.deep, &mut out.rims));
        }
    }

    /// The pixels of a rectangle within the extent of a patch, if that is known: where the patch is
    /// deep enough.
    #[inline(always)]
    fn tighter<S: Simd>(&self, extent: &LaneRect<S>, within: PixelRect) -> Option<PixelRect> {
        if extent.unknown != 0 {
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
}

/// Lists the points of an outline. The end of a side is the start of the next one mostly.
#[inline(always)]
fn gather(d: &Drawable, out: &mut SeenSides) {
    out.placed.clear();
    let (mut at, mut end, positions) = (0, None, &d.surface.positions);
    for (number, side) in d.outline() {
        let [from, to] = side.ends;
        if let Some(end) = end.filter(|&end| end != from) {
            out.push(at, positions[end as usize]);
            at += 1;
        }
        out.push(at, positions[from as usize]);
        out.begin(at, side.slack, d.beyond(number, &side));
        (at, end) = (at + 1, Some(to));
    }
    // The rest repeats the last one.
    let last = end.map_or(Vec3::ZERO, |end| positions[end as usize]);
    (at..at / LANES * LANES + LANES).for_each(|at| out.push(at, last));
}

/// Lists sides that are not drawn as one edge, and all of them if the eye may go some way.
#[cold]
fn whole_sides(
    group: u32,
    (sides, points): (&Sides, &PlacedPoints),
    has_room: bool,
    (deep, rims): (&mut Vec<WholeSide>, &mut Vec<WholeSide>),
) {
    for lane in (0..LANES).filter(|lane| sides.begins >> lane & 1 == 1) {
        let at = |i: usize| DVec3::from_array(points.at.map(|of| of[i].into()));
        let pixel = |i: usize| (sides.x[i].into(), sides.y[i].into());
        let side = WholeSide {
            group,
            lane: lane as u32,
            ends: [at(lane), at(lane + 1)],
            pixels: [pixel(lane), pixel(lane + 1)],
            slack: points.slack[lane].into(),
        };
        if sides.plain >> lane & 1 == 0 {
            deep.push(side.clone());
        }
        if has_room {
            rims.push(side);
        }
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
                let begin = |s: &Sides| (0..LANES).filter(|i| s.begins >> i & 1 == 1).collect::<Vec<_>>();
                let points = out.groups.iter().flat_map(|s| begin(s).into_iter().map(move |i| (s, i)));
                for ((Sides { x, y, wide, unsure, plain, .. }, i), (_, side)) in
                    points.zip(drawable.outline())
                {
                    if plain >> i & 1 == 0 {
                        continue;
                    }
                    edges += 1;
                    let [from, to] = drawable.surface.ends(&side);
                    for (p, (x, y)) in [(from, (x[i], y[i])), (to, (x[i + 1], y[i + 1]))] {
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
