//! Shells on the graphics processor: their pictures, beside rays and beside each other.

mod own_pass;
mod painted;
mod pictures;
mod posed;
mod self_shadow;

use casca_fur::mesh::{Coat, Mesh, Vertex};
use casca_scenes::world;
use glam::Vec3;

/// A ball of radius 1, cut so often, with a coat at each vertex.
fn ball(cuts: u32, coat: impl Fn(Vec3) -> Coat) -> Mesh {
    let ball = world::Mesh::ball(cuts);
    let vertex = |&p: &Vec3| Vertex { position: p, normal: p };
    let (vertices, coats) = ball.positions.iter().map(|p| (vertex(p), coat(*p))).unzip();
    Mesh::new(vertices, coats, ball.triangles).unwrap()
}
