//! How times and memory grow: with hidden and visible objects and with triangles.

use std::f32::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;

use casca::{MeshOptions, Method, Query, TriMesh};
use glam::{Affine3A, Vec2, Vec3};
use rand::RngExt;
use rayon::ThreadPoolBuilder;

use super::upkeep::Arena;
use super::{ASPECT, BUFFER, Contender, FrameInput, Lab, LabError, Section, Table, grouped, median, p99};
use casca_scenes::drive::{Driver, fitted_grid, view_of};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::{timed, timed_by_wall};
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Animation, Camera, GridHint, Mesh, Motion, Object, Shape, World};

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
    let grid = fitted_grid(world)?;
    // Several threads prepare meshes.
    let (driver, setup) = timed_by_wall(|| Driver::new(world, &grid, |_| ()));
    let driver = driver?;
    let mut frustum = Query::with_method(Method::Frustum)?;
    let mut contenders = [Contender::hzb(BUFFER.0, BUFFER.1), Contender::casca("", Method::point())?];
    let mut times = [Vec::new(), Vec::new()];
    let (mut in_frustum_sum, mut found_sum) = (0, 0);
    let views = views.clamp(1, world.frames.max(1));
    for i in 0..views {
        let camera = world.camera(i * world.frames / views, ASPECT);
        let pvs = frustum.run(&driver.scene, &view_of(&camera)?);
        let in_frustum: Vec<usize> = (0..world.objects.len()).filter(|&o| driver.sees(pvs, o)).collect();
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

/// A quantity that grows: its name, its sizes, and the world of a size.
struct Series<'a> {
    name: &'static str,
    sizes: Vec<usize>,
    build: &'a dyn Fn(usize) -> World,
}

