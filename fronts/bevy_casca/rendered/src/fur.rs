//! Fur in Bevy beside fur by casca-fur, and a herd behind walls.

use std::any::TypeId;

use bevy::asset::RenderAssetUsages;
use bevy::camera::ClearColorConfig;
use bevy::camera::visibility::VisibleEntities;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::diagnostic::FrameCount;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_casca::{CascaSettings, MaterialsPlugin, Surface};
use bevy_casca_fur::{
    ATTRIBUTE_FUR_LENGTH, Coat, FurExtension, FurMaterial, FurPlugin, FurSettings, Furry, fur_material,
};
use casca_fur::glam;
use casca_fur::gpu::look::{Look, sky_pixel};
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::reference::Reference;
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Coat as OwnCoat, Mesh as OwnMesh, Vertex};
use casca_fur::scenes::threads;
use casca_fur::shading::Material;
use casca_fur::strands::Fur;
use casca_scenes::world;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_tools::camera::Camera as OwnCamera;

use crate::rendered::{HEIGHT, Rendered, WIDTH};

/// The vertical angle of view, in degrees.
const ANGLE: f32 = 40.0;

/// The linear colour of the coat.
const COLOR: Vec3 = Vec3::new(0.55, 0.36, 0.2);

/// The share of light at roots, and of the skin below the fur.
const DARK: f32 = 0.3;

/// Frames until all coats are there with their layers; also those whose time is taken.
const SETTLED: u32 = 8;

/// A ball of radius 1 with fur, alone before a sky, all light from everywhere.
pub struct Ball {
    mesh: world::Mesh,
    fur: Fur,
    eye: Vec3,
}

impl Ball {
    /// Fur of 15% of the radius, bent, in tufts that curl, seen from nearby.
    pub fn new() -> Result<Self, String> {
        let fur = Fur::for_radius(1.0, 0.15, 0.3).map_err(|why| why.to_string())?;
        let bend = glam::Vec3::new(0.0, -0.5, 0.0);
        let eye = Vec3::new(1.6, 1.1, 2.3);
        let fur = Fur { spacing: 0.05, bend, clump: 0.5, curl: 0.4, ..fur };
        Ok(Self { mesh: world::Mesh::ball(4), fur, eye })
    }

    /// The look of casca-fur with light from everywhere alone.
    fn look(&self) -> Look {
        let dull = Material { diffuse: 0.0, specular: 0.0, ..Material::default() };
        Look { material: Material { ambient: 1.0, root: DARK, ..dull }, ..Look::new(self.fur) }
    }

    fn own_mesh(&self) -> Result<OwnMesh, String> {
        let vertex = |&p: &glam::Vec3| Vertex { position: p, normal: p };
        let vertices: Vec<Vertex> = self.mesh.positions.iter().map(vertex).collect();
        let coat = OwnCoat { color: glam::Vec3::from_array(COLOR.to_array()), length: 1.0 };
        let coats = vec![coat; vertices.len()];
        OwnMesh::new(vertices, coats, self.mesh.triangles.clone()).map_err(|why| why.to_string())
    }

    fn own_camera(&self) -> OwnCamera {
        let eye = glam::Vec3::from_array(self.eye.to_array());
        OwnCamera::look_at(eye, glam::Vec3::ZERO, ANGLE, WIDTH as f32 / HEIGHT as f32, 0.1, 50.0)
    }

    /// The picture of casca-fur's own renderer.
    pub fn by_casca_fur(&self, layers: u32) -> Result<Vec<u8>, String> {
        let text = |why: &dyn std::fmt::Display| why.to_string();
        let gpu = Gpu::headless(false).map_err(|why| text(&why))?;
        let canvas = Canvas::new(&gpu, (WIDTH, HEIGHT));
        let mut renderer =
            Renderer::new(&gpu, COLOUR, &[self.own_mesh()?], &self.look()).map_err(|why| text(&why))?;
        let stand = Stand { mesh: 0, place: glam::Affine3A::IDENTITY, root: [1.0; 3], tip: [1.0; 3] };
        let list = DrawList::new(&[(stand, layers)], Vec::new());
        let sun = Sun { towards: glam::Vec3::Y, center: glam::Vec3::ZERO, radius: 2.0, shadows: false };
        renderer.draw(&gpu, &canvas.picture(), &self.own_camera(), &list, &sun).map_err(|why| text(&why))?;
        canvas.read_picture(&gpu).map_err(|why| text(&why))
    }

    /// The traced strands, in half of the size with two by two rays a pixel.
    pub fn traced(&self) -> Result<Vec<u8>, String> {
        let (mesh, look) = (self.own_mesh()?, self.look());
        let reference = Reference::new(&mesh, &look).map_err(|why| why.to_string())?;
        let size = (WIDTH / 2, HEIGHT / 2);
        Ok(reference.picture(&self.own_camera(), size, 2, &[glam::Vec3::ONE; 2], glam::Vec3::Y))
    }

