// The splat operator, with the arithmetic of the processor's version: sisters/points/src/camera.rs, numeric.rs and splat/.
//
// Depths are kept as the bits of infinity minus their own bits, which are in the order of floats: the minimum of depths is the maximum of
// these, and a cleared buffer is infinitely far.

struct Lens {
    eye: vec3f,
    near: f32,
    // Right and down are as long as there are pixels in a tangent of 1.
    right: vec3f,
    far: f32,
    down: vec3f,
    // Pixels of a radius at the depth 1; with a radius for each point, of a radius of 1.
    scale: f32,
    forward: vec3f,
    // Always 0. Compilers do not know that.
    zero: u32,
    centre: vec2f,
    size: vec2i,
    // Bias: a length, or (1 - part) and part / far.
    bias: vec3f,
    // 1 if the bias is a part.
    window: u32,
    // As the enum `Filter`.
    filtering: u32,
    // 1 if there is a radius for each point.
    each: u32,
    // 1 if surfaces may slant.
    slopes: u32,
    // Where each level begins in `far_bits`.
    starts: array<vec4u, 3>,
}

@group(0) @binding(0) var<uniform> lens: Lens;
@group(0) @binding(1) var<uniform> level: u32;
@group(0) @binding(2) var<storage, read_write> far_bits: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> limits: array<f32>;
// The number of levels that squares need.
@group(0) @binding(4) var<storage, read_write> levels: atomic<u32>;
@group(0) @binding(5) var<storage, read> points: array<f32>;
@group(0) @binding(6) var<storage, read> radii: array<f32>;
@group(0) @binding(7) var<storage, read_write> visible: array<atomic<u32>>;

const INFINITE: u32 = 0x7f800000u;

// A product as it is. Compilers may fuse a product and a sum into one operation that rounds once; they cannot see through this.
fn product(a: f32, b: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(a * b) ^ lens.zero);
}

fn scalar(a: vec3f, b: vec3f) -> f32 {
    return product(a.x, b.x) + product(a.y, b.y) + product(a.z, b.z);
}

// The quotient of numbers that are not negative, rounded as IEEE 754 asks for: shaders may be off by some of the last digits.
fn quotient(a: f32, b: f32) -> f32 {
    let bits_a = bitcast<u32>(a);
    let bits_b = bitcast<u32>(b);
    let m_a = (bits_a & 0x7fffffu) | 0x800000u;
    let m_b = (bits_b & 0x7fffffu) | 0x800000u;
    if bits_a < 0x800000u || bits_b >= INFINITE {
        return 0.0;
    }
    // a / b is q 2^e with 24 bits of q, which is m_a 2^shift / m_b.
    let shift = select(23u, 24u, m_a < m_b);
    let e = i32(bits_a >> 23u) - i32(bits_b >> 23u) + 150 - i32(shift);
    if e >= 255 || bits_a >= INFINITE || bits_b < 0x800000u {
        return bitcast<f32>(INFINITE);
    }
    if e <= 0 {
        return 0.0;
    }
    var q = u32(f32(m_a) / f32(m_b) * f32(1u << shift));
    // The remainder is small, so that 32 bits are enough of it.
    var rest = bitcast<i32>((m_a << shift) - q * m_b);
    let step = bitcast<i32>(m_b);
    for (var i = 0; i < 16 && rest < 0; i++) {
        q -= 1u;
        rest += step;
    }
    for (var i = 0; i < 16 && rest >= step; i++) {
        q += 1u;
        rest -= step;
    }
    // No quotient lies midway between two floats.
    q += u32(2 * rest > step);
    return bitcast<f32>((u32(e) << 23u) + (q - 0x800000u));
}

// Pixels in units of 1/256. In the sum, whose bits begin with those of 49152, these are the last ones.
fn subpixels(pixels: f32) -> i32 {
    return bitcast<i32>(clamp(pixels, -1.0, 16383.0) + 49152.0) - 0x47400000;
}

struct Place {
    at: vec2i,
    depth: f32,
    seen: bool,
}

fn place(i: u32) -> Place {
    let offset = vec3f(points[3u * i], points[3u * i + 1u], points[3u * i + 2u]) - lens.eye;
    let depth = scalar(lens.forward, offset);
    var found = Place(vec2i(0), depth, false);
    if depth >= lens.near && depth <= lens.far {
        let inverse = quotient(1.0, depth);
        let x = lens.centre.x + product(scalar(lens.right, offset), inverse);
        let y = lens.centre.y + product(scalar(lens.down, offset), inverse);
        found.at = vec2i(subpixels(x), subpixels(y));
        found.seen = all(found.at >= vec2i(0)) && all(found.at < lens.size * 256);
    }
    return found;
}

// Half of a square's side beyond its first pixel.
fn half_side(i: u32, p: Place) -> i32 {
    var scale = lens.scale;
    if lens.each == 1u {
        scale = product(radii[i], scale);
    }
    return subpixels(clamp(quotient(scale, p.depth) - 0.5, 0.0, 512.0));
}

// The pixels that a square covers: the first and the last one.
fn square(i: u32, p: Place) -> vec4i {
    let half = half_side(i, p);
    return vec4i(p.at - half, p.at + half) >> vec4u(8u);
}

// The largest level whose squares are not larger.
fn level_of(covered: vec4i) -> u32 {
    let side = covered.zw - covered.xy + 1;
    return firstLeadingBit(u32(min(side.x, side.y)));
}

