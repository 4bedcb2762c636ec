//! Margins of the scene: volumes, times, occluders against bounds.
