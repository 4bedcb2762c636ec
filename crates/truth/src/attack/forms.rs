//! Solids in single precision, as an application describes them, and the shapes of the library made
//! of them.

use std::sync::Arc;

use casca::{Aabb, Bounds, Convex, Error, Instance, Obb, Occluder, Plane, Sphere, TriMesh};
use casca_scenes::world::Mesh;
use glam::{Affine3A, DVec3, Mat3, Quat, Vec3, Vec3A};

use crate::numeric::attack::LEAST_FORM;

/// A solid, or a surface of triangles. A `Block` lies along the axes, a `Cut` is one with pieces cut
/// off: cuts are outward normals, and how far from the middle they are, in lengths of the normal
/// squared. `by` is how far a cut box or a hull was moved since. A `Mesh` is one of the known meshes
/// in world space, `Placed` is one under a transform.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    Ball { center: Vec3, radius: f32 },
    Block { min: Vec3, max: Vec3 },
    Turned { center: Vec3, half: Vec3, turn: Quat },
    Cut { min: Vec3, max: Vec3, cuts: Vec<(Vec3, f32)>, by: DVec3 },
    Hull { points: Vec<Vec3>, by: DVec3 },
    Mesh { base: u8, center: Vec3, scale: Vec3 },
    Placed { base: u8, transform: Affine3A },
}

/// How many meshes are known.
pub const BASES: u8 = 8;

/// How many of them, the first ones, are closed.
pub const CLOSED_BASES: u8 = 4;

/// Positions within -1 to 1, and triangles.
pub fn base(which: u8) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let Mesh { positions: cube, triangles: sides, .. } = Mesh::cuboid(Vec3::NEG_ONE, Vec3::ONE);
    match which % BASES {
        0 => (cube, sides),
        1 => {
            let corners = [(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)];
            let corners =
                corners.map(|(x, y, z): (i8, i8, i8)| Vec3::new(f32::from(x), f32::from(y), f32::from(z)));
            (corners.to_vec(), vec![[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]])
        }
        2 => {
            let tips = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            let faces =
                vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
            (tips, faces)
        }
        3 => {
            // A prism over an L: not convex.
            let outline = [(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (-1.0, 1.0)];
            let ring = |z: f32| outline.iter().map(move |&(x, y)| Vec3::new(x, y, z));
            let mut faces = Vec::new();
            for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
                faces.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
            }
            for i in 0..6 {
                let j = (i + 1) % 6;
                faces.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
            }
            (ring(-1.0).chain(ring(1.0)).collect(), faces)
        }
        4 => {
            let flat = cube.iter().take(4).map(|p| p.with_z(0.0)).collect();
            (flat, vec![[0, 1, 3], [0, 3, 2]])
        }
        5 => (cube, sides[..10].to_vec()),
        6 => (vec![Vec3::NEG_X, Vec3::X, Vec3::Y], vec![[0, 1, 2]]),
        _ => {
            // Two triangles as far apart as they can be: bricks between them are empty.
            let corner =
                |at: f32| [Vec3::splat(at), Vec3::new(at, at, 0.9 * at), Vec3::new(at, 0.9 * at, at)];
            (corner(-1.0).into_iter().chain(corner(1.0)).collect(), vec![[0, 1, 2], [3, 4, 5]])
        }
    }
}

/// The known meshes, prepared.
pub struct Shelf {
    meshes: Vec<Arc<TriMesh>>,
}

impl Shelf {
    pub fn new() -> Result<Self, Error> {
        let prepare = |which| {
            let (positions, triangles) = base(which);
            TriMesh::new(positions, triangles).map(Arc::new)
        };
        Ok(Self { meshes: (0..BASES).map(prepare).collect::<Result<_, _>>()? })
    }
}

impl Form {
    pub fn center(&self) -> Vec3 {
        match self {
            Self::Ball { center, .. } | Self::Turned { center, .. } | Self::Mesh { center, .. } => *center,
            Self::Block { min, max } => *min + (*max - *min) * 0.5,
            Self::Cut { min, max, by, .. } => (*min + *max) * 0.5 + by.as_vec3(),
            Self::Hull { points, by } => points.iter().sum::<Vec3>() / points.len() as f32 + by.as_vec3(),
            Self::Placed { transform, .. } => transform.translation.into(),
        }
    }

