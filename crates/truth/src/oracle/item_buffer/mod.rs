//! The nearest object at every pixel, found analytically.

mod frame;
mod pixel_rays;
mod setup;
mod tile;
mod trace;
mod triangle;

use std::sync::atomic::AtomicU32;

use casca_scenes::world::{Camera, Object, Shape};
use glam::DVec3;
use rayon::prelude::*;

use super::frustum::Frustum;
use super::geometry::MeshCache;
use frame::{Bins, Entry, Frame, TILE};
use pixel_rays::PixelRays;
use setup::Setup;
use tile::Tile;

pub use frame::NONE;

/// An exact item buffer: for each pixel the nearest occluder along the ray
/// through the pixel's centre, and how many pixels show each object.
///
/// - All in f64, from the exact eye. Triangles that share an edge leave no
///   gap, nor do abutting boxes.
/// - Depth is in metres along the camera's forward axis. What lies nearer
///   than the near plane or beyond the far plane is neither seen nor hides.
/// - Spheres and boxes are solid and seen from outside only: one that holds
///   the eye, or the point where a pixel's ray leaves the near plane, neither
///   shows nor hides there. One that holds the eye of a perspective camera
///   and reaches beyond the near plane counts as visible all the same.
/// - Meshes are surfaces that are seen from both sides; each triangle hides as its sides say.
/// - The nearest wins; at exactly equal depth the lower index.
///
/// The result does not depend on the number of threads.
#[derive(Debug, Default)]
pub struct ItemBuffer {
    width: usize,
    height: usize,
    index: Vec<u32>,
    depth: Vec<f64>,
    visible: Vec<u32>,
    holding_eye: Vec<u32>,
    meshes: MeshCache,
}

