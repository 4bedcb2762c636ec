//! The options of the cell method.

use crate::cell::Hiding;
use crate::error::Error;

/// How the cell method finds the cells that occluders hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Fusion {
    /// All rows and columns of cells that block, with exact masks of directions: hides most, and
    /// costs least.
    #[default]
    Masks,
    /// As in the thesis, section 3.3.4: each opaque cell in sight grows to a row or a column, and
    /// hides the cells behind it one by one. For comparisons: it costs all rows of the grid for
    /// each opaque cell in sight.
    Straight,
    /// As [`Fusion::Straight`], with a second arm round the corner that is nearest to the viewer.
    LShaped,
}

/// The options of [`Method::Cell`](crate::Method::Cell).
///
/// ```
/// use casca_plane::{CellOptions, Disc, GridSpec, Method, ObjectDesc, Query, Rect, Scene, View};
/// use glam::{UVec2, Vec2};
///
/// # fn main() -> Result<(), casca_plane::Error> {
/// let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims: UVec2::splat(64) })?;
/// let wall = Rect::new(Vec2::new(30.0, 0.0), Vec2::new(33.0, 64.0));
/// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let mut guard = Disc::new(Vec2::new(48.5, 30.5), 0.4);
/// let guard_id = scene.insert(ObjectDesc::dynamic(guard).max_speed(3.0).reported_on_expiry())?;
///
/// let mut query = Query::with_method(Method::Cell)?;
/// query.set_cell_options(CellOptions::new().min_angle(0.01))?;
/// let mut reports = 0;
/// for frame in 0..120 {
///     guard.center.y += 2.0 / 60.0;
///     // While the guard is hidden, its motion costs nothing until its volume expires.
///     if scene.begin_frame(f64::from(frame) / 60.0)?.contains(&guard_id) {
///         scene.update(guard_id, guard, None)?;
///         reports += 1;
///     }
///     let pvs = query.run(&scene, &View::all_round(Vec2::new(10.5, 30.5))?);
///     assert!(!pvs.contains(guard_id));
///     scene.end_frame([query.pvs()])?;
/// }
/// assert!(reports < 5);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CellOptions {
    /// How cells hide others.
    pub fusion: Fusion,
    /// Occluders that seem smaller than this hide nothing: an estimate of their angle in radians,
    /// from 0 to π (Coorg & Teller 1997). 0 leaves out none. It saves time with
    /// [`Fusion::Straight`] and [`Fusion::LShaped`], which set each hidden cell. With
    /// [`Fusion::Masks`] it saves little; occluders that fuse there count as one.
    pub min_angle: f32,
}

impl CellOptions {
    /// The options that hide most.
    pub const fn new() -> Self {
        Self { fusion: Fusion::Masks, min_angle: 0.0 }
    }

    /// Chooses how cells hide others.
    #[must_use]
    pub const fn fusion(mut self, fusion: Fusion) -> Self {
        self.fusion = fusion;
        self
    }

    /// Leaves out occluders that seem smaller than an angle in radians.
    #[must_use]
    pub const fn min_angle(mut self, min_angle: f32) -> Self {
        self.min_angle = min_angle;
        self
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let most = std::f32::consts::PI;
        if (0.0..=most).contains(&self.min_angle) {
            return Ok(());
        }
        let (what, value) = ("the least angle of occluders in radians", self.min_angle.into());
        Err(Error::Setting { what, value, min: 0.0, max: most.into() })
    }

    pub(super) fn hiding(&self) -> Hiding {
        let least_angle = f64::from(self.min_angle);
        match self.fusion {
            Fusion::Masks => Hiding::Rows { narrowest: least_angle },
            Fusion::Straight => Hiding::Caps { l_shaped: false, least_angle },
            Fusion::LShaped => Hiding::Caps { l_shaped: true, least_angle },
        }
    }
}
