// What the application drew: positions in metres, whose fourth component is 1 where there is a
// surface, and normals.

@group(0) @binding(0) var place: texture_2d<f32>;
@group(0) @binding(1) var normals: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_storage_2d<rgba32float, write>;
