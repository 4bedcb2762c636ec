// The nearest line in each pixel. The walk is that of sisters/lines/src/walk.rs, in single precision.

@group(0) @binding(1) var<uniform> choosing: u32;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> segments: array<vec2u>;
@group(0) @binding(4) var<storage, read> order: array<u32>;
// The first segment of a chunk in `order`, and their number.
@group(0) @binding(5) var<storage, read> chunks: array<vec2u>;
// The greatest inverted depth, and the greatest inverted number of a segment at it: 0 is nothing.
@group(0) @binding(8) var<storage, read_write> nearest: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> owners: array<atomic<u32>>;
// The depth of the context in each pixel.
@group(0) @binding(10) var surfaces: texture_2d<f32>;
@group(0) @binding(11) var<storage, read> tangents: array<vec4f>;
@group(0) @binding(12) var<storage, read_write> fragments: array<Fragment>;

const FAR_AWAY: f32 = 3e38;
const DOT: u32 = 0x80000000u;

struct Walk {
    a: vec3f,
    b: vec3f,
    pa: vec3f,
    pb: vec3f,
    at: vec2i,
    last: vec2i,
    step: vec2i,
    begin: f32,
    to: f32,
    end: f32,
    alive: bool,
}

fn ends_of(segment: u32) -> vec2u {
    let first = segments[segment].x;
    return vec2u(first & ~DOT, (first & ~DOT) + select(1u, 0u, (first & DOT) != 0u));
}

// The part in the depths and in a rectangle of the picture; the second is less than the first if there is none.
fn clip(a: vec3f, b: vec3f, pa: vec3f, pb: vec3f, low: vec2f, high: vec2f) -> vec2f {
    var at_a = array<f32, 6>(-a.z - lens.near, lens.far + a.z, pa.x - low.x * pa.z, high.x * pa.z - pa.x,
        pa.y - low.y * pa.z, high.y * pa.z - pa.y);
    var at_b = array<f32, 6>(-b.z - lens.near, lens.far + b.z, pb.x - low.x * pb.z, high.x * pb.z - pb.x,
        pb.y - low.y * pb.z, high.y * pb.z - pb.y);
    var part = vec2f(0.0, 1.0);
    for (var i = 0; i < 6; i++) {
        let ends = vec2f(at_a[i], at_b[i]);
        if ends.x < 0.0 && ends.y < 0.0 {
            return vec2f(1.0, 0.0);
        }
        let crossing = ends.x / (ends.x - ends.y);
        if ends.x < 0.0 {
            part.x = max(part.x, crossing);
        } else if ends.y < 0.0 {
            part.y = min(part.y, crossing);
        }
    }
    return part;
}

// The share of the way at which the border of a column is crossed.
fn crossing(at: i32, step: i32, last: i32, a: vec2f, b: vec2f) -> f32 {
    if at == last {
        return FAR_AWAY;
    }
    let border = f32(at + max(step, 0));
    let start = a.x - border * a.y;
    return start / (start - (b.x - border * b.y));
}

// The end of the part in the column.
fn measure(walk: ptr<function, Walk>) -> vec2f {
    let w = *walk;
    let over = vec2f(crossing(w.at.x, w.step.x, w.last.x, w.pa.xz, w.pb.xz), crossing(w.at.y, w.step.y, w.last.y, w.pa.yz, w.pb.yz));
    (*walk).to = select(clamp(min(over.x, over.y), w.begin, w.end), w.end, all(w.at == w.last));
    return over;
}

