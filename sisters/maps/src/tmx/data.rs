//! The tiles of a layer: as text, or in base64 and compressed.

use std::cmp::Ordering;
use std::io::{ErrorKind, Read};

use base64::Engine;
use base64::alphabet;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use flate2::bufread::{GzDecoder, ZlibDecoder};
use ruzstd::decoding::StreamingDecoder;

use super::xml::Element;
use crate::MapError;

/// Base64 with or without padding at its end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Bytes that Zstandard may look back, which it holds: those that its format asks of each reader.
const MOST_WINDOW: u64 = 8 << 20;

/// How the tiles of a layer are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Data {
    Csv,
    Plain,
    Zlib,
    Gzip,
    Zstd,
}

/// Takes the ids of tiles by their numbers in the layer.
type Take<'a> = &'a mut dyn FnMut(u64, u32);

impl Data {
    pub fn new(data: Element<'_>) -> Result<Self, MapError> {
        let [encoding, compression] =
            ["encoding", "compression"].map(|name| data.attribute(name).unwrap_or_default());
        match (encoding, compression) {
            ("csv", "") => Ok(Self::Csv),
            ("base64", "") => Ok(Self::Plain),
            ("base64", "zlib") => Ok(Self::Zlib),
            ("base64", "gzip") => Ok(Self::Gzip),
            ("base64", "zstd") => Ok(Self::Zstd),
            _ => Err(data.damaged(format!(
                "tiles in {encoding:?} and {compression:?} are not read: choose CSV or base64 (Map, Map Properties, \
                 Tile Layer Format)"
            ))),
        }
    }

    /// Hands out the ids of exactly `count` tiles.
    pub fn decode(self, text: &str, count: u64, take: Take<'_>) -> Result<(), String> {
        if self == Self::Csv {
            return csv(text, count, take);
        }
        let letters: Vec<u8> = text.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
        let bytes = BASE64.decode(letters).map_err(|why| why.to_string())?;
        match self {
            Self::Zlib => binary(ZlibDecoder::new(&bytes[..]), count, take),
            Self::Gzip => binary(GzDecoder::new(&bytes[..]), count, take),
            Self::Zstd => {
                let decoder = StreamingDecoder::new_with_max_window_size(&bytes[..], MOST_WINDOW);
                binary(decoder.map_err(|why| why.to_string())?, count, take)
            }
            _ => binary(&bytes[..], count, take),
        }
    }
}

/// Numbers between commas, or in lines of their own. Where one is missing between two commas is no
/// tile; a comma at the end counts for nothing.
fn csv(text: &str, count: u64, take: Take<'_>) -> Result<(), String> {
    let text = text.trim();
    let text = text.strip_suffix(',').unwrap_or(text);
    let mut read = 0;
    for part in text.split(',').filter(|_| !text.is_empty()) {
        if part.trim().is_empty() {
            read += 1;
        }
        for word in part.split_whitespace() {
            let id = word.parse().map_err(|why| format!("tile {read}, {word:.40}: {why}"))?;
            if read >= count {
                return Err(too_many(count));
            }
            take(read, id);
            read += 1;
        }
    }
    match read.cmp(&count) {
        Ordering::Less => Err(too_few(read, count)),
        Ordering::Equal => Ok(()),
        Ordering::Greater => Err(too_many(count)),
    }
}

/// Ids in 32 bits, little-endian. Bytes are decompressed a buffer at a time, and none behind the
/// last tile.
fn binary(mut bytes: impl Read, count: u64, take: Take<'_>) -> Result<(), String> {
    let mut buffer = [0; 4096];
    let mut read = 0;
    while read < count {
        let tiles = (count - read).min(buffer.len() as u64 / 4);
        let part = &mut buffer[..4 * tiles as usize];
        match bytes.read_exact(part) {
            Err(why) if why.kind() == ErrorKind::UnexpectedEof => return Err(too_few(read, count)),
            result => result.map_err(|why| why.to_string())?,
        }
        for (id, index) in part.as_chunks().0.iter().zip(read..) {
            take(index, u32::from_le_bytes(*id));
        }
        read += tiles;
    }
    match bytes.read(&mut buffer[..1]) {
        Ok(0) => Ok(()),
        Ok(_) => Err(too_many(count)),
        Err(why) => Err(why.to_string()),
    }
}

fn too_few(read: u64, count: u64) -> String {
    format!("too few tiles for its dimensions: about {read} of {count}")
}

fn too_many(count: u64) -> String {
    format!("more than the {count} tiles of its dimensions")
}
