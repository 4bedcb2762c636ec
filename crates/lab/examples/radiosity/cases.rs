//! The scenes of the table.

use std::path::Path;
use std::sync::Arc;

use casca_radiosity::{Material, Object, Scene, Texture, Triangle};
use casca_scenes::import::load_lit;
use casca_scenes::lit::{self, Kind, LightKind, LitObject, LitScene};
use casca_scenes::world::{Camera, Mesh};
use glam::{Affine3A, Vec2, Vec3};

use crate::Outcome;

/// Data of a real building, if it is there.
pub const SPONZA: &str = "../shared/scenes/sponza.glb";

/// A scene and its cameras.
pub struct Case {
    /// For the table.
    pub name: String,
    /// As the path tracer takes it: each texel is a square of a material of its own.
    pub scene: LitScene,
    /// Names and cameras.
    pub cameras: Vec<(String, Camera)>,
    /// The parts that the cache takes as textures: those are the last objects of the scene.
    textured: Vec<Picture>,
}

/// A parallelogram of texels.
struct Picture {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
    size: [u32; 2],
    texels: Vec<Vec3>,
}

/// Texels of the texture along an edge of a texel of the picture, so that hardly any of it is
/// blurred into its neighbours.
const FINER: u32 = 8;

impl Picture {
    fn at(&self, x: f32, y: f32) -> Vec3 {
        self.corner + self.u * (x / self.size[0] as f32) + self.v * (y / self.size[1] as f32)
    }

    /// A square for each texel, and the materials from a number on.
    fn squares(&self, first: usize) -> (LitObject, Vec<lit::Material>) {
        let [width, height] = self.size;
        let (mut positions, mut triangles, mut materials) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..width * height {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            let start = positions.len() as u32;
            positions
                .extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(a, b)| self.at(x + a, y + b)));
            triangles.extend([[start, start + 1, start + 2], [start, start + 2, start + 3]]);
            materials.extend([first as u32 + i; 2]);
        }
        let object = LitObject {
            name: String::new(),
            materials: materials.into(),
            mesh: Arc::new(Mesh { positions, triangles, ..Mesh::default() }),
            transform: Affine3A::IDENTITY,
            moves: false,
        };
        (object, self.texels.iter().map(|t| lit::Material::matt(*t)).collect())
    }

    /// Two triangles with places in a texture.
    fn textured(&self, material: u32) -> (Object, Texture) {
        let [width, height] = self.size;
        let finer = |i: u32| {
            let (x, y) = (i % (width * FINER) / FINER, i / (width * FINER) / FINER);
            self.texels[(y * width + x) as usize]
        };
        let texels = (0..width * height * FINER * FINER).map(finer).collect();
        let texture = Texture::new(width * FINER, height * FINER, texels).expect("it has all of its texels");
        let [a, b, c, d] =
            [self.corner, self.corner + self.u, self.corner + self.u + self.v, self.corner + self.v];
        let triangles = [[a, b, c], [a, c, d]].map(|corners| Triangle { corners, material }).into();
        let [o, x, y] = [Vec2::ZERO, Vec2::X, Vec2::Y];
        (Object { triangles, uv: vec![[o, x, x + y], [o, x + y, y]] }, texture)
    }
}

fn boxes(parts: &[([f32; 6], usize)]) -> Vec<LitObject> {
    let object = |([a, b, c, d, e, f], material): &([f32; 6], usize)| {
        let mesh = Mesh::cuboid(Vec3::new(*a, *b, *c), Vec3::new(*d, *e, *f));
        LitObject {
            name: String::new(),
            materials: vec![*material as u32; mesh.triangles.len()].into(),
            mesh: Arc::new(mesh),
            transform: Affine3A::IDENTITY,
            moves: false,
        }
    };
    parts.iter().map(object).collect()
}

/// A number of 0 to 1 for a place in a row.
fn share(i: u32) -> f32 {
    (i as f32 * 0.618_034).fract()
}

fn camera(name: &str, eye: [f32; 3], target: [f32; 3]) -> (String, Camera) {
    let [eye, target] = [eye, target].map(Vec3::from_array);
    (name.to_owned(), Camera::look_at(eye, target, 65.0, lit::ASPECT, 0.01, 100.0))
}

