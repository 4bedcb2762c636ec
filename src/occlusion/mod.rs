//! Occlusion buffers: visibility from a point at the precision of pixels, without sampling.
//!
//! Six faces around the eye (one plane for parallel rays) keep tiles of coverage bits with far
//! depths; a pixel that is not covered is *open*. A frustum looks through a window of some faces
//! only. Occluders are rounded inwards: a pixel is covered only if all directions in its square are
//! inside the silhouette, at a depth behind which everything in the whole tile is hidden. Targets
//! are rounded outwards: one is hidden only if every pixel that its silhouette may touch is covered
//! nearer than its nearest point. Where pixels are too coarse to decide, [`magnify`] draws them
//! again at a finer pitch, and [`refine`] tests the silhouettes themselves; [`examine`] does both.
//!
//! | Layer | Modules |
//! |---|---|
//! | geometry on a face | [`face`], [`silhouette`], [`front`] |
//! | occluders and targets | [`solid`], [`surface`], [`target`] |
//! | pixels | [`pitch`], [`pixels`], [`rows`], [`tiles`], [`coverage`], [`bins`] |
//! | buffers | [`face_buffer`], [`buffers`], [`holes`], [`refine`], [`magnify`], [`examine`], [`image`] |
//!
//! After the thesis' future work (section 5, occluder fusion in image space) and the sources named
//! in [`tiles`].

pub(crate) mod bins;
pub(crate) mod buffers;
pub(crate) mod coverage;
pub(crate) mod examine;
pub(crate) mod face;
pub(crate) mod face_buffer;
pub(crate) mod front;
pub(crate) mod holes;
pub(crate) mod magnify;
pub(crate) mod pitch;
pub(crate) mod pixels;
pub(crate) mod refine;
pub(crate) mod rows;
pub(crate) mod silhouette;
pub(crate) mod solid;
pub(crate) mod surface;
pub(crate) mod target;
pub(crate) mod tiles;
