// What the application drew.

@group(0) @binding(0) var place: PLACE;
@group(0) @binding(1) var normals: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_storage_2d<rgba32float, write>;
@group(0) @binding(3) var<uniform> view: View;

// From clip space into metres, and the depth that shows nothing.
struct View { inverse: mat4x4f, empty: f32 }

// A position without a fourth component of 1 shows nothing.
fn at_position(id: vec2u) -> vec4f {
    return textureLoad(place, id, 0);
}

fn at_depth(id: vec2u) -> vec4f {
    let depth = textureLoad(place, id, 0);
    if depth == view.empty { return vec4f(0.0); }
    let across = (vec2f(id) + 0.5) / vec2f(textureDimensions(place));
    let point = view.inverse * vec4f(2.0 * across.x - 1.0, 1.0 - 2.0 * across.y, depth, 1.0);
    return vec4f(point.xyz / point.w, 1.0);
}
