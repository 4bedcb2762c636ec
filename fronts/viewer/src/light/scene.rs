//! The scene that the program shows: a file or a generated one, with balls that move.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use casca_lit::load_lit;
use casca_radiosity::lit::{Kind, LitObject, LitScene, Material};
use casca_scenes::world::{Camera, Mesh};
use glam::{Affine3A, Quat, Vec3};

/// Radius of a ball, as a share of the scene's shortest side.
const BALL: f32 = 0.04;

/// A scene and the balls in it.
pub struct Room {
    /// The scene.
    pub scene: LitScene,
    /// Its least and greatest corner, without balls.
    pub bounds: (Vec3, Vec3),
    balls: usize,
}

impl Room {
    /// Loads or makes a scene and adds balls.
    pub fn open(name: &str, balls: u16) -> Result<Self, Box<dyn Error>> {
        let ending = Path::new(name).extension().unwrap_or_default();
        let is_file = ending.eq_ignore_ascii_case("glb") || ending.eq_ignore_ascii_case("gltf");
        let scene = if is_file {
            load_lit(Path::new(name))?
        } else {
            name.parse::<Kind>().map_err(|why| format!("{why}, and it is no .glb or .gltf file"))?.build()
        };
        let (bounds, balls) = (scene.bounds(), usize::from(balls));
        let mut start = Self { scene, balls, bounds };
        let mesh = Arc::new(Mesh::ball(2));
        for i in 0..balls {
            let hue = [0, 1, 2].map(|c| 0.25 + 0.5 * f32::from(u8::from((i + c) % 3 == 0)));
            start.scene.materials.push(Material::matt(Vec3::from_array(hue)));
            let material = start.scene.materials.len() as u32 - 1;
            start.scene.objects.push(LitObject {
                materials: vec![material; mesh.triangles.len()].into(),
                mesh: mesh.clone(),
                uv: Arc::default(),
                transform: start.ball(i, 0.0),
            });
        }
        Ok(start)
    }

    /// Places the camera, if vectors for it are given.
    pub fn look(&mut self, look: Option<(Vec3, Vec3)>) {
        if let Some((eye, target)) = look {
            self.scene.camera = self.looking(eye, target, casca_radiosity::lit::ASPECT);
        }
    }

    /// A camera for pictures that are so many times as wide as high, with the field of view of the
    /// scene's camera. It sees all of the scene from anywhere.
    pub fn looking(&self, eye: Vec3, target: Vec3, aspect: f32) -> Camera {
        let (min, max) = self.bounds;
        let size = 4.0 * (max - min).length().max(1e-3);
        let fov_y = 2.0 * self.scene.camera.projection.y_axis.y.recip().atan().to_degrees();
        let far = size + eye.distance(0.5 * (min + max));
        Camera::look_at(eye, target, fov_y.clamp(1.0, 170.0), aspect, size * 1e-4, far)
    }

    /// The scene's camera, for pictures of another shape.
    pub fn camera(&self, (width, height): (u32, u32)) -> Camera {
        let mut camera = self.scene.camera;
        camera.projection.x_axis.x = camera.projection.y_axis.y * height as f32 / width as f32;
        camera
    }

    /// Numbers of the balls among the objects, and where each is at a time in seconds.
    pub fn balls_at(&self, seconds: f32) -> impl Iterator<Item = (usize, Affine3A)> + '_ {
        let first = self.scene.objects.len() - self.balls;
        (0..self.balls).map(move |i| (first + i, self.ball(i, seconds)))
    }

    /// Balls go up and down on a spiral around the middle of the scene.
    fn ball(&self, i: usize, seconds: f32) -> Affine3A {
        let (min, max) = self.bounds;
        let size = max - min;
        let share = (i as f32 + 0.5) / self.balls.max(1) as f32;
        // Turns by the golden angle spread them evenly.
        let angle = i as f32 * 2.4 + 0.5 * seconds;
        let height = 0.3 + 0.2 * (seconds + i as f32).sin();
        let place = Vec3::new(0.5 + 0.4 * share * angle.cos(), height, 0.5 + 0.4 * share * angle.sin());
        let radius = Vec3::splat(BALL * size.min_element().max(1e-3));
        Affine3A::from_scale_rotation_translation(radius, Quat::IDENTITY, min + size * place)
    }
}

/// By texture where its texels start and its size, and then the texels.
pub fn texels_of(scene: &LitScene) -> Vec<u32> {
    let (mut heads, mut texels) = (Vec::new(), Vec::new());
    for texture in &scene.textures {
        let (width, height) = texture.size();
        heads.extend([(3 * scene.textures.len() + texels.len()) as u32, width, height]);
        texels.extend(texture.texels().iter().map(|t| u32::from_le_bytes(*t)));
    }
    heads.extend(texels);
    heads
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_see_the_scene_from_afar_with_its_field_of_view() {
        let start = Room::open("cornell-point", 0).unwrap();
        let (min, max) = start.bounds;
        let own = start.scene.camera.projection;
        for away in [1.0, 10.0, 1e3] {
            let camera = start.looking(min - (max - min) * away, max, casca_radiosity::lit::ASPECT);
            assert!((camera.projection.y_axis.y - own.y_axis.y).abs() < 1e-4);
            for corner in [min, max] {
                let depth = camera.view_projection().project_point3(corner).z;
                assert!((0.0..=1.0).contains(&depth), "{away}: {depth}");
            }
        }
    }
}
