//! Margins of occlusion buffers: silhouettes, depths, coverage.
