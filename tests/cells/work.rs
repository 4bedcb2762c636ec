//! The work of the cell method follows what is seen and what the scene contains, not the volume of
//! the grid; and walks that end early find what whole walks find.

use casca::internals::QueryInternals;

use crate::common::*;

const SIZE: f32 = 1024.0;

fn cell() -> Query {
    query_by(Method::cell())
}

fn ball(scene: &mut Scene, at: Vec3) -> ObjectId {
    scene.fixed(Sphere::new(at, 0.4))
}

fn work(query: &mut Query, scene: &Scene, eye: Vec3) -> Stats {
    *query.run(scene, &around(eye)).stats()
}

#[test]
fn an_eye_inside_a_large_solid_visits_no_cells() {
    let mut scene = empty();
    let whole = scene.solid(Aabb::new(Vec3::splat(0.5), Vec3::splat(SIZE - 0.5)));
    let balls: Vec<ObjectId> = (1..9).map(|i| ball(&mut scene, Vec3::splat(100.0 * i as f32))).collect();
    let movers = [false, true].map(|on_expiry| {
        let desc = ObjectDesc::dynamic(Sphere::new(Vec3::new(700.0, 300.0, 500.0), 0.4)).max_speed(1.0);
        scene.insert(if on_expiry { desc.reported_on_expiry() } else { desc }).unwrap()
    });
    let mut query = cell();
    // From outside, all in the solid is hidden: the moving objects get volumes.
    query.run(&scene, &around(Vec3::splat(-5.0)));
    assert_eq!(query.pvs().visible(), [whole]);
    scene.end_frame([query.pvs()]).unwrap();
    assert!(movers.iter().all(|&id| scene.tbv(id).unwrap().is_some()));

    let eye = Vec3::splat(110.3);
    let stats = work(&mut query, &scene, eye);
    assert!(stats.eye_in_occluder && query.pvs().view_cell().is_none());
    assert_eq!((stats.cells_visited, stats.shells, stats.tbvs_revealed), (0, 0, 2));
    assert_eq!((query.pvs().len(), query.pvs().revealed()), (11, &movers[..]));
    // Front to back.
    let place = |id: ObjectId| query.pvs().iter().position(|seen| seen == id).unwrap();
    assert!(balls.windows(2).all(|pair| place(pair[0]) < place(pair[1])));
    assert!(movers.iter().all(|&id| place(id) > place(balls[5]) && place(id) < place(balls[7])));

    // A view of one side has what lies there.
    let pvs = query.run(&scene, &looking(eye, Vec3::NEG_ONE, [0.8, 1.0, 0.1, 4.0 * SIZE]));
    assert_eq!((pvs.visible(), pvs.revealed()), (&[whole, balls[0]][..], &[][..]));
    assert_eq!(pvs.stats().cells_visited, 0);
}

#[test]
fn an_eye_before_a_large_solid_visits_few_cells() {
    let mut scene = empty();
    scene.solid(Aabb::new(Vec3::splat(0.5), Vec3::splat(SIZE - 0.5)));
    let inside: Vec<ObjectId> = (0..200)
        .map(|i| {
            let share = Vec3::new(i as f32 / 200.0, (i * 37 % 199) as f32 / 200.0, (i % 7) as f32 / 7.0);
            let at = share * 800.0 + 100.0;
            let ball = Sphere::new(at, 0.4);
            scene.insert(if i % 2 == 0 {
                ObjectDesc::fixed(ball)
            } else {
                ObjectDesc::dynamic(ball).max_speed(1.0)
            })
        })
        .collect::<Result<_, _>>()
        .unwrap();
    let mut query = cell();
    for frame in 0..2 {
        scene.begin_frame(f64::from(frame)).unwrap();
        for eye in [Vec3::splat(-5.0), Vec3::new(-5.0, 400.0, 700.0), Vec3::new(500.0, 1030.0, 500.0)] {
            let stats = work(&mut query, &scene, eye);
            assert!(!stats.eye_in_occluder && inside.iter().all(|&id| !query.pvs().contains(id)));
            assert!(query.pvs().revealed().is_empty());
            assert!(stats.cells_visited < 2_000_000, "{eye}: {stats:?}");
        }
        // The second time, moving objects are in volumes.
        scene.end_frame([query.pvs()]).unwrap();
    }
    assert!(scene.tbv(inside[1]).unwrap().is_some());
}

