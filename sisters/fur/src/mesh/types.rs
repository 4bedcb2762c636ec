//! Vertices, coats and indexed meshes.

use casca::Aabb;
use glam::Vec3;

use crate::error::Error;
use crate::numeric::{MAX_COORDINATE, MAX_TRIANGLES};

/// A vertex: 24 bytes for the graphics processor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Vertex {
    /// Position in object space.
    pub position: Vec3,
    /// Normal in object space: of length 1, or zero where none is known yet.
    pub normal: Vec3,
}

impl Vertex {
    /// A vertex without a normal.
    pub const fn at(position: Vec3) -> Self {
        Self { position, normal: Vec3::ZERO }
    }
}

/// The fur at a vertex: what a vertex colour with four channels holds. 16 bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Coat {
    /// Linear colour, 0 to 1 each.
    pub color: Vec3,
    /// The length of the fur as a share of the greatest, 0 to 1: the alpha channel. 0 is bald.
    pub length: f32,
}

impl Default for Coat {
    /// White fur of full length.
    fn default() -> Self {
        Self { color: Vec3::ONE, length: 1.0 }
    }
}

/// An indexed triangle mesh, checked: finite, not empty, and each index has its vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    pub(super) vertices: Vec<Vertex>,
    pub(super) coats: Vec<Coat>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh of vertices and triangles, counter-clockwise seen from outside; one coat for each
    /// vertex, or none for white fur of full length. Normals are scaled to length 1; those of
    /// length 0 stay zero. Costs one pass.
    ///
    /// # Errors
    /// Refuses no triangles, more than 2^29, indices without a vertex, values that are not finite,
    /// coordinates above 1e9, coats outside of 0 to 1 and a wrong number of coats.
    pub fn new(
        mut vertices: Vec<Vertex>,
        mut coats: Vec<Coat>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, Error> {
        check_count(triangles.len())?;
        check_vertices(&vertices)?;
        if coats.is_empty() {
            coats = vec![Coat::default(); vertices.len()];
        }
        check_coats(&coats, vertices.len())?;
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                let (number, count) = (vertex as usize, vertices.len());
                let (what, of, does) = ("triangle", triangle, "uses vertex");
                return Err(Error::Missing { what, of, does, number, count });
            }
        }
        for v in &mut vertices {
            v.normal = v.normal.as_dvec3().normalize_or_zero().as_vec3();
        }
        Ok(Self { vertices, coats, triangles })
    }

    /// The vertices.
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// The fur at each vertex.
    pub fn coats(&self) -> &[Coat] {
        &self.coats
    }

    /// The triangles: three vertices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The box of the vertices, without fur.
    pub fn aabb(&self) -> Aabb {
        // A checked mesh has a vertex.
        Aabb::from_points(self.vertices.iter().map(|v| v.position))
            .unwrap_or(Aabb::new(Vec3::ZERO, Vec3::ZERO))
    }

    /// Bytes of the vertices and indices on the graphics processor, without coats: 24 for each
    /// vertex, and for each of three indices of a face 2 below 65,536 vertices, else 4 (thesis,
    /// section 7.1.1).
    pub fn bytes(&self) -> u64 {
        let (vertices, faces) = (self.vertices.len() as u64, self.triangles.len() as u64);
        24 * vertices + 3 * faces * if vertices < 65_536 { 2 } else { 4 }
    }

    /// The area of all triangles, in square units.
    pub fn area(&self) -> f64 {
        let at = |v: u32| self.vertices[v as usize].position.as_dvec3();
        self.triangles.iter().map(|t| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length() * 0.5).sum()
    }

    /// How many edges do not belong to exactly two triangles that run along them in opposite
    /// directions; 0 for a closed two-manifold mesh. Edges are pairs of positions, so that seams of
    /// normals or coats count as closed. Costs a sort of the edges.
    pub fn open_edges(&self) -> usize {
        let bits = |v: u32| self.vertices[v as usize].position.to_array().map(|c| (c + 0.0).to_bits());
        let mut edges: Vec<_> = self
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| {
                let (a, b) = (bits(a), bits(b));
                (a.min(b), a.max(b), a < b)
            })
            .collect();
        edges.sort_unstable();
        let same = |a: &(_, _, bool), b: &(_, _, bool)| (a.0, a.1) == (b.0, b.1);
        let fine = |e: &[([u32; 3], [u32; 3], bool)]| e.len() == 2 && e[0].2 != e[1].2 && e[0].0 != e[0].1;
        edges.chunk_by(same).filter(|e| !fine(e)).count()
    }
}

pub(super) fn check_count(triangles: usize) -> Result<(), Error> {
    match triangles {
        0 => Err(Error::Empty),
        1..=MAX_TRIANGLES => Ok(()),
        _ => Err(Error::TooMany { what: "triangles", count: triangles as f64, max: MAX_TRIANGLES }),
    }
}

pub(super) fn check_vertices(vertices: &[Vertex]) -> Result<(), Error> {
    for (vertex, v) in vertices.iter().enumerate() {
        for (what, value) in [("position", v.position), ("normal", v.normal)] {
            // NaN is not below.
            if !value.abs().cmple(Vec3::splat(MAX_COORDINATE)).all() {
                return Err(Error::Vertex { vertex, what, value, max: MAX_COORDINATE });
            }
        }
    }
    Ok(())
}

pub(super) fn check_coats(coats: &[Coat], vertices: usize) -> Result<(), Error> {
    if coats.len() != vertices {
        return Err(Error::Count { what: "coats", found: coats.len(), expected: vertices });
    }
    for (vertex, coat) in coats.iter().enumerate() {
        let within = |x: f32| (0.0..=1.0).contains(&x);
        if !coat.color.to_array().into_iter().all(within) {
            return Err(Error::Vertex { vertex, what: "colour", value: coat.color, max: 1.0 });
        }
        crate::error::range("the length of the fur at a vertex", coat.length.into(), 0.0, 1.0)?;
    }
    Ok(())
}
