// The lists of cells and the segments in one buffer each. parts.wgsl has the same for larger ones.

// The numbers of segments in the lists.
@group(0) @binding(21) var<storage, read> lists: array<u32>;
// The two ends of each segment: three coordinates, and the code of the direction in which its line leads on from there.
@group(0) @binding(22) var<storage, read> ends: array<vec4u>;

fn named(i: u32) -> u32 {
    return lists[i];
}

fn end_of(i: u32) -> vec4u {
    return ends[i];
}
