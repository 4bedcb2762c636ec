//! Sets of cells against exact visibility: rays from eyes in the cells, by code that shares nothing
//! with casca.

use std::ops::ControlFlow;

use casca::Aabb;
use casca_bake::{BakeError, Baker, Cells, Finder, Level, Places, bounds_of, eyes_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{GridHint, Mesh, Motion, Object, Shape, Sides, World};
use casca_truth::oracle::RayOracle;
use casca_truth::places::{coordinate, place_in};
use glam::{Affine3A, DVec3, Vec3};
use rand::RngExt;

/// Rays that pass this close to a border between seen and hidden are in doubt, in metres.
const DOUBT: f64 = 1e-4;

/// Eyes keep that far from solids, in metres, and by that share of its radius from a ball.
const CLEAR: f32 = 1e-3;

fn world(kind: SceneKind, scale: f32) -> World {
    let mut world = build(kind, &SceneOptions { scale, ..SceneOptions::default() });
    world.objects.retain(|object| object.motion == Motion::Static);
    world
}

/// A level of some objects, on the grid of a small scene.
fn level_of(objects: Vec<Object>) -> Level {
    Level::new(&World { objects, ..world(SceneKind::Rooms, 0.1) }, None, false).unwrap()
}

/// A point of the surface of a shape, by three numbers from 0 to 1.
fn point_of(shape: &Shape, [a, b, c]: [f32; 3]) -> Vec3 {
    match shape {
        Shape::Sphere { center, radius } => {
            center + *radius * (Vec3::new(a, b, c) * 2.0 - 1.0).normalize_or(Vec3::Y) * 0.999
        }
        Shape::Box { min, max } => {
            let mut share = Vec3::new(a, b, c);
            let axis = (a * 3000.0) as usize % 3;
            share[axis] = share[axis].round();
            min + share * (max - min)
        }
        Shape::Mesh { mesh, transform } => {
            let triangle = mesh.triangles[(c * mesh.triangles.len() as f32) as usize % mesh.triangles.len()];
            let [p, q, r] = triangle.map(|v| transform.transform_point3(mesh.positions[v as usize]));
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            p + (q - p) * a + (r - p) * b
        }
    }
}

/// Whether a place is in a solid.
fn in_solid(objects: &[Object], place: Vec3) -> bool {
    objects.iter().filter(|o| o.occludes).any(|object| match &object.shape {
        Shape::Sphere { center, radius } => center.distance(place) <= *radius * (1.0 + CLEAR),
        Shape::Box { min, max } => place.cmpge(min - CLEAR).all() && place.cmple(max + CLEAR).all(),
        // Last, because it is a pass over all edges.
        Shape::Mesh { mesh, .. } => bounds_of(&object.shape).contains(place) && mesh.is_closed(),
    })
}

/// Looks from many eyes of some cells. Returns the sizes of the sets, and how many objects the eyes
/// saw.
fn look(world: &World, places: &Places, cells: usize, queries: u32) -> (usize, usize) {
    let level = Level::new(world, None, false).unwrap();
    let grid = places.cells(&level).unwrap();
    let numbers = places.numbers(&level).unwrap();
    assert!(numbers.len() > cells);
    let mut finder = Finder::new(&level, queries);
    let rays = RayOracle::new(&world.objects);
    let mut random = generator(7, 0xba8e);
    let (mut sizes, mut seen_in_all) = (0, 0);
    for i in 0..cells {
        let number = numbers[i * numbers.len() / cells];
        let eyes = eyes_of(&grid, number).unwrap();
        let set = finder.set(eyes);
        assert!(set.windows(2).all(|pair| pair[0] < pair[1]));
        sizes += set.len();
        let mut seen = vec![false; world.objects.len()];
        for round in 0..150 {
            let mut share = || random.random_range(0.0..1.0f32);
            let mut at = Vec3::new(share(), share(), share());
            if round % 2 == 0 {
                // On a side.
                at[round % 3] = at[round % 3].round();
            }
            let eye = eyes.min + at * (eyes.max - eyes.min);
            if in_solid(&world.objects, eye) {
                continue;
            }
            for (object, number) in world.objects.iter().zip(0u32..) {
                if seen[number as usize] {
                    continue;
                }
                let target = point_of(&object.shape, [share(), share(), share()]).as_dvec3();
                let eye = eye.as_dvec3();
                let aside = (target - eye).any_orthonormal_vector() * DOUBT;
                let free = |by: DVec3| !rays.occluded(eye, target + by, number as usize);
                if free(DVec3::ZERO) && free(aside) && free(-aside) {
                    seen[number as usize] = true;
                    assert!(
                        set.binary_search(&number).is_ok(),
                        "{number} is seen from {eye} in cell {i}: {eyes:?}"
                    );
                }
            }
        }
        seen_in_all += seen.iter().filter(|seen| **seen).count();
    }
    (sizes, seen_in_all)
}

#[test]
fn rooms_lose_nothing_and_their_walls_hide() {
    let world = world(SceneKind::Rooms, 0.3);
    let within = Some(Aabb::new(Vec3::ZERO, Vec3::new(40.0, 2.0, 40.0)));
    let places = Places { edge: 2.0, height: Some((0.2, 2.0)), within };
    let (sizes, seen) = look(&world, &places, 4, 30);
    let all = 4 * world.objects.len();
    assert!(seen > 4 * 10 && sizes < seen * 5 / 2 && sizes < all / 2, "{seen} {sizes} of {all}");
}

#[test]
fn a_town_of_meshes_loses_nothing() {
    let world = world(SceneKind::Town, 0.02);
    let places = Places { edge: 6.0, height: Some((1.0, 2.0)), within: None };
    let (sizes, seen) = look(&world, &places, 3, 16);
    assert!(seen > 3 * 20 && sizes >= seen, "{seen} {sizes}");
}

/// A level around a cell of 2 m in its middle, given for a side that looks along x: `turn` takes it
/// to any side. A wall has a hole before one corner of the side. Behind it lie a ball before the
/// hole, one before another corner, and a bar beside the cell whose far end shows through the hole.
fn level_with_hole(turn: impl Fn(Vec3) -> Vec3) -> (World, Aabb) {
    let middle = Vec3::splat(20.0);
    let boxed = |low: [f32; 3], high: [f32; 3]| {
        let (a, b) = (middle + turn(Vec3::from(low)), middle + turn(Vec3::from(high)));
        Shape::Box { min: a.min(b), max: a.max(b) }
    };
    let ball = |at: [f32; 3]| Shape::Sphere { center: middle + turn(Vec3::from(at)), radius: 0.1 };
    let hole = (0.7, 0.9);
    let shapes = vec![
        ball([4.0, 0.8, 0.8]),
        ball([4.0, -0.8, -0.8]),
        boxed([0.5, 2.4, 0.7], [7.0, 2.6, 0.9]),
        boxed([1.5, -9.0, -9.0], [2.0, hole.0, 9.0]),
        boxed([1.5, hole.1, -9.0], [2.0, 9.0, 9.0]),
        boxed([1.5, hole.0, -9.0], [2.0, hole.1, hole.0]),
        boxed([1.5, hole.0, hole.1], [2.0, hole.1, 9.0]),
        // Nothing is seen through the other sides.
        boxed([-2.0, -9.0, -9.0], [-1.5, 9.0, 9.0]),
        boxed([-2.0, 1.5, -9.0], [2.0, 2.0, 9.0]),
        boxed([-2.0, -2.0, -9.0], [2.0, -1.5, 9.0]),
        boxed([-2.0, -9.0, 1.5], [2.0, 9.0, 2.0]),
        boxed([-2.0, -9.0, -2.0], [2.0, 9.0, -1.5]),
    ];
    let mut world = world(SceneKind::Rooms, 0.1);
    let motion = Motion::Static;
    let object = |(i, shape)| Object { name: String::new(), shape, motion, occludes: i > 2, tested: true };
    world.objects = shapes.into_iter().enumerate().map(object).collect();
    world.grid = GridHint { min: Vec3::ZERO, max: Vec3::splat(40.0), cell: 0.2 };
    (world, Aabb::new(middle - 1.0, middle + 1.0))
}

#[test]
fn what_one_corner_of_a_side_sees_is_found() {
    for axis in 0..3 {
        for signs in 0..8 {
            let sign = |i: usize| if signs >> i & 1 == 0 { 1.0 } else { -1.0 };
            let turn = |p: Vec3| {
                let mut q = Vec3::ZERO;
                (0..3).for_each(|i| q[(axis + i) % 3] = p[i] * sign(i));
                q
            };
            let (world, cell) = level_with_hole(turn);
            let level = Level::new(&world, None, false).unwrap();
            for queries in [16, 60] {
                let set = Finder::new(&level, queries).set(cell);
                let has = |i| set.contains(&i);
                assert!(has(0) && has(2), "{axis} {signs:b} {queries}: {set:?}");
                assert!(!has(1), "{axis} {signs:b} {queries}: the ball behind the wall is hidden");
            }
        }
    }
}

/// A static object that hides others.
fn occluder(shape: Shape) -> Object {
    Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true }
}

