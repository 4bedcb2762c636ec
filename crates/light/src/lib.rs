//! Light that bounces: voxel cone tracing on the grid of casca, with wgpu.
