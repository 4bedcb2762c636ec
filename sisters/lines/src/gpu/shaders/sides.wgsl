// The occlusion on the sides of places along lines: sisters/lines/src/occlusion/sides.rs has the same on the processor. Values stay from frame to frame.

@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
// Four numbers of each line, as `Span` of places.rs, and from `ao.tangents` on the tangents of places.
@group(0) @binding(23) var<storage, read> places: array<u32>;
// Four values of 8 bits in a word, and a bit of each that has been asked for.
@group(0) @binding(24) var<storage, read_write> values: array<atomic<u32>>;
@group(0) @binding(25) var<storage, read_write> asked: array<atomic<u32>>;
// The number of values to be computed, three numbers of padding, and the numbers of the values.
@group(0) @binding(26) var<storage, read_write> work: array<atomic<u32>>;
@group(0) @binding(27) var<storage, read_write> groups: array<u32>;

const WORK: u32 = 4u;
// Rays of a value that are traced side by side: one each, as a turned view asks for too few values to fill a device. And the values of a workgroup.
const SIDE_LANES: u32 = 12u;
const SIDE_VALUES: u32 = 64u / SIDE_LANES;
const TURN: f32 = 6.2831855;

// The unit tangent at a place.
fn tangent_at(place: u32) -> vec3f {
    return direction_of(places[ao.tangents + place]);
}

// Two directions that are normal to a unit direction and to each other (Duff et al. 2017, "Building an orthonormal basis, revisited").
fn beside_axis(axis: vec3f) -> array<vec3f, 2> {
    let sign = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    return array(
        vec3f(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        vec3f(b, sign + axis.y * axis.y * a, -axis.y),
    );
}

// The numbers of the values that a fragment takes, and their shares.
struct Parts {
    values: vec4u,
    shares: vec4f,
}

fn parts_of(fragment: Fragment) -> Parts {
    let span = fragment.line * 4u;
    let steps = f32(places[span + 3u]);
    let long = vertices[places[span + 1u]].w;
    var at = 0.0;
    if steps > 0.0 { at = clamp(fragment.along / long * steps, 0.0, steps); }
    let before = min(floor(at), max(steps - 1.0, 0.0));
    let pole = to_world(pole_of(fragment.tangent, away_at(fragment.position)));
    var parts: Parts;
    for (var i = 0u; i < 2u; i++) {
        let place = places[span + 2u] + u32(min(before + f32(i), steps));
        let axes = beside_axis(tangent_at(place));
        let x = dot(pole, axes[0]);
        let y = dot(pole, axes[1]);
        var angle = 0.0;
        if x != 0.0 || y != 0.0 { angle = atan2(y, x) / TURN * f32(SIDES); }
        let turn = floor(angle);
        let first = u32(i32(turn) + i32(SIDES)) % SIDES;
        let share = select(1.0 - (at - before), at - before, i == 1u);
        let second = share * (angle - turn);
        parts.values[2u * i] = place * SIDES + first;
        parts.values[2u * i + 1u] = place * SIDES + (first + 1u) % SIDES;
        parts.shares[2u * i] = share - second;
        parts.shares[2u * i + 1u] = second;
    }
    return parts;
}

fn is_receiver(fragment: Fragment) -> bool {
    return fragment.line != NONE && !(lens.perspective == 1u && fragment.position.z >= 0.0);
}

// Puts the values that fragments take, and that nobody asked for before, into the list of work.
@compute @workgroup_size(8, 8)
fn ask(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= ao.size) { return; }
    let fragment = fragments[id.y * ao.size.x + id.x];
    if !is_receiver(fragment) { return; }
    let parts = parts_of(fragment);
    for (var i = 0u; i < 4u; i++) {
        let value = parts.values[i];
        let bit = 1u << (value % 32u);
        if (atomicLoad(&asked[value / 32u]) & bit) != 0u { continue; }
        if (atomicOr(&asked[value / 32u], bit) & bit) == 0u {
            atomicStore(&work[WORK + atomicAdd(&work[0], 1u)], value);
        }
    }
}

// Workgroups along x, as `Kernel::run_groups` has them.
const ROW: u32 = 32768u;

// The workgroups that the work takes.
@compute @workgroup_size(1)
fn count() {
    let all = (atomicLoad(&work[0]) + SIDE_VALUES - 1u) / SIDE_VALUES;
    groups[0] = min(all, ROW);
    groups[1] = (all + ROW - 1u) / ROW;
    groups[2] = 1u;
}

