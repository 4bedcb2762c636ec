#![doc = include_str!("../README.md")]
//! [`Slots`] stores values, each in a [`Slot`]: a small number that no other value has at the same
//! time, so that tables beside it are plain vectors by slot. An [`Id`] names one value for ever:
//! it also holds the generation of the slot, and a tag that tells the store from all others.
//!
//! # Why not slotmap
//!
//! [slotmap](https://docs.rs/slotmap) 1.1.1 was read first. It iterates in the order of slots and
//! its keys go through 64 bits, but it does not serve:
//!
//! - **Ids come back.** The version of a slot wraps around after 2^31 removals, and an old key then
//!   names another value. Here a slot whose generations are used up is given up.
//! - **Keys know no owner.** A key of one map finds whatever another map has in that slot. A tag
//!   would have to be checked around each call, and be stored for each slot besides: a clone knows
//!   the ids that it was made with, but not those that the original gives out later.
//! - **No access by slot.** Matrices and lists of cells hold a slot in 4 bytes and read its value
//!   without knowing the version. A slotmap reads only by a key of 8 bytes.
//! - **No insertion under a given id**, which a copy that follows its original needs: `reattach`
//!   takes only keys that the same map detached, and panics on others.

mod expiry;
mod set;
mod slot;
mod slots;

pub use expiry::{Expiry, ExpiryQueue};
pub use set::SlotSet;
pub use slot::{Id, Slot};
pub use slots::{MOST_SLOTS, Slots};
