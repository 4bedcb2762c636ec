//! The grazing form of the attack: tiny objects closely past the outlines of occluders, as seen
//! from the outermost places and turns that a view stands for.
//!
//! Objects of the size of a point are put 1e-11 to 1e-2 past a silhouette edge, just behind the
//! occluder or far behind it. The eye is at the place of the view, on the ball of its reach, turned
//! as far as the view may turn, at a corner of the view cell; or rays are parallel. A point is seen
//! if its segment misses all occluders by more than the rounding of double precision. Each set must
//! then hold its object. Segments that come closer than that to an occluder are not judged.
//!
//! One scene has hundreds of such objects, and each query decides all of them. [`play`] plays the
//! scene of a seed, and [`long_run`] many of them on all cores; results do not depend on the number
//! of threads.

mod casters;
mod cells;
mod outermost;
mod parallel;
mod run;
mod solid;
mod stage;
mod stream;
mod tally;
mod views;
mod walls;

pub use run::{Run, long_run, play};
pub use tally::{Count, Lost, Tally};
pub use walls::{Meshes, SHAPES};
