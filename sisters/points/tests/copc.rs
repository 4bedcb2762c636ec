//! Cloud-optimized files (COPC 1.0): as the LAZ files that they are, all points from chunks of
//! different sizes; by levels and boxes; and with a hostile hierarchy.

mod octrees;

use std::io::Cursor;

use casca_points::PointCloud;
use casca_points::files::{FileError, Levels, Selection, read_selected_source, read_source};
use glam::DVec3;
use octrees::{HEADER, INFO_AT, Node, TREE, copc, entry, las, points};

fn parse(bytes: Vec<u8>) -> Result<PointCloud, FileError> {
    let mut all = PointCloud::default();
    read_source(Cursor::new(bytes), "test.copc.laz".into(), usize::MAX, |cloud| {
        all = cloud;
        Ok::<_, FileError>(())
    })?;
    Ok(all)
}

fn reported(bytes: &[u8], wanted: Selection) -> Result<(PointCloud, Vec<String>), FileError> {
    let mut all = PointCloud::default();
    let name = "test.copc.laz".into();
    let report = read_selected_source(Cursor::new(bytes.to_vec()), name, &wanted, usize::MAX, |cloud| {
        all = cloud;
        Ok::<_, FileError>(())
    })?;
    Ok((all, report.warnings))
}

fn selected(bytes: &[u8], wanted: Selection) -> Result<PointCloud, FileError> {
    reported(bytes, wanted).map(|(cloud, _)| cloud)
}

fn levels(levels: Levels) -> Selection {
    Selection { levels, within: None }
}

#[track_caller]
fn same(cloud: &PointCloud, expected: impl Iterator<Item = (DVec3, [u8; 3])>) {
    let expected: Vec<_> = expected.collect();
    assert_eq!(cloud.len(), expected.len());
    assert_eq!(cloud.colours.len(), expected.len());
    for (i, (p, c)) in cloud.world_positions().zip(&cloud.colours).enumerate() {
        assert!(p.distance(expected[i].0) < 1e-6 && *c == expected[i].1, "{i}: {p}");
    }
}

#[test]
fn all_points_of_all_nodes_are_read() {
    let nodes = |counts: &[usize]| -> Vec<Node> {
        (0..).zip(counts).map(|(i, &n)| ([i.min(1), i & 1, i >> 1 & 1, 0], n)).collect()
    };
    for nodes in [nodes(&[9]), nodes(&[50, 1, 200, 3]), nodes(&[1000, 70_000, 5])] {
        let file = copc(&nodes, false);
        same(&parse(file.clone()).unwrap(), points(&nodes));
        let cloud = selected(&file, levels(Levels::To(9))).unwrap();
        assert!(cloud == parse(file).unwrap(), "nodes and chunks have the same points");
    }
}

#[test]
fn levels_end_where_they_are_told() {
    for pages in [false, true] {
        let file = copc(&TREE, pages);
        let to = |level: i32| {
            points(&TREE)
                .zip(TREE.iter().flat_map(|n| vec![n.0[0]; n.1]))
                .filter_map(move |(point, own)| (own <= level).then_some(point))
        };
        for (wanted, level) in [
            (Levels::To(0), 0),
            (Levels::To(1), 1),
            (Levels::To(2), 2),
            (Levels::To(u32::MAX), 2),
            (Levels::Spacing(0.5), 0),
            (Levels::Spacing(0.4), 1),
            (Levels::Spacing(1e-9), 2),
            (Levels::Spacing(-1.0), 2),
            (Levels::All, 2),
        ] {
            same(&selected(&file, levels(wanted)).unwrap(), to(level));
        }
    }
}

#[test]
fn only_the_nodes_of_the_wanted_part_are_read() {
    let file = copc(&TREE, true);
    let damaged = |from: usize, to: usize| {
        let mut file = file.clone();
        file[from..to].fill(0xa5);
        file
    };
    // The chunks behind that of level 0, and the page of the child.
    let start = u32::from_le_bytes(std::array::from_fn(|i| file[96 + i])) as usize;
    let page = u64::from_le_bytes(std::array::from_fn(|i| file[INFO_AT + 40 + i])) as usize;
    let second = u64::from_le_bytes(std::array::from_fn(|i| file[page + 48 + i])) as usize;
    let table = u64::from_le_bytes(std::array::from_fn(|i| file[start + i])) as usize;
    let child = file.len() - 2 * 32;
    let coarse = selected(&file, levels(Levels::To(0))).unwrap();
    for (from, to) in [(second, table), (child, file.len())] {
        let file = damaged(from, to);
        assert!(selected(&file, levels(Levels::To(0))).unwrap() == coarse);
        let rest = reported(&file, levels(Levels::To(2)));
        assert!(rest.is_err() || rest.is_ok_and(|(_, warnings)| warnings.len() == 1));
    }
    let far = Some([DVec3::new(4.0, -9.0, -9.0), DVec3::splat(9.0)]);
    let wanted = Selection { within: far, ..Selection::default() };
    assert!(
        selected(&damaged(child, file.len()), wanted).unwrap() == selected(&file, wanted).unwrap(),
        "the page of the child lies outside of the box"
    );
}

