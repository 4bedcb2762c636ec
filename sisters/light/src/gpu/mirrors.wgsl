// A picture of what glossy surfaces mirror: rays of a lobe.

@group(0) @binding(4) var roughness: texture_2d<f32>;

// Smith's lambda of GGX, by the cosine of a way above the surface.
fn casca_shadow(cosine: f32, rough: f32) -> f32 {
    let c = max(cosine, LEAST_COSINE);
    return 0.5 * (sqrt(1.0 + rough * rough * max(1.0 - c * c, 0.0) / (c * c)) - 1.0);
}

// The `i`th direction of a lobe of GGX, as dense as visible normals (Heitz 2018), and its weight: 0
// below the surface. The third axis is the surface's normal.
fn casca_lobe(i: u32, eye: vec3f, rough: f32, key: u32) -> vec4f {
    let bent = normalize(vec3f(rough * eye.xy, eye.z));
    // Along the horizon, whose far half the surface hides: the other axis is squeezed.
    let size = dot(bent.xy, bent.xy);
    var across = vec3f(1.0, 0.0, 0.0);
    if size > NO_WAY { across = vec3f(-bent.y, bent.x, 0.0) * inverseSqrt(size); }
    let along = cross(bent, across);
    let radius = sqrt((f32(i) + casca_unit(key, 1u)) / f32(gloss.rays * gloss.tries));
    let turn = TURN * casca_golden(i, casca_unit(key, 0u));
    let x = radius * cos(turn);
    let y = mix(sqrt(max(1.0 - x * x, 0.0)), radius * sin(turn), 0.5 * (1.0 + bent.z));
    let dome = across * x + along * y + bent * sqrt(max(1.0 - x * x - y * y, 0.0));
    let facet = normalize(vec3f(rough * dome.xy, max(dome.z, 0.0)));
    let way = 2.0 * dot(eye, facet) * facet - eye;
    if way.z <= 0.0 { return vec4f(0.0); }
    let hidden = 1.0 + casca_shadow(eye.z, rough);
    return vec4f(normalize(way), hidden / (hidden + casca_shadow(way.z, rough)));
}

// The direction of a ray, and what it counts. Of few rays, each is chosen of more directions by
// weight (resampled importance sampling, Talbot et al. 2005): over pixels, even the mean of one is
// the lobe's. Of many rays each has one direction, as choices would spread them less evenly.
fn casca_chosen(ray: u32, eye: vec3f, rough: f32, key: u32) -> vec4f {
    var chosen = vec4f(0.0);
    var chance = casca_golden(ray, casca_unit(key, 2u));
    for (var i = 0u; i < gloss.tries; i++) {
        let lobe = casca_lobe(ray * gloss.tries + i, eye, rough, key);
        if lobe.w <= 0.0 { continue; }
        let sum = chosen.w + lobe.w;
        let share = lobe.w / sum;
        // What is left of a chance is as even as the whole of it.
        if chance < share {
            chosen = vec4f(lobe.xyz, sum);
            chance /= share;
        } else {
            chosen.w = sum;
            chance = (chance - share) / (1.0 - share);
        }
    }
    return chosen;
}

// What some of a pixel's rays bring: the sum of light and of weights, and the weights of rays that
// hit what no state stands for.
struct CascaPart { light: vec4f, unknown: f32 }

fn casca_mirrored(point: vec3f, normal: vec3f, eye: vec3f, rough: f32, lane: u32) -> CascaPart {
    var part = CascaPart(vec4f(0.0), 0.0);
    let spot = (point - casca_grid.low) / casca_grid.cell + normal * LIFT;
    let height = dot(eye, normal);
    // From farther away than half of FAR, the way to the grid may be longer than FAR.
    if !all(abs(spot) < vec3f(0.5 * FAR)) || height <= 0.0 { return part; }
    let key = casca_key(point);
    let right = casca_across(normal);
    let up = cross(normal, right);
    let local = vec3f(dot(eye, right), dot(eye, up), height);
    let is_sharp = rough < LEAST_ROUGH;
    let rays = select(gloss.rays, 1u, is_sharp);
    for (var i = lane; i < rays; i += gloss.lanes) {
        var way = vec4f(2.0 * height * normal - eye, 1.0);
        if !is_sharp {
            let chosen = casca_chosen(i, local, rough, key);
            way = vec4f(right * chosen.x + up * chosen.y + normal * chosen.z, chosen.w);
        }
        if way.w <= 0.0 { continue; }
        let found = casca_along(spot, normalize(way.xyz), 1.0);
        part.light += way.w * vec4f(found.rgb, 1.0);
        part.unknown += way.w * (1.0 - found.w);
    }
    return part;
}

// The exponent of a number, 0 for what may be rounded to 0 and 255 for what is not finite: shaders
// may take it for granted that comparisons meet no NaN.
fn exponent(x: f32) -> u32 {
    return (bitcast<u32>(x) >> 23u) & 255u;
}

// A unit vector, whatever the length; 0 if there is none.
fn unit_of(v: vec3f) -> vec3f {
    let most = max(exponent(v.x), max(exponent(v.y), exponent(v.z)));
    if most == 0u || most == 255u { return vec3f(0.0); }
    // By a power of two, so that squares are neither rounded to 0 nor infinite.
    return normalize(v * bitcast<f32>(max(254u - most, 1u) << 23u));
}

// By thread.
var<workgroup> parts: array<CascaPart, 64>;

// The mean radiance of the lobe; in the last component 1, less half of the share of its rays that
// hit what no state stands for; 0 if no ray was sent.
@compute @workgroup_size(64)
fn mirrors(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) index: u32) {
    let lane = index % gloss.lanes;
    let id = casca_pixel(group.xy, index);
    let is_in = all(id < textureDimensions(picture));
    var part = CascaPart(vec4f(0.0), 0.0);
    if is_in {
        let rough = textureLoad(roughness, id, 0).x;
        if exponent(rough) < 255u && rough >= 0.0 {
            let position = textureLoad(place, id, 0);
            let normal = unit_of(textureLoad(normals, id, 0).xyz);
            let eye = unit_of(gloss.eye - position.xyz);
            if position.w >= 1.0 && any(normal != vec3f(0.0)) && any(eye != vec3f(0.0)) {
                part = casca_mirrored(position.xyz, normal, eye, min(rough, 1.0), lane);
            }
        }
    }
    parts[index] = part;
    workgroupBarrier();
    if !is_in || lane != 0u { return; }
    for (var i = 1u; i < gloss.lanes; i++) {
        part.light += parts[index + i].light;
        part.unknown += parts[index + i].unknown;
    }
    var mean = vec4f(0.0);
    if part.light.w > 0.0 { mean = vec4f(part.light.rgb / part.light.w, 1.0 - 0.5 * part.unknown / part.light.w); }
    textureStore(picture, id, mean);
}
