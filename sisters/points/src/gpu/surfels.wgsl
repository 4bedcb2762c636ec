// Surface splatting in three passes: depths of the nearest surface, sums of colours near it, and their means.

struct Lens {
    view_projection: mat4x4f,
    eye: vec3f,
    // How far the depth of the surface is moved away from the eye.
    offset: f32,
    forward: vec3f,
    near: f32,
    // Towards the light.
    light: vec3f,
    // The share of light that comes from everywhere; 1 without lighting.
    ambient: f32,
    // The least radius, at the depth 1.
    least: f32,
    // What radii are multiplied by.
    scale: f32,
}

@group(0) @binding(0) var<uniform> lens: Lens;
@group(0) @binding(1) var sums: texture_2d<f32>;

struct Corner {
    @builtin(position) clip: vec4f,
    // From -1 to 1 in the square around the disc.
    @location(0) at: vec2f,
    @location(1) colour: vec3f,
}

// The weight of a disc is e^-FALL at its rim.
const FALL: f32 = 4.0;

struct Surfel {
    @builtin(vertex_index) vertex: u32,
    @location(0) position: vec3f,
    @location(1) radius: f32,
    @location(2) normal: vec3f,
    @location(3) colour: vec4f,
}

fn placed(surfel: Surfel) -> Corner {
    let to_eye = lens.eye - surfel.position;
    let depth = -dot(lens.forward, to_eye);
    let facing = dot(surfel.normal, to_eye);
    let has_normal = any(surfel.normal != vec3f(0.0));
    // Back faces, and discs nearer than the near plane, are moved out of the picture.
    if depth < lens.near || (has_normal && facing <= 0.0) {
        return Corner(vec4f(2.0, 2.0, 2.0, 1.0), vec2f(0.0), vec3f(0.0));
    }
    let axis = normalize(select(to_eye, surfel.normal, has_normal));
    let other = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(axis.y) > 0.7);
    let u = normalize(cross(axis, other));
    let at = vec2f(f32(surfel.vertex & 1u), f32(surfel.vertex >> 1u)) * 2.0 - 1.0;
    let size = max(surfel.radius * lens.scale, lens.least * depth);
    let place = surfel.position + (u * at.x + cross(axis, u) * at.y) * size;
    let bright = select(1.0, mix(max(dot(axis, lens.light), 0.0), 1.0, lens.ambient), has_normal);
    var found = Corner(lens.view_projection * vec4f(place, 1.0), at, surfel.colour.rgb * bright);
    // 1 at the near plane, 0 at infinity.
    found.clip.z = lens.near;
    return found;
}

@vertex
fn corner(surfel: Surfel) -> Corner {
    return placed(surfel);
}

// The surface, moved backwards, so that the discs of one surface do not hide one another.
@vertex
fn corner_behind(surfel: Surfel) -> Corner {
    var found = placed(surfel);
    // The depth is near / w: this one belongs to w + offset.
    found.clip.z = found.clip.z * found.clip.w / (found.clip.w + lens.offset);
    return found;
}

@fragment
fn surface(in: Corner) {
    if dot(in.at, in.at) > 1.0 { discard; }
}

@fragment
fn weighted(in: Corner) -> @location(0) vec4f {
    let distance = dot(in.at, in.at);
    if distance > 1.0 { discard; }
    return vec4f(in.colour, 1.0) * exp(-FALL * distance);
}

@vertex
fn everywhere(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn mean(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let sum = textureLoad(sums, vec2i(at.xy), 0);
    if sum.a == 0.0 { discard; }
    return vec4f(sum.rgb / sum.a, 1.0);
}
