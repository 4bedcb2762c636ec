use super::*;
use glam::Vec3;

const SMALL: Sampling =
    Sampling { settle: 5, steady: 2, frames: 4, judged: 4, width: 640, patience: f64::INFINITY };

#[test]
fn all_structures_find_what_the_array_finds_and_the_library_all_that_is_visible() {
    for (hidden, fast) in [(true, true), (true, false), (false, true)] {
        let arena = Arena { count: 400, hidden, fast, seed: 5 };
        let rows = measure(arena, SMALL, &|_| ()).expect("structures agree");
        assert_eq!(rows.len(), 5 + WAYS.len());
        let linear = find(&rows, "linear array", &arena).unwrap();
        assert!(linear.returned > 50.0 && linear.visible > 0.0, "{linear:?}");
        for row in &rows {
            assert_eq!(row.lost, 0, "{row:?}");
            assert!(row.returned + 1e-9 >= row.visible, "{row:?}");
        }
        let point = find(&rows, "casca point", &arena).unwrap();
        assert_eq!(point.returned < 0.5 * linear.returned, hidden, "{point:?}");
    }
}

#[test]
fn structures_follow_boxes_that_grow_jump_and_leave_the_hall() {
    let world = Arena { count: 50, hidden: false, fast: false, seed: 1 }.build();
    let mut now = boxes(&world.objects);
    let camera = world.camera(0, 1.0);
    let frustum = Frustum::of(&camera);
    let mut all = others(&now, &world);
    let jump = |i: usize, round: usize| {
        let a = (i * 37 + round * 91) as f32;
        Vec3::new(a.sin() * 90.0 + 64.0, a.cos() * 40.0 + 24.0, (a * 0.7).sin() * 90.0 + 64.0)
    };
    for round in 0..20 {
        for (i, b) in now.iter_mut().enumerate() {
            let half = 0.1 + ((i + round) % 13) as f32 * 3.0;
            *b = (jump(i, round) - half, jump(i, round) + half);
        }
        let mut expected: Option<Vec<u32>> = None;
        for structure in &mut all {
            structure.update(&now);
            let mut found = Vec::new();
            structure.query(&frustum, &mut found);
            found.sort_unstable();
            match &expected {
                None => expected = Some(found),
                Some(e) => assert_eq!(*e, found, "{} in round {round}", structure.name()),
            }
        }
        let found = expected.unwrap_or_default().len();
        assert!(found > 5 && found < 50, "the view tells them apart: {found}");
    }
}
