//! The rule of strands as WGSL, for renderers other than `gpu`: the same text that it compiles.

use crate::numeric::FINE;
use crate::shading::Material;
use crate::strands::{Fur, MAX_PER_CELL};

/// Where strands stand and how they are lit, as functions of a struct `Look`, whose bytes [`look`]
/// gives. It needs no binding.
pub const STRANDS: &str = include_str!("gpu/strands.wgsl");

/// For [`SLAB`]: a fragment looks one strand up, the one next to its ray. Asks for
/// `strand_near(texel: vec3i) -> u32`, a texel of [`Fur::table`].
pub const LOOKUP: &str = include_str!("gpu/lookup.wgsl");

/// The strand that a fragment of a layer shows: `change(shell)`, which all fragments must call, and
/// `seen(swayed(shell), change, normal, width, ray)`. It comes after [`STRANDS`] and [`LOOKUP`], and
/// asks for two names: a variable `look: Look`, and a struct `Shell` with the fields `base: vec3f`
/// and `normal: vec3f` (of the skin, in the mesh at rest; `normal` is interpolated and not made
/// longer), `corner: vec3f` (`base` of one corner of the triangle, `flat`), `coat: vec4f` (w: the
/// share of the full length), `which: vec3u` (y: the layer, z: how many there are) and `bend: vec3f`.
pub const SLAB: &str = include_str!("gpu/slab.wgsl");

/// The words of a `Look`: fur, how it throws light back, and how much strands differ in colour.
pub fn look(fur: &Fur, light: &Material, vary: f32) -> [u32; 20] {
    let [x, y, z] = fur.bend.to_array();
    let head = [x, y, z, fur.height, fur.spacing, fur.radius, fur.taper, fur.variation, fur.clump, fur.curl];
    let counts = [fur.per_cell.min(MAX_PER_CELL), fur.seed];
    let light = [light.exponent, light.wrap, light.root, light.ambient, light.diffuse, light.specular, vary];
    let tail = [FINE * fur.spacing].into_iter().chain(light).map(f32::to_bits);
    let mut words = head.map(f32::to_bits).into_iter().chain(counts).chain(tail);
    std::array::from_fn(|_| words.next().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_are_whole_functions_without_bindings() {
        for text in [STRANDS, LOOKUP, SLAB] {
            let count = |sign: char| text.matches(sign).count();
            assert_eq!((count('{'), count('(')), (count('}'), count(')')));
            assert!(!text.contains("@group") && !text.contains("frame.") && !text.contains("textureSample"));
        }
        assert!(SLAB.contains("fn seen(") && SLAB.contains("fn change("));
    }
}