    /// The picture of Bevy, with its colours stored as casca-fur stores them, and the time of a frame.
    pub fn by_bevy(&self, layers: u32) -> Result<(Vec<u8>, f64), String> {
        let mesh = mesh_of(&self.own_mesh()?);
        let fill = |world: &mut World| {
            let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
            // Of the color that its vertices have, too.
            let unlit = |light: f32| StandardMaterial {
                base_color: Color::linear_rgb(light, light, light),
                unlit: true,
                fog_enabled: false,
                ..default()
            };
            let skin = world.resource_mut::<Assets<StandardMaterial>>().add(unlit(DARK));
            let extension = FurExtension { dark: DARK, ..FurExtension::new(self.fur) };
            let fur = world.resource_mut::<Assets<FurMaterial>>().add(fur_material(unlit(1.0), extension));
            world.insert_resource(FurSettings { most_layers: layers, ..default() });
            world.spawn((Mesh3d(mesh), MeshMaterial3d(skin), Furry(fur)));
        };
        let eye = Transform::from_translation(self.eye).looking_at(Vec3::ZERO, Vec3::Y);
        let mut rendered = furry(None, fill, eye)?;
        let (world, camera) = rendered.world_and_camera();
        let sky = sky_pixel().map(|byte| (f32::from(byte) / 255.0).powf(2.2));
        let mut of_camera = world.entity_mut(camera);
        of_camera.insert((Tonemapping::None, DebandDither::Disabled));
        // A prepass of depths changes nothing.
        if layers == 8 {
            of_camera.insert(DepthPrepass);
        }
        if let Some(mut camera) = of_camera.get_mut::<Camera>() {
            let color = Color::LinearRgba(LinearRgba::rgb(sky[0], sky[1], sky[2]));
            camera.clear_color = ClearColorConfig::Custom(color);
        }
        let (picture, time) = timed(&mut rendered)?;
        let coats = coats(&mut rendered);
        if coats != [(layers, true)] {
            return Err(format!("coats with {coats:?} layers instead of one with {layers}"));
        }
        // Of the sRGB curve, to the power that casca-fur uses.
        let stored = |&byte: &u8| Srgba::gamma_function(f32::from(byte) / 255.0).powf(1.0 / 2.2) * 255.0;
        Ok((picture.iter().map(|byte| stored(byte).round() as u8).collect(), time))
    }
}

/// An app with fur, after some frames.
pub fn furry(
    settings: Option<CascaSettings>,
    fill: impl FnOnce(&mut World),
    eye: Transform,
) -> Result<Rendered, String> {
    let mut rendered = Rendered::with_plugins(
        settings,
        |app| {
            // One sees through it, and what is nearer is drawn over it.
            let fur = MaterialsPlugin::<MeshMaterial3d<FurMaterial>>::new(|_| Surface::Unknown);
            app.add_plugins((FurPlugin, fur));
        },
        fill,
        eye,
    )?;
    let (world, camera) = rendered.world_and_camera();
    let lens = PerspectiveProjection { fov: ANGLE.to_radians(), ..default() };
    world.entity_mut(camera).insert(Projection::Perspective(lens));
    (0..SETTLED).for_each(|_| rendered.app.update());
    Ok(rendered)
}

/// A picture, and the milliseconds of all threads for a frame, from several frames.
pub fn timed(rendered: &mut Rendered) -> Result<(Vec<u8>, f64), String> {
    let now = |rendered: &mut Rendered| (threads(), rendered.app.world().resource::<FrameCount>().0);
    rendered.capture()?;
    let start = now(rendered);
    (0..SETTLED).for_each(|_| rendered.app.update());
    let picture = rendered.capture()?;
    let end = now(rendered);
    Ok((picture, (end.0 - start.0) / f64::from(end.1 - start.1)))
}

/// The layers of all coats, in the order of their animals, and whether the camera draws them.
pub fn coats(rendered: &mut Rendered) -> Vec<(u32, bool)> {
    let (world, camera) = rendered.world_and_camera();
    let listed = world.get::<VisibleEntities>(camera).map(|seen| seen.get(TypeId::of::<Mesh3d>()).to_vec());
    let listed = listed.unwrap_or_default();
    let mut coats = world.query::<(Entity, &ChildOf, &Coat)>();
    let coat = |(entity, parent, coat): (Entity, &ChildOf, &Coat)| {
        (parent.parent(), coat.layers(), listed.contains(&entity))
    };
    let mut all: Vec<(Entity, u32, bool)> = coats.iter(world).map(coat).collect();
    all.sort();
    all.into_iter().map(|(_, layers, drawn)| (layers, drawn)).collect()
}

/// A mesh of casca-fur, with the colours and lengths of its coat.
pub fn mesh_of(own: &OwnMesh) -> Mesh {
    let (vertices, coats) = (own.vertices(), own.coats());
    let positions: Vec<[f32; 3]> = vertices.iter().map(|v| v.position.to_array()).collect();
    let normals: Vec<[f32; 3]> = vertices.iter().map(|v| v.normal.to_array()).collect();
    let colors: Vec<[f32; 4]> = coats.iter().map(|c| c.color.extend(1.0).to_array()).collect();
    let lengths: Vec<f32> = coats.iter().map(|c| c.length).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_attribute(ATTRIBUTE_FUR_LENGTH, lengths)
        .with_inserted_indices(Indices::U32(own.triangles().concat()))
}

/// The root of the mean squared difference of two pictures, of 1; alpha does not count.
pub fn rmse(a: &[u8], b: &[u8]) -> f64 {
    let colour = |p: &[u8]| p.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect::<Vec<u8>>();
    let (a, b) = (colour(a), colour(b));
    let sum: f64 = a.iter().zip(&b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (sum / a.len().max(1) as f64).sqrt() / 255.0
}
