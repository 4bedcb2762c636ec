//! Margins of views: matrices, eyes, planes.
