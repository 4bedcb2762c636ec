//! Margins of exact visibility. They are for double precision unless they
//! say otherwise.

/// The greatest share of its size by which a solid is grown when a ray must miss it by more than
/// rounding.
pub(crate) const GROW: f64 = 1e-7;
/// The same as a share of the distance.
pub(crate) const GROW_DISTANCE: f64 = 1e-9;
/// The same for triangles, in barycentric coordinates.
pub(crate) const GROW_TRIANGLE: f64 = 1e-7;
/// Triangles reach past their edges by this much in barycentric coordinates, so that rounding opens
/// no gap between neighbours.
pub(crate) const CLOSE_TRIANGLE: f64 = 1e-10;
/// Components of a direction below this count as zero: their inverse would not be finite.
pub(crate) const NO_STEP: f64 = 1e-290;
/// The inverse of such a component. A product with a coordinate is finite.
pub(crate) const INVERSE_OF_NO_STEP: f64 = 1e290;
/// By what share the box of a mesh is widened against the rounding of its transform.
pub(crate) const BOX_SIZE: f64 = 1e-9;
/// The same as a share of the coordinates of its middle.
pub(crate) const BOX_PLACE: f64 = 1e-12;

/// Hits this near the target, as a share of the way, do not hide it.
pub(crate) const END: f64 = 1e-6;
/// A ray that must be beyond doubt goes on past its target by this share: what coincides with the
/// target hides it.
pub(crate) const PAST_END: f64 = 1e-9;

/// The least near plane of a perspective view: at the eye itself nothing can be projected.
pub(crate) const NEAREST: f64 = 1e-9;
/// What is within this share of the frustum's border may be outside by a renderer's rounding to
/// f32.
pub(crate) const SURELY_INSIDE: f64 = 1e-6;
/// Shapes are outside of a plane by more than this share of the terms of the test, or may meet it.
pub(crate) const PLANE: f64 = 1e-9;

/// A sphere is looked at only from outside by more than this share of its radius: nearer, hardly a
/// cap is visible.
pub(crate) const OUTSIDE_SPHERE: f64 = 1e-9;
/// Points of a visible cap stay this far, in cosine, from its rim, where rounding would put them
/// behind it.
pub(crate) const OFF_RIM: f64 = 1e-12;
/// The weight of a face without area, so that one of several such faces can be drawn.
pub(crate) const LEAST_AREA: f64 = 1e-30;

/// What is added to the greatest coordinate of a scene, so that one at the origin has a size.
pub(crate) const LEAST_SCALE: f64 = 1e-3;
/// Rays of the hierarchies are of single precision: they are longer by this share, and of the size
/// of the scene.
pub(crate) const RAY_F32: f64 = 1e-5;
/// The boxes of the hierarchies are widened by this share of the scene, some tens of roundings of
/// such a ray.
pub(crate) const BOX_F32: f64 = 4e-6;
