//! The view: an eye or a direction, and the planes that bound the part of space that it sees.

pub(crate) mod cut;
mod eye;
mod matrix;
pub(crate) mod motion;
mod sees;
#[cfg(test)]
mod tests;
mod turn;

use glam::{DVec3, Mat4, Vec3};
use smallvec::SmallVec;

use crate::error::{Error, finite3, not_negative};
use crate::geometry::plane::HalfSpace;
use crate::geometry::{Aabb, Plane, Room};
use crate::numeric::shape::REGION;
use crate::numeric::view::THROUGH_EYE;
pub(crate) use crate::view::eye::Origin;
use crate::view::matrix::Frustum;

/// The most planes that can bound a view.
pub const MAX_PLANES: usize = 32;

/// The part of space that a camera sees: rays from an eye (or parallel ones), bounded by planes.
///
/// # Use
///
/// Give [`View::perspective`] the eye and the matrix with which the camera draws,
/// [`View::orthographic`] the direction and the matrix of a camera or light with parallel rays, or
/// [`View::omnidirectional`] the eye alone; [`View::of_cell`] takes a box of eyes. Then say which
/// layers it shows ([`View::with_layers`]), how far its eye may go ([`View::with_reach`]) and by
/// how much it may turn ([`View::with_turn`])
/// before the set is found anew.
///
/// ```
/// use casca::View;
/// use glam::{Mat4, Vec3, Vec4};
///
/// # fn main() -> Result<(), casca::Error> {
/// // 60 degrees high and 16:9, with reversed depth from 0.1 on, looking along -z.
/// let projection =
///     Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
/// let eye = Vec3::new(4.0, 2.0, 9.0);
/// let matrix = projection * Mat4::from_translation(-eye);
/// let view = View::perspective(eye, matrix)?.with_reach(0.25)?.with_layers(0b1);
/// assert_eq!((view.eye(), view.reach(), view.layers()), (Some(eye.as_dvec3()), 0.25, 1));
/// assert!(View::perspective(eye + Vec3::X, matrix).is_err(), "the matrix is of another eye");
/// # Ok(())
/// # }
/// ```
///
/// # Conventions
///
/// Units are those of the world, in single precision. Depth runs from 0 to 1 as in wgpu, Vulkan and
/// Direct3D (glam's `camera::rh::proj::directx` and the like; before 0.33.2
/// `Mat4::perspective_rh`), also reversed or with an infinite far plane; OpenGL's -1 to 1 has
/// constructors of its own.
///
/// # Cost
///
/// A view is made in some hundred arithmetic operations, and is a few hundred bytes without memory
/// on the heap unless it has more than six planes or may turn.
///
/// # Guarantees
///
/// The planes of a matrix are moved outwards by the distance to which single precision knows them:
/// about 2e-7 of the eye's distance from the origin. So no object is lost that the renderer draws
/// with the same matrix. What is not finite, or contradicts itself, is refused.
///
/// # Pitfalls
///
/// - [`View::from_view_projection`] has to find the eye from the matrix, and knows it only roughly:
///   occluders then hide less. Give the eye where you have it.
/// - Far from the origin single precision is coarse: see [`crate::Scene::set_origin`].
/// - Parallel rays get occlusion only from [`View::orthographic`], which is told where they start.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    pub(crate) origin: Origin,
    pub(crate) planes: SmallVec<[HalfSpace; 6]>,
    /// One bit for each plane outside of which the eye lies.
    cutting: u32,
    /// One bit for each plane through the eye.
    sides: u32,
    /// How far planes that cut off the eye, or any of parallel rays, were moved outwards, at most:
    /// since they were found from a matrix, or because of the reach.
    widened: f64,
    /// Whether it is known at which end parallel rays start.
    ordered: bool,
    /// The layers that it shows, a bit for each.
    layers: u64,
    /// How far the eye may go from its place.
    room: Room,
    /// Set if the camera may turn.
    turned: Option<Box<Turned>>,
}

/// How a view was opened for turns.
#[derive(Debug, Clone, PartialEq)]
struct Turned {
    /// The camera may turn by this, in radians.
    angle: f64,
    /// Rays may start up to this far from the eye, inside the planes of the opened view: 0 without
    /// a near plane, infinity if that does not bound them.
    near: f64,
    /// The view as it was, with its reach.
    straight: View,
}

