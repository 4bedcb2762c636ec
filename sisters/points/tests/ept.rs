//! Entwine Point Tiles: folders with a LAZ file for each node of an octree.

mod octrees;

use std::fs;
use std::path::Path;

use casca_points::PointCloud;
use casca_points::files::{FileError, Levels, Selection, read, read_selected, read_source};
use glam::DVec3;
use octrees::{LOW, Node, SIDE, SPACING, TREE, las, points};

#[path = "../../../tests/damage/mod.rs"]
mod damage;

const DESCRIPTION: &str = "ept.json";
const ROOT: &str = "ept-hierarchy/0-0-0-0.json";
const CHILD: &str = "ept-hierarchy/1-0-0-0.json";

fn name([level, x, y, z]: [i32; 4]) -> String {
    format!("{level}-{x}-{y}-{z}")
}

/// The points of nodes, level by level.
fn sorted(finest: i32) -> Vec<Node> {
    let mut nodes: Vec<Node> = TREE.into_iter().filter(|node| node.0[0] <= finest).collect();
    nodes.sort_by_key(|node| node.0);
    nodes
}

/// Writes the tree as tiles, its hierarchy in two files.
fn write(folder: &Path) {
    for part in ["ept-data", "ept-hierarchy"] {
        fs::create_dir_all(folder.join(part)).unwrap();
    }
    let high = LOW + SIDE;
    let description = format!(
        r#"{{"bounds": [{LOW}, {LOW}, {LOW}, {high}, {high}, {high}], "dataType": "laszip", "points": 291,
        "schema": [{{"name": "X", "type": "signed", "size": 4, "scale": 0.001, "offset": 0}}],
        "span": {}, "version": "1.0.0"}}"#,
        SIDE / SPACING
    );
    fs::write(folder.join(DESCRIPTION), description).unwrap();
    let (mut root, mut child) = (vec![format!("\"{}\": -1", name([1, 0, 0, 0]))], Vec::new());
    for node in TREE {
        let ([level, x, y, z], count) = node;
        let below = level > 0 && [x, y, z].iter().all(|i| i >> (level - 1) == 0);
        let page = if below { &mut child } else { &mut root };
        page.push(format!("\"{}\": {count}", name(node.0)));
        if count > 0 {
            let tile = folder.join(format!("ept-data/{}.laz", name(node.0)));
            fs::write(tile, las(&[node], true)).unwrap();
        }
    }
    fs::write(folder.join(ROOT), format!("{{{}}}", root.join(", "))).unwrap();
    fs::write(folder.join(CHILD), format!("{{{}}}", child.join(", "))).unwrap();
}

fn selected(path: &Path, wanted: Selection) -> Result<PointCloud, FileError> {
    let mut all = PointCloud::default();
    read_selected(path, &wanted, usize::MAX, |cloud| {
        all = cloud;
        Ok::<_, FileError>(())
    })?;
    Ok(all)
}

fn to(level: u32) -> Selection {
    Selection { levels: Levels::To(level), within: None }
}

#[track_caller]
fn same(cloud: &PointCloud, expected: impl Iterator<Item = (DVec3, [u8; 3])>) {
    let expected: Vec<_> = expected.collect();
    assert_eq!((cloud.len(), cloud.colours.len()), (expected.len(), expected.len()));
    for (i, (p, c)) in cloud.world_positions().zip(&cloud.colours).enumerate() {
        assert!(p.distance(expected[i].0) < 1e-6 && *c == expected[i].1, "{i}: {p}");
    }
}

#[test]
fn tiles_are_read_level_by_level() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    same(&read(folder.path()).unwrap().0, points(&sorted(2)));
    same(&read(&folder.path().join(DESCRIPTION)).unwrap().0, points(&sorted(2)));
    for (level, spacing) in [(0, 0.5), (1, 0.3), (2, 0.2)] {
        same(&selected(folder.path(), to(level)).unwrap(), points(&sorted(level as i32)));
        let levels = Levels::Spacing(spacing);
        let cloud = selected(folder.path(), Selection { levels, within: None }).unwrap();
        same(&cloud, points(&sorted(level as i32)));
    }
    let (low, high) = (DVec3::ZERO, DVec3::new(4.0, 3.5, 2.0));
    let wanted = Selection { within: Some([low, high]), ..Selection::default() };
    let inside = |p: &DVec3| p.cmpge(low).all() && p.cmple(high).all();
    let expected = sorted(2);
    same(&selected(folder.path(), wanted).unwrap(), points(&expected).filter(|(p, _)| inside(p)));
}

#[test]
fn only_the_tiles_of_the_wanted_part_are_read() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    fs::remove_file(folder.path().join(CHILD)).unwrap();
    fs::remove_file(folder.path().join("ept-data/1-1-0-0.laz")).unwrap();
    same(&selected(folder.path(), to(0)).unwrap(), points(&sorted(0)));
    let said = selected(folder.path(), to(1)).unwrap_err();
    assert!(matches!(&said, FileError::Io { name, .. } if name.ends_with("1-0-0-0.json")), "{said}");
}

