//! Levels in glTF files: what of them can have a lightmap, and the files with it.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use casca_lit::read_lit;
use casca_radiosity::lit::LitScene;
use casca_scenes::export::container;
use casca_scenes::import::Trouble;
use casca_scenes::import::parts::{Components, File, Known, Meshes, Warnings, beside, contents, parse};
use casca_scenes::world::{Motion, Shape};
use glam::{DVec3, Vec3};
use gltf::Accessor;
use gltf::accessor::DataType;
use serde_json::{Map, Value, json};

use uvunwrap::OutputMesh;

use crate::atlas::Placed;
use crate::{BakeError, Light, Settings, ktx2};

/// The member of `extras` that holds what was baked.
const KEY: &str = "casca_light";
/// Bytes of an image in a file of its own.
const MOST_BYTES: usize = 1 << 28;
/// Floats, and indices of 32 bits, as files call them.
const F32: u32 = 5126;
const U32: u32 = 5125;

/// A mesh that has a lightmap.
struct Baked {
    mesh: usize,
    /// By triangle: its primitive.
    primitives: Vec<u32>,
    /// By vertex: its primitive and its number there.
    vertices: Vec<(usize, u32)>,
    /// By place: its node.
    nodes: Vec<usize>,
}

/// A glTF file that is to be lit.
pub struct Level<'a> {
    /// Its scene, which may be changed before it is lit.
    pub scene: LitScene,
    /// Its meshes that stand still, and where.
    pub placed: Vec<Placed>,
    /// What of it gets no lightmap, and why, and what else is not as its author may expect: a line each.
    pub warnings: Vec<String>,
    file: File<'a>,
    /// Its text as it was.
    root: Value,
    folder: Option<&'a Path>,
    baked: Vec<Baked>,
    origin: DVec3,
}

impl<'a> Level<'a> {
    /// Reads a level from the bytes of a file; other files that it names are looked for from `folder`.
    ///
    /// Lightmaps are for meshes of nodes that neither move, nor have a skin, morph targets or instances
    /// of an extension.
    ///
    /// # Errors
    /// As [`casca_lit::read_lit`], and nothing stands still.
    pub fn read(name: &str, bytes: &'a [u8], folder: Option<&'a Path>) -> Result<Self, BakeError> {
        let scene = read_lit(name, bytes, folder)?;
        let warnings = Warnings::default();
        let file = parse(bytes, folder, &warnings)?;
        let world = contents(name, &file, &warnings)?;
        let text = |why: serde_json::Error| Trouble::Format(format!("its JSON: {why}"));
        let root: Value = serde_json::from_slice(file.json).map_err(text)?;
        let mut count: HashMap<usize, usize> = HashMap::new();
        world.source.parts.iter().for_each(|part| *count.entry(part.node).or_default() += 1);
        // By mesh, in order.
        let mut still: BTreeMap<usize, Vec<(usize, glam::Affine3A)>> = BTreeMap::new();
        let nodes: Vec<gltf::Node> = file.document.nodes().collect();
        for (object, part) in world.objects.iter().zip(&world.source.parts) {
            if let (Motion::Static, Shape::Mesh { transform, .. }, Some(mesh), 1) =
                (object.motion, &object.shape, nodes[part.node].mesh(), count[&part.node])
            {
                still.entry(mesh.index()).or_default().push((part.node, *transform));
            }
        }
        let mut meshes = Meshes::new(&file.buffers, Components::Integers);
        let (mut placed, mut baked) = (Vec::new(), Vec::new());
        for mesh in file.document.meshes() {
            let Some(places) = still.remove(&mesh.index()) else { continue };
            if let Some(why) = refused(&mesh, &root) {
                warnings.add(format!("mesh {}", mesh.index()), &format!("gets no lightmap: {why}"));
                continue;
            }
            let mut vertices = Vec::new();
            let Some((joined, primitives)) = meshes.parted(&mesh, |p, v| vertices.push((p, v)))? else {
                continue;
            };
            let (nodes, places) = places.into_iter().unzip();
            placed.push(Placed { mesh: joined, places });
            baked.push(Baked { mesh: mesh.index(), primitives, vertices, nodes });
        }
        if placed.is_empty() {
            return Err(BakeError::NothingStill);
        }
        let (warnings, origin) = (warnings.lines(), world.source.origin);
        Ok(Self { scene, placed, warnings, file, root, folder, baked, origin })
    }

