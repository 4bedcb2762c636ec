//! Sets by the size of cells, on rocks that do not lie on cells.

use casca_plane::{ConvexPolygon, Disc, GridSpec, Method, ObjectDesc, Query, Scene, View};
use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::setup::{Failure, count, micros};

/// World units along each side.
const SIZE: f32 = 128.0;

/// Turned boxes and discs of 1 to 5 units, and small objects between them. Eyes are in no rock.
fn scene(cells: u32) -> Result<(Scene, Vec<Vec2>), Failure> {
    let spec = GridSpec { min: Vec2::ZERO, cell: SIZE / cells as f32, dims: UVec2::splat(cells) };
    let (mut scene, mut random) = (Scene::new(&spec)?, Pcg64Mcg::seed_from_u64(3));
    let mut rocks = Vec::new();
    let place = |random: &mut Pcg64Mcg, edge: f32| {
        Vec2::new(random.random_range(edge..SIZE - edge), random.random_range(edge..SIZE - edge))
    };
    for i in 0..260 {
        let center = place(&mut random, 8.0);
        let half = Vec2::new(random.random_range(0.5..2.5), random.random_range(0.5..2.5));
        rocks.push((center, half.length()));
        if i % 2 == 0 {
            let disc = Disc::new(center, half.x);
            scene.insert(ObjectDesc::fixed(disc).occluder(disc))?;
        } else {
            let turn = Vec2::from_angle(random.random_range(0.0..6.2));
            let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
            let corners = corners.map(|corner| center + turn.rotate(half * Vec2::from(corner)));
            let rock = ConvexPolygon::new(&corners)?;
            scene.insert(ObjectDesc::fixed(rock.clone()).occluder(rock))?;
        }
    }
    for _ in 0..1500 {
        let disc = Disc::new(place(&mut random, 2.0), 0.25);
        scene.insert(ObjectDesc::fixed(disc).user_data(1))?;
    }
    let is_free = |eye: &Vec2| rocks.iter().all(|(center, reach)| center.distance(*eye) > *reach);
    let eyes = (0..400).map(|_| place(&mut random, 20.0)).filter(is_free).take(40).collect();
    Ok((scene, eyes))
}

/// The table.
pub fn print() -> Result<(), Failure> {
    println!(
        "Resolution: 260 rocks of 1 to 5 units and 1500 objects on {SIZE}x{SIZE} units, means of 40 views all round.\n"
    );
    println!("| grid | cell | PVS | PVS / seen from the eye | µs |");
    println!("|---|---|---|---|---|");
    for cells in [16, 32, 64, 128, 256, 512, 1024, 2048] {
        let (scene, eyes) = scene(cells)?;
        let mut cell = Query::with_method(Method::Cell)?;
        let mut point = Query::with_method(Method::Point)?;
        let (mut pvs, mut evs, mut time) = (0.0, 0.0, 0.0);
        for &eye in &eyes {
            let view = View::all_round(eye)?;
            evs += count(&scene, point.run(&scene, &view));
            time += micros(|| {
                cell.run(&scene, &view);
            });
            pvs += count(&scene, cell.pvs());
        }
        let n = eyes.len() as f64;
        println!(
            "| {cells}² | {:.4} | {:.1} | {:.2} | {:.0} |",
            SIZE / cells as f32,
            pvs / n,
            pvs / evs,
            time / n
        );
    }
    println!();
    Ok(())
}
