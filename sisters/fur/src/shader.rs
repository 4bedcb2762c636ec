//! The rule of strands as WGSL, for renderers other than `gpu`: the same text that it compiles.

pub use crate::numeric::{COARSE, FINE, STEPS};

/// Where strands stand and how they are lit: `strand_at` and the functions that it needs, as
/// functions of a struct `Look`. Its fields are those of [`crate::strands::Fur`] and a few more;
/// set them by their names, since more may come. It needs no binding.
pub const STRANDS: &str = include_str!("gpu/strands.wgsl");

/// The strand that a fragment of a layer shows: `change(shell)`, which all fragments must call, and
/// `seen(shell, change, normal, width, ray)`, which follows the ray through the slab below the
/// layer by up to [`STEPS`] blocks of cells. It comes after [`STRANDS`] and asks for five names: a
/// variable `look: Look`; a struct `Shell` with the fields `base: vec3f` and `normal: vec3f` (of
/// the skin, in the mesh at rest; `normal` is interpolated and not made longer), `corner: vec3f`
/// (`base` of one corner of the triangle, `flat`), `coat: vec4f` (w: the share of the full length),
/// `which: vec3u` (y: the layer, z: how many there are) and `bend: vec3f`; `bent(bend) -> Look`;
/// `height_of(which) -> f32`; and `strand_here(look, skin, height, long) -> Seen`, which calls
/// `strand_at`.
pub const SLAB: &str = concat!(include_str!("gpu/rays.wgsl"), include_str!("gpu/slab.wgsl"));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_are_whole_functions_without_bindings() {
        for text in [STRANDS, SLAB] {
            let count = |sign: char| text.matches(sign).count();
            assert_eq!((count('{'), count('(')), (count('}'), count(')')));
            assert!(!text.contains("@group") && !text.contains("frame.") && !text.contains("textureSample"));
        }
        assert!(
            STRANDS.contains("fn strand_at(") && SLAB.contains("fn seen(") && SLAB.contains("fn change(")
        );
    }
}
