//! Buffers whose bytes a file has only as views that `EXT_meshopt_compression` packs.

use std::collections::HashMap;
use std::rc::Rc;

use casca_meshopt::unpacked;
use gltf::buffer::View;
use serde_json::Value;

use super::accessors::Buffers;
use super::error::{Trouble, unread};

/// The names of the extension: the old one, and the one since Khronos ratified it.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Bytes that views of any file may unpack to, and in addition for each byte of its buffers. Files
/// of gltfpack take some six; only zeros take more than thirty.
const FREE: usize = 1 << 20;
const FOR_A_BYTE: usize = 32;

/// What the extension says of a view, if it is packed.
pub(super) fn packed<'a>(view: &'a View) -> Option<&'a Value> {
    MESHOPT.iter().find_map(|name| view.extension_value(name))
}

/// Fills the buffers that have no bytes of their own from packed views.
pub(super) fn unpack(
    document: &gltf::Document,
    buffers: Vec<Option<Rc<Vec<u8>>>>,
) -> Result<Buffers, Trouble> {
    let held = buffers.iter().flatten().map(|bytes| bytes.len()).fold(0, usize::saturating_add);
    let mut left = held.saturating_mul(FOR_A_BYTE).saturating_add(FREE);
    let mut spend = |buffer: usize, size: Option<usize>| {
        let rest = size.and_then(|size| left.checked_sub(size));
        left = rest.ok_or_else(|| unread(buffer, "it unpacks to too much"))?;
        Ok::<_, Trouble>(())
    };
    let mut made: HashMap<usize, Vec<u8>> = HashMap::new();
    for buffer in document.buffers().filter(|buffer| buffers[buffer.index()].is_none()) {
        spend(buffer.index(), Some(buffer.length()))?;
        made.insert(buffer.index(), vec![0; buffer.length()]);
    }
    let size = made.values().map(Vec::len).sum();
    for view in document.views() {
        let index = view.buffer().index();
        let (Some(said), Some(bytes)) = (packed(&view), made.get_mut(&index)) else { continue };
        let number = |name: &str| said[name].as_u64().and_then(|n| usize::try_from(n).ok());
        let (count, stride) = (number("count").unwrap_or(0), number("byteStride").unwrap_or(0));
        spend(index, count.checked_mul(stride))?;
        let fail = || unread(index, &format!("what buffer view {} packs is damaged", view.index()));
        let from = number("byteOffset").unwrap_or(0);
        let end = number("byteLength").and_then(|length| from.checked_add(length)).unwrap_or(usize::MAX);
        let source = number("buffer").and_then(|source| buffers.get(source)?.as_ref()?.get(from..end));
        let (mode, filter) = (said["mode"].as_str().unwrap_or(""), said["filter"].as_str().unwrap_or("NONE"));
        let new = source.and_then(|source| unpacked(mode, filter, source, count, stride)).ok_or_else(fail)?;
        let place = bytes.get_mut(view.offset()..).and_then(|bytes| bytes.get_mut(..new.len()));
        place.filter(|_| new.len() <= view.length()).ok_or_else(fail)?.copy_from_slice(&new);
    }
    let all = buffers.into_iter().enumerate();
    let all = all.map(|(i, held)| held.unwrap_or_else(|| Rc::new(made.remove(&i).unwrap_or_default())));
    Ok(Buffers::new(all.collect(), size))
}