impl View {
    /// The view of a perspective or orthographic camera, from the matrix that
    /// takes world space to clip space with depth 0 to 1.
    ///
    /// Orthographic views from here get no occlusion (see [`View::orthographic`]). The eye is found
    /// from the matrix, to the precision that single floats leave (about 1e-6 of its distance from
    /// the origin). Where that does not tell the cell of the eye, the result of a query is slightly
    /// larger. [`View::perspective`] takes the exact eye.
    ///
    /// # Errors
    /// Refuses a matrix that is not finite, or maps space to a plane, line or point.
    pub fn from_view_projection(matrix: Mat4) -> Result<Self, Error> {
        Frustum::new(matrix, false, None).map(Self::from)
    }

    /// As [`View::from_view_projection`], for depth from -1 to 1 (OpenGL).
    ///
    /// # Errors
    /// As [`View::from_view_projection`].
    pub fn from_view_projection_gl(matrix: Mat4) -> Result<Self, Error> {
        Frustum::new(matrix, true, None).map(Self::from)
    }

    /// The view of a perspective camera whose eye is known exactly; depth 0 to 1, also reversed or
    /// with an infinite far plane.
    ///
    /// Visibility is that from the given eye. Planes are moved outwards until the eye lies inside.
    /// Where it differs from the matrix's eye by more than products of matrices in single precision
    /// usually explain (a millionth of its distance from the origin), it counts as known to within
    /// that difference.
    ///
    /// # Errors
    /// As [`View::from_view_projection`]; also refuses an eye that is not finite, an orthographic
    /// matrix, and with [`Error::EyeMismatch`] an eye that is not the matrix's: off by more than
    /// about four millionths of twice its distance from the origin and of the distance that it sees
    /// (that of the far plane, at most 10,000 times that of the near plane).
    pub fn perspective(eye: Vec3, matrix: Mat4) -> Result<Self, Error> {
        finite3("the eye", eye)?;
        Frustum::new(matrix, false, Some(eye.as_dvec3())).map(Self::from)
    }

    /// As [`View::perspective`], for depth from -1 to 1 (OpenGL).
    ///
    /// # Errors
    /// As [`View::perspective`].
    pub fn perspective_gl(eye: Vec3, matrix: Mat4) -> Result<Self, Error> {
        finite3("the eye", eye)?;
        Frustum::new(matrix, true, Some(eye.as_dvec3())).map(Self::from)
    }

    /// The view of an orthographic camera that looks along `forward` (of any length); depth 0 to 1,
    /// also reversed.
    ///
    /// A matrix alone does not tell at which end parallel rays start: views of orthographic
    /// matrices from the other constructors get no occlusion.
    ///
    /// # Errors
    /// As [`View::from_view_projection`]; also refuses a direction that is not finite or runs
    /// across the rays, and a perspective matrix.
    pub fn orthographic(forward: Vec3, matrix: Mat4) -> Result<Self, Error> {
        finite3("the direction", forward)?;
        let mut view = Self::from_view_projection(matrix)?;
        let Origin::Direction(d) = view.origin else {
            return Err(Error::Matrix("it is no orthographic camera's"));
        };
        let along = d.dot(forward.as_dvec3().normalize_or_zero());
        if along.abs() < 0.5 {
            return Err(Error::Matrix("its rays do not run along the direction given"));
        }
        view.origin = Origin::Direction(d * along.signum());
        view.ordered = true;
        Ok(view)
    }

    /// Parallel rays that start infinitely far away and run along `direction`, inside all of the
    /// half-spaces. Directions and normals have length 1.
    pub(crate) fn parallel(direction: DVec3, planes: SmallVec<[HalfSpace; 6]>) -> Self {
        Self { ordered: true, ..Self::bounded(Origin::Direction(direction), planes) }
    }

    /// The part of space around an eye that lies inside all of the half-spaces, each of which
    /// contains the eye. Normals have length 1.
    pub(crate) fn around(eye: DVec3, planes: SmallVec<[HalfSpace; 6]>) -> Self {
        Self::bounded(Origin::Eye { at: eye, error: 0.0 }, planes)
    }

    /// All that lies inside of some half-spaces, on all layers, for an eye that stays where it is.
    fn bounded(origin: Origin, planes: SmallVec<[HalfSpace; 6]>) -> Self {
        Self {
            origin,
            planes,
            cutting: 0,
            sides: 0,
            widened: 0.0,
            ordered: false,
            layers: u64::MAX,
            room: Room::NONE,
            turned: None,
        }
    }

