//! Generated lit scenes; sizes and materials of the Cornell box are those measured at Cornell
//! University, in metres.

use std::str::FromStr;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{ASPECT, LitObject, LitScene, Material};
use crate::Light;
use casca_scenes::world::{BOX_TRIANGLES, Camera, Mesh};

/// The generated scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The Cornell box: 36 triangles, a red and a green wall, two blocks, and a patch of the
    /// ceiling that emits.
    Cornell,
    /// The same, lit by a point below the ceiling instead of the patch.
    CornellPoint,
}

const WHITE: Material = Material::matt(Vec3::new(0.73, 0.73, 0.73));
const RED: Material = Material::matt(Vec3::new(0.63, 0.065, 0.05));
const GREEN: Material = Material::matt(Vec3::new(0.14, 0.45, 0.091));
/// Height of the Cornell box.
const CEILING: f32 = 5.488;
/// Corners of the patch of light, in x and z.
const PATCH: [[f32; 2]; 2] = [[2.13, 2.27], [3.43, 3.32]];
/// Radiance of the patch.
const PATCH_LIGHT: Vec3 = Vec3::new(18.4, 15.6, 8.0);

impl Kind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Cornell, Self::CornellPoint];

    /// Its name in file names and on command lines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cornell => "cornell",
            Self::CornellPoint => "cornell-point",
        }
    }

    /// Makes it.
    pub fn build(self) -> LitScene {
        match self {
            Self::Cornell => {
                let mut scene = cornell();
                let [[x0, z0], [x1, z1]] = PATCH;
                let y = CEILING - 0.002;
                let corners = [[x0, z0], [x1, z0], [x1, z1], [x0, z1]].map(|[x, z]| Vec3::new(x, y, z));
                add(&mut scene, quad(corners), Material::emitter(PATCH_LIGHT));
                scene
            }
            Self::CornellPoint => {
                let mut scene = LitScene { name: Self::CornellPoint.name().to_owned(), ..cornell() };
                let [[x0, z0], [x1, z1]] = PATCH;
                let position = Vec3::new((x0 + x1) / 2.0, CEILING - 0.3, (z0 + z1) / 2.0);
                // The intensity of the patch straight down.
                let color = PATCH_LIGHT * ((x1 - x0) * (z1 - z0));
                scene.lights.push(Light::point(position, color));
                scene
            }
        }
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("there is no lit scene {name:?}; there are {names}")
        })
    }
}

/// Adds an object of one material.
fn add(scene: &mut LitScene, mesh: Mesh, material: Material) {
    let number = scene.materials.iter().position(|m| *m == material).unwrap_or_else(|| {
        scene.materials.push(material);
        scene.materials.len() - 1
    });
    scene.objects.push(LitObject {
        materials: vec![number as u32; mesh.triangles.len()].into(),
        uv: Arc::default(),
        mesh: Arc::new(mesh),
        transform: Affine3A::IDENTITY,
    });
}

/// Two triangles; counter-clockwise seen from the front.
fn quad(corners: [Vec3; 4]) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// The walls and blocks of the Cornell box, without light.
fn cornell() -> LitScene {
    // A focal length of 35 mm with a sensor of 25 mm.
    let camera =
        Camera::look_at(Vec3::new(2.78, 2.73, -8.0), Vec3::new(2.78, 2.73, 0.0), 39.3, ASPECT, 0.1, 100.0);
    let mut scene = LitScene {
        name: Kind::Cornell.name().to_owned(),
        objects: Vec::new(),
        materials: Vec::new(),
        textures: Vec::new(),
        lights: Vec::new(),
        sky: Vec3::ZERO,
        camera,
    };
    let (w, h, d) = (5.528, CEILING, 5.592);
    let wall = |corners: [[f32; 3]; 4]| quad(corners.map(Vec3::from_array));
    let walls = [
        // The floor, the ceiling, and the walls at the back, at the right and at the left.
        ([[0.0, 0.0, 0.0], [0.0, 0.0, d], [w, 0.0, d], [w, 0.0, 0.0]], WHITE),
        ([[0.0, h, 0.0], [w, h, 0.0], [w, h, d], [0.0, h, d]], WHITE),
        ([[0.0, 0.0, d], [0.0, h, d], [w, h, d], [w, 0.0, d]], WHITE),
        ([[0.0, 0.0, 0.0], [0.0, h, 0.0], [0.0, h, d], [0.0, 0.0, d]], GREEN),
        ([[w, 0.0, 0.0], [w, 0.0, d], [w, h, d], [w, h, 0.0]], RED),
    ];
    for (corners, material) in walls {
        add(&mut scene, wall(corners), material);
    }
    add(&mut scene, block([[130, 65], [82, 225], [240, 272], [290, 114]], 165), WHITE);
    add(&mut scene, block([[423, 247], [265, 296], [314, 456], [472, 406]], 330), WHITE);
    scene
}

/// A block over four corners in x and z, from the ground up; in centimetres.
fn block(base: [[u16; 2]; 4], height: u16) -> Mesh {
    // In the order of the corners of a box, whose bits are x, y and z.
    let order = [(0, 0), (3, 0), (0, height), (3, height), (1, 0), (2, 0), (1, height), (2, height)];
    let metres = |cm: u16| f32::from(cm) / 100.0;
    let corner = |(i, y): (usize, u16)| Vec3::new(metres(base[i][0]), metres(y), metres(base[i][1]));
    let positions = order.map(corner).to_vec();
    Mesh { positions, triangles: BOX_TRIANGLES.to_vec(), ..Mesh::default() }
}
