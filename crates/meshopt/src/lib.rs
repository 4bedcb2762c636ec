//! Buffer views as `EXT_meshopt_compression` and `KHR_meshopt_compression` pack them, and gltfpack
//! writes them: unpacked without unsafe code and without C++, for pages too. Written after the text
//! of the extension. Damaged bytes give `None`.

#[cfg(all(test, feature = "encoder"))]
mod tests;

/// Vertices whose bytes are packed with the same number of bits.
const GROUP: usize = 16;
/// Vertices of a block have at most this many bytes together, and are at most this many.
const BLOCK_BYTES: usize = 8192;
const BLOCK: usize = 256;

/// The `count` elements of `stride` bytes of a view, by the names of their mode and filter; `None`
/// if the bytes are damaged, or if there is no such mode or filter. A byte may become a thousand
/// zeros, so that the number of elements is to be checked before.
pub fn unpacked(mode: &str, filter: &str, packed: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let corners = match mode {
        "ATTRIBUTES" => {
            let mut bytes = attributes(packed, count, stride)?;
            unfilter(filter, stride, &mut bytes)?;
            return Some(bytes);
        }
        "TRIANGLES" if count.is_multiple_of(3) => triangles(packed, count)?,
        "INDICES" => indices(packed, count)?,
        _ => return None,
    };
    let narrow = |corner: u32| corner.to_le_bytes().into_iter().take(stride);
    matches!(stride, 2 | 4).then(|| corners.into_iter().flat_map(narrow).collect())
}

fn take<'a>(bytes: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, rest) = bytes.split_at_checked(count)?;
    *bytes = rest;
    Some(taken)
}

/// Takes the first byte. Its upper half says what kind of data follows, its lower half is the version.
fn version(packed: &mut &[u8], kind: u8) -> Option<u8> {
    let header = take(packed, 1)?[0];
    (header & 0xf0 == kind && header & 0x0f <= 1).then_some(header & 0x0f)
}

/// Numbers with their sign in the lowest bit.
fn signed(packed: u32) -> u32 {
    (packed >> 1) ^ (packed & 1).wrapping_neg()
}

/// The bytes of `count` vertices of `stride` bytes.
fn attributes(mut packed: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return None;
    }
    let version = version(&mut packed, 0xa0)?;
    // At the end stand a vertex from which the first differs, and the kinds of the channels.
    let (tail, least) = if version == 0 { (stride, 32) } else { (stride + stride / 4, 24) };
    let data = packed.len().checked_sub(tail.max(least))?;
    let (mut data, end) = packed.split_at(data);
    let (first, kinds) = end[end.len() - tail..].split_at(stride);
    let mut last = first.to_vec();
    let (mut vertices, size) = (Vec::new(), count.checked_mul(stride)?);
    let most = (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK);
    while vertices.len() < size {
        let held = most.min(count - vertices.len() / stride);
        block(&mut data, kinds, &mut last, held, &mut vertices)?;
    }
    data.is_empty().then_some(vertices)
}

/// A block of vertices: channels of four bytes, each of which is the difference to that of the
/// vertex before.
fn block(data: &mut &[u8], kinds: &[u8], last: &mut [u8], held: usize, out: &mut Vec<u8>) -> Option<()> {
    let (start, stride) = (out.len(), last.len());
    out.resize(start + held * stride, 0);
    let controls = take(data, kinds.len())?;
    for (channel, before) in last.chunks_exact_mut(4).enumerate() {
        let control = controls.get(channel);
        let mut planes = [[0; BLOCK]; 4];
        for (i, plane) in planes.iter_mut().enumerate() {
            let bits = match control.map(|control| control >> (2 * i) & 3) {
                None => [0, 2, 4, 8],
                Some(0) => [0, 1, 2, 4],
                Some(1) => [1, 2, 4, 8],
                Some(2) => continue,
                Some(_) => {
                    plane[..held].copy_from_slice(take(data, held)?);
                    continue;
                }
            };
            groups(data, bits, &mut plane[..held.next_multiple_of(GROUP)])?;
        }
        let kind = kinds.get(channel).copied().unwrap_or(0);
        for i in 0..held {
            let (new, old) = (planes.map(|plane| plane[i]), [before[0], before[1], before[2], before[3]]);
            let value = match kind & 3 {
                0 => std::array::from_fn(|k| old[k].wrapping_add(signed(new[k].into()) as u8)),
                1 => {
                    let half = |of: [u8; 4], k: usize| u16::from_le_bytes([of[k], of[k + 1]]);
                    let sum = |k| half(old, k).wrapping_add(signed(half(new, k).into()) as u16);
                    let ([a, b], [c, d]) = (sum(0).to_le_bytes(), sum(2).to_le_bytes());
                    [a, b, c, d]
                }
                2 => {
                    let turned = u32::from_le_bytes(new).rotate_right(u32::from(kind >> 4));
                    (turned ^ u32::from_le_bytes(old)).to_le_bytes()
                }
                _ => return None,
            };
            before.copy_from_slice(&value);
            out[start + i * stride + 4 * channel..][..4].copy_from_slice(&value);
        }
    }
    Some(())
}

