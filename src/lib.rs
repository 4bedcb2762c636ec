//! casca
