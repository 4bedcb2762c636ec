// The occlusion by rays through cells: sisters/lines/src/occlusion/rays.rs has the same on the processor. Lengths are in units of the radius.

struct Ao {
    radius: f32,
    // The radius of a tube.
    tube: f32,
    sets: u32,
    samples: u32,
    // The size of the picture.
    size: vec2u,
    // Where the tangents of places begin in their buffer.
    tangents: u32,
    // 1 if tubes of other lines are solid.
    solid: u32,
}

@group(0) @binding(12) var<storage, read> fragments: array<Fragment>;
// Points of the disc.
@group(0) @binding(15) var<storage, read> samples: array<vec2f>;
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

fn set_of(fragment: Fragment) -> u32 {
    return hash(fragment.line, u32(clamp(fragment.along / (ao.radius * SET_STEP), 0.0, 4294967040.0))) % ao.sets;
}

struct Hemisphere {
    pole: vec3f,
    across: vec3f,
}

fn hemisphere(fragment: Fragment) -> Hemisphere {
    let away = away_at(fragment.position);
    let flat = vec3f(1.0, 0.0, 0.0) - away * away.x;
    let long = length(flat);
    let across = select(vec3f(0.0, 1.0, 0.0), flat / max(long, LEAST_LENGTH), long > LEAST_LENGTH);
    return Hemisphere(pole_of(fragment.tangent, away), across);
}

struct Grid {
    origin: vec3f,
    side: f32,
    dims: vec3u,
    margin: f32,
}

@group(0) @binding(19) var<uniform> grid: Grid;
// Where the list of each cell starts, and behind that the line of each segment.
@group(0) @binding(20) var<storage, read> starts: array<u32>;
// The numbers of segments in the lists.
@group(0) @binding(21) var<storage, read> lists: array<u32>;
// The two ends of each segment: three coordinates, and the code of the direction in which its line leads on from there.
@group(0) @binding(22) var<storage, read> ends: array<vec4u>;
// Instead of a direction: the line ends.
const LINE_ENDS: u32 = 0x80008000u;

// A ray, and what all rays of a receiver have in common.
struct Ray {
    start: vec3f,
    way: vec3f,
    // The radius of a tube, half of the greatest width of a ray, and of its width for each unit of its way.
    tube: f32,
    soft: f32,
    spread: f32,
}

// Whether the start lies in a tube.
fn holds(ray: Ray, to_a: vec3f, axis: vec3f) -> bool {
    let along = clamp(-dot(to_a, axis) / dot(axis, axis), 0.0, 1.0);
    return length(to_a + axis * along) <= ray.tube;
}

// Whether the tube of another line than `own` holds the start, if tubes are solid.
fn is_buried(ray: Ray, own: u32) -> bool {
    let at = floor((ray.start - grid.origin) / grid.side);
    if ao.solid == 0u || any(at < vec3f(0.0)) || any(at >= vec3f(grid.dims)) { return false; }
    let place = vec3u(at);
    let cell = (place.z * grid.dims.y + place.y) * grid.dims.x + place.x;
    let lines = grid.dims.x * grid.dims.y * grid.dims.z + 1u;
    for (var i = starts[cell]; i < starts[cell + 1u]; i++) {
        let row = lists[i] * 2u;
        let a = bitcast<vec3f>(ends[row].xyz);
        let axis = (bitcast<vec3f>(ends[row + 1u].xyz) - a) / ao.radius;
        if starts[lines + lists[i]] != own && holds(ray, (a - ray.start) / ao.radius, axis) { return true; }
    }
    return false;
}

fn part_of(bits: u32) -> f32 {
    return max(f32(i32(bits << 16u) >> 16u) / 32767.0, -1.0);
}

// The unit direction of a code of directions.rs.
fn direction_of(code: u32) -> vec3f {
    let x = part_of(code);
    let y = part_of(code >> 16u);
    let z = 1.0 - abs(x) - abs(y);
    let back = max(-z, 0.0);
    return normalize(vec3f(x - select(back, -back, x < 0.0), y - select(back, -back, y < 0.0), z));
}

