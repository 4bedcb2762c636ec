// The colour of a strand: that of the coat at its root.

/// How the coat changes from pixel to pixel. Must be called by all fragments.
fn paint_of(shell: Shell) -> array<vec3f, 2> {
    return array(dpdx(shell.coat.rgb), dpdy(shell.coat.rgb));
}

/// The colour at a place on the skin, `way` from the base of the fragment.
fn colour_at(shell: Shell, c: Change, paint: array<vec3f, 2>, way: vec3f) -> vec3f {
    let across = cross(c.base[0], c.base[1]);
    let area = dot(across, across);
    var pixels = vec2f(0.0);
    if area > 0.0 {
        // Colours do not go on changing so far beyond the triangle.
        let near = way * min(1.0, length(shell.corner - shell.base) / max(length(way), 1e-30));
        pixels = vec2f(dot(near, cross(c.base[1], across)), dot(near, cross(across, c.base[0]))) / area;
    }
    return saturate(shell.coat.rgb + paint[0] * pixels.x + paint[1] * pixels.y);
}
