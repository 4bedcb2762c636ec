// Lines of a thickness in four samples of each pixel. The lens is that of the samples, so that a pixel of it is a sample.

// Where the fragment of each sample of a pixel is: its layer, four bits a sample from the lowest on. Then the share of the pixel that its nearest
// line covers, 12 bits, and the layer of that one, or NO_LAYER where the share is that of the samples.
@group(0) @binding(28) var<storage, read_write> layers: array<u32>;

const LAYERS: u32 = 4u;
const NO_LAYER: u32 = 15u;

// Samples of a pixel are at the corners of a turned square: no two in the same row or column of quarters.
fn place_of(sample: vec2i) -> vec2f {
    let odd = vec2f(sample & vec2i(1));
    return vec2f(sample) + vec2f(0.75 - 0.5 * odd.y, 0.25 + 0.5 * odd.x);
}

// A segment in the picture.
struct Strip {
    a: vec3f,
    b: vec3f,
    // The ends of the part in the depths and near the picture, and their homogeneous coordinates w.
    first: vec2f,
    last: vec2f,
    w: vec2f,
    part: vec2f,
}

// The part is empty if its second end is less than its first.
fn strip_of(segment: u32) -> Strip {
    let ends = ends_of(segment);
    var s: Strip;
    s.a = to_eye(vertices[ends.x].xyz);
    s.b = to_eye(vertices[ends.y].xyz);
    let pa = project(s.a);
    let pb = project(s.b);
    let room = vec2f(lens.thick + 1.0);
    s.part = clip(s.a, s.b, pa, pb, -room, vec2f(lens.size) + room);
    let first = mix(pa, pb, s.part.x);
    let last = mix(pa, pb, s.part.y);
    s.first = first.xy / first.z;
    s.last = last.xy / last.z;
    s.w = vec2f(first.z, last.z);
    return s;
}

// The share of the segment at the point that is nearest to a place in the picture, and the distance in pixels.
fn nearest_on(s: Strip, place: vec2f) -> vec2f {
    let way = s.last - s.first;
    let square = dot(way, way);
    var along = 0.0;
    if square > 0.0 { along = saturate(dot(place - s.first, way) / square); }
    let nearer = along * s.w.x;
    let share = nearer / (nearer + (1.0 - along) * s.w.y);
    return vec2f(mix(s.part.x, s.part.y, share), distance(place, s.first + way * along));
}

// As `draw`, for samples within half the thickness of a line.
@compute @workgroup_size(64)
fn draw_thick(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let segment = segment_of(group, groups, local);
    if segment == NONE { return; }
    let s = strip_of(segment);
    if s.part.x > s.part.y { return; }
    let way = s.last - s.first;
    // Along the longer side, and across it.
    let steep = abs(way.y) > abs(way.x);
    let start = select(s.first, s.first.yx, steep);
    let end = select(s.last, s.last.yx, steep);
    let most = vec2i(select(lens.size, lens.size.yx, steep)) - 1;
    var slope = 0.0;
    if end.x != start.x { slope = (end.y - start.y) / (end.x - start.x); }
    // Samples lie up to a quarter beside the middle of their pixel.
    let half = lens.thick * sqrt(1.0 + slope * slope) + 0.25 * abs(slope) + IN_DOUBT;
    let to = min(i32(floor(max(start.x, end.x) + lens.thick)), most.x);
    for (var i = max(i32(floor(min(start.x, end.x) - lens.thick)), 0); i <= to; i++) {
        let middle = start.y + slope * (f32(i) + 0.5 - start.x);
        let last = min(i32(floor(middle + half)), most.y);
        for (var j = max(i32(floor(middle - half)), 0); j <= last; j++) {
            let at = select(vec2i(i, j), vec2i(j, i), steep);
            let near = nearest_on(s, place_of(at));
            let depth = -mix(s.a.z, s.b.z, near.x);
            if near.y <= lens.thick && depth <= textureLoad(surfaces, at, 0).x {
                choose(pixel_number(vec2u(at)), depth, segment);
            }
        }
    }
}

