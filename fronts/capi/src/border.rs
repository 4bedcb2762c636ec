//! The border: memory that C owns, read and written. All `unsafe` of this crate is here.
//!
//! Every function takes pointers that an exported function was called with. The manual at the head
//! of the header states the promise that callers make there: a pointer is null, or leads to as much
//! memory as the function's comment says, which no other thread writes meanwhile. What can be
//! checked without following the pointer is checked: null, alignment, and sizes that no memory has.

use std::mem::MaybeUninit;

use crate::error::{Failure, call, casca_status};

/// Types of which every sequence of bits is a value.
///
/// # Safety
/// Only numbers, arrays of numbers, and structs of those.
pub(crate) unsafe trait Plain: Copy {}

// SAFETY: numbers, and arrays of them.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for u64 {}
// SAFETY: as above.
unsafe impl<const N: usize> Plain for [f32; N] {}
// SAFETY: as above.
unsafe impl<const N: usize> Plain for [f64; N] {}
// SAFETY: as above.
unsafe impl<const N: usize> Plain for [u32; N] {}
/// Says that all bits are values of a struct: numbers, handles, and pointers that only this module
/// follows.
macro_rules! plain {
    ($name:ident) => {
        // SAFETY: it has no other fields.
        unsafe impl $crate::border::Plain for $name {}
    };
}
pub(crate) use plain;

/// A struct that C passes, whose first field is its size in bytes.
///
/// # Safety
/// `#[repr(C)]`, the first field is `size: usize`, and all bytes zero are a value of it, as is any
/// change of those bytes that C can make: numbers, pointers and optional functions.
pub(crate) unsafe trait Sized: Copy {
    /// Its name in C.
    const NAME: &'static str;
    /// The size that it had when it came into the header first.
    const LEAST: usize;
}

/// Says that a struct grows by its size.
macro_rules! grows {
    ($($name:ident: $least:expr,)+) => {
        $(
            // SAFETY: it has the fields that the trait asks for.
            unsafe impl $crate::border::Sized for $name {
                const NAME: &'static str = stringify!($name);
                const LEAST: usize = $least;
            }
        )+
    };
}
pub(crate) use grows;

/// No struct of any version is larger.
const GREATEST: usize = 4096;

fn null(what: &str) -> Failure {
    Failure::new(casca_status::CASCA_ERROR_NULL_POINTER, format!("{what} must not be null"))
}

fn check<T>(pointer: *const T, what: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(null(what));
    }
    if !pointer.is_aligned() {
        let (at, by) = (pointer.addr(), align_of::<T>());
        let why = format!("{what} must be aligned to {by} bytes, but is {at:#x}");
        return Err(Failure::new(casca_status::CASCA_ERROR_BAD_SPAN, why));
    }
    Ok(())
}

fn check_span<T>(pointer: *const T, count: usize, what: &str) -> Result<(), Failure> {
    check(pointer, what)?;
    let bytes = count.checked_mul(size_of::<T>()).filter(|&bytes| isize::try_from(bytes).is_ok());
    if bytes.is_none_or(|bytes| pointer.addr().checked_add(bytes).is_none()) {
        let why = format!("{what} cannot have {count} elements: no memory is as large");
        return Err(Failure::new(casca_status::CASCA_ERROR_BAD_SPAN, why));
    }
    Ok(())
}

/// The size that a struct says it has.
fn size_of_struct<T: Sized>(pointer: *const T) -> Result<usize, Failure> {
    check(pointer, T::NAME)?;
    // SAFETY: the caller's struct has at least its first field, and was checked for alignment.
    let size = unsafe { pointer.cast::<usize>().read() };
    if (T::LEAST..=GREATEST).contains(&size) {
        return Ok(size);
    }
    let why = format!(
        "{0}.size must be sizeof({0}), at least {1}, but is {size}: fill it by CASCA_INIT",
        T::NAME,
        T::LEAST
    );
    Err(Failure::new(casca_status::CASCA_ERROR_BAD_STRUCT, why))
}

