// Skinned vertices: the twin of `Weights::blend` in casca-fur, and how posed strands lean.

// For each joint of all animals that are posed, the rows of a matrix, from the mesh at rest to object space.
@group(1) @binding(2) var<storage, read> joints: array<array<vec4f, 3>>;

/// The blended matrix of a vertex. `pose` is the first joint of the animal and their number; joints that it lacks stay at rest.
fn blended(pose: vec2u, follows: vec4u, shares: vec4f) -> array<vec4f, 3> {
    var sum = array<vec4f, 3>(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var i = 0u; i < 4u; i++) {
        var m = array<vec4f, 3>(vec4f(1.0, 0.0, 0.0, 0.0), vec4f(0.0, 1.0, 0.0, 0.0), vec4f(0.0, 0.0, 1.0, 0.0));
        if follows[i] < pose.y {
            m = joints[pose.x + follows[i]];
        }
        for (var row = 0u; row < 3u; row++) {
            sum[row] += m[row] * shares[i];
        }
    }
    return sum;
}

/// First `inner`, then `outer`.
fn chained(outer: array<vec4f, 3>, inner: array<vec4f, 3>) -> array<vec4f, 3> {
    var rows = array<vec4f, 3>();
    for (var i = 0u; i < 3u; i++) {
        rows[i] = outer[i].x * inner[0] + outer[i].y * inner[1] + outer[i].z * inner[2] + vec4f(0.0, 0.0, 0.0, outer[i].w);
    }
    return rows;
}

fn transformed(rows: array<vec4f, 3>, v: vec4f) -> vec3f {
    return vec3f(dot(rows[0], v), dot(rows[1], v), dot(rows[2], v));
}

/// A bend with a lean of the world, xyz, no longer than w; with w = 0 there is none. The twin of `Lean::bend`.
fn leaning(bend: vec3f, lean: vec4f, axes: mat3x3f) -> vec3f {
    if lean.w <= 0.0 {
        return bend;
    }
    let long = max(vec3f(length(axes[0]), length(axes[1]), length(axes[2])), vec3f(1e-30));
    let sum = bend + (lean.xyz * axes) / long;
    return sum * min(1.0, lean.w / max(length(sum), 1e-30));
}
