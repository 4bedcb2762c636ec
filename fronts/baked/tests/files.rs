//! Files against maps of sets, and bytes that are no files.

use std::collections::{BTreeMap, BTreeSet};

use casca_baked::{Baked, Cells, ReadError, WriteError, Writer};
use proptest::prelude::*;

const OBJECTS: u32 = 300;

fn cells(dims: [u32; 3]) -> Cells {
    Cells { low: [-3.5, 0.25, 1e3], size: [1.0, 2.5, 0.1], dims, origin: [0.0; 3] }
}

/// A grid with sets that are alike in neighbouring cells.
fn levels() -> impl Strategy<Value = (Cells, BTreeMap<u32, BTreeSet<u32>>)> {
    let dims = [1..6u32, 1..4u32, 1..6u32];
    let cell = (any::<prop::sample::Index>(), prop::collection::btree_set(0..OBJECTS, 0..8), any::<bool>());
    (dims, prop::collection::btree_set(0..OBJECTS, 0..60), prop::collection::vec(cell, 0..40)).prop_map(
        |(dims, common, sets)| {
            let cells = cells(dims);
            let count = (dims[0] * dims[1] * dims[2]) as usize;
            let sets = sets.into_iter().map(|(cell, own, shares)| {
                let other: BTreeSet<u32> =
                    if shares { common.symmetric_difference(&own).copied().collect() } else { own };
                (cell.index(count) as u32, other)
            });
            (cells, sets.collect())
        },
    )
}

fn write(cells: Cells, sets: &BTreeMap<u32, BTreeSet<u32>>) -> Vec<u8> {
    let mut writer = Writer::new(cells, OBJECTS).unwrap();
    for (cell, set) in sets.iter().rev() {
        writer.put(*cell, &set.iter().copied().collect::<Vec<_>>()).unwrap();
    }
    writer.finish().unwrap()
}

