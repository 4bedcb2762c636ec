//! Primitives that `KHR_draco_mesh_compression` packs. They are unpacked into one more buffer, and
//! get accessors that read it.

use std::collections::HashMap;
use std::rc::Rc;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointIndex};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Buffer, View};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::{self, Valid};
use gltf::json::{Accessor, Index, Root};
use serde_json::Value;

use super::accessors::Buffers;
use super::error::Trouble;
use super::warnings::Warnings;

/// The name of the extension.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";
/// Bytes that any file may unpack to, and in addition for each byte of its buffers. Meshes take ten
/// to twenty, a flat grid of a million vertices a hundred; unpacking needs eight times as many.
const FREE: usize = 1 << 24;
const FOR_A_BYTE: usize = 128;
/// Bytes of an unpacked index, and of a triangle of three.
const INDEX: usize = 4;
const TRIANGLE: usize = 3 * INDEX;

const TOO_MUCH: &str = "unpacks to too much";
const OTHER: &str = "is of another type than its accessor";
/// A warning.
const TWICE: &str =
    "is there twice, plain and packed by Draco, which rounds: the plain form is read; draw that one";

/// A document whose primitives are unpacked.
struct Unpacked {
    root: Root,
    /// The bytes of its last buffer.
    bytes: Vec<u8>,
    /// Bytes that may still be unpacked.
    left: usize,
    /// By buffer view.
    streams: HashMap<usize, Rc<Mesh>>,
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
    let mut unpacked = Unpacked {
        root: document.as_json().clone(),
        bytes: Vec::new(),
        left: buffers.bytes().saturating_mul(FOR_A_BYTE).saturating_add(FREE),
        streams: HashMap::new(),
        accessors: HashMap::new(),
    };
    for (m, mesh) in meshes.iter_mut().enumerate() {
        for (p, primitive) in mesh.primitives.iter_mut().enumerate() {
            let Some(said) = said(primitive).cloned() else { continue };
            if !required && !unpacked.is_bare(primitive) {
                warnings.add(format!("primitive {p} of mesh {m}"), TWICE);
                continue;
            }
            let view = said["bufferView"].as_u64().and_then(|i| views.get(usize::try_from(i).ok()?));
            view.ok_or_else(|| "its buffer view is not there".to_owned())
                .and_then(|view| {
                    let packed = buffers.view(view).map_err(|why| why.to_string())?;
                    unpacked.primitive(primitive, &said["attributes"], view.index(), packed)
                })
                .map_err(|why| Trouble::Packed { mesh: m, primitive: p, why })?;
        }
    }
    let Unpacked { mut root, bytes, .. } = unpacked;
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

impl Unpacked {
    /// Whether the positions of a primitive have no bytes, so that they would all be zeros.
    fn is_bare(&self, primitive: &Primitive) -> bool {
        let accessor = primitive.attributes.get(&Valid(Semantic::Positions));
        let accessor = accessor.and_then(|accessor| self.root.get(*accessor));
        accessor.is_some_and(|a| a.buffer_view.is_none() && a.sparse.is_none())
    }

    /// Has the accessors of a primitive read what a buffer view packs.
    fn primitive(
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
            let mesh = Rc::new(self.unpack(packed)?);
            self.streams.insert(view, mesh);
        }
        let mesh = self.streams[&view].clone();
        let indices = primitive.indices.as_mut().ok_or("it has no indices")?;
        let read = self.accessor(view, None, *indices, &mesh);
        *indices = read.map_err(|why| format!("its triangles {why}"))?;
        for (semantic, accessor) in &mut primitive.attributes {
            let name = semantic.to_string();
            let Some(number) = numbers[&name].as_u64() else { continue };
            let number = u32::try_from(number).map_err(|_| format!("it has no {name}"))?;
            let read = self.accessor(view, Some(number), *accessor, &mesh);
            *accessor = read.map_err(|why| format!("its {name} {why}"))?;
        }
        if self.is_bare(primitive) { Err("it has no positions".to_owned()) } else { Ok(()) }
    }

