// The light of a point, as the processor's cache answers: the mean of the states around it, each
// behind a short ray of its own. Lengths are in cells.

// Cells of one size: the least one, how many are along an edge of a cell of the grid, their number
// along each axis, and the first brick.
struct CascaLevel { low: vec3i, fine: f32, dims: vec3i, brick: u32 }

struct CascaGrid {
    // The least corner, in metres, and the edge of a cell.
    low: vec3f,
    cell: f32,
    dims: vec3i,
    // Where parts of `casca_cells` start: first entries of cells, the tree, and the triangles of its
    // leaves; and how many parts the tree has.
    heads: u32,
    tree: u32,
    list: u32,
    parts: u32,
    // How many levels there are: the grid, and windows in it.
    count: u32,
    // Where holes of triangles start, or 0.
    holes: u32,
    levels: array<CascaLevel, 3>,
}

// The place of the middle of its starts, the first of them, their number, and whether a surface is just above them. None if not gathered.
struct CascaState { middle: vec3f, first: u32, count: u32, covered: u32 }

@group(1) @binding(0) var<uniform> casca_grid: CascaGrid;
@group(1) @binding(1) var<storage, read> casca_cells: array<u32>;
// The normal, and the area.
@group(1) @binding(2) var<storage, read> casca_entries: array<vec4f>;
@group(1) @binding(3) var<storage, read> casca_states: array<CascaState>;
@group(1) @binding(4) var<storage, read> casca_starts: array<vec4f>;
// A corner and two edges, each with how far a barycentric coordinate may be below 0.
@group(1) @binding(5) var<storage, read> casca_triangles: array<array<vec4f, 3>>;
@group(1) @binding(6) var<storage, read> casca_indirect: array<vec4f>;

// The number of a cell of a level among the occupied ones, or -1.
fn casca_occupied(size: u32, at: vec3i) -> i32 {
    let level = casca_grid.levels[size];
    let c = at - level.low;
    if any(c < vec3i(0)) || any(c >= level.dims) { return -1; }
    let b = c >> vec3u(2u);
    let bricks = (level.dims.xy + 3) >> vec2u(2u);
    let brick = 3 * (i32(level.brick) + (b.z * bricks.y + b.y) * bricks.x + b.x);
    let place = u32(((c.z & 3) << 4u) | ((c.y & 3) << 2u) | (c.x & 3));
    let bit = 1u << (place & 31u);
    let half = brick + i32(place >> 5u);
    let mask = casca_cells[half];
    if (mask & bit) == 0u { return -1; }
    var before = casca_cells[brick + 2] + countOneBits(mask & (bit - 1u));
    if place >= 32u { before += countOneBits(casca_cells[brick]); }
    return i32(before);
}

// The distance at which a ray meets a triangle ahead, or -1.
fn casca_meet(number: u32, origin: vec3f, direction: vec3f) -> f32 {
    let triangle = casca_triangles[number];
    let p = cross(direction, triangle[2].xyz);
    let determinant = dot(triangle[1].xyz, p);
    if determinant == 0.0 { return -1.0; }
    let way = origin - triangle[0].xyz;
    let u = dot(way, p) / determinant;
    let q = cross(way, triangle[1].xyz);
    let v = dot(direction, q) / determinant;
    let distance = dot(triangle[2].xyz, q) / determinant;
    let is_in = u >= -triangle[1].w && v >= -triangle[2].w && 1.0 - u - v >= -triangle[0].w;
    let is_met = is_in && distance >= 0.0 && !(casca_grid.holes > 0u && casca_hole(number, u, v));
    return select(-1.0, distance, is_met);
}