fn with_checksum(bytes: &mut [u8]) {
    let at = bytes.len() - 4;
    let sum = crc32fast::hash(&bytes[..at]);
    bytes[at..].copy_from_slice(&sum.to_le_bytes());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn what_was_written_is_read((cells, sets) in levels()) {
        let bytes = write(cells, &sets);
        let baked = Baked::read(&bytes).unwrap();
        prop_assert_eq!((baked.cells(), baked.objects()), (&cells, OBJECTS));
        let distinct: BTreeSet<_> = sets.values().collect();
        prop_assert_eq!(baked.sets() as usize, distinct.len());
        for cell in 0..cells.dims.iter().product() {
            let set = baked.set(cell).map(|set| set.iter().collect::<BTreeSet<_>>());
            prop_assert_eq!(set.as_ref(), sets.get(&cell));
            if let (Some(set), Some(truth)) = (baked.set(cell), sets.get(&cell)) {
                prop_assert!(set.iter().is_sorted());
                prop_assert_eq!(set.iter().count(), truth.len());
                prop_assert!((0..OBJECTS).all(|object| set.contains(object) == truth.contains(&object)));
            }
        }
        prop_assert!(baked.set(cells.dims.iter().product()).is_none());
    }

    #[test]
    fn no_bytes_make_it_fail((cells, sets) in levels(), changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4), cut in any::<prop::sample::Index>(), resum in any::<bool>()) {
        let whole = write(cells, &sets);
        let short = &whole[..cut.index(whole.len())];
        prop_assert!(Baked::read(short).is_err());
        let mut bytes = whole.clone();
        for (at, byte) in &changes {
            bytes[at.index(whole.len())] = *byte;
        }
        if resum {
            with_checksum(&mut bytes);
        }
        match Baked::read(&bytes) {
            Err(_) => prop_assert!(bytes != whole),
            Ok(baked) => {
                prop_assert!(resum || bytes == whole);
                prop_assert!(each_is_a_set(&baked));
            }
        }
        // Without a check, sets may be wrong, but reading them ends.
        if let Ok(baked) = Baked::open(&bytes) {
            let count: u32 = baked.cells().dims.iter().product();
            (0..count.min(1000)).filter_map(|cell| baked.set(cell)).for_each(|set| _ = set.iter().count());
        }
    }

    #[test]
    fn a_place_is_in_its_cell(at in prop::array::uniform3(-0.1..1.1f64), edge in prop::array::uniform3(0..6), low in prop::array::uniform3(prop_oneof![-1e6..1e6f64, -0.5..0.5f64]), size in prop::array::uniform3(0.01..50.0f64)) {
        let dims = [7, 1000, 3];
        let cells = Cells { low, size, dims, origin: [0.0; 3] };
        // Some places lie on borders.
        let place: [f64; 3] = std::array::from_fn(|i| {
            let at = at[i] * f64::from(dims[i]);
            let border = low[i] + size[i] * at.round();
            match edge[i] {
                0 => border,
                1 => border.next_up(),
                2 => border.next_down(),
                _ => low[i] + size[i] * at,
            }
        });
        if let Some(cell) = cells.at(place) {
            let (least, most) = cells.room(cell).unwrap();
            prop_assert!((0..3).all(|i| least[i] <= place[i] && place[i] <= most[i]));
            let middle: [f64; 3] = std::array::from_fn(|i| (least[i] + most[i]) / 2.0);
            prop_assert_eq!(cells.at(middle), Some(cell));
        } else {
            prop_assert!((0..3).any(|i| !(0.001..0.999).contains(&at[i]) || edge[i] < 3));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn from_cell_to_cell_boxes_see_what_a_place_in_them_sees((cells, sets) in levels(), places in prop::collection::vec(prop::array::uniform3((-0.1..1.1f64, any::<bool>())), 6)) {
        let count: u32 = cells.dims.iter().product();
        let mut writer = Writer::cell_to_cell(cells, &sets.keys().copied().collect()).unwrap();
        for (cell, set) in &sets {
            writer.put(*cell, &set.iter().copied().filter(|seen| *seen < count).collect::<Vec<_>>()).unwrap();
        }
        let bytes = writer.finish().unwrap();
        let baked = Baked::read(&bytes).unwrap();
        prop_assert!(baked.is_cell_to_cell() && Writer::like(&baked).unwrap().is_empty());
        // Half of all coordinates lie on borders.
        let place = |share: [(f64, bool); 3]| -> [f64; 3] {
            std::array::from_fn(|i| {
                let at = share[i].0 * f64::from(cells.dims[i]);
                cells.low[i] + if share[i].1 { at.round() } else { at } * cells.size[i]
            })
        };
        let span = |a: [f64; 3], b: [f64; 3]| -> [[f64; 3]; 2] {
            [std::array::from_fn(|i| a[i].min(b[i])), std::array::from_fn(|i| a[i].max(b[i]))]
        };
        let at: Vec<[f64; 3]> = places.into_iter().map(place).collect();
        let (eyes, target) = (span(at[0], at[1]), span(at[2], at[3]));
        // A place in each box; some lie at its corners.
        let inside = |[low, high]: [[f64; 3]; 2], by: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| by[i].clamp(low[i], high[i]))
        };
        let (eye, point) = (inside(eyes, at[4]), inside(target, at[5]));
        // An eye on a border sees what those on either side of it see.
        let sees = |by: f64| {
            let beside = |k: u32| -> [f64; 3] {
                std::array::from_fn(|i| eye[i] + if k >> i & 1 == 0 { -by } else { by })
            };
            let from: BTreeSet<u32> = (0..8).map(beside).chain([eye]).filter_map(|eye| cells.at(eye)).collect();
            match (cells.at(eye), cells.at(point)) {
                (Some(_), Some(to)) if sets.contains_key(&to) => {
                    from.iter().any(|from| sets.get(from).is_none_or(|set| set.contains(&to)))
                }
                _ => true,
            }
        };
        let may_see = baked.may_see([eye; 2], [point; 2]);
        prop_assert!(may_see >= sees(1e-9) && may_see <= sees(1e-3), "{eye:?} {point:?}");
        if let (Some(set), Some(to)) = (baked.set_at(eye), cells.at(point).filter(|to| sets.contains_key(to))) {
            prop_assert!(set.contains(to) == may_see, "{eye:?} {point:?}");
        }
        prop_assert!(!sees(1e-9) || baked.may_see(eyes, target));
        prop_assert!(baked.may_see([eyes[1], eyes[0]], target) || eyes[0] == eyes[1]);
        if let Some(all) = cells.of_box(eyes[0], eyes[1]) {
            let numbers: Vec<u32> = cells.numbers(all).collect();
            prop_assert!(numbers.contains(&cells.at(eye).unwrap()));
            let near = cells.of_eyes(eyes[0], eyes[1]).unwrap();
            prop_assert!(numbers.iter().all(|cell| cells.numbers(near).any(|one| one == *cell)));
            prop_assert!(numbers.is_sorted() && numbers.len() as u64 == all.count());
        }
    }
}

