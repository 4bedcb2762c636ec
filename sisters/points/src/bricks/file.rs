//! Files of bricks, opened and read.
//!
//! All numbers are little-endian. 64 bytes: "CASCABRK", version (u32), levels (u32), origin (3
//! f64), points (u64), bricks (u64), 0 (u64). Then 16 bytes for each point: position minus origin
//! (3 f32), red, green, blue, 0. Then 64 bytes for each brick, in the order of their points: least
//! and greatest corner (6 f32), and the points of each level (10 u32), of which the last is all.

use super::BrickError;
use crate::Camera;
use casca::{Aabb, ObjectDesc, ObjectId, Scene};
use glam::{DVec3, Vec3};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Levels of detail of a brick: one point for each occupied cell of the grids of 1, 2, 4, … 256
/// cells along its longest edge, and all.
pub(super) const LEVELS: usize = 10;
/// The most points of a brick: 4 MiB.
pub(super) const MOST: u32 = 1 << 18;
/// Bytes of the header, and of each entry of the index.
pub(super) const HEADER: u64 = 64;
pub(super) const ENTRY: u64 = 64;
/// Bytes of a point.
pub(super) const POINT: u64 = 16;

const MAGIC: [u8; 8] = *b"CASCABRK";
const VERSION: u32 = 3;

fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}

fn float(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(array(bytes, at))
}

/// A point of a brick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BrickPoint {
    pub position: Vec3,
    pub colour: [u8; 3],
}

impl BrickPoint {
    pub fn to_bytes(self) -> [u8; POINT as usize] {
        let mut bytes = [0; POINT as usize];
        bytes[..12].copy_from_slice(self.position.to_array().map(f32::to_le_bytes).as_flattened());
        bytes[12..15].copy_from_slice(&self.colour);
        bytes
    }

    pub fn from_bytes(bytes: &[u8]) -> Self {
        let position = Vec3::from([0, 4, 8].map(|at| float(bytes, at)));
        Self { position, colour: array(bytes, 12) }
    }
}

/// The header of a file.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Header {
    pub origin: DVec3,
    pub points: u64,
    pub bricks: u64,
}

impl Header {
    pub fn to_bytes(self) -> Vec<u8> {
        let origin = self.origin.to_array().map(f64::to_le_bytes);
        let counts = [self.points, self.bricks, 0].map(u64::to_le_bytes);
        let kind = [VERSION, LEVELS as u32].map(u32::to_le_bytes);
        [&MAGIC, kind.as_flattened(), origin.as_flattened(), counts.as_flattened()].concat()
    }

    fn from_bytes(bytes: &[u8; HEADER as usize]) -> Result<Self, String> {
        if bytes[..8] != MAGIC {
            let cause = "it does not begin with CASCABRK; a build that was broken off leaves such a file";
            return Err(cause.into());
        }
        let [version, levels] = [8, 12].map(|at| u32::from_le_bytes(array(bytes, at)));
        if version != VERSION {
            return Err(format!("its version is {version}, and only {VERSION} is known"));
        }
        if levels != LEVELS as u32 {
            return Err(format!("its bricks have {levels} levels of detail, version {version} has {LEVELS}"));
        }
        let origin = DVec3::from([16, 24, 32].map(|at| f64::from_le_bytes(array(bytes, at))));
        let [points, bricks] = [40, 48].map(|at| u64::from_le_bytes(array(bytes, at)));
        if !origin.is_finite() {
            return Err("its origin is not finite".into());
        }
        Ok(Self { origin, points, bricks })
    }
}

/// A brick as the index has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Brick {
    pub bounds: Aabb,
    /// The number of points up to each level.
    pub counts: [u32; LEVELS],
    /// The points of the file before it.
    pub first: u64,
}

impl Brick {
    pub fn to_bytes(self) -> Vec<u8> {
        let corners = [self.bounds.min.to_array(), self.bounds.max.to_array()].concat();
        let corners = corners.into_iter().flat_map(f32::to_le_bytes);
        corners.chain(self.counts.into_iter().flat_map(u32::to_le_bytes)).collect()
    }

    fn from_bytes(bytes: &[u8], first: u64) -> Option<Self> {
        let corner = |at: usize| Vec3::from([0, 4, 8].map(|i| float(bytes, at + i)));
        let bounds = Aabb::new(corner(0), corner(12));
        let counts: [u32; LEVELS] = std::array::from_fn(|i| u32::from_le_bytes(array(bytes, 24 + 4 * i)));
        let finite = bounds.min.is_finite() && bounds.max.is_finite() && bounds.min.cmple(bounds.max).all();
        let sound = finite && counts.is_sorted() && counts[0] > 0 && counts[LEVELS - 1] <= MOST;
        sound.then_some(Self { bounds, counts, first })
    }

    /// The longest edge of the bounds.
    pub fn edge(&self) -> f64 {
        (self.bounds.max.as_dvec3() - self.bounds.min.as_dvec3()).max_element()
    }

    fn all(&self) -> u32 {
        self.counts[LEVELS - 1]
    }
}

/// A brick of which the first points are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Want {
    /// The number of the brick.
    pub brick: u32,
    /// How many of its points.
    pub points: u32,
}

/// An open file of bricks. Coordinates of bricks, points and the scene are relative to [`Bricks::origin`].
#[derive(Debug)]
pub struct Bricks {
    pub(super) name: String,
    header: Header,
    pub(super) index: Vec<Brick>,
    file: Mutex<File>,
}

