// Which chunks of segments lie behind nearer lines or context in every pixel that they may touch: those need not be drawn.

@group(0) @binding(1) var<uniform> which: u32;
@group(0) @binding(5) var<storage, read> chunks: array<vec2u>;
// As in raster.wgsl.
@group(0) @binding(8) var<storage, read> nearest: array<u32>;
@group(0) @binding(10) var surfaces: texture_2d<f32>;
// The least and the greatest corner of each chunk.
@group(0) @binding(40) var<storage, read> corners: array<vec4f>;
// Whether a chunk was seen in the last frame.
@group(0) @binding(41) var<storage, read> shown: array<u32>;
// Chunks to draw.
@group(0) @binding(42) var<storage, read_write> list: array<vec2u>;
// For each of the two lists its chunks and its segments.
@group(0) @binding(43) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(44) var<storage, read_write> groups: array<u32>;
// The keys of the farthest depth in tiles of pixels, and in tiles of these.
@group(0) @binding(45) var<storage, read_write> tiles: array<u32>;

const SIDE: u32 = 8u;
const ROW: u32 = 32768u;
// More tiles of tiles than this are not looked at.
const MOST: u32 = 64u;

var<workgroup> farthest: atomic<u32>;

fn append(chunk: vec2u) {
    let at = atomicAdd(&counts[2u * which], 1u);
    atomicAdd(&counts[2u * which + 1u], chunk.y);
    list[at] = chunk;
}

fn number_of(group: vec3u, among: vec3u, local: u32) -> u32 {
    return (group.y * among.x + group.x) * 64u + local;
}

// Chunks that were seen in the last frame are drawn first.
@compute @workgroup_size(64)
fn divide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) all_groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = number_of(group, all_groups, local);
    if number >= arrayLength(&chunks) { return; }
    let chunk = chunks[number];
    if chunk.y != 0u && shown[chunk.x / CHUNK] != 0u { append(chunk); }
}

// The workgroups of a list.
@compute @workgroup_size(1)
fn count() {
    let all = atomicLoad(&counts[2u * which]);
    groups[0] = min(all, ROW);
    groups[1] = (all + ROW - 1u) / ROW;
    groups[2] = 1u;
}

fn tiles_of(size: vec2u) -> vec2u {
    return (size + SIDE - 1u) / SIDE;
}

// A line must be nearer than this to be seen: the key of the nearest line so far, or of context.
fn cover(at: vec2u) -> u32 {
    return max(nearest[pixel_number(at)], key_of(textureLoad(surfaces, at, 0).x));
}

fn gather(inside: bool, key: u32, local: u32, place: u32) {
    if local == 0u { atomicStore(&farthest, NONE); }
    workgroupBarrier();
    if inside { atomicMin(&farthest, key); }
    workgroupBarrier();
    if local == 0u { tiles[place] = atomicLoad(&farthest); }
}

@compute @workgroup_size(8, 8)
fn of_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) local: u32) {
    let inside = all(id.xy < lens.size);
    gather(inside, cover(min(id.xy, lens.size - 1u)), local, tile.y * tiles_of(lens.size).x + tile.x);
}

@compute @workgroup_size(8, 8)
fn of_tiles(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) local: u32) {
    let size = tiles_of(lens.size);
    let at = min(id.xy, size - 1u);
    let key = tiles[at.y * size.x + at.x];
    gather(all(id.xy < size), key, local, size.x * size.y + tile.y * tiles_of(size).x + tile.x);
}

struct Outline {
    low: vec2f,
    high: vec2f,
    near: f32,
    // False where rounding or the eye forbid a bound.
    known: bool,
}

// The pixels that the lines of a chunk may touch, and a depth that all of them are beyond.
fn outline(chunk: u32) -> Outline {
    var found = Outline(vec2f(3e38), vec2f(-3e38), 3e38, true);
    var far_off = vec3f(0.0);
    for (var i = 0u; i < 8u; i++) {
        let pick = vec3<bool>((i & 1u) != 0u, (i & 2u) != 0u, (i & 4u) != 0u);
        let corner = select(corners[2u * chunk].xyz, corners[2u * chunk + 1u].xyz, pick);
        far_off = max(far_off, abs((corner - lens.origin) - lens.rest));
        let eye = to_eye(corner);
        let p = project(eye);
        found.near = min(found.near, -eye.z);
        found.known = found.known && -eye.z > lens.near;
        found.low = min(found.low, p.xy / p.z);
        found.high = max(found.high, p.xy / p.z);
    }
    let off = HIDDEN_ROUNDING * (far_off.x + far_off.y + far_off.z);
    let off_middle = max(abs(found.low - lens.middle), abs(found.high - lens.middle));
    let beside = max(off_middle.x, off_middle.y);
    let per_unit = select(lens.scale, (lens.scale + beside) / found.near, lens.perspective == 1u);
    let room = HIDDEN_ROOM + lens.thick + off * per_unit;
    found.low -= room;
    found.high += room;
    found.near -= off;
    // Comparisons with what is not a number are false.
    found.known = found.known && beside < FARTHEST_PIXEL && room < FARTHEST_PIXEL && found.near > lens.near;
    return found;
}

// Whether a pixel of a rectangle may show something at a key or a nearer one. All bounds are inclusive.
fn may_show(low: vec2u, high: vec2u, key: u32) -> bool {
    let size = tiles_of(lens.size);
    let above = size.x * size.y;
    let many = SIDE * SIDE;
    let spans = high / many - low / many + 1u;
    if spans.x * spans.y > MOST { return true; }
    for (var v = low.y / many; v <= high.y / many; v++) {
        for (var u = low.x / many; u <= high.x / many; u++) {
            if tiles[above + v * tiles_of(size).x + u] > key { continue; }
            let first = max(vec2u(u, v) * many, low) / SIDE;
            let last = min(vec2u(u, v) * many + many - 1u, high) / SIDE;
            for (var j = first.y; j <= last.y; j++) {
                for (var i = first.x; i <= last.x; i++) {
                    if tiles[j * size.x + i] > key { continue; }
                    let start = max(vec2u(i, j) * SIDE, low);
                    let end = min(vec2u(i, j) * SIDE + SIDE - 1u, high);
                    for (var y = start.y; y <= end.y; y++) {
                        for (var x = start.x; x <= end.x; x++) {
                            if cover(vec2u(x, y)) <= key { return true; }
                        }
                    }
                }
            }
        }
    }
    return false;
}

// Chunks that were not seen in the last frame are drawn where a pixel may show them.
@compute @workgroup_size(64)
fn examine(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) all_groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = number_of(group, all_groups, local);
    if number >= arrayLength(&chunks) { return; }
    let chunk = chunks[number];
    if chunk.y == 0u || shown[chunk.x / CHUNK] != 0u { return; }
    let found = outline(chunk.x / CHUNK);
    if found.known {
        let most = vec2f(lens.size) - 1.0;
        if any(found.high < vec2f(0.0)) || any(found.low > most + 1.0) { return; }
        let low = vec2u(clamp(found.low, vec2f(0.0), most));
        let high = vec2u(clamp(found.high, vec2f(0.0), most));
        if !may_show(low, high, key_of(found.near)) { return; }
    }
    append(chunk);
}
