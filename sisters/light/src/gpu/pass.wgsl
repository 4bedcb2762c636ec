// Passes along stored hits. All states read what was sent before the pass (Jacobi), so that the
// order in which the device works does not matter.

struct Count { states: u32, row: u32 }

// The state, its first hit and the number of its hits.
struct Block { state: u32, first: u32, count: u32, unused: u32 }

// The sum of what its rays see of the sky, and what it scatters of its irradiance.
struct Surface { sky: vec4f, share: vec4f }

@group(0) @binding(0) var<uniform> count: Count;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<storage, read> hits: array<u32>;
@group(0) @binding(3) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(4) var<storage, read> direct: array<vec4f>;
@group(0) @binding(5) var<storage, read> before: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> after: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> indirect: array<vec4f>;

fn number(id: vec3u) -> u32 {
    return id.x + id.y * count.row;
}

fn send(state: u32) {
    after[state] = surfaces[state].share * (direct[state] + indirect[state]);
}

@compute @workgroup_size(64)
fn spread(@builtin(global_invocation_id) id: vec3u) {
    if number(id) >= count.states { return; }
    let block = blocks[number(id)];
    var light = surfaces[block.state].sky;
    for (var i = block.first; i < block.first + block.count; i++) {
        // Rays to the sky and dark ones carry nothing here.
        if hits[i] < DARK { light += before[hits[i]]; }
    }
    indirect[block.state] = light * (PI / f32(block.count));
    send(block.state);
}

// After other direct light. What was sent before stays unread.
@compute @workgroup_size(64)
fn renew(@builtin(global_invocation_id) id: vec3u) {
    if number(id) >= count.states { return; }
    send(blocks[number(id)].state);
}
