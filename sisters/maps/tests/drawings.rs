//! Maps drawn with letters, floor plans, and files of either kind.

use std::sync::atomic::{AtomicU32, Ordering};

use casca_maps::{Drawing, HARBOUR};
use casca_plane::BitGrid;

/// The free tiles that can be reached from one of them, by sides.
fn connected(walls: &BitGrid, start: (u32, u32)) -> u64 {
    let mut reached = BitGrid::new(walls.width(), walls.height());
    let mut open = vec![start];
    while let Some((x, y)) = open.pop() {
        let inside = x < walls.width() && y < walls.height();
        if inside && !walls.get(x, y) && !reached.get(x, y) {
            reached.set(x, y, true);
            open.extend([(x + 1, y), (x, y + 1), (x.wrapping_sub(1), y), (x, y.wrapping_sub(1))]);
        }
    }
    reached.count()
}

#[test]
fn all_rooms_can_be_entered() {
    for seed in 0..20 {
        let plan = Drawing::rooms(150, 97, seed);
        let free = 150 * 97 - plan.walls.count();
        assert_eq!(connected(&plan.walls, (1, 1)), free, "seed {seed}");
        assert!(plan.doors.len() > 40 && plan.doors.iter().all(|&(x, y)| !plan.walls.get(x, y)));
        // A door is a gap in a wall.
        assert!(plan.doors.iter().all(|&(x, y)| {
            let wall = |x, y| plan.walls.get(x, y);
            wall(x - 1, y) && wall(x + 1, y) || wall(x, y - 1) && wall(x, y + 1)
        }));
        assert_eq!(plan, Drawing::rooms(150, 97, seed));
        assert_ne!(plan, Drawing::rooms(150, 97, seed + 1));
    }
    for (width, height) in [(0, 0), (0, 9), (9, 0), (1, 1), (2, 3), (3, 1), (5, 200), (64, 64)] {
        let walls = Drawing::rooms(width, height, 1).walls;
        assert_eq!((walls.width(), walls.height()), (width, height));
    }
}

/// Opens a file of some bytes, whose name says nothing, or says what its error is.
fn opened(bytes: &[u8]) -> Result<Drawing, String> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("casca-map-{}-{number}.txt", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let found = Drawing::open(&path);
    std::fs::remove_file(&path).unwrap();
    found.map_err(|why| {
        let (why, name) = (why.to_string(), path.display().to_string());
        assert!(why.starts_with(&name), "{why}");
        why[name.len()..].to_owned()
    })
}

#[test]
fn files_that_are_no_maps_are_refused_by_their_contents() {
    let prose = "The quick brown fox jumps over the lazy dog.\n# A heading\nAnd more words follow here, one by one.\n";
    assert!(opened(b"{\"a\": 1}").unwrap_err().contains("no element map"));
    for bytes in [b"\x01\x02".as_slice(), b"1,1,1,1\n1,0,0,1\n", prose.as_bytes()] {
        let why = opened(bytes).unwrap_err();
        assert!(why.contains("no map"), "{why}");
    }
    assert!(opened(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap_err().contains("no text"));
    let why = Drawing::open("no/such/map").unwrap_err().to_string();
    assert!(why.starts_with("no/such/map cannot be read"), "{why}");
    assert!(Drawing::open(std::env::temp_dir()).unwrap_err().to_string().contains("is no file"));
    // One line much longer than many others takes no memory for all.
    let wide = "#".repeat(60_000) + &"\n#".repeat(60_000);
    assert!(opened(wide.as_bytes()).unwrap_err().contains("much longer than the others"));
}

#[test]
fn drawings_are_read_with_all_line_ends_and_marks() {
    let harbour = Drawing::read(HARBOUR);
    for (from, to) in [("\n", "\n"), ("\n", "\r\n"), ("\n", "\r")] {
        assert_eq!(opened(HARBOUR.replace(from, to).as_bytes()), Ok(harbour.clone()), "{to:?}");
    }
    assert_eq!(opened(format!("\u{feff}{HARBOUR}").as_bytes()), Ok(harbour.clone()));
    let open = opened(b"....\n.g@.\n").unwrap();
    assert!(
        (open.start, &open.guards[..]) == (Some((2, 1)), &[(1, 1)])
            && open.warnings[0].contains("nothing blocks")
    );
    // Many letters, and walls among them.
    assert_eq!(opened("#gggg\n".repeat(9).as_bytes()).unwrap().walls.count(), 9);
}

#[test]
fn maps_of_tiled_are_drawings_by_their_contents() {
    let text = include_str!("../levels/harbour.tmx");
    let (found, drawn) = (opened(text.as_bytes()).unwrap(), Drawing::read(HARBOUR));
    assert_eq!(
        found, drawn,
        "walls by a property of tiles and by a layer, doors, guards and the start by objects"
    );
    // Names are as good as classes, and walls that are no tiles are told of.
    let object = |inner: &str| {
        let map = "<map orientation=\"orthogonal\" width=\"4\" height=\"1\" tilewidth=\"9\" tileheight=\"9\"><tileset firstgid=\"1\"/>\
            <layer name=\"Walls\" width=\"4\" height=\"1\"><data encoding=\"csv\">1,0,0,1</data></layer><objectgroup>";
        opened(format!("{map}<object x=\"10\" {inner}/></objectgroup></map>").as_bytes()).unwrap()
    };
    assert_eq!(object("name=\"Player Start\"").start, Some((1, 0)));
    assert_eq!(object("type=\"GUARD\"").guards, [(1, 0)]);
    assert_eq!(object("type=\"Door\" width=\"9\" height=\"9\"").doors, [(1, 0)]);
    assert!(
        object("type=\"wall\" width=\"9\" height=\"3\"").warnings[0].contains("1 walls are no whole tiles")
    );
    assert!(opened(b"\n<!DOCTYPE html>\n<html></html>").unwrap_err().contains("no element map"));
}

#[test]
fn the_harbour_is_whole() {
    let harbour = Drawing::read(HARBOUR);
    assert_eq!((harbour.walls.width(), harbour.walls.height()), (72, 36));
    let free = 72 * 36 - harbour.walls.count();
    assert_eq!(connected(&harbour.walls, harbour.start.unwrap()), free);
    assert!(harbour.doors.len() > 10 && harbour.guards.len() > 5);
    assert_eq!(Drawing::read(""), Drawing::default());
}
