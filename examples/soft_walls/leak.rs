//! How much light a cone lets through an opaque wall: the experiment of the digest on voxel cone
//! tracing, in a grid one cell thick.

use casca::glam::{UVec3, Vec3};
use casca::soft::{Cone, Layer, March, SoftGrid};
use casca::{Aabb, Error, GridSpec, TriMesh};

/// Cells along x and y.
pub const N: u32 = 256;

/// The walls of the experiment start at these planes across x.
const PLANES: std::ops::Range<usize> = 20..120;
const APART: usize = 3;

/// What came through the walls, of 1, and how many steps that took.
#[derive(Debug, Clone, Copy)]
pub struct Leak {
    pub mean: f32,
    pub greatest: f32,
    #[allow(dead_code, reason = "tests have no use for it")]
    pub steps: f32,
}

/// A wall of the experiment.
#[derive(Debug, Clone, Copy)]
pub enum Wall {
    /// Across x, so many cells thick.
    Straight(u32),
    /// A surface without thickness whose x grows by half of y.
    Askew,
}

impl Wall {
    fn insert(self, soft: &mut SoftGrid, plane: f32) -> Result<casca::soft::SoftId, Error> {
        let n = N as f32;
        match self {
            Self::Straight(cells) => {
                let (min, max) = (plane + 0.25, plane + cells as f32 - 0.25);
                soft.insert(Aabb::new(Vec3::new(min, 0.0, 0.0), Vec3::new(max, n, 1.0)), Layer::Moving)
            }
            Self::Askew => {
                let at = |y: f32, z: f32| Vec3::new(plane + 0.37 + (y - 12.8) * 0.5, y, z);
                let corners = vec![at(-n, -1.0), at(2.0 * n, -1.0), at(2.0 * n, 2.0), at(-n, 2.0)];
                let mesh = TriMesh::bounds_only(corners, vec![[0, 1, 2], [0, 2, 3]])?;
                soft.insert(std::sync::Arc::new(mesh), Layer::Moving)
            }
        }
    }
}

/// A grid of 256 x 256 x 1 cells of length 1, in which everything is the same along z.
pub fn slice() -> Result<SoftGrid, Error> {
    SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::new(N, N, 1) })
}

/// The light that passes 34 walls, for a ray at an angle to x and a cone around it. Every wall
/// hides all.
pub fn through_walls(wall: Wall, degrees: f32, tan: f32, march: &March) -> Result<Leak, Error> {
    let mut soft = slice()?;
    let (sin, cos) = degrees.to_radians().sin_cos();
    let apex = Vec3::new(0.01 * N as f32, 0.05 * N as f32, 0.5);
    let cone = Cone { apex, direction: Vec3::new(cos, sin, 0.0), tan, reach: 1.2 * N as f32 };
    let (mut sum, mut greatest, mut steps, mut walls) = (0.0, 0.0f32, 0, 0u16);
    for plane in PLANES.step_by(APART) {
        let id = wall.insert(&mut soft, plane as f32)?;
        soft.rebuild();
        let answer = soft.cone(&cone, march)?;
        soft.remove(id)?;
        sum += answer.transmittance;
        greatest = greatest.max(answer.transmittance);
        steps += answer.steps;
        walls += 1;
    }
    Ok(Leak { mean: sum / f32::from(walls), greatest, steps: steps as f32 / f32::from(walls) })
}

/// The light that passes a wall one cell thick so many cells ahead of the apex, which is in the
/// middle of a cell.
pub fn near_wall(ahead: u32, tan: f32, march: &March) -> Result<f32, Error> {
    let mut soft = slice()?;
    Wall::Straight(1).insert(&mut soft, (40 + ahead) as f32)?;
    soft.rebuild();
    let (apex, reach) = (Vec3::new(40.5, 128.0, 0.5), N as f32);
    Ok(soft.cone(&Cone { apex, direction: Vec3::X, tan, reach }, march)?.transmittance)
}
