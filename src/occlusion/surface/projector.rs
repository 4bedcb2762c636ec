//! Sides of patches projected to the pixels of a face, eight at a time in single precision.

use glam::{DMat3, DVec3, Vec3};

use crate::numeric::occlusion::{EDGE, FAR_PIXEL, FARTHEST_PIXEL, PLACED, PROJECTED, REACH_ROOM, SLACK_ROOM};
use crate::numeric::{greater, lesser};
use crate::occlusion::face::Face;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::{PixelRect, floor};
use crate::occlusion::surface::deep::DeepSides;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::raster::{Edges, LANES, Lanes, each};
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
    /// How far the eye may go from the origin.
    reach: f64,
}

/// How the points of a drawable come to the face.
struct Frame {
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
struct Placed {
    from: [Lanes; 3],
    to: [Lanes; 3],
    slack: Lanes,
    /// Whether all coordinates are finite, as a sum of zeros.
    zero: Lanes,
    /// Which edges may be drawn as they are.
    plain: [bool; LANES],
}

/// A rectangle around points, lane by lane.
struct Extent {
    least: [Lanes; 2],
    most: [Lanes; 2],
    /// The greatest width of an edge, and whether that is known of all of them.
    wide: Lanes,
    known: [bool; LANES],
}

impl Extent {
    const EMPTY: Self = Self {
        least: [[f32::INFINITY; LANES]; 2],
        most: [[f32::NEG_INFINITY; LANES]; 2],
        wide: [0.0; LANES],
        known: [true; LANES],
    };
}

impl Frame {
    /// Moves points to the face, given by their coordinates.
    #[inline(always)]
    fn turn(&self, points: &[Lanes; 3]) -> [Lanes; 3] {
        let (eye, rest, at) = (self.eye.0.to_array(), self.eye.1.to_array(), self.at.to_array());
        let off = |axis: usize| -> Lanes { each(|i| points[axis][i] - eye[axis] - rest[axis]) };
        let (x, y, z) = (off(0), off(1), off(2));
        let turned = |axis: usize| {
            let (row, at) = (self.rows[axis], at[axis]);
            each(|i| row.x * x[i] + row.y * y[i] + row.z * z[i] + at)
        };
        [turned(0), turned(1), turned(2)]
    }
}

impl Projector {
    pub(crate) fn new(buffer: &FaceBuffer, viewpoint: Viewpoint) -> Self {
        let Viewpoint { origin, limit, reach } = viewpoint;
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
            reach,
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
        (self.reach > 0.0).then(|| Rims { sides: self.deep_sides(), reach: self.reach })
    }

