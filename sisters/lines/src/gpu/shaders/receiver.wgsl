// The receiver of an occlusion: its settings, its samples and its hemisphere. Lengths are in units of the radius.

struct Ao {
    radius: f32,
    // The factor, k or line radius.
    value: f32,
    step: f32,
    // As the enum `Estimator`.
    estimator: u32,
    // 1: by distance, 2: by angle, 4: the thesis' sign.
    flags: u32,
    // As the enum `SetChoice`.
    choice: u32,
    sets: u32,
    samples: u32,
    // The size of the picture.
    size: vec2u,
    // Where the tangents of places begin in their buffer.
    tangents: u32,
    padding: u32,
}

@group(0) @binding(12) var<storage, read> fragments: array<Fragment>;
// Places in the disc, areas and the numbers of sectors.
@group(0) @binding(15) var<storage, read> samples: array<vec4f>;
@group(0) @binding(16) var<uniform> ao: Ao;
@group(0) @binding(17) var<storage, read_write> occlusion: array<f32>;

// As `numeric::hash` of casca-lines.
fn permuted(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn hash(a: u32, b: u32) -> u32 {
    return permuted(a ^ permuted(b));
}

fn set_of(fragment: Fragment, pixel: vec2u) -> u32 {
    switch ao.choice {
        case 0u: { return 0u; }
        case 1u: { return hash(pixel.x, pixel.y) % ao.sets; }
        default: { return hash(fragment.line, u32(clamp(fragment.along / ao.step, 0.0, 4294967040.0))) % ao.sets; }
    }
}

struct Hemisphere {
    middle: vec3f,
    pole: vec3f,
    across: vec3f,
    upwards: vec3f,
}

fn hemisphere(fragment: Fragment) -> Hemisphere {
    let away = away_at(fragment.position);
    let flat = vec3f(1.0, 0.0, 0.0) - away * away.x;
    let long = length(flat);
    let across = select(vec3f(0.0, 1.0, 0.0), flat / max(long, 1e-30), long > 1e-30);
    return Hemisphere(fragment.position / ao.radius, pole_of(fragment.tangent, away), across, cross(across, away));
}