/// Groups of bytes; two bits say which of four numbers of bits the bytes of a group have. The
/// greatest number that such bits can hold stands for a byte behind them.
fn groups(data: &mut &[u8], bits: [usize; 4], plane: &mut [u8]) -> Option<()> {
    let headers = take(data, (plane.len() / GROUP).div_ceil(4))?;
    for (i, group) in plane.chunks_exact_mut(GROUP).enumerate() {
        let bits = bits[usize::from(headers[i / 4] >> (i % 4 * 2) & 3)];
        let packed = take(data, GROUP * bits / 8)?;
        if bits == 8 {
            group.copy_from_slice(packed);
            continue;
        }
        for (k, byte) in group.iter_mut().enumerate().take(if bits == 0 { 0 } else { GROUP }) {
            let (holds, most) = (8 / bits, (1 << bits) - 1);
            // The first of a byte is in its highest bits, but in the lowest where it is a single bit.
            let place = if bits == 1 { k % holds } else { holds - 1 - k % holds };
            *byte = packed[k / holds] >> (bits * place) & most;
            if *byte == most {
                *byte = take(data, 1)?[0];
            }
        }
    }
    Some(())
}

/// A number in bytes of seven bits, the lowest first; the highest bit says that more follow.
fn number(data: &mut &[u8]) -> Option<u32> {
    let mut number = 0;
    for shift in (0..32).step_by(7) {
        let byte = take(data, 1)?[0];
        number |= u32::from(byte & 127) << shift;
        if byte < 128 {
            break;
        }
    }
    Some(number)
}

/// The last sixteen of something.
struct Recent<T> {
    held: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new(none: T) -> Self {
        Self { held: [none; 16], next: 0 }
    }

    /// The one so many before the next.
    fn back(&self, count: u8) -> T {
        self.held[self.next.wrapping_sub(count.into()) % 16]
    }

    fn push(&mut self, new: T) {
        self.held[self.next] = new;
        self.next = (self.next + 1) % 16;
    }
}

/// The corners of triangles, `count` in all.
fn triangles(mut packed: &[u8], count: usize) -> Option<Vec<u32>> {
    // Kinds of corners from this one on are not among the recent ones.
    let free = if version(&mut packed, 0xe0)? == 0 { 15 } else { 13 };
    let codes = take(&mut packed, count / 3)?;
    let (mut data, table) = packed.split_last_chunk::<16>()?;
    let (mut edges, mut recent) = (Recent::new([u32::MAX; 2]), Recent::new(u32::MAX));
    // The vertex that was not named yet, and the last that was named by its difference to another.
    let (mut next, mut last) = (0u32, 0u32);
    let mut corners = Vec::with_capacity(count);
    for &code in codes {
        if code < 0xf0 {
            // At a recent edge: one corner is left.
            let ([a, b], kind) = (edges.back(1 + (code >> 4)), code & 15);
            let c = match kind {
                0 => fresh(&mut next),
                15 => step(&mut last, signed(number(&mut data)?)),
                _ if kind < free => recent.back(1 + kind),
                _ => step(&mut last, if kind == 13 { u32::MAX } else { 1 }),
            };
            if kind == 0 || kind >= free {
                recent.push(c);
            }
            edges.push([c, b]);
            edges.push([a, c]);
            corners.extend([a, b, c]);
            continue;
        }
        let kinds = if code < 0xfe { table[usize::from(code & 15)] } else { take(&mut data, 1)?[0] };
        if code >= 0xfe && kinds == 0 {
            next = 0;
        }
        let kinds = [if code == 0xff { 15 } else { 0 }, kinds >> 4, kinds & 15];
        let mut own = [0; 3];
        for (corner, kind) in own.iter_mut().zip(kinds) {
            *corner = match kind {
                0 => fresh(&mut next),
                15 => step(&mut last, signed(number(&mut data)?)),
                _ => recent.back(kind),
            };
        }
        let new = own.iter().zip(kinds).filter(|(_, kind)| matches!(kind, 0 | 15));
        new.for_each(|(&corner, _)| recent.push(corner));
        let [a, b, c] = own;
        [[b, a], [c, b], [a, c]].into_iter().for_each(|edge| edges.push(edge));
        corners.extend(own);
    }
    data.is_empty().then_some(corners)
}

