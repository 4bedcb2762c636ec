// A picture of irradiance.

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(picture)) { return; }
    let position = textureLoad(place, id.xy, 0);
    let normal = textureLoad(normals, id.xy, 0).xyz;
    var light = vec4f(0.0);
    if position.w >= 1.0 && dot(normal, normal) > 0.0 {
        light = ANSWER(position.xyz, normalize(normal));
    }
    textureStore(picture, id.xy, light);
}
