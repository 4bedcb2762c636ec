// A picture of irradiance. A position without a fourth component of 1 shows nothing.

@group(0) @binding(0) var positions: texture_2d<f32>;
@group(0) @binding(1) var normals: texture_2d<f32>;
@group(0) @binding(2) var picture: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(picture)) { return; }
    let position = textureLoad(positions, id.xy, 0);
    let normal = textureLoad(normals, id.xy, 0).xyz;
    var light = vec4f(0.0);
    if position.w == 1.0 && dot(normal, normal) > 0.0 {
        light = casca_irradiance(position.xyz, normalize(normal));
    }
    textureStore(picture, id.xy, light);
}
