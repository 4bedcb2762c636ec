//! The voxels of a lit scene: occupied cells of the library's soft grid, with the mean colour,
//! emission and normal of the surface in each.

use std::sync::Arc;

use casca::soft::{Layer, SoftGrid};
use casca::{GridSpec, TriMesh};
use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::experiments::LabError;
use casca_scenes::lit::{Incident, Light, LitScene, LitTriangle, Material};
use casca_scenes::world::Mesh;

/// Cells between the scene and the side of the grid. Not a whole number: walls along the axes would
/// lie on the sides of cells and fill two.
const MARGIN: f32 = 2.5;
/// Triangles are taken as points, so many to the edge of a cell.
const POINTS: f32 = 3.0;
/// Rays start so many cells off a surface: there no cell belongs to it if it is flat.
pub(super) const OFF: f32 = 1.8;
/// No voxel.
const NONE: u32 = u32::MAX;

/// The surface in a cell.
#[derive(Debug, Clone, Copy, Default)]
pub struct Voxel {
    /// Mean share of light that is reflected.
    pub albedo: Vec3,
    /// Mean radiance that is emitted.
    pub emission: Vec3,
    /// Mean normal of the one side; the surface has another side.
    pub normal: Vec3,
    /// Mean point, in world units; `None` where no surface is in the cell or beside it, such as
    /// deep in a solid. Such a voxel is black.
    pub point: Option<Vec3>,
}

/// Light, if the library refuses nothing.
pub(super) type Lit = Result<Vec3, casca::Error>;

/// Light of the two sides of each voxel: that which the normal points to, and the other.
pub type Sides = Vec<[Vec3; 2]>;

/// The voxels of a scene.
pub struct Voxels {
    /// Which cells are occupied.
    pub soft: SoftGrid,
    /// Cells along an axis.
    pub n: i32,
    /// Edge length of a cell.
    pub cell: f32,
    /// Least corner of the grid.
    pub min: Vec3,
    /// The surfaces, in the order of their cells.
    pub voxels: Vec<Voxel>,
    places: Vec<u32>,
}

/// Sums over the points in a cell.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: f32,
    /// That of surfaces that emit.
    emitting: f32,
    albedo: Vec3,
    emission: Vec3,
    normal: Vec3,
    point: Vec3,
}

