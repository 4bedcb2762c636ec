//! How times and memory grow with hidden objects, and how fast meshes are prepared.

use std::f32::consts::TAU;
use std::ops::ControlFlow;

use casca::{MeshOptions, Method, Query, TriMesh};
use glam::{Vec2, Vec3};
use rand::RngExt;

use super::{ASPECT, BUFFER, Contender, FrameInput, Lab, LabError, Section, Table, grouped, median, p99};
use casca_scenes::drive::{Driver, fitted_cell, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::random::generator;
use casca_scenes::world::{Mesh, Motion, Object, World};

/// What one size costs.
#[derive(Debug, Clone, Copy)]
struct Row {
    objects: usize,
    /// Seconds to make the scene, meshes included.
    setup: f64,
    /// Bytes of the scene after the queries.
    memory: f64,
    /// Objects in the frustum and in the set of `point`: means.
    in_frustum: f64,
    found: f64,
    /// Milliseconds over all views: median and 99th percentile.
    point: [f64; 2],
    hzb: [f64; 2],
}

/// Measures a world from this many views of its walk, in the grid that fits; the least of `repeats`
/// runs from each counts.
fn measure(world: &World, views: usize, repeats: usize) -> Result<Row, LabError> {
    let cell = fitted_cell(world)?;
    let (driver, setup) = timed(|| Driver::new(world, cell, |_| ()));
    let driver = driver?;
    let mut frustum = Query::with_method(Method::Frustum)?;
    let mut contenders = [Contender::hzb(BUFFER.0, BUFFER.1), Contender::casca("", Method::point())?];
    let mut times = [Vec::new(), Vec::new()];
    let (mut in_frustum_sum, mut found_sum) = (0, 0);
    let views = views.clamp(1, world.frames.max(1));
    for i in 0..views {
        let camera = world.camera(i * world.frames / views, ASPECT);
        let pvs = frustum.run(&driver.scene, &view_of(&camera)?);
        let in_frustum = driver.found(pvs);
        let input =
            FrameInput { driver: &driver, objects: &world.objects, in_frustum: &in_frustum, camera: &camera };
        let mut least = [f64::INFINITY; 2];
        // The first run of all takes memory, and does not count.
        for round in 0..repeats.max(1) + usize::from(i == 0) {
            for (contender, least) in contenders.iter_mut().zip(&mut least) {
                let time = contender.run(&input)?.as_secs_f64() * 1e3;
                *least = if i > 0 || round > 0 { least.min(time) } else { *least };
            }
        }
        times.iter_mut().zip(least).for_each(|(times, least)| times.push(least));
        in_frustum_sum += in_frustum.len();
        found_sum += contenders[1].found().len();
    }
    let [hzb, point] = times.map(|mut ms| [median(&mut ms), p99(&mut ms)]);
    Ok(Row {
        objects: world.objects.len(),
        setup: setup.as_secs_f64(),
        memory: driver.scene.memory().total() as f64,
        in_frustum: in_frustum_sum as f64 / views as f64,
        found: found_sum as f64 / views as f64,
        point,
        hzb,
    })
}

/// How the default method scales. A full run has a million objects.
///
/// # Errors
/// If a scene is refused.
pub fn scaling(lab: &Lab) -> Result<Section, LabError> {
    let (views, repeats) = lab.pick((100, 3), (2, 1));
    let sizes = lab.pick([5000, 100_000, 1_000_000], [500, 1000, 2000]);
    let columns = [
        "hidden objects",
        "objects",
        "in the frustum",
        "PVS of point",
        "point, ms",
        "point p99, ms",
        "hzb, ms",
        "hzb p99, ms",
        "setup, s",
        "memory, MB",
    ];
    let mut table = Table::new("scaling", &columns);
    let mut rows = Vec::with_capacity(sizes.len());
    for size in sizes {
        (lab.progress)(&format!("hidden objects: {}", grouped(size)));
        let hidden = SceneOptions { seed: lab.seed, beyond_walls: Some(size), ..SceneOptions::default() };
        let row = measure(&build(SceneKind::Spheres, &hidden), views, repeats)?;
        let counts = [row.in_frustum, row.found].map(|n| format!("{n:.1}"));
        let times = [row.point[0], row.point[1], row.hzb[0], row.hzb[1]].map(|ms| format!("{ms:.4}"));
        let costs = [format!("{:.4}", row.setup), format!("{:.3}", row.memory / 1e6)];
        let first = [size.to_string(), row.objects.to_string()];
        table.row(first.into_iter().chain(counts).chain(times).chain(costs));
        rows.push(row);
    }
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let mut section = Section::new("Scaling");
    section.text(format!(
        "Fresh queries of `point` from {views} views, each with the least of {repeats} runs, and `hzb` with \
         {}x{} pixels, among static spheres beyond the closed walls of the thesis' hall. **With {} such \
         hidden objects instead of {}, a query of `point` takes {:.1} times as long ({:.2} ms), one of `hzb` \
         {:.0} times;** setup {:.2} s, {:.0} MB.",
        BUFFER.0,
        BUFFER.1,
        grouped(sizes[sizes.len() - 1]),
        grouped(sizes[0]),
        last.point[0] / first.point[0].max(f64::MIN_POSITIVE),
        last.point[0],
        last.hzb[0] / first.hzb[0].max(f64::MIN_POSITIVE),
        last.setup,
        last.memory / 1e6
    ));
    section.rows("All sizes as CSV", table);
    let world = large_city(lab, lab.pick(19, 3));
    let row = measure(&world, views, repeats)?;
    section.text(format!(
        "A city of {} static objects is set up in {:.2} s and takes {:.0} bytes an object; a query of `point` \
         in its streets takes {:.2} ms and finds {:.0} of {:.0} objects in the frustum, `hzb` takes {:.1} ms.",
        grouped(row.objects),
        row.setup,
        row.memory / row.objects as f64,
        row.point[0],
        row.found,
        row.in_frustum,
        row.hzb[0]
    ));
    preparation(lab, &mut section)?;
    Ok(section)
}

/// The city in square tiles, an odd number in a row, without motion; the camera walks in the middle one.
fn large_city(lab: &Lab, side: i32) -> World {
    let mut city = build(SceneKind::City, &SceneOptions { seed: lab.seed, ..SceneOptions::default() });
    let edge = (city.grid.max - city.grid.min) * Vec3::new(1.0, 0.0, 1.0);
    let moved = |object: &Object, by: Vec3| {
        let shape = object.shape.moved(by);
        Object { name: String::new(), shape, motion: Motion::Static, ..*object }
    };
    let tile = std::mem::take(&mut city.objects);
    for i in 0..side * side {
        let at = Vec3::new((i % side - side / 2) as f32, 0.0, (i / side - side / 2) as f32) * edge;
        city.objects.extend(tile.iter().map(|object| moved(object, at)));
    }
    let more = edge * (side / 2) as f32;
    (city.grid.min, city.grid.max) = (city.grid.min - more, city.grid.max + more);
    city
}

/// How fast one thread prepares meshes.
fn preparation(lab: &Lab, section: &mut Section) -> Result<(), LabError> {
    let columns = ["meshes", "triangles", "seconds", "triangles a second", "MB"];
    let mut table = Table::new("scaling-preparation", &columns);
    let (mut times, mut sizes) = (Vec::new(), Vec::new());
    type Build = fn(usize, u64) -> Vec<Mesh>;
    let kinds: [(&str, Build); 3] = [
        ("ground, 100 meshes", ground),
        ("balls of 320 triangles", |n, _| vec![Mesh::ball(2); n.div_ceil(320)]),
        ("soup, one mesh", |n, seed| vec![soup(n, seed)]),
    ];
    for (i, (name, build)) in kinds.into_iter().enumerate() {
        // Ten millions in one mesh would take gigabytes.
        for size in [10_000, 1_000_000, 10_000_000] {
            if size > lab.pick(if i == 0 { 10_000_000 } else { 1_000_000 }, 10_000) {
                continue;
            }
            (lab.progress)(&format!("preparation of {name}: {} triangles", grouped(size)));
            let (mut seconds, mut triangles, mut bytes) = (0.0, 0, 0);
            for mesh in build(size, lab.seed) {
                let (positions, corners) = (mesh.positions, mesh.triangles);
                triangles += corners.len();
                let go_on = &mut |_| ControlFlow::Continue(());
                let (prepared, time) =
                    timed(|| TriMesh::prepare(positions, corners, &MeshOptions::default(), go_on));
                bytes += prepared?.memory_bytes();
                seconds += time.as_secs_f64();
            }
            let each = triangles.max(1) as f64;
            times.push(seconds * 1e6 / each);
            sizes.push(bytes as f64 / each);
            table.row([
                name.to_owned(),
                triangles.to_string(),
                format!("{seconds:.3}"),
                format!("{:.0}", each / seconds.max(f64::MIN_POSITIVE)),
                format!("{:.2}", bytes as f64 / 1e6),
            ]);
        }
    }
    let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    section.text(format!(
        "One thread prepares meshes (`TriMesh::prepare`) in {:.1} to {:.1} us and {:.0} to {:.0} bytes a triangle.",
        least(&times),
        most(&times),
        least(&sizes),
        most(&sizes)
    ));
    section.rows("All preparations as CSV", table);
    Ok(())
}

/// Rolling ground of about this many triangles, in 100 square meshes of 32 m.
fn ground(triangles: usize, _: u64) -> Vec<Mesh> {
    let wave = |along: f32, height: f32, length: f32| height * (TAU * along / length).sin();
    let height =
        |p: Vec2| wave(p.x + 0.7 * p.y, 4.5, 90.0) + wave(p.y - 0.3 * p.x, 1.6, 31.0) + wave(p.x, 0.3, 7.0);
    let squares = ((triangles as f64 / 200.0).sqrt().round() as u32).max(1);
    let tile = |tile: usize| {
        Mesh::sheet(squares, squares, |i, j| {
            let at = [i, j].map(|n| n as f32 / squares as f32);
            let p = (Vec2::new((tile % 10) as f32, (tile / 10) as f32) + Vec2::from(at)) * 32.0;
            Vec3::new(p.x, height(p), p.y)
        })
    };
    (0..100).map(tile).collect()
}

/// Triangles of about a tenth of a metre, each with vertices of its own, anywhere in a cube of 10
/// m.
fn soup(triangles: usize, seed: u64) -> Mesh {
    let mut dice = generator(seed, 0x50a9);
    let mut point = |size: f32| Vec3::new(dice.random(), dice.random(), dice.random()) * size;
    let positions = (0..triangles).flat_map(|_| {
        let at = point(10.0);
        [at, at + point(0.1), at + point(0.1)]
    });
    let positions = positions.collect();
    let corners = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
    Mesh { positions, triangles: (0..triangles as u32).map(corners).collect(), ..Mesh::default() }
}
