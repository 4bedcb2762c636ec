//! Clouds whose visible points are known: by rays at the mesh that they are samples of, or by
//! formulas.

use std::path::Path;
use std::sync::Arc;

use bitvec::vec::BitVec;
use casca_points::Camera;
use glam::{Affine3A, DVec3, Vec3};
use rand::RngExt;
use rayon::prelude::*;

use super::hare::hare;
use super::sample::{Sample, Sampler};
use crate::experiments::LabError;
use casca_scenes::import;
use casca_scenes::random::{Generator, generator};
use casca_scenes::world::{Mesh, Motion, Object, Shape};
use casca_truth::oracle::RayOracle;

/// The view of an eye.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// The eye.
    pub eye: Vec3,
    /// The middle of the picture.
    pub target: Vec3,
    /// The vertical angle of the picture in degrees.
    pub fov: f32,
    /// The least and the largest depth of a point that is seen.
    pub depths: (f32, f32),
}

impl Look {
    /// From `eye` to the middle of something far away, with the angles of the thesis' cameras: near
    /// and far at half and twice the distance.
    pub fn at(eye: Vec3, target: Vec3) -> Self {
        let distance = eye.distance(target);
        Self { eye, target, fov: 45.0, depths: (distance / 2.0, distance * 2.0) }
    }

    /// The camera for a picture of this size.
    ///
    /// # Errors
    /// As [`Camera::look_at`].
    pub fn camera(&self, size: (u32, u32)) -> Result<Camera, LabError> {
        let (near, far) = self.depths;
        let up = if (self.target - self.eye).normalize_or_zero().y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        Ok(Camera::look_at(self.eye, self.target, up, self.fov.to_radians(), size, near, far)?)
    }
}

/// Points, an eye, and the points that it truly sees.
#[derive(Debug, Clone)]
pub struct Cloud {
    /// A name for tables.
    pub name: String,
    /// The points.
    pub points: Vec<Vec3>,
    /// The side of the square of surface that a point stands for.
    pub spacing: f32,
    /// Whether each is visible from the eye.
    pub truth: BitVec,
    /// The eye.
    pub look: Look,
}

/// The vertices of the hare by the square of its cells.
const VERTICES: f64 = 1.836;

/// The middle of the hare.
pub const MIDDLE: Vec3 = Vec3::new(0.05, 1.4, 0.0);

impl Cloud {
    /// The vertices of the hare's mesh, about as many as asked for, seen from in front.
    pub fn hare(count: usize) -> Self {
        Self::hare_from(count, Look::at(Vec3::new(3.6, 3.3, 4.2), MIDDLE))
    }

    /// The same seen from elsewhere.
    pub fn hare_from(count: usize, look: Look) -> Self {
        let cells = (count as f64 / VERTICES).sqrt().round() as u32;
        Self::of_vertices("hare", hare(cells), look)
    }

    /// The vertices of a mesh, judged by rays at its triangles; those around a vertex do not hide
    /// it.
    pub fn of_vertices(name: &str, mesh: Mesh, look: Look) -> Self {
        let (points, area) = (mesh.positions.clone(), Sampler::new(&mesh).map_or(0.0, |s| s.area()));
        let triangles = mesh.triangles.clone();
        let truth =
            seen_on_mesh(mesh, &points, look.eye, |i, triangle| triangles[triangle].contains(&(i as u32)));
        let spacing = (area / points.len().max(1) as f64).sqrt() as f32;
        Self { name: name.to_owned(), points, spacing, truth, look }
    }

    /// Even samples of a mesh, judged by rays.
    ///
    /// # Errors
    /// If the mesh has no area.
    pub fn of_mesh(name: &str, mesh: Mesh, count: usize, seed: u64, look: Look) -> Result<Self, LabError> {
        let (samples, spacing) = samples(&mesh, count, seed)?;
        let points = points_of(&samples);
        let truth =
            seen_on_mesh(mesh, &points, look.eye, |i, triangle| samples[i].triangle as usize == triangle);
        Ok(Self { name: name.to_owned(), points, spacing, truth, look })
    }

