//! Why a command failed.

use std::error::Error;

/// Why a command failed.
pub type Failure = Box<dyn Error + Send + Sync>;
