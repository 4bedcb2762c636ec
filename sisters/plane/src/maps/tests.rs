use super::*;

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
        let plan = FloorPlan::generate(150, 97, seed);
        let free = 150 * 97 - plan.walls.count();
        assert_eq!(connected(&plan.walls, (1, 1)), free, "seed {seed}");
        assert!(plan.doors.len() > 40 && plan.doors.iter().all(|&(x, y)| !plan.walls.get(x, y)));
        // A door is a gap in a wall.
        assert!(plan.doors.iter().all(|&(x, y)| {
            let wall = |x, y| plan.walls.get(x, y);
            wall(x - 1, y) && wall(x + 1, y) || wall(x, y - 1) && wall(x, y + 1)
        }));
    }
}

#[test]
fn maps_have_the_density_of_their_kind() {
    for (kind, least, most) in
        [(MapKind::Rooms, 0.1, 0.25), (MapKind::Caves, 0.25, 0.5), (MapKind::Fields, 0.015, 0.04)]
    {
        let map = kind.generate(300, 200, 3);
        let share = map.count() as f64 / (300.0 * 200.0);
        assert!((least..most).contains(&share), "{}: {share}", kind.name());
        assert_eq!(map, kind.generate(300, 200, 3));
        assert_ne!(map, kind.generate(300, 200, 4));
    }
}

#[test]
fn maps_of_all_sizes_are_made() {
    for kind in MapKind::ALL {
        for (width, height) in [(0, 0), (0, 9), (9, 0), (1, 1), (2, 3), (3, 1), (5, 200), (64, 64)] {
            let map = kind.generate(width, height, 1);
            assert_eq!((map.width(), map.height()), (width, height));
        }
    }
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