/// Three rooms of 4, 3 and 5 metres in a row, with doors, furniture, a lamp in the first one, and a
/// window in the last one.
fn house() -> Case {
    let mut parts: Vec<([f32; 6], usize)> = vec![
        // Floor, ceiling, the long walls and an end.
        ([-0.2, -0.2, -0.2, 12.4, 0.0, 4.2], 0),
        ([-0.2, 2.6, -0.2, 12.4, 2.8, 4.2], 1),
        ([-0.2, 0.0, -0.2, 12.4, 2.6, 0.0], 1),
        ([-0.2, 0.0, 4.0, 12.4, 2.6, 4.2], 1),
        ([-0.2, 0.0, 0.0, 0.0, 2.6, 4.0], 2),
        // The end with a window.
        ([12.2, 0.0, 0.0, 12.4, 0.9, 4.0], 1),
        ([12.2, 2.2, 0.0, 12.4, 2.6, 4.0], 1),
        ([12.2, 0.9, 0.0, 12.4, 2.2, 1.2], 1),
        ([12.2, 0.9, 2.8, 12.4, 2.2, 4.0], 1),
        // Furniture.
        ([1.0, 0.7, 1.5, 2.4, 0.75, 2.6], 3),
        ([1.1, 0.0, 1.6, 1.2, 0.7, 1.7], 3),
        ([2.2, 0.0, 2.4, 2.3, 0.7, 2.5], 3),
        ([5.0, 0.0, 0.0, 6.2, 1.9, 0.5], 3),
        ([8.6, 0.0, 2.0, 10.6, 0.45, 3.9], 4),
        ([8.0, 0.0, 0.0, 8.5, 0.8, 0.8], 2),
    ];
    // Walls with doors of 0.9 m, which are 2.1 m high.
    for (x, z) in [(4.0, 2.6), (7.1, 0.5)] {
        parts.push(([x, 0.0, 0.0, x + 0.1, 2.6, z], 1));
        parts.push(([x, 0.0, z + 0.9, x + 0.1, 2.6, 4.0], 1));
        parts.push(([x, 2.1, z, x + 0.1, 2.6, z + 0.9], 1));
    }
    let materials = [[0.4, 0.3, 0.2], [0.8, 0.8, 0.78], [0.7, 0.2, 0.15], [0.5, 0.35, 0.2], [0.2, 0.3, 0.6]];
    let cameras = vec![
        camera("lamp", [0.3, 1.6, 0.3], [3.5, 1.0, 3.5]),
        camera("middle", [4.3, 1.6, 3.7], [7.0, 1.0, 0.3]),
        camera("window", [11.9, 1.6, 3.7], [7.4, 0.9, 0.8]),
    ];
    let scene = LitScene {
        name: "house".to_owned(),
        objects: boxes(&parts),
        materials: materials.map(|c| lit::Material::matt(Vec3::from_array(c))).into(),
        lights: vec![lit::Light::point(Vec3::new(2.0, 2.2, 1.2), Vec3::new(12.0, 10.0, 8.0))],
        sky: Vec3::new(3.0, 4.0, 5.0),
        camera: cameras[0].1,
    };
    Case { name: "house".to_owned(), scene, cameras, textured: Vec::new() }
}

/// Sponza under a sun and a sky, from both ends.
fn sponza(name: &str) -> Outcome<Case> {
    let mut scene = load_lit(Path::new(SPONZA))?;
    let camera = match name {
        "hall" => camera(name, [-9.0, 2.0, 0.2], [8.0, 4.0, 0.4]),
        _ => camera(name, [-10.0, 1.6, 4.3], [6.0, 1.8, 4.3]),
    };
    scene.sky = Vec3::new(0.6, 0.8, 1.0);
    let direction = Vec3::new(0.25, -1.0, 0.12);
    let mut sun = lit::Light::point(Vec3::ZERO, Vec3::new(12.0, 11.0, 10.0));
    sun.kind = LightKind::Directional { direction, half_angle: 0.01 };
    scene.lights = vec![sun];
    Ok(Case { name: "sponza".to_owned(), scene, cameras: vec![camera], textured: Vec::new() })
}

/// A scene by its name.
pub fn case(name: &str) -> Outcome<Case> {
    match name {
        "house" => Ok(house()),
        "gallery" => Ok(gallery()),
        "street" => Ok(street()),
        "cave" => Ok(cave()),
        "hall" | "aisle" => sponza(name),
        _ => {
            let scene = name.parse::<Kind>()?.build();
            let cameras = vec![("front".to_owned(), scene.camera)];
            Ok(Case { name: name.to_owned(), scene, cameras, textured: Vec::new() })
        }
    }
}