/// How the default method scales. A full run has a million objects and ten million triangles.
///
/// # Errors
/// If a scene is refused.
pub fn scaling(lab: &Lab) -> Result<Section, LabError> {
    let seed = lab.seed;
    let (views, repeats) = lab.pick((100, 3), (2, 1));
    let series = [
        Series {
            name: "hidden objects",
            sizes: lab.pick(vec![5000, 100_000, 1_000_000], vec![500, 2000]),
            build: &|n| {
                let options = SceneOptions { seed, beyond_walls: Some(n), ..SceneOptions::default() };
                build(SceneKind::Spheres, &options)
            },
        },
        Series {
            name: "visible movers",
            sizes: lab.pick(vec![100, 1000, 10_000, 100_000], vec![100, 500]),
            build: &|n| {
                // The view holds about five of six.
                let arena = Arena { count: n * 6 / 5, hidden: false, fast: false, seed };
                World { frames: 150, ..arena.build() }
            },
        },
        Series {
            name: "triangles",
            sizes: lab.pick(vec![10_000, 100_000, 1_000_000, 10_000_000], vec![2000, 20_000]),
            build: &|n| ground(n, seed),
        },
    ];
    let columns = [
        "series",
        "size",
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
    let mut findings = String::new();
    for Series { name, sizes, build } in series {
        let mut ends: [Option<(usize, Row)>; 2] = [None; 2];
        for &size in &sizes {
            (lab.progress)(&format!("{name}: {}", grouped(size)));
            let row = measure(&build(size), views, repeats)?;
            ends = [ends[0].or(Some((size, row))), Some((size, row))];
            let counts = [row.in_frustum, row.found].map(|n| format!("{n:.1}"));
            let times = [row.point[0], row.point[1], row.hzb[0], row.hzb[1]].map(|ms| format!("{ms:.4}"));
            let costs = [format!("{:.4}", row.setup), format!("{:.3}", row.memory / 1e6)];
            let first = [name.to_owned(), size.to_string(), row.objects.to_string()];
            table.row(first.into_iter().chain(counts).chain(times).chain(costs));
        }
        let [Some((small, first)), Some((large, last))] = ends else { continue };
        findings += &format!(
            "- {name}, {} to {}: a query of `point` takes {:.1} times as long ({:.2} ms), one of `hzb` {:.0} \
             times; setup {:.2} s, {:.0} MB.\n",
            grouped(small),
            grouped(large),
            last.point[0] / first.point[0].max(f64::MIN_POSITIVE),
            last.point[0],
            last.hzb[0] / first.hzb[0].max(f64::MIN_POSITIVE),
            last.setup,
            last.memory / 1e6
        );
    }
    let mut section = Section::new("Scaling");
    section.text(format!(
        "Fresh queries of `point` from {views} views, each with the least of {repeats} runs, and `hzb` with \
         {}x{} pixels. *Hidden objects* are static spheres beyond the closed walls of the thesis' hall; \
         *visible movers* are small spheres in the open; *triangles* are those of a rolling ground of 320 m, \
         in 100 meshes with 2,000 boxes on them.",
        BUFFER.0, BUFFER.1
    ));
    section.text(findings);
    section.rows("All sizes as CSV", table);
    preparation(lab, &mut section)?;
    Ok(section)
}

/// How fast one thread prepares meshes.
fn preparation(lab: &Lab, section: &mut Section) -> Result<(), LabError> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let columns = ["meshes", "triangles", "seconds", "triangles a second", "MB"];
    let mut table = Table::new("scaling-preparation", &columns);
    let (mut times, mut sizes) = (Vec::new(), Vec::new());
    type Build = fn(usize, u64) -> Vec<Arc<Mesh>>;
    let kinds: [(&str, Build); 3] = [
        ("ground, 100 meshes", |n, seed| {
            let objects = ground(n, seed).objects.into_iter();
            let mesh = |o: Object| if let Shape::Mesh { mesh, .. } = o.shape { Some(mesh) } else { None };
            objects.filter_map(mesh).collect()
        }),
        ("balls of 320 triangles", |n, _| {
            std::iter::repeat_n(Arc::new(Mesh::ball(2)), n.div_ceil(320)).collect()
        }),
        ("soup, one mesh", |n, seed| vec![Arc::new(soup(n, seed))]),
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
                let (positions, corners) = (mesh.positions.clone(), mesh.triangles.clone());
                triangles += corners.len();
                let go_on = &mut |_| ControlFlow::Continue(());
                let (prepared, time) = pool.install(|| {
                    timed(|| TriMesh::prepare(positions, corners, &MeshOptions::default(), go_on))
                });
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

/// The ground: its size, and the number of meshes along each side.
const GROUND: f32 = 320.0;
const TILES: usize = 10;
const BOXES: usize = 2000;
const EYE: f32 = 1.7;
const FRAMES: usize = 150;

/// Hills: waves of several lengths and directions.
#[derive(Clone)]
struct Hills([(Vec2, f32, f32); 12]);

impl Hills {
    fn new(dice: &mut Generator) -> Self {
        Self(std::array::from_fn(|i| {
            let length = 90.0 * 0.75f32.powi(i as i32);
            let way = Vec2::from_angle(TAU * dice.random::<f32>()) * TAU / length;
            (way, TAU * dice.random::<f32>(), 0.05 * length)
        }))
    }

    fn at(&self, p: Vec2) -> f32 {
        20.0 + self.0.iter().map(|(way, phase, height)| height * (way.dot(p) + phase).sin()).sum::<f32>()
    }
}

/// Nothing moves but the camera: a round about the middle, with a look ahead.
impl Animation for Hills {
    fn shapes(&self, _: usize, _: &mut dyn FnMut(usize, Shape)) {}

    fn camera(&self, frame: usize, aspect: f32) -> Camera {
        let way = Vec2::from_angle(TAU * frame as f32 / FRAMES as f32);
        let p = Vec2::splat(GROUND * 0.5) + way * GROUND * 0.25;
        let eye = Vec3::new(p.x, self.at(p) + EYE, p.y);
        let ahead = way.perp();
        Camera::look_at(eye, eye + Vec3::new(ahead.x, -0.05, ahead.y), 60.0, aspect, 0.1, 500.0)
    }
}

/// A square of the ground with this many squares of two triangles along each side.
fn tile(hills: &Hills, corner: Vec2, squares: usize) -> Mesh {
    let (side, pitch) = (squares + 1, GROUND / (TILES * squares) as f32);
    let vertex = |i: usize| {
        let p = corner + Vec2::new((i % side) as f32, (i / side) as f32) * pitch;
        Vec3::new(p.x, hills.at(p), p.y)
    };
    let square = |i: usize| {
        let a = (i / squares * side + i % squares) as u32;
        let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
        [[a, d, b], [a, c, d]]
    };
    Mesh {
        positions: (0..side * side).map(vertex).collect(),
        triangles: (0..squares * squares).flat_map(square).collect(),
        ..Mesh::default()
    }
}

/// Rolling ground of about this many triangles, and boxes on it. The hills are the same for any
/// number.
fn ground(triangles: usize, seed: u64) -> World {
    let mut dice = generator(seed, 0x6e0d);
    let hills = Hills::new(&mut dice);
    let squares = ((triangles as f64 / (2 * TILES * TILES) as f64).sqrt().round() as usize).max(1);
    let fixed = |shape, occludes| Object {
        name: String::new(),
        shape,
        motion: Motion::Static,
        occludes,
        tested: true,
    };
    let tile = |i: usize| {
        let corner = Vec2::new((i % TILES) as f32, (i / TILES) as f32) * (GROUND / TILES as f32);
        let mesh = Arc::new(tile(&hills, corner, squares));
        fixed(Shape::Mesh { mesh, transform: Affine3A::IDENTITY }, true)
    };
    let mut objects: Vec<Object> = (0..TILES * TILES).map(tile).collect();
    for _ in 0..BOXES {
        let p = Vec2::new(dice.random::<f32>(), dice.random::<f32>()) * (GROUND - 2.0) + 1.0;
        let (base, half) = (Vec3::new(p.x, hills.at(p), p.y), 0.2 + 0.6 * dice.random::<f32>());
        objects.push(fixed(Shape::Box { min: base - half, max: base + half }, false));
    }
    World {
        source: Default::default(),
        name: "ground".to_owned(),
        objects,
        grid: GridHint { min: Vec3::ZERO, max: Vec3::new(GROUND, 60.0, GROUND), cell: 1.0 },
        frames: FRAMES,
        animation: Box::new(hills),
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::walker::{item_buffer, visible_in};

    #[test]
    fn the_hills_hide_most_and_nothing_of_the_rest_is_lost() {
        let world = ground(20_000, 7);
        let all: usize = world
            .objects
            .iter()
            .map(|o| if let Shape::Mesh { mesh, .. } = &o.shape { mesh.triangles.len() } else { 0 })
            .sum();
        assert!((all as f64 / 20_000.0 - 1.0).abs() < 0.2, "{all}");
        let seen = visible_in(&mut item_buffer(640), &world.objects, &world.camera(0, ASPECT)).len();
        assert!(seen > 20 && seen < 1500, "{seen}");
        let row = measure(&world, 1, 1).unwrap();
        assert!(row.found >= seen as f64 && row.found <= row.in_frustum && row.memory > 0.0, "{row:?}");
    }
}
