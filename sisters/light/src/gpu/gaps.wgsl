// Irradiance by rays where a picture has none of states.

@group(0) @binding(4) var before: texture_2d<f32>;

// The `i`th direction above a surface, as dense as its cosine (Malley 1988).
fn casca_above(i: u32, normal: vec3f, key: u32) -> vec3f {
    let square = (f32(i) + casca_unit(key, 1u)) / f32(gloss.rays);
    let turn = TURN * casca_golden(i, casca_unit(key, 0u));
    let right = casca_across(normal);
    let up = cross(normal, right);
    let radius = sqrt(square);
    return normalize(right * (radius * cos(turn)) + up * (radius * sin(turn)) + normal * sqrt(1.0 - square));
}

// By thread: what some of a pixel's rays bring.
var<workgroup> parts: array<vec3f, 64>;

@compute @workgroup_size(64)
fn gaps(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) index: u32) {
    let lane = index % gloss.lanes;
    let id = casca_pixel(group.xy, index);
    let is_in = all(id < textureDimensions(picture));
    var light = vec4f(0.0);
    var is_gap = false;
    var sum = vec3f(0.0);
    if is_in {
        light = textureLoad(before, id, 0);
        let position = textureLoad(place, id, 0);
        let normal = textureLoad(normals, id, 0).xyz;
        if light.w == 0.0 && position.w >= 1.0 && dot(normal, normal) > 0.0 {
            let facing = normalize(normal);
            let spot = (position.xyz - casca_grid.low) / casca_grid.cell + facing * LIFT;
            // From farther away than half of FAR, the way to the grid may be longer than FAR.
            is_gap = all(abs(spot) < vec3f(0.5 * FAR));
            let key = casca_key(position.xyz);
            for (var i = lane; is_gap && i < gloss.rays; i += gloss.lanes) {
                // The light of lamps is direct.
                sum += casca_along(spot, casca_above(i, facing, key), 0.0).rgb;
            }
        }
    }
    parts[index] = sum;
    workgroupBarrier();
    if !is_in || lane != 0u { return; }
    for (var i = 1u; i < gloss.lanes; i++) { sum += parts[index + i]; }
    // The mean radiance times pi.
    if is_gap { light += vec4f(sum * (0.5 * TURN / f32(gloss.rays)), 0.5); }
    textureStore(picture, id, light);
}
