// Light as colours of a screen.

@group(0) @binding(1) var light: texture_2d<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Exposed, cut off at 1, by the curve of sRGB (IEC 61966-2-1).
@fragment
fn colour(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var found = textureLoad(light, vec2u(position.xy), 0).rgb;
    if eye.layer != ALBEDO && eye.layer != NORMALS {
        found = clamp(found * eye.exposure, vec3f(0.0), vec3f(1.0));
        found = select(1.055 * pow(found, vec3f(1.0 / 2.4)) - 0.055, 12.92 * found, found < vec3f(0.0031308));
    }
    return vec4f(found, 1.0);
}