// The line of a place: the last one whose first place is not behind it.
fn line_of(place: u32) -> u32 {
    var low = 0u;
    var high = ao.tangents / 4u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if places[middle * 4u + 2u] <= place { low = middle; } else { high = middle; }
    }
    return low;
}

// A place in the world.
fn middle_of(place: u32) -> vec3f {
    let span = line_of(place) * 4u;
    let first = places[span];
    let last = places[span + 1u];
    let steps = places[span + 3u];
    if steps == 0u { return vertices[first].xyz; }
    let along = vertices[last].w * (f32(place - places[span + 2u]) / f32(steps));
    // The first vertex beyond it.
    var low = first;
    var high = last + 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if vertices[middle].w <= along { low = middle + 1u; } else { high = middle; }
    }
    let next = clamp(low, first + 1u, last);
    let a = vertices[next - 1u];
    let b = vertices[next];
    let way = b.w - a.w;
    var share = 0.0;
    if way > 0.0 { share = clamp((along - a.w) / way, 0.0, 1.0); }
    return a.xyz + (b.xyz - a.xyz) * share;
}

// The data that all rays of a value share, and the set of their directions.
struct Side {
    ray: Ray,
    along: vec3f,
    upwards: vec3f,
    pole: vec3f,
    chosen: u32,
}

fn side_of(value: u32) -> Side {
    let place = value / SIDES;
    let number = value % SIDES;
    var side: Side;
    side.along = tangent_at(place);
    let axes = beside_axis(side.along);
    let angle = f32(number) * (TURN / f32(SIDES));
    side.pole = axes[0] * cos(angle) + axes[1] * sin(angle);
    side.upwards = cross(side.pole, side.along);
    side.ray.start = middle_of(place) + side.pole * (ao.tube * RAY_LIFT);
    side.ray.tube = ao.tube / ao.radius;
    side.ray.soft = max(grid.margin - ao.tube, 0.0) / ao.radius;
    side.ray.spread = SIDE_SPREAD / sqrt(f32(ao.samples));
    side.chosen = hash(place, number) % ao.sets;
    return side;
}

fn ray_of(side: Side, i: u32) -> Ray {
    let at = samples[side.chosen * ao.samples + i];
    var ray = side.ray;
    ray.way = side.along * at.x + side.upwards * at.y + side.pole * sqrt(max(1.0 - dot(at, at), 0.0));
    return ray;
}

// Some rays of a value, from the one numbered `lane` on.
fn traced_side(value: u32, lane: u32) -> f32 {
    let side = side_of(value);
    let buried = is_buried(side.ray, line_of(value / SIDES));
    var hidden = 0.0;
    for (var i = lane; i < ao.samples; i += SIDE_LANES) {
        if buried { hidden += 1.0; } else { hidden += 1.0 - passed(ray_of(side, i)); }
    }
    return hidden;
}

// The rays of the values in the list of work.
@compute @workgroup_size(64)
fn trace_sides(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = (group.y * ROW + group.x) * SIDE_VALUES + local / SIDE_LANES;
    let is_there = local < SIDE_VALUES * SIDE_LANES && number < atomicLoad(&work[0]);
    var value = 0u;
    if is_there { value = atomicLoad(&work[WORK + number]); }
    var hidden = 0.0;
    if is_there { hidden = traced_side(value, local % SIDE_LANES); }
    sums[local] = hidden;
    workgroupBarrier();
    if is_there && local % SIDE_LANES == 0u {
        var sum = 0.0;
        for (var i = 0u; i < SIDE_LANES; i++) { sum += sums[local + i]; }
        let share = sum / f32(ao.samples);
        // What is not a number becomes 0.
        let byte = u32(select(0.0, min(share, 1.0), share > 0.0) * 255.0 + 0.5);
        atomicOr(&values[value / 4u], byte << (8u * (value % 4u)));
    }
}

// The occlusion of pixels from the values.
@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= ao.size) { return; }
    let pixel = id.y * ao.size.x + id.x;
    let fragment = fragments[pixel];
    var sum = 0.0;
    if is_receiver(fragment) {
        let parts = parts_of(fragment);
        for (var i = 0u; i < 4u; i++) {
            let value = parts.values[i];
            let byte = atomicLoad(&values[value / 4u]) >> (8u * (value % 4u)) & 255u;
            sum += f32(byte) / 255.0 * parts.shares[i];
        }
    }
    occlusion[pixel] = select(0.0, min(sum, 1.0), sum > 0.0);
}
