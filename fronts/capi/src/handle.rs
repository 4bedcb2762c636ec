//! Handles: numbers that C holds in the place of pointers.
//!
//! A handle names its kind, a slot, and how often that slot was used before. So a call tells a
//! handle that was freed, or is of another kind, from one that lives, without following a pointer.
//!
//! Each slot has a lock that calls never wait for: a call that reads takes its share, a call that
//! changes takes all, and where that fails the call is refused as busy. So no two calls can wait
//! for each other, whatever they lock in which order.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};

use crate::error::{Failure, casca_status};

/// The slots of the first chunk; each further one has twice as many.
const FIRST: usize = 64;
/// The bits of a slot's number in a handle.
const SLOT_BITS: u32 = 24;
/// As many chunks as that number can name.
const CHUNKS: usize = (SLOT_BITS - FIRST.ilog2()) as usize;

/// The names of kinds, by their numbers.
const KINDS: [&str; 8] = ["", "scene", "query", "mesh", "solid", "job", "plane scene", "plane query"];

/// A slot. Neighbours do not share a line of the cache.
#[repr(align(64))]
struct Slot<T> {
    /// How often the slot was used before, counted from 1.
    generation: AtomicU32,
    value: RwLock<Option<Box<T>>>,
}

/// The slots that are free.
struct Free {
    slots: Vec<u32>,
    /// Slots from this one on were never used.
    used: u32,
}

/// All that handles of one kind name.
pub(crate) struct Registry<T> {
    kind: u8,
    chunks: [OnceLock<Box<[Slot<T>]>>; CHUNKS],
    free: Mutex<Free>,
}

/// A value that a call may read, together with other calls.
pub(crate) struct Shared<'a, T>(RwLockReadGuard<'a, Option<Box<T>>>);

/// A value that a call may change, since no other call uses it.
pub(crate) struct Exclusive<'a, T>(RwLockWriteGuard<'a, Option<Box<T>>>);

impl<T> Deref for Shared<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_ref().expect("slots are looked at before they are shared")
    }
}

impl<T> Deref for Exclusive<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_ref().expect("slots are looked at before they are lent")
    }
}

impl<T> DerefMut for Exclusive<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.as_mut().expect("slots are looked at before they are lent")
    }
}

/// The chunk of a slot, and its place there.
fn place(slot: usize) -> (usize, usize) {
    let from_first = slot + FIRST;
    let chunk = (from_first / FIRST).ilog2() as usize;
    (chunk, from_first - (FIRST << chunk))
}

impl<T> Registry<T> {
    /// No handles of a kind.
    pub(crate) const fn new(kind: u8) -> Self {
        let free = Mutex::new(Free { slots: Vec::new(), used: 0 });
        Self { kind, chunks: [const { OnceLock::new() }; CHUNKS], free }
    }

    fn slot(&self, number: usize) -> Option<&Slot<T>> {
        let (chunk, at) = place(number);
        self.chunks.get(chunk)?.get()?.get(at)
    }