/// A hall with paintings and a tiled floor, and three spots.
fn gallery() -> Case {
    let parts = [
        ([-0.2, -0.2, -0.2, 10.2, -0.01, 5.2], 0),
        ([-0.2, 3.5, -0.2, 10.2, 3.7, 5.2], 0),
        ([-0.2, -0.01, -0.2, 10.2, 3.5, 0.0], 0),
        ([-0.2, -0.01, 5.0, 10.2, 3.5, 5.2], 0),
        ([-0.2, -0.01, 0.0, 0.0, 3.5, 5.0], 0),
        ([10.0, -0.01, 0.0, 10.2, 3.5, 5.0], 0),
        ([4.0, 0.0, 2.1, 6.0, 0.45, 2.9], 1),
    ];
    let tile = |i: u32| {
        if (i % 20 + i / 20).is_multiple_of(2) { Vec3::splat(0.75) } else { Vec3::new(0.12, 0.1, 0.1) }
    };
    let mut textured = vec![Picture {
        corner: Vec3::new(0.0, 0.0, 5.0),
        u: Vec3::X * 10.0,
        v: Vec3::Z * -5.0,
        size: [20, 10],
        texels: (0..200).map(tile).collect(),
    }];
    for i in 0..6 {
        // Each has colours of its own, in blocks.
        let hue = Vec3::new(share(3 * i), share(3 * i + 1), share(3 * i + 2));
        let texel = |k: u32| (hue * (0.3 + 0.7 * share(7 * k + i))).lerp(Vec3::splat(share(k)), 0.3) * 0.9;
        let x = 0.9 + 2.9 * (i % 3) as f32;
        let (corner, u) = match i < 3 {
            true => (Vec3::new(x, 1.0, 0.02), Vec3::X * 2.0),
            false => (Vec3::new(x + 2.0, 1.0, 4.98), Vec3::X * -2.0),
        };
        textured.push(Picture {
            corner,
            u,
            v: Vec3::Y * 1.5,
            size: [12, 9],
            texels: (0..108).map(texel).collect(),
        });
    }
    let mut objects = boxes(&parts);
    let mut materials: Vec<_> =
        [[0.8, 0.78, 0.75], [0.4, 0.25, 0.15]].map(|c| lit::Material::matt(Vec3::from_array(c))).into();
    for picture in &textured {
        let (object, of_texels) = picture.squares(materials.len());
        objects.push(object);
        materials.extend(of_texels);
    }
    let spot = |x: f32, z: f32, to: [f32; 3]| {
        let position = Vec3::new(x, 3.3, z);
        let direction = Vec3::from_array(to) - position;
        let mut light = lit::Light::point(position, Vec3::new(40.0, 37.0, 33.0));
        light.kind = LightKind::Spot { position, direction, radius: 0.05, inner: 0.45, outer: 0.7 };
        light
    };
    let cameras = vec![
        camera("along", [0.4, 1.7, 4.5], [9.0, 1.3, 1.0]),
        camera("across", [9.5, 1.7, 3.9], [3.0, 1.2, 0.2]),
    ];
    let scene = LitScene {
        name: "gallery".to_owned(),
        objects,
        materials,
        lights: vec![
            spot(2.0, 3.0, [1.9, 1.7, 0.0]),
            spot(5.0, 2.0, [4.8, 1.7, 5.0]),
            spot(8.0, 3.0, [8.0, 0.0, 2.5]),
        ],
        sky: Vec3::ZERO,
        camera: cameras[0].1,
    };
    Case { name: "gallery".to_owned(), scene, cameras, textured }
}

