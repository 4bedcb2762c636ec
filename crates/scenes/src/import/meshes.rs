//! The triangles of meshes, and their lines and points as triangles without area.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::rc::Rc;

use glam::Vec3;
use gltf::mesh::Mode;

use super::accessors::{Buffers, Components, TOO_MUCH, unfit};
use super::error::Trouble;
use crate::world::{Bounds, Mesh, around};

/// Whether primitives of a mode are lines or points.
pub(super) fn is_loose(mode: Mode) -> bool {
    matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip)
}

/// By triangle, given by their primitives: the index of the material plus one, 0 for the default.
pub fn materials_of(mesh: &gltf::Mesh, primitives: &[u32]) -> Vec<u32> {
    let all: Vec<u32> = mesh.primitives().map(|p| p.material().index().map_or(0, |i| i as u32 + 1)).collect();
    primitives.iter().map(|&p| all.get(p as usize).copied().unwrap_or(0)).collect()
}

/// Calls `add` with each triangle of a primitive, line or point.
fn each_triangle(
    mode: Mode,
    corners: &[u32],
    mut add: impl FnMut([u32; 3]) -> Result<(), Trouble>,
) -> Result<(), Trouble> {
    match mode {
        Mode::TriangleStrip => corners.windows(3).enumerate().try_for_each(|(i, w)| {
            // Every other triangle of a strip runs the other way round.
            add(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
        }),
        Mode::TriangleFan => corners[1..].windows(2).try_for_each(|w| add([corners[0], w[0], w[1]])),
        Mode::Triangles => corners.chunks_exact(3).try_for_each(|t| add([t[0], t[1], t[2]])),
        Mode::Points => corners.iter().try_for_each(|&p| add([p, p, p])),
        Mode::Lines => corners.chunks_exact(2).try_for_each(|l| add([l[0], l[1], l[1]])),
        Mode::LineStrip | Mode::LineLoop => {
            let back = [*corners.last().unwrap_or(&0), *corners.first().unwrap_or(&0)];
            let back = (mode == Mode::LineLoop && !corners.is_empty()).then_some(back);
            let mut lines = corners.windows(2).map(|l| [l[0], l[1]]).chain(back);
            lines.try_for_each(|[a, b]| add([a, b, b]))
        }
    }
}

/// Reads meshes; vertex data that several share is read once.
pub struct Meshes<'a> {
    buffers: &'a Buffers,
    /// What positions may be.
    components: Components,
    positions: HashMap<usize, Rc<Vec<Vec3>>>,
    /// By accessor: the box around its positions.
    boxes: HashMap<usize, Bounds>,
}

impl<'a> Meshes<'a> {
    /// A reader of the meshes of a file, whose positions are of these components.
    pub fn new(buffers: &'a Buffers, components: Components) -> Self {
        Self { buffers, components, positions: HashMap::new(), boxes: HashMap::new() }
    }

    /// Joins all that is drawn of a mesh, with the vertices that it uses, and says of which
    /// primitive each triangle is; `None` if there is nothing. A line is a triangle without area,
    /// and so is a point.
    pub fn mesh(&mut self, mesh: &gltf::Mesh) -> Result<Option<(Mesh, Vec<u32>)>, Trouble> {
        self.joined(mesh, false, |_, _| {})
    }

    /// The same for triangles only, where primitives share no vertices, since they may differ in
    /// colour; `each` is called for each vertex in turn, with its primitive and its number there.
    pub fn parted(
        &mut self,
        mesh: &gltf::Mesh,
        each: impl FnMut(usize, u32),
    ) -> Result<Option<(Mesh, Vec<u32>)>, Trouble> {
        self.joined(mesh, true, each)
    }

