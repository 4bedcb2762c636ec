//! The bytes of buffers: from the binary chunk, from data URIs and from other files.

use std::collections::{HashMap, HashSet};
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::buffer::Source;
use percent_encoding::percent_decode_str;

use super::error::{Trouble, short, unread};
use super::packed::packed;

/// Files that were read, by their paths without detours: many buffers may name the same.
pub type Known = HashMap<PathBuf, Rc<Vec<u8>>>;

/// Reads all buffers; each holds at least as many bytes as the file says. `None` is one that cannot
/// be had, but that packed views fill.
pub fn buffers_of(
    document: &gltf::Document,
    mut blob: Option<Vec<u8>>,
    folder: Option<&Path>,
) -> Result<Vec<Option<Rc<Vec<u8>>>>, Trouble> {
    let filled = document.views().filter(|view| packed(view).is_some()).map(|view| view.buffer().index());
    let filled: HashSet<usize> = filled.collect();
    let mut buffers = Vec::new();
    let mut known = Known::new();
    let most = document.buffers().map(|buffer| buffer.length()).max().unwrap_or(0);
    for buffer in document.buffers() {
        let (index, needed) = (buffer.index(), buffer.length());
        let data = match buffer.source() {
            // Later buffers have no binary chunk to be in.
            Source::Bin if index > 0 => Err("it has no URI".to_owned()),
            Source::Bin => blob.take().map(Rc::new).ok_or_else(|| "the file has no binary chunk".to_owned()),
            Source::Uri(uri) => match uri.split_at_checked(5) {
                Some((scheme, rest)) if scheme.eq_ignore_ascii_case("data:") => decoded(rest).map(Rc::new),
                _ => beside(folder, uri, most, &mut known),
            },
        };
        let data = match data {
            Err(_) if filled.contains(&index) => {
                buffers.push(None);
                continue;
            }
            Err(why) => return Err(unread(index, &why)),
            Ok(data) => data,
        };
        if data.len() < needed {
            return Err(short(index, data.len(), needed));
        }
        buffers.push(Some(data));
    }
    Ok(buffers)
}

/// The bytes of a data URI, from behind its scheme.
pub fn decoded(rest: &str) -> Result<Vec<u8>, String> {
    let (kind, data) = rest.split_once(',').ok_or("its data URI has no comma")?;
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Err("its data URI is not in base64, and no other is read".to_owned());
    }
    // In an address, some characters may be escaped.
    let data: Vec<u8> = percent_decode_str(data).filter(|byte| !byte.is_ascii_whitespace()).collect();
    STANDARD.decode(data).map_err(|e| format!("its data URI is not sound base64: {e}"))
}

/// The bytes of the file at a relative URI, or of that name, which others write unescaped and with
/// backslashes; no more than the `most` that a buffer needs, for it may have no end.
pub fn beside(
    folder: Option<&Path>,
    uri: &str,
    most: usize,
    known: &mut Known,
) -> Result<Rc<Vec<u8>>, String> {
    let fail = |why: &str| format!("{uri}: {why}");
    let name = uri.replace('\\', "/");
    let start = name.split(['/', '?', '#']).next().unwrap_or("");
    if start.contains(':') {
        return Err(fail("only files are read, by relative URIs"));
    }
    let decoded = percent_decode_str(&name).decode_utf8().map_err(|_| fail("names no file in UTF-8"))?;
    let relative = |part| matches!(part, Component::Normal(_) | Component::CurDir | Component::ParentDir);
    if !Path::new(decoded.as_ref()).components().chain(Path::new(&name).components()).all(relative) {
        return Err(fail("only relative URIs are read"));
    }
    let folder = folder.ok_or_else(|| fail("lies in another file, and no folder is given"))?;
    let as_named = folder.join(&name);
    let path = if as_named.is_file() { as_named } else { folder.join(decoded.as_ref()) };
    if uri.contains(['?', '#']) && !path.is_file() {
        return Err(fail("a URI with a query or a fragment names no file"));
    }
    let mut read = || {
        let path = path.canonicalize()?;
        if let Some(data) = known.get(&path) {
            return Ok(data.clone());
        }
        // Pipes and devices are not opened: that alone may wait without end.
        if !std::fs::metadata(&path)?.is_file() {
            return Err(std::io::Error::other("is no file"));
        }
        let mut data = Vec::new();
        std::fs::File::open(&path)?.take(most as u64).read_to_end(&mut data)?;
        Ok(known.entry(path).or_insert(Rc::new(data)).clone())
    };
    read().map_err(|e| fail(&e.to_string()))
}
