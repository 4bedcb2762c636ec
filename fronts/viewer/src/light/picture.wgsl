// Pictures: the surface in each pixel, then its light, then colours.

// With the roughness beside the albedo, and the number of its texture plus 1, or 0, beside the emission.
struct Material { albedo: vec4f, emission: vec4f, specular: vec4f }
@group(0) @binding(1) var<storage, read> materials: array<Material>;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) a: vec3f,
    @location(1) @interpolate(flat) b: vec3f,
    @location(2) @interpolate(flat) c: vec3f,
    @location(3) @interpolate(flat) normal: vec3f,
    @location(4) @interpolate(flat) material: u32,
    // Where the corners lie in the texture of the material.
    @location(5) @interpolate(flat) u: vec2f,
    @location(6) @interpolate(flat) v: vec2f,
    @location(7) @interpolate(flat) w: vec2f,
}

@vertex
fn corner(
    @builtin(vertex_index) index: u32,
    @location(0) a: vec3f,
    @location(1) b: vec3f,
    @location(2) c: vec3f,
    @location(3) normal: vec3f,
    @location(4) material: u32,
    @location(5) u: vec2f,
    @location(6) v: vec2f,
    @location(7) w: vec2f,
) -> Corner {
    var corners = array<vec3f, 3>(a, b, c);
    return Corner(eye.to_clip * vec4f(corners[index % 3u], 1.0), a, b, c, normal, material, u, v, w);
}

// By texture where its texels start and its size; then the texels.
@group(0) @binding(9) var<storage, read> texels: array<u32>;

// The texel of a texture at a place: roots of linear light, and 0 for holes.
fn texel_at(texture: u32, place: vec2f) -> vec4f {
    let size = vec2u(texels[3u * texture + 1u], texels[3u * texture + 2u]);
    let at = min(vec2u(fract(place) * vec2f(size)), size - 1u);
    return unpack4x8unorm(texels[texels[3u * texture] + at.y * size.x + at.x]);
}

// The shares of the corners where a ray meets the plane of a triangle (Moeller and Trumbore 1997).
fn shares_of(corner: Corner, ray: vec3f) -> vec3f {
    let first = corner.b - corner.a;
    let second = corner.c - corner.a;
    let p = cross(ray, second);
    let way = eye.position - corner.a;
    let q = cross(way, first);
    let parts = vec2f(dot(way, p), dot(ray, q)) / dot(first, p);
    return vec3f(1.0 - parts.x - parts.y, parts);
}

// The mean colour of a texture over a pixel. The shares of the corners are those in its middle.
fn painted(corner: Corner, ray: vec3f, shares: vec3f, texture: u32) -> vec3f {
    let uv = mat3x2f(corner.u, corner.v, corner.w);
    let middle = uv * shares;
    let right = uv * shares_of(corner, ray + eye.right) - middle;
    let down = uv * shares_of(corner, ray + eye.down) - middle;
    var sum = vec4f(0.0);
    for (var i = 0u; i < TEXELS * TEXELS; i++) {
        let off = (vec2f(vec2u(i % TEXELS, i / TEXELS)) + 0.5) / f32(TEXELS) - 0.5;
        let found = texel_at(texture, middle + right * off.x + down * off.y);
        sum += vec4f(found.rgb * found.rgb, 1.0) * found.w;
    }
    return sum.rgb / max(sum.w, 1.0);
}

// A number from 0 to 2^23 - 1 for a colour: what a float of 1 and more holds exactly. Roots are finer
// where it is dark.
fn bits_of(colour: vec3f) -> f32 {
    let parts = round(sqrt(colour) * vec3f(255.0, 255.0, 127.0));
    return parts.r + 256.0 * parts.g + 65536.0 * parts.b;
}

fn colour_of(number: f32) -> vec3f {
    let bits = u32(number);
    let parts = vec3f(vec3u(bits & 255u, (bits >> 8u) & 255u, bits >> 16u)) / vec3f(255.0, 255.0, 127.0);
    return parts * parts;
}