fn occluder_of(mesh: Mesh) -> Object {
    occluder(Shape::Mesh { mesh: mesh.into(), transform: Affine3A::IDENTITY })
}

fn occluder_at(center: Vec3, radius: f32) -> Object {
    occluder(Shape::Sphere { center, radius })
}

#[test]
fn eyes_may_be_in_a_closed_mesh() {
    let mut world = world(SceneKind::Rooms, 0.1);
    let room = Mesh::cuboid(Vec3::new(2.0, 0.0, 2.0), Vec3::new(30.0, 4.0, 30.0));
    let ball = |x| occluder_at(Vec3::new(x, 2.0, 16.0), 0.5);
    world.objects = vec![occluder_of(room), ball(28.0), ball(36.0)];
    let cell = Aabb::new(Vec3::new(4.0, 1.0, 15.0), Vec3::new(6.0, 3.0, 17.0));
    let found = |solid| Finder::new(&Level::new(&world, None, solid).unwrap(), 32).set(cell);
    assert_eq!(found(false)[..2], [0, 1], "the ball in the room is seen, whatever the room is made of");
    assert_eq!(found(true), [0], "nobody is in there");
    let outside = Aabb::new(Vec3::new(32.0, 1.0, 15.0), Vec3::new(34.0, 3.0, 17.0));
    assert_eq!(Finder::new(&Level::new(&world, None, false).unwrap(), 32).set(outside), [0, 2]);
}