    /// How the points of a drawable come to the face. Parallel rays have the depth 1 everywhere,
    /// and lengths in units of the face.
    #[inline(always)]
    fn frame(&self, d: &Drawable) -> Frame {
        let origin = self.origin;
        let Face { right, up, forward, parallel } = self.face;
        let axes = DMat3::from_cols(right, up, if parallel { DVec3::ZERO } else { forward }).transpose();
        let depth = if parallel { DVec3::Z } else { DVec3::ZERO };
        let whole = &d.surface.patches[0];
        let unit = if parallel { right.length() } else { 1.0 };
        let frame = |eye: (Vec3, Vec3), turn: DMat3, at: DVec3, growth: f64, error: f64| {
            let rows = turn.transpose();
            Frame {
                eye,
                rows: [rows.x_axis.as_vec3(), rows.y_axis.as_vec3(), rows.z_axis.as_vec3()],
                at: at.as_vec3(),
                growth: (growth * unit) as f32,
                error: ((d.error + error) * unit) as f32,
            }
        };
        let reach = whole.min.abs().max(whole.max.abs()).as_dvec3();
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
    pub(super) fn project(&self, d: &Drawable, within: PixelRect, out: &mut SeenSides) -> Option<PixelRect> {
        let frame = self.frame(d);
        let mut extent = Extent::EMPTY;
        let (mut ends, mut finite) = (Ends::default(), true);
        let mut outline = d.outline();
        while outline.len() > 0 {
            let (mut twins, mut opposite, mut count) = ([NO_TWIN; LANES], 0, 0);
            for (number, side) in outline.by_ref().take(LANES) {
                ends.set(count, side.from, side.to, side.slack);
                if let Some((twin, turned)) = d.beyond(number, side) {
                    twins[count] = twin;
                    opposite |= u8::from(turned) << count;
                }
                count += 1;
            }
            // The rest repeats the first.
            for lane in count..LANES {
                ends.copy(0, lane);
            }
            let placed = self.place(&frame, &ends);
            let mut edges = self.edges(&placed, &mut extent);
            finite &= placed.zero.iter().sum::<f32>() == 0.0;
            let used = (0xff_u32 >> (LANES - count)) as u8;
            let deep = !edges.plain & used;
            edges.plain &= used;
            if deep != 0 {
                let group = out.groups.len() as u32;
                for lane in (0..LANES).filter(|lane| deep >> lane & 1 == 1) {
                    out.deep.push(whole_side(&placed, &edges, group, lane));
                }
            }
            if self.reach > 0.0 {
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
    fn tighter(&self, extent: &Extent, within: PixelRect) -> Option<PixelRect> {
        if !extent.known.iter().all(|&known| known) {
            return Some(within);
        }
        let most = |lanes: &Lanes| f64::from(lanes.iter().copied().fold(f32::NEG_INFINITY, greater));
        let least = |lanes: &Lanes| f64::from(lanes.iter().copied().fold(f32::INFINITY, lesser));
        let wide = most(&extent.wide);
        let narrow = |(lo, hi): (i64, i64), axis: usize, first: i64| {
            let at = |v: f64| first + floor(v.clamp(-FARTHEST_PIXEL, FARTHEST_PIXEL));
            let (a, b) = (at(least(&extent.least[axis]) - wide), at(most(&extent.most[axis]) + wide));
            (lo.max(a), hi.min(b + 1))
        };
        let pixels = PixelRect { x: narrow(within.x, 0, self.first.0), y: narrow(within.y, 1, self.first.1) };
        (!pixels.is_empty()).then_some(pixels)
    }

    /// Moves points to the face.
    #[inline(always)]
    fn place(&self, f: &Frame, ends: &Ends) -> Placed {
        let (from, to) = (f.turn(&ends.from), f.turn(&ends.to));
        let slack: Lanes = each(|i| ends.slack[i] * f.growth + f.error);
        let zeros = |p: &[Lanes; 3], i: usize| (p[0][i] * 0.0 + p[1][i] * 0.0) + p[2][i] * 0.0;
        let zero = each(|i| slack[i] * 0.0 + (zeros(&from, i) + zeros(&to, i)));
        let plain = each(|i| {
            let (near, far) = (lesser(from[2][i], to[2][i]), greater(from[2][i], to[2][i]));
            // One width serves all of the edge, or there is no slack.
            let even = (slack[i] == 0.0) | ((far <= 2.0 * near) & (far > 2.0 * slack[i]));
            (near >= self.limit) & even
        });
        Placed { from, to, slack, zero, plain }
    }

    /// The edges in pixels. Those that leave the range of pixels are no longer plain.
    #[inline(always)]
    fn edges(&self, p: &Placed, extent: &mut Extent) -> Edges {
        let shift = self.middle.0.abs() + self.middle.1.abs();
        let (a, b): (Lanes, Lanes) = (each(|i| 1.0 / p.from[2][i]), each(|i| 1.0 / p.to[2][i]));
        let column = |p: &[Lanes; 3], inverse: &Lanes| -> Lanes {
            each(|i| p[0][i] * inverse[i] * self.per_unit + self.middle.0)
        };
        let row = |p: &[Lanes; 3], inverse: &Lanes| -> Lanes {
            each(|i| p[1][i] * inverse[i] * self.per_unit + self.middle.1)
        };
        let (x0, y0, x1, y1) = (column(&p.from, &a), row(&p.from, &a), column(&p.to, &b), row(&p.to, &b));
        let sum: Lanes = each(|i| (x0[i].abs() + y0[i].abs()) + (x1[i].abs() + y1[i].abs()));
        let unsure: Lanes = each(|i| EDGE as f32 + PROJECTED * (sum[i] + shift));
        // At depth z, points of the face move by at most slack (1 + |u|) / z, with |u| <= 1.
        let grow = SLACK_ROOM * self.per_unit;
        let wide: Lanes = each(|i| 2.0 * unsure[i] + p.slack[i] * greater(a[i], b[i]) * grow);
        // Also if it is not a number.
        let small: [bool; LANES] = each(|i| sum[i] < FAR_PIXEL);
        let plain: [bool; LANES] = each(|i| p.plain[i] & small[i] & (wide[i] < FAR_PIXEL));
        extent.least[0] = each(|i| lesser(lesser(x0[i], x1[i]), extent.least[0][i]));
        extent.least[1] = each(|i| lesser(lesser(y0[i], y1[i]), extent.least[1][i]));
        extent.most[0] = each(|i| greater(greater(x0[i], x1[i]), extent.most[0][i]));
        extent.most[1] = each(|i| greater(greater(y0[i], y1[i]), extent.most[1][i]));
        extent.wide = each(|i| greater(wide[i], extent.wide[i]));
        if self.reach > 0.0 {
            let room = REACH_ROOM * self.reach as f32 * self.per_unit;
            extent.wide = each(|i| greater(wide[i] + room * greater(a[i], b[i]), extent.wide[i]));
        }
        extent.known = each(|i| {
            let near = lesser(p.from[2][i], p.to[2][i]);
            extent.known[i] & (near >= 2.0 * self.limit + 2.0 * p.slack[i]) & small[i]
        });
        let plain = (0..LANES).fold(0, |bits, i| bits | u8::from(plain[i]) << i);
        Edges { x0, y0, x1, y1, wide, unsure, plain, seams: 0 }
    }
}

/// A side that is not drawn as one edge.
fn whole_side(p: &Placed, e: &Edges, group: u32, lane: usize) -> WholeSide {
    let at = |of: &[Lanes; 3]| DVec3::new(of[0][lane].into(), of[1][lane].into(), of[2][lane].into());
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
    use crate::geometry::placement::Placement;
    use crate::mesh::surface::{Rules, Surface};
    use crate::occlusion::face::Rect;
    use crate::random::Random;

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
        let mut random = Random(5);
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
                Placement::new("a test", Affine3A::from_scale_rotation_translation(scale, turn, to), 10.0)
                    .unwrap()
            });
            let (around, reach) = match &placement {
                Some(_) => (Vec3::ZERO, 6.0),
                None => (eye.as_vec3() + single(&mut random, 8.0), 12.0),
            };
            let corners: Vec<Vec3> = (0..60).map(|_| around + single(&mut random, reach)).collect();
            let triangles: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let rules = Rules { tolerance: 0.0, cosine: 0.9, least: 0.0, front: false };
            let surface = Surface::new(&corners, &triangles, &rules);
            let projector = Projector::new(&buffer, Viewpoint { origin: eye, limit: 0.01, reach: 0.0 });
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
                projector.project(&drawable, *buffer.window().pixels(), &mut out);
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
                    for (p, (x, y)) in [(side.from, (x0[i], y0[i])), (side.to, (x1[i], y1[i]))] {
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
