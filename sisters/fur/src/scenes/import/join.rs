//! Primitives with their colours, joined to one mesh.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::mesh::Coat;
use crate::skin::PER_VERTEX;
use casca_images::{Images, attribute};
use glam::{Affine3A, Vec3};
use gltf::Semantic;
use gltf::accessor::Dimensions;

use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{Buffers, Components, Meshes, materials_of};
use casca_scenes::world::Mesh;

/// The colour of fur whose file says nothing about colours: brown, linear.
const PLAIN: Vec3 = Vec3::new(0.36, 0.21, 0.10);

/// The attribute with the length of fur, without its underscore.
const LENGTH: &str = "FURLENGTH";

/// The joints that a vertex follows, and their shares.
pub(super) type Follower = ([u32; PER_VERTEX], [f32; PER_VERTEX]);

/// The joined parts; all by vertex but the mesh and the materials.
#[derive(Default)]
pub(super) struct Made {
    pub(super) mesh: Mesh,
    pub(super) coats: Vec<Coat>,
    /// By triangle.
    pub(super) materials: Vec<u32>,
    /// Only of vertices that follow something.
    pub(super) followers: Vec<Follower>,
}

/// Joins meshes.
pub(super) struct Join<'a> {
    reader: Meshes<'a>,
    images: Images<'a>,
    buffers: &'a Buffers,
    /// The number that stands for no material.
    plain: u32,
    made: Made,
    /// The coats of the vertices of a primitive, by index of the mesh and the primitive.
    known: HashMap<(usize, usize), Vec<Coat>>,
}

impl<'a> Join<'a> {
    pub(super) fn new(
        document: &gltf::Document,
        buffers: &'a Buffers,
        positions: Components,
        folder: Option<&'a Path>,
    ) -> Self {
        Self {
            reader: Meshes::new(buffers, positions),
            images: Images::new(buffers, folder),
            buffers,
            plain: document.materials().count() as u32,
            made: Made::default(),
            known: HashMap::new(),
        }
    }

    /// The joined parts.
    pub(super) fn done(self) -> Made {
        self.made
    }

    /// Adds a mesh under a transform; `follows` says what a vertex of a primitive follows.
    pub(super) fn add(
        &mut self,
        mesh: &gltf::Mesh,
        at: Affine3A,
        follows: &dyn Fn((usize, usize)) -> Result<Option<Follower>, Trouble>,
    ) -> Result<(), Trouble> {
        let mut sources = Vec::new();
        let each = |primitive: usize, vertex: u32| sources.push((primitive, vertex as usize));
        let Some((part, primitives)) = self.reader.parted(mesh, each)? else { return Ok(()) };
        // Nodes may show one mesh often.
        if !self.buffers.spend(part.positions.len() + part.triangles.len()) {
            return Err(Trouble::Part(format!("mesh {} has too many vertices", mesh.index())));
        }
        let used: HashSet<usize> = sources.iter().map(|source| source.0).collect();
        for primitive in mesh.primitives() {
            let key = (mesh.index(), primitive.index());
            if used.contains(&primitive.index()) && !self.known.contains_key(&key) {
                let coats = self.coats(mesh.index(), &primitive)?;
                self.known.insert(key, coats);
            }
        }
        let made = &mut self.made;
        let first = made.mesh.positions.len() as u32;
        for (&position, source) in part.positions.iter().zip(&sources) {
            let position = at.transform_point3(position);
            if !position.is_finite() {
                return Err(Trouble::NotFinite(format!("a position of mesh {}", mesh.index())));
            }
            made.mesh.positions.push(position);
            // Each primitive with a vertex was looked at, and as many colours were read.
            made.coats.push(self.known[&(mesh.index(), source.0)][source.1]);
            made.followers.extend(follows(*source)?);
        }
        // A mirrored mesh would be inside out.
        let order = if at.matrix3.determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] };
        made.mesh.triangles.extend(part.triangles.iter().map(|t| order.map(|i| first + t[i])));
        let plain = self.plain;
        let materials = materials_of(mesh, &primitives);
        made.materials.extend(materials.iter().map(|&m| m.checked_sub(1).unwrap_or(plain)));
        Ok(())
    }

    /// The coats of a primitive.
    fn coats(&mut self, mesh: usize, primitive: &gltf::Primitive) -> Result<Vec<Coat>, Trouble> {
        let count = primitive.get(&Semantic::Positions).map_or(0, |accessor| accessor.count());
        let finite = |values: &[f32], what: &str| match values.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(Trouble::NotFinite(format!("a {what} of mesh {mesh}"))),
        };
        let colors = match primitive.get(&Semantic::Colors(0)) {
            None => None,
            Some(accessor) => Some(self.colors(&accessor, count)?),
        };
        let lengths = match primitive.get(&Semantic::Extras(LENGTH.to_owned())) {
            None => None,
            Some(accessor) => {
                Some(attribute::<1>(self.buffers, &accessor, "lengths of fur", count)?.into_flattened())
            }
        };
        finite(colors.as_deref().unwrap_or(&[]).as_flattened(), "colour")?;
        finite(lengths.as_deref().unwrap_or(&[]), "length")?;
        let material = primitive.material();
        let [r, g, b, _] = material.pbr_metallic_roughness().base_color_factor();
        finite(&[r, g, b], "base colour")?;
        let plain = material.index().is_none() && colors.is_none();
        let base = if plain { PLAIN } else { Vec3::new(r, g, b) };
        let share = |x: f32| x.clamp(0.0, 1.0);
        let coat = |v: usize| {
            let [r, g, b, alpha] = colors.as_ref().map_or([1.0; 4], |colors| colors[v]);
            let length = lengths.as_ref().map_or(alpha, |lengths| lengths[v]);
            let color = (base * Vec3::new(share(r), share(g), share(b))).clamp(Vec3::ZERO, Vec3::ONE);
            Coat { color, length: share(length) }
        };
        let mut coats: Vec<Coat> = (0..count).map(coat).collect();
        if let Some(info) = material.pbr_metallic_roughness().base_color_texture() {
            let places = self.images.places(primitive, &info, count)?;
            let image = self.images.of(&info.texture())?;
            for (coat, uv) in coats.iter_mut().zip(places) {
                coat.color *= image.color(uv);
            }
        }
        Ok(coats)
    }

    fn colors(&self, accessor: &gltf::Accessor, count: usize) -> Result<Vec<[f32; 4]>, Trouble> {
        match accessor.dimensions() {
            Dimensions::Vec3 => {
                let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
                Ok(attribute::<3>(self.buffers, accessor, "colours", count)?
                    .into_iter()
                    .map(opaque)
                    .collect())
            }
            _ => attribute::<4>(self.buffers, accessor, "colours", count),
        }
    }
}
