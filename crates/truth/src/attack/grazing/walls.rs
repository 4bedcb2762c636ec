//! Occluders by chance, in all shapes that the library knows.

use std::sync::Arc;

use casca::{Aabb, Bounds, Error, Instance, ObjectDesc, Occluder, TriMesh};
use casca_scenes::world::Mesh;
use glam::{Affine3A, DAffine3, DVec3, Quat, Vec3};

use super::super::dice::{Dice, direction, turn};
use super::super::forms::{BASES, Form, Shelf, base, skew};
use super::super::solid::Solid;
use crate::numeric::attack::WALL_BOUNDS;

/// Names of shapes, as tallies have them.
pub const SHAPES: [&str; 12] = [
    "sphere",
    "box",
    "turned box",
    "polytope",
    "closed mesh",
    "open mesh",
    "instance",
    "mirrored instance",
    "slit",
    "T-junction",
    "sliver",
    "side of the view",
];

/// An occluder, and the solid that it truly is.
pub struct Wall {
    pub shape: usize,
    pub solid: Solid,
    pub bounds: Bounds,
    pub occluder: Occluder,
    pub text: String,
}

/// The corners and triangles of a mesh, and the mesh itself.
type Known = (Vec<Vec3>, Vec<[u32; 3]>, Arc<TriMesh>);

pub struct Meshes {
    shelf: Shelf,
    /// The known ones, and larger ones: a ball, and a curved sheet.
    all: Vec<Known>,
    pub speck: Arc<TriMesh>,
}

impl Meshes {
    pub fn new() -> Result<Self, Error> {
        let prepared = |(positions, triangles): (Vec<Vec3>, Vec<[u32; 3]>)| {
            let mesh = TriMesh::new(positions.clone(), triangles.clone())?;
            Ok((positions, triangles, Arc::new(mesh)))
        };
        let large = [Mesh::ball(2), sheet(6)].map(|mesh| (mesh.positions, mesh.triangles));
        let corners = vec![Vec3::X, Vec3::Y, Vec3::Z];
        Ok(Self {
            shelf: Shelf::new()?,
            all: (0..BASES).map(base).chain(large).map(prepared).collect::<Result<_, Error>>()?,
            speck: Arc::new(TriMesh::bounds_only(corners, vec![[0, 1, 2]])?),
        })
    }
}

/// An open sheet with hills.
fn sheet(n: u32) -> Mesh {
    Mesh::sheet(n, n, |j, i| {
        let [x, y] = [i, j].map(|k| k as f32 / n as f32 * 2.0 - 1.0);
        Vec3::new(x, y, 0.2 * (3.0 * x).sin() * (2.0 * y).cos())
    })
}

/// A vector with another coordinate along an axis.
fn with(mut p: Vec3, axis: usize, to: f32) -> Vec3 {
    p[axis] = to;
    p
}

/// A gap between 1e-7 and 1e-2.
fn gap(dice: &mut Dice) -> f32 {
    10f64.powf(-7.0 + 5.0 * dice.real()) as f32
}

impl Wall {
    fn of(form: &Form, shape: usize, meshes: &Meshes) -> Option<Self> {
        let (bounds, occluder) = form.shapes(&meshes.shelf).ok()?;
        let solid = Solid::new(form);
        let bounds = bounds.unwrap_or_else(|| {
            // Rounded outwards.
            let (min, max) = solid.extent;
            let room = WALL_BOUNDS * (solid.radius + min.abs().max(max.abs()).max_element());
            Aabb::new((min - room).as_vec3(), (max + room).as_vec3()).into()
        });
        Some(Self { shape, solid, bounds, occluder, text: format!("{form:?}") })
    }