impl Bricks {
    /// Opens a file and reads its index, but no points.
    ///
    /// # Errors
    /// If it cannot be opened, is of another format or version, or its length or index contradicts
    /// its header.
    pub fn open(path: &Path) -> Result<Self, BrickError> {
        let name = path.display().to_string();
        let io = |source| BrickError::Io { name: name.clone(), source };
        let broken = |cause: String| BrickError::Broken { name: name.clone(), cause };
        let mut file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut start = [0; HEADER as usize];
        if length < HEADER {
            return Err(broken(format!("it has {length} bytes")));
        }
        file.read_exact(&mut start).map_err(io)?;
        let header = Header::from_bytes(&start).map_err(&broken)?;
        let Header { points, bricks, .. } = header;
        let points_end = u128::from(HEADER) + u128::from(points) * u128::from(POINT);
        let end = points_end + u128::from(bricks) * u128::from(ENTRY);
        if end != length.into() || u32::try_from(bricks).is_err() {
            let cause = format!("its {length} bytes are not those of {points} points in {bricks} bricks");
            return Err(broken(cause));
        }
        let mut bytes = vec![0; (bricks * ENTRY) as usize];
        file.seek(SeekFrom::Start(points_end as u64)).map_err(io)?;
        file.read_exact(&mut bytes).map_err(io)?;
        let (mut first, mut index) = (0, Vec::with_capacity(bricks as usize));
        for (number, entry) in bytes.chunks_exact(ENTRY as usize).enumerate() {
            let nonsense = || broken(format!("the bounds or counts of brick {number} make no sense"));
            index.push(Brick::from_bytes(entry, first).ok_or_else(nonsense)?);
            first += u64::from(index[number].all());
        }
        if first != points {
            return Err(broken(format!("it has {points} points, its bricks {first}")));
        }
        Ok(Self { name, header, index, file: Mutex::new(file) })
    }

    /// The number of bricks.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// The number of points in all bricks.
    pub fn points(&self) -> u64 {
        self.header.points
    }

    /// The place that all coordinates are relative to, in those of the source.
    pub fn origin(&self) -> DVec3 {
        self.header.origin
    }

    /// The least box around all points; a point at the origin if there are none.
    pub fn bounds(&self) -> Aabb {
        let all = self.index.iter().map(|brick| brick.bounds).reduce(|a, b| a.union(&b));
        all.unwrap_or(Aabb::new(Vec3::ZERO, Vec3::ZERO))
    }

    /// Inserts every brick as a fixed object that hides nothing, with its number as user data. The
    /// ids are in the order of the bricks.
    ///
    /// # Errors
    /// Those of [`Scene::insert`]; the bricks before the error are inserted.
    pub fn insert_into(&self, scene: &mut Scene) -> Result<Vec<ObjectId>, casca::Error> {
        scene.reserve(self.len());
        let objects = self.index.iter().zip(0_u64..);
        objects.map(|(brick, i)| scene.insert(ObjectDesc::fixed(brick.bounds).user_data(i))).collect()
    }

    /// The points that a picture needs of some bricks, in the given order, which should be from
    /// near to far as in a PVS: as many as lie about `pixels` apart in the picture, at the place of
    /// the brick that is nearest to the eye. Numbers that are not bricks are ignored.
    pub fn wants(&self, bricks: impl IntoIterator<Item = u32>, camera: &Camera, pixels: f32) -> Vec<Want> {
        let want = |number: u32| {
            let brick = self.index.get(number as usize)?;
            let nearest = camera.eye().clamp(brick.bounds.min, brick.bounds.max);
            let distance = camera.eye().as_dvec3().distance(nearest.as_dvec3());
            let spacing = f64::from(pixels) * distance / f64::from(camera.pixels_per_tangent());
            // The first grid whose cells are at most as large; all points where none is.
            let level = (brick.edge() / spacing).log2().ceil().clamp(0.0, (LEVELS - 1) as f64) as usize;
            Some(Want { brick: number, points: brick.counts[level] })
        };
        bricks.into_iter().filter_map(want).collect()
    }

    /// About how far apart the first `points` points of a brick are: the number of occupied cells
    /// of a grid tells the area of the surface.
    pub fn spacing(&self, brick: u32, points: u32) -> f32 {
        let Some(brick) = self.index.get(brick as usize) else { return 0.0 };
        let points = points.min(brick.all());
        // The finest grid of which each occupied cell has about four of the points.
        let level = brick.counts.iter().rposition(|&n| u64::from(n) * 4 <= u64::from(points)).unwrap_or(0);
        let area = f64::from(brick.counts[level]) / f64::from(points.max(1));
        (brick.edge() * (-(level as f64)).exp2() * area.sqrt()) as f32
    }

    /// Reads some points of a brick. The range must lie within its points.
    pub(super) fn read(&self, brick: u32, range: Range<u32>) -> Result<Vec<BrickPoint>, BrickError> {
        let io = |source| BrickError::Io { name: self.name.clone(), source };
        let Brick { bounds, first, .. } = self.index[brick as usize];
        let mut bytes = vec![0; range.len() * POINT as usize];
        {
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            file.seek(SeekFrom::Start(HEADER + (first + u64::from(range.start)) * POINT)).map_err(io)?;
            file.read_exact(&mut bytes).map_err(io)?;
        }
        let points: Vec<_> = bytes.chunks_exact(POINT as usize).map(BrickPoint::from_bytes).collect();
        if points.iter().any(|p| !bounds.contains(p.position)) {
            let cause = format!("a point of brick {brick} lies outside its bounds");
            return Err(BrickError::Broken { name: self.name.clone(), cause });
        }
        Ok(points)
    }

    /// The points of a brick, at most as many as wanted; 0 for no brick.
    pub(super) fn available(&self, want: Want) -> u32 {
        self.index.get(want.brick as usize).map_or(0, |brick| brick.all().min(want.points))
    }
}