    /// Whether it is known where rays start.
    pub(crate) fn is_ordered(&self) -> bool {
        self.ordered || self.eye().is_some()
    }

    /// All of space around an eye, in every direction and however far.
    ///
    /// # Errors
    /// Refuses an eye that is not finite.
    pub fn omnidirectional(eye: Vec3) -> Result<Self, Error> {
        Self::from_planes(eye, &[])
    }

    /// The part of space around an eye that lies inside all given half-spaces. Planes closer to the
    /// eye than about a part in 10^7 of their coordinates count as planes through it, since single
    /// precision does not tell them apart.
    ///
    /// # Errors
    /// Refuses an eye that is not finite, planes without direction and more than
    /// [`MAX_PLANES`] planes.
    pub fn from_planes(eye: Vec3, planes: &[Plane]) -> Result<Self, Error> {
        finite3("the eye", eye)?;
        if planes.len() > MAX_PLANES {
            return Err(Error::TooManyPlanes { given: planes.len(), max: MAX_PLANES });
        }
        let planes = planes.iter().enumerate().map(|(i, p)| {
            let v = p.normal.as_dvec3().extend(f64::from(p.offset));
            HalfSpace::new(v).ok_or(Error::Plane(i))
        });
        let planes: SmallVec<[HalfSpace; 6]> = planes.collect::<Result<_, _>>()?;
        let at = eye.as_dvec3();
        // Planes through the eye miss it by their rounding to single precision.
        let rounding = |p: &HalfSpace| THROUGH_EYE * (at.abs().dot(p.normal.abs()) + p.offset.abs());
        let marked = |is: &dyn Fn(&HalfSpace) -> bool| {
            planes.iter().zip(0..).filter(|(p, _)| is(p)).map(|(_, i)| 1 << i).sum()
        };
        let cutting = marked(&|p| p.distance(at) < -rounding(p));
        let sides = marked(&|p| p.distance(at).abs() <= rounding(p));
        Ok(Self { cutting, sides, ..Self::bounded(Origin::Eye { at, error: 0.0 }, planes) })
    }

    /// All of space around a view cell, a box of eyes: the result of a query has all that can be
    /// seen from anywhere in it, in every direction and however far.
    ///
    /// The box may be flat, or a point. Everything that a box of eyes sees, but for objects that
    /// meet it, its surface sees too: where sets of large boxes are needed, the views of many small
    /// parts of its six sides together have the smaller sets.
    ///
    /// As with a [reach](View::with_reach) of half its diagonal, which is less tight, occluders
    /// hide less around their outlines. Those that meet the box hide nothing. Triangles that are
    /// nearer to its middle than about three times that reach hide if the box lies on one side of
    /// them and the outline of their patch is farther away. [`View::with_reach`] makes the box a
    /// ball. Any result for the box holds for eyes in it ([`crate::Pvs::is_valid_for`]).
    ///
    /// # Errors
    /// Refuses a box that is inverted or not finite.
    pub fn of_cell(cell: Aabb) -> Result<Self, Error> {
        cell.check("the view cell")?;
        let (min, max) = (cell.min.as_dvec3(), cell.max.as_dvec3());
        let at = (min + max) * 0.5;
        // Rounding may not leave eyes outside.
        let grow = if min == max { 0.0 } else { REGION };
        let half = (max - min) * 0.5 * (1.0 + grow) + at.abs() * grow;
        let view = Self::bounded(Origin::Eye { at, error: 0.0 }, SmallVec::new());
        Ok(Self { room: Room::cuboid(half, half.length() * (1.0 + grow)), ..view })
    }