// Half of the width of a ray.
fn half_width(ray: Ray, t: f32) -> f32 {
    return max(min(t * ray.spread, ray.soft), 1.17549435e-38);
}

// The share of the width of a ray that a tube covers, at a way and a distance from its middle.
fn covered(ray: Ray, t: f32, distance: f32) -> f32 {
    let half = half_width(ray, t);
    return (min(half, distance + ray.tube) - max(-half, distance - ray.tube)) / (2.0 * half);
}

// The share that the ball at an end of a tube covers, of a ray that comes nearest to the line of the tube beyond that end, or runs along the tube and comes to that end first; 0 where the tube after it on its line, or the ball of that one, covers it.
fn rounded(ray: Ray, part: vec2f, to_a: vec3f, axis: vec3f, neighbours: vec2u, is_across: bool) -> f32 {
    let is_first = select(dot(ray.way, axis) > 0.0, dot(ray.way * dot(to_a, ray.way) - to_a, axis) < 0.0, is_across);
    let end = select(to_a + axis, to_a, is_first);
    let neighbour = select(neighbours.y, neighbours.x, is_first);
    let t = dot(end, ray.way);
    let off = ray.way * t - end;
    if !(t > part.x && t <= part.y) { return 0.0; }
    if neighbour != LINE_ENDS {
        let on = direction_of(neighbour);
        // A tube that holds the start stops nothing, and its ball neither.
        let is_alone = length(end + on * max(-dot(end, on), 0.0)) <= ray.tube;
        if !is_alone && !(is_across && is_first && dot(off, on) < 0.0) { return 0.0; }
    }
    // A ball is no longer than it is wide.
    return covered(ray, t, length(off)) * min(ray.tube / half_width(ray, t), 1.0);
}

// The share of a ray that the tubes let through that come nearest to it on a part of its way.
fn beside(ray: Ray, part: vec2f, cell: u32) -> f32 {
    var open = 1.0;
    // The square of the greatest distance at which a tube stops some of it.
    let widest = ray.tube + min(ray.soft, part.y * ray.spread);
    let reach = widest * widest;
    for (var i = starts[cell]; i < starts[cell + 1u]; i++) {
        let row = lists[i] * 2u;
        let first = ends[row];
        let last = ends[row + 1u];
        let a = bitcast<vec3f>(first.xyz);
        let to_a = (a - ray.start) / ao.radius;
        let axis = (bitcast<vec3f>(last.xyz) - a) / ao.radius;
        let normal = cross(ray.way, axis);
        let square = dot(normal, normal);
        let is_across = square > RAY_PARALLEL * dot(axis, axis);
        let beside = dot(to_a, normal);
        if is_across && beside * beside > reach * square { continue; }
        let share = dot(cross(to_a, ray.way), normal) / square;
        var part_covered = 0.0;
        if is_across && share >= 0.0 && share < 1.0 {
            let t = dot(cross(to_a, axis), normal) / square;
            if t > part.x && t <= part.y { part_covered = covered(ray, t, abs(beside) / sqrt(square)); }
        } else {
            part_covered = rounded(ray, part, to_a, axis, vec2u(first.w, last.w), is_across);
        }
        if part_covered > 0.0 && !holds(ray, to_a, axis) { open *= 1.0 - min(part_covered, 1.0); }
    }
    return open;
}

