//! What a test scene is: objects, their motion over time and a camera path.
//!
//! Independent of the library, so that the oracle can work on it without
//! sharing code with what it checks.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

pub use casca_tools::camera::Camera;
use glam::{Affine3A, DVec3, Vec3};

/// Seconds between two frames of every path.
pub const FRAME_SECONDS: f64 = 1.0 / 30.0;

/// From which sides a triangle hides what is behind it. Its front is where its corners run
/// counter-clockwise in object space; under a transform that mirrors, it stays on the same side of
/// the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// From none: one sees through it, or it is not surely there.
    Neither,
    /// From its front.
    Front,
    /// From both.
    #[default]
    Both,
}

/// The sign of the determinant of a transform: less than 0 if it mirrors, 0 if it flattens.
pub fn turn_of(transform: &Affine3A) -> f64 {
    let determinant = transform.as_daffine3().matrix3.determinant();
    if determinant == 0.0 { 0.0 } else { determinant.signum() }
}

/// An indexed triangle mesh in object space.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Vertex indices, three per triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// By triangle: from where it hides. Those beyond the end hide from both sides.
    pub sides: Vec<Sides>,
}

/// The least and the greatest corner of a box.
pub(crate) type Bounds = (Vec3, Vec3);

/// The box around points. It is NaN if one of them is: `min` of a number and NaN may be either, and
/// would forget all points before.
pub(crate) fn around(points: impl IntoIterator<Item = Vec3>) -> Bounds {
    points.into_iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| match (lo + p).is_nan() {
        true => (Vec3::NAN, Vec3::NAN),
        false => (lo.min(p), hi.max(p)),
    })
}

/// The triangles of a box by the numbers of its [`box_corners`], counter-clockwise seen from
/// outside.
pub const BOX_TRIANGLES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

/// The corners of a box; the bits of a corner's number say where it has the greater x (1), y (2)
/// and z (4).
pub fn box_corners(min: Vec3, max: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|i| {
        let side = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(side(0), side(1), side(2))
    })
}

impl Mesh {
    /// A box.
    pub fn cuboid(min: Vec3, max: Vec3) -> Self {
        let (positions, triangles) = (box_corners(min, max).to_vec(), BOX_TRIANGLES.to_vec());
        Self { positions, triangles, sides: Vec::new() }
    }

    /// A sheet of `m` times `k` squares, of two triangles each; its corners by their numbers. It faces up
    /// if the first number runs along x and the second along z.
    pub fn sheet(m: u32, k: u32, mut at: impl FnMut(u32, u32) -> Vec3) -> Self {
        let corners = (0..=k).flat_map(|j| (0..=m).map(move |i| (i, j)));
        let square = |n: u32| {
            let a = n / m * (m + 1) + n % m;
            [[a, a + m + 2, a + 1], [a, a + m + 1, a + m + 2]]
        };
        let positions = corners.map(|(i, j)| at(i, j)).collect();
        Self { positions, triangles: (0..m * k).flat_map(square).collect(), sides: Vec::new() }
    }

