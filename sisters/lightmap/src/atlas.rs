//! A second set of texture coordinates for each mesh, and a rectangle of an atlas for each of its places.

use casca_scenes::world::{Mesh, turn_of};
use glam::{Affine3A, DVec2, DVec3, UVec2, Vec2, Vec3};
use uvunwrap::{Atlas, Density, InstanceRect, MeshInput, Options, OutputMesh, generate};

use crate::BakeError;

/// Texels around each chart. What reads the light of a point by four texels needs one of them; Bevy's
/// bicubic filter needs two.
pub(crate) const PADDING: u32 = 2;
/// Texels of all pages: a gigabyte while they are lit.
const MOST_TEXELS: f64 = (1u64 << 25) as f64;
/// Samples stay this far inside of triangles, in texels: a point on an edge may lie in another wall.
const INSET: f64 = 1.0 / 16.0;
/// But no sample is moved beyond this share of its triangle's height.
const MOST_INSET: f64 = 0.25;
/// Triangles lower than this share of their mesh are not unwrapped: `uvunwrap` leaves out those of half of
/// that, whose coordinates single precision cannot tell apart, and takes no mesh of such ones only.
const LEAST_HEIGHT: f64 = 2e-6;
/// Half of a texel's diagonal: a point has a texel whose middle is no farther.
const NEAR: f64 = 0.71;

/// A mesh, and where it stands.
#[derive(Debug, Clone, Default)]
pub struct Placed {
    /// The mesh.
    pub mesh: Mesh,
    /// Object space to world space, once for each place.
    pub places: Vec<Affine3A>,
}

/// A texel that is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// Its number in the pages, row by row and page by page.
    pub number: u32,
    /// What it is lit at, in metres.
    pub point: Vec3,
    /// The unit normal of the front there.
    pub normal: Vec3,
}

/// The texels of an atlas that hold light.
#[derive(Debug, Clone, Default)]
pub struct Texels {
    /// Those that surfaces touch.
    pub lit: Vec<Texel>,
    /// Those around charts, and which of the former each repeats.
    pub repeated: Vec<(u32, u32)>,
}

/// The greatest scale along an axis.
fn scale_of(place: &Affine3A) -> f32 {
    let m = place.matrix3;
    [m.x_axis, m.y_axis, m.z_axis].into_iter().map(|axis| axis.length()).fold(0.0, f32::max)
}

/// Unwraps meshes, and finds a rectangle for each of their places: so many texels a metre, on pages with
/// sides of so many texels at most. Meshes without places or without area get nothing.
///
/// # Errors
/// There are too many texels, a mesh fits on no page, or a mesh or a place is not finite.
pub fn unwrap(placed: &[Placed], texels: f32, side: u32) -> Result<Atlas, BakeError> {
    let check = |needed: f64| {
        let fit = f64::from(texels) * (MOST_TEXELS / needed).sqrt() * 0.9;
        if needed <= MOST_TEXELS { Ok(()) } else { Err(BakeError::Texels(needed, MOST_TEXELS, fit)) }
    };
    // Before anything takes long.
    check(placed.iter().map(Placed::area).sum::<f64>() * f64::from(texels).powi(2))?;
    let arrays = placed.iter().map(|p| {
        let scales = p.places.iter().map(|place| scale_of(place).max(f32::MIN_POSITIVE));
        (p.mesh.positions.iter().map(|v| v.to_array()).collect(), scales.collect())
    });
    let arrays: Vec<(Vec<[f32; 3]>, Vec<f32>)> = arrays.collect();
    let inputs = placed.iter().zip(&arrays).map(|(p, (positions, scales))| {
        let is_none = scales.is_empty() || !p.can_be_unwrapped();
        let (indices, instance_scales) =
            if is_none { (&[][..], &[][..]) } else { (p.mesh.triangles.as_flattened(), &scales[..]) };
        MeshInput { instance_scales, ..MeshInput::new(positions, indices) }
    });
    let inputs: Vec<MeshInput> = inputs.collect();
    let unwrapped = |page_size| {
        let density = Density::Fixed { texels_per_unit: texels, page_size };
        let options = Options { density, padding: PADDING, ..Options::default() };
        generate(&inputs, &options).map_err(BakeError::Unwrap)
    };
    let mut found = unwrapped(None)?;
    if found.width.max(found.height) > side {
        found = unwrapped(Some(side))?;
    }
    check(f64::from(found.width) * f64::from(found.height) * f64::from(found.page_count))?;
    Ok(found)
}

/// Where a point of a rectangle lies in its page, in texels.
pub fn on_page(atlas: &Atlas, rect: &InstanceRect, uv: [f32; 2]) -> DVec2 {
    let [min, max, uv] = [rect.min, rect.max, uv].map(|p| Vec2::from_array(p).as_dvec2());
    (min + uv * (max - min)) * UVec2::new(atlas.width, atlas.height).as_dvec2()
}

/// The texels of an atlas that hold light, for the meshes that it was made of.
pub fn texels(atlas: &Atlas, placed: &[Placed]) -> Texels {
    let mut all = Texels::default();
    for (p, layout) in placed.iter().zip(&atlas.meshes) {
        for (at, rect) in p.places.iter().zip(&layout.instances) {
            texels_of(atlas, (&p.mesh, at), (layout, rect), &mut all);
        }
    }
    all
}