impl Voxels {
    /// Voxels of a cube of `n` cells along each axis, 8 to 256. Triangles and values that the path
    /// tracer leaves out are left out.
    ///
    /// # Errors
    /// If `n` is out of range, or the library refuses the grid or a mesh.
    pub fn new(scene: &LitScene, n: u32) -> Result<Self, LabError> {
        if !(8..=256).contains(&n) {
            return Err(format!("{n} cells along an axis: there must be 8 to 256").into());
        }
        let (lo, hi) = scene.bounds();
        let cell = (hi - lo).max_element().max(1e-3) / (n as f32 - 2.0 * MARGIN);
        let min = (lo + hi) / 2.0 - cell * n as f32 / 2.0;
        let mut soft = SoftGrid::new(&GridSpec { min, cell, dims: UVec3::splat(n) })?;
        let triangles = scene.triangles();
        for object in triangles.chunk_by(|a, b| a.object == b.object) {
            let mesh = Mesh {
                positions: object.iter().flat_map(|t| t.corners).collect(),
                triangles: (0..object.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
                ..Mesh::default()
            };
            for part in parts(&mesh)? {
                soft.insert(Arc::new(part), Layer::Fixed)?;
            }
        }
        soft.rebuild();
        let n = n as i32;
        let mut made =
            Self { soft, n, cell, min, voxels: Vec::new(), places: vec![NONE; (n * n * n) as usize] };
        let materials: Vec<Material> = scene.materials.iter().map(Material::sound).collect();
        made.fill(&triangles, &materials);
        Ok(made)
    }

    /// A point in units of cells.
    pub fn to_cells(&self, point: Vec3) -> Vec3 {
        (point - self.min) / self.cell
    }

    fn place(&self, c: IVec3) -> Option<usize> {
        let inside = c.cmpge(IVec3::ZERO).all() && c.cmplt(IVec3::splat(self.n)).all();
        inside.then(|| ((c.z * self.n + c.y) * self.n + c.x) as usize)
    }

    /// The number of the voxel in a cell.
    pub fn at(&self, cell: IVec3) -> Option<usize> {
        self.place(cell).map(|i| self.places[i]).filter(|&v| v != NONE).map(|v| v as usize)
    }

    /// Gives every occupied cell a voxel. Sums are made in the order of triangles.
    fn fill(&mut self, triangles: &[LitTriangle], materials: &[Material]) {
        let mut sums = vec![Sums::default(); self.places.len()];
        for t in triangles {
            self.deposit(t, &materials[t.material as usize], &mut sums);
        }
        for (i, sum) in sums.iter().enumerate() {
            let n = self.n as usize;
            let cell = IVec3::new((i % n) as i32, (i / n % n) as i32, (i / n / n) as i32);
            if !self.soft.is_occupied(Layer::Fixed, cell) {
                continue;
            }
            // A cell that the surface only touches takes after its neighbours. Areas may be as good
            // as none, too.
            let mut all = *sum;
            if all.weight <= 0.0 {
                let around = (0..27).map(|k| cell + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
                around.filter_map(|c| self.place(c)).for_each(|p| all.merge(&sums[p]));
            }
            self.places[i] = self.voxels.len() as u32;
            self.voxels.push(all.mean(2.0 * self.cell * self.cell));
        }
    }

    /// Adds a triangle as points with equal shares of its area.
    fn deposit(&self, t: &LitTriangle, material: &Material, sums: &mut [Sums]) {
        let [a, b, c] = t.corners;
        let (ab, ac, cross) = (b - a, c - a, t.cross());
        let longest = ab.length().max(ac.length()).max((c - b).length());
        let m = ((longest / self.cell * POINTS).ceil().max(1.0) as u32).min(8 * self.n as u32);
        let weight = cross.length() / (m * m) as f32;
        for i in 0..m {
            // The triangle is cut into m² similar ones; every second one is turned.
            for j in 0..2 * (m - i) - 1 {
                let third = (1 + j % 2) as f32 / 3.0;
                let (u, v) = ((i as f32 + third) / m as f32, ((j / 2) as f32 + third) / m as f32);
                let point = a + ab * u + ac * v;
                if let Some(place) = self.place(self.to_cells(point).floor().as_ivec3()) {
                    sums[place].merge(&Sums {
                        weight,
                        emitting: if material.emits() { weight } else { 0.0 },
                        albedo: material.albedo * weight,
                        emission: material.emission * weight,
                        normal: cross.normalize_or_zero() * weight,
                        point: point * weight,
                    });
                }
            }
        }
    }

    /// The side of a voxel that a ray of some direction meets: 0 if it runs against the normal.
    pub fn side(&self, voxel: usize, direction: Vec3) -> usize {
        usize::from(self.voxels[voxel].normal.dot(direction) > 0.0)
    }

    /// The light that a function says leaves each side of each voxel with a surface, from its point
    /// and the normal of the side; the other voxels are black.
    pub fn sides(&self, of: impl Fn(&Voxel, Vec3, Vec3) -> Lit + Sync) -> Result<Sides, casca::Error> {
        let both = |v: &Voxel| match v.point {
            Some(point) => Ok([of(v, point, v.normal)?, of(v, point, -v.normal)?]),
            None => Ok([Vec3::ZERO; 2]),
        };
        self.voxels.par_iter().map(both).collect()
    }

    /// What surfaces emit.
    pub fn emission(&self) -> Sides {
        self.voxels.iter().map(|v| [v.emission; 2]).collect()
    }

    /// Direct light of lights, with shadows by exact walks to their centres.
    ///
    /// # Errors
    /// If the library refuses a walk.
    pub fn direct(&self, lights: &[Light]) -> Result<Sides, casca::Error> {
        let share = std::f32::consts::FRAC_1_PI;
        self.sides(|v, point, normal| Ok(v.albedo * self.lit(lights, point, normal)? * share))
    }

    /// The irradiance of lights at a point of a surface, as [`Self::direct`] finds it.
    pub(super) fn lit(&self, lights: &[Light], point: Vec3, normal: Vec3) -> Lit {
        let (far, off) = (2.0 * self.n as f32 * self.cell, OFF * self.cell);
        let from = point + normal * off;
        let mut sum = Vec3::ZERO;
        for incident in lights.iter().filter_map(|l| l.incident(point)) {
            let cos = incident.direction.dot(normal);
            if cos > 0.0 && self.open(point, from, &incident, far)? {
                sum += incident.irradiance * cos;
            }
        }
        Ok(sum)
    }

    /// Whether nothing hides a light from a point in front of a surface. Cells near the surface,
    /// and near a light, may be those of the surface or of its lamp: nothing hides a light whose
    /// distance is no more than both parts of the way that are left out.
    fn open(&self, point: Vec3, from: Vec3, light: &Incident, far: f32) -> Result<bool, casca::Error> {
        let off = OFF * self.cell;
        if light.distance <= 2.0 * off {
            return Ok(true);
        }
        let to = if light.distance < far {
            let lamp = point + light.direction * light.distance;
            lamp - (lamp - from).normalize_or_zero() * off
        } else {
            from + light.direction * far
        };
        Ok(self.soft.first_hit(from, to)?.is_none())
    }
}

/// A mesh, or open parts of it. The library fills closed meshes; one that faces inwards is a room,
/// which must not be filled. A closed mesh is open without one of its triangles that has an area.
fn parts(mesh: &Mesh) -> Result<Vec<TriMesh>, casca::Error> {
    let outward = mesh.is_closed();
    let (mut parts, mut rest) = (Vec::new(), &mesh.triangles[..]);
    while !rest.is_empty() {
        let part = TriMesh::bounds_only(mesh.positions.clone(), rest.to_vec())?;
        if outward || !part.is_closed() {
            parts.push(part);
            break;
        }
        let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize]);
        let flat = |[a, b, c]: [Vec3; 3]| a == b || b == c || c == a;
        let first = rest.iter().position(|t| !flat(corners(t))).map_or(rest.len(), |i| i + 1);
        parts.push(TriMesh::bounds_only(mesh.positions.clone(), rest[..first].to_vec())?);
        rest = &rest[first..];
    }
    Ok(parts)
}

impl Sums {
    /// Adds other sums. Normals are turned to the side of those that were added before.
    fn merge(&mut self, other: &Self) {
        let side = if self.normal.dot(other.normal) < 0.0 { -1.0 } else { 1.0 };
        self.weight += other.weight;
        self.emitting += other.emitting;
        self.albedo += other.albedo;
        self.emission += other.emission;
        self.normal += other.normal * side;
        self.point += other.point;
    }

    /// The means, where `full` is the weight of a surface that lies across a cell.
    fn mean(&self, full: f32) -> Voxel {
        let over = |weight: f32| if weight > 0.0 { 1.0 / weight } else { 0.0 };
        Voxel {
            albedo: self.albedo * over(self.weight),
            // A surface behind a lamp takes nothing of its light; one beside it does.
            emission: self.emission * over(self.emitting.max(full.min(self.weight))),
            normal: self.normal.normalize_or(Vec3::Y),
            point: (self.weight > 0.0).then(|| self.point / self.weight),
        }
    }
}
