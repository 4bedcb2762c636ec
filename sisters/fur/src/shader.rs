//! The rule of strands as WGSL, for renderers other than `gpu`: the same text that it compiles.

pub use crate::numeric::FINE;

/// Where strands stand and how they are lit, as functions of a struct `Look`. Its fields are those
/// of [`crate::strands::Fur`] and a few more; set them by their names, since more may come. It needs
/// no binding.
pub const STRANDS: &str = include_str!("gpu/strands.wgsl");

/// The strand that a fragment of a layer shows: `change(shell)`, which all fragments must call, and
/// `seen(shell, change, normal, width, ray)`. It comes after [`STRANDS`] and either [`LOOKUP`] or
/// [`WALK`], and asks for four names: a variable `look: Look`; a struct `Shell` with the fields
/// `base: vec3f` and `normal: vec3f` (of the skin, in the mesh at rest; `normal` is interpolated and
/// not made longer), `corner: vec3f` (`base` of one corner of the triangle, `flat`), `coat: vec4f`
/// (w: the share of the full length), `which: vec3u` (y: the layer, z: how many there are) and
/// `bend: vec3f`; `bent(bend) -> Look`; and `height_of(which) -> f32`.
pub const SLAB: &str = include_str!("gpu/slab.wgsl");

/// For [`SLAB`]: a fragment looks one strand up, the one next to its ray. Asks for
/// `strand_near(texel: vec3i) -> u32`, a texel of [`crate::strands::Fur::table`].
pub const LOOKUP: &str = include_str!("gpu/lookup.wgsl");

/// For [`SLAB`]: a fragment walks along its ray from cell to cell, which takes no table, and some ten
/// times as long.
pub const WALK: &str = include_str!("gpu/walk.wgsl");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_are_whole_functions_without_bindings() {
        for text in [STRANDS, LOOKUP, WALK, SLAB] {
            let count = |sign: char| text.matches(sign).count();
            assert_eq!((count('{'), count('(')), (count('}'), count(')')));
            assert!(!text.contains("@group") && !text.contains("frame.") && !text.contains("textureSample"));
        }
        assert!(SLAB.contains("fn seen(") && SLAB.contains("fn change("));
    }
}
