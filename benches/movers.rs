//! Reports of 100,000 small moving objects that hide nothing, and queries that see most of them,
//! beside an array of boxes that is written and tested against the frustum.
//!
//! `cargo bench --bench movers`; with a tree, and with hidden objects that go unreported:
//! `casca-lab report`, "Upkeep of moving objects".

use std::hint::black_box;
use std::time::Duration;

use casca::{Aabb, ObjectDesc, ObjectId, Query, Scene, Sphere, View, cell_for};
use criterion::Criterion;
use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{DVec3, Vec3, Vec4, Vec4Swizzles};

const COUNT: usize = 100_000;
const HALL: Vec3 = Vec3::new(128.0, 48.0, 128.0);
const RADIUS: f32 = 0.2;
const GROUP: &str = "movers";

/// Places spread evenly: multiples of irrational numbers, without their whole parts.
fn places() -> Vec<Vec3> {
    let share = DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478);
    let inside = HALL - 4.0;
    (0..COUNT).map(|i| 2.0 + (share * i as f64).fract().as_vec3() * inside).collect()
}

/// All balls, moved by an offset.
fn balls(places: &[Vec3], by: Vec3) -> Vec<Sphere> {
    places.iter().map(|&p| Sphere::new(p + by, RADIUS)).collect()
}

/// Where the balls are, or how they are reported.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Listed,
    Hidden,
    OnExpiry,
}

fn scene(balls: &[Sphere], kind: Kind) -> (Scene, Vec<ObjectId>) {
    let cell = cell_for(Aabb::new(Vec3::ZERO, HALL), COUNT).expect("a plain region");
    let mut scene = Scene::new(cell).expect("a plain grid");
    let desc = |ball| {
        let desc = ObjectDesc::dynamic(ball).max_speed(1.0);
        if kind == Kind::OnExpiry { desc.reported_on_expiry() } else { desc }
    };
    let ids = balls.iter().map(|&ball| scene.insert(desc(ball)).expect("a plain ball")).collect();
    if kind == Kind::Hidden {
        // A view of nothing puts all of them into volumes, some thousand in each frame.
        let mut query = Query::new();
        let away = View::from_planes(Vec3::ONE, &[casca::Plane { normal: Vec3::NEG_X, offset: 1.0 }]);
        for frame in 0..COUNT / casca::MOST_NEW_VOLUMES + 2 {
            scene.begin_frame(f64::from(frame as u32) / 60.0).expect("a finite time");
            query.run(&scene, away.as_ref().expect("a plain view"));
            scene.end_frame([query.pvs()]).expect("a result of this scene");
        }
    }
    (scene, ids)
}

fn view() -> (View, [Vec4; 5]) {
    let eye = Vec3::new(1.0, HALL.y * 0.5, HALL.z * 0.5);
    let m = directx::perspective(1.05, 16.0 / 9.0, 0.1, 300.0) * look_to_mat4(eye, Vec3::X, Vec3::Y);
    let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
    let planes = [w + x, w - x, w + y, w - y, z].map(|p| p / p.xyz().length());
    (View::perspective(eye, m).expect("a plain camera"), planes)
}

/// Frames begun and reports of all balls, in turns at two places.
fn moves(c: &mut Criterion, name: &str, by: Vec3, kind: Kind) {
    let places = places();
    let there = [balls(&places, Vec3::ZERO), balls(&places, by)];
    let (mut scene, ids) = scene(&there[0], kind);
    let (mut turn, mut frame) = (0, 0u32);
    let mut group = c.benchmark_group(GROUP);
    group.bench_function(name, |b| {
        b.iter(|| {
            (turn, frame) = (turn ^ 1, frame + 1);
            // Those that are reported on expiry are all due: no frame ends.
            black_box(scene.begin_frame(1.0 + f64::from(frame) / 60.0).expect("a finite time"));
            scene.update_many(ids.iter().copied().zip(there[turn].iter().copied())).expect("plain moves")
        });
    });
}

fn main() {
    let mut c = Criterion::default().configure_from_args();
    c = c.sample_size(20).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1));
    moves(&mut c, "a step", Vec3::splat(0.01), Kind::Listed);
    moves(&mut c, "a step, hidden", Vec3::splat(0.01), Kind::Hidden);
    moves(&mut c, "a step, on expiry", Vec3::splat(0.01), Kind::OnExpiry);
    // A brick has 2.45 m.
    moves(&mut c, "to another brick", Vec3::X * 1.9, Kind::Listed);
    let places = places();
    let (balls, (view, planes)) = (balls(&places, Vec3::ZERO), view());
    let (scene, _) = scene(&balls, Kind::Listed);
    let mut query = Query::new();
    let mut group = c.benchmark_group(GROUP);
    group.bench_function("query", |b| b.iter(|| query.run(&scene, &view).len()));
    let seen = query.pvs().len();
    let mut boxes = vec![(Vec3::ZERO, Vec3::ZERO); COUNT];
    group.bench_function("array, written", |b| {
        b.iter(|| {
            for (own, ball) in boxes.iter_mut().zip(black_box(&balls)) {
                *own = (ball.center - ball.radius, ball.center + ball.radius);
            }
        });
    });
    let mut found = Vec::new();
    group.bench_function("array, tested", |b| {
        b.iter(|| {
            found.clear();
            for (i, (min, max)) in boxes.iter().enumerate() {
                let inside = |p: &Vec4| {
                    let far = Vec3::select(p.xyz().cmpge(Vec3::ZERO), *max, *min);
                    p.xyz().dot(far) + p.w >= 0.0
                };
                if planes.iter().all(inside) {
                    found.push(i as u32);
                }
            }
            found.len()
        });
    });
    group.finish();
    c.final_summary();
    println!("{seen} of {COUNT} objects are in the set, {} in the frustum", found.len());
}