    /// The same view of some layers only: it shows an object if `mask` has a bit in common with the
    /// [layers](crate::ObjectDesc::layers) of the object. A new view shows all layers; the mask 0
    /// shows nothing.
    ///
    /// ```
    /// use casca::{ObjectDesc, Query, Scene, Sphere, View};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// const WORLD: u64 = 1;
    /// const FIRST_PERSON: u64 = 2;
    /// let mut scene = Scene::new(1.0)?;
    /// let ball = Sphere::new(Vec3::splat(9.5), 1.0);
    /// let head = scene.insert(ObjectDesc::dynamic(ball).layers(WORLD))?;
    /// let hands = scene.insert(ObjectDesc::dynamic(ball).layers(FIRST_PERSON))?;
    /// let view = View::omnidirectional(Vec3::splat(2.5))?;
    /// let mut query = Query::new();
    /// assert_eq!(query.run(&scene, &view.clone().with_layers(FIRST_PERSON)).visible(), [hands]);
    /// assert_eq!(query.run(&scene, &view.with_layers(WORLD)).visible(), [head]);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_layers(mut self, mask: u64) -> Self {
        self.layers = mask;
        self
    }

    /// The layers that it shows, a bit for each: see [`View::with_layers`].
    pub fn layers(&self) -> u64 {
        self.layers
    }

    /// The same view for an eye that may go up to `reach` world units from its place, in any
    /// direction and without turning ([`View::with_turn`]): the result of a query has all that it
    /// can see from anywhere there. It holds for many frames ([`crate::Pvs::is_valid_for`]), or for
    /// a client whose eye is known with delay.
    ///
    /// The planes of the view go along with the eye. Unless it looks all round, objects nearer than
    /// eight times the reach are visible without a test. Occluders hide less around their outlines,
    /// as far as one of these eyes sees past them (after Wonka, Wimmer & Schmalstieg 2000, and
    /// Voglreiter et al. 2023); those nearer than about three times the reach hide nothing. Objects
    /// are tested as they are. Where parts that abut share no edges, each opens a gap of the reach:
    /// make them one mesh, or let static ones share their vertices. The reach replaces that of an
    /// earlier call; 0 is the view as it was.
    ///
    /// # Errors
    /// Refuses a reach that is negative or not finite.
    pub fn with_reach(self, reach: f32) -> Result<Self, Error> {
        not_negative("the reach", f64::from(reach))?;
        let room = Room::ball(f64::from(reach));
        Ok(match self.turned.as_ref().map(|turned| turned.angle) {
            Some(angle) => self.straight().roaming(room).opened(angle),
            None => self.roaming(room),
        })
    }

    /// A view that is not opened for turns, for an eye anywhere in a room around its place.
    fn roaming(mut self, room: Room) -> Self {
        let by = |plane: &HalfSpace| room.along(plane.normal) - self.room.along(plane.normal);
        self.planes.iter_mut().for_each(|plane| plane.offset += by(plane));
        self.widened += room.radius() - self.room.radius();
        self.room = room;
        self
    }

    /// How far the eye may go from its place, in world units: see [`View::with_reach`].
    pub fn reach(&self) -> f64 {
        self.room.radius()
    }

    /// Whether all eyes of another view are among those of this one.
    pub(crate) fn reaches(&self, other: &Self) -> bool {
        let (Origin::Eye { at, .. }, Origin::Eye { at: eye, error }) = (self.origin, other.origin) else {
            return false;
        };
        if self.origin == other.origin {
            return self.room.holds(&other.room, DVec3::ZERO);
        }
        // What rounding adds to the offset.
        let rounding = REGION * ((eye - at).length() + self.reach());
        self.room.holds(&other.room.grown(error + rounding), eye - at)
    }

    /// The eye in world units; `None` for parallel rays.
    pub fn eye(&self) -> Option<DVec3> {
        match self.origin {
            Origin::Eye { at, .. } => Some(at),
            Origin::Direction(_) => None,
        }
    }

    /// How far from its place the eye may go.
    pub(crate) fn room(&self) -> &Room {
        &self.room
    }

    /// How far from its place the eye may be along each axis: as far as it is not known, and as it
    /// may go.
    pub(crate) fn eye_box(&self) -> DVec3 {
        match self.origin {
            Origin::Eye { error, .. } => self.room.half() + error,
            Origin::Direction(_) => DVec3::ZERO,
        }
    }

    /// The planes with a bit in `marked`.
    fn marked(&self, marked: u32) -> impl Iterator<Item = &HalfSpace> {
        self.planes.iter().zip(0..).filter(move |(_, i)| marked >> i & 1 != 0).map(|(p, _)| p)
    }
}

impl From<Frustum> for View {
    fn from(Frustum { origin, planes, cutting, sides, widened }: Frustum) -> Self {
        Self { cutting, sides, widened, ..Self::bounded(origin, planes) }
    }
}
