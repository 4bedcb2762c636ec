//! LAS and LAZ: compressed points by the crate `laz`. Sizes in a file are checked before it
//! reserves memory for them.

use super::chunks::{Batch, Chunks, room};
use super::head::{self, Layout};
use super::sink::{Attributes, FileError, Sample, Sink, Source, plain};
use glam::DVec3;

pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let head = head::read(&mut source).map_err(|e| sink.header("LAS", e))?;
    head.warnings.iter().for_each(|what| sink.warn(what));
    let (count, record) = (head.count, head.layout.record);
    let mut next: Box<dyn FnMut(u64) -> Batch> = match &head.packed {
        Some(packed) => {
            let mut chunks = Chunks::new(source, &head, packed).map_err(|e| sink.header("LAS", e))?;
            Box::new(move |passed| chunks.next(count - passed))
        }
        None => {
            let there = count.min((head.end - head.start) / record as u64);
            Box::new(move |passed| {
                let mut records = room(there - passed, record);
                match source.read_exact(&mut records) {
                    Ok(()) if passed < there => (records, None),
                    read => {
                        let cause = read.err().map_or_else(|| "the file ends here".into(), plain);
                        (Vec::new(), Some((cause, count - passed)))
                    }
                }
            })
        }
    };
    let mut passed = 0;
    while passed < count {
        let (records, gap) = next(passed);
        passed += (records.len() / record) as u64;
        hand_out(&records, &head.layout, sink)?;
        if let Some((cause, points)) = gap {
            sink.lose(sink.point(format!("after point {passed} of {count}"), cause), points);
            passed += points;
        }
    }
    Ok(())
}

/// Gives the points of records to the sink.
fn hand_out<E: From<FileError>>(records: &[u8], layout: &Layout, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let channels = |record: &[u8], at: usize| {
        [0, 2, 4].map(|channel| u16::from_le_bytes([record[at + channel], record[at + channel + 1]]))
    };
    if let (None, Some(at)) = (sink.colour_shift, layout.colour) {
        let all = records.chunks_exact(layout.record).flat_map(|record| channels(record, at));
        sink.colour_shift = all.max().filter(|&most| most > 0).map(|most| if most > 255 { 8 } else { 0 });
    }
    // The standard demands 16 bits a channel, but some programs write 8.
    let shift = sink.colour_shift.unwrap_or(8);
    let has = Attributes { colours: layout.colour.is_some(), ..Attributes::default() };
    for record in records.chunks_exact(layout.record) {
        let number = |axis: usize| i32::from_le_bytes(std::array::from_fn(|i| record[4 * axis + i]));
        let steps = DVec3::new(number(0).into(), number(1).into(), number(2).into());
        let byte = |channel: u16| (channel >> shift).min(255) as u8;
        let colour = layout.colour.map_or(Sample::NONE.colour, |at| channels(record, at).map(byte));
        let position = steps * layout.scale + layout.offset;
        sink.push(Sample { position, colour, ..Sample::NONE }, has)?;
    }
    Ok(())
}