/// Reads a struct. Fields that an older header lacks are zero, which is their default. Fields that
/// only a newer header has must be zero.
pub(crate) fn read<T: Sized>(pointer: *const T) -> Result<T, Failure> {
    let size = size_of_struct(pointer)?;
    let (known, bytes) = (size.min(size_of::<T>()), pointer.cast::<u8>());
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller's struct has `size` bytes, and the copy has room for the known ones.
    unsafe { bytes.copy_to_nonoverlapping(value.as_mut_ptr().cast(), known) };
    // SAFETY: as above; what lies beyond the known fields belongs to the caller's struct, too.
    let unknown = unsafe { std::slice::from_raw_parts(bytes.add(known), size - known) };
    if unknown.iter().any(|byte| *byte != 0) {
        let why = format!("{} has fields that this version does not know, and they are not 0", T::NAME);
        return Err(Failure::new(casca_status::CASCA_ERROR_BAD_STRUCT, why));
    }
    // SAFETY: zeros with bytes of such a struct over them are a value, as the trait says.
    Ok(unsafe { value.assume_init() })
}

/// As [`read`]; a null pointer is a struct of zeros.
pub(crate) fn read_or_default<T: Sized>(pointer: *const T) -> Result<T, Failure> {
    if pointer.is_null() {
        // SAFETY: zeros are a value, as the trait says.
        return Ok(unsafe { MaybeUninit::zeroed().assume_init() });
    }
    read(pointer)
}

/// A struct for results, which the caller owns.
pub(crate) struct OutStruct<T: Sized> {
    to: *mut T,
    size: usize,
}

impl<T: Sized> OutStruct<T> {
    pub(crate) fn new(to: *mut T) -> Result<Self, Failure> {
        Ok(Self { to, size: size_of_struct(to.cast_const())? })
    }

    /// Writes all fields but the size: those that the caller's header has.
    pub(crate) fn set(&self, value: &T) {
        let (head, bytes) = (size_of::<usize>(), self.to.cast::<u8>());
        let known = self.size.min(size_of::<T>());
        let from = std::ptr::from_ref(value).cast::<u8>();
        // SAFETY: the caller's struct has `size` bytes, of which `known` are there in both structs;
        // `value` is a copy of ours, so that they do not overlap.
        unsafe { from.add(head).copy_to_nonoverlapping(bytes.add(head), known - head) };
        // SAFETY: as above.
        unsafe { bytes.add(known).write_bytes(0, self.size - known) };
    }
}

/// A span of the caller's.
pub(crate) fn span<'a, T: Plain>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    check_span(pointer, count, what)?;
    // SAFETY: it is aligned, has a size that memory can have, and the caller's memory there lives
    // until the call ends. All bits are values.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// One array of the caller's.
pub(crate) fn array<T: Plain>(pointer: *const T, what: &str) -> Result<T, Failure> {
    check(pointer, what)?;
    // SAFETY: it is aligned, and leads to one value as the function's comment says.
    Ok(unsafe { pointer.read() })
}

/// Positions that lie `stride` bytes apart, 0 for 12.
pub(crate) fn positions(
    pointer: *const f32,
    count: usize,
    stride: usize,
    what: &str,
) -> Result<Vec<[f32; 3]>, Failure> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let stride = if stride == 0 { size_of::<[f32; 3]>() } else { stride };
    if stride % align_of::<f32>() != 0 || stride < size_of::<[f32; 3]>() || stride > 1 << 16 {
        let why = format!("the stride of {what} must be a multiple of 4 from 12 to 65536, not {stride}");
        return Err(Failure::new(casca_status::CASCA_ERROR_BAD_SPAN, why));
    }
    check(pointer, what)?;
    check_span(pointer.cast::<u8>(), count.saturating_mul(stride), what)?;
    let at = |i: usize| {
        // SAFETY: the caller's span has `count` positions at this stride, the products do not
        // overflow, and the stride keeps the alignment.
        unsafe { pointer.byte_add(i * stride).cast::<[f32; 3]>().read() }
    };
    Ok((0..count).map(at).collect())
}

