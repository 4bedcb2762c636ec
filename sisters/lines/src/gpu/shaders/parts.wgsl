// As cells.wgsl, for lists and segments in several buffers: each but the last has 2^`grid.part` words.

@group(0) @binding(21) var<storage, read> lists: array<u32>;
@group(0) @binding(50) var<storage, read> lists_1: array<u32>;
@group(0) @binding(51) var<storage, read> lists_2: array<u32>;
@group(0) @binding(52) var<storage, read> lists_3: array<u32>;
@group(0) @binding(53) var<storage, read> lists_4: array<u32>;
@group(0) @binding(54) var<storage, read> lists_5: array<u32>;
@group(0) @binding(22) var<storage, read> ends: array<vec4u>;
@group(0) @binding(55) var<storage, read> ends_1: array<vec4u>;

fn named(i: u32) -> u32 {
    let at = i & ((1u << grid.part) - 1u);
    switch i >> grid.part {
        case 0u: { return lists[at]; }
        case 1u: { return lists_1[at]; }
        case 2u: { return lists_2[at]; }
        case 3u: { return lists_3[at]; }
        case 4u: { return lists_4[at]; }
        default: { return lists_5[at]; }
    }
}

fn end_of(i: u32) -> vec4u {
    // Four words each.
    let part = grid.part - 2u;
    if i >> part == 0u { return ends[i]; }
    return ends_1[i - (1u << part)];
}