    fn unpack(&mut self, packed: &[u8]) -> Result<Mesh, String> {
        // What it takes to read counts, too: views may lie in the same bytes.
        self.spend(packed.len()).map_err(|why| format!("it {why}"))?;
        let most = self.left as u64;
        let limits = DecodeLimits::default()
            .with_max_decoded_bytes(most)
            .with_max_faces(most / TRIANGLE as u64)
            .with_max_points(most);
        let mut mesh = Mesh::new();
        let unpacked =
            MeshDecoder::new().decode(&mut DecoderBuffer::new(packed).with_limits(limits), &mut mesh);
        unpacked.map_err(|why| match why.kind() {
            ErrorKind::LimitExceeded | ErrorKind::AllocationExceedsInput => format!("it {TOO_MUCH}"),
            _ => why.to_string(),
        })?;
        Ok(mesh)
    }

    fn spend(&mut self, bytes: usize) -> Result<(), &'static str> {
        self.left = self.left.checked_sub(bytes).ok_or(TOO_MUCH)?;
        Ok(())
    }

    /// An accessor that reads an attribute of a mesh, or its indices, in the place of one that has
    /// no bytes.
    fn accessor(
        &mut self,
        view: usize,
        number: Option<u32>,
        old: Index<Accessor>,
        mesh: &Mesh,
    ) -> Result<Index<Accessor>, &'static str> {
        let key = (view, number, old.value());
        if let Some(known) = self.accessors.get(&key) {
            return Ok(*known);
        }
        let mut new = self.root.get(old).cloned().ok_or("is not there")?;
        let start = self.bytes.len();
        let count = match number {
            None => {
                let corners = mesh.faces().as_flattened();
                self.spend(corners.len() * INDEX)?;
                self.bytes.extend(corners.iter().flat_map(|corner| corner.0.to_le_bytes()));
                new.component_type = Valid(GenericComponentType(ComponentType::U32));
                corners.len()
            }
            Some(number) => {
                self.values(mesh, number, (new.component_type, new.type_))?;
                mesh.num_points()
            }
        };
        let view = View {
            buffer: Index::new(self.root.buffers.len() as u32),
            byte_length: (self.bytes.len() - start).into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        };
        (new.buffer_view, new.byte_offset, new.sparse) = (Some(self.root.push(view)), None, None);
        new.count = count.into();
        let new = self.root.push(new);
        self.accessors.insert(key, new);
        Ok(new)
    }

    /// Adds the values of all points of a mesh.
    fn values(
        &mut self,
        mesh: &Mesh,
        number: u32,
        kind: (Checked<GenericComponentType>, Checked<Type>),
    ) -> Result<(), &'static str> {
        let attribute = mesh.attribute_by_unique_id(number).ok_or("is not there")?;
        let (Valid(GenericComponentType(component)), Valid(kind)) = kind else { return Err(OTHER) };
        let is_so = data_type_of(component) == attribute.data_type()
            && kind.multiplicity() == usize::from(attribute.num_components());
        if !is_so {
            return Err(OTHER);
        }
        let size = component.size() * kind.multiplicity();
        self.spend(size.checked_mul(mesh.num_points()).ok_or(TOO_MUCH)?)?;
        for point in 0..mesh.num_points() {
            let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
            let start = value.checked_mul(size);
            let value =
                start.and_then(|start| attribute.buffer().data().get(start..start.checked_add(size)?));
            self.bytes.extend_from_slice(value.ok_or("has points without values")?);
        }
        Ok(())
    }
}

fn data_type_of(component: ComponentType) -> DataType {
    match component {
        ComponentType::I8 => DataType::Int8,
        ComponentType::U8 => DataType::Uint8,
        ComponentType::I16 => DataType::Int16,
        ComponentType::U16 => DataType::Uint16,
        ComponentType::U32 => DataType::Uint32,
        ComponentType::F32 => DataType::Float32,
    }
}
