//! One disc, and the discs of a whole cloud.

use super::fan::SECTORS;
use crate::numeric::BOX;
use glam::{DVec3, Vec3A};
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{BvhBuildParams, aabb::Aabb, ray::Ray};
use std::time::Duration;

/// The discs of a cloud: one for each of its places.
#[derive(Clone)]
pub(super) struct Discs {
    /// In the order of the tree, whose indices of primitives are left out.
    pub discs: Vec<Packed>,
    pub tree: Bvh2,
    /// The disc of each point.
    pub disc_of: Vec<u32>,
    pub margins: Margins,
    pub frame: Frame,
    /// Whether points of no surface are visible where nothing hides them.
    pub show_strays: bool,
}

/// Most discs of a leaf of the tree, and the cost of a step from node to node in tests of discs: the
/// larger, the smaller the tree: 3 bytes a disc, where 16 and 8 make it 6.
const LEAF: u32 = 32;
const VISIT: f32 = 16.0;

/// Where the cloud lies: it is moved and scaled into the cube from -1 to 1, so that nothing over-
/// or underflows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub middle: DVec3,
    pub scale: f64,
}

/// Lengths in spacings, which grow with the noise of the points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins {
    /// How far from a plane its points may be.
    pub inlier: f32,
    /// How far from a plane neighbours of the same part of the surface may be.
    pub layer: f32,
    /// How far behind a disc a point may be and not be hidden by it.
    pub behind: f32,
    /// The least distance between the two sides of a plate.
    pub plate: f32,
    /// The least distance of a point between the two sides of a plate from each.
    pub between: f32,
    /// The least spacing by which these are taken but the last: that of noise.
    pub grain: f32,
}

/// A piece of the estimated surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    pub at: Vec3A,
    /// Of length 1; zero if the point has too few neighbours, so that it hides nothing.
    pub normal: Vec3A,
    /// The side of the square of surface that the point stands for.
    pub spacing: f32,
    /// How far the neighbours of the plane are from it: the root of the mean square.
    pub rough: f32,
    /// The sign of the normal tells front and back.
    pub oriented: bool,
    /// It is on the rim of a plate: nobody sees it from behind.
    pub solid: bool,
    /// It is on no surface.
    pub stray: bool,
    /// How far the disc reaches in each of the directions in which sectors begin, in parts of its
    /// spacing: see [`Disc::reach`].
    pub reach: [u8; SECTORS],
}

/// A disc as it is kept.
#[derive(Clone, Copy)]
pub(super) struct Packed {
    pub at: [f32; 3],
    normal: [i16; 2],
    /// The upper halves of the floats for the spacing and how rough it is, and flags in the place
    /// of their signs: the first for oriented, the second for solid, both for stray.
    lengths: [u16; 2],
    reach: [u8; SECTORS],
}

/// The parts of a spacing in which the reach of a disc is counted: few discs reach beyond 2.5.
const PARTS: f32 = 100.0;

/// The edge of the cube from -8 to 8 in which rays start: what they round is a part of it.
const ACROSS_CUBE: f32 = 16.0;

/// A length by its packed half, without the flag.
fn length(half: u16) -> f32 {
    f32::from_bits(u32::from(half) << 17 >> 1)
}

/// The largest coordinate of a packed normal, and what stands for none.
const LARGEST: f32 = i16::MAX as f32;
const NO_NORMAL: [i16; 2] = [i16::MIN; 2];

/// A normal as a place on the octahedron unfolded into a square (Meyer et al. 2010, "On
/// Floating-Point Normal Vectors").
fn packed(normal: Vec3A) -> [i16; 2] {
    if normal == Vec3A::ZERO {
        return NO_NORMAL;
    }
    let [x, y, z] = (normal / normal.abs().element_sum()).to_array();
    let fold = |x: f32, y: f32| if z < 0.0 { (1.0 - y.abs()).copysign(x) } else { x };
    [fold(x, y), fold(y, x)].map(|x| (x * LARGEST).round() as i16)
}

