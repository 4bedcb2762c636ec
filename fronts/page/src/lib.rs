//! The viewer of casca as one static page: `.ci/page` makes `web/index.html` of it.
//!
//! - `viewer`: what the script of the page calls.
//! - `cpp`: memory for a library in C++.
//! - `told`: messages to that script, as JSON.
//!
//! The page's own script and looks are in `index.html` beside the sources. On other targets this
//! crate is empty.
#![cfg(target_arch = "wasm32")]
#![deny(missing_docs)]

mod cpp;
mod told;
mod viewer;

pub use viewer::Viewer;