fn texels_of(
    atlas: &Atlas,
    (mesh, at): (&Mesh, &Affine3A),
    (layout, rect): (&OutputMesh, &InstanceRect),
    all: &mut Texels,
) {
    let size = UVec2::new(atlas.width, atlas.height);
    let reach = DVec2::splat(PADDING.into());
    let low = (on_page(atlas, rect, [0.0; 2]) - reach).floor().max(DVec2::ZERO).as_uvec2();
    let high = (on_page(atlas, rect, [1.0; 2]) + reach).ceil().as_uvec2().min(size);
    let local = |x: u32, y: u32| ((y - low.y) * (high.x - low.x) + x - low.x) as usize;
    // By texel of the rectangle: the square of the distance to the nearest triangle, and what is there.
    let area = (high - low).element_product();
    let mut nearest: Vec<Option<(f64, Vec3, Vec3, DVec2)>> = vec![None; area as usize];
    for (triangle, corners) in mesh.triangles.iter().zip(layout.indices.as_chunks::<3>().0) {
        let [a, b, c] = triangle.map(|v| at.transform_point3(mesh.positions[v as usize]).as_dvec3());
        let flat = corners.map(|v| on_page(atlas, rect, layout.vertices[v as usize].uv));
        let normal = (b - a).cross(c - a).try_normalize().filter(|n| n.is_finite());
        // The others are in no chart.
        let is_charted = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]) != 0.0;
        let Some(normal) = normal.filter(|_| is_charted) else { continue };
        let normal = if turn_of(at) < 0.0 { -normal } else { normal };
        let least = (flat[0].min(flat[1]).min(flat[2]) - reach).floor().max(low.as_dvec2());
        let most = (flat[0].max(flat[1]).max(flat[2]) + reach).ceil().min(high.as_dvec2());
        for y in least.y as u32..most.y as u32 {
            for x in least.x as u32..most.x as u32 {
                let middle = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let (shares, square) = nearest_of(flat, middle);
                let best = &mut nearest[local(x, y)];
                if best.is_none_or(|old| square < old.0) {
                    let within = inside(flat, shares);
                    let point = a * within.x + b * within.y + c * within.z;
                    let on = flat[0] * shares.x + flat[1] * shares.y + flat[2] * shares.z;
                    *best = Some((square, point.as_vec3(), normal.as_vec3(), on));
                }
            }
        }
    }
    let page = rect.page * size.x * size.y;
    for (x, y) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (x, y))) {
        let Some((square, point, normal, on)) = nearest[local(x, y)] else { continue };
        let number = page + y * size.x + x;
        if square <= NEAR * NEAR {
            all.lit.push(Texel { number, point, normal });
        } else {
            // The texel that holds the nearest point of the chart is lit.
            let [u, v] = on.clamp(low.as_dvec2(), high.as_dvec2() - 1.0).as_uvec2().to_array();
            all.repeated.push((number, page + v * size.x + u));
        }
    }
}

impl Placed {
    /// The corners of all triangles, in object space.
    fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        let at = |v: u32| self.mesh.positions.get(v as usize).map_or(DVec3::ZERO, |p| p.as_dvec3());
        self.mesh.triangles.iter().map(move |t| t.map(at))
    }

    /// The area in all places, in square metres.
    fn area(&self) -> f64 {
        let area: f64 = self.corners().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
        area * self.places.iter().map(|p| f64::from(scale_of(p)).powi(2)).sum::<f64>()
    }

    fn can_be_unwrapped(&self) -> bool {
        let (low, high) = self.mesh.bounds(&Affine3A::IDENTITY);
        let least = LEAST_HEIGHT * (high - low).as_dvec3().length();
        self.corners().any(|[a, b, c]| {
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let twice = (b - a).cross(c - a).length();
            // What is not finite is refused by name.
            twice.is_nan() || twice > least * longest
        })
    }
}

/// The barycentric coordinates of the point of a triangle that is nearest to another point, and the
/// square of its distance.
fn nearest_of([a, b, c]: [DVec2; 3], point: DVec2) -> (DVec3, f64) {
    let area = (b - a).perp_dot(c - a);
    let shares = DVec3::new((b - point).perp_dot(c - point), (c - point).perp_dot(a - point), 0.0) / area;
    let shares = shares.with_z(1.0 - shares.x - shares.y);
    // Not so where there is no area.
    if shares.cmpge(DVec3::ZERO).all() {
        return (shares, 0.0);
    }
    let on = |p: DVec2, q: DVec2, [i, j]: [usize; 2]| {
        let way = q - p;
        let t = ((point - p).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let mut shares = DVec3::ZERO;
        (shares[i], shares[j]) = (1.0 - t, t);
        (shares, point.distance_squared(p + way * t))
    };
    let edges = [on(a, b, [0, 1]), on(b, c, [1, 2]), on(c, a, [2, 0])];
    edges.into_iter().fold(edges[0], |best, edge| if edge.1 < best.1 { edge } else { best })
}

/// Barycentric coordinates of a point near by that is not on the edge: see [`INSET`].
fn inside([a, b, c]: [DVec2; 3], shares: DVec3) -> DVec3 {
    let area = (b - a).perp_dot(c - a).abs().max(f64::MIN_POSITIVE);
    let edges = DVec3::new(b.distance(c), c.distance(a), a.distance(b));
    let moved = shares.max((edges * (INSET / area)).min(DVec3::splat(MOST_INSET)));
    moved / moved.element_sum()
}
