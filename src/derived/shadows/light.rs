//! Lights, and the views of them.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::error::{Error, finite3};
use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::numeric::scene::LIGHT_EXTENT;
use crate::view::View;

/// A light that casts shadows, for [`crate::Query::shadow_casters`].
///
/// Its numbers are checked where it is used.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    pub(crate) kind: LightKind,
    /// The layers of the objects that cast its shadows.
    layers: u64,
}

/// Where light comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum LightKind {
    Directional(Vec3),
    Point { position: Vec3, range: f32 },
    Spot(Box<View>),
}

impl Light {
    /// A light infinitely far away, such as the sun. `direction` is the one in which light travels,
    /// of any length.
    pub const fn directional(direction: Vec3) -> Self {
        Self { kind: LightKind::Directional(direction), layers: u64::MAX }
    }

    /// A light that shines from a point in all directions, and lights nothing farther away than
    /// `range`. Both are in world units; the range may be infinite.
    pub const fn point(position: Vec3, range: f32) -> Self {
        Self { kind: LightKind::Point { position, range }, layers: u64::MAX }
    }

    /// A light that shines from the eye of a view on all that lies inside the view: the camera of a
    /// shadow map. Rays start at its near plane: objects before that cast no shadow. An
    /// orthographic view ([`View::orthographic`]) is a directional light that lights a box. Its
    /// layers are those of the view.
    pub fn spot(view: View) -> Self {
        Self { layers: view.layers(), kind: LightKind::Spot(Box::new(view)) }
    }

    /// The same light, whose shadows are cast by objects on some layers only, a bit for each. All
    /// others let it through: they are no casters, and do not keep the light from those behind
    /// them.
    ///
    /// Shadows may fall on all that the camera sees, whatever its layers: they are the camera's
    /// matter.
    #[must_use]
    pub fn with_layers(self, mask: u64) -> Self {
        Self { layers: mask, ..self }
    }

    /// The layers of the objects that cast its shadows: see [`Light::with_layers`].
    pub const fn layers(&self) -> u64 {
        self.layers
    }
}

/// A light whose numbers were checked.
#[derive(Debug)]
pub(super) struct Lamp {
    rays: Rays,
    layers: u64,
}

impl Lamp {
    pub(super) fn new(light: &Light) -> Result<Self, Error> {
        Ok(Self { rays: Rays::new(&light.kind)?, layers: light.layers })
    }

    /// The part of a box that the light may reach; `None` if it reaches none of it.
    pub(super) fn lit(&self, block: &Block) -> Option<Block> {
        self.rays.lit(block)
    }

    /// All that the light may reach, of objects on its layers.
    pub(super) fn whole_view(&self) -> View {
        self.rays.whole_view().with_layers(self.layers)
    }

    /// A view of objects on its layers with all rays of the light to some boxes; `None` if there
    /// are no boxes.
    pub(super) fn view_of(&self, pieces: &[Block]) -> Option<View> {
        Some(self.rays.view_of(pieces)?.with_layers(self.layers))
    }
}

/// Where the rays of a light start, and which way they go.
#[derive(Debug)]
enum Rays {
    Sun {
        /// Axes at right angles, of which the last runs along the light.
        axes: [DVec3; 3],
    },
    Bulb {
        at: DVec3,
        range: f64,
    },
    Spot(Box<View>),
}

impl Rays {
    fn new(kind: &LightKind) -> Result<Self, Error> {
        match kind {
            LightKind::Directional(direction) => {
                const WHAT: &str = "the direction of the light";
                finite3(WHAT, *direction)?;
                let along = direction.as_dvec3().try_normalize().ok_or(Error::NoDirection { what: WHAT })?;
                let (right, up) = along.any_orthonormal_pair();
                Ok(Self::Sun { axes: [right, up, along] })
            }
            LightKind::Point { position, range } => {
                finite3("the position of the light", *position)?;
                let range = f64::from(*range);
                if range.is_nan() || range < 0.0 {
                    let what = "the range of the light";
                    return Err(Error::Setting { what, value: range, min: 0.0, max: f64::INFINITY });
                }
                Ok(Self::Bulb { at: position.as_dvec3(), range })
            }
            LightKind::Spot(view) => Ok(Self::Spot(view.clone())),
        }
    }

    /// The part of a box that the light may reach; `None` if it reaches none of it.
    fn lit(&self, block: &Block) -> Option<Block> {
        match self {
            Self::Sun { .. } => Some(*block),
            Self::Bulb { at, range } => {
                let farthest = range + LIGHT_EXTENT * (range + at.abs().max_element());
                if block.distance_from(*at) > farthest {
                    return None;
                }
                let (min, max) = (block.min.max(at - farthest), block.max.min(at + farthest));
                // In doubt (NaN), it reaches all of it.
                if min.cmple(max).all() { Some(Block { min, max }) } else { Some(*block) }
            }
            Self::Spot(view) => view.may_see_volume(block).then_some(*block),
        }
    }

    /// All that the light may reach.
    fn whole_view(&self) -> View {
        match self {
            Self::Sun { axes } => View::parallel(axes[2], SmallVec::new()),
            Self::Bulb { at, range } => {
                let farthest = range + LIGHT_EXTENT * (range + at.abs().max_element());
                if farthest.is_finite() {
                    Self::between(*at, at - farthest, at + farthest)
                } else {
                    View::around(*at, SmallVec::new())
                }
            }
            Self::Spot(view) => (**view).clone(),
        }
    }

    /// A view with all rays of the light to some boxes; `None` if there are no boxes.
    fn view_of(&self, pieces: &[Block]) -> Option<View> {
        match self {
            Self::Sun { axes } => {
                let along = axes[2];
                let extent = pieces.iter().map(|piece| widened(piece, axes)).reduce(join)?;
                let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
                for (axis, min, max) in
                    [(axes[0], extent.min.x, extent.max.x), (axes[1], extent.min.y, extent.max.y)]
                {
                    planes.push(HalfSpace { normal: axis, offset: -min });
                    planes.push(HalfSpace { normal: -axis, offset: max });
                }
                planes.push(HalfSpace { normal: -along, offset: extent.max.z });
                Some(View::parallel(along, planes))
            }
            Self::Bulb { at, .. } => {
                let around = pieces.iter().copied().reduce(join)?;
                Some(Self::between(*at, around.min.min(*at), around.max.max(*at)))
            }
            Self::Spot(view) => (!pieces.is_empty()).then(|| (**view).clone()),
        }
    }

    /// The rays of an eye inside a box that contains it.
    fn between(eye: DVec3, min: DVec3, max: DVec3) -> View {
        let sides = (0..3).flat_map(|i| {
            let axis = DVec3::AXES[i];
            [HalfSpace { normal: axis, offset: -min[i] }, HalfSpace { normal: -axis, offset: max[i] }]
        });
        View::around(eye, sides.collect())
    }
}

/// The smallest box around two.
pub(super) fn join(a: Block, b: Block) -> Block {
    Block { min: a.min.min(b.min), max: a.max.max(b.max) }
}

/// A box along some axes around a box, widened by [`LIGHT_EXTENT`].
fn widened(block: &Block, axes: &[DVec3; 3]) -> Block {
    let (middle, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    let greatest = block.min.abs().max(block.max.abs()).max_element();
    let middle = DVec3::from_array(axes.map(|axis| middle.dot(axis)));
    let radius = DVec3::from_array(axes.map(|axis| half.dot(axis.abs()))) + LIGHT_EXTENT * greatest;
    Block { min: middle - radius, max: middle + radius }
}
