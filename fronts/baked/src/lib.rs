//! Files of visibility that was found ahead of time: for each cell of a grid of boxes, the objects
//! that can be seen from anywhere in it.
//!
#![doc = include_str!("../README.md")]
//!
//! # Format
//!
//! All numbers are little-endian; nothing is aligned.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `CASCAPVS` |
//! | 4 | version: 3 |
//! | 4 | what sets hold: 0 for objects, 1 for cells of the grid itself |
//! | 4 | number of objects, or of cells |
//! | 4 | CRC-32 of the numbers, ascending, of the cells that sets tell of; 0 for objects |
//! | 24 | least corner of the grid, 3 doubles |
//! | 24 | edges of a cell, 3 doubles |
//! | 12 | cells along x, y and z |
//! | 24 | from where solids were given in single precision, 3 doubles |
//! | 4 | number of sets `n` |
//! | 4 for each cell | its set, or 2^32 - 1 if it has none; x runs fastest |
//! | 4 (n + 1) | where each set begins, and the last one ends, in the bytes that follow |
//! | the rest but 4 | sets |
//! | 4 | CRC-32 of all bytes before |
//!
//! A set is a list of numbers by 7 bits a byte, the last byte of each without its highest bit: how
//! many sets before it is the set that it differs from (0: none), then the objects that are in one
//! of the two only, ascending: each as its distance from the one before, less 1.
#![no_std]
#![deny(missing_docs)]

#[cfg(feature = "write")]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod cells;
mod error;
mod numbers;
mod read;
mod set;
#[cfg(feature = "write")]
mod write;

pub use cells::{CellBox, Cells, NEAR};
pub use error::{ReadError, WriteError};
pub use read::Baked;
pub use set::{Objects, Set};
#[cfg(feature = "write")]
pub use write::Writer;

/// The first bytes of a file.
const MAGIC: [u8; 8] = *b"CASCAPVS";

/// The version that is written and read.
const VERSION: u32 = 3;

/// The bytes before the sets of cells.
const HEADER: usize = 8 + 4 + 4 + 4 + 4 + 24 + 24 + 12 + 24 + 4;

/// What sets hold: objects, or cells of the grid itself.
const OBJECTS: u32 = 0;
const CELLS: u32 = 1;

/// A cell without a set.
const NONE: u32 = u32::MAX;

/// A set differs from one that differs from another, and so on: so many lists make up one at most.
const DEPTH: usize = 4;