    fn soup(shape: usize, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Option<Self> {
        let solid = Solid::mesh(&positions, &triangles, DAffine3::IDENTITY);
        let text = format!("a mesh of {positions:?} and {triangles:?}");
        let mesh = Arc::new(TriMesh::new(positions, triangles).ok()?);
        Some(Self { shape, solid, bounds: mesh.clone().into(), occluder: mesh.into(), text })
    }

    pub fn describe(&self, dynamic: bool, layers: u64) -> ObjectDesc {
        let bounds = self.bounds.clone();
        let desc = if dynamic { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        desc.occluder(self.occluder.clone()).layers(layers)
    }

    /// Occluders of one kind, about `size` large: one, or several with gaps between them. `snap`
    /// rounds coordinates.
    pub fn some(
        dice: &mut Dice,
        meshes: &Meshes,
        center: Vec3,
        size: f32,
        snap: impl Fn(Vec3) -> Vec3,
    ) -> Vec<Self> {
        let mut side = || size * 10f32.powf(dice.between(-0.7, 0.0));
        let half = Vec3::new(side(), side(), side());
        let block = |min: Vec3, max: Vec3| Form::Block { min: snap(min), max: snap(max) };
        let one = |form: Form, shape: usize| Self::of(&form, shape, meshes).into_iter().collect::<Vec<_>>();
        match dice.below(24) {
            0..=2 => one(Form::Ball { center, radius: size }, 0),
            3..=6 => one(block(center - half, center + half), 1),
            7 | 8 => one(Form::Turned { center, half, turn: turn(dice) }, 2),
            9 => {
                let cuts = (0..1 + dice.below(4))
                    .map(|_| (direction(dice), dice.between(0.2, 0.9) * half.min_element()))
                    .collect();
                one(Form::Cut { min: center - half, max: center + half, cuts, by: DVec3::ZERO }, 3)
            }
            10 => {
                let points = (0..5 + dice.below(6)).map(|_| center + direction(dice) * half).collect();
                one(Form::Hull { points, by: DVec3::ZERO }, 3)
            }
            11 | 12 => one(Form::Mesh { base: dice.below(4) as u8, center, scale: half }, 4),
            13 | 14 => one(Form::Mesh { base: 4 + dice.below(3) as u8, center, scale: half }, 5),
            15..=18 => {
                let mirrored = dice.once_in(2);
                let signs = if mirrored { Vec3::new(1.0, -1.0, 1.0) } else { Vec3::ONE };
                let matrix = skew(turn(dice), half * signs, dice.pick(&[0.0, 0.0, 0.5]));
                let transform = Affine3A::from_mat3_translation(matrix, center);
                let shape = if mirrored { 7 } else { 6 };
                let base = dice.below(u32::from(BASES)) as u8;
                let known = match dice.below(3) {
                    0 => usize::from(BASES) + dice.below(2) as usize,
                    1 => usize::from(base),
                    _ => return one(Form::Placed { base, transform }, shape),
                };
                let (positions, triangles, mesh) = &meshes.all[known];
                Self::placed(positions, triangles, mesh, transform, shape)
            }
            19..=21 => Self::slit(dice, meshes, center, half, snap),
            22 => Self::junction(dice, center, half),
            _ => Self::sliver(dice, center, half),
        }
    }

    fn placed(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        mesh: &Arc<TriMesh>,
        transform: Affine3A,
        shape: usize,
    ) -> Vec<Self> {
        // As renderers transform them: in single precision.
        let moved: Vec<Vec3> = positions.iter().map(|p| transform.transform_point3(*p)).collect();
        let solid = Solid::mesh(&moved, triangles, DAffine3::IDENTITY);
        let instance = Instance::new(mesh.clone(), transform).ok();
        let made = instance.map(|instance| Self {
            shape,
            solid,
            bounds: instance.clone().into(),
            occluder: instance.into(),
            text: format!("a mesh of {} triangles under {transform:?}", triangles.len()),
        });
        made.into_iter().collect()
    }

    /// Two occluders with a gap between them, or none.
    fn slit(
        dice: &mut Dice,
        meshes: &Meshes,
        center: Vec3,
        half: Vec3,
        snap: impl Fn(Vec3) -> Vec3,
    ) -> Vec<Self> {
        let axis = dice.below(3) as usize;
        let wide = if dice.once_in(4) { 0.0 } else { gap(dice) * dice.pick(&[1.0, half.max_element()]) };
        let (center, half) = (snap(center), snap(half).max(half * 0.5));
        let (mut low, mut high) = (center, center);
        (low[axis], high[axis]) = (center[axis] - half[axis], center[axis] + half[axis]);
        let beside = with(half, axis, 0.0);
        let end = center[axis] + wide;
        let left = Form::Block { min: low - beside, max: center + beside };
        let right = match dice.below(3) {
            // A round one beside a flat one.
            0 => Form::Ball {
                center: with(center, axis, end + half[axis]),
                radius: half[axis].min(half.max_element()),
            },
            1 => Form::Placed {
                base: 0,
                transform: Affine3A::from_scale_rotation_translation(
                    with(half, axis, half[axis] * 0.5),
                    Quat::IDENTITY,
                    with(center, axis, end + half[axis] * 0.5),
                ),
            },
            _ => Form::Block { min: with(center, axis, end) - beside, max: high + beside },
        };
        [left, right].iter().filter_map(|form| Self::of(form, 8, meshes)).collect()
    }

    /// A mesh of triangles that share no vertices along a line, with a crack between them.
    fn junction(dice: &mut Dice, center: Vec3, half: Vec3) -> Vec<Self> {
        let wide = if dice.once_in(4) { 0.0 } else { gap(dice) * half.x };
        let turn = turn(dice);
        let place = |x: f32, y: f32, z: f32| center + turn * (Vec3::new(x, y, z) * half);
        let middle = dice.between(-0.9, 0.9);
        let positions = vec![
            place(-1.0, 0.0, 0.0),
            place(1.0, 0.0, 0.0),
            place(0.0, 1.0, 0.1),
            // The side below has one vertex more, which lies off the line.
            center + turn * (Vec3::new(middle, 0.0, 0.0) * half - Vec3::Y * wide),
            place(0.0, -1.0, -0.1),
        ];
        let triangles = vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]];
        Self::soup(9, positions, triangles).into_iter().collect()
    }

