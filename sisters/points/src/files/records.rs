//! Records of points, and how they are decoded: shared by LAS, LAZ and COPC files.

use glam::DVec3;
use las::{Header, PointData, PointDataBuilder};
use laz::{DecompressionSelection, LazItemRecordBuilder, LazItemType, LazVlr};

use super::sink::{Attributes, FileError, Sample, Sink};

/// Points that are decoded at once.
const BATCH: u64 = 1 << 16;
/// Bytes of points that are decoded at once, at most: records may have 64 KiB.
const BATCH_BYTES: u64 = 1 << 22;
/// Bytes of a point behind those of its format, in LAZ: each takes 10 kB in the decoder.
const MOST_EXTRA_BYTES: u64 = 4096;

/// Gives decoded points to the sink.
pub(super) fn hand_out<E: From<FileError>>(batch: &PointData, sink: &mut Sink<'_, E>) -> Result<(), E> {
    if sink.colour_shift.is_none() {
        let channels = batch.rgb().into_iter().flatten().flat_map(|(r, g, b)| [r, g, b]);
        sink.colour_shift =
            channels.max().filter(|&most| most > 0).map(|most| if most > 255 { 8 } else { 0 });
    }
    // The standard demands 16 bits a channel, but some programs write 8.
    let shift = sink.colour_shift.unwrap_or(8);
    let byte = |c: u16| (c >> shift).min(255) as u8;
    let mut colours = batch.rgb().map(|all| all.map(|(r, g, b)| [r, g, b].map(byte)));
    let has = Attributes { colours: colours.is_some(), ..Attributes::default() };
    for ((x, y), z) in batch.x().zip(batch.y()).zip(batch.z()) {
        let colour = colours.as_mut().and_then(Iterator::next).unwrap_or(Sample::NONE.colour);
        sink.push(Sample { position: DVec3::new(x, y, z), colour, ..Sample::NONE }, has)?;
    }
    Ok(())
}

/// Bytes for the next of the points that are `left`.
pub(super) fn room(left: u64, header: &Header) -> Vec<u8> {
    let record = u64::from(header.point_format().len());
    let count = left.min(BATCH).min((BATCH_BYTES / record.max(1)).max(1));
    vec![0; (count * record) as usize]
}

/// The points of these bytes.
pub(super) fn decoded(bytes: Vec<u8>, header: &Header) -> Result<PointData, String> {
    PointDataBuilder::new().for_header(header).build_from_bytes(bytes).map_err(|e| e.to_string())
}

/// The layers that are decoded, where points lie in layers. On times the decoder would recurse as
/// often as a file says, and overflow the stack.
pub(super) fn wanted() -> DecompressionSelection {
    DecompressionSelection::base().decompress_z().decompress_rgb()
}

/// Checks that the parts of compressed points make up a record: the decoder takes memory for each
/// part.
pub(super) fn check_items(vlr: &LazVlr, record: u64) -> Result<(), String> {
    let items = vlr.items();
    let size: u64 = items.iter().map(|item| u64::from(item.size())).sum();
    if items.is_empty() || size != record {
        return Err(format!("compressed points have {size} bytes a point, the header says {record}"));
    }
    for item in items {
        let own = LazItemRecordBuilder::new().add_item(item.item_type()).build();
        if own.iter().any(|own| own.size() != item.size()) {
            return Err(format!("compressed points have {:?} of {} bytes", item.item_type(), item.size()));
        }
    }
    let is_bytes = |kind: LazItemType| matches!(kind, LazItemType::Byte(_) | LazItemType::Byte14(_));
    let extra: u64 =
        items.iter().filter(|item| is_bytes(item.item_type())).map(|item| u64::from(item.size())).sum();
    if extra > MOST_EXTRA_BYTES {
        return Err(format!(
            "compressed points have {extra} extra bytes; at most {MOST_EXTRA_BYTES} are read"
        ));
    }
    let kinds = || items.iter().map(|item| u16::from(item.item_type()));
    match kinds().enumerate().find(|&(i, kind)| kinds().take(i).any(|other| other == kind)) {
        Some((_, kind)) => Err(format!("compressed points have the item {kind} twice")),
        None => Ok(()),
    }
}