    /// Adds the triangles of another mesh.
    pub fn append(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        if !(self.sides.is_empty() && other.sides.is_empty()) {
            self.sides.resize(self.triangles.len(), Sides::Both);
            self.sides.extend(other.sides);
        }
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    /// From where a triangle hides.
    pub fn sides_of(&self, triangle: usize) -> Sides {
        self.sides.get(triangle).copied().unwrap_or_default()
    }

    /// The triangles that hide, and whether they do so from their front only; `None` if none does.
    /// Where some hide from their front and others from both sides, each of the latter comes twice,
    /// once for each side.
    pub fn hiding(&self) -> Option<(Cow<'_, [[u32; 3]]>, bool)> {
        let has = |wanted| self.sides.contains(&wanted);
        let both = has(Sides::Both) || self.sides.len() < self.triangles.len();
        let front = has(Sides::Front);
        if !(both || front) {
            return None;
        }
        if !(has(Sides::Neither) || both && front) {
            return Some((Cow::Borrowed(&self.triangles), front));
        }
        let mut hiding = Vec::with_capacity(self.triangles.len());
        for (i, &[a, b, c]) in self.triangles.iter().enumerate() {
            let sides = self.sides_of(i);
            if sides != Sides::Neither {
                hiding.push([a, b, c]);
            }
            if sides == Sides::Both && front {
                hiding.push([a, c, b]);
            }
        }
        Some((Cow::Owned(hiding), front))
    }

    /// The least and the greatest corner of its vertices under a transform.
    pub fn bounds(&self, transform: &Affine3A) -> (Vec3, Vec3) {
        around(self.positions.iter().map(|&p| transform.transform_point3(p)))
    }

    /// Whether it bounds solids and its triangles face outwards: vertices of equal positions taken
    /// as one, each edge is run along as often in one direction as in the other, and the volume
    /// inside is positive. A mesh whose triangles name vertices that it lacks does not.
    pub fn is_closed(&self) -> bool {
        if self.triangles.iter().flatten().any(|&v| v as usize >= self.positions.len()) {
            return false;
        }
        let bits = |v: u32| self.positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
        let mut balance: HashMap<_, i32> = HashMap::new();
        let mut volume = 0.0;
        for t in &self.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let (a, b) = (bits(a), bits(b));
                if a != b {
                    *balance.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
                }
            }
            let [a, b, c] = t.map(|v| self.positions[v as usize].as_dvec3());
            volume += a.dot(b.cross(c));
        }
        volume > 0.0 && balance.values().all(|&n| n == 0)
    }

    /// An icosahedron cut into 4^`cuts` times its triangles, with vertices at distance 1 from the
    /// origin.
    pub fn ball(cuts: u32) -> Self {
        let g = (1.0 + 5f32.sqrt()) / 2.0;
        let mut positions: Vec<Vec3> = Vec::new();
        for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
            positions.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
        }
        let mut triangles = Vec::new();
        for i in 0..12u32 {
            for j in 0..12u32 {
                for k in 0..12u32 {
                    let [a, b, c] = [i, j, k].map(|v| positions[v as usize]);
                    let edge = |p: Vec3, q: Vec3| (p.distance(q) - 2.0).abs() < 1e-3;
                    let first = i < j && i < k;
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    if first && outward && edge(a, b) && edge(b, c) && edge(c, a) {
                        triangles.push([i, j, k]);
                    }
                }
            }
        }
        for _ in 0..cuts {
            triangles = cut(&mut positions, triangles);
        }
        let positions = positions.into_iter().map(Vec3::normalize).collect();
        Self { positions, triangles, sides: Vec::new() }
    }
}

/// Cuts each triangle into four, with new vertices in the directions of the middles of edges.
fn cut(positions: &mut Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let (p, q) = (positions[a as usize].normalize(), positions[b as usize].normalize());
            positions.push(p + q);
            positions.len() as u32 - 1
        })
    };
    let mut next = Vec::with_capacity(4 * triangles.len());
    for [a, b, c] in triangles {
        let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
        next.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
    }
    next
}

/// The exact geometry of an object, in world space.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A solid sphere.
    Sphere {
        /// Centre in metres.
        center: Vec3,
        /// Radius in metres.
        radius: f32,
    },
    /// A solid axis-aligned box.
    Box {
        /// Least corner.
        min: Vec3,
        /// Greatest corner.
        max: Vec3,
    },
    /// A triangle mesh: a surface that is seen from both sides, and hides as its triangles say.
    Mesh {
        /// The mesh in object space.
        mesh: Arc<Mesh>,
        /// Object space to world space.
        transform: Affine3A,
    },
}

impl Shape {
    /// The corners of the box around the shape.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Sphere { center, radius } => (*center - *radius, *center + *radius),
            Self::Box { min, max } => (*min, *max),
            Self::Mesh { mesh, transform } => mesh.bounds(transform),
        }
    }

    /// The shape moved by an offset; its coordinates are rounded.
    pub fn moved(&self, by: Vec3) -> Self {
        match self {
            Self::Sphere { center, radius } => Self::Sphere { center: *center + by, radius: *radius },
            Self::Box { min, max } => Self::Box { min: *min + by, max: *max + by },
            Self::Mesh { mesh, transform } => {
                let transform = Affine3A::from_translation(by) * *transform;
                Self::Mesh { mesh: mesh.clone(), transform }
            }
        }
    }
}