// The share of a ray of length 1 that gets through.
fn passed(ray: Ray) -> f32 {
    let dims = vec3f(grid.dims);
    let start = (ray.start - grid.origin) / grid.side;
    let forth = select(vec3f(-1.0), vec3f(1.0), ray.way >= vec3f(0.0));
    let step = forth * max(abs(ray.way), vec3f(LEAST_WAY)) / (grid.side / ao.radius);
    // Where the ray enters and leaves the grid.
    let low = -start / step;
    let high = (dims - start) / step;
    let first = min(low, high);
    let last = max(low, high);
    var enter = max(max(first.x, first.y), max(first.z, 0.0));
    let leave_grid = min(min(last.x, last.y), min(last.z, 1.0));
    if !(enter <= leave_grid) { return 1.0; }
    var cell = floor(clamp(start + step * enter, vec3f(0.0), dims - 1.0));
    var open = 1.0;
    // Each step leads on towards a side of the grid.
    for (var steps = grid.dims.x + grid.dims.y + grid.dims.z; steps > 0u; steps--) {
        let borders = (cell + max(forth, vec3f(0.0)) - start) / step;
        let nearest = min(borders.x, min(borders.y, borders.z));
        let leave = min(nearest, leave_grid);
        let at = min(vec3u(cell), grid.dims - 1u);
        open *= beside(ray, vec2f(enter, leave), (at.z * grid.dims.y + at.y) * grid.dims.x + at.x);
        if open < STOPPED || !(leave < leave_grid) { return open; }
        enter = max(enter, leave);
        if borders.x == nearest {
            cell.x += forth.x;
        } else if borders.y == nearest {
            cell.y += forth.y;
        } else {
            cell.z += forth.z;
        }
        if any(cell < vec3f(0.0)) || any(cell >= dims) { return open; }
    }
    return open;
}

fn to_world(eye: vec3f) -> vec3f {
    return lens.right * eye.x + lens.up * eye.y + lens.back * eye.z;
}

// Rays of a pixel that are traced side by side, and the pixels of a workgroup.
const LANES: u32 = 8u;
const TILE: vec2u = vec2u(4u, 2u);
var<workgroup> sums: array<f32, 64>;

// Each invocation traces some rays of a pixel: software adapters end the loops of one invocation after 65,535 turns in all.
@compute @workgroup_size(64)
fn trace(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = group.y * groups.x + group.x;
    let across_picture = (ao.size.x + TILE.x - 1u) / TILE.x;
    let corner = vec2u(number % across_picture, number / across_picture) * TILE;
    let at_tile = local / LANES;
    let at = corner + vec2u(at_tile % TILE.x, at_tile / TILE.x);
    let is_inside = all(at < ao.size);
    let pixel = at.y * ao.size.x + at.x;
    var hidden = 0.0;
    if is_inside {
        hidden = traced(fragments[pixel], local % LANES);
    }
    sums[local] = hidden;
    workgroupBarrier();
    if is_inside && local % LANES == 0u {
        var sum = 0.0;
        for (var i = 0u; i < LANES; i++) { sum += sums[local + i]; }
        let value = sum / f32(ao.samples);
        // What is not a number becomes 0.
        occlusion[pixel] = select(0.0, min(value, 1.0), value > 0.0);
    }
}

// How much is stopped of every eighth ray of a receiver, from the one numbered `lane` on.
fn traced(fragment: Fragment, lane: u32) -> f32 {
    var hidden = 0.0;
    if fragment.line != NONE && !(lens.perspective == 1u && fragment.position.z >= 0.0) {
        let above = hemisphere(fragment);
        let flat = fragment.tangent - above.pole * dot(fragment.tangent, above.pole);
        let long = length(flat);
        let across = select(above.across, flat / max(long, LEAST_LENGTH), long > LEAST_LENGTH);
        let upwards = cross(above.pole, across);
        var ray: Ray;
        ray.start = lens.origin + (lens.rest + to_world(fragment.position)) + to_world(above.pole) * (ao.tube * RAY_LIFT);
        ray.tube = ao.tube / ao.radius;
        ray.soft = max(grid.margin - ao.tube, 0.0) / ao.radius;
        ray.spread = 1.0 / sqrt(f32(ao.samples));
        let chosen = set_of(fragment);
        let buried = is_buried(ray, fragment.line);
        for (var i = lane; i < ao.samples; i += LANES) {
            let place = samples[chosen * ao.samples + i];
            let way = across * place.x + upwards * place.y + above.pole * sqrt(max(1.0 - dot(place, place), 0.0));
            ray.way = to_world(way);
            if buried { hidden += 1.0; } else { hidden += 1.0 - passed(ray); }
        }
    }
    return hidden;
}
