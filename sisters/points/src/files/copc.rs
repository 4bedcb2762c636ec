//! Some nodes of COPC files (Butler et al. 2021, "COPC 1.0"): LAZ files whose chunks are nodes of
//! an octree, and whose hierarchy says where these lie.
//!
//! Not by `las::CopcReader`, which reserves memory by the numbers in the file.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};

use glam::DVec3;

use super::chunks::{Chunks, Gap};
use super::guarded::plain;
use super::head::{Head, Packed};
use super::levels::{Key, Octree};
use super::records::hand_out;
use super::sink::{FileError, Sink, Source};

/// Bytes of an entry of a page of the hierarchy.
const ENTRY: u64 = 32;
/// Entries that are read at once.
const ENTRIES: usize = 1 << 10;

/// A chunk of points.
#[derive(Debug, Clone, Copy)]
struct Node {
    key: Key,
    start: u64,
    bytes: u64,
    points: u64,
}

/// Reads the nodes that are wanted, in the order of the file. `info` is the record of COPC.
pub(super) fn read<E: From<FileError>>(
    mut source: impl Source,
    head: &Head,
    packed: &Packed,
    info: &[u8],
    sink: &mut Sink<'_, E>,
) -> Result<(), E> {
    let nodes = nodes(&mut source, head, info, sink).map_err(|e| sink.header("COPC", e))?;
    for node in nodes {
        let mut left = node.points;
        let mut points = match chunk(&mut source, head, packed, &node) {
            Ok(points) => points,
            Err(cause) => {
                sink.lose(sink.point(format!("node {}", node.key), cause), left);
                continue;
            }
        };
        while left > 0 {
            let (records, gap) = points.next(left);
            left -= (records.len() / head.layout.record) as u64;
            hand_out(&records, &head.layout, sink)?;
            if let Some(Gap { cause, points }) = gap {
                sink.lose(sink.point(format!("node {}", node.key), cause), points);
                left -= points;
            }
        }
    }
    Ok(())
}

/// The nodes with points that are wanted.
fn nodes<E: From<FileError>>(
    source: &mut impl Source,
    head: &Head,
    info: &[u8],
    sink: &Sink<'_, E>,
) -> Result<Vec<Node>, String> {
    let number =
        |i: usize| info.get(8 * i..8 * i + 8).and_then(|b| b.try_into().ok()).map(u64::from_le_bytes);
    let numbers: Option<Vec<u64>> = (0..7).map(number).collect();
    let numbers = numbers.ok_or_else(|| format!("its record has {} bytes", info.len()))?;
    let [x, y, z, half, spacing] = std::array::from_fn(|i| f64::from_bits(numbers[i]));
    let octree =
        Octree::new((DVec3::new(x, y, z) - half, 2.0 * half), spacing, head.layout.scale, sink.wanted())?;
    let mut nodes = hierarchy(source, head.length, (numbers[5], numbers[6]), &octree)?;
    nodes.sort_unstable_by_key(|node| (node.start, node.key));
    // As many points as a file promises may be decoded, however often nodes name a chunk.
    let points = nodes.iter().fold(0_u64, |sum, node| sum.saturating_add(node.points));
    if points > head.count {
        return Err(format!("nodes have {points} points, the header says {}", head.count));
    }
    Ok(nodes)
}

/// The nodes of all pages that are wanted. Pages have as many bytes together as the file at most,
/// so that none is read without end.
fn hierarchy(
    source: &mut (impl Read + Seek),
    length: u64,
    root: (u64, u64),
    octree: &Octree,
) -> Result<Vec<Node>, String> {
    let (mut pages, mut read) = (vec![root], 0);
    let mut nodes = BTreeMap::new();
    while let Some((start, bytes)) = pages.pop() {
        read += bytes.min(length);
        if start.checked_add(bytes).is_none_or(|end| end > length) || bytes % ENTRY != 0 {
            return Err(format!("a page of {bytes} bytes at byte {start} of {length}"));
        }
        if read > length {
            return Err("pages of the hierarchy refer to each other".into());
        }
        source.seek(SeekFrom::Start(start)).map_err(plain)?;
        let mut left = (bytes / ENTRY) as usize;
        while left > 0 {
            let mut entries = vec![0; left.min(ENTRIES) * ENTRY as usize];
            source.read_exact(&mut entries).map_err(plain)?;
            left -= left.min(ENTRIES);
            for entry in entries.as_chunks::<{ ENTRY as usize }>().0 {
                let (node, count) = parse(entry, length)?;
                match count {
                    _ if !octree.wants(node.key) => {}
                    0 => {}
                    -1 => pages.push((node.start, node.bytes)),
                    _ if nodes.insert(node.key, node).is_some() => {
                        return Err(format!("the node {} comes twice", node.key));
                    }
                    _ => {}
                }
            }
        }
    }
    Ok(nodes.into_values().collect())
}

/// An entry of a page, and its number of points: -1 for another page.
fn parse(entry: &[u8; ENTRY as usize], length: u64) -> Result<(Node, i32), String> {
    let number = |i: usize| i32::from_le_bytes(std::array::from_fn(|b| entry[4 * i + b]));
    let start = u64::from_le_bytes(std::array::from_fn(|b| entry[16 + b]));
    let numbers = [0, 1, 2, 3].map(|i| i64::from(number(i)));
    let key = Key::new(numbers).ok_or_else(|| format!("an entry of the node {numbers:?}"))?;
    let (bytes, count) = (number(6), number(7));
    let node = |bytes| Node { key, start, bytes, points: count.max(0) as u64 };
    match u64::try_from(bytes) {
        _ if count == 0 => Ok((node(0), count)),
        Ok(bytes) if count >= -1 && start.checked_add(bytes).is_some_and(|end| end <= length) => {
            Ok((node(bytes), count))
        }
        _ => Err(format!("the node {key} has {count} points in {bytes} bytes at byte {start} of {length}")),
    }
}

/// The points of a node.
fn chunk<'a, S: Source>(
    source: &'a mut S,
    head: &Head,
    packed: &Packed,
    node: &Node,
) -> Result<Chunks<'a, &'a mut S>, String> {
    let mut said = [0; 4];
    source.seek(SeekFrom::Start(node.start.saturating_add(head.layout.record as u64))).map_err(plain)?;
    source.read_exact(&mut said).map_err(plain)?;
    let said = u32::from_le_bytes(said);
    if u64::from(said) != node.points {
        return Err(format!("its chunk has {said} points, the hierarchy says {}", node.points));
    }
    source.seek(SeekFrom::Start(node.start)).map_err(plain)?;
    Chunks::of_one(source, head, packed, node.start + node.bytes, node.points)
}
