//! Margins of shapes and plain geometry.
