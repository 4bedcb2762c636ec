//! Entries that are found, missing, damaged and of others.

use casca::Facing;
use casca_scenes::world::Mesh;

use super::*;

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("casca-cache-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        Self(folder)
    }

    fn cache(&self) -> MeshCache {
        MeshCache::new(&self.0).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Meshes of several kinds: round, with corners, open, flat, of several pieces.
fn meshes() -> Vec<Mesh> {
    let cone = |at: f32| Mesh {
        positions: (0..9)
            .map(|i| match i {
                8 => Vec3::new(at, 3.0, 0.0),
                i => Vec3::new(at + (i as f32 * 0.785).cos(), 0.0, (i as f32 * 0.785).sin()),
            })
            .collect(),
        triangles: (0..8).map(|i| [i, 8, (i + 1) % 8]).collect(),
        ..Mesh::default()
    };
    let mut cones = cone(0.0);
    cones.append(cone(5.0));
    let mut rock = Mesh::ball(3);
    rock.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.2 * (p.x * 5.0).sin());
    let board = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::NEG_Y * 0.0 + Vec3::Z],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    vec![Mesh::ball(2), rock, Mesh::cuboid(Vec3::ZERO, Vec3::ONE), cones, board]
}

fn ask(cache: &MeshCache, mesh: &Mesh, how: &MeshOptions) -> TriMesh {
    let go_on = &mut |_| ControlFlow::Continue(());
    cache.prepare(mesh.positions.clone(), mesh.triangles.clone(), how, go_on).unwrap()
}

fn fresh(mesh: &Mesh, how: &MeshOptions) -> TriMesh {
    let go_on = &mut |_| ControlFlow::Continue(());
    TriMesh::prepare(mesh.positions.clone(), mesh.triangles.clone(), how, go_on).unwrap()
}

fn counts(hits: usize, misses: usize) -> CacheCounts {
    CacheCounts { hits, misses, unwritten: 0 }
}

fn options() -> Vec<MeshOptions> {
    let how = MeshOptions::default();
    vec![
        how,
        how.tolerance(0.05),
        how.tolerance(0.050_000_004),
        how.min_radius(0.3),
        how.max_angle(30.0),
        how.facing(Facing::Front),
        how.occludes(false),
    ]
}

#[test]
fn a_mesh_that_is_found_is_the_same_in_every_bit() {
    let folder = Folder::new("same");
    for (meshes, how) in options().into_iter().map(|how| (meshes(), how)) {
        for mesh in &meshes {
            let cache = folder.cache();
            let new = fresh(mesh, &how);
            for round in 0..2 {
                let asked = ask(&cache, mesh, &how);
                // All fields, those that follow from others, too. Capacities do not show.
                assert_eq!(format!("{asked:?}"), format!("{new:?}"));
                assert_eq!(cache.counts(), counts(round, 1));
            }
        }
    }
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), meshes().len() * options().len());
}

#[test]
fn what_changed_has_another_entry() {
    let folder = Folder::new("changed");
    let cache = folder.cache();
    let ball = Mesh::ball(1);
    let mut all = Vec::new();
    for how in options() {
        all.push(cache.path_of(&ball.positions, &ball.triangles, &how));
    }
    let how = MeshOptions::default();
    for i in 0..3 {
        let mut other = ball.clone();
        match i {
            0 => other.positions[7].y = other.positions[7].y.next_up(),
            1 => other.triangles[3].rotate_left(1),
            _ => other.positions.push(Vec3::ZERO),
        }
        all.push(cache.path_of(&other.positions, &other.triangles, &how));
    }
    // As many numbers, divided in another way.
    let corners = vec![Vec3::ZERO; 4];
    all.push(cache.path_of(&corners, &[[0; 3]; 2], &how));
    all.push(cache.path_of(&corners[..2], &[[0; 3]; 4], &how));
    let count = all.len();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), count);
}

#[test]
fn damaged_entries_are_prepared_and_written_anew() {
    let folder = Folder::new("damaged");
    let (ball, cube) = (Mesh::ball(1), Mesh::cuboid(Vec3::ZERO, Vec3::ONE));
    let how = MeshOptions::default();
    let cache = folder.cache();
    let sound = format!("{:?}", ask(&cache, &ball, &how));
    let path = cache.path_of(&ball.positions, &ball.triangles, &how);
    let whole = fs::read(&path).unwrap();
    ask(&cache, &cube, &how);
    let other = fs::read(cache.path_of(&cube.positions, &cube.triangles, &how)).unwrap();
    let mut flipped = whole.clone();
    flipped[100] ^= 4;
    let longer = [whole.clone(), vec![0]].concat();
    let damaged = [Vec::new(), whole[..whole.len() / 2].to_vec(), flipped, longer, other, vec![7; 40]];
    for (i, bytes) in damaged.into_iter().enumerate() {
        fs::write(&path, bytes).unwrap();
        assert_eq!(format!("{:?}", ask(&cache, &ball, &how)), sound);
        assert_eq!(cache.counts(), counts(0, 3 + i));
        assert_eq!(fs::read(&path).unwrap(), whole, "it is sound again");
    }
    assert_eq!(format!("{:?}", ask(&cache, &ball, &how)), sound);
    assert_eq!(cache.counts().hits, 1);
    // A folder in its place cannot be read, nor be replaced.
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    fs::write(path.join("file"), [0]).unwrap();
    assert_eq!(format!("{:?}", ask(&cache, &ball, &how)), sound);
    assert_eq!(cache.counts().unwritten, 1);
    let names = fs::read_dir(&folder.0).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.ends_with(UNFINISHED)));
}

#[test]
fn threads_and_caches_share_a_folder() {
    let folder = Folder::new("threads");
    let (one, two) = (folder.cache(), folder.cache());
    let meshes = meshes();
    let how = MeshOptions::default();
    let wanted: Vec<String> = meshes.iter().map(|mesh| format!("{:?}", fresh(mesh, &how))).collect();
    std::thread::scope(|scope| {
        for cache in [&one, &two, &one, &two] {
            scope.spawn(|| {
                for _ in 0..8 {
                    for (mesh, wanted) in meshes.iter().zip(&wanted) {
                        assert_eq!(&format!("{:?}", ask(cache, mesh, &how)), wanted);
                    }
                }
            });
        }
    });
    let (one, two) = (one.counts(), two.counts());
    assert_eq!(one.hits + one.misses + two.hits + two.misses, 4 * 8 * meshes.len());
    assert!(one.hits > 0 && two.hits > 0 && one.unwritten + two.unwritten == 0);
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), meshes.len(), "nothing is left unfinished");
}

#[test]
fn errors_of_meshes_are_not_kept() {
    let folder = Folder::new("errors");
    let cache = folder.cache();
    let go_on = &mut |_| ControlFlow::Continue(());
    let how = MeshOptions::default();
    let wrong = cache.prepare(vec![Vec3::NAN], vec![[0; 3]], &how, go_on);
    assert!(matches!(wrong, Err(Error::NotFinite { .. })));
    let ball = Mesh::ball(0);
    let stop = &mut |_| ControlFlow::Break(());
    for _ in 0..2 {
        let ended = cache.prepare(ball.positions.clone(), ball.triangles.clone(), &how, stop);
        assert_eq!(ended.err(), Some(Error::Cancelled));
        ask(&cache, &ball, &how);
    }
    assert_eq!(cache.counts(), counts(2, 1));
}
