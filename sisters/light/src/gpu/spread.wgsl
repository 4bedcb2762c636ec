// Numbers and directions that are spread evenly, the same in every run.

// PCG of Jarzynski and Olano (2020).
fn casca_hash(number: u32) -> u32 {
    let state = number * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// The seed of the choices that are made at a point: nothing flickers while an eye stands still.
fn casca_key(point: vec3f) -> u32 {
    let bits = bitcast<vec3u>(point);
    return casca_hash(bits.x ^ casca_hash(bits.y ^ casca_hash(bits.z)));
}

// A number from 0 to below 1 for a key and a dimension.
fn casca_unit(key: u32, dimension: u32) -> f32 {
    return f32(casca_hash(key ^ casca_hash(dimension)) >> 8u) / 16777216.0;
}

// Golden turns stay exact: a product of large numbers would lose its fraction.
fn casca_golden(i: u32, start: f32) -> f32 {
    return fract(f32(i * 2654435769u) / 4294967296.0 + start);
}

// A unit vector across another.
fn casca_across(way: vec3f) -> vec3f {
    let side = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(way.x) > 0.7);
    return normalize(cross(way, side));
}