#[test]
fn the_last_of_many_solids_ends_a_walk() {
    let mut scene = empty();
    // A wall before the eye, at the border of the grid, hides the others.
    let wall = scene.solid(Aabb::new(Vec3::new(20.0, 0.0, 0.0), Vec3::new(40.0, SIZE, SIZE)));
    let near = ball(&mut scene, Vec3::new(3.0, 500.0, 520.0));
    for i in 0..27u32 {
        let at = UVec3::new(i % 3, i / 3 % 3, i / 9).as_vec3() * 320.0 + 60.0;
        scene.solid(Aabb::new(at, at + 150.0));
        ball(&mut scene, at + 200.0);
    }
    for eye in [Vec3::new(0.5, 500.5, 500.5), Vec3::new(-4.5, 500.5, 500.5)] {
        let mut query = cell();
        let stats = work(&mut query, &scene, eye);
        assert!(query.pvs().len() == 2 && query.pvs().contains(wall) && query.pvs().contains(near));
        assert!(stats.cells_visited < 6_000_000, "{eye}: {stats:?}");
    }
    // A ball along the wall is seen, and the hidden part of each shell is passed over.
    let far = ball(&mut scene, Vec3::new(3.0, 500.0, SIZE - 4.0));
    let mut query = cell();
    let stats = work(&mut query, &scene, Vec3::new(0.5, 500.5, 500.5));
    assert!(query.pvs().len() == 3 && query.pvs().contains(far));
    assert!(stats.cells_visited < 40_000_000, "{stats:?}");
}

#[test]
fn empty_grids_are_answered_at_once() {
    let mut scene = empty();
    let mut query = cell();
    for eye in [Vec3::splat(512.5), Vec3::splat(-20.0), Vec3::new(0.5, 3.5, 1023.5)] {
        let stats = work(&mut query, &scene, eye);
        assert!(stats.cells_visited <= 1 && stats.shells == 0, "{eye}: {stats:?}");
    }
    // After its only object, a walk ends.
    ball(&mut scene, Vec3::splat(700.0));
    let stats = work(&mut query, &scene, Vec3::splat(690.5));
    assert!(query.pvs().len() == 1 && stats.shells < 12 && stats.cells_visited < 20_000, "{stats:?}");
}

#[test]
fn walks_go_on_to_the_border_where_overhanging_objects_are_seen() {
    let mut scene = empty();
    // It hides what the antenna has in the grid, not what it has above.
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 15.0), Vec3::new(40.0, 40.0, 17.0));
    scene.solid(wall);
    let mut antenna = |top| {
        let b = Aabb::new(Vec3::new(20.0, 38.0, 20.0), Vec3::new(22.0, top, 22.0));
        scene.fixed(b)
    };
    let (short, tall) = (antenna(40.0), antenna(80.0));
    let mut query = cell();
    work(&mut query, &scene, Vec3::new(20.5, 2.5, 5.5));
    assert!(!query.pvs().contains(short), "the wall hides it");
    assert!(query.pvs().contains(tall), "it is seen above the wall");
}

#[test]
fn objects_farther_away_than_cells_can_be_numbered_are_found() {
    for far in [1e9f32, 1e10, 1e32] {
        for axis in 0..3 {
            let mut scene = empty();
            let half = 5.3;
            let mut at = Vec3::splat(11.0);
            at[axis] = far;
            let beyond = [at, -at].map(|at| Sphere::new(at, half));
            let beyond = beyond.map(|ball| scene.insert(ObjectDesc::dynamic(ball).occluder(ball)).unwrap());
            let mut pole = Aabb::from_center(Vec3::splat(11.0), Vec3::splat(0.2));
            (pole.min[axis], pole.max[axis]) = (-far, far);
            let pole = scene.fixed(pole);
            ball(&mut scene, Vec3::splat(20.0));
            for eye in [Vec3::splat(3.5), Vec3::new(0.5, 21.5, 12.5)] {
                let mut query = cell();
                work(&mut query, &scene, eye);
                assert!(beyond.iter().all(|&id| query.pvs().contains(id)), "{far} along {axis} from {eye}");
                assert!(query.pvs().contains(pole), "{far} along {axis} from {eye}");
            }
        }
    }
}

fn place(random: &mut Random) -> Vec3 {
    random.place(0.0, 1.0, 0.125)
}

