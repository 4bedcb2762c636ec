// The camera, for all shaders of light.

struct Eye {
    to_clip: mat4x4f,
    position: vec3f,
    layer: u32,
    sky: vec3f,
    exposure: f32,
    // The ray of a place: corner + x right + y down, in pixels. Depths are finest before the reach.
    corner: vec3f,
    reach: f32,
    right: vec3f,
    down: vec3f,
}
@group(0) @binding(0) var<uniform> eye: Eye;

