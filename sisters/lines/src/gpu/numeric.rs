//! All margins and constants of the shaders, each with its reason.
//!
//! The processor's version places vertices in double precision, the shaders in single. So the two
//! may disagree on the pixels that a line just touches.

use crate::numeric::{ALONG_VIEW, LEAST_WAY, RAY_LIFT, RAY_PARALLEL, SET_STEP, SIDE_SPREAD, SIDES, STOPPED};

/// The part of a pixel by which rounding may move a line. A coordinate of a picture has up to 14
/// bits before the binary point, so that the last of its 24 bits is worth 2^-10 of a pixel; a walk
/// adds up some roundings of it. It holds for segments with ends up to 16,384 pixels from the
/// picture's middle.
pub const IN_DOUBT: f32 = 1.0 / 128.0;

/// The greatest depth of a view, in units of the range of its depths. Depths are computed in single
/// precision: farther away their rounding would put lines before nearer ones, so that such views
/// are refused.
pub const FARTHEST: f64 = 32.0;

/// The occlusion of a pixel may differ by this from the processor's: sums in single precision, in
/// another order. It holds where both take the same set of samples. Where rounding puts a fragment
/// into the next one, it differs by the noise of the samples.
pub const OCCLUSION_OFF: f32 = 2e-3;

/// A normal of context that is shorter than this after interpolation has no direction: vertices
/// whose triangles face all ways have the normal 0. Triangles are shaded flat there.
pub const LEAST_NORMAL: f32 = 1e-3;

/// The greatest thickness of smooth lines in pixels: the cost of a line grows with it.
pub const MOST_THICK: f32 = 16.0;

/// The share of a pixel that a line covers may differ by this from that of its samples. Those of a
/// straight line differ by up to 0.3, where two samples lie along its border; more comes from ends
/// and bends.
pub const SAMPLES_OFF: f32 = 0.35;

/// The least extent of the grid of a scene of bundles, as a share of the greatest coordinate, and in
/// units of the scene: bundles and context may all lie at one place.
pub const LEAST_EXTENT: f32 = 1e-3;

/// The room around bundles and context in the grid of their scene, as a share of the extent:
/// rounding puts nothing outside.
pub const GRID_ROOM: f32 = 0.01;

/// A vector that is not longer than this has no direction: what would be divided by its length
/// would not be finite.
pub const LEAST_LENGTH: f32 = 1e-30;

/// Constants as the shaders take them.
pub(super) fn constants() -> String {
    let all = [
        ("IN_DOUBT", IN_DOUBT),
        ("ALONG_VIEW", ALONG_VIEW),
        ("SET_STEP", SET_STEP),
        ("LEAST_WAY", LEAST_WAY),
        ("RAY_LIFT", RAY_LIFT),
        ("RAY_PARALLEL", RAY_PARALLEL),
        ("STOPPED", STOPPED),
        ("SIDE_SPREAD", SIDE_SPREAD),
        ("LEAST_NORMAL", LEAST_NORMAL),
        ("LEAST_LENGTH", LEAST_LENGTH),
        ("SAMPLES_OFF", SAMPLES_OFF),
    ];
    let sides = format!("const SIDES: u32 = {SIDES}u;\n");
    all.iter().map(|(name, value)| format!("const {name}: f32 = {value:e};\n")).chain([sides]).collect()
}
