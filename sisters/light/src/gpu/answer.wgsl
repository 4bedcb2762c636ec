// Answers of indirect light.

// The light of a state that is averaged.
fn casca_held(state: u32) -> vec3f { return casca_indirect[state].rgb; }

// The indirect irradiance of a point in metres with a unit normal; 1 in the last component if
// states gave it, and 0 if there are none, or no free ones.
fn casca_irradiance(point: vec3f, normal: vec3f) -> vec4f {
    let spot = (point - casca_grid.low) / casca_grid.cell + normal * LIFT;
    let size = vec3f(casca_grid.dims);
    // Far outside, whole numbers end.
    if !(all(spot > vec3f(-2.0 * ANSWER_REACH)) && all(spot < size + 2.0 * ANSWER_REACH)) { return vec4f(0.0); }
    return casca_around(spot, normal);
}
