//! The numbers that the application gives objects, apart from them: most scenes have none.

use casca_slots::Slot;

/// By slot, up to the last one with a number that is not 0.
#[derive(Debug, Clone, Default)]
pub(super) struct UserData(Vec<u64>);

impl UserData {
    /// The number of the object in a slot.
    pub(super) fn get(&self, slot: Slot) -> u64 {
        self.0.get(slot.index()).copied().unwrap_or(0)
    }

    /// Sets the number of the object in a slot.
    pub(super) fn set(&mut self, slot: Slot, number: u64) {
        match self.0.get_mut(slot.index()) {
            Some(own) => *own = number,
            None if number == 0 => {}
            None => {
                self.0.resize(slot.index(), 0);
                self.0.push(number);
            }
        }
    }

    /// Bytes on the heap.
    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::geometry::Sphere;
    use crate::object::ObjectDesc;
    use crate::scene::Scene;

    #[test]
    fn numbers_stay_with_their_objects() {
        let mut scene = Scene::new(1.0).unwrap();
        let desc = || ObjectDesc::fixed(Sphere::new(Vec3::splat(4.0), 1.0));
        let [plain, first, second] = [0, 7, 8].map(|n| scene.insert(desc().user_data(n)).unwrap());
        assert_eq!([plain, first, second].map(|id| scene.user_data(id)), [Ok(0), Ok(7), Ok(8)]);
        let copy = scene.clone();
        scene.set_user_data(plain, 3).unwrap();
        scene.remove(first).unwrap();
        // It comes to the same slot.
        let next = scene.insert(desc()).unwrap();
        assert_eq!(next.slot(), first.slot());
        assert_eq!([plain, next, second].map(|id| scene.user_data(id)), [Ok(3), Ok(0), Ok(8)]);
        assert_eq!(scene.iter().map(|(_, object)| object.user_data()).collect::<Vec<_>>(), [3, 0, 8]);
        assert_eq!([plain, first, second].map(|id| copy.user_data(id)), [Ok(0), Ok(7), Ok(8)]);
    }
}