impl ItemBuffer {
    /// An empty buffer of `width` times `height` pixels, each at most 65,535.
    pub fn new(width: usize, height: usize) -> Self {
        assert!(width <= 65_535 && height <= 65_535, "at most 65,535 pixels a side");
        Self {
            width,
            height,
            index: vec![NONE; width * height],
            depth: vec![f64::INFINITY; width * height],
            ..Self::default()
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The nearest occluder at each pixel, row by row from the top left;
    /// [`NONE`] where there is none.
    pub fn items(&self) -> &[u32] {
        &self.index
    }

    /// The depth of the nearest occluder at each pixel: metres along the
    /// camera's forward axis, infinite where there is none.
    pub fn depths(&self) -> &[f64] {
        &self.depth
    }

    /// For each object the number of pixels that show it. For what hides, those where it is
    /// nearest; for the rest, those where nothing that hides is nearer. A pixel that shows both of
    /// a mesh counts twice. One that holds the eye has at least 1. Objects that neither hide nor
    /// are tested have 0.
    pub fn visible(&self) -> &[u32] {
        &self.visible
    }

    /// The solids that hold the eye and are counted visible for that.
    pub fn holding_eye(&self) -> &[u32] {
        &self.holding_eye
    }

    /// Draws `objects` as seen by `camera`.
    pub fn render(&mut self, objects: &[Object], camera: &Camera) {
        let (width, height) = (self.width, self.height);
        self.meshes.learn(objects);
        self.visible.clear();
        self.visible.resize(objects.len(), 0);
        self.holding_eye.clear();
        if width == 0 || height == 0 {
            return;
        }
        let frustum = Frustum::new(camera);
        let rays = PixelRays::new(&frustum, width, height);
        let setup = Setup { frustum: &frustum, rays, width, height };

        let (entries, meshes) = self.entries(&setup, objects);
        let frame = Frame { objects, rays, meshes, eye: frustum.eye() };

        let (mut hiding, mut others): (Vec<Entry>, Vec<Entry>) =
            entries.into_iter().partition(|entry| entry.hides);
        // Front to back; what does not hide is kept together by object.
        hiding.par_sort_unstable_by_key(|entry| (entry.near.to_bits(), entry.object, entry.triangle));
        others.par_sort_unstable_by_key(|entry| (entry.object, entry.triangle));
        let columns = width.div_ceil(TILE);
        let rows = height.div_ceil(TILE);
        let (hiding_bins, other_bins) =
            rayon::join(|| Bins::new(&hiding, columns, rows), || Bins::new(&others, columns, rows));

        let counts: Vec<AtomicU32> = objects.iter().map(|_| AtomicU32::new(0)).collect();
        self.index
            .par_chunks_mut(width * TILE)
            .zip(self.depth.par_chunks_mut(width * TILE))
            .enumerate()
            .for_each(|(row, (index, depth))| {
                let mut tile = Tile::new();
                for column in 0..columns {
                    let number = row * columns + column;
                    tile.reset(column * TILE, row * TILE, width, height);
                    for &i in hiding_bins.of(number) {
                        let entry = &hiding[i as usize];
                        if f64::from(entry.near) + rays.near > tile.farthest {
                            break;
                        }
                        tile.draw(&frame, entry);
                    }
                    tile.count(&counts);
                    tile.show(&frame, &others, other_bins.of(number), &counts);
                    for y in 0..tile.rows {
                        let from = y * TILE..y * TILE + tile.columns;
                        let to = y * width + tile.x..y * width + tile.x + tile.columns;
                        index[to.clone()].copy_from_slice(&tile.index[from.clone()]);
                        depth[to].copy_from_slice(&tile.depth[from]);
                    }
                }
            });
        self.visible.clear();
        self.visible.extend(counts.into_iter().map(AtomicU32::into_inner));

        if rays.perspective {
            self.count_holders(&setup, objects);
        }
    }

    /// What may be drawn, and the vertices of the meshes among it, as entries number them.
    fn entries(&self, setup: &Setup, objects: &[Object]) -> (Vec<Entry>, Vec<Vec<DVec3>>) {
        let mut entries: Vec<Entry> =
            objects.par_iter().enumerate().filter_map(|(i, object)| setup.solid(i as u32, object)).collect();
        let in_view: Vec<u32> = objects
            .par_iter()
            .enumerate()
            .filter(|(_, object)| setup.mesh_in_view(object, &self.meshes))
            .map(|(i, _)| i as u32)
            .collect();
        let drawn: Vec<(Vec<DVec3>, Vec<Entry>)> = in_view
            .par_iter()
            .enumerate()
            .map(|(slot, &object)| setup.mesh(object, slot as u32, &objects[object as usize]))
            .collect();
        let mut meshes = Vec::with_capacity(drawn.len());
        for (vertices, triangles) in drawn {
            meshes.push(vertices);
            entries.extend(triangles);
        }
        (entries, meshes)
    }

    /// Counts the solids that hold the eye as visible.
    fn count_holders(&mut self, setup: &Setup, objects: &[Object]) {
        self.holding_eye = objects
            .par_iter()
            .enumerate()
            .filter(|(_, object)| setup.holds_eye(object))
            .map(|(i, _)| i as u32)
            .collect();
        for &i in &self.holding_eye {
            self.visible[i as usize] = self.visible[i as usize].max(1);
        }
    }

    /// The ray through the centre of a pixel of a buffer of this size: where
    /// it leaves the near plane, and its way per metre of depth.
    pub(super) fn pixel_ray(&self, frustum: &Frustum, pixel: usize) -> (DVec3, DVec3) {
        let rays = PixelRays::new(frustum, self.width, self.height);
        let (x, y) = (pixel % self.width, pixel / self.width);
        let step = rays.step(x, y);
        (frustum.eye() + rays.start(x, y) + step * rays.near, step)
    }

    /// The first and last pixel (x, y, x, y) an object may cover.
    pub(super) fn rectangle(&self, frustum: &Frustum, object: &Object) -> Option<[u16; 4]> {
        let setup = Setup {
            frustum,
            rays: PixelRays::new(frustum, self.width, self.height),
            width: self.width,
            height: self.height,
        };
        match object.shape {
            Shape::Mesh { .. } => {
                let (min, max) = self.meshes.bounds(&object.shape);
                setup.box_rect(min - frustum.eye(), max - frustum.eye()).map(|(rect, _)| rect)
            }
            _ => setup.solid(0, object).map(|entry| entry.rect),
        }
    }
}