#[test]
fn what_is_not_read_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |file: &str, from: &str, into: &str, reason: &str| {
        write(folder.path());
        let path = folder.path().join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(&path, text.replacen(from, into, 1)).unwrap();
        let said = selected(folder.path(), Selection { levels: Levels::Spacing(0.1), within: None });
        let said = said.unwrap_err().to_string();
        assert!(said.contains(reason), "{said} / {reason}");
    };
    refused(DESCRIPTION, "\"laszip\"", "\"binary\"", "its tiles are \"binary\"; only \"laszip\" is read");
    refused(DESCRIPTION, "\"dataType\"", "\"type\"", "no \"dataType\"");
    refused(DESCRIPTION, "1.0.0", "2.0.0", "its version is \"2.0.0\"");
    refused(DESCRIPTION, "\"bounds\": [", "\"bounds\": [true, ", "its \"bounds\" are not six numbers");
    refused(DESCRIPTION, "7.5, 7.5, 7.5", "-9, -9, -9", "its octree has a side of");
    refused(DESCRIPTION, "\"span\": 16", "\"span\": 0", "a spacing of inf");
    refused(DESCRIPTION, "{", "{[", "broken EPT header");
    refused(ROOT, "1-1-0-0", "1-1-0-2", "no node is called \"1-1-0-2\"");
    refused(ROOT, "1-1-0-0", "../../1-1-0-0", "no node is called");
    refused(ROOT, "1-1-0-0", "1-1-0-0-0", "no node is called");
    refused(ROOT, "\"1-1-0-0\": 1", "\"1-1-0-0\": -2", "the node 1-1-0-0 has -2 points");
    refused(ROOT, "\"1-1-0-0\": 1", "\"1-1-0-0\": 1.5", "the node 1-1-0-0 has 1.5 points");
    let json = fs::read(folder.path().join(DESCRIPTION)).unwrap();
    let each = |_| Ok::<_, FileError>(());
    let said = read_source(std::io::Cursor::new(json), "ept.json".into(), 9, each).unwrap_err().to_string();
    assert!(said.contains("its points lie in files beside it"), "{said}");
}

#[test]
fn a_tile_that_is_missing_or_broken_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let tile = folder.path().join("ept-data/1-0-0-0.laz");
    let rest: Vec<Node> = sorted(2).into_iter().filter(|node| node.0 != [1, 0, 0, 0]).collect();
    for damage in [None, Some(0), Some(100), Some(500)] {
        write(folder.path());
        for name in [DESCRIPTION, ROOT, CHILD] {
            let text = fs::read_to_string(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name), format!("\u{feff}{text}")).unwrap();
        }
        let bytes = fs::read(&tile).unwrap();
        match damage {
            Some(end) => fs::write(&tile, &bytes[..end]).unwrap(),
            None => fs::remove_file(&tile).unwrap(),
        }
        let (cloud, report) = read(folder.path()).unwrap();
        same(&cloud, points(&rest));
        let [said] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
        assert!(
            said.contains("1-0-0-0.laz") && said.ends_with("; 200 of 291 points could not be read"),
            "{said}"
        );
    }
}

#[test]
fn files_that_refer_to_each_other_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let text = fs::read_to_string(folder.path().join(CHILD)).unwrap();
    let circle = text.replacen('{', "{\"0-0-0-0\": -1, ", 1);
    fs::write(folder.path().join(CHILD), circle).unwrap();
    same(&read(folder.path()).unwrap().0, points(&sorted(2)));
}

#[test]
fn tiles_with_and_without_colours_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let mut builder = las::Builder::from((1, 4));
    builder.point_format = las::point::Format::new(6).unwrap();
    builder.point_format.is_compressed = true;
    let tile = folder.path().join("ept-data/2-3-0-1.laz");
    let mut writer = las::Writer::from_path(&tile, builder.into_header().unwrap()).unwrap();
    writer.write_point(las::Point { gps_time: Some(0.0), ..Default::default() }).unwrap();
    writer.close().unwrap();
    assert!(read(folder.path()).unwrap_err().to_string().contains("points have colours"));
}

#[test]
fn damaged_descriptions_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (file, seed) in [(DESCRIPTION, 1), (ROOT, 2), (CHILD, 3)] {
        write(folder.path());
        let whole = fs::read(folder.path().join(file)).unwrap();
        for case in 0..300 {
            let mut next = damage::numbers(seed << 32 | case);
            fs::write(folder.path().join(file), damage::damaged(&whole, &[], &mut next)).unwrap();
            if let Ok(cloud) = selected(folder.path(), to(1)) {
                assert_eq!(cloud.check(), Ok(()));
            }
        }
    }
}