    /// Long thin triangles beside each other.
    fn sliver(dice: &mut Dice, center: Vec3, half: Vec3) -> Vec<Self> {
        let turn = turn(dice);
        let thin = gap(dice).max(1e-5);
        let mut positions = vec![center + turn * (Vec3::new(-1.0, 0.0, 0.0) * half)];
        let mut y = -0.5;
        for _ in 0..6 {
            positions.push(center + turn * (Vec3::new(1.0, y, dice.between(-0.2, 0.2)) * half));
            y += dice.pick(&[thin, 0.2, 0.4]);
        }
        let triangles = (1..6).map(|i| [0, i, i + 1]).collect();
        Self::soup(10, positions, triangles).into_iter().collect()
    }
}

/// Boxes and balls that fill cells, for [`casca::Method::Cell`]: `cell` is the edge of a cell of a
/// grid that begins at `min`.
pub fn thick(dice: &mut Dice, meshes: &Meshes, center: Vec3, size: f32, cell: f32, begin: Vec3) -> Vec<Wall> {
    let to_cells = |p: Vec3| begin + ((p - begin) / cell).round() * cell;
    let mut side = || (size * dice.between(0.5, 1.5)).max(cell);
    let half = Vec3::new(side(), side(), side());
    let (mut min, mut max) = (to_cells(center - half), to_cells(center + half));
    if dice.once_in(3) {
        let room = gap(dice) * cell * dice.pick(&[1.0, -1.0]);
        (min, max) = (min - room, max + room);
    }
    let form = match dice.below(6) {
        0 => Form::Ball { center, radius: half.max_element() },
        1 => Form::Turned { center, half, turn: turn(dice) },
        2 => Form::Mesh { base: 0, center: (min + max) * 0.5, scale: (max - min) * 0.5 },
        _ => Form::Block { min, max },
    };
    let shape = match form {
        Form::Ball { .. } => 0,
        Form::Turned { .. } => 2,
        Form::Mesh { .. } => 4,
        _ => 1,
    };
    let mut walls: Vec<Wall> = Wall::of(&form, shape, meshes).into_iter().collect();
    // A neighbour that abuts.
    if matches!(form, Form::Block { .. }) && dice.once_in(3) {
        let axis = dice.below(3) as usize;
        let wide = max[axis] - min[axis];
        let by = Vec3::AXES[axis] * (wide + if dice.once_in(3) { gap(dice) * cell } else { 0.0 });
        walls.extend(Wall::of(&Form::Block { min: min + by, max: max + by }, 8, meshes));
    }
    walls
}
