//! Typed elements of buffers: dense, sparse, or both. Nothing is taken for granted about where they
//! lie.

use std::cell::Cell;
use std::rc::Rc;

use glam::Vec3;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, buffer::View};

use super::error::{Trouble, short};

/// Elements that an accessor without a buffer view may have: they take memory, but no bytes of the
/// file.
const MOST_ZEROS: usize = 1 << 20;
/// Elements that are read from any file: many accessors can lie in the same bytes, or in none.
const FREE_ELEMENTS: usize = 1 << 20;
/// Elements that are read from a byte of the buffers, in addition. Without sharing it is one at
/// most.
const ELEMENTS_OF_A_BYTE: usize = 4;

/// Why an accessor is refused that goes beyond the elements of a file.
pub const TOO_MUCH: &str = "one too many: the file unfolds to too much";

/// Which component types elements may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Components {
    /// Floats only.
    Floats,
    /// Also normalised integers of 8 or 16 bits.
    Normalized,
    /// Also other integers of 8 or 16 bits.
    Integers,
}

/// All buffers of a file.
#[derive(Debug)]
pub struct Buffers {
    bytes: Vec<Rc<Vec<u8>>>,
    /// Elements that may still be read.
    left: Cell<usize>,
}

impl Buffers {
    /// Those of a file, each with its bytes; some of these, as many as given, were packed, and are
    /// read no more than once.
    pub(super) fn new(bytes: Vec<Rc<Vec<u8>>>, unpacked: usize) -> Self {
        let all = Self { bytes, left: Cell::new(FREE_ELEMENTS) };
        let held = all.bytes().saturating_sub(unpacked).saturating_mul(ELEMENTS_OF_A_BYTE);
        all.left.set(held.saturating_add(unpacked).saturating_add(FREE_ELEMENTS));
        all
    }

    /// Adds a buffer that was packed.
    pub(super) fn add(&mut self, unpacked: Vec<u8>) {
        self.left.set(self.left.get().saturating_add(unpacked.len()));
        self.bytes.push(Rc::new(unpacked));
    }

    /// How many bytes there are.
    pub fn bytes(&self) -> usize {
        self.bytes.iter().map(|b| b.len()).fold(0, usize::saturating_add)
    }

    /// Takes note of elements that need memory; says whether the file may still have them.
    pub fn spend(&self, count: usize) -> bool {
        let left = self.left.get().checked_sub(count);
        self.left.set(left.unwrap_or(0));
        left.is_some()
    }

    /// Reads vectors of `N` floats.
    pub fn floats<const N: usize>(
        &self,
        accessor: &Accessor,
        what: &'static str,
        components: Components,
    ) -> Result<Vec<[f32; N]>, Trouble> {
        let (data_type, normalized) = (accessor.data_type(), accessor.normalized());
        let taken = match data_type {
            DataType::F32 => true,
            DataType::U32 => false,
            _ if normalized => components != Components::Floats,
            _ => components == Components::Integers,
        };
        let dimensions = match N {
            1 => Dimensions::Scalar,
            2 => Dimensions::Vec2,
            3 => Dimensions::Vec3,
            16 => Dimensions::Mat4,
            _ => Dimensions::Vec4,
        };
        if !taken || accessor.dimensions() != dimensions {
            return Err(unfit(accessor, what, "of a type that is not read"));
        }
        let size = data_type.size();
        self.elements(accessor, what, [0.0; N], |bytes| {
            let mut components = bytes.chunks_exact(size).map(|c| component(data_type, normalized, c));
            std::array::from_fn(|_| components.next().unwrap_or(0.0))
        })
    }

    /// Reads vectors that must be finite.
    pub(super) fn vectors(&self, accessor: &Accessor, what: &'static str) -> Result<Vec<Vec3>, Trouble> {
        let vectors = self.floats(accessor, what, Components::Floats)?;
        let vectors: Vec<Vec3> = vectors.into_iter().map(Vec3::from_array).collect();
        match vectors.iter().all(|v| v.is_finite()) {
            true => Ok(vectors),
            false => Err(unfit(accessor, what, "not finite")),
        }
    }

    /// Reads the indices of a primitive.
    pub fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, Trouble> {
        let what = "indices";
        let greatest = match accessor.data_type() {
            DataType::U8 => u32::from(u8::MAX),
            DataType::U16 => u32::from(u16::MAX),
            DataType::U32 => u32::MAX,
            _ => return Err(unfit(accessor, what, "of a type that is not read")),
        };
        if accessor.dimensions() != Dimensions::Scalar || accessor.normalized() {
            return Err(unfit(accessor, what, "of a type that is not read"));
        }
        let indices = self.elements(accessor, what, 0, unsigned)?;
        // Where primitives can be restarted, this index does it; glTF forbids it.
        if indices.contains(&greatest) {
            return Err(unfit(accessor, what, "with the greatest index of its type, which is no vertex"));
        }
        Ok(indices)
    }

