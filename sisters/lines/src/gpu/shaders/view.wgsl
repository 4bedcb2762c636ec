// A view in single precision: sisters/lines/src/view.rs has the double one. All shaders begin with this part.

struct Lens {
    // Rows of the rotation into eye space.
    right: vec3f,
    scale: f32,
    up: vec3f,
    near: f32,
    back: vec3f,
    far: f32,
    // The origin of eye space in the world; `rest` holds the digits that do not fit.
    origin: vec3f,
    perspective: u32,
    rest: vec3f,
    // Half the thickness of lines in pixels; 0 where a line shows in all pixels that it crosses.
    thick: f32,
    middle: vec2f,
    size: vec2u,
}

@group(0) @binding(0) var<uniform> lens: Lens;

struct Fragment {
    position: vec3f,
    // The number of the line; NONE where there is none.
    line: u32,
    tangent: vec3f,
    along: f32,
}

const NONE: u32 = 0xffffffffu;

fn to_eye(world: vec3f) -> vec3f {
    let offset = (world - lens.origin) - lens.rest;
    return vec3f(dot(lens.right, offset), dot(lens.up, offset), dot(lens.back, offset));
}

// Homogeneous pixel coordinates.
fn project(eye: vec3f) -> vec3f {
    let w = select(1.0, -eye.z, lens.perspective == 1u);
    return vec3f(lens.middle.x * w + lens.scale * eye.x, lens.middle.y * w - lens.scale * eye.y, w);
}

// The length of a vector in any unit: squares of small and of large coordinates do not fit into single precision.
fn long_of(v: vec3f) -> f32 {
    let most = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return select(0.0, most * length(v / most), most > 0.0);
}

// The direction away from the viewer.
fn away_at(eye: vec3f) -> vec3f {
    let distance = long_of(eye);
    if lens.perspective == 0u || !(distance > 0.0) || eye.z > 0.0 {
        return vec3f(0.0, 0.0, -1.0);
    }
    return eye / distance;
}

// The direction that is normal to a tangent and turned most to the viewer; without one, that to the viewer.
fn pole_of(tangent: vec3f, away: vec3f) -> vec3f {
    let pole = tangent * dot(tangent, away) - away;
    let long = length(pole);
    return select(-away, pole / max(long, ALONG_VIEW), long > ALONG_VIEW);
}

fn pixel_size(depth: f32) -> f32 {
    return select(1.0, depth, lens.perspective == 1u) / lens.scale;
}

// The number of a pixel in buffers.
fn pixel_number(at: vec2u) -> u32 {
    return at.y * lens.size.x + at.x;
}

// An order of depths as whole numbers, the nearest greatest.
fn key_of(depth: f32) -> u32 {
    let b = bitcast<u32>(depth);
    return select(~(b | 0x80000000u), b, (b & 0x80000000u) != 0u);
}