    /// The files of the lit level: `name.glb` first, and then the images that it names, which lie beside
    /// it.
    ///
    /// All of the level is as it was, but for the vertices of meshes with a lightmap, which are more, and
    /// `TEXCOORD_1` of them, which is `TEXCOORD_0`, too, if there was none; strips and fans become triangles,
    /// buffers become one, and images become part of the file. `extras.casca_light` of a node names its page,
    /// from 0, and the rectangle of it in which `TEXCOORD_1` lies, as the least x and y and the greatest ones.
    /// That of the scene names the images of all pages; that of the probes, their box, their counts and the
    /// spacing that they were made for; the radiance of the sky; and whether the light of lights that are no
    /// surfaces is baked.
    ///
    /// # Errors
    /// Something that the file names is missing, or the files would be too large.
    pub fn lit(
        &self,
        name: &str,
        light: &Light,
        settings: &Settings,
    ) -> Result<Vec<(String, Vec<u8>)>, BakeError> {
        let mut writer = Writer { root: self.root.clone(), bytes: Vec::new() };
        writer.take_over(&self.file, self.folder)?;
        for (baked, layout) in self.baked.iter().zip(&light.atlas.meshes) {
            writer.mesh(&self.file, baked, layout)?;
            for (node, rect) in baked.nodes.iter().zip(&layout.instances) {
                let uv_rect = [rect.min, rect.max].concat();
                writer.extra("nodes", *node, json!({"lightmap": rect.page, "uv_rect": uv_rect}));
            }
        }
        let (width, height) = (light.atlas.width, light.atlas.height);
        let pages = light.texels.chunks((width * height).max(1) as usize);
        let mut files: Vec<(String, Vec<u8>)> = (0..)
            .zip(pages)
            .map(|(i, page)| (format!("{name}.lightmap{i}.ktx2"), ktx2::file([width, height, 0], page)))
            .collect();
        let lightmaps: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        let probes = &light.probes;
        let box_of = |p: Vec3| (p.as_dvec3() + self.origin).to_array();
        let image = format!("{name}.probes.ktx2");
        let extra = json!({
            "lightmaps": lightmaps,
            "probes": {"image": image, "min": box_of(probes.min), "max": box_of(probes.max),
                "counts": probes.counts.to_array(), "spacing": settings.spacing},
            "sky": self.scene.sky.to_array(),
            "lights": if settings.live { "live" } else { "baked" },
        });
        writer.extra("scenes", self.file.document.default_scene().map_or(0, |s| s.index()), extra);
        let (size, texels) = probes.texture();
        files.push((image, ktx2::file(size.to_array(), &texels)));
        files.insert(0, (format!("{name}.glb"), writer.finish()?));
        Ok(files)
    }
}

/// Whether a text says anywhere that a texture lies in the second set of coordinates.
fn uses_second_set(text: &Value) -> bool {
    match text {
        Value::Array(list) => list.iter().any(uses_second_set),
        Value::Object(map) => map.iter().any(|(k, v)| (k == "texCoord" && v == 1) || uses_second_set(v)),
        _ => false,
    }
}

/// Why a mesh has no lightmap, if it has none. Its primitives are seen as the file has them, since what
/// is read here lacks what is not drawn.
fn refused(mesh: &gltf::Mesh, root: &Value) -> Option<&'static str> {
    for primitive in mesh.primitives() {
        let material = primitive.material().index().map(|i| &root["materials"][i]);
        let is_plain = |a: &Accessor| a.sparse().is_none() && a.view().is_some();
        if material.is_some_and(uses_second_set) {
            return Some("a texture of it uses TEXCOORD_1; let that use TEXCOORD_0");
        }
        if primitive.morph_targets().len() > 0 {
            return Some("it has morph targets");
        }
        if !primitive.attributes().all(|(_, accessor)| is_plain(&accessor)) {
            return Some("its vertices are stored as differences, or not at all");
        }
    }
    None
}