/// Whether all sets that cells have are ascending lists of objects.
fn each_is_a_set(baked: &Baked) -> bool {
    let count: u32 = baked.cells().dims.iter().product();
    (0..count.min(1000)).filter_map(|cell| baked.set(cell)).all(|set| {
        let objects: Vec<u32> = set.iter().collect();
        objects.windows(2).all(|pair| pair[0] < pair[1])
            && objects.iter().all(|object| *object < baked.objects())
    })
}

#[test]
fn neighbours_are_stored_by_what_differs() {
    let cells = cells([50, 1, 1]);
    let all: BTreeSet<u32> = (0..OBJECTS).step_by(2).collect();
    let sets: BTreeMap<u32, BTreeSet<u32>> = (0..50)
        .map(|cell| (cell, all.iter().copied().filter(|object| object % 50 != cell).collect()))
        .collect();
    let bytes = write(cells, &sets);
    // One in four has a list of its own.
    assert!(bytes.len() < 50 * 150 / 2, "{} bytes", bytes.len());
    let same: BTreeMap<u32, BTreeSet<u32>> = (0..50).map(|cell| (cell, all.clone())).collect();
    assert_eq!(Baked::read(&write(cells, &same)).unwrap().sets(), 1);
}

#[test]
fn refusals_name_the_reason() {
    let bytes = write(cells([2, 1, 1]), &BTreeMap::from([(0, BTreeSet::from([1, 5]))]));
    let read = |bytes: &[u8]| Baked::read(bytes).map(|_| ());
    assert_eq!(read(b""), Err(ReadError::NotBaked));
    assert_eq!(read(b"CASCAPVT and more"), Err(ReadError::NotBaked));
    let given = bytes.len() as u64 - 1;
    assert_eq!(read(&bytes[..bytes.len() - 1]), Err(ReadError::Length { needed: given + 1, given }));
    let mut other = bytes.clone();
    other[8] = 1;
    assert_eq!(read(&other), Err(ReadError::Version(1)));
    // Neither another kind, nor cells where the grid has 2 of them.
    for kind in [2, 1] {
        let mut other = bytes.clone();
        other[12] = kind;
        with_checksum(&mut other);
        assert_eq!(read(&other), Err(ReadError::Kind(kind.into())));
    }
    let mut other = bytes.clone();
    let body = other.len() - 5;
    other[body] ^= 1;
    assert_eq!(read(&other), Err(ReadError::Checksum));
    let mut other = bytes.clone();
    // The last number of the only set: an object that is not there.
    other[body] = 0xff;
    with_checksum(&mut other);
    assert_eq!(read(&other), Err(ReadError::Set(0)));
    let mut other = bytes.clone();
    other[112] = 1;
    with_checksum(&mut other);
    assert_eq!(read(&other), Err(ReadError::Cell(0)));
    let mut other = bytes.clone();
    // There are as many objects as the greatest number in a set.
    other[16..20].copy_from_slice(&5u32.to_le_bytes());
    with_checksum(&mut other);
    assert_eq!(read(&other), Err(ReadError::Set(0)));
    let baked = Baked::read(&bytes).unwrap();
    assert!(baked.set_at([-3.5, 0.25, 1e3]).is_some() && baked.set_at([-3.5, 2.75, 1e3]).is_none());
    let four = cells([2, 2, 1]);
    assert_eq!(four.at([-3.0, 0.3, 1e3]), Some(0));
    assert_eq!(four.at([-1.5, 0.3, 1e3]), None, "no cell of the next row");
    for at in [24, 48, 72, 84] {
        let mut other = bytes.clone();
        other[at..at + 8].fill(0xff);
        with_checksum(&mut other);
        assert_eq!(read(&other), Err(ReadError::Cells), "byte {at}");
    }
    let wrong = Cells { size: [1.0, f64::NAN, 1.0], ..cells([1, 1, 1]) };
    for cells in [wrong, cells([0, 1, 1]), cells([1 << 22, 1, 1]), cells([1 << 11, 1 << 11, 1 << 11])] {
        assert_eq!(Writer::new(cells, 1).map(|_| ()), Err(WriteError::Cells));
    }
    let mut writer = Writer::new(cells([2, 1, 1]), 3).unwrap();
    assert_eq!(writer.put(2, &[]), Err(WriteError::Cell(2)));
    for (set, index) in [(&[0, 2, 2][..], 2), (&[1, 0], 1), (&[0, 1, 2, 3], 3), (&[7, 1], 0)] {
        assert_eq!(writer.put(0, set), Err(WriteError::Objects { index }));
    }
    assert!(writer.is_empty());
}