/// The next vertex.
fn fresh(next: &mut u32) -> u32 {
    step(next, 1).wrapping_sub(1)
}

/// Goes on by a difference.
fn step(last: &mut u32, by: u32) -> u32 {
    *last = last.wrapping_add(by);
    *last
}

/// `count` indices, each by its difference to one of two before.
fn indices(mut packed: &[u8], count: usize) -> Option<Vec<u32>> {
    version(&mut packed, 0xd0)?;
    let (mut data, _) = packed.split_last_chunk::<4>()?;
    let mut last = [0u32; 2];
    let mut index = |_| {
        let number = number(&mut data)?;
        Some(step(&mut last[(number & 1) as usize], signed(number >> 1)))
    };
    // Each takes a byte or more.
    let all = (count < packed.len()).then(|| (0..count).map(&mut index).collect::<Option<Vec<u32>>>())??;
    data.is_empty().then_some(all)
}

/// Undoes a filter of vertices of `stride` bytes; `None` if there is none of that name.
fn unfilter(filter: &str, stride: usize, bytes: &mut [u8]) -> Option<()> {
    let undo: fn([f32; 4], f32) -> [f32; 4] = match (filter, stride) {
        ("NONE", _) => return Some(()),
        ("EXPONENTIAL", _) => {
            for four in bytes.as_chunks_mut::<4>().0 {
                let packed = i32::from_le_bytes(*four);
                let power = f32::from_bits((((packed >> 24) + 127) as u32) << 23);
                *four = (power * (packed << 8 >> 8) as f32).to_le_bytes();
            }
            return Some(());
        }
        ("OCTAHEDRAL", 4 | 8) => octahedral,
        ("QUATERNION", 8) => quaternion,
        ("COLOR", 4 | 8) => color,
        _ => return None,
    };
    // Of four components, which are bytes or numbers of two bytes.
    let width = stride / 4;
    let most = ((1 << (8 * width - 1)) - 1) as f32;
    for vertex in bytes.chunks_exact_mut(stride) {
        let read = |i: usize| match width {
            1 => f32::from(vertex[i] as i8),
            _ => f32::from(i16::from_le_bytes([vertex[2 * i], vertex[2 * i + 1]])),
        };
        let found = undo([0, 1, 2, 3].map(read), most);
        for (place, number) in vertex.chunks_exact_mut(width).zip(found) {
            place.copy_from_slice(&(number.round() as i32).to_le_bytes()[..width]);
        }
    }
    Some(())
}

/// A direction by a point of an octahedron, whose size is in the third component.
fn octahedral([x, y, one, w]: [f32; 4], most: f32) -> [f32; 4] {
    let z = one - x.abs() - y.abs();
    let folded = z.min(0.0);
    let unfold = |c: f32| if c >= 0.0 { c + folded } else { c - folded };
    let (x, y) = (unfold(x), unfold(y));
    let scale = most / (x * x + y * y + z * z).sqrt();
    [x * scale, y * scale, z * scale, w]
}

/// A rotation by its three smaller components; the last one says which is the greatest, and their
/// scale.
fn quaternion([x, y, z, w]: [f32; 4], most: f32) -> [f32; 4] {
    let bits = w as i32;
    let scale = (bits | 3) as f32;
    let greatest = (scale * scale * 2.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let unit = most / std::f32::consts::SQRT_2 / scale;
    let mut all = [greatest, x, y, z].map(|c| c * unit);
    all.rotate_right((bits & 3) as usize);
    all
}

/// A colour by its brightness, two differences and its opacity, whose highest bit says how many bits
/// all have.
fn color([y, orange, green, opacity]: [f32; 4], most: f32) -> [f32; 4] {
    let whole = 2.0 * most + 1.0;
    let unsigned = |c: f32| if c < 0.0 { c + whole + 1.0 } else { c };
    let (y, opacity) = (unsigned(y), unsigned(opacity) as u32);
    let bits = u32::MAX.checked_shr(opacity.leading_zeros()).unwrap_or(0);
    let opacity = (opacity << 1 & bits) | (opacity & 1);
    [y + orange - green, y + green, y - orange - green, opacity as f32].map(|c| c * whole / bits as f32)
}
