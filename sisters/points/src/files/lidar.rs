//! LAS and LAZ: compressed points by the crate `laz`. Sizes in a file are checked before it
//! reserves memory for them.

use super::chunks::{Chunks, Gap};
use super::copc;
use super::head::{self, Head};
use super::levels::{Levels, Selection};
use super::records::{hand_out, room};
use super::sink::{FileError, NONE, Sink, Source};

pub(super) fn read<E: From<FileError>>(mut source: impl Source, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let head = head::open(&mut source, sink)?;
    if *sink.wanted() != Selection::default() {
        match (&head.copc, &head.packed) {
            (Some(info), Some(packed)) => return copc::read(source, &head, packed, info, sink),
            _ if sink.wanted().levels != Levels::All => return Err(sink.no_levels("LAS").into()),
            _ => {}
        }
    }
    read_all(source, &head, sink)
}

/// Reads all points, in their order, from a source that is at the first.
pub(super) fn read_all<E: From<FileError>>(
    source: impl Source,
    head: &Head,
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    sink.extent = NONE;
    points(source, head, sink)?;
    // Some programs round bounds, others do not write them at all, or something else.
    let ([low, high], [from, to]) = (sink.extent, head.bounds);
    let slack = (high - low).abs().max_element() + head.layout.scale.abs().max_element();
    let is_near = from.cmple(low + slack).all() && to.cmpge(high - slack).all();
    if !is_near && sink.extent != NONE {
        sink.warn(format_args!(
            "its header says that points lie from {from} to {to}, and they lie from {low} to {high}: \
             bounds are not used"
        ));
    }
    Ok(())
}

fn points<E: From<FileError>>(mut source: impl Source, head: &Head, sink: &mut Sink<'_, E>) -> Result<(), E> {
    let (count, record) = (head.count, head.layout.record);
    let Some(packed) = &head.packed else {
        let there = count.min((head.end - head.start) / record as u64);
        let mut read = 0;
        while read < there {
            let mut bytes = room(there - read, record);
            if let Err(error) = source.read_exact(&mut bytes) {
                sink.lose(sink.point(format!("after point {read} of {count}"), error), count - read);
                return Ok(());
            }
            read += (bytes.len() / record) as u64;
            hand_out(&bytes, &head.layout, sink)?;
        }
        if read < count {
            sink.lose(
                sink.point(format!("after point {read} of {count}"), "the file ends here"),
                count - read,
            );
        }
        return Ok(());
    };
    let mut chunks = Chunks::new(source, head, packed).map_err(|e| sink.header("LAS", e))?;
    let mut passed = 0;
    while passed < count {
        let (records, gap) = chunks.next(count - passed);
        passed += (records.len() / record) as u64;
        hand_out(&records, &head.layout, sink)?;
        if let Some(Gap { cause, points }) = gap {
            sink.lose(sink.point(format!("after point {passed} of {count}"), cause), points);
            passed += points;
        }
    }
    Ok(())
}