    fn joined(
        &mut self,
        mesh: &gltf::Mesh,
        parted: bool,
        mut each: impl FnMut(usize, u32),
    ) -> Result<Option<(Mesh, Vec<u32>)>, Trouble> {
        let mut joined = Mesh::default();
        let mut primitives = Vec::new();
        // By accessor, index there and, where primitives are parted, their number.
        let mut known: HashMap<(usize, u32, usize), u32> = HashMap::new();
        for primitive in mesh.primitives() {
            let mode = primitive.mode();
            let is_loose = is_loose(mode);
            if is_loose && parted {
                continue;
            }
            let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else { continue };
            let points = self.points(&accessor, mesh.index())?;
            let vertices = points.len();
            let corners: Vec<u32> = match primitive.indices() {
                Some(indices) => self.buffers.indices(&indices)?,
                // Read once, but perhaps used often.
                None if !self.buffers.spend(vertices) => return Err(unfit(&accessor, "positions", TOO_MUCH)),
                None => (0..=u32::MAX).take(vertices).collect(),
            };
            let whole = match mode {
                Mode::Triangles => corners.len().is_multiple_of(3),
                _ => is_loose || corners.len() >= 3,
            };
            if !whole {
                let (n, mesh, corners) = (primitive.index(), mesh.index(), corners.len());
                let what = format!("primitive {n} of mesh {mesh} has {corners} corners");
                return Err(Trouble::Part(format!("{what}, which make no whole triangles")));
            }
            let add = |corners: [u32; 3]| {
                let [a, b, c] = corners;
                if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                    let mesh = mesh.index();
                    return Err(Trouble::Part(format!("mesh {mesh} names vertex {vertex} of {vertices}")));
                }
                // Strips go on elsewhere by triangles with two equal corners, which show nothing.
                let is_part_of_strip = matches!(mode, Mode::TriangleStrip | Mode::TriangleFan);
                if is_part_of_strip && (a == b || b == c || c == a) {
                    return Ok(());
                }
                let mut triangle = [0; 3];
                for (place, vertex) in triangle.iter_mut().zip(corners) {
                    *place = match known.entry((
                        accessor.index(),
                        vertex,
                        if parted { primitive.index() } else { 0 },
                    )) {
                        Entry::Occupied(entry) => *entry.get(),
                        Entry::Vacant(entry) => {
                            let many = |_| format!("mesh {} has too many vertices", mesh.index());
                            let new = u32::try_from(joined.positions.len()).map_err(many);
                            let new = new.map_err(Trouble::Part)?;
                            joined.positions.push(points[vertex as usize]);
                            each(primitive.index(), vertex);
                            *entry.insert(new)
                        }
                    };
                }
                joined.triangles.push(triangle);
                Ok(())
            };
            each_triangle(mode, &corners, add)?;
            primitives.resize(joined.triangles.len(), primitive.index() as u32);
        }
        Ok((!joined.triangles.is_empty()).then_some((joined, primitives)))
    }

    /// The box around the vectors of an accessor: positions, or offsets of a morph target.
    pub(super) fn around(&mut self, accessor: &gltf::Accessor) -> Result<Bounds, Trouble> {
        if let Some(known) = self.boxes.get(&accessor.index()) {
            return Ok(*known);
        }
        let all = self.buffers.floats(accessor, "positions or morph targets", self.components)?;
        let bounds = around(all.into_iter().map(Vec3::from_array));
        self.boxes.insert(accessor.index(), bounds);
        Ok(bounds)
    }

    /// The positions of an accessor of a mesh.
    ///
    /// # Errors
    /// Refuses positions that are not finite.
    pub fn points(&mut self, accessor: &gltf::Accessor, mesh: usize) -> Result<Rc<Vec<Vec3>>, Trouble> {
        if let Some(points) = self.positions.get(&accessor.index()) {
            return Ok(points.clone());
        }
        let points = self.buffers.floats(accessor, "positions", self.components)?;
        let points: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
        if points.iter().any(|p| !p.is_finite()) {
            return Err(Trouble::NotFinite(format!("a position of mesh {mesh}")));
        }
        let points = Rc::new(points);
        self.positions.insert(accessor.index(), points.clone());
        Ok(points)
    }
}
