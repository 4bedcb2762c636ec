//! Margins of the attack. They are for double precision, and share nothing with those of the
//! oracle: a mistake in one should not hide in the other.

/// A sight that starts in the skin of a solid, which is what rounding leaves in doubt, and leaves it
/// within this many skins is not hidden by it.
pub(crate) const SKINS: f64 = 64.0;

/// Objects keep this little below the speed that they promised, so that rounding breaks no promise.
pub(crate) const KEPT_SPEED: f64 = 1.0 - 1e-9;
/// Objects may be this share of their coordinates out of their volumes: a rounding.
pub(crate) const OUT_OF_VOLUME: f64 = 1e-9;

/// Points count as inside a half-space this share of their coordinates within it.
pub(crate) const INSIDE: f64 = 1e-9;
/// Planes closer to the eye than this share of the coordinates may count as planes through it.
pub(crate) const THROUGH_EYE: f64 = 1e-6;
/// Rows of a matrix that cancel to this share leave rounding only: an infinite far plane.
pub(crate) const NO_PLANE: f64 = 1e-6;
/// Planes that parallel rays cross at less than this sine cut nothing off.
pub(crate) const ALONG_PLANE: f64 = 1e-6;

/// Grazing segments closer to a border than this share of the lengths are in doubt: a hundred
/// roundings.
pub(crate) const ROOM: f64 = 2e-14;
/// The same as a share of the coordinates, from which differences are taken.
pub(crate) const ROOM_COORDINATES: f64 = 1e-15;
/// Points this close to a plane, as a share of the size of a solid, lie on it.
pub(crate) const ON_SOLID: f64 = 1e-10;
/// Three unit normals that span less meet in no corner worth looking past.
pub(crate) const ASKEW: f64 = 1e-6;
/// Edges, and faces beside them, that make a smaller sine with the rays have no outside.
pub(crate) const ALONG_EDGE: f64 = 1e-6;
/// The bounds of a wall are grown by this share of its size and coordinates: they are rounded to
/// f32.
pub(crate) const WALL_BOUNDS: f64 = 1e-6;

/// A point counts as lit up to this share of the range of a light: at the range itself rounding
/// decides.
pub(crate) const IN_RANGE: f64 = 1.0 - 1e-9;
/// Boxes of casters are grown by this share of the coordinates, some thousand roundings, where they
/// excuse an answer.
pub(crate) const CASTER_ROOM: f64 = 1e-12;
/// Eyes are turned by this share of the angle that a set holds for: at the angle itself rounding
/// decides.
pub(crate) const WITHIN_TURN: f64 = 1.0 - 1e-9;
/// The same for frames of a walk, whose cameras are rounded to f32.
pub(crate) const WITHIN_TURN_F32: f64 = 1.0 - 1e-6;
/// Turns are measured with roundings: one counts as within an angle up to this multiple of it, half
/// of what [`WITHIN_TURN`] leaves.
pub(crate) const AS_TURNED: f64 = 1.0 + 5e-10;
/// A point of a ball lies this share of the radius out from its centre: not beyond it by a
/// rounding.
pub(crate) const ON_BALL: f64 = 1.0 - 1e-15;
/// The corner of an oriented box, likewise; its turn is rounded more often.
pub(crate) const ON_CORNER: f64 = 1.0 - 1e-12;
/// The least size of an instance, as a share of the unit of a scene: smaller ones would be flat in
/// f32.
pub(crate) const LEAST_INSTANCE: f32 = 1e-6;
/// A step towards an eye that rounding may take out of its reach: shares of 1 are lessened by this,
/// then by more.
pub(crate) const LAST_PLACE: f64 = 1e-16;
/// The same where places are of single precision.
pub(crate) const LAST_PLACE_F32: f64 = 1e-7;
/// The least size inside a form where other objects are put, as a share of its coordinates: a
/// twentieth of it is still several steps of f32.
pub(crate) const LEAST_FORM: f32 = 5e-6;
