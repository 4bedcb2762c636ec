// Direct light of a point, as the processor finds it: lights and lamps, by rays against the
// triangles of the tree. Lengths are in cells.

struct CascaCounts {
    lights: u32,
    lamps: u32,
    light_rays: u32,
    lamp_points: u32,
    lamp_rays: u32,
    // The luminance of lamps times their area.
    power: f32,
}

// Lights, of four vectors each, and lamps, of two.
@group(1) @binding(7) var<storage, read> casca_sources: array<vec4f>;
@group(1) @binding(8) var<uniform> casca_counts: CascaCounts;

// The share of a disc around a way that is seen. `reach` is that of the way in cells.
fn casca_seen(spot: vec3f, way: vec3f, tangent: f32, reach: f32, key: u32) -> f32 {
    var rays = casca_counts.light_rays;
    if tangent <= 0.0 { rays = 1u; }
    let right = casca_across(way);
    let up = cross(right, way);
    var seen = 0.0;
    for (var i = 0u; i < rays; i++) {
        let radius = sqrt((f32(i) + casca_unit(key, 2u)) / f32(rays)) * max(tangent, 0.0);
        let turn = TURN * casca_golden(i, casca_unit(key, 3u));
        let to = way + (right * cos(turn) + up * sin(turn)) * radius;
        let far = length(to);
        if casca_open(spot, to / far, reach * far) { seen += 1.0; }
    }
    return seen / f32(rays);
}

// The irradiance of a ball of one watt per steradian, in 1 / m².
fn casca_ball(spot: vec3f, normal: vec3f, centre: vec3f, radius: f32, key: u32) -> f32 {
    let way = centre - spot;
    let reach = length(way);
    if reach <= 0.0 { return 0.0; }
    let cosine = dot(way / reach, normal);
    if cosine <= 0.0 { return 0.0; }
    let metres = reach * casca_grid.cell;
    return cosine * casca_seen(spot, way / reach, radius / reach, reach, key) / (metres * metres);
}

// The product of the solid angle and the cosine of a small part of a lamp, by its area.
fn casca_small(spot: vec3f, normal: vec3f, point: vec3f, facing: vec3f) -> f32 {
    let way = point - spot;
    let square = dot(way, way);
    if square <= 0.0 { return 0.0; }
    return max(dot(way, normal), 0.0) * abs(dot(way, facing)) / (square * square);
}

fn casca_light(number: u32, spot: vec3f, normal: vec3f, key: u32) -> vec3f {
    let first = 4u * number;
    let place = casca_sources[first];
    let colour = casca_sources[first + 1u];
    let axis = casca_sources[first + 2u];
    let rest = casca_sources[first + 3u];
    switch u32(place.w) {
        case 0u: { return colour.rgb * casca_ball(spot, normal, place.xyz, colour.w, key); }
        case 1u: {
            let cosine = dot(normalize(spot - place.xyz), axis.xyz);
            if cosine <= axis.w { return vec3f(0.0); }
            var share = 1.0;
            if cosine < rest.w { share = (cosine - axis.w) / (rest.w - axis.w); }
            let smooth_share = share * share * (3.0 - 2.0 * share);
            return colour.rgb * smooth_share * casca_ball(spot, normal, place.xyz, colour.w, key);
        }
        default: {
            let cosine = dot(place.xyz, normal);
            if cosine <= 0.0 { return vec3f(0.0); }
            return colour.rgb * cosine * casca_seen(spot, place.xyz, colour.w, FAR, key);
        }
    }
}

struct CascaChoice { lamp: u32, point: vec3f, weight: f32, facing: vec3f }

// The `i`th of the points of lamps that are weighed, spread by power.
fn casca_choice(i: u32, spot: vec3f, normal: vec3f, turn: vec2f) -> CascaChoice {
    let along = (f32(i) + turn.x) / f32(casca_counts.lamp_points);
    let first = 4u * casca_counts.lights;
    var low = 0u;
    var high = casca_counts.lamps - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if casca_sources[first + 2u * middle].w <= along { low = middle + 1u; } else { high = middle; }
    }
    let before = select(casca_sources[first + 2u * max(low, 1u) - 2u].w, 0.0, low == 0u);
    let part = casca_sources[first + 2u * low].w - before;
    let inside = clamp((along - before) / max(part, LEAST_SHARE), 0.0, 1.0);
    let across = casca_golden(i, turn.y);
    let halves = casca_sources[first + 2u * low + 1u];
    let triangle = casca_triangles[u32(halves.x) + LOW * u32(halves.z)];
    let root = sqrt(inside);
    let point = triangle[0].xyz + triangle[1].xyz * (root * (1.0 - across)) + triangle[2].xyz * (root * across);
    let facing = normalize(cross(triangle[1].xyz, triangle[2].xyz));
    return CascaChoice(low, point, casca_small(spot, normal, point, facing), facing);
}

fn casca_lamps(spot: vec3f, normal: vec3f, key: u32) -> vec3f {
    if casca_counts.lamps == 0u { return vec3f(0.0); }
    let turn = vec2f(casca_unit(key, 4u), casca_unit(key, 5u));
    var sum = 0.0;
    for (var i = 0u; i < casca_counts.lamp_points; i++) { sum += casca_choice(i, spot, normal, turn).weight; }
    if sum <= 0.0 { return vec3f(0.0); }
    // Rays go to points by weight, at even steps through their sum.
    let rays = f32(casca_counts.lamp_rays);
    let start = casca_unit(key, 6u);
    var light = vec3f(0.0);
    var passed = 0.0;
    var sent = 0.0;
    for (var i = 0u; i < casca_counts.lamp_points; i++) {
        let choice = casca_choice(i, spot, normal, turn);
        passed += choice.weight;
        var count = 0.0;
        while sent < rays && (sent + start) / rays * sum < passed { sent += 1.0; count += 1.0; }
        if count == 0.0 { continue; }
        let facing = choice.facing * select(1.0, -1.0, dot(choice.facing, choice.point - spot) > 0.0);
        if casca_free(spot, choice.point + facing * LIFT) {
            let lamp = 4u * casca_counts.lights + 2u * choice.lamp;
            light += count * casca_sources[lamp].rgb / casca_sources[lamp + 1u].y;
        }
    }
    return light * (sum / rays) * casca_counts.power / f32(casca_counts.lamp_points);
}

// The direct irradiance of a point in metres with a unit normal.
fn casca_direct(point: vec3f, normal: vec3f) -> vec3f {
    let spot = (point - casca_grid.low) / casca_grid.cell + normal * LIFT;
    let key = casca_key(point);
    var light = casca_lamps(spot, normal, key);
    for (var i = 0u; i < casca_counts.lights; i++) {
        light += casca_light(i, spot, normal, casca_hash(key ^ casca_hash(i)));
    }
    return light;
}

// Direct and indirect irradiance, and 1 if states gave the latter.
fn casca_light_of(point: vec3f, normal: vec3f) -> vec4f {
    return casca_irradiance(point, normal) + vec4f(casca_direct(point, normal), 0.0);
}
