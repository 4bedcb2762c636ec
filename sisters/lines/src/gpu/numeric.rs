//! All margins and constants of the shaders, each with its reason.
//!
//! The processor's version places vertices in double precision, the shaders in single. So the two
//! may disagree on the columns and slices that a line just touches. A line sets all slices that it
//! enters deeper than [`IN_DOUBT`], and none that it misses by more: the tests compare both bounds
//! with exact clipping.

use crate::numeric::{
    ALONG_VIEW, LEAST_KNOWN, LEAST_SINE, LEAST_WAY, MEAN_SINE, PARALLEL, RAY_LIFT, RAY_PARALLEL, SIDE_SPREAD,
    SIDES, STOPPED,
};

/// The part of a pixel or slice by which rounding may move a line. A coordinate of a picture has up
/// to 14 bits before the binary point, so that the last of its 24 bits is worth 2^-10 of a pixel; a
/// walk adds up some roundings of it. It holds for segments with ends up to 16,384 pixels from the
/// picture's middle, and depths up to [`FARTHEST`] ranges away: those are 8,192 slices.
pub const IN_DOUBT: f32 = 1.0 / 128.0;

/// The greatest depth of a view, in units of the range of its depths. Depths are computed in single
/// precision: farther away their rounding would put lines into wrong slices, so that such views are
/// refused.
pub const FARTHEST: f64 = 32.0;

/// The occlusion of a pixel may differ by this from the processor's: sums of 150 terms in single
/// precision, in another order, and exponentials with some units in the last place. It holds where
/// both take the same samples in the same columns. Where rounding puts a sample into the next
/// column or a fragment into the next set of samples, it differs by the noise of the samples.
pub const OCCLUSION_OFF: f32 = 2e-3;

/// Units of length in the range of depths, 2^27. A 32-bit number holds parts of segments 32 times
/// as long, so that parts that leave a column steeply fit; a part as long as a pixel is thousands
/// of units.
pub const LENGTH_UNITS: f64 = 134_217_728.0;

/// Segments of a workgroup, the chunks that are drawn or left out.
pub const CHUNK: u32 = 64;

/// Segments of a view from which on looking for lines behind lines pays on graphics processors: see
/// [`LineCulling::Large`](crate::gpu::hidden::LineCulling::Large).
pub const LARGE_SET: u32 = 1 << 19;

/// The rounding of a coordinate of eye space, as a share of the way from the eye along all axes:
/// differences, products and sums, of a corner of a chunk and of a point in it, are some 17 units
/// in the last place, 2^-24 each. Twice that is taken.
pub const HIDDEN_ROUNDING: f32 = 1.0 / 524_288.0;

/// Pixels around the outline of a chunk that its lines may touch: the pixel that holds a border,
/// which [`IN_DOUBT`] may move.
pub const HIDDEN_ROOM: f32 = 1.0;

/// Chunks that reach farther from the middle of the picture, in pixels, count as seen: as far as
/// [`IN_DOUBT`] holds.
pub const FARTHEST_PIXEL: f32 = 16_384.0;

/// A normal of context that is shorter than this after interpolation has no direction: vertices
/// whose triangles face all ways have the normal 0. Triangles are shaded flat there.
pub const LEAST_NORMAL: f32 = 1e-3;

/// The greatest thickness of smooth lines in pixels: the cost of a line grows with it.
pub const MOST_THICK: f32 = 16.0;

/// The share of a pixel that a line covers may differ by this from that of its samples. Those of a
/// straight line differ by up to 0.3, where two samples lie along its border; more comes from ends
/// and bends.
pub const SAMPLES_OFF: f32 = 0.35;

/// Constants as the shaders take them.
pub(super) fn constants() -> String {
    let all = [
        ("IN_DOUBT", IN_DOUBT),
        ("ALONG_VIEW", ALONG_VIEW),
        ("LEAST_KNOWN", LEAST_KNOWN),
        ("LEAST_SINE", LEAST_SINE),
        ("PARALLEL", PARALLEL),
        ("MEAN_SINE", MEAN_SINE),
        ("LEAST_WAY", LEAST_WAY),
        ("RAY_LIFT", RAY_LIFT),
        ("RAY_PARALLEL", RAY_PARALLEL),
        ("STOPPED", STOPPED),
        ("SIDE_SPREAD", SIDE_SPREAD),
        ("HIDDEN_ROUNDING", HIDDEN_ROUNDING),
        ("HIDDEN_ROOM", HIDDEN_ROOM),
        ("FARTHEST_PIXEL", FARTHEST_PIXEL),
        ("LEAST_NORMAL", LEAST_NORMAL),
        ("SAMPLES_OFF", SAMPLES_OFF),
    ];
    let sides = format!("const SIDES: u32 = {SIDES}u;\nconst CHUNK: u32 = {CHUNK}u;\n");
    all.iter().map(|(name, value)| format!("const {name}: f32 = {value:e};\n")).chain([sides]).collect()
}