/// A place for one result, checked before anything is changed.
pub(crate) struct Out<T: Copy>(*mut T);

impl<T: Copy> Out<T> {
    pub(crate) fn new(to: *mut T, what: &str) -> Result<Self, Failure> {
        check(to.cast_const(), what)?;
        Ok(Self(to))
    }

    /// The same for a result that the caller may not want.
    pub(crate) fn or_null(to: *mut T, what: &str) -> Result<Self, Failure> {
        if to.is_null() { Ok(Self(to)) } else { Self::new(to, what) }
    }

    pub(crate) fn set(&self, value: T) {
        if !self.0.is_null() {
            // SAFETY: it was checked for alignment, and leads to room for one value.
            unsafe { self.0.write(value) }
        }
    }
}

/// Runs the body of an exported function that gives one result.
pub(crate) fn give<T: Copy>(
    to: *mut T,
    what: &str,
    body: impl FnOnce() -> Result<T, Failure>,
) -> casca_status {
    call(|| {
        let out = Out::new(to, what)?;
        out.set(body()?);
        Ok(())
    })
}

/// The same for a struct, whose field `size` stays the caller's.
pub(crate) fn give_struct<T: Sized>(to: *mut T, body: impl FnOnce() -> Result<T, Failure>) -> casca_status {
    call(|| {
        let out = OutStruct::new(to)?;
        out.set(&body()?);
        Ok(())
    })
}

/// Room for many results, and for their number.
pub(crate) struct OutSpan<T: Plain> {
    to: *mut T,
    capacity: usize,
    count: Out<usize>,
    what: &'static str,
}

impl<T: Plain> OutSpan<T> {
    pub(crate) fn new(
        to: *mut T,
        capacity: usize,
        count: *mut usize,
        what: &'static str,
    ) -> Result<Self, Failure> {
        if capacity > 0 {
            check_span(to.cast_const(), capacity, what)?;
        }
        Ok(Self { to, capacity, count: Out::new(count, "count")?, what })
    }

    /// Writes the results, if there is room for all; their number in any case.
    pub(crate) fn set(&self, values: &[T]) -> Result<(), Failure> {
        self.count.set(values.len());
        if values.len() > self.capacity {
            let (what, has, needs) = (self.what, self.capacity, values.len());
            let why = format!("{what} has room for {has} elements, but {needs} are needed");
            return Err(Failure::new(casca_status::CASCA_ERROR_TOO_SMALL, why));
        }
        if !values.is_empty() {
            // SAFETY: it was checked for null, alignment and size, and the caller's memory there
            // has room for as many values.
            unsafe { self.to.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
        }
        Ok(())
    }
}

/// One result for each of some questions: the room was promised to be as long as those.
pub(crate) struct OutList<T: Plain> {
    to: *mut T,
    count: usize,
}

impl<T: Plain> OutList<T> {
    pub(crate) fn new(to: *mut T, count: usize, what: &str) -> Result<Self, Failure> {
        if count > 0 {
            check_span(to.cast_const(), count, what)?;
        }
        Ok(Self { to, count })
    }

    /// Writes the first results of an iterator, at most as many as there is room for.
    pub(crate) fn set(&self, values: impl Iterator<Item = T>) {
        for (i, value) in values.take(self.count).enumerate() {
            // SAFETY: checked as above, and `i` is less than the number of values.
            unsafe { self.to.add(i).write(value) };
        }
    }
}

/// Calls a function of the caller's.
pub(crate) fn tell(
    progress: unsafe extern "C" fn(f32, *mut std::ffi::c_void) -> i32,
    share: f32,
    user: *mut std::ffi::c_void,
) -> i32 {
    // SAFETY: the caller passed the function and its data, and both live until this call ends.
    unsafe { progress(share, user) }
}
