//! Meshes as `KHR_draco_mesh_compression` packs them: unpacked by `draco-core`, which has no unsafe
//! code, within limits. Damaged bytes give an error.

use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointIndex};

/// What was packed.
pub struct Unpacked(Mesh);

/// Unpacks a mesh of triangles to no more than `most` bytes; on the way it takes up to eight times as
/// many.
///
/// # Errors
/// The bytes are damaged, or are too many when unpacked.
pub fn unpacked(packed: &[u8], most: usize) -> Result<Unpacked, String> {
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(most as u64)
        .with_max_faces((most / size_of::<[u32; 3]>()) as u64);
    let mut mesh = Mesh::new();
    match MeshDecoder::new().decode(&mut DecoderBuffer::new(packed).with_limits(limits), &mut mesh) {
        Ok(()) if mesh.num_faces() == 0 => Err("it has no triangles".to_owned()),
        Ok(()) => Ok(Unpacked(mesh)),
        Err(why) if matches!(why.kind(), ErrorKind::LimitExceeded | ErrorKind::AllocationExceedsInput) => {
            Err("it unpacks to too much".to_owned())
        }
        Err(why) => Err(format!("it is damaged, or is no mesh ({why})")),
    }
}

impl Unpacked {
    /// How many corners triangles have, three each.
    pub fn corners(&self) -> usize {
        self.0.num_faces().saturating_mul(3)
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.0.num_points()
    }

    /// The numbers of points at the corners of triangles, each in four bytes, lowest first.
    pub fn indices(&self) -> Vec<u8> {
        self.0.faces().as_flattened().iter().flat_map(|corner| corner.0.to_le_bytes()).collect()
    }

    /// The values of all points in the attribute of a number, which has so many components of a type
    /// of glTF; `None` if there is no such attribute.
    pub fn values(&self, number: u32, component: u32, components: usize) -> Option<Vec<u8>> {
        let attribute = self.0.attribute_by_unique_id(number)?;
        let data_type = attribute.data_type();
        if of_gltf(data_type)? != component || usize::from(attribute.num_components()) != components {
            return None;
        }
        let size = data_type.byte_length() * components;
        let mut bytes = Vec::with_capacity(self.points().checked_mul(size)?);
        for point in 0..self.points() as u32 {
            let start = (attribute.mapped_index(PointIndex(point)).0 as usize).checked_mul(size)?;
            bytes.extend_from_slice(attribute.buffer().data().get(start..start.checked_add(size)?)?);
        }
        Some(bytes)
    }
}

/// The number that glTF has for a type of components.
fn of_gltf(data_type: DataType) -> Option<u32> {
    match data_type {
        DataType::Int8 => Some(5120),
        DataType::Uint8 => Some(5121),
        DataType::Int16 => Some(5122),
        DataType::Uint16 => Some(5123),
        DataType::Uint32 => Some(5125),
        DataType::Float32 => Some(5126),
        _ => None,
    }
}