    /// The form as the library moves it by an offset: coordinates are rounded, or kept in double
    /// precision where the library keeps them.
    #[must_use]
    pub fn translated(&self, offset: Vec3) -> Self {
        let mut form = self.clone();
        match &mut form {
            Self::Ball { center, .. } | Self::Turned { center, .. } | Self::Mesh { center, .. } => {
                *center += offset;
            }
            Self::Block { min, max } => (*min, *max) = (*min + offset, *max + offset),
            Self::Cut { by, .. } | Self::Hull { by, .. } => *by += offset.as_dvec3(),
            Self::Placed { transform, .. } => transform.translation += Vec3A::from(offset),
        }
        form
    }

    /// The form as an application moves it: all in single precision.
    #[must_use]
    pub fn moved(&self, offset: Vec3) -> Self {
        let mut form = self.translated(offset);
        if let Self::Cut { by, .. } | Self::Hull { by, .. } = &mut form {
            *by = by.as_vec3().as_dvec3();
        }
        form
    }

    /// The half-spaces of a cut box before it was moved.
    pub fn planes(min: Vec3, max: Vec3, cuts: &[(Vec3, f32)]) -> Vec<Plane> {
        let mut planes: Vec<Plane> = Vec::new();
        for axis in Vec3::AXES {
            planes.push(Plane { normal: axis, offset: -axis.dot(min) });
            planes.push(Plane { normal: -axis, offset: axis.dot(max) });
        }
        let middle = (min + max) * 0.5;
        let cut = |&(n, h): &(Vec3, f32)| Plane { normal: -n, offset: n.dot(middle + n * h) };
        planes.extend(cuts.iter().map(cut));
        planes
    }

    /// Positions of a mesh in world space.
    pub fn positions(base: &[Vec3], center: Vec3, scale: Vec3) -> Vec<Vec3> {
        base.iter().map(|&p| center + p * scale).collect()
    }

    /// As bounds, and as an occluder; bounds are `None` where the library has no such bounds.
    pub fn shapes(&self, shelf: &Shelf) -> Result<(Option<Bounds>, Occluder), Error> {
        Ok(match self {
            Self::Ball { center, radius } => {
                let ball = Sphere::new(*center, *radius);
                (Some(ball.into()), ball.into())
            }
            Self::Block { min, max } => {
                let block = Aabb::new(*min, *max);
                (Some(block.into()), block.into())
            }
            Self::Turned { center, half, turn } => {
                let turned = Obb::new(*center, *half, *turn);
                (Some(turned.into()), turned.into())
            }
            Self::Cut { min, max, cuts, by } => {
                let solid = Convex::from_planes(&Self::planes(*min, *max, cuts))?;
                (None, Arc::new(solid.translated(by.as_vec3())?).into())
            }
            Self::Hull { points, by } => {
                let solid = Convex::from_points(points)?;
                (None, Arc::new(solid.translated(by.as_vec3())?).into())
            }
            Self::Mesh { base: which, center, scale } => {
                let (positions, triangles) = base(*which);
                let positions = Self::positions(&positions, *center, *scale);
                let mesh = Arc::new(TriMesh::new(positions, triangles)?);
                (Some(mesh.clone().into()), mesh.into())
            }
            Self::Placed { base, transform } => {
                let mesh = shelf.meshes[usize::from(base % BASES)].clone();
                let instance = Instance::new(mesh, *transform)?;
                (Some(instance.clone().into()), instance.into())
            }
        })
    }

    /// A middle, and half the edges of a box along the axes that lies well inside a solid.
    pub fn room(&self) -> Option<(Vec3, Vec3)> {
        // Below the root of a third and below 1, so that roundings of single precision do no harm.
        const IN_BALL: f32 = 0.55;
        const IN_BOX: f32 = 0.95;
        let (center, half) = match self {
            Self::Ball { center, radius } => (*center, Vec3::splat(*radius * IN_BALL)),
            Self::Block { min, max } => (self.center(), (*max - *min) * 0.5 * IN_BOX),
            Self::Turned { center, half, .. } => (*center, Vec3::splat(half.min_element() * IN_BALL)),
            _ => return None,
        };
        let least = (LEAST_FORM * center.abs().max_element()).max(0.02);
        (half.min_element() >= least).then_some((center, half))
    }
}

/// A matrix that turns, and scales, shears or mirrors.
pub fn skew(turn: Quat, scale: Vec3, shear: f32) -> Mat3 {
    let slanted = Mat3::from_cols(Vec3::X, Vec3::new(shear, 1.0, 0.0), Vec3::new(0.0, -shear, 1.0));
    Mat3::from_quat(turn) * slanted * Mat3::from_diagonal(scale)
}