// Whether a triangle has a hole at barycentric coordinates of its second and third corner.
fn casca_hole(number: u32, u: f32, v: f32) -> bool {
    let at = casca_cells[casca_grid.holes + number];
    if at == 0u { return false; }
    let a = bitcast<vec2f>(vec2u(casca_cells[at], casca_cells[at + 1u]));
    let b = bitcast<vec2f>(vec2u(casca_cells[at + 2u], casca_cells[at + 3u]));
    let c = bitcast<vec2f>(vec2u(casca_cells[at + 4u], casca_cells[at + 5u]));
    let size = vec2u(casca_cells[at + 6u], casca_cells[at + 7u]);
    let texel = min(vec2u(fract(a + (b - a) * u + (c - a) * v) * vec2f(size)), size - 1u);
    let bit = texel.y * size.x + texel.x;
    return ((casca_cells[casca_cells[at + 8u] + bit / 32u] >> (bit % 32u)) & 1u) == 0u;
}

fn casca_sees(spot: vec3f, state: CascaState) -> bool {
    for (var i = 0u; i < state.count; i++) {
        if casca_free(spot, casca_starts[state.first + i].xyz) { return true; }
    }
    return false;
}

// The finest level that has a point.
fn casca_level(spot: vec3f) -> u32 {
    for (var i = casca_grid.count - 1u; i > 0u; i--) {
        let c = vec3i(floor(spot * casca_grid.levels[i].fine)) - casca_grid.levels[i].low;
        if all(c >= vec3i(0)) && all(c < casca_grid.levels[i].dims) { return i; }
    }
    return 0u;
}

// The sum of weighted light and the sum of weights of cells of a level within a reach.
fn casca_within(spot: vec3f, normal: vec3f, size: u32, reach: f32) -> vec4f {
    var sum = vec4f(0.0);
    let fine = casca_grid.levels[size].fine;
    let place = spot * fine;
    let middle = vec3i(floor(place));
    let most = i32(ceil(reach));
    let covered = select(1u, 0u, casca_free(spot, spot + normal * (COVER / fine)));
    for (var z = -most; z <= most; z++) { for (var y = -most; y <= most; y++) { for (var x = -most; x <= most; x++) {
        let cell = middle + vec3i(x, y, z);
        let nearest = clamp(place, vec3f(cell) - ABOVE * fine, vec3f(cell) + 1.0 + ABOVE * fine);
        if distance(place, nearest) >= reach { continue; }
        let at = casca_occupied(size, cell);
        if at < 0 { continue; }
        let end = casca_cells[casca_grid.heads + u32(at) + 1u];
        for (var e = casca_cells[casca_grid.heads + u32(at)]; e < end; e++) {
            let entry = casca_entries[e];
            let like = dot(entry.xyz, normal);
            let number = 2u * e + select(0u, 1u, like < 0.0);
            let state = casca_states[number];
            let way = (state.middle - spot) * fine;
            let near = max(1.0 - length(way) / reach, 0.0);
            let low = max(1.0 - ANSWER_HEIGHT * abs(dot(way, normal)), 0.0);
            let area = ANSWER_AREA + (1.0 - ANSWER_AREA) * min(entry.w, 1.0);
            let weight = near * near * low * (abs(like) - ANSWER_NORMAL) * area;
            if state.count > 0u && state.covered == covered && weight > 0.0 && casca_sees(spot, state) {
                sum += weight * vec4f(casca_held(number), 1.0);
            }
        }
    } } }
    return sum;
}

fn casca_near(spot: vec3f, normal: vec3f, size: u32) -> vec4f {
    let sum = casca_within(spot, normal, size, ANSWER_REACH);
    if sum.w > 0.0 { return sum; }
    return casca_within(spot, normal, size, 2.0 * ANSWER_REACH);
}

// The mean of the states around a spot, and 1; 0 if there are none, or no free ones.
fn casca_around(spot: vec3f, normal: vec3f) -> vec4f {
    let own = casca_level(spot);
    var sum = casca_near(spot, normal, own);
    // What lies in the face of a window belongs to one side of it.
    for (var i = 0u; i < casca_grid.count && sum.w <= 0.0; i++) {
        if i != own { sum = casca_near(spot, normal, i); }
    }
    if sum.w <= 0.0 { return vec4f(0.0); }
    return vec4f(sum.rgb / sum.w, 1.0);
}
