//! The two forms of a file: text, and the binary container with its chunks.

use super::error::Trouble;

/// What stands before UTF-8 text of some editors.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// The bytes of the container's header, and of that of a chunk.
const HEADER: usize = 12;
const CHUNK: usize = 8;

/// The JSON of a file, and its binary chunk.
pub(super) fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Trouble> {
    if !bytes.starts_with(b"glTF") {
        return Ok((text_of(bytes)?, None));
    }
    let word = |at: usize| {
        let four = bytes.get(at..at + 4).ok_or_else(|| fault("it ends within its header"))?;
        Ok::<_, Trouble>(four.iter().rev().fold(0, |n, &byte| n << 8 | usize::from(byte)))
    };
    match word(4)? {
        2 => {}
        version @ (1 | 3..=9) => return Err(Trouble::Version(format!("{version}.0"))),
        version => return Err(fault(format!("it is of version {version}, which there is not"))),
    }
    let length = word(8)?;
    if length < HEADER || length > bytes.len() {
        return Err(fault(format!("it says that it has {length} bytes, but it has {}", bytes.len())));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = HEADER;
    // Chunks of other kinds are passed over, and what is too short to be one.
    while at + CHUNK <= length {
        let (held, kind) = (word(at)?, &bytes[at + 4..at + CHUNK]);
        let start = at + CHUNK;
        let Some(chunk) = bytes[..length].get(start..start.saturating_add(held)) else {
            let (kind, left) = (kind.escape_ascii(), length - start);
            return Err(fault(format!("it has a chunk {kind} of {held} bytes, of which {left} are there")));
        };
        match kind {
            b"JSON" => json = json.or(Some(chunk)),
            b"BIN\0" => binary = binary.or(Some(chunk)),
            _ => {}
        }
        at = next_chunk(&bytes[..length], start + held);
    }
    let json = json.ok_or_else(|| fault("it has no chunk of JSON"))?;
    Ok((text_of(json)?, binary))
}

/// Where the chunk behind `end` begins: chunks end at multiples of four, but some writers count the
/// bytes that fill them up, and some leave them away.
fn next_chunk(bytes: &[u8], end: usize) -> usize {
    let is_chunk = |at: usize| {
        let kind = bytes.get(at + 4..at + CHUNK);
        kind.is_some_and(|kind| kind == b"BIN\0" || kind == b"JSON")
    };
    if is_chunk(end) { end } else { end.next_multiple_of(4) }
}

/// Text without what stands around it.
fn text_of(bytes: &[u8]) -> Result<&[u8], Trouble> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(fault("it is text in UTF-16; save it as UTF-8"));
    }
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let filled = text.iter().rev().take_while(|&&byte| byte == 0).count();
    Ok(&text[..text.len() - filled])
}

fn fault(why: impl Into<String>) -> Trouble {
    Trouble::Format(why.into())
}