// The place with 1 and the packed colour of the texture. The last: how rough it is, less than 0 if it
// mirrors nothing, and its material.
struct Surface {
    @location(0) place: vec4f,
    @location(1) normal: vec4f,
    @location(2) kind: vec2f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn surface(corner: Corner) -> Surface {
    // Devices move corners to parts of pixels, so that the middle of one may lie outside of the
    // triangle, and behind another wall. Its ray tells.
    let ray = eye.corner + eye.right * corner.clip.x + eye.down * corner.clip.y;
    let shares = shares_of(corner, ray);
    let material = materials[corner.material];
    var colour = vec3f(1.0);
    if material.emission.w > 0.0 {
        let texture = u32(material.emission.w) - 1u;
        if texel_at(texture, mat3x2f(corner.u, corner.v, corner.w) * shares).w == 0.0 { discard; }
        colour = painted(corner, ray, shares, texture);
    }
    var inside = clamp(shares, vec3f(0.0), vec3f(1.0));
    inside /= max(inside.x + inside.y + inside.z, 0.5);
    let mixed = corner.a * inside.x + corner.b * inside.y + corner.c * inside.z;
    // Sums lie off the plane by more than rays start above it.
    let flat = mixed + corner.normal * dot(corner.normal, corner.a - mixed);
    // In edges of rooms that is in two walls; the eye sees the fronts of both.
    let at = flat + PULL * (eye.position - flat);
    // Surfaces look alike from both sides.
    let is_behind = dot(corner.normal, eye.position - flat) < 0.0;
    let normal = corner.normal * select(1.0, -1.0, is_behind);
    let roughness = material.albedo.w;
    // Where the near and the far side of a box end in one pixel, the near one is seen.
    let far = max((eye.to_clip * vec4f(flat, 1.0)).w, 0.0);
    let depth = far / (far + eye.reach) + select(0.0, BEHIND, is_behind);
    return Surface(vec4f(at, 1.0 + bits_of(colour)), vec4f(normal, 0.0), vec2f(roughness, f32(corner.material)), depth);
}

@group(0) @binding(2) var kinds: texture_2d<f32>;
@group(0) @binding(3) var places: texture_2d<f32>;
// Irradiance of all light that the layer shows; for the direct layer also that of the rest.
@group(0) @binding(4) var lit: texture_2d<f32>;
@group(0) @binding(5) var rest: texture_2d<f32>;
@group(0) @binding(6) var mirrored: texture_2d<f32>;
@group(0) @binding(7) var normals: texture_2d<f32>;
@group(0) @binding(8) var light: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn compose(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(light)) { return; }
    textureStore(light, id.xy, light_of(id.xy));
}

fn light_of(pixel: vec2u) -> vec4f {
    let place = textureLoad(places, pixel, 0);
    if place.w < 1.0 { return vec4f(eye.sky, 0.0); }
    let material = materials[u32(textureLoad(kinds, pixel, 0).y)];
    let albedo = material.albedo.rgb * colour_of(place.w - 1.0);
    if eye.layer == ALBEDO { return vec4f(albedo + material.specular.rgb, 1.0); }
    if eye.layer == NORMALS { return vec4f(0.5 * normalize(textureLoad(normals, pixel, 0).xyz) + 0.5, 1.0); }
    var found = vec3f(0.0);
    if eye.layer == PICTURE || eye.layer == MIRRORED {
        found += material.specular.rgb * textureLoad(mirrored, pixel, 0).rgb;
    }
    if eye.layer == MIRRORED { return vec4f(found, 1.0); }
    if eye.layer != INDIRECT { found += material.emission.rgb; }
    var irradiance = textureLoad(lit, pixel, 0).rgb;
    if eye.layer == DIRECT { irradiance -= textureLoad(rest, pixel, 0).rgb; }
    return vec4f(found + albedo / PI * max(irradiance, vec3f(0.0)), 1.0);
}