fn border(k: u32) -> i32 {
    return select(1i << k, 0, k == 0u);
}

// Where a level has the depth of a square, by the left upper pixel of it; -1 for squares beside the picture.
fn entry(k: u32, at: vec2i) -> i32 {
    let b = border(k);
    if any(at < vec2i(-b)) || any(at >= lens.size) {
        return -1;
    }
    return i32(lens.starts[k / 4u][k % 4u]) + (at.y + b) * (lens.size.x + b) + at.x + b;
}

fn index(group: vec3u, local: u32) -> u32 {
    return group.x * 256u + local;
}

@compute @workgroup_size(256)
fn measure(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = index(group, local);
    if i >= arrayLength(&points) / 3u { return; }
    let p = place(i);
    if p.seen {
        let needed = level_of(square(i, p)) + 1u;
        if atomicLoad(&levels) < needed { atomicMax(&levels, needed); }
    }
}

@compute @workgroup_size(256)
fn draw(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = index(group, local);
    if i >= arrayLength(&points) / 3u { return; }
    let p = place(i);
    if !p.seen { return; }
    let covered = square(i, p);
    let k = level_of(covered);
    let last = covered.zw + 1 - (1i << k);
    let bits = INFINITE - bitcast<u32>(p.depth);
    // A square is the union of four of its level, which overlap.
    for (var corner = 0; corner < 4; corner++) {
        let at = entry(k, select(covered.xy, last, vec2<bool>((corner & 1) == 1, corner > 1)));
        if at >= 0 && atomicLoad(&far_bits[at]) < bits { atomicMax(&far_bits[at], bits); }
    }
}

// Lowers the depths of a level to those of the level above, whose squares consist of four of its own.
@compute @workgroup_size(16, 16)
fn push(@builtin(global_invocation_id) id: vec3u) {
    let at = vec2i(id.xy) - border(level);
    let own = entry(level, at);
    if own < 0 { return; }
    var bits = atomicLoad(&far_bits[own]);
    let half = 1i << level;
    for (var corner = 0; corner < 4; corner++) {
        let above = entry(level + 1u, at - half * vec2i(corner & 1, corner >> 1u));
        bits = max(bits, atomicLoad(&far_bits[above]));
    }
    atomicStore(&far_bits[own], bits);
}

fn filtered(at: vec2i) -> f32 {
    let own = INFINITE - atomicLoad(&far_bits[at.y * lens.size.x + at.x]);
    var least = own;
    var most = own;
    for (var i = 0; i < 9; i++) {
        let near = clamp(at + vec2i(i % 3, i / 3) - 1, vec2i(0), lens.size - 1);
        let other = INFINITE - atomicLoad(&far_bits[near.y * lens.size.x + near.x]);
        least = min(least, other);
        most = max(most, other);
    }
    let is_at_background = most == INFINITE;
    var bits = own;
    if lens.filtering == 2u || (lens.filtering == 1u && !is_at_background) { bits = most; }
    if lens.filtering == 3u && !is_at_background { bits = least; }
    return bitcast<f32>(bits);
}

@compute @workgroup_size(16, 16)
fn limit(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2i(id.xy) >= lens.size) { return; }
    let depth = filtered(vec2i(id.xy));
    var bound = depth + lens.bias.x;
    if lens.window == 1u && bitcast<u32>(depth) < INFINITE {
        bound = quotient(1.0, quotient(lens.bias.y, depth) + lens.bias.z);
    }
    limits[id.y * u32(lens.size.x) + id.x] = max(bound, depth);
}

fn is_inside(at: vec2i) -> bool {
    return all(at >= vec2i(0)) && all(at < lens.size);
}

fn inverse_limit(at: vec2i) -> f32 {
    return quotient(1.0, limits[at.y * lens.size.x + at.x]);
}

// How much inverse depths rise around a pixel, by the lesser slope of its two sides.
fn rise(own: f32, at: vec2i, step: vec2i) -> f32 {
    var to = 0.0;
    var ahead = 0.0;
    let has_before = is_inside(at - step);
    let has_after = is_inside(at + step);
    if has_before { to = own - inverse_limit(at - step); }
    if has_after { ahead = inverse_limit(at + step) - own; }
    if has_before && has_after {
        return select(0.0, min(abs(to), abs(ahead)), (to > 0.0) == (ahead > 0.0));
    }
    return abs(select(ahead, to, has_before));
}

// As `DepthImage::slanted` of the processor, where the reasons are.
fn slanted(at: vec2i, half: i32) -> f32 {
    let step = 2 * half / 256 + 1;
    let own = inverse_limit(at);
    let both = rise(own, at, vec2i(step, 0)) + rise(own, at, vec2i(0, step));
    return own - product(quotient(f32(half + 128), f32(step * 256)), both);
}

@compute @workgroup_size(256)
fn test(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let i = index(group, local);
    if i >= arrayLength(&points) / 3u { return; }
    let p = place(i);
    if !p.seen { return; }
    let pixel = p.at >> vec2u(8u);
    var seen = p.depth <= limits[pixel.y * lens.size.x + pixel.x];
    if !seen && lens.slopes == 1u {
        seen = quotient(1.0, p.depth) >= slanted(pixel, half_side(i, p));
    }
    if seen {
        atomicOr(&visible[i / 32u], 1u << (i % 32u));
    }
}
