// Means of light over linked states.

struct Count { states: u32, row: u32 }

// The state, its first hit and the number of its hits.
struct Block { state: u32, first: u32, count: u32, unused: u32 }

@group(0) @binding(0) var<uniform> count: Count;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<storage, read> links: array<array<u32, MOST_LINKS>>;
@group(0) @binding(3) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> after: array<vec4f>;

@compute @workgroup_size(64)
fn smoothed(@builtin(global_invocation_id) id: vec3u) {
    let number = id.x + id.y * count.row;
    if number >= count.states { return; }
    let state = blocks[number].state;
    var sum = before[state];
    var parts = 1.0;
    for (var i = 0; i < MOST_LINKS; i++) {
        let link = links[number][i];
        if link == NONE { break; }
        sum += before[link];
        parts += 1.0;
    }
    after[state] = sum / parts;
}
