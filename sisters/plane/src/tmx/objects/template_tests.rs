//! Objects that are made of templates.

use std::io;

use glam::Vec2;

use super::*;
use crate::editor::Role;
use crate::geometry::Rect;
use crate::tmx::{TmxImport, TmxMap, TmxWarning};

/// A tileset of tiles of 16 by 32 pixels: the tile 1 is a door.
const TILES: &str = "<tileset tilewidth=\"16\" tileheight=\"32\" tilecount=\"4\"><tile id=\"1\"><properties>\
    <property name=\"door\" type=\"bool\" value=\"true\"/></properties></tile></tileset>";

/// Reads a map of tiles of 16 by 16 pixels with some objects. `t.tsx` is a tileset that it has from
/// 11 on, `u.tsx` one that it has not; there are the templates that are given.
fn read(objects: &str, templates: &[(&str, &str)]) -> TmxMap {
    let map = format!(
        "<map orientation=\"orthogonal\" width=\"8\" height=\"8\" tilewidth=\"16\" tileheight=\"16\" infinite=\"1\">\
         <tileset firstgid=\"1\" source=\"s.tsx\"/><tileset firstgid=\"11\" source=\"sets/t.tsx\"/>\
         <tileset firstgid=\"13\" source=\"s.tsx\"/><objectgroup name=\"o\">{objects}</objectgroup></map>"
    );
    let mut opened = Vec::new();
    let open = |path: &str| {
        assert!(!opened.contains(&path.to_owned()), "{path} is read twice");
        opened.push(path.to_owned());
        let template = templates.iter().find(|(name, _)| *name == path);
        match (template, path) {
            (Some((_, text)), _) => Ok(format!("<template>{text}</template>").into()),
            (_, "s.tsx" | "sets/t.tsx" | "sets/u.tsx") => Ok(TILES.into()),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    };
    TmxImport::default().parse_map(map.as_bytes(), open).unwrap()
}

fn rect(x: f32, y: f32, right: f32, bottom: f32) -> TmxShape {
    TmxShape::Rect(Rect::new(Vec2::new(x, y), Vec2::new(right, bottom)))
}

#[test]
fn objects_take_over_the_parts_that_they_do_not_say() {
    let template = "<object name=\"gate\" type=\"opaque\" x=\"64\" y=\"80\" width=\"32\" height=\"16\" rotation=\"90\" visible=\"0\">\
        <properties><property name=\"a\" type=\"int\" value=\"1\"/><property name=\"b\" type=\"int\" value=\"2\"/></properties></object>";
    let found = read(
        "<object id=\"1\" template=\"gate.tx\" x=\"32\" y=\"16\"/>\
         <object id=\"2\" template=\"gate.tx\" name=\"own\" class=\"door\" width=\"16\" height=\"16\" rotation=\"0\" visible=\"1\">\
         <properties><property name=\"b\" type=\"int\" value=\"3\"/></properties></object>\
         <object id=\"3\" template=\"gate.tx\" width=\"48\"/><object id=\"4\" template=\"gate.tx\"><ellipse/></object>",
        &[("gate.tx", template)],
    );
    assert_eq!(found.warnings, []);
    let [first, own, half, round] = &found.objects[..] else { panic!() };
    // Its place is its own. It turns about this, so that it is one tile wide and two high.
    assert_eq!((&*first.name, &first.shape, first.visible), ("gate", &rect(1., 1., 2., 3.), false));
    assert_eq!((first.role, &*first.class), (Role::Wall, "opaque"));
    assert_eq!((&*own.name, &own.shape, own.visible), ("own", &rect(0., 0., 1., 1.), true));
    assert_eq!((own.role, &*own.class), (Role::Door, "door"));
    let ints = |object: &TmxObject| ["a", "b"].map(|name| object.properties.get(name).cloned());
    assert_eq!(ints(first), [1, 2].map(|v| Some(TmxValue::Int(v))));
    assert_eq!(ints(own), [1, 3].map(|v| Some(TmxValue::Int(v))));
    // A size of one length is none, for the editor.
    assert_eq!(half.shape, rect(-1., 0., 0., 2.));
    assert!(matches!(round.shape, TmxShape::Ellipse { .. }));
}

#[test]
fn members_of_classes_come_from_both() {
    let class = |members: &str| {
        format!(
            "<properties><property name=\"c\" type=\"class\" propertytype=\"C\"><properties>{members}</properties></property>\
             </properties>"
        )
    };
    let member =
        |name: &str, value: i32| format!("<property name=\"{name}\" type=\"int\" value=\"{value}\"/>");
    let template = format!("<object><point/>{}</object>", class(&(member("a", 1) + &member("b", 2))));
    let own = class(&(member("b", 3) + &member("d", 4)));
    let found = read(&format!("<object template=\"p.tx\">{own}</object>"), &[("p.tx", &template)]);
    let TmxValue::Class { members, .. } = &found.objects[0].properties["c"] else { panic!() };
    let all: Vec<_> = members.iter().map(|(name, value)| (&**name, value.clone())).collect();
    assert_eq!(all, [("a", 1), ("b", 3), ("d", 4)].map(|(name, v)| (name, TmxValue::Int(v))));
}

#[test]
fn tiles_of_templates_count_by_their_own_tilesets() {
    let of = |source: &str, gid: u32| {
        format!(
            "<tileset firstgid=\"5\" source=\"{source}\"/><object gid=\"{gid}\" width=\"16\" height=\"16\"/>"
        )
    };
    let turned = 0x8000_0000;
    let templates = [
        ("parts/a.tx", of("../sets/t.tsx", turned | 6)),
        ("parts/b.tx", of("../sets/u.tsx", 6)),
        ("parts/c.tx", of("../sets/t.tsx", 8)),
        ("parts/d.tx", of("../sets/t.tsx", 4)),
        ("parts/e.tx", of("../s.tsx", 6)),
    ];
    let templates: Vec<_> = templates.iter().map(|(name, text)| (*name, &**text)).collect();
    let objects: String = (1..)
        .zip(&templates)
        .map(|(id, (name, _))| format!("<object id=\"{id}\" template=\"{name}\" y=\"16\"/>"))
        .collect();
    let own = "<object id=\"6\" template=\"parts/a.tx\" gid=\"3\" y=\"16\"/>";
    let found = read(&(objects + own), &templates);
    let tiles: Vec<_> = found.objects.iter().map(|object| (object.id, object.tile, object.role)).collect();
    // The map has 11 and 12 of that tileset, and another from 13 on; a tileset that comes twice has
    // the numbers of the first.
    let expected = [
        (1, Some(turned | 12), Role::Door),
        (2, None, Role::Door),
        (3, None, Role::Plain),
        (5, Some(2), Role::Door),
        (6, Some(3), Role::Plain),
    ];
    assert_eq!(tiles, expected);
    assert!(found.objects.iter().all(|object| object.shape == rect(0., 0., 1., 1.)));
    let unknown = TmxWarning::Object { id: 4, layer: "o".into(), fault: TmxFault::UnknownTile(4) };
    assert_eq!(found.warnings, [unknown]);
}

#[test]
fn templates_that_are_not_read_are_named() {
    let templates = [
        ("none.tx", ""),
        ("self.tx", "<object template=\"self.tx\"/>"),
        ("set.tx", "<tileset firstgid=\"1\" source=\"no.tsx\"/><object/>"),
        ("cut.tx", "<object>"),
        ("number.tx", "<object width=\"-1\" height=\"1\"/>"),
        ("text.tx", "<object><text>A</text></object>"),
    ];
    for (path, said) in [
        ("none.tx", "the template none.tx is not read: none.tx, line 1: the template has no object"),
        ("self.tx", "self.tx, line 1: a template is made of a template: it is left out"),
        ("set.tx", "no.tsx cannot be read"),
        ("cut.tx", "cut.tx, line 1: "),
        ("missing.tx", "missing.tx cannot be read"),
        ("number.tx", "width=\"-1\" is no number that is read"),
    ] {
        // Twice, of which the second does not open the file.
        let found = read(&format!("<object id=\"1\" template=\"{path}\"/>").repeat(2), &templates);
        assert_eq!((found.objects.len(), found.warnings.len()), (0, 3), "{path}, and nothing blocks");
        assert_eq!(found.warnings[0], found.warnings[1]);
        assert!(found.warnings[0].to_string().contains(said), "{} / {said}", found.warnings[0]);
    }
    let found = read("<object id=\"1\" template=\"text.tx\"/><object><point/></object>", &templates);
    assert_eq!((found.objects.len(), found.warnings.len()), (1, 1), "a text is passed over");
}