#[test]
fn a_closed_mesh_beside_the_cell_may_be_hollow() {
    // A booth of 1 m whose side is in the same cell of the grid as a side of the view cell. Who
    // looks from inside of it sees the ball in it, and hardly anything else.
    let mut world = world(SceneKind::Rooms, 0.1);
    let booth = Mesh::cuboid(Vec3::new(6.1, 1.0, 5.0), Vec3::new(7.1, 2.0, 6.0));
    let ball = |x| occluder_at(Vec3::new(x, 1.5, 5.5), 0.05);
    world.objects = vec![occluder_of(booth), ball(6.6), ball(9.0)];
    world.grid = GridHint { min: Vec3::ZERO, max: Vec3::splat(40.0), cell: 0.5 };
    let level = Level::new(&world, None, false).unwrap();
    let cell = |x0: f32, x1: f32| Aabb::new(Vec3::new(x0, 1.2, 5.2), Vec3::new(x1, 1.8, 5.8));
    for queries in [16, 200] {
        let mut finder = Finder::new(&level, queries);
        assert_eq!(finder.set(cell(5.0, 6.0)), [0], "all is hidden by the booth");
        assert_eq!(finder.set(cell(5.0, 6.2))[..2], [0, 1], "eyes in the booth see the ball in it");
        assert_eq!(finder.set(cell(8.0, 8.5)), [0, 2]);
    }
}

#[test]
fn walls_hide_what_is_behind_them_only() {
    // A sheet between two cells, a picture on it, a ball behind it, and one whose box touches it.
    let sheet = |x: f32, low: [f32; 2], high: [f32; 2]| {
        let at = |y, z| Vec3::new(x, y, z);
        let [a, b, c, d] =
            [at(low[0], low[1]), at(high[0], low[1]), at(high[0], high[1]), at(low[0], high[1])];
        occluder_of(Mesh {
            positions: vec![a, b, c, d],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        })
    };
    let ball = |x| occluder_at(Vec3::new(x, 5.0, 5.0), 0.25);
    let sheets = [sheet(8.0, [0.0, 0.0], [10.0, 10.0]), sheet(8.0, [4.0, 4.0], [6.0, 6.0])];
    let level = level_of(sheets.into_iter().chain([ball(9.0), ball(8.25)]).collect());
    let before = Aabb::new(Vec3::new(5.0, 4.0, 4.0), Vec3::new(6.0, 6.0, 6.0));
    let set = Finder::new(&level, 60).set(before);
    assert!(set[..2] == [0, 1] && !set.contains(&2), "{set:?}");
    let behind = Aabb::new(Vec3::new(10.0, 4.0, 4.0), Vec3::new(11.0, 6.0, 6.0));
    assert_eq!(Finder::new(&level, 60).set(behind), [0, 1, 2, 3]);
}

