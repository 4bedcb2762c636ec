use crate::error::Error;
use crate::geometry::Shape;
use crate::id::ObjectId;
use crate::object::ObjectDesc;
use crate::scene::Scene;

/// An object of a map in a scene, as the `insert` of such objects gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The parts, with the occluders that they have while the object hides.
    parts: Vec<(ObjectId, Option<Shape>)>,
}

impl Placed {
    /// Adds all parts, with their occluders, or none.
    pub(crate) fn insert(
        scene: &mut Scene,
        parts: Vec<(Shape, Option<Shape>)>,
        user_data: u64,
    ) -> Result<Self, Error> {
        let mut placed = Self { parts: Vec::with_capacity(parts.len()) };
        for (bounds, occluder) in parts {
            let mut desc = ObjectDesc::fixed(bounds).user_data(user_data);
            if let Some(occluder) = &occluder {
                desc = desc.occluder(occluder.clone());
            }
            match scene.insert(desc) {
                Ok(id) => placed.parts.push((id, occluder)),
                Err(error) => {
                    placed.ids().try_for_each(|id| scene.remove(id))?;
                    return Err(error);
                }
            }
        }
        Ok(placed)
    }

    /// Its objects in the scene: more than one for a polygon that is not convex.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> {
        self.parts.iter().map(|(id, _)| *id)
    }

    /// Whether any of its parts hides: a wall, or a door that is closed. Costs a look at each part.
    ///
    /// # Errors
    /// [`Error::UnknownObject`] if a part was removed or belongs to another scene.
    pub fn is_closed(&self, scene: &Scene) -> Result<bool, Error> {
        let mut hides = false;
        for id in self.ids() {
            hides |= scene.occluder(id)?.is_some();
        }
        Ok(hides)
    }

    /// Closes or opens a door: all its parts hide, or none does. Walls are opened in the same way;
    /// objects that hide nothing do not change. Costs as [`Scene::set_occluder`] for each part.
    ///
    /// # Errors
    /// [`Error::UnknownObject`] if a part was removed or belongs to another scene. Nothing changes
    /// then.
    pub fn set_closed(&self, scene: &mut Scene, closed: bool) -> Result<(), Error> {
        self.parts.iter().try_for_each(|(id, _)| scene.bounds(*id).map(drop))?;
        for (id, occluder) in self.parts.iter().filter(|(_, occluder)| occluder.is_some()) {
            if scene.occluder(*id)?.is_some() != closed {
                scene.set_occluder(*id, occluder.clone().filter(|_| closed))?;
            }
        }
        Ok(())
    }
}
