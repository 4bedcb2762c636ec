//! Primitives that `KHR_draco_mesh_compression` packs. They are unpacked into one more buffer, and
//! get accessors that read it.

use std::collections::HashMap;
use std::rc::Rc;

use casca_draco::{Unpacked, unpacked};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Buffer, View};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Index, Root};
use serde_json::Value;

use super::accessors::Buffers;
use super::error::Trouble;
use super::warnings::Warnings;

/// The name of the extension.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";
/// Bytes that any file may unpack to, and in addition for each byte of its buffers. Meshes take ten
/// to twenty, a flat grid of a million vertices a hundred.
const FREE: usize = 1 << 24;
const FOR_A_BYTE: usize = 128;

const TWICE: &str =
    "is there twice, plain and packed by Draco, which rounds: the plain form is read; draw that one";
const ADVICE: &str = "; export it anew, or without compression";

/// A document whose primitives are unpacked.
struct Document {
    root: Root,
    /// The bytes of its last buffer.
    bytes: Vec<u8>,
    /// Bytes that may still be unpacked.
    left: usize,
    /// By buffer view.
    streams: HashMap<usize, Rc<Unpacked>>,
    /// By buffer view, attribute there or none for indices, and the accessor without bytes.
    accessors: HashMap<(usize, Option<u32>, usize), Index<Accessor>>,
}

/// Unpacks the primitives that are there in no other form, and all if each program must.
pub(super) fn unpack_primitives(
    document: gltf::Document,
    buffers: &mut Buffers,
    warnings: &Warnings,
) -> Result<gltf::Document, Trouble> {
    let mut meshes = document.as_json().meshes.clone();
    if !meshes.iter().flat_map(|mesh| &mesh.primitives).any(|p| said(p).is_some()) {
        return Ok(document);
    }
    let required = document.extensions_required().any(|name| name == DRACO);
    let views: Vec<_> = document.views().collect();
    let mut new = Document {
        root: document.as_json().clone(),
        bytes: Vec::new(),
        left: buffers.bytes().saturating_mul(FOR_A_BYTE).saturating_add(FREE),
        streams: HashMap::new(),
        accessors: HashMap::new(),
    };
    for (m, mesh) in meshes.iter_mut().enumerate() {
        for (p, primitive) in mesh.primitives.iter_mut().enumerate() {
            let Some(said) = said(primitive).cloned() else { continue };
            let place = format!("primitive {p} of mesh {m}");
            if !required && !new.is_bare(primitive) {
                warnings.add(place, TWICE);
                continue;
            }
            let view = said["bufferView"].as_u64().and_then(|i| views.get(usize::try_from(i).ok()?));
            view.ok_or_else(|| "its buffer view is not there".to_owned())
                .and_then(|view| {
                    let packed = buffers.view(view).map_err(|why| why.to_string())?;
                    new.unpack(primitive, &said["attributes"], view.index(), packed)
                })
                .map_err(|why| format!("{place} is packed by Draco, and cannot be had: {why}{ADVICE}"))
                .map_err(Trouble::Part)?;
        }
    }
    let Document { mut root, bytes, .. } = new;
    root.meshes = meshes;
    let byte_length = bytes.len().into();
    root.push(Buffer { byte_length, name: None, uri: None, extensions: None, extras: None });
    buffers.add(bytes);
    Ok(gltf::Document::from_json_without_validation(root))
}

/// What the extension says of a primitive, if it is packed.
fn said(primitive: &Primitive) -> Option<&Value> {
    primitive.extensions.as_ref()?.others.get(DRACO)
}

impl Document {
    /// Whether the positions or indices of a primitive have no bytes, so that they would be zeros.
    fn is_bare(&self, primitive: &Primitive) -> bool {
        let positions = primitive.attributes.get(&Valid(Semantic::Positions)).copied();
        let mut accessors = [positions, primitive.indices].into_iter().flatten();
        let zeros = |a: &Accessor| a.buffer_view.is_none() && a.sparse.is_none();
        accessors.any(|accessor| self.root.get(accessor).is_some_and(zeros))
    }

    /// Unpacks a primitive from a buffer view. Its accessors read the unpacked bytes from then on.
    fn unpack(
        &mut self,
        primitive: &mut Primitive,
        numbers: &Value,
        view: usize,
        packed: &[u8],
    ) -> Result<(), String> {
        if primitive.mode != Valid(Mode::Triangles) {
            return Err("it is not of triangles".to_owned());
        }
        if !self.streams.contains_key(&view) {
            // What it takes to read counts, too: views may lie in the same bytes.
            self.spend(Some(packed.len()))?;
            self.streams.insert(view, Rc::new(unpacked(packed, self.left)?));
        }
        let mesh = self.streams[&view].clone();
        let indices = primitive.indices.as_mut().ok_or("it has no indices")?;
        *indices = self.accessor(view, None, *indices, &mesh)?;
        for (semantic, accessor) in &mut primitive.attributes {
            let name = semantic.to_string();
            let Some(number) = numbers[&name].as_u64().and_then(|n| u32::try_from(n).ok()) else { continue };
            let read = self.accessor(view, Some(number), *accessor, &mesh);
            *accessor = read.map_err(|why| format!("{name}: {why}"))?;
        }
        if self.is_bare(primitive) { Err("it has no positions".to_owned()) } else { Ok(()) }
    }

    fn spend(&mut self, bytes: Option<usize>) -> Result<(), &'static str> {
        self.left = bytes.and_then(|bytes| self.left.checked_sub(bytes)).ok_or("it unpacks to too much")?;
        Ok(())
    }

    /// An accessor that reads an attribute of a mesh, or its indices, in the place of one that has
    /// no bytes.
    fn accessor(
        &mut self,
        view: usize,
        number: Option<u32>,
        old: Index<Accessor>,
        mesh: &Unpacked,
    ) -> Result<Index<Accessor>, &'static str> {
        let key = (view, number, old.value());
        if let Some(known) = self.accessors.get(&key) {
            return Ok(*known);
        }
        let mut new = self.root.get(old).cloned().ok_or("it has no accessor")?;
        if number.is_none() {
            (new.component_type, new.type_) =
                (Valid(GenericComponentType(ComponentType::U32)), Valid(Type::Scalar));
        }
        let (Valid(GenericComponentType(component)), Valid(kind)) = (new.component_type, new.type_) else {
            return Err("it has no type");
        };
        let count = if number.is_none() { mesh.corners() } else { mesh.points() };
        self.spend(count.checked_mul(component.size() * kind.multiplicity()))?;
        let bytes = match number {
            None => mesh.indices(),
            Some(number) => mesh
                .values(number, component.as_gl_enum(), kind.multiplicity())
                .ok_or("it is not there, or of another type than its accessor")?,
        };
        let view = self.root.push(View {
            buffer: Index::new(self.root.buffers.len() as u32),
            byte_length: bytes.len().into(),
            byte_offset: Some(self.bytes.len().into()),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        });
        self.bytes.extend(bytes);
        (new.buffer_view, new.byte_offset, new.sparse) = (Some(view), None, None);
        new.count = count.into();
        let new = self.root.push(new);
        self.accessors.insert(key, new);
        Ok(new)
    }
}