fn start(segment: u32) -> Walk {
    let ends = ends_of(segment);
    var w: Walk;
    w.a = to_eye(vertices[ends.x].xyz);
    w.b = to_eye(vertices[ends.y].xyz);
    w.pa = project(w.a);
    w.pb = project(w.b);
    let size = vec2f(lens.size);
    let part = clip(w.a, w.b, w.pa, w.pb, vec2f(0.0), size);
    w.alive = part.x <= part.y;
    w.begin = part.x;
    w.end = part.y;
    let first = mix(w.pa, w.pb, part.x);
    let last = mix(w.pa, w.pb, part.y);
    w.at = vec2i(clamp(first.xy / first.z, vec2f(0.0), size - 1.0));
    w.last = vec2i(clamp(last.xy / last.z, vec2f(0.0), size - 1.0));
    w.step = sign(w.last - w.at);
    return w;
}

// To the next column. Each step leads nearer to the last one, so that walks end.
fn advance(walk: ptr<function, Walk>, over: vec2f) {
    let w = *walk;
    (*walk).alive = any(w.at != w.last);
    (*walk).begin = w.to;
    if w.at.y == w.last.y || (w.at.x != w.last.x && over.x <= over.y) {
        (*walk).at.x += w.step.x;
    } else {
        (*walk).at.y += w.step.y;
    }
}

// The segment of an invocation, or NONE.
fn segment_of(group: vec3u, groups: vec3u, local: u32) -> u32 {
    let number = group.y * groups.x + group.x;
    if number >= arrayLength(&chunks) || local >= chunks[number].y {
        return NONE;
    }
    return order[chunks[number].x + local];
}

// Runs twice: depths first, then the segments at them. One entry serves both, so that both round alike.
@compute @workgroup_size(64)
fn draw(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let segment = segment_of(group, groups, local);
    if segment == NONE { return; }
    var w = start(segment);
    while w.alive {
        let over = measure(&w);
        let pixel = pixel_number(vec2u(w.at));
        let depth = -mix(w.a.z, w.b.z, (w.begin + w.to) * 0.5);
        if depth <= textureLoad(surfaces, w.at, 0).x { choose(pixel, depth, segment); }
        advance(&w, over);
    }
}

// Enters a depth in the first run, and a segment that is at the nearest one in the second.
fn choose(pixel: u32, depth: f32, segment: u32) {
    let key = key_of(depth);
    if choosing == 0u {
        atomicMax(&nearest[pixel], key);
    } else if atomicLoad(&nearest[pixel]) == key {
        atomicMax(&owners[pixel], ~segment);
    }
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= lens.size) { return; }
    let pixel = pixel_number(id.xy);
    let owner = atomicLoad(&owners[pixel]);
    var found: Fragment;
    found.line = NONE;
    if owner != 0u {
        let segment = ~owner;
        let ends = ends_of(segment);
        let a = to_eye(vertices[ends.x].xyz);
        let b = to_eye(vertices[ends.y].xyz);
        let pa = project(a);
        let pb = project(b);
        let corner = vec2f(id.xy);
        var part = clip(a, b, pa, pb, corner, corner + 1.0);
        if part.x > part.y {
            // Rounding put the pixel into the walk.
            part = clip(a, b, pa, pb, corner - IN_DOUBT, corner + 1.0 + IN_DOUBT);
        }
        found = fragment_of(segment, a, b, clamp((part.x + part.y) * 0.5, 0.0, 1.0));
    }
    fragments[pixel] = found;
}

// The fragment at a share of a segment, whose ends are at `a` and `b` in eye space.
fn fragment_of(segment: u32, a: vec3f, b: vec3f, t: f32) -> Fragment {
    let ends = ends_of(segment);
    let tangent = mix(tangents[ends.x].xyz, tangents[ends.y].xyz, t);
    let turned = vec3f(dot(lens.right, tangent), dot(lens.up, tangent), dot(lens.back, tangent));
    let long = length(turned);
    var found: Fragment;
    found.position = mix(a, b, t);
    found.line = segments[segment].y;
    found.tangent = select(vec3f(0.0), turned / max(long, LEAST_LENGTH), long > LEAST_LENGTH);
    found.along = mix(vertices[ends.x].w, vertices[ends.y].w, t);
    return found;
}
