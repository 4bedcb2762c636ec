//! The library in a small scene, run by `.ci/wasm` on a target without an operating system.
//!
//! Nothing can be printed there: the exit code says which look at the scene went wrong, 0 none.

use std::process::ExitCode;
use std::sync::Arc;

use casca::{Aabb, DrawOptions, Error, Method, ObjectDesc, ObjectId, Query, Scene};
use casca::{Sphere, TriMesh, View};
use glam::Vec3;
use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};

/// The exit code if the library refuses something; a panic ends the program without one.
const REFUSED: u8 = 100;
/// The eye, on one side of a wall across the level.
const EYE: Vec3 = Vec3::new(32.5, 4.5, 58.5);

/// A level cut in two by a wall, with something before it, something beyond it, something behind
/// the eye, and a bird that starts beyond the wall.
struct Level {
    scene: Scene,
    wall: ObjectId,
    before: ObjectId,
    beyond: ObjectId,
    behind_eye: ObjectId,
    bird: ObjectId,
}

fn ball(z: f32) -> Sphere {
    Sphere::new(Vec3::new(32.0, 4.0, z), 0.3)
}

impl Level {
    /// `of_triangles` makes the wall a closed mesh.
    fn new(of_triangles: bool) -> Result<Self, Error> {
        let mut scene = Scene::new(1.0)?;
        let wall = Aabb::new(Vec3::new(0.0, 0.0, 30.0), Vec3::new(64.0, 16.0, 33.0));
        let wall = if of_triangles {
            let mesh = Arc::new(box_mesh(wall)?);
            scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh))?
        } else {
            scene.insert(ObjectDesc::fixed(wall).occluder(wall))?
        };
        Ok(Self {
            wall,
            before: scene.insert(ObjectDesc::fixed(ball(45.0)))?,
            beyond: scene.insert(ObjectDesc::fixed(ball(10.0)))?,
            behind_eye: scene.insert(ObjectDesc::fixed(ball(62.0)))?,
            bird: scene.insert(ObjectDesc::dynamic(ball(12.0)).max_speed(600.0))?,
            scene,
        })
    }

    /// Two frames: the bird is beyond the wall, then before it. Whether each shows the right
    /// objects.
    fn shows(&mut self, method: Method) -> Result<bool, Error> {
        let mut query = Query::with_method(method)?;
        let matrix = perspective(0.8, 16.0 / 9.0, 0.1, 500.0) * look_at_mat4(EYE, EYE - Vec3::Z, Vec3::Y);
        let view = View::perspective(EYE, matrix)?;
        let culls = !matches!(method, Method::Frustum);
        let mut right = true;
        for (time, z) in [(0.0, 12.0), (0.1, 47.0)] {
            self.scene.begin_frame(time)?;
            self.scene.update(self.bird, ball(z), None)?;
            let mut want = vec![self.wall, self.before];
            if !culls {
                want.push(self.beyond);
            }
            if !culls || z > 33.0 {
                want.push(self.bird);
            }
            let pvs = query.run(&self.scene, &view);
            let mut found = pvs.visible().to_vec();
            found.sort_unstable();
            want.sort_unstable();
            right &= found == want && !pvs.contains(self.behind_eye);
            let mut items = Vec::new();
            pvs.draw_list(&self.scene, &DrawOptions::default(), &mut items)?;
            right &= items.len() == want.len();
            self.scene.end_frame([query.pvs()])?;
        }
        Ok(right)
    }
}

/// The twelve triangles of a box.
fn box_mesh(b: Aabb) -> Result<TriMesh, Error> {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i >> bit & 1 == 1 { b.max[axis] } else { b.min[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh::new((0..8).map(corner).collect(), triangles)
}

/// The number of the first look that went wrong, from 1; 0 if none did.
fn first_wrong() -> Result<u8, Error> {
    let mut number = 0;
    for of_triangles in [false, true] {
        for method in [Method::Frustum, Method::cell(), Method::point()] {
            number += 1;
            if !Level::new(of_triangles)?.shows(method)? {
                return Ok(number);
            }
        }
    }
    Ok(0)
}

fn main() -> ExitCode {
    ExitCode::from(first_wrong().unwrap_or(REFUSED))
}