#[test]
fn points_outside_of_the_box_are_left_out() {
    let boxes = [
        [DVec3::splat(-9.0), DVec3::splat(20.0)],
        [DVec3::ZERO, DVec3::new(4.0, 3.5, 2.0)],
        [DVec3::new(3.5, -0.5, -0.5), DVec3::new(3.5, 9.0, 9.0)],
        [DVec3::splat(3.0), DVec3::splat(2.0)],
        [DVec3::NAN, DVec3::splat(2.0)],
    ];
    for file in [copc(&TREE, true), las(&TREE, true), las(&TREE, false)] {
        for [low, high] in boxes {
            let wanted = Selection { within: Some([low, high]), ..Selection::default() };
            let inside = |p: &DVec3| p.cmpge(low).all() && p.cmple(high).all();
            same(&selected(&file, wanted).unwrap(), points(&TREE).filter(|(p, _)| inside(p)));
        }
    }
}

#[test]
fn files_without_levels_say_so() {
    for (file, name) in [(las(&TREE, true), "LAS"), (b"ply\n".to_vec(), "PLY"), (b"1\n".to_vec(), "surfel")] {
        let said = selected(&file, levels(Levels::To(3))).unwrap_err().to_string();
        assert_eq!(said, format!("test.copc.laz: {name} files have no levels, only COPC and EPT files do"));
    }
}

#[test]
fn a_hostile_hierarchy_is_refused() {
    let file = copc(&TREE, true);
    let page = u64::from_le_bytes(std::array::from_fn(|i| file[INFO_AT + 40 + i]));
    let refused = |at: usize, bytes: &[u8], reason: &str| {
        let mut file = file.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        let said = selected(&file, levels(Levels::To(5))).unwrap_err().to_string();
        assert!(said.contains(reason), "{said} / {reason}");
    };
    let first = page as usize;
    let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| file[at + i]));
    let (start, bytes) = (number(first + 16), number(first + 24) as i32);
    refused(INFO_AT + 40, &u64::MAX.to_le_bytes(), "a page of");
    refused(INFO_AT + 48, &(1_u64 << 40).to_le_bytes(), "a page of 1099511627776 bytes");
    refused(INFO_AT + 48, &33_u64.to_le_bytes(), "a page of 33 bytes");
    refused(INFO_AT + 24, &f64::NAN.to_le_bytes(), "a side of NaN");
    refused(first, &entry([0; 4], page, 32, -1), "refer to each other");
    refused(first, &entry([-1, 0, 0, 0], start, bytes, 50), "an entry of the node [-1, 0, 0, 0]");
    refused(first, &entry([0, 1, 0, 0], start, bytes, 50), "an entry of the node");
    refused(first, &entry([0; 4], u64::MAX - 9, bytes, 50), "50 points in");
    refused(first, &entry([0; 4], start, -1, 50), "50 points in");
    refused(first, &entry([0; 4], start, bytes, -2), "-2 points in");
    refused(first, &entry([0; 4], start, bytes, i32::MAX), "points, the header says 291");
    refused(first, &entry([1, 1, 0, 0], start, bytes, 50), "the node 1-1-0-0 comes twice");
}

#[test]
fn a_node_that_is_broken_is_left_out() {
    let file = copc(&TREE, true);
    let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| file[at + i]));
    let first = number(INFO_AT + 40) as usize;
    let (start, bytes) = (number(first + 16), number(first + 24) as i32);
    for (root, reason) in [
        (entry([0; 4], start, bytes, 49), "its chunk has 50 points, the hierarchy says 49; 49 of 290 points"),
        (entry([0; 4], start, 40, 50), "layers of"),
    ] {
        let mut file = file.clone();
        file[first..first + root.len()].copy_from_slice(&root);
        let (cloud, warnings) = reported(&file, levels(Levels::To(5))).unwrap();
        same(&cloud, points(&TREE[1..]));
        let [said] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(said.starts_with("test.copc.laz, node 0-0-0-0: ") && said.contains(reason), "{said}");
    }
}

#[test]
fn a_file_that_was_cut_is_refused() {
    let whole = copc(&TREE, true);
    let points = u32::from_le_bytes(std::array::from_fn(|i| whole[96 + i])) as usize;
    for end in [200, HEADER + 20, points - 1, points + 4, points + 60] {
        for wanted in [Levels::All, Levels::To(0)] {
            let said = selected(&whole[..end], levels(wanted)).unwrap_err().to_string();
            assert!(said.contains("test.copc.laz"), "{end}: {said}");
        }
    }
}