/// A file in the making: its text and its bytes.
struct Writer {
    root: Value,
    bytes: Vec<u8>,
}

/// An object in a member of another; what is there of another kind is replaced.
fn object<'a>(of: &'a mut Value, member: &str) -> &'a mut Map<String, Value> {
    let found = &mut of[member];
    if !found.is_object() {
        *found = json!({});
    }
    found.as_object_mut().expect("it was made one")
}

impl Writer {
    /// Adds an item to a list of the file; returns its number.
    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = &mut self.root[list];
        if !list.is_array() {
            *list = json!([]);
        }
        let list = list.as_array_mut().expect("it was made one");
        list.push(item);
        list.len() - 1
    }

    /// Adds bytes, from a multiple of four on; returns where.
    fn add(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.bytes.extend(bytes);
        self.bytes.len() - bytes.len()
    }

    fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.add(bytes), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.push("bufferViews", view)
    }

    /// The bytes of all views, and images of other files.
    fn take_over(&mut self, file: &File, folder: Option<&Path>) -> Result<(), BakeError> {
        for view in file.document.views() {
            let at = self.add(file.buffers.view(&view)?);
            let text = &mut self.root["bufferViews"][view.index()];
            (text["buffer"], text["byteOffset"]) = (0.into(), at.into());
            // Packed bytes lie elsewhere.
            text.as_object_mut().map(|view| view.remove("extensions"));
        }
        for list in ["extensionsUsed", "extensionsRequired"] {
            if let Some(Value::Array(names)) = self.root.get_mut(list) {
                names
                    .retain(|name| !name.as_str().is_some_and(|name| name.ends_with("_meshopt_compression")));
            }
        }
        let mut known = Known::new();
        for image in file.document.images() {
            let gltf::image::Source::Uri { uri, .. } = image.source() else { continue };
            if uri.is_empty() || uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
                continue;
            }
            // One that no material reads may be missing, and one of another kind is found by its name.
            let Ok(bytes) = beside(folder, uri, MOST_BYTES, &mut known) else { continue };
            let kind = match &bytes[..] {
                [0x89, b'P', b'N', b'G', ..] => "image/png",
                [0xff, 0xd8, ..] => "image/jpeg",
                _ => continue,
            };
            let view = self.view(&bytes, None);
            let text = &mut self.root["images"][image.index()];
            (text["bufferView"], text["mimeType"]) = (view.into(), kind.into());
            text.as_object_mut().map(|image| image.remove("uri"));
        }
        Ok(())
    }

    /// Says what was baked of an item of a list.
    fn extra(&mut self, list: &str, number: usize, what: Value) {
        let item = match self.root[list].get_mut(number) {
            Some(item) => item,
            // A file without scenes.
            None => &mut self.root,
        };
        object(item, "extras").insert(KEY.to_owned(), what);
    }

    /// Gives the primitives of a mesh vertices with the coordinates of a layout.
    fn mesh(&mut self, file: &File, baked: &Baked, layout: &OutputMesh) -> Result<(), BakeError> {
        let Some(mesh) = file.document.meshes().nth(baked.mesh) else { return Ok(()) };
        for primitive in mesh.primitives() {
            // New numbers of the vertices of this primitive, and its triangles.
            let mut new: HashMap<u32, u32> = HashMap::new();
            let (mut kept, mut uv, mut indices) = (Vec::new(), Vec::new(), Vec::new());
            let of =
                |(triangle, p): (&[u32; 3], &u32)| (*p as usize == primitive.index()).then_some(*triangle);
            for vertex in
                layout.indices.as_chunks::<3>().0.iter().zip(&baked.primitives).filter_map(of).flatten()
            {
                let next = kept.len() as u32;
                indices.push(*new.entry(vertex).or_insert_with(|| {
                    let of = layout.vertices[vertex as usize];
                    kept.push(baked.vertices[of.xref as usize].1);
                    uv.push(of.uv);
                    next
                }));
            }
            // Lines and points stay as they are.
            if indices.is_empty() {
                continue;
            }
            let mut attributes = Map::new();
            let old = self.root["meshes"][baked.mesh]["primitives"][primitive.index()]["attributes"].clone();
            for (name, number) in old.as_object().into_iter().flatten() {
                let accessor = number.as_u64().and_then(|i| file.document.accessors().nth(i as usize));
                // Broken ones that nothing needs are left out.
                if let Some(bytes) = accessor.and_then(|a| gathered(file, &a, &kept).map(|b| (a, b))) {
                    let number = self.like(&bytes.0, bytes.1, kept.len(), name);
                    attributes.insert(name.clone(), number.into());
                }
            }
            let uv: Vec<u8> = uv.into_iter().flatten().flat_map(f32::to_le_bytes).collect();
            let number = self.accessor((&uv, Some(8)), kept.len(), F32, "VEC2");
            attributes.insert("TEXCOORD_1".to_owned(), number.into());
            // Sets start with 0, and Bevy draws nothing that has a second one alone.
            attributes.entry("TEXCOORD_0").or_insert_with(|| number.into());
            let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
            let number = self.accessor((&bytes, None), indices.len(), U32, "SCALAR");
            let text = &mut self.root["meshes"][baked.mesh]["primitives"][primitive.index()];
            (text["attributes"], text["indices"], text["mode"]) =
                (attributes.into(), number.into(), 4.into());
        }
        Ok(())
    }

    fn accessor(&mut self, view: (&[u8], Option<usize>), count: usize, component: u32, kind: &str) -> usize {
        let view = self.view(view.0, view.1);
        let text = json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        self.push("accessors", text)
    }

    /// An accessor like another, with so many other elements.
    fn like(&mut self, old: &Accessor, (bytes, wide): (Vec<u8>, usize), count: usize, name: &str) -> usize {
        let mut text = self.root["accessors"][old.index()].clone();
        text["bufferView"] = self.view(&bytes, Some(wide)).into();
        text["count"] = count.into();
        text.as_object_mut().map(|text| text.remove("byteOffset"));
        if name == "POSITION" && old.data_type() == DataType::F32 {
            let floats = bytes.as_chunks().0.iter().map(|b: &[u8; 4]| f32::from_le_bytes(*b));
            let floats: Vec<f32> = floats.collect();
            let all = floats.as_chunks().0.iter().map(|p: &[f32; 3]| Vec3::from_array(*p));
            let (low, high) =
                all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            (text["min"], text["max"]) = (json!(low.to_array()), json!(high.to_array()));
        }
        self.push("accessors", text)
    }

    fn finish(mut self) -> Result<Vec<u8>, BakeError> {
        self.root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        container(self.root, self.bytes).ok_or(BakeError::TooLarge)
    }
}

/// Some elements of an accessor, bit for bit, from multiples of four bytes on, and how many bytes each
/// takes; `None` where they are not all there.
fn gathered(file: &File, from: &Accessor, kept: &[u32]) -> Option<(Vec<u8>, usize)> {
    file.buffers.check(from, "an attribute").ok()?;
    let view = from.view().filter(|_| from.sparse().is_none())?;
    let (size, all) = (from.size(), file.buffers.view(&view).ok()?);
    let (step, wide) = (view.stride().unwrap_or(size), size.next_multiple_of(4));
    let mut bytes = Vec::with_capacity(kept.len() * wide);
    for vertex in kept.iter().map(|v| *v as usize) {
        let at = from.offset() + vertex * step;
        bytes.extend(all.get(at..at + size).filter(|_| vertex < from.count())?);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Some((bytes, wide))
}
