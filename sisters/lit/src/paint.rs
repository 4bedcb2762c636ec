//! What is painted on the meshes of glTF files: their textures, and where triangles lie in them.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use casca_images::{Images, Picture, linear_of};
use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{Components, File, Meshes, materials_of};
use glam::{DVec3, Vec2, Vec3};
use gltf::texture::{Info, WrappingMode};

use casca_radiosity::Texture;
use casca_radiosity::lit::Material;

/// By triangle of a mesh: its material, and where its corners lie in the texture of that.
pub(super) type Painted = (Arc<[u32]>, Arc<[[Vec2; 3]]>);

/// The textures of a file.
pub(super) struct Paint<'a> {
    meshes: Meshes<'a>,
    images: Images<'a>,
    pub(super) textures: Vec<Texture>,
    /// By texture of the file, least opacity and factor of opacity.
    known: HashMap<(usize, u32, u32), u32>,
    /// By texture of the file: those that shine.
    lights: HashMap<usize, Texture>,
}

impl<'a> Paint<'a> {
    pub(super) fn new(file: &'a File, folder: Option<&'a Path>) -> Self {
        Self {
            meshes: Meshes::new(&file.buffers, Components::Integers),
            images: Images::new(&file.buffers, folder),
            textures: Vec::new(),
            known: HashMap::new(),
            lights: HashMap::new(),
        }
    }

    /// The mean of a texture, whose bytes stand for some numbers; 1 without one.
    pub(super) fn mean(&mut self, info: Option<Info>, of: fn(u8) -> f32) -> Result<Vec3, Trouble> {
        let Some(info) = info else { return Ok(Vec3::ONE) };
        let picture = self.images.of(&info.texture())?;
        let texels = picture.texels.chunks_exact(4);
        let (count, add) = (texels.len() as f64, |sum, t: &[u8]| {
            sum + DVec3::from_array([0, 1, 2].map(|i| of(t[i]).into()))
        });
        Ok((texels.fold(DVec3::ZERO, add) / count).as_vec3())
    }

    /// The number of a texture, in which a product of the opacity and a factor that is less than `least`
    /// is a hole.
    pub(super) fn texture(&mut self, info: Info, least: f32, factor: f32) -> Result<u32, Trouble> {
        let kind = (info.texture().index(), least.to_bits(), factor.to_bits());
        if let Some(number) = self.known.get(&kind) {
            return Ok(*number);
        }
        self.textures.push(texture_of(self.images.of(&info.texture())?, &info, least, factor)?);
        let number = self.textures.len() as u32 - 1;
        self.known.insert(kind, number);
        Ok(number)
    }

    /// A texture that shines: without holes.
    fn light(&mut self, info: &Info) -> Result<Texture, Trouble> {
        let index = info.texture().index();
        if let Some(known) = self.lights.get(&index) {
            return Ok(known.clone());
        }
        let made = texture_of(self.images.of(&info.texture())?, info, 0.0, 1.0)?;
        self.lights.insert(index, made.clone());
        Ok(made)
    }

    /// Where the vertices of a primitive lie in a texture as that goes on here: by repeating.
    fn places(&mut self, primitive: &gltf::Primitive, info: Option<Info>) -> Result<Vec<Vec2>, Trouble> {
        let (Some(info), Some(positions)) = (info, primitive.get(&gltf::Semantic::Positions)) else {
            return Ok(Vec::new());
        };
        let mut places = self.images.places(primitive, &info, positions.count())?;
        let picture = self.images.of(&info.texture())?;
        let half = 0.5 / picture.size.as_vec2();
        for (place, axis) in places.iter_mut().flat_map(|Vec2 { x, y }| [(x, 0), (y, 1)]) {
            match picture.wrap[axis] {
                WrappingMode::Repeat => {}
                // There are two of it.
                WrappingMode::MirroredRepeat => *place *= 0.5,
                // Exact for triangles inside.
                WrappingMode::ClampToEdge => *place = place.clamp(half[axis], 1.0 - half[axis]),
            }
        }
        Ok(places)
    }

    /// What is painted on a mesh, of whose triangles each belongs to a primitive. Where a texture of
    /// light is not white, materials are added that have the mean over a triangle.
    pub(super) fn mesh(
        &mut self,
        mesh: &gltf::Mesh,
        primitives: &[u32],
        materials: &mut Vec<Material>,
    ) -> Result<Painted, Trouble> {
        let mut numbers = materials_of(mesh, primitives);
        // By primitive: where vertices lie in the colours and in the light, and the light.
        let mut painted = Vec::new();
        for primitive in mesh.primitives() {
            let material = primitive.material();
            let color = self.places(&primitive, material.pbr_metallic_roughness().base_color_texture())?;
            let glow = material.emissive_texture();
            let light = match &glow {
                Some(info) => Some(self.light(info)?),
                None => None,
            };
            painted.push((color, self.places(&primitive, glow)?, light));
        }
        let mut vertices = Vec::new();
        let parted = match painted.iter().any(|(color, glow, _)| !(color.is_empty() && glow.is_empty())) {
            true => {
                self.meshes.parted(mesh, |primitive, vertex| vertices.push((primitive, vertex as usize)))?
            }
            false => None,
        };
        let Some((parted, of)) = parted else { return Ok((numbers.into(), Arc::default())) };
        let mut uv = vec![[Vec2::ZERO; 3]; primitives.len()];
        let mut rest = parted.triangles.iter().zip(&of).peekable();
        for (i, primitive) in primitives.iter().enumerate() {
            // Lines and points are not among them.
            let Some((corners, _)) = rest.next_if(|(_, p)| *p == primitive) else { continue };
            let (color, glow, light) = &painted[*primitive as usize];
            let of = |places: &[Vec2]| {
                corners.map(|v| places.get(vertices[v as usize].1).copied().unwrap_or_default())
            };
            uv[i] = of(color);
            if let Some(light) = light {
                let material = materials[numbers[i] as usize];
                let emission = material.emission * light.mean(of(glow)).0;
                if materials.last().is_none_or(|last| *last != Material { emission, ..material }) {
                    materials.push(Material { emission, ..material });
                }
                numbers[i] = materials.len() as u32 - 1;
            }
        }
        Ok((numbers.into(), uv.into()))
    }
}

/// A picture as it is repeated: twice along an axis on which it is mirrored.
fn texture_of(picture: &Picture, info: &Info, least: f32, factor: f32) -> Result<Texture, Trouble> {
    let [w, h] = picture.size.to_array();
    let [across, down] = picture.wrap.map(|w| 1 + u32::from(w == WrappingMode::MirroredRepeat));
    let texel = |(x, y): (u32, u32)| {
        let (x, y) = (x.min(2 * w - 1 - x), y.min(2 * h - 1 - y));
        let at = 4 * (y as usize * w as usize + x as usize);
        let color = Vec3::from_array([0, 1, 2].map(|i| linear_of(picture.texels[at + i])));
        let opacity = f32::from(picture.texels[at + 3]) / 255.0 * factor;
        color.extend(if opacity < least { 0.0 } else { 1.0 })
    };
    let texels = (0..down * h).flat_map(|y| (0..across * w).map(move |x| (x, y))).map(texel);
    let image = info.texture().source().index();
    Texture::new(across * w, down * h, texels).map_err(|why| Trouble::Part(format!("image {image} {why}")))
}
