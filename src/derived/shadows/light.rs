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

/// Where the rays of a light start, and which way they go.
#[derive(Debug)]
enum Rays {
    Sun {
        /// Axes at right angles, of which the last runs along the light.
        axes: [DVec3; 3],
    },
    Bulb {
        at: DVec3,
        /// Its range, widened for rounding.
        farthest: f64,
    },
    Spot(Box<View>),
}

impl Lamp {
    pub(super) fn new(light: &Light) -> Result<Self, Error> {
        let rays = match &light.kind {
            LightKind::Directional(direction) => {
                const WHAT: &str = "the direction of the light";
                finite3(WHAT, *direction)?;
                let along = direction.as_dvec3().try_normalize().ok_or(Error::NoDirection { what: WHAT })?;
                let (right, up) = along.any_orthonormal_pair();
                Rays::Sun { axes: [right, up, along] }
            }
            LightKind::Point { position, range } => {
                finite3("the position of the light", *position)?;
                let range = f64::from(*range);
                if range.is_nan() || range < 0.0 {
                    let what = "the range of the light";
                    return Err(Error::Setting { what, value: range, min: 0.0, max: f64::INFINITY });
                }
                let at = position.as_dvec3();
                Rays::Bulb { at, farthest: range + LIGHT_EXTENT * (range + at.abs().max_element()) }
            }
            LightKind::Spot(view) => Rays::Spot(view.clone()),
        };
        Ok(Self { rays, layers: light.layers })
    }

    /// The part of a box that the light may reach; `None` if it reaches none of it.
    pub(super) fn lit(&self, block: &Block) -> Option<Block> {
        match &self.rays {
            Rays::Sun { .. } => Some(*block),
            &Rays::Bulb { at, farthest } => {
                if block.distance_from(at) > farthest {
                    return None;
                }
                let lit = block.intersection(&Block { min: at - farthest, max: at + farthest });
                // In doubt (NaN), it reaches all of it.
                Some(if lit.min.cmple(lit.max).all() { lit } else { *block })
            }
            Rays::Spot(view) => view.may_see_volume(block).then_some(*block),
        }
    }

    /// All that the light may reach, of objects on its layers.
    pub(super) fn whole_view(&self) -> View {
        let view = match &self.rays {
            Rays::Sun { axes } => View::parallel(axes[2], SmallVec::new()),
            &Rays::Bulb { at, farthest } if farthest.is_finite() => between(at, at - farthest, at + farthest),
            Rays::Bulb { at, .. } => View::around(*at, SmallVec::new()),
            Rays::Spot(view) => (**view).clone(),
        };
        view.with_layers(self.layers)
    }

    /// A view of objects on its layers with all rays of the light to some boxes; `None` if there
    /// are no boxes.
    pub(super) fn view_of(&self, pieces: &[Block]) -> Option<View> {
        let view = match &self.rays {
            Rays::Sun { axes } => {
                let along = axes[2];
                let extent = pieces.iter().map(|piece| widened(piece, axes)).reduce(Block::join)?;
                let mut planes: SmallVec<[HalfSpace; 6]> = SmallVec::new();
                for (axis, min, max) in
                    [(axes[0], extent.min.x, extent.max.x), (axes[1], extent.min.y, extent.max.y)]
                {
                    planes.push(HalfSpace { normal: axis, offset: -min });
                    planes.push(HalfSpace { normal: -axis, offset: max });
                }
                planes.push(HalfSpace { normal: -along, offset: extent.max.z });
                View::parallel(along, planes)
            }
            Rays::Bulb { at, .. } => {
                let around = pieces.iter().copied().reduce(Block::join)?;
                between(*at, around.min.min(*at), around.max.max(*at))
            }
            Rays::Spot(_) if pieces.is_empty() => return None,
            Rays::Spot(view) => (**view).clone(),
        };
        Some(view.with_layers(self.layers))
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

/// A box along some axes around a box, widened by [`LIGHT_EXTENT`].
fn widened(block: &Block, axes: &[DVec3; 3]) -> Block {
    let (middle, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    let greatest = block.min.abs().max(block.max.abs()).max_element();
    let middle = DVec3::from_array(axes.map(|axis| middle.dot(axis)));
    let radius = DVec3::from_array(axes.map(|axis| half.dot(axis.abs()))) + LIGHT_EXTENT * greatest;
    Block { min: middle - radius, max: middle + radius }
}