/// Houses along a street under a sun and a sky.
fn street() -> Case {
    let mut parts = vec![([-3.0, -0.5, -3.0, 63.0, 0.0, 33.0], 0)];
    for i in 0..12 {
        let (row, k) = (i % 2, i / 2);
        let (x, height) = (k as f32 * 10.0 + 2.0 * share(i), 6.0 + 9.0 * share(5 * i + 2));
        let z = if row == 0 { 0.0 } else { 20.0 };
        parts.push(([x, 0.0, z, x + 7.5, height, z + 10.0], 1 + (i % 3) as usize));
        // Balconies.
        let (front, depth) = if row == 0 { (10.0, 1.2) } else { (18.8, 1.2) };
        for floor in 1..(height / 3.0) as u32 {
            let y = 3.0 * floor as f32;
            parts.push(([x + 1.0, y, front, x + 4.0, y + 0.2, front + depth], 4));
        }
    }
    let colours = [[0.3, 0.3, 0.32], [0.7, 0.6, 0.5], [0.75, 0.75, 0.72], [0.6, 0.3, 0.25], [0.5, 0.5, 0.5]];
    let cameras = vec![
        camera("along", [1.0, 1.7, 15.0], [40.0, 3.0, 14.0]),
        camera("between houses", [18.4, 1.7, 4.0], [18.8, 2.5, 25.0]),
    ];
    let mut sun = lit::Light::point(Vec3::ZERO, Vec3::new(12.0, 11.0, 9.5));
    sun.kind = LightKind::Directional { direction: Vec3::new(0.5, -1.0, -0.6), half_angle: 0.005 };
    let scene = LitScene {
        name: "street".to_owned(),
        objects: boxes(&parts),
        materials: colours.map(|c| lit::Material::matt(Vec3::from_array(c))).into(),
        lights: vec![sun],
        sky: Vec3::new(0.8, 1.1, 1.6),
        camera: cameras[0].1,
    };
    Case { name: "street".to_owned(), scene, cameras, textured: Vec::new() }
}

/// A rough hollow with an opening to the sky, and a ball that glows.
fn cave() -> Case {
    let bump = |d: Vec3| {
        let waves = [(3.1, 0.12), (7.3, 0.07), (17.0, 0.03)];
        let of = |(f, size): (f32, f32)| {
            size * ((d.x * f + 1.0).sin() + (d.y * f * 1.1 + 2.0).sin() * (d.z * f * 0.9).cos())
        };
        1.0 + waves.map(of).iter().sum::<f32>()
    };
    let ball = Mesh::ball(5);
    let way = |p: &Vec3| p.normalize_or_zero();
    let positions = ball.positions.iter().map(|p| way(p) * bump(way(p)) * Vec3::new(6.0, 3.5, 5.0)).collect();
    let opening = Vec3::new(0.8, 0.6, 0.1).normalize();
    let is_rock = |t: &&[u32; 3]| way(&ball.positions[t[0] as usize]).dot(opening) < 0.93;
    // Seen from inside.
    let triangles: Vec<_> = ball.triangles.iter().filter(is_rock).map(|[a, b, c]| [*a, *c, *b]).collect();
    let object = |mesh: Mesh, material, transform| LitObject {
        name: String::new(),
        materials: vec![material; mesh.triangles.len()].into(),
        mesh: Arc::new(mesh),
        transform,
        moves: false,
    };
    let lamp = Affine3A::from_scale_rotation_translation(
        Vec3::splat(0.3),
        glam::Quat::IDENTITY,
        Vec3::new(-2.5, -0.8, -0.6),
    );
    let cameras = vec![
        camera("to the lamp", [3.0, 0.2, 1.0], [-3.0, -0.6, -0.5]),
        camera("to the opening", [-3.5, -0.4, 1.2], [3.0, 0.8, 0.0]),
    ];
    let scene = LitScene {
        name: "cave".to_owned(),
        objects: vec![
            object(Mesh { positions, triangles, ..Mesh::default() }, 0, Affine3A::IDENTITY),
            object(Mesh::ball(2), 1, lamp),
        ],
        materials: vec![
            lit::Material::matt(Vec3::new(0.55, 0.5, 0.42)),
            lit::Material::emitter(Vec3::new(14.0, 7.0, 2.5)),
        ],
        lights: Vec::new(),
        sky: Vec3::new(2.0, 2.6, 3.4),
        camera: cameras[0].1,
    };
    Case { name: "cave".to_owned(), scene, cameras, textured: Vec::new() }
}

impl Case {
    /// The scene as the cache takes it, pictures as textures.
    pub fn input(&self) -> Scene {
        let mut scene = Scene::from(&self.scene);
        scene.objects.truncate(self.scene.objects.len() - self.textured.len());
        for picture in &self.textured {
            let (object, texture) = picture.textured(scene.materials.len() as u32);
            let albedo_texture = Some(scene.textures.len() as u32);
            scene.materials.push(Material { albedo_texture, ..Material::new(Vec3::ONE, Vec3::ZERO) });
            scene.textures.push(texture);
            scene.objects.push(object);
        }
        scene
    }
}
