// Boxes that hide lines: for each pixel the depth of the nearest one on the ray through its centre, and the side that is seen.

@group(0) @binding(13) var<storage, read> boxes: array<vec4f>;
@group(0) @binding(14) var<storage, read_write> walls: array<vec2f>;

@compute @workgroup_size(8, 8)
fn find(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= lens.size) { return; }
    let offset = (vec2f(id.xy) + 0.5 - lens.middle) / lens.scale;
    let across = lens.right * offset.x - lens.up * offset.y;
    let is_perspective = lens.perspective == 1u;
    // Places are start + depth * step.
    let step = select(-lens.back, across - lens.back, is_perspective);
    let start = select(across, vec3f(0.0), is_perspective);
    var found = vec2f(FAR_AWAY, 0.0);
    for (var i = 0u; i + 1u < arrayLength(&boxes); i += 2u) {
        let low = (boxes[i].xyz - lens.origin) - lens.rest - start;
        let high = (boxes[i + 1u].xyz - lens.origin) - lens.rest - start;
        var enter = lens.near;
        var leave = lens.far;
        var side = 0.0;
        for (var axis = 0u; axis < 3u; axis++) {
            if step[axis] == 0.0 {
                if low[axis] > 0.0 || high[axis] < 0.0 { leave = -FAR_AWAY; }
                continue;
            }
            let a = low[axis] / step[axis];
            let b = high[axis] / step[axis];
            if min(a, b) > enter {
                enter = min(a, b);
                side = f32(axis + 1u) * select(1.0, -1.0, step[axis] > 0.0);
            }
            leave = min(leave, max(a, b));
        }
        if enter <= leave && enter < found.x {
            found = vec2f(enter, side);
        }
    }
    walls[pixel_number(id.xy)] = found;
}

const FAR_AWAY: f32 = 3e38;