    /// All triangles of a glTF file, seen from its camera at the first frame.
    ///
    /// # Errors
    /// As [`import::load`], and if its triangles have no area.
    pub fn of_file(path: &Path, count: usize, seed: u64) -> Result<Self, LabError> {
        let world = import::load(path)?;
        let mut mesh = Mesh::default();
        for object in &world.objects {
            if let Shape::Mesh { mesh: part, transform } = &object.shape {
                mesh.append(placed(part, transform));
            }
        }
        let camera = world.camera(0, 4.0 / 3.0);
        let forward = -camera.view.row(2).truncate();
        let far = 2.0 * world.grid.min.distance(world.grid.max);
        let look = Look { eye: camera.eye, target: camera.eye + forward, fov: 60.0, depths: (0.05, far) };
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Self::of_mesh(&name, mesh, count, seed, look)
    }

    /// A sphere of radius 1, of which the eye sees the points whose tangent planes it is above.
    pub fn sphere(count: usize) -> Self {
        let turn = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
        let at = |i: usize| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (y, x) = (turn * i as f64).sin_cos();
            DVec3::new(x * (1.0 - z * z).sqrt(), y * (1.0 - z * z).sqrt(), z).as_vec3()
        };
        let look = Look::at(Vec3::new(3.0, 2.0, 1.0), Vec3::ZERO);
        let spacing = (4.0 * std::f32::consts::PI / count as f32).sqrt();
        Self::by_formula("sphere", ((0..count).map(at).collect(), spacing), look, |p| {
            p.dot(look.eye.as_dvec3() - p) > 0.0
        })
    }

    /// The surface of a cube from -1 to 1, of which the eye sees three sides.
    ///
    /// # Errors
    /// Never: a cube has an area.
    pub fn cube(count: usize, seed: u64) -> Result<Self, LabError> {
        let (samples, spacing) = samples(&Mesh::cuboid(Vec3::NEG_ONE, Vec3::ONE), count, seed)?;
        let look = Look::at(Vec3::new(4.0, 3.0, 5.0), Vec3::ZERO);
        Ok(Self::by_formula("cube", (points_of(&samples), spacing), look, |p| p.max_element() > 1.0 - 1e-6))
    }

    /// A square of side 2 and the same 0.4 below it. The upper one hides all of the lower one but
    /// what shows past its border.
    ///
    /// # Errors
    /// Never: squares have an area.
    pub fn sheets(count: usize, seed: u64) -> Result<Self, LabError> {
        let square = |y| Mesh {
            positions: [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                .map(|(x, z)| Vec3::new(x, y, z))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let mut mesh = square(0.0);
        mesh.append(square(-0.4));
        let (samples, spacing) = samples(&mesh, count, seed)?;
        let look = Look::at(Vec3::new(1.9, 1.5, 2.3), Vec3::new(0.0, -0.2, 0.0));
        let eye = look.eye.as_dvec3();
        let is_seen = |p: DVec3| {
            // Where the way from the eye passes the height of the upper square.
            let crossing = eye + (p - eye) * (eye.y / (eye.y - p.y));
            p.y > -0.2 || crossing.x.abs() > 1.0 || crossing.z.abs() > 1.0
        };
        Ok(Self::by_formula("sheets", (points_of(&samples), spacing), look, is_seen))
    }

    fn by_formula(
        name: &str,
        (points, spacing): (Vec<Vec3>, f32),
        look: Look,
        is_seen: impl Fn(DVec3) -> bool,
    ) -> Self {
        let truth = points.iter().map(|p| is_seen(p.as_dvec3())).collect();
        Self { name: name.to_owned(), points, spacing, truth, look }
    }

    /// The points in double precision.
    pub fn places(&self) -> Vec<DVec3> {
        self.points.iter().map(|p| p.as_dvec3()).collect()
    }

    /// The diagonal of the bounding box.
    pub fn diagonal(&self) -> f32 {
        let low = self.points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = self.points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        low.distance(high)
    }

    /// The same with points that are moved by Gaussian noise; `sigma` is a part of the diagonal.
    /// The truth is that of the unmoved points.
    pub fn noisy(&self, sigma: f32, seed: u64) -> Self {
        let mut random = generator(seed, 0x9015e);
        let scale = sigma * self.diagonal();
        // Box & Muller 1958.
        let mut normal = || {
            let (u, v) = (1.0 - random.random::<f32>(), random.random::<f32>());
            (-2.0 * u.ln()).sqrt() * (std::f32::consts::TAU * v).cos()
        };
        let moved = |p: &Vec3| *p + Vec3::new(normal(), normal(), normal()) * scale;
        let points = self.points.iter().map(moved).collect();
        Self { points, ..self.clone() }
    }

    /// The points that a function keeps, told by place.
    pub fn filtered(&self, seed: u64, mut keep: impl FnMut(Vec3, &mut Generator) -> bool) -> Self {
        let mut random = generator(seed, 0xde15);
        let kept: Vec<bool> = self.points.iter().map(|&p| keep(p, &mut random)).collect();
        let points = self.points.iter().zip(&kept).filter(|(_, k)| **k).map(|(p, _)| *p).collect();
        let truth = self.truth.iter().by_vals().zip(&kept).filter(|(_, k)| **k).map(|(t, _)| t).collect();
        Self { points, truth, ..self.clone() }
    }
}

/// Even samples, and the side of the square that one stands for.
fn samples(mesh: &Mesh, count: usize, seed: u64) -> Result<(Vec<Sample>, f32), LabError> {
    let sampler = Sampler::new(mesh).ok_or("the mesh has no area, or one that is not finite")?;
    let samples = sampler.evenly(count, seed);
    let spacing = (sampler.area() / samples.len().max(1) as f64).sqrt() as f32;
    Ok((samples, spacing))
}

fn points_of(samples: &[Sample]) -> Vec<Vec3> {
    samples.iter().map(|s| s.point).collect()
}

fn placed(mesh: &Mesh, transform: &Affine3A) -> Mesh {
    let positions = mesh.positions.iter().map(|&p| transform.transform_point3(p)).collect();
    Mesh { positions, triangles: mesh.triangles.clone(), ..Mesh::default() }
}

/// Whether the eye sees each point of a mesh: no triangle is between them but those that are the
/// point's own.
fn seen_on_mesh(mesh: Mesh, points: &[Vec3], eye: Vec3, own: impl Fn(usize, usize) -> bool + Sync) -> BitVec {
    let shape = Shape::Mesh { mesh: Arc::new(mesh), transform: Affine3A::IDENTITY };
    let object = Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: true };
    let rays = RayOracle::new(&[object]);
    let is_seen = |(i, p): (usize, &Vec3)| {
        !rays.hides_point(eye.as_dvec3(), p.as_dvec3(), 0, |triangle| own(i, triangle))
    };
    let seen: Vec<bool> = points.par_iter().enumerate().map(is_seen).collect();
    seen.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::points::judge::Confusion;

    /// The truth by rays, at a mesh, beside that of a formula.
    fn compared(cloud: &Cloud, mesh: Mesh, samples: &[Sample]) -> Confusion {
        let own = |i: usize, triangle| samples[i].triangle as usize == triangle;
        Confusion::of(&cloud.truth, &seen_on_mesh(mesh, &points_of(samples), cloud.look.eye, own))
    }

    #[test]
    fn rays_agree_with_formulas() {
        let cube = Cloud::cube(4000, 3).unwrap();
        let mesh = Mesh::cuboid(Vec3::NEG_ONE, Vec3::ONE);
        let samples_of_cube = samples(&mesh, 4000, 3).unwrap().0;
        assert_eq!(points_of(&samples_of_cube), cube.points);
        let found = compared(&cube, mesh, &samples_of_cube);
        // Points on an edge, within rounding, belong to both sides.
        assert!(found.visible > 1900 && found.false_visible + found.false_hidden <= 2, "{found:?}");

        let ball = Mesh::ball(5);
        let samples_of_ball = samples(&ball, 4000, 3).unwrap().0;
        let look = Cloud::sphere(1).look;
        let by_tangent = |p: DVec3| p.dot(look.eye.as_dvec3() - p) > 0.0;
        let sphere = Cloud::by_formula("ball", (points_of(&samples_of_ball), 0.0), look, by_tangent);
        let found = compared(&sphere, ball, &samples_of_ball);
        // A ball of flat triangles has another limb than a sphere, by half a triangle.
        assert!(found.visible > 1300 && found.false_visible + found.false_hidden < 60, "{found:?}");
    }

    #[test]
    fn the_upper_sheet_hides_most_of_the_lower_one() {
        let cloud = Cloud::sheets(6000, 1).unwrap();
        let of_lower = |seen| {
            let both = cloud.points.iter().zip(&cloud.truth);
            both.filter(|(p, truth)| p.y < -0.2 && **truth == seen).count()
        };
        assert_eq!(cloud.truth.count_zeros(), of_lower(false));
        // The shadow of the upper square on the height of the lower one, by hand: from -1 to 0.76
        // and from -1 to 0.653.
        let share = of_lower(true) as f64 / (of_lower(true) + of_lower(false)) as f64;
        assert!((share - (1.0 - 1.76 * 1.653 / 4.0)).abs() < 0.015, "{share}");
    }

    #[test]
    fn the_hare_is_closed_and_has_hollows_and_its_samples_are_even() {
        let mesh = hare(60);
        assert!(mesh.is_closed() && mesh.triangles.len() > 10_000, "{}", mesh.triangles.len());
        let vertices = Cloud::hare(9000);
        assert!((8800..9200).contains(&vertices.points.len()), "{}", vertices.points.len());
        // A triangle of a limb faces the eye or not; its vertices belong to others, too.
        let share = vertices.truth.count_ones() as f64 / vertices.points.len() as f64;
        assert!((0.36..0.46).contains(&share), "{share}");
        let cloud = Cloud::of_mesh("hare", mesh, 3000, 1, Cloud::hare(100).look).unwrap();
        assert!((2900..=3000).contains(&cloud.points.len()), "{}", cloud.points.len());
        // A convex body shows less than half of itself; one with hollows shows still less, and
        // hides parts that face the eye.
        let seen = cloud.truth.count_ones();
        assert!((900..1400).contains(&seen), "{seen}");
        let nearest = |p: &Vec3| {
            let others = cloud.points.iter().filter(|q| *q != p).map(|q| p.distance(*q));
            others.fold(f32::INFINITY, f32::min)
        };
        let (least, most) =
            cloud.points.iter().map(nearest).fold((f32::INFINITY, 0.0_f32), |(a, b), d| (a.min(d), b.max(d)));
        assert!(most < 2.2 * least, "{least} {most}");
    }

    #[test]
    fn noise_has_its_size_and_filters_keep_the_truth_of_their_points() {
        let cloud = Cloud::sphere(5000);
        let noisy = cloud.noisy(0.01, 7);
        let square: f32 = cloud.points.iter().zip(&noisy.points).map(|(a, b)| a.distance_squared(*b)).sum();
        let expected = 0.01 * cloud.diagonal() * 3_f32.sqrt();
        assert!(((square / 5000.0).sqrt() / expected - 1.0).abs() < 0.05);
        let eye = cloud.look.eye;
        let near = cloud.filtered(1, |p, _| p.dot(eye - p) > 0.0);
        assert!(near.truth.all() && near.points.len() == cloud.truth.count_ones());
    }
}
