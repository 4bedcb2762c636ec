// The occlusion by columns: sisters/lines/src/occlusion/columns.rs has the same on the processor. Lengths are in units of the radius.

@group(0) @binding(6) var<storage, read> bits: array<u32>;
@group(0) @binding(7) var<storage, read> lengths: array<u32>;

const PI: f32 = 3.14159265;

// Points of the column are start + t * step from the receiver, for t from `enter` to `leave`; t is a depth counted from that of `start`.
struct Prism {
    start: vec3f,
    step: vec3f,
    enter: f32,
    leave: f32,
    column: u32,
    // The slices of the range, and their number; 0 if nothing is known.
    first: u32,
    last: u32,
    total: u32,
    // The depth of `start`, in units of the scene.
    base: f32,
}

// The column through a sample, in the hemisphere with its base raised by `lift`; `enter` > `leave` if there is none.
fn prism_of(above: Hemisphere, at: vec2f, lift: f32) -> Prism {
    var p: Prism;
    p.enter = 1.0;
    p.start = above.across * at.x + above.upwards * at.y;
    p.step = vec3f(0.0, 0.0, -1.0);
    let place = above.middle + p.start;
    if lens.perspective == 1u { p.step = place / -place.z; }
    let a = dot(p.step, p.step);
    let b = dot(p.step, p.start);
    let root = b * b - a * (dot(p.start, p.start) - 1.0);
    if !(root > 0.0) { return p; }
    var enter = (-b - sqrt(root)) / a;
    var leave = (-b + sqrt(root)) / a;
    let height = dot(above.pole, p.start) - lift;
    let slope = dot(above.pole, p.step);
    if abs(slope) < PARALLEL {
        if height < 0.0 { return p; }
    } else {
        let base_at = select(-height, height, (ao.flags & 4u) != 0u) / slope;
        if slope < 0.0 { leave = min(leave, base_at); } else { enter = max(enter, base_at); }
    }
    if !(enter < leave) { return p; }
    p.enter = enter;
    p.leave = leave;
    p.base = -place.z * ao.radius;
    let pixel = project(place * ao.radius);
    let column = floor(pixel.xy / pixel.z);
    if !(pixel.z > 0.0) || any(column < vec2f(0.0)) || any(column >= vec2f(lens.size)) { return p; }
    p.column = pixel_number(vec2u(column));
    let depths = p.base + vec2f(enter, leave) * ao.radius;
    if depths.x <= lens.far && depths.y >= lens.near {
        p.first = slice_of(depths.x);
        p.last = slice_of(depths.y);
        p.total = p.last - p.first + 1u;
    }
    return p;
}

// The share of the cosine-weighted directions times the way that they have in the column, for an area of 1 across.
fn weight_of(p: Prism, pole: vec3f) -> f32 {
    let g = dot(pole, p.start);
    let m = dot(pole, p.step);
    let a = dot(p.step, p.step);
    let b = dot(p.start, p.step);
    let c = dot(p.start, p.start);
    let d = a * c - b * b;
    // The smallest normal number.
    if d <= 1.17549435e-38 { return 0.0; }
    let low = ((a * g - m * b) * p.enter + b * g - m * c) / (d * length(p.start + p.step * p.enter));
    let high = ((a * g - m * b) * p.leave + b * g - m * c) / (d * length(p.start + p.step * p.leave));
    let weight = (high - low) * sqrt(a) / PI;
    return select(0.0, weight, weight > 0.0 && weight < 1e30);
}

// A word of a column with the slices `first` to `last` only.
fn word_of(column: u32, i: u32, first: u32, last: u32) -> u32 {
    let low = max(first, i * 32u) - i * 32u;
    let high = min(last, i * 32u + 31u) - i * 32u;
    return bits[column * (lens.slices / 32u) + i] & (NONE << low) & (NONE >> (31u - high));
}

fn count(column: u32, first: u32, last: u32) -> u32 {
    var on = 0u;
    for (var i = first / 32u; i <= last / 32u; i++) { on += countOneBits(word_of(column, i, first, last)); }
    return on;
}

