//! Sets of objects in few bytes, for networks: whole sets, and the differences between two.
//!
//! | bytes | content |
//! | --- | --- |
//! | 1 | version, 1 |
//! | 1 | 0: a whole set, 1: a difference |
//! | 4 | of a difference only: digest of the set that it starts from |
//! | any | of a difference only: how many objects leave, and the place of each in that set, less that of the one before and 1 |
//! | any | how many objects follow or enter, and of each, in the order of their indices: twice its index less that of the one before and 1, and 1 more if its generation follows; that generation |
//! | 4 | digest of the set that is meant |
//!
//! Numbers without a size have 7 bits a byte, lowest first, and the eighth bit says that more
//! follow. All others are little endian. The first index and the first place have none before them,
//! and are given as they are. A digest is FNV-1a of the keys, of which the halves are added modulo
//! two: it finds accidents, not intent.

use std::collections::BTreeMap;

use crate::error::KeySetError;
use crate::pvs::Pvs;

const VERSION: u8 = 1;
const WHOLE: u8 = 0;
const DIFFERENCE: u8 = 1;

/// A set of objects by their keys ([`crate::Scene::key`]), to be sent and received: whole, or as
/// the difference to a set that the receiver has. Most objects take one byte, and those that stay
/// take none.
///
/// Keys leave out the scene: sender and receiver must mean the same one, such as a server and
/// clients that know its objects by these keys. The order of a [`Pvs`] is not kept.
///
/// ```
/// use casca::{GridSpec, KeySet, ObjectDesc, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut scene = Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(16) })?;
/// let mut query = Query::new();
/// let view = View::omnidirectional(Vec3::splat(9.5))?;
///
/// scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(4.0), 1.0)))?;
/// let first = KeySet::of(query.run(&scene, &view));
/// let mut client = KeySet::decode(&first.encode())?;
///
/// let late = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(12.0), 1.0)))?;
/// let second = KeySet::of(query.run(&scene, &view));
/// let message = second.encode_since(&first);
/// client.apply(&message)?;
/// assert!(client == second && client.contains(scene.key(late)?));
/// assert_eq!(message.len(), 13);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct KeySet {
    /// Index and generation of each object, in order. No index comes twice.
    entries: Vec<(u32, u32)>,
}

impl KeySet {
    /// The objects of a result.
    pub fn of(pvs: &Pvs) -> Self {
        let mut entries: Vec<(u32, u32)> = pvs.iter().map(|id| (id.slot().get(), id.generation())).collect();
        entries.sort_unstable();
        Self { entries }
    }

    /// How many objects there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Whether an object is among them, by its key. Costs a binary search.
    pub fn contains(&self, key: u64) -> bool {
        self.entries.binary_search(&split(key)).is_ok()
    }