/// How an object moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Never moves.
    Static,
    /// May move, at most this fast (metres per second).
    Dynamic {
        /// Promised greatest speed of any point of the object.
        max_speed: f32,
    },
}

/// One object of a test scene.
#[derive(Debug, Clone)]
pub struct Object {
    /// A name for messages; may be empty.
    pub name: String,
    /// Where it is now, exactly.
    pub shape: Shape,
    /// Whether it can move.
    pub motion: Motion,
    /// Whether it hides others, a mesh as its [`Sides`] say. An object that does not occlude is
    /// still tested, but the oracle lets one see through it.
    pub occludes: bool,
    /// Whether its visibility is asked for.
    pub tested: bool,
}

/// The grid a scene asks for unless the user says otherwise.
#[derive(Debug, Clone, Copy)]
pub struct GridHint {
    /// Least corner of the region that holds every object at every frame.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
    /// Edge length of a cell in metres.
    pub cell: f32,
}

/// Moves the objects of a world and its camera. Deterministic: the same frame
/// gives the same positions, whatever was asked before.
pub trait Animation: Send + Sync {
    /// The shapes of moving objects at `frame`, as (object index, shape),
    /// passed to `set` in ascending order of index.
    fn shapes(&self, frame: usize, set: &mut dyn FnMut(usize, Shape));
    /// The camera at `frame`, for pictures `aspect` times as wide as high.
    fn camera(&self, frame: usize, aspect: f32) -> Camera;
}

/// What a file says about the world that was read from it; empty for other worlds.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// What of the file is not as its author may expect: a line each, which names the place in the
    /// file. Tools show them.
    pub warnings: Vec<String>,
    /// What is added to each position of the world, its camera and its grid to get that of the
    /// file, in metres: a scene far from the origin of its file is moved to one of its own, since
    /// single precision is too coarse there. Zero where nothing was moved;
    /// single precision holds its numbers.
    pub origin: DVec3,
    /// The JSON of the file, as it was; empty for other worlds.
    pub document: Arc<[u8]>,
    /// By object as it was read: what of the file it is. Shorter where that is not known.
    pub parts: Vec<FilePart>,
}

/// What of a glTF file an object is.
#[derive(Debug, Clone)]
pub struct FilePart {
    /// The index of its node.
    pub node: usize,
    /// By triangle of its mesh: the number of the primitive. None where the object is a box around
    /// what the file draws.
    pub primitives: Arc<[u32]>,
}

impl Source {
    /// Prints the warnings to the standard error of a tool.
    pub fn tell(&self) {
        self.warnings.iter().for_each(|line| eprintln!("warning: {line}"));
    }

    /// Says what the origin is, for tools whose coordinates are those of the world; `None` if that
    /// is the one of the file.
    pub fn about_origin(&self) -> Option<String> {
        let DVec3 { x, y, z } = self.origin;
        let said =
            format!("the scene lies far from the origin of its file: add {x}, {y}, {z} to coordinates");
        (self.origin != DVec3::ZERO).then_some(said)
    }
}

/// A test scene.
pub struct World {
    /// What the file says that it comes from.
    pub source: Source,
    /// Name as given on the command line, or the file's name.
    pub name: String,
    /// All objects, with their shapes at the frame last set (0 at first).
    pub objects: Vec<Object>,
    /// The grid it asks for.
    pub grid: GridHint,
    /// Frames of the path.
    pub frames: usize,
    /// Motion and camera.
    pub animation: Box<dyn Animation>,
}

impl World {
    /// Moves every object to where it is at `frame`; returns the indices of
    /// the objects whose shape was set, in ascending order.
    pub fn set_frame(&mut self, frame: usize) -> Vec<usize> {
        let mut moved = Vec::new();
        let objects = &mut self.objects;
        self.animation.shapes(frame, &mut |index, shape| {
            objects[index].shape = shape;
            moved.push(index);
        });
        moved
    }

    /// The camera at `frame`.
    pub fn camera(&self, frame: usize, aspect: f32) -> Camera {
        self.animation.camera(frame, aspect)
    }
}
