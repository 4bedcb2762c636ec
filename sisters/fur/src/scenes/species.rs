//! A kind of animal in a field: generated, or of a file.

use crate::error::{Error, range};
use crate::mesh::{Image, Mesh};
use crate::skin::SkinBounds;
use casca::Aabb;
use glam::{Affine3A, Quat, Vec3};

use crate::scenes::animals::{Animal, Rig};
use crate::scenes::character::Character;
use crate::scenes::gait::Gait;

/// A kind of animal in a field: its meshes, its walk, and how large it is there.
#[derive(Debug, Clone)]
pub struct Species {
    levels: Vec<Mesh>,
    images: Vec<Image>,
    /// The box of the finest level: finding it takes a pass over its vertices.
    aabb: Aabb,
    rig: Option<Rig>,
    places: Places,
}

/// From the spaces of a species' meshes to where it stands: on the ground at 0, around the axis y,
/// looking along x, about a unit long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Places {
    /// From meshes at rest.
    pub(super) rest: Affine3A,
    /// From posed meshes.
    pub(super) posed: Affine3A,
    /// How much larger a length is after either.
    pub(super) scale: f32,
}

impl From<&Animal> for Species {
    fn from(animal: &Animal) -> Self {
        let aabb = animal.aabb();
        let place = Affine3A::from_translation(Vec3::Y * -aabb.min.y);
        let places = Places { rest: place, posed: place, scale: 1.0 };
        let (levels, rig) = (animal.levels().to_vec(), Some(animal.rig().clone()));
        Self { levels, images: Vec::new(), aabb, rig, places }
    }
}

impl Species {
    /// The species of a character. Its longest side is a unit, and it looks to where the first
    /// clip walks; along z, as glTF has it, if there is none or its feet stay where they are.
    /// It walks by that clip, at the pace at which feet on the ground stay there.
    ///
    /// # Errors
    /// Refuses a character without levels, weights that are not those of its levels, and what
    /// `casca_fur` refuses.
    pub fn of_character(character: &Character) -> Result<Self, Error> {
        let levels = character.levels.clone();
        let aabb = levels.first().ok_or(Error::Empty)?.aabb();
        let scale = (aabb.max - aabb.min).max_element().max(f32::MIN_POSITIVE).recip();
        let units = Affine3A::from_scale(Vec3::splat(scale));
        let moved = character.rig.as_ref().and_then(|rig| Some((rig, &rig.clips.first()?.1)));
        let mut gait = Gait::of_none(scale * aabb.min.y);
        let (mut rig, mut own) = (None, units);
        if let Some((of, walk)) = moved {
            let count = levels.len() as f64;
            range("the number of levels with weights", of.weights.len() as f64, count, count)?;
            own = units * of.place_at_rest(&levels[0])?.0;
            // All levels, since weights of other meshes are refused.
            let bounds = levels.iter().zip(&of.weights).map(|(mesh, weights)| SkinBounds::new(mesh, weights));
            let mut bounds = bounds.collect::<Result<Vec<SkinBounds>, Error>>()?;
            let coarsest = levels.len() - 1;
            gait = Gait::new((&levels[coarsest], &of.weights[coarsest]), &of.skeleton, walk, own);
            rig = Some(Rig {
                bounds: bounds.swap_remove(0),
                skeleton: of.skeleton.clone(),
                weights: of.weights.clone(),
                walk: walk.clone(),
                stride: gait.stride,
            });
        }
        let turn = Affine3A::from_quat(Quat::from_rotation_y(gait.ahead.z.atan2(gait.ahead.x)));
        let onto = |low: f32| turn * Affine3A::from_translation(Vec3::Y * -low);
        let places = Places { rest: onto(scale * aabb.min.y) * units, posed: onto(gait.low) * own, scale };
        Ok(Self { levels, images: character.images.clone(), aabb, rig, places })
    }

    /// The meshes, finest first; vertices of each are vertices of the finest.
    pub fn levels(&self) -> &[Mesh] {
        &self.levels
    }

    /// The images on which their vertices lie.
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// The box of the finest level, at rest.
    pub fn aabb(&self) -> Aabb {
        self.aabb
    }

    /// Half the diagonal of the box: the radius by which the thesis measures fur.
    pub fn radius(&self) -> f32 {
        (self.aabb.max - self.aabb.min).length() * 0.5
    }

    /// Its skeleton, weights and walk, if it can walk.
    pub fn rig(&self) -> Option<&Rig> {
        self.rig.as_ref()
    }

    pub(super) fn places(&self) -> &Places {
        &self.places
    }

    /// The rig of one that has to walk.
    pub(super) fn walker(&self) -> Result<&Rig, Error> {
        self.rig.as_ref().ok_or(Error::Still)
    }
}
