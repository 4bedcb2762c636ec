//! Margins of meshes: preparing, outlines, cells of triangles.