    fn name(&self) -> &'static str {
        KINDS[usize::from(self.kind)]
    }

    /// Stores a value and gives its handle.
    pub(crate) fn add(&self, value: T) -> Result<u64, Failure> {
        let number = {
            let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
            match free.slots.pop() {
                Some(number) => number,
                None if place(free.used as usize).0 < CHUNKS => {
                    free.used += 1;
                    free.used - 1
                }
                None => {
                    let why = format!("there are as many handles of the kind {} as can be", self.name());
                    return Err(Failure::new(casca_status::CASCA_ERROR_FULL, why));
                }
            }
        };
        let (chunk, at) = place(number as usize);
        let make = || {
            let slot = || Slot { generation: AtomicU32::new(1), value: RwLock::new(None) };
            std::iter::repeat_with(slot).take(FIRST << chunk).collect()
        };
        let slot = &self.chunks[chunk].get_or_init(make)[at];
        *slot.value.write().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(value));
        slot.value.clear_poison();
        let generation = slot.generation.load(Ordering::Acquire);
        Ok(u64::from(self.kind) << 56 | u64::from(number) << 32 | u64::from(generation))
    }

    fn refuse(&self, status: casca_status, handle: u64, why: &str) -> Failure {
        Failure::new(status, format!("the handle {handle:#x} of a {} {why}", self.name()))
    }

    /// The slot that a handle names, if its generation is the present one.
    #[inline]
    fn find(&self, handle: u64) -> Result<&Slot<T>, Failure> {
        let (kind, generation) = ((handle >> 56) as u8, handle as u32);
        let number = (handle >> 32) as usize & ((1 << SLOT_BITS) - 1);
        match self.slot(number) {
            Some(slot) if kind == self.kind => match slot.generation.load(Ordering::Acquire) {
                present if present == generation => Ok(slot),
                present => Err(self.refuse_generation(handle, generation > present)),
            },
            _ => Err(self.refuse_kind(handle, kind)),
        }
    }

    #[cold]
    fn refuse_generation(&self, handle: u64, is_later: bool) -> Failure {
        if is_later || handle as u32 == 0 {
            return self.never(handle);
        }
        self.refuse(casca_status::CASCA_ERROR_STALE_HANDLE, handle, "was freed")
    }

    #[cold]
    fn never(&self, handle: u64) -> Failure {
        self.refuse(casca_status::CASCA_ERROR_INVALID_HANDLE, handle, "was never given out")
    }

    #[cold]
    fn refuse_kind(&self, handle: u64, kind: u8) -> Failure {
        match KINDS.get(usize::from(kind)) {
            Some(name) if kind != 0 && kind != self.kind => {
                let status = casca_status::CASCA_ERROR_WRONG_KIND;
                self.refuse(status, handle, &format!("is needed, but it names a {name}"))
            }
            _ => self.never(handle),
        }
    }

    #[cold]
    fn refuse_lock<G>(&self, handle: u64, why: &TryLockError<G>) -> Failure {
        match why {
            TryLockError::WouldBlock => self.refuse(
                casca_status::CASCA_ERROR_BUSY,
                handle,
                "is in use by another thread, or was given twice: a call that changes it must be alone",
            ),
            TryLockError::Poisoned(_) => self.refuse(
                casca_status::CASCA_ERROR_PANIC,
                handle,
                "was being changed when a call panicked: free it",
            ),
        }
    }

    /// Lends the value of a handle to be read, together with other calls that read it.
    #[inline]
    pub(crate) fn shared(&self, handle: u64) -> Result<Shared<'_, T>, Failure> {
        let slot = self.find(handle)?;
        let value = slot.value.try_read().map_err(|why| self.refuse_lock(handle, &why))?;
        // It may have been freed, and even used again, since the look at the generation.
        self.find(handle)?;
        if value.is_none() { Err(self.never(handle)) } else { Ok(Shared(value)) }
    }

    /// Lends the value of a handle to be changed, by this call alone.
    #[inline]
    pub(crate) fn exclusive(&self, handle: u64) -> Result<Exclusive<'_, T>, Failure> {
        let slot = self.find(handle)?;
        let value = slot.value.try_write().map_err(|why| self.refuse_lock(handle, &why))?;
        self.find(handle)?;
        if value.is_none() { Err(self.never(handle)) } else { Ok(Exclusive(value)) }
    }

    /// Takes the value of a handle out. The handle names nothing from then on.
    pub(crate) fn take(&self, handle: u64) -> Result<T, Failure> {
        let slot = self.find(handle)?;
        let mut value = match slot.value.try_write() {
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            other => other.map_err(|why| self.refuse_lock(handle, &why))?,
        };
        self.find(handle)?;
        let taken = value.take().ok_or_else(|| self.never(handle))?;
        let used = handle as u32;
        slot.generation.store(used.saturating_add(1), Ordering::Release);
        drop(value);
        // A slot whose generations are used up is given up.
        if used.saturating_add(1) < u32::MAX {
            let number = (handle >> 32) as u32 & ((1 << SLOT_BITS) - 1);
            self.free.lock().unwrap_or_else(PoisonError::into_inner).slots.push(number);
        }
        Ok(*taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_status::*;

    fn refusal<T>(result: Result<T, Failure>) -> casca_status {
        result.err().expect("it must be refused").status
    }

    #[test]
    fn handles_are_never_used_again() {
        static NUMBERS: Registry<u32> = Registry::new(1);
        let mut old = Vec::new();
        for i in 0..1000 {
            let handle = NUMBERS.add(i).unwrap();
            assert_eq!(*NUMBERS.shared(handle).unwrap(), i);
            assert!(!old.contains(&handle));
            old.push(handle);
            if i % 3 != 0 {
                assert_eq!(NUMBERS.take(handle).unwrap(), i);
                assert_eq!(refusal(NUMBERS.shared(handle)), CASCA_ERROR_STALE_HANDLE);
                assert_eq!(refusal(NUMBERS.take(handle)), CASCA_ERROR_STALE_HANDLE);
            }
        }
        assert_eq!(*NUMBERS.shared(old[999]).unwrap(), 999);
    }

    #[test]
    fn kinds_and_numbers_that_were_never_given_out_are_told_apart() {
        static NUMBERS: Registry<u32> = Registry::new(1);
        let handle = NUMBERS.add(7).unwrap();
        for (bits, status) in [
            (0, CASCA_ERROR_INVALID_HANDLE),
            (u64::MAX, CASCA_ERROR_INVALID_HANDLE),
            (handle + 1, CASCA_ERROR_INVALID_HANDLE),
            (handle - 1, CASCA_ERROR_INVALID_HANDLE),
            (handle | 3 << 32, CASCA_ERROR_INVALID_HANDLE),
            (handle | 0xff_ffff << 32, CASCA_ERROR_INVALID_HANDLE),
            (handle | 2 << 56, CASCA_ERROR_WRONG_KIND),
        ] {
            assert_eq!(refusal(NUMBERS.shared(bits)), status, "{bits:#x}");
            assert_eq!(refusal(NUMBERS.exclusive(bits)), status, "{bits:#x}");
        }
    }

    #[test]
    fn who_changes_is_alone() {
        static NUMBERS: Registry<u32> = Registry::new(1);
        let handle = NUMBERS.add(7).unwrap();
        let (one, two) = (NUMBERS.shared(handle).unwrap(), NUMBERS.shared(handle).unwrap());
        assert_eq!(refusal(NUMBERS.exclusive(handle)), CASCA_ERROR_BUSY);
        assert_eq!(refusal(NUMBERS.take(handle)), CASCA_ERROR_BUSY);
        drop((one, two));
        let alone = NUMBERS.exclusive(handle).unwrap();
        assert_eq!(refusal(NUMBERS.shared(handle)), CASCA_ERROR_BUSY);
        drop(alone);
        assert!(NUMBERS.take(handle).is_ok());
    }

    #[test]
    fn a_panic_makes_a_handle_useless_but_free() {
        static NUMBERS: Registry<u32> = Registry::new(1);
        let handle = NUMBERS.add(7).unwrap();
        let status = crate::error::call(|| {
            let _alone = NUMBERS.exclusive(handle)?;
            panic!("while it is changed")
        });
        assert_eq!(status, CASCA_ERROR_PANIC);
        assert_eq!(refusal(NUMBERS.shared(handle)), CASCA_ERROR_PANIC);
        assert_eq!(NUMBERS.take(handle).unwrap(), 7);
        let next = NUMBERS.add(8).unwrap();
        assert_eq!(*NUMBERS.shared(next).unwrap(), 8);
    }

    #[test]
    fn places_follow_each_other() {
        let mut next = (0, 0);
        for slot in 0..5000 {
            assert_eq!(place(slot), next);
            next = if next.1 + 1 == FIRST << next.0 { (next.0 + 1, 0) } else { (next.0, next.1 + 1) };
        }
        assert!(place((1 << SLOT_BITS) - 1 - FIRST).0 < CHUNKS);
    }
}