    /// The keys, in the order of their indices.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.entries.iter().map(|&(index, generation)| u64::from(generation) << 32 | u64::from(index))
    }

    /// The whole set in bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = vec![VERSION, WHOLE];
        put_entries(&self.entries, &mut out);
        out.extend(self.digest().to_le_bytes());
        out
    }

    /// The difference to a set that the receiver has, in bytes. Costs both sets.
    pub fn encode_since(&self, base: &Self) -> Vec<u8> {
        let mut out = vec![VERSION, DIFFERENCE];
        out.extend(base.digest().to_le_bytes());
        let leave: Vec<u32> = (0u32..)
            .zip(&base.entries)
            .filter(|(_, entry)| self.entries.binary_search(entry).is_err())
            .map(|(place, _)| place)
            .collect();
        put(leave.len() as u64, &mut out);
        let mut next = 0;
        for place in leave {
            put(u64::from(place - next), &mut out);
            next = place + 1;
        }
        let enter = self.entries.iter().copied();
        let enter: Vec<_> = enter.filter(|entry| base.entries.binary_search(entry).is_err()).collect();
        put_entries(&enter, &mut out);
        out.extend(self.digest().to_le_bytes());
        out
    }

    /// A whole set from its bytes. Takes memory for objects that are there only.
    ///
    /// # Errors
    /// Refuses bytes that are no set, and those of a difference, which [`KeySet::apply`] takes.
    pub fn decode(bytes: &[u8]) -> Result<Self, KeySetError> {
        let mut set = Self::default();
        match bytes.get(1) {
            Some(&DIFFERENCE) if bytes[0] == VERSION => Err(KeySetError::NotWhole),
            _ => set.apply(bytes).map(|()| set),
        }
    }

    /// Becomes the set that was encoded: as a whole, or as the difference to this set.
    ///
    /// # Errors
    /// Refuses bytes that are neither, and differences to another set ([`KeySetError::Base`]: ask
    /// for the whole set then). The set is left as it was.
    pub fn apply(&mut self, bytes: &[u8]) -> Result<(), KeySetError> {
        let mut input = Input { bytes, at: 0 };
        let version = input.byte()?;
        if version != VERSION {
            return Err(KeySetError::Version { found: version, known: VERSION });
        }
        let next = match input.byte()? {
            WHOLE => Self { entries: input.entries()? },
            DIFFERENCE => self.changed(&mut input)?,
            kind => return Err(KeySetError::Kind(kind)),
        };
        let (stored, computed) = (input.digest()?, next.digest());
        if stored != computed {
            return Err(KeySetError::Digest { stored, computed });
        }
        match bytes.len() - input.at {
            0 => {
                *self = next;
                Ok(())
            }
            rest => Err(KeySetError::Trailing(rest)),
        }
    }

    /// The set with the changes of a difference.
    fn changed(&self, input: &mut Input) -> Result<Self, KeySetError> {
        let (base, own) = (input.digest()?, self.digest());
        if base != own {
            return Err(KeySetError::Base { base, own });
        }
        let mut stay = self.entries.as_slice();
        let mut entries = Vec::new();
        for _ in 0..input.number()? {
            let before = usize::try_from(input.number()?).ok().filter(|&before| before < stay.len());
            let before = before.ok_or(KeySetError::Place { objects: self.entries.len() })?;
            entries.extend_from_slice(&stay[..before]);
            stay = &stay[before + 1..];
        }
        entries.extend_from_slice(stay);
        entries.extend(input.entries()?);
        entries.sort_unstable();
        match entries.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(KeySetError::Twice { index: pair[0].0 }),
            None => Ok(Self { entries }),
        }
    }

    fn digest(&self) -> u32 {
        let mut sum = 0xcbf2_9ce4_8422_2325u64;
        for byte in self.iter().flat_map(u64::to_le_bytes) {
            sum = (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        (sum ^ sum >> 32) as u32
    }
}

/// The index and the generation that a key consists of.
fn split(key: u64) -> (u32, u32) {
    (key as u32, (key >> 32) as u32)
}

/// The set of some keys, such as those of several results. Of keys with one index, all but one name
/// objects that are gone: the one of the latest object counts.
impl FromIterator<u64> for KeySet {
    fn from_iter<I: IntoIterator<Item = u64>>(keys: I) -> Self {
        let mut latest = BTreeMap::new();
        for (index, generation) in keys.into_iter().map(split) {
            let known = latest.entry(index).or_insert(generation);
            *known = generation.max(*known);
        }
        Self { entries: latest.into_iter().collect() }
    }
}

/// Appends a number, 7 bits a byte.
fn put(mut number: u64, out: &mut Vec<u8>) {
    while number > 0x7f {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn put_entries(entries: &[(u32, u32)], out: &mut Vec<u8>) {
    put(entries.len() as u64, out);
    let mut next = 0;
    for &(index, generation) in entries {
        put(((u64::from(index) - next) << 1) | u64::from(generation > 0), out);
        if generation > 0 {
            put(generation.into(), out);
        }
        next = u64::from(index) + 1;
    }
}

/// Bytes that are read.
struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Input<'_> {
    fn byte(&mut self) -> Result<u8, KeySetError> {
        let byte = *self.bytes.get(self.at).ok_or(KeySetError::Truncated(self.bytes.len()))?;
        self.at += 1;
        Ok(byte)
    }

    fn digest(&mut self) -> Result<u32, KeySetError> {
        let mut bytes = [0; 4];
        for byte in &mut bytes {
            *byte = self.byte()?;
        }
        Ok(u32::from_le_bytes(bytes))
    }

    fn number(&mut self) -> Result<u64, KeySetError> {
        let (at, mut number) = (self.at, 0);
        for shift in (0..u64::BITS).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if bits << shift >> shift != bits {
                break;
            }
            number |= bits << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(KeySetError::Number { at })
    }

    fn entries(&mut self) -> Result<Vec<(u32, u32)>, KeySetError> {
        let mut entries = Vec::new();
        let mut next = 0u64;
        for _ in 0..self.number()? {
            let at = self.at;
            let number = self.number()?;
            let index = u32::try_from(next.saturating_add(number >> 1));
            let generation = if number & 1 == 1 { self.number()? } else { 0 };
            let (Ok(index), Ok(generation)) = (index, u32::try_from(generation)) else {
                return Err(KeySetError::Number { at });
            };
            entries.push((index, generation));
            next = u64::from(index) + 1;
        }
        Ok(entries)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn keys() -> impl Strategy<Value = KeySet> {
        let near = (0u32..400, prop_oneof![4 => Just(0u32), 1 => 1u32..300]);
        let any = (any::<u32>(), any::<u32>());
        let key = prop_oneof![9 => near, 1 => any].prop_map(|(i, g)| u64::from(g) << 32 | u64::from(i));
        prop::collection::vec(key, 0..200).prop_map(|keys| keys.into_iter().collect())
    }

    proptest! {
        #[test]
        fn sets_arrive_as_they_were_sent((old, new) in (keys(), keys())) {
            prop_assert_eq!(&KeySet::decode(&new.encode()).unwrap(), &new);
            let message = new.encode_since(&old);
            let mut receiver = old.clone();
            receiver.apply(&message).unwrap();
            prop_assert_eq!(&receiver, &new);
            prop_assert!(new.iter().all(|key| receiver.contains(key)));
            // The difference to itself names no object.
            prop_assert_eq!(new.encode_since(&new).len(), 12);
            if old != new {
                let mut other = new.clone();
                let refused = other.apply(&message);
                prop_assert!(matches!(refused, Err(KeySetError::Base { .. })), "{:?}", refused);
                prop_assert_eq!(other, new);
            }
        }

        #[test]
        fn damaged_bytes_are_refused_or_another_set((old, new) in (keys(), keys()), at in any::<usize>(), with in any::<u8>()) {
            for mut bytes in [new.encode(), new.encode_since(&old)] {
                let at = at % bytes.len();
                for end in [at, bytes.len() - 1] {
                    prop_assert!(old.clone().apply(&bytes[..end]).is_err());
                }
                let same = bytes[at] == with;
                bytes[at] = with;
                let mut receiver = old.clone();
                let result = receiver.apply(&bytes);
                prop_assert!(same || result.is_err(), "a digest finds each change of a byte");
                prop_assert!(same || receiver == old);
                bytes.push(0);
                prop_assert!(receiver.apply(&bytes).is_err());
            }
        }

        #[test]
        fn any_bytes_are_read_without_a_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..60), kind in 0u8..2) {
            let _ = KeySet::decode(&bytes);
            if let [version, second, ..] = bytes.as_mut_slice() {
                (*version, *second) = (VERSION, kind);
            }
            let mut set: KeySet = (0..20).collect();
            let _ = set.apply(&bytes);
        }
    }

    #[test]
    fn most_objects_take_a_byte() {
        let all: KeySet = (0..1000u64).map(|i| 3 * i).collect();
        assert_eq!(all.encode().len(), 2 + 2 + 1000 + 4);
        let some: KeySet = (0..1000u64).filter(|i| i % 100 != 7).map(|i| 3 * i).collect();
        assert!(some.encode_since(&all).len() < 2 + 4 + 1 + 10 * 2 + 1 + 4);
        assert!(KeySet::default().is_empty() && all.len() == 1000);
    }

    #[test]
    fn errors_say_what_is_wrong() {
        let set: KeySet = [5, 9].into_iter().collect();
        let whole = set.encode();
        let apply = |change: &dyn Fn(&mut Vec<u8>)| {
            let mut bytes = whole.clone();
            change(&mut bytes);
            KeySet::decode(&bytes).unwrap_err()
        };
        assert_eq!(apply(&|b| b[0] = 2), KeySetError::Version { found: 2, known: 1 });
        assert_eq!(apply(&|b| b[1] = 7), KeySetError::Kind(7));
        assert_eq!(apply(&|b| b.truncate(4)), KeySetError::Truncated(4));
        assert_eq!(apply(&|b| b.push(1)), KeySetError::Trailing(1));
        assert!(matches!(apply(&|b| b[3] = 12), KeySetError::Digest { .. }));
        assert_eq!(KeySet::decode(&set.encode_since(&set)), Err(KeySetError::NotWhole));
        // 2^32 or more is no index, and more than 64 bits are no number.
        let far = [vec![VERSION, WHOLE, 1, 0xfe], vec![0xff; 8], vec![1]].concat();
        assert_eq!(KeySet::decode(&far), Err(KeySetError::Number { at: 3 }));
        let long = [vec![VERSION, WHOLE], vec![0xff; 12]].concat();
        assert_eq!(KeySet::decode(&long), Err(KeySetError::Number { at: 2 }));
        let mut twice = vec![VERSION, DIFFERENCE];
        twice.extend(set.digest().to_le_bytes());
        twice.extend([0, 1, 5 << 1 | 1, 3]);
        assert_eq!(set.clone().apply(&twice), Err(KeySetError::Twice { index: 5 }));
        let mut absent = vec![VERSION, DIFFERENCE];
        absent.extend(set.digest().to_le_bytes());
        absent.extend([1, 2, 0]);
        assert_eq!(set.clone().apply(&absent), Err(KeySetError::Place { objects: 2 }));
    }
}
