// An order of depths as whole numbers, the nearest greatest.
fn key_of(depth: f32) -> u32 {
    let b = bitcast<u32>(depth);
    return select(~(b | 0x80000000u), b, (b & 0x80000000u) != 0u);
}

