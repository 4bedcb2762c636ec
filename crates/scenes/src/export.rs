//! glTF files that are written.

use gltf::binary::{Glb, Header};
use serde_json::Value;

/// A .glb file of a document and its buffer; `None` beyond 4 GB. Empty lists go: glTF has none.
pub fn container(mut document: Value, bytes: Vec<u8>) -> Option<Vec<u8>> {
    if let Some(members) = document.as_object_mut() {
        members.retain(|_, list| list.as_array().is_none_or(|list| !list.is_empty()));
    }
    // The length is found as the file is written.
    let header = Header { magic: *b"glTF", version: 2, length: 0 };
    let json = document.to_string().into_bytes().into();
    let file = Glb { header, json, bin: Some(bytes.into()) }.to_vec().ok()?;
    u32::try_from(file.len()).is_ok().then_some(file)
}