    /// Makes sure that all elements of an accessor are there, whatever they are.
    pub fn check(&self, accessor: &Accessor, what: &'static str) -> Result<(), Trouble> {
        self.elements(accessor, what, (), |_| ()).map(drop)
    }

    /// The bytes of a view.
    pub fn view(&self, view: &View) -> Result<&[u8], Trouble> {
        let found = self.span(view, 0, 1, view.length(), view.length())?;
        Ok(found.unwrap_or(&[]))
    }

    fn elements<T: Copy>(
        &self,
        accessor: &Accessor,
        what: &'static str,
        zero: T,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Trouble> {
        let fail = |why| unfit(accessor, what, why);
        let (size, count) = (accessor.size(), accessor.count());
        if count == 0 {
            return Err(fail("empty"));
        }
        let base = match accessor.view() {
            Some(view) => {
                let stride = view.stride().unwrap_or(size);
                if stride < size {
                    return Err(fail("packed closer than its elements are long"));
                }
                let bytes = self
                    .span(&view, accessor.offset(), count, stride, size)?
                    .ok_or_else(|| fail("longer than its buffer view"))?;
                Some(bytes.chunks(stride))
            }
            None if count > MOST_ZEROS => return Err(fail("too long to be read without a buffer view")),
            None => None,
        };
        if !self.spend(count) {
            return Err(fail(TOO_MUCH));
        }
        let mut elements: Vec<T> = match base {
            Some(chunks) => chunks.map(|chunk| decode(&chunk[..size])).collect(),
            None => vec![zero; count],
        };
        if let Some(sparse) = accessor.sparse() {
            if sparse.count() == 0 || sparse.count() > count {
                return Err(fail("sparse with no elements, or with more than it has"));
            }
            let packed = |view: &View, offset: usize, size: usize| {
                if view.stride().is_some() {
                    return Err(fail("sparse with a stride"));
                }
                self.span(view, offset, sparse.count(), size, size)?
                    .ok_or_else(|| fail("sparse with more elements than its buffer view holds"))
            };
            let (places, values) = (sparse.indices(), sparse.values());
            let width = match places.index_type() {
                IndexType::U8 => 1,
                IndexType::U16 => 2,
                IndexType::U32 => 4,
            };
            let at = packed(&places.view(), places.offset(), width)?.chunks_exact(width);
            let new = packed(&values.view(), values.offset(), size)?.chunks_exact(size);
            let mut least = 0;
            for (place, value) in at.map(|b| unsigned(b) as usize).zip(new) {
                if place < least {
                    return Err(fail("sparse with indices that do not ascend"));
                }
                *elements.get_mut(place).ok_or_else(|| fail("sparse with an index beyond its end"))? =
                    decode(value);
                least = place + 1;
            }
        }
        Ok(elements)
    }

    /// The bytes from the first of `count` elements to the end of the last; `None` if the view is
    /// too short.
    fn span(
        &self,
        view: &View,
        offset: usize,
        count: usize,
        stride: usize,
        size: usize,
    ) -> Result<Option<&[u8]>, Trouble> {
        let buffer = view.buffer().index();
        let bytes = self.bytes.get(buffer).map_or(&[][..], |bytes| bytes.as_slice());
        let end = view.offset().checked_add(view.length());
        let Some(bytes) = end.and_then(|end| bytes.get(view.offset()..end)) else {
            let needed = end.unwrap_or(usize::MAX);
            return Err(short(buffer, bytes.len(), needed));
        };
        let length = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
        let end = length.and_then(|n| n.checked_add(offset));
        Ok(end.and_then(|end| bytes.get(offset..end)))
    }
}

/// Why an accessor is refused.
pub fn unfit(accessor: &Accessor, what: &'static str, why: &'static str) -> Trouble {
    Trouble::Part(format!("accessor {} ({what}) is {why}", accessor.index()))
}

/// A little-endian number of at most 4 bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |n, &byte| n << 8 | u32::from(byte))
}

fn component(data_type: DataType, normalized: bool, bytes: &[u8]) -> f32 {
    let bits = unsigned(bytes);
    let (value, most) = match data_type {
        DataType::I8 => (f32::from(bits as u8 as i8), 127.0),
        DataType::U8 => (f32::from(bits as u8), 255.0),
        DataType::I16 => (f32::from(bits as u16 as i16), 32767.0),
        DataType::U16 => (f32::from(bits as u16), 65535.0),
        DataType::U32 | DataType::F32 => return f32::from_bits(bits),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}
