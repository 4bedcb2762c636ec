//! The tiles of a layer: as text, or in base64 and compressed.

use std::io::{BufReader, ErrorKind, Read};

use base64::Engine;
use base64::alphabet;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use flate2::bufread::{GzDecoder, ZlibDecoder};
use ruzstd::decoding::StreamingDecoder;

use super::element::FORMATS;

/// Base64 with or without padding at its end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Bytes that Zstandard may look back, which it holds: those that its format asks of each reader.
const MOST_WINDOW: u64 = 8 << 20;

/// Hands out the ids of exactly `count` tiles with their numbers, of a text and how it is stored.
/// What is compressed unfolds a buffer at a time, and not behind the last tile.
pub fn decode(
    text: &str,
    [encoding, compression]: [&str; 2],
    count: u64,
    take: &mut dyn FnMut(u64, u32) -> Result<(), String>,
) -> Result<(), String> {
    let is_known = match encoding {
        "csv" => compression.is_empty(),
        "base64" => ["", "zlib", "gzip", "zstd"].contains(&compression),
        _ => false,
    };
    if !is_known {
        return Err(format!("tiles in {encoding:?} and {compression:?} are not read: {FORMATS}"));
    }
    let letters = text.bytes().filter(|byte| encoding == "base64" && !byte.is_ascii_whitespace());
    let bytes = BASE64.decode(letters.collect::<Vec<u8>>()).map_err(|why| why.to_string())?;
    let bytes = &bytes[..];
    let mut ids: Box<dyn Iterator<Item = Result<u32, String>>> = match (encoding, compression) {
        ("csv", _) => Box::new(csv(text)),
        (_, "zlib") => Box::new(words(ZlibDecoder::new(bytes))),
        (_, "gzip") => Box::new(words(GzDecoder::new(bytes))),
        (_, "zstd") => {
            let decoder = StreamingDecoder::new_with_max_window_size(bytes, MOST_WINDOW);
            Box::new(words(decoder.map_err(|why| why.to_string())?))
        }
        _ => Box::new(words(bytes)),
    };
    for number in 0..count {
        let id =
            ids.next().ok_or_else(|| format!("too few tiles for its dimensions: {number} of {count}"))?;
        take(number, id.map_err(|why| format!("tile {number}: {why}"))?)?;
    }
    if ids.next().is_some() { Err(format!("more than the {count} tiles of its dimensions")) } else { Ok(()) }
}

/// Numbers between commas and blanks.
fn csv(text: &str) -> impl Iterator<Item = Result<u32, String>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().map_err(|why| format!("{word:.40}: {why}")))
}

/// Numbers of 32 bits, little-endian.
fn words(bytes: impl Read) -> impl Iterator<Item = Result<u32, String>> {
    let mut bytes = BufReader::new(bytes);
    std::iter::from_fn(move || {
        let mut word = [0; 4];
        match bytes.read_exact(&mut word) {
            Ok(()) => Some(Ok(u32::from_le_bytes(word))),
            Err(why) if why.kind() == ErrorKind::UnexpectedEof => None,
            Err(why) => Some(Err(why.to_string())),
        }
    })
}