#[inline]
fn unpacked(normal: [i16; 2]) -> Vec3A {
    if normal == NO_NORMAL {
        return Vec3A::ZERO;
    }
    let [x, y] = normal.map(|x| f32::from(x) / LARGEST);
    let z = 1.0 - x.abs() - y.abs();
    let under = (-z).max(0.0);
    Vec3A::new(x - under.copysign(x), y - under.copysign(y), z).normalize()
}

/// A normal as it is after it was packed.
pub(super) fn rounded(normal: Vec3A) -> Vec3A {
    unpacked(packed(normal))
}

impl Packed {
    /// Whether a ray that starts within the cube from -8 to 8 may meet it: most in a leaf are too far away.
    #[inline]
    pub(super) fn is_near(&self, ray: &Ray) -> bool {
        let most = f32::from(u8::MAX) / PARTS * length(self.lengths[0]) + ACROSS_CUBE * BOX;
        let across = (Vec3A::from(self.at) - ray.origin).cross(ray.direction);
        across.length_squared() <= most * most * ray.direction.length_squared()
    }

    #[inline]
    pub(super) fn disc(&self) -> Disc {
        let [a, b] = self.lengths.map(|half| half >> 15 != 0);
        let [spacing, rough] = self.lengths.map(length);
        let (at, normal, reach) = (self.at.into(), unpacked(self.normal), self.reach);
        Disc { at, normal, spacing, rough, oriented: a && !b, solid: b && !a, stray: a && b, reach }
    }
}

/// The tree of some discs, which come into its order, and the places where they were.
pub(super) fn tree(discs: &mut Vec<Packed>) -> (Bvh2, Vec<u32>) {
    let bounds: Vec<Aabb> = discs.iter().map(|disc| disc.disc().bounds()).collect();
    let leaves = BvhBuildParams {
        max_prims_per_leaf: LEAF,
        collapse_traversal_cost: VISIT,
        ..BvhBuildParams::fast_build()
    };
    let mut tree = build_bvh2(&bounds, leaves, &mut Duration::default());
    tree.parents = Vec::new();
    let indices = std::mem::take(&mut tree.primitive_indices);
    // Depth first, so that neighbours are close in it.
    let (mut order, mut left) = (Vec::with_capacity(discs.len()), vec![0]);
    while let Some(node) = left.pop().and_then(|node: usize| tree.nodes.get_mut(node)) {
        let (first, count) = (node.first_index as usize, node.prim_count as usize);
        if count == 0 {
            left.extend([first + 1, first]);
        } else {
            node.first_index = order.len() as u32;
            order.extend(&indices[first..first + count]);
        }
    }
    *discs = order.iter().map(|&i| discs[i as usize]).collect();
    (tree, order)
}

impl Disc {
    /// Sets how far it reaches, once it has a spacing.
    pub(super) fn pack(&self, reach: [f32; SECTORS]) -> Packed {
        // Rounded to nearest.
        let half = |x: f32, flag: bool| ((x.to_bits() + (1 << 15)) >> 16) as u16 | u16::from(flag) << 15;
        let (a, b) = (self.oriented || self.stray, self.solid || self.stray);
        let mut packed = Packed {
            at: self.at.into(),
            normal: packed(self.normal),
            lengths: [half(self.spacing, a), half(self.rough, b)],
            reach: self.reach,
        };
        let unit = packed.disc().spacing / PARTS;
        packed.reach = reach.map(|reach| (reach / unit).round() as u8);
        packed
    }

    /// How far it reaches in the direction in which a sector begins.
    #[inline]
    pub(super) fn reach(&self, sector: usize) -> f32 {
        f32::from(self.reach[sector]) * (self.spacing / PARTS)
    }

    fn bounds(&self) -> Aabb {
        let reach = (0..SECTORS).map(|k| self.reach(k)).fold(0.0, f32::max);
        let sine2 = (Vec3A::ONE - self.normal * self.normal).max(Vec3A::ZERO);
        let half = Vec3A::new(sine2.x.sqrt(), sine2.y.sqrt(), sine2.z.sqrt()) * reach
            + BOX * (reach + self.at.abs());
        Aabb { min: self.at - half, max: self.at + half }
    }
}