// The mean of ratios and the ratio of sums.
fn shares(above: Hemisphere, tangent: vec3f, chosen: u32) -> vec2f {
    var ratios = 0.0;
    var columns = 0.0;
    var sums = vec2f(0.0);
    for (var i = 0u; i < ao.samples; i++) {
        let p = prism_of(above, samples[chosen * ao.samples + i].xy, 0.0);
        if p.enter > p.leave || p.total == 0u { continue; }
        let on = f32(count(p.column, p.first, p.last));
        let first = p.start + p.step * p.enter;
        let last = p.start + p.step * p.leave;
        var near = 1.0;
        var sines = vec2f(1.0);
        if (ao.flags & 1u) != 0u {
            let mean = (length(first) + length(last)) * 0.5;
            near = 1.0 / (mean * mean);
        }
        if (ao.flags & 2u) != 0u {
            sines = vec2f(length(cross(tangent, first / max(length(first), 1e-30))), length(cross(tangent, last / max(length(last), 1e-30))));
        }
        let mean_sine = (sines.x + sines.y) * 0.5;
        let total = f32(p.total);
        ratios += on * mean_sine * near / (total * max(sines.x, LEAST_SINE));
        columns += 1.0;
        sums += vec2f(on, total) * mean_sine * near;
    }
    return vec2f(select(0.0, ratios / columns, columns > 0.0), select(0.0, sums.x / sums.y, sums.y > 0.0));
}

// The lengths in the set slices of a prism, times cos(angle to the pole) / (pi distance^2) over the area across.
fn lengths_in(p: Prism, pole: vec3f, lift: f32) -> f32 {
    let thick = (lens.far - lens.near) / f32(lens.slices);
    var sum = 0.0;
    for (var g = p.first / lens.group; g <= p.last / lens.group; g++) {
        let on = count(p.column, g * lens.group, g * lens.group + lens.group - 1u);
        if on == 0u { continue; }
        let first = max(p.first, g * lens.group);
        let last = min(p.last, g * lens.group + lens.group - 1u);
        var in_group = 0.0;
        for (var i = first / 32u; i <= last / 32u; i++) {
            var word = word_of(p.column, i, first, last);
            while word != 0u {
                let depth = lens.near + thick * (f32(i * 32u + firstTrailingBit(word)) + 0.5);
                word &= word - 1u;
                let point = p.start + p.step * ((depth - p.base) / ao.radius);
                let height = dot(pole, point);
                let distance = length(point);
                let side = pixel_size(depth) / ao.radius;
                if height > lift && distance < 1.0 {
                    in_group += height / (PI * distance * distance * distance * side * side);
                }
            }
        }
        let at = 2u * (p.column * lens.groups + g);
        let long = (f32(lengths[at]) + f32(lengths[at + 1u]) * 4294967296.0) / lens.units;
        sum += in_group * long / f32(on);
    }
    return sum / ao.radius;
}

// The share of cosine-weighted rays that tubes of a radius stop.
fn stopped(above: Hemisphere, chosen: u32) -> f32 {
    var weights = array<f32, 8>();
    var lines = array<f32, 8>();
    var all_directions = 0.0;
    let pole = abs(above.pole);
    let thick = (lens.far - lens.near) / f32(lens.slices);
    let lift = (pixel_size(-above.middle.z * ao.radius) * (pole.x + pole.y) + thick * pole.z) * 0.5 / ao.radius;
    for (var i = 0u; i < ao.samples; i++) {
        let sample = samples[chosen * ao.samples + i];
        let p = prism_of(above, sample.xy, lift);
        if p.enter > p.leave { continue; }
        let weight = weight_of(p, above.pole) * sample.z;
        all_directions += weight;
        if p.total == 0u { continue; }
        weights[u32(sample.w)] += weight;
        lines[u32(sample.w)] += sample.z * lengths_in(p, above.pole, lift);
    }
    var known = 0.0;
    var hidden = 0.0;
    for (var s = 0; s < 8; s++) {
        known += weights[s];
        if weights[s] > 0.0 {
            hidden += weights[s] * (1.0 - exp(-2.0 * ao.value / ao.radius * MEAN_SINE * lines[s] / weights[s]));
        }
    }
    return select(0.0, hidden / known, known > all_directions * LEAST_KNOWN);
}

@compute @workgroup_size(8, 8)
fn estimate(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= ao.size) { return; }
    let pixel = id.y * ao.size.x + id.x;
    let fragment = fragments[pixel];
    var value = 0.0;
    if fragment.line != NONE && !(lens.perspective == 1u && fragment.position.z >= 0.0) {
        let above = hemisphere(fragment);
        let chosen = set_of(fragment, id.xy);
        switch ao.estimator {
            case 0u: { value = shares(above, fragment.tangent, chosen).x * ao.value; }
            case 1u: { value = shares(above, fragment.tangent, chosen).y * ao.value; }
            case 2u: { value = 1.0 - exp(-ao.value * shares(above, fragment.tangent, chosen).x); }
            default: { value = stopped(above, chosen); }
        }
    }
    // What is not a number becomes 0.
    occlusion[pixel] = select(0.0, min(value, 1.0), value > 0.0);
}
