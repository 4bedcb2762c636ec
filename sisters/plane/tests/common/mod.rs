//! Settings and shapes that the tests share.

mod cases;
pub mod forms;

pub use cases::cases;