/// Solids, balls that move and balls that stay, some overhanging the grid, some on another layer.
pub fn some_scene(random: &mut Random, size: u32) -> Scene {
    let mut scene = empty();
    let largest = random.unit() * 0.4 * size as f32;
    for i in 0..(random.unit() * 120.0) as u32 + 4 {
        let at = place(random) * size as f32;
        let desc = match i % 5 {
            0 => {
                let b = Aabb::from_center(at, place(random) * largest + 1.0);
                ObjectDesc::fixed(b).occluder(b)
            }
            1 => {
                let b = Sphere::new(at, 1.0 + random.unit() * 0.05 * size as f32);
                ObjectDesc::dynamic(b).occluder(b)
            }
            2 => ObjectDesc::dynamic(Sphere::new(at, 0.5)).max_speed(2.0),
            3 => ObjectDesc::dynamic(Sphere::new(at, 0.5)).max_speed(2.0).reported_on_expiry(),
            _ => ObjectDesc::fixed(Aabb::from_center(at, place(random) * 3.0)),
        };
        scene.insert(if i % 11 == 7 { desc.layers(2) } else { desc }).unwrap();
    }
    // A thin sheet far beyond the grid, and something beyond it.
    let height = random.unit() * size as f32;
    let (min, max) = (Vec3::new(-1e30, height, -1e6), Vec3::new(1e30, height + 0.2, 1e6));
    scene.fixed(Aabb::new(min, max));
    scene.fixed(Sphere::new(Vec3::splat(size as f32 + 3.0), 1.0));
    scene
}

pub fn some_views(random: &mut Random, size: f32) -> Vec<View> {
    let outside = Vec3::new(-0.3 * random.unit(), random.unit(), random.unit()) * size;
    let border = Vec3::new(0.5, random.unit() * size, random.unit() * size);
    let mut views = Vec::new();
    for eye in [place(random) * size, outside, border, place(random) * 8.0 - 4.0 + size] {
        let toward = (Vec3::splat(size * 0.5) - eye + place(random) * 0.3 * size).normalize();
        let camera = look_to_mat4(eye, toward, Vec3::Y);
        let wide = directx::perspective(0.3 + random.unit(), 1.5, 0.1, 2.0 * size) * camera;
        let flat = directx::orthographic(-0.3 * size, 0.3 * size, -0.2 * size, 0.2 * size, 0.0, 2.0 * size);
        views.push(around(eye));
        views.push(View::perspective(eye, wide).unwrap());
        views.push(View::from_view_projection(wide).unwrap());
        views.push(View::orthographic(toward, flat * camera).unwrap());
    }
    views
}

#[test]
fn walks_that_end_early_find_what_whole_walks_find() {
    let mut random = Random(3);
    let (mut hidden, mut ended, mut revealed, mut open) = (0, 0, 0, 0);
    for size in [40, 96, 40, 96, 130, 64, 40, 80, 96, 64] {
        let mut scene = some_scene(&mut random, size);
        for frame in 0..2 {
            scene.begin_frame(f64::from(frame) * 0.2).unwrap();
            for view in some_views(&mut random, size as f32) {
                let (mut query, mut whole) = (cell(), cell());
                // A query that records cells visits all of them.
                whole.record_cells(true);
                let (a, b) = (query.run(&scene, &view), whole.run(&scene, &view));
                let found = |pvs: &Pvs| {
                    let order = |ids: &[ObjectId]| ids.iter().copied().collect::<BTreeSet<_>>();
                    (order(pvs.visible()), order(pvs.revealed()))
                };
                assert_eq!(found(a), found(b), "{view:?}");
                assert_eq!(a.view_cell(), b.view_cell());
                assert!(a.stats().shells <= b.stats().shells);
                ended += u32::from(a.stats().shells < b.stats().shells);
                revealed += a.revealed().len();
                let mut frustum = query_by(Method::Frustum);
                let all = frustum.run(&scene, &view);
                if a.view_cell().is_some() {
                    hidden += all.iter().filter(|&id| !a.contains(id)).count();
                } else {
                    // Objects that move unseen may be anywhere in their volumes.
                    assert!(all.iter().all(|id| a.contains(id)), "{view:?}");
                    assert!(a.iter().all(|id| all.contains(id) || a.revealed().contains(&id)), "{view:?}");
                    open += 1;
                }
            }
            look(&mut scene, &mut Query::new(), &around(place(&mut random) * size as f32));
        }
    }
    println!(
        "{hidden} hidden, {ended} walks ended early, {revealed} volumes revealed, {open} without occlusion"
    );
    assert!(hidden > 300 && ended > 50 && revealed > 100 && open > 30);
}