#[test]
fn sheets_and_boxes_that_hide_from_their_front_let_eyes_behind_it_see() {
    let ball = |x| occluder_at(Vec3::new(x, 5.0, 5.0), 0.25);
    let at = |y, z| Vec3::new(8.0, y, z);
    let sheet = |sides| Mesh {
        positions: vec![at(0.0, 0.0), at(10.0, 0.0), at(10.0, 10.0), at(0.0, 10.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        sides: vec![sides; 2],
    };
    // Two boxes that touch, as one wall.
    let half = |low: f32| Mesh {
        sides: vec![Sides::Front; 12],
        ..Mesh::cuboid(Vec3::new(7.9, low, 0.0), Vec3::new(8.1, low + 5.0, 10.0))
    };
    let eyes = |x: f32| Aabb::new(Vec3::new(x, 4.0, 4.0), Vec3::new(x + 1.0, 6.0, 6.0));
    let sees = |walls: Vec<Mesh>, x: f32| {
        let first = walls.len() as u32;
        let level = level_of(walls.into_iter().map(occluder_of).chain([ball(7.0), ball(9.0)]).collect());
        let set = Finder::new(&level, 60).set(eyes(x));
        [first, first + 1].map(|number| set.contains(&number))
    };
    // The front looks to greater x.
    assert_eq!(sees(vec![sheet(Sides::Front)], 10.0), [false, true]);
    assert_eq!(sees(vec![sheet(Sides::Front)], 5.0), [true, true]);
    assert_eq!(sees(vec![sheet(Sides::Both)], 5.0), [true, false]);
    assert_eq!(sees(vec![sheet(Sides::Neither)], 10.0), [true, true]);
    // From within the boxes one sees out; from outside nothing passes them.
    assert_eq!(sees(vec![half(0.0), half(5.0)], 7.9 - 0.4), [true, true]);
    assert_eq!(sees(vec![half(0.0), half(5.0)], 5.0), [true, false]);
    assert_eq!(sees(vec![half(0.0), half(5.0)], 10.0), [false, true]);
}

/// Looks from random eyes in some cells at random places in all. Returns the sizes of the sets, and
/// how many cells were seen.
fn look_from_cell_to_cell(world: &World, places: &Places, cells: usize) -> (usize, usize, usize) {
    let level = Level::new(world, None, false).unwrap();
    let (grid, numbers) = (places.cells(&level).unwrap(), places.numbers(&level).unwrap());
    let level = level.cell_to_cell(&grid, &numbers).unwrap();
    let mut finder = Finder::new(&level, 16);
    let rays = RayOracle::new(&world.objects);
    let mut random = generator(7, 0xce11);
    let mut place = |room: Aabb| {
        let mut share = || random.random_range(0.0..1.0f32);
        room.min + Vec3::new(share(), share(), share()) * (room.max - room.min)
    };
    let (mut sizes, mut seen_in_all) = (0, 0);
    for i in 0..cells {
        let from = eyes_of(&grid, numbers[i * numbers.len() / cells]).unwrap();
        let set = finder.set(from);
        assert!(set.iter().all(|cell| numbers.binary_search(cell).is_ok()));
        sizes += set.len();
        for &to in &numbers {
            let room = eyes_of(&grid, to).unwrap();
            let pairs = (0..60).map(|_| (place(from), place(room)));
            let mut free = pairs.filter(|(eye, at)| {
                let inside = in_solid(&world.objects, *eye) || in_solid(&world.objects, *at);
                !inside && !rays.occluded(eye.as_dvec3(), at.as_dvec3(), usize::MAX)
            });
            if let Some((eye, at)) = free.next() {
                assert!(set.binary_search(&to).is_ok(), "from {eye} to {at} in cell {to}");
                seen_in_all += 1;
            }
        }
    }
    (sizes, seen_in_all, cells * numbers.len())
}

#[test]
fn cells_that_are_seen_from_cells_are_found() {
    let world = world(SceneKind::Rooms, 0.3);
    // Cells of 3 m reach through walls and into the floor.
    let within = Some(Aabb::new(Vec3::ZERO, Vec3::new(40.0, 3.0, 40.0)));
    let places = Places { edge: 3.0, height: Some((0.0, 2.2)), within };
    let (sizes, seen, all) = look_from_cell_to_cell(&world, &places, 12);
    assert!(seen > 12 * 4 && sizes < seen * 3 / 2 && sizes < all / 2, "{seen} {sizes} of {all}");
}

#[test]
fn spheres_and_all_cells_lose_nothing() {
    let world = world(SceneKind::Spheres, 0.2);
    let (sizes, seen) = look(&world, &Places { edge: 16.0, height: None, within: None }, 4, 16);
    assert!(seen > 4 * 20 && sizes >= seen, "{seen} {sizes}");
}

/// Solids whose faces touch, and things without height or extent among them.
fn lattice(random: &mut Generator) -> World {
    let mut world = world(SceneKind::Rooms, 0.1);
    let mut place = |low: f32, high: f32, step: f32| {
        let mut at = || coordinate(random.random_range(0.0..1.0), low..high, step);
        Vec3::new(at(), at(), at())
    };
    let mut object = |i: u32| {
        let occludes = i < 6;
        let size = if occludes { place(0.5, 4.5, 1.0) } else { place(0.0, 1.0, 1.0) };
        let min = place(0.0, 8.0, 1.0);
        let shape = Shape::Box { min, max: min + size };
        Object { name: String::new(), shape, motion: Motion::Static, occludes, tested: true }
    };
    world.objects = (0..16).map(&mut object).collect();
    world.grid = GridHint { min: Vec3::ZERO, max: Vec3::splat(12.0), cell: 0.5 };
    world
}

#[test]
fn eyes_on_faces_and_borders_lose_nothing() {
    let grid = Cells { low: [2.0; 3], size: [2.0; 3], dims: [2; 3], origin: [0.0; 3] };
    let (mut found, mut hidden) = (0, 0);
    for seed in 0..40 {
        let mut random = generator(seed, 0x1a77);
        let world = lattice(&mut random);
        let level = Level::new(&world, None, false).unwrap();
        let rays = RayOracle::new(&world.objects);
        let mut finder = Finder::new(&level, 16);
        let sets: Vec<Vec<u32>> = (0..8).map(|cell| finder.set(eyes_of(&grid, cell).unwrap())).collect();
        let one = Aabb::new(Vec3::splat(2.0), Vec3::splat(4.0));
        let of_one = finder.set(one);
        for _ in 0..300 {
            let mut share = || random.random_range(0.0..1.0);
            let eye = DVec3::from_array([0; 3].map(|_| coordinate(share(), 2.0..6.0, 1.0).into()));
            // On either side of the faces that it lies on, very near and a little farther off.
            let beside = place_in(DVec3::ZERO, DVec3::ZERO, &mut share);
            let eyes = [eye + beside, eye + beside.signum() * DOUBT];
            let is_in = |eye: DVec3, object: &Object| match &object.shape {
                Shape::Box { min, max } => {
                    object.occludes && eye.cmpge(min.as_dvec3()).all() && eye.cmple(max.as_dvec3()).all()
                }
                _ => false,
            };
            let Some(cells) = grid.of_eyes(eye.to_array(), eye.to_array()) else { continue };
            if eyes.iter().any(|&eye| world.objects.iter().any(|object| is_in(eye, object))) {
                continue;
            }
            for (object, number) in world.objects.iter().zip(0u32..) {
                let Shape::Box { min, max } = object.shape else { continue };
                let point = place_in(min.as_dvec3(), max.as_dvec3(), &mut share);
                let has = |set: &[u32]| set.binary_search(&number).is_ok();
                let is_found = grid.numbers(cells).any(|cell| has(&sets[cell as usize]));
                hidden += usize::from(!is_found);
                if eyes.iter().any(|&eye| rays.occluded(eye, point, number as usize)) {
                    continue;
                }
                found += 1;
                let from = format!("{seed}: {number} is seen from {eye} at {point}");
                assert!(is_found, "{from}, cells {:?}", grid.numbers(cells).collect::<Vec<_>>());
                let in_one = eye.cmple(one.max.as_dvec3()).all();
                assert!(!in_one || has(&of_one), "{from}, by a cell alone");
            }
        }
    }
    assert!(found > 1000 && hidden > 1000, "{found} {hidden}");
}

#[test]
fn other_cells_than_those_that_sets_tell_of_are_refused() {
    let world = world(SceneKind::Rooms, 0.1);
    let places = Places { edge: 10.0, height: Some((0.0, 2.2)), within: None };
    let level = Level::new(&world, None, false).unwrap();
    let (grid, numbers) = (places.cells(&level).unwrap(), places.numbers(&level).unwrap());
    let level = level.cell_to_cell(&grid, &numbers[1..]).unwrap();
    let bake = |cells, numbers: &[u32]| {
        let baker = Baker::of(&level, cells, numbers, 16);
        baker.run(1, None, &mut |_, _| ControlFlow::Continue(())).map(|sets| sets.len())
    };
    assert_eq!(bake(grid, &numbers[1..3]).unwrap(), 2);
    assert!(matches!(bake(grid, &numbers[..2]), Err(BakeError::OtherCells)));
    let other = Cells { size: grid.size.map(|size| size * 2.0), ..grid };
    assert!(matches!(bake(other, &[]), Err(BakeError::OtherCells)));
}

#[test]
fn the_journal_of_objects_with_other_numbers_is_refused() {
    let mut world = world(SceneKind::Rooms, 0.1);
    let places = Places { edge: 20.0, height: Some((0.2, 2.0)), within: None };
    let folder = tempfile::tempdir().unwrap();
    let bake = |world: &World| {
        let level = Level::new(world, None, false).unwrap();
        let baker = Baker::new(&level, &places, 16).unwrap();
        baker.run(1, Some(&folder.path().join("journal")), &mut |_, _| ControlFlow::Continue(()))
    };
    let sets = bake(&world).unwrap().finish().unwrap();
    assert_eq!(bake(&world).unwrap().finish().unwrap(), sets);
    // A door that moves, before all that stand still.
    let door = Object { motion: Motion::Dynamic { max_speed: 1.0 }, ..world.objects[0].clone() };
    world.objects.insert(0, door);
    assert!(matches!(bake(&world), Err(BakeError::OtherJournal(_))));
}

#[test]
fn files_of_levels_far_from_the_origin_have_the_coordinates_of_the_level() {
    let origin = DVec3::new(500_000.0, 0.0, -5_414_016.0);
    let mut level = world(SceneKind::Rooms, 0.2);
    let middle = (level.grid.min + level.grid.max).as_dvec3() * 0.5;
    let sets = |world: &World, at: DVec3| {
        let [min, max] = [-3.0, 3.0].map(|side| (at + side).as_vec3());
        let places = Places { edge: 2.0, height: None, within: Some(Aabb::new(min, max)) };
        let made = Level::new(world, None, false).unwrap();
        let baker = Baker::new(&made, &places, 8).unwrap();
        baker.run(1, None, &mut |_, _| ControlFlow::Continue(())).unwrap().finish().unwrap()
    };
    let near = sets(&level, middle);
    level.source.origin = origin;
    let far = sets(&level, middle + origin);
    let (near, far) = (casca_bake::Baked::read(&near).unwrap(), casca_bake::Baked::read(&far).unwrap());
    let mut random = generator(7, 0xfa7);
    let mut known = 0;
    for _ in 0..2000 {
        let place = middle + DVec3::from_array(std::array::from_fn(|_| random.random_range(-4.0..4.0)));
        let set = |baked: &casca_bake::Baked, at: DVec3| {
            baked.set_at(at.to_array()).map(|set| set.iter().collect::<Vec<_>>())
        };
        let found = set(&far, place + origin);
        known += usize::from(found.is_some());
        assert_eq!(set(&near, place), found, "{place}");
    }
    assert!(known > 500, "{known}");
}
