//! Every margin and constant of the shaders, with its reason. [`constants`] hands them to WGSL.

use crate::cones::MOST_CONES;
use crate::data::LightKindNumber;
use crate::picture::Layer;
use crate::volume::LEVELS;

/// Cells grow by this share of their edge before triangles are tested. Coordinates of up to 512 cells have errors of 2^-15 of a cell in single
/// precision, and the products of the test a few times that.
pub const TOUCH: f32 = 1.0 / 2048.0;

/// A ray or cone starts so many cells above a surface, times the sum of the components of its normal. A plane touches
/// cells whose centres are up to half that sum away. From a point, a filter sees centres within one sum, and a voxel's centre may lie
/// half a sum behind its plane: 0.5 + 1 from the surface, and no less from a centre, as the exact walk needs no filter.
pub const PUSH_OFF: f32 = 1.5;

/// Albedo is summed as integers of 10 bits, so that [`MOST_TRIANGLES`] of them fit into 32 bits.
pub const UNIT: f32 = 1023.0;
/// The same for normals, which have a sign.
pub const UNIT_NORMAL: f32 = 511.0;
/// Of the emission of a cell the greatest counts, as a share of the brightest in the scene: as many steps as single precision tells with room.
const UNIT_EMISSION: f32 = 1_048_575.0;
/// Triangles of a scene: 2^22 sums of 10 bits fit into 32.
pub const MOST_TRIANGLES: usize = 1 << 22;

/// Normals whose mean is shorter face so many ways that none stands for the cell: a thin sheet with two sides.
const CANCELLED: f32 = 0.2;
/// The greatest number of a half float.
const LARGEST_HALF: f32 = 65504.0;
/// Corners further than this many cells from the grid are left out: products of three coordinates stay finite.
pub const FARTHEST: f32 = 1e6;
/// A cell is at least this share of the greatest coordinate: single precision tells 16 places in it.
pub const LEAST_CELL: f32 = 16.0 * f32::EPSILON;
/// Farther than all there is, in cells.
const FAR: f32 = 1e9;
/// Instead of zero, where it is divided by.
const TINY: f32 = 1e-6;
/// Steps of a walk or cone: more than three times the cells along the longest axis, and than the shortest steps need.
const MOST_STEPS: u32 = 4096;
/// Ambient occlusion of something at the reach of the cones counts a hundredth of that nearby.
const NEAR_FADE: f32 = 99.0;
/// The tangent of half the angle of the narrowest reflection: one degree, below which it costs only time (digest 2.4).
pub const NARROWEST: f32 = 0.0175;

/// The tangent of half the angle of the widest reflection, sqrt(5) / 2: that of an exponent of 2.
pub const WIDEST_REFLECTION: f32 = 1.12;

/// Constants that shaders begin with.
pub fn constants() -> String {
    let floats = [
        ("TOUCH", TOUCH),
        ("PUSH_OFF", PUSH_OFF),
        ("UNIT", UNIT),
        ("UNIT_EMISSION", UNIT_EMISSION),
        ("UNIT_NORMAL", UNIT_NORMAL),
        ("CANCELLED", CANCELLED),
        ("LARGEST_HALF", LARGEST_HALF),
        ("FAR", FAR),
        ("TINY", TINY),
        ("NEAR_FADE", NEAR_FADE),
        ("PI", std::f32::consts::PI),
    ];
    let numbers = [
        ("MOST_STEPS", MOST_STEPS),
        ("LEVELS", LEVELS),
        ("MOST_CONES", MOST_CONES as u32),
        ("DIRECTIONAL", LightKindNumber::Directional as u32),
        ("SPOT", LightKindNumber::Spot as u32),
    ];
    let floats = floats.map(|(name, value)| format!("const {name}: f32 = {value:?};\n"));
    let layers = Layer::EVERY.map(|layer| (layer.constant(), layer as u32));
    let numbers = numbers
        .map(|(name, n)| (name.to_owned(), n))
        .into_iter()
        .chain(layers)
        .map(|(name, n)| format!("const {name}: u32 = {n}u;\n"));
    floats.into_iter().chain(numbers).collect()
}