// The part of a square of side 1 that lies on one side of a straight line, at a distance from its middle: negative if less than half does.
fn beside_straight(normal: vec2f, distance: f32) -> f32 {
    let long = max(abs(normal.x), abs(normal.y));
    let short = min(abs(normal.x), abs(normal.y));
    let corner = max(0.5 * (long + short) - abs(distance), 0.0);
    // A straight line cuts off a triangle of the square, or crosses two sides that are opposite to each other.
    let cut = select(max(0.5 - abs(distance) / long, 0.0), corner * corner / (2.0 * long * short), corner < short);
    return select(cut, 1.0 - cut, distance > 0.0);
}

// The share of a pixel that a segment would cover if it were endless; negative where its direction is not known.
fn covered_by(s: Strip, pixel: vec2u) -> f32 {
    let way = s.last - s.first;
    let long = length(way);
    if !(long > IN_DOUBT) { return -1.0; }
    let off = 2.0 * vec2f(pixel) + 1.0 - s.first;
    let along = dot(off, way) / long;
    if along < -1.0 || along > long + 1.0 { return -1.0; }
    let normal = vec2f(-way.y, way.x) / long;
    // Two samples are a pixel.
    let distance = 0.5 * dot(off, normal);
    let half = 0.5 * lens.thick;
    return beside_straight(normal, half - distance) + beside_straight(normal, half + distance) - 1.0;
}

// Samples of a pixel that show the same line at about the same place have one fragment, in the middle of them.
@compute @workgroup_size(8, 8)
fn resolve_samples(@builtin(global_invocation_id) id: vec3u) {
    let size = lens.size / 2u;
    if any(id.xy >= size) { return; }
    var found: array<Fragment, LAYERS>;
    var owner: array<u32, LAYERS>;
    // Sums of places, and their number.
    var places: array<vec3f, LAYERS>;
    var count = 0u;
    var word = 0u;
    // The nearest context of samples without a line.
    var context = FAR_AWAY;
    for (var i = 0u; i < 4u; i++) {
        let at = 2u * id.xy + vec2u(i & 1u, i >> 1u);
        let segment = ~atomicLoad(&owners[pixel_number(at)]);
        var layer = NO_LAYER;
        if segment == NONE {
            context = min(context, textureLoad(surfaces, at, 0).x);
        } else {
            let place = place_of(vec2i(at));
            let s = strip_of(segment);
            let here = fragment_of(segment, s.a, s.b, nearest_on(s, place).x);
            layer = 0u;
            // Two pixels of the picture are four samples.
            let near = 4.0 * pixel_size(-here.position.z);
            while layer < count && (found[layer].line != here.line || !(abs(found[layer].along - here.along) <= near)) { layer++; }
            if layer == count {
                found[count] = here;
                owner[count] = segment;
                places[count] = vec3f(0.0);
                count++;
            }
            places[layer] += vec3f(place, 1.0);
        }
        word |= layer << (4u * i);
    }
    let pixel = id.y * size.x + id.x;
    var front = 0u;
    for (var layer = 1u; layer < count; layer++) {
        if found[layer].position.z > found[front].position.z { front = layer; }
    }
    // Four samples meet a slanted line in steps: its area is known better. Ends and bends of lines, and what context hides, are left to the samples.
    var share = -1.0;
    if count > 0u && places[front].z < 4.0 && context > -found[front].position.z {
        share = covered_by(strip_of(owner[front]), id.xy);
        if !(abs(share - 0.25 * places[front].z) <= SAMPLES_OFF) { share = -1.0; }
    }
    word |= select(u32(share * 4095.0 + 0.5) << 16u | front << 28u, NO_LAYER << 28u, share < 0.0);
    layers[pixel] = word;
    for (var layer = 0u; layer < LAYERS; layer++) {
        var fragment: Fragment;
        fragment.line = NONE;
        if layer < count {
            let s = strip_of(owner[layer]);
            fragment = fragment_of(owner[layer], s.a, s.b, nearest_on(s, places[layer].xy / places[layer].z).x);
        }
        fragments[layer * size.x * size.y + pixel] = fragment;
    }
}
