//! Light by cones through voxels, as J. Villegas traces it (*Trazado de Conos para el Cálculo de
//! Iluminación Global empleando Sombreado de Vóxeles*, UCV 2016), beside the path tracer.
//!
//! Triangles are put into a cube of cells, which are lit; six chains of smaller cubes hold their
//! light and opacity as rays along each axis meet them; a pixel follows six cones of 60 degrees.
//! Errors are RMSE over the mean of the path tracer's picture: of the first and the second bounce,
//! and of the shadow of the first light by one cone, whose truth is a share from 0 to 1. The first
//! row has the noise of those pictures in the same unit, which errors contain. The scene is the
//! Cornell box with a ball of light in its upper half, so far from the ceiling that paths find what
//! it lights.

use std::error::Error;

use casca_radiosity::Light;
use casca_radiosity::lit::path::{PathTracer, Quantity, Render, Surface};
use casca_radiosity::lit::{Kind, LitScene};
use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};

const SIZE: (usize, usize) = (96, 72);
const SAMPLES: u32 = 256;
/// Cells along each axis of the cube, and steps of cones.
const SIZES: [i32; 2] = [32, 64];
const STEPS: [f32; 4] = [0.1, 0.5, 1.0, 2.5];
/// Cells between the scene and the side of the cube. Not a whole number: walls along the axes would
/// lie in the faces of cells.
const MARGIN: f32 = 2.5;
/// Triangles are taken as points, so many to the edge of a cell.
const POINTS: f32 = 3.0;
/// Cones begin so many cells off a surface, and have their first sample as far from there.
const START: f32 = 2.0;
/// The tangent of half the angle of the six cones of a pixel.
const TAN: f32 = 0.577_35;
/// The narrowest cone of a shadow: thinner ones take long, and find no more.
const NARROWEST: f32 = 0.0175;
/// A cone ends where it lets less light than this through: errors are printed to hundredths.
const DARK: f32 = 1e-3;

/// The surface in a cell: sums over points.
#[derive(Clone, Copy, Default)]
struct Voxel {
    albedo: Vec3,
    normal: Vec3,
    point: Vec3,
    count: f32,
}

struct Voxels {
    n: i32,
    cell: f32,
    min: Vec3,
    surfaces: Vec<Voxel>,
    /// Light and opacity: by level, and by direction of rays, two for each axis. Those of level 0
    /// are the same for all directions.
    levels: Vec<[Vec<Vec4>; 6]>,
}

impl Voxels {
    fn new(scene: &LitScene, n: i32) -> Self {
        let (lo, hi) = scene.bounds();
        let cell = (hi - lo).max_element() / (n as f32 - 2.0 * MARGIN);
        let min = (lo + hi) / 2.0 - cell * n as f32 / 2.0;
        let mut surfaces = vec![Voxel::default(); (n * n * n) as usize];
        for t in scene.triangles() {
            let [a, b, c] = t.corners;
            let (u, v) = (b - a, c - a);
            let steps = (u.length().max(v.length()).max((v - u).length()) / cell * POINTS).ceil();
            let albedo = scene.materials[t.material as usize].sound().albedo;
            let normal = u.cross(v).normalize_or_zero();
            for i in 0..=steps as i32 {
                for k in 0..=steps as i32 - i {
                    let point = a + u * (i as f32 / steps) + v * (k as f32 / steps);
                    let at = ((point - min) / cell).floor().as_ivec3();
                    let voxel = &mut surfaces[((at.z * n + at.y) * n + at.x) as usize];
                    voxel.albedo += albedo;
                    voxel.normal += normal;
                    voxel.point += point;
                    voxel.count += 1.0;
                }
            }
        }
        for v in surfaces.iter_mut().filter(|v| v.count > 0.0) {
            (v.albedo, v.point) = (v.albedo / v.count, v.point / v.count);
            v.normal = v.normal.normalize_or_zero();
        }
        Self { n, cell, min, surfaces, levels: Vec::new() }
    }

    /// Lights all surfaces and makes the smaller cubes: in each direction pairs of cells front to
    /// back, and the mean of four pairs, so that a wall stays as opaque as it is from that side.
    fn fill(&mut self, light: impl Fn(&Self, &Voxel) -> Vec3) {
        let of = |v: &Voxel| if v.count > 0.0 { light(self, v).extend(1.0) } else { Vec4::ZERO };
        let base: Vec<Vec4> = self.surfaces.iter().map(of).collect();
        self.levels = vec![std::array::from_fn(|_| base.clone())];
        let mut n = self.n;
        while n > 1 {
            n = (n + 1) / 2;
            let level = self.levels.len() - 1;
            let next = std::array::from_fn(|face| {
                let (axis, is_down) = (face / 2, face % 2 == 1);
                let cells = (0..n * n * n).map(|i| {
                    let mut sum = Vec4::ZERO;
                    for k in 0..4 {
                        let mut front = IVec3::new(i % n, i / n % n, i / n / n) * 2;
                        front[(axis + 1) % 3] += k % 2;
                        front[(axis + 2) % 3] += k / 2;
                        let mut back = front;
                        if is_down {
                            front[axis] += 1
                        } else {
                            back[axis] += 1
                        }
                        let front = self.fetch(level, face, front);
                        sum += front + self.fetch(level, face, back) * (1.0 - front.w);
                    }
                    sum / 4.0
                });
                cells.collect()
            });
            self.levels.push(next);
        }
    }

    fn fetch(&self, level: usize, face: usize, c: IVec3) -> Vec4 {
        let n = (self.n + (1 << level) - 1) >> level;
        let is_inside = c.min_element() >= 0 && c.max_element() < n;
        if is_inside { self.levels[level][face][((c.z * n + c.y) * n + c.x) as usize] } else { Vec4::ZERO }
    }

    /// Light and opacity around a point in cells, as rays of a unit direction meet them.
    fn sample(&self, level: usize, point: Vec3, d: Vec3) -> Vec4 {
        let at = point / (1 << level) as f32 - 0.5;
        let (low, share) = (at.floor(), at - at.floor());
        let mut sum = Vec4::ZERO;
        for axis in 0..3 {
            let face = 2 * axis + usize::from(d[axis] < 0.0);
            for k in 0..8 {
                let high = IVec3::new(k & 1, k >> 1 & 1, k >> 2);
                let near = high.as_vec3();
                let weight = (near * share + (1.0 - near) * (1.0 - share)).element_product();
                sum += self.fetch(level, face, low.as_ivec3() + high) * (weight * d[axis] * d[axis]);
            }
        }
        sum
    }

    /// The light that a cone over a surface gathers, and the share that passes it. A sample has the
    /// opacity of a cell; `corrected`, that of its step.
    fn cone(&self, (at, normal): (Vec3, Vec3), d: Vec3, tan: f32, reach: f32, how: (f32, bool)) -> Vec4 {
        let apex = (at - self.min) / self.cell + normal * START;
        let (mut light, mut passes, mut t) = (Vec3::ZERO, 1.0, START);
        while t < (reach / self.cell).min(2.0 * self.n as f32) && passes > DARK {
            // The level whose cells are as wide as the cone's radius.
            let wanted = (tan * t).max(1.0).log2().min(self.levels.len() as f32 - 1.001);
            let (level, point) = (wanted as usize, apex + d * t);
            let both = [level, level + 1].map(|l| self.sample(l, point, d));
            let mut found = both[0].lerp(both[1], wanted.fract());
            let length = (2.0 * tan * t * how.0).max(0.1);
            if how.1 && found.w > 0.0 {
                found *= (1.0 - (1.0 - found.w.min(1.0)).powf(length / wanted.exp2())) / found.w;
            }
            light += found.xyz() * passes;
            passes *= 1.0 - found.w.min(1.0);
            t += length;
        }
        light.extend(passes)
    }

    /// The mean light over a surface, weighed by the cosine: a cone along the normal, five around.
    fn gather(&self, at: Vec3, normal: Vec3, how: (f32, bool)) -> Vec3 {
        let (x, y) = normal.any_orthonormal_pair();
        let cone = |d: Vec3| self.cone((at, normal), d, TAN, f32::INFINITY, how).xyz();
        let around = (0..5).map(|k| {
            let (s, c) = (k as f32 / 5.0 * std::f32::consts::TAU).sin_cos();
            cone(normal * 0.5 + (x * c + y * s) * 0.75_f32.sqrt()) * 0.15
        });
        cone(normal) * 0.25 + around.sum::<Vec3>()
    }
}

/// The light that the lights of a scene give a surface, with exact shadows.
fn direct(scene: &LitScene, tracer: &PathTracer, v: &Voxel, off: f32) -> Vec3 {
    let from = v.point + v.normal * off;
    let lights = scene.lights.iter().filter_map(|light| {
        let seen = light.incident(from)?;
        let cosine = seen.direction.dot(v.normal).max(0.0);
        let hit = tracer.hit(from.as_dvec3(), seen.direction.as_dvec3());
        let is_free = hit.is_none_or(|h| h.point.as_vec3().distance(from) >= seen.distance);
        is_free.then_some(seen.irradiance * cosine)
    });
    lights.sum::<Vec3>() * v.albedo / std::f32::consts::PI
}

/// The square root of the mean of squared differences over pixels and channels.
fn rmse(truth: &[Vec3], pixels: impl Iterator<Item = Vec3>) -> f64 {
    let sum: f64 = truth.iter().zip(pixels).map(|(a, b)| (*a - b).as_dvec3().length_squared()).sum();
    (sum / (3 * truth.len()) as f64).sqrt()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Kind::CornellPoint.build();
    let intensity = Vec3::new(25.0, 21.0, 11.0);
    scene.lights = vec![Light::Point { position: Vec3::new(2.78, 4.0, 2.8), intensity, radius: 0.25 }];
    let tracer = PathTracer::new(&scene);
    let truth = |quantity| tracer.render(&scene.camera, SIZE, &quantity, SAMPLES, 1);
    let truths = [truth(Quantity::Radiance(2..=2))?, truth(Quantity::Radiance(3..=3))?];
    let shadow = truth(Quantity::Shadow(0))?;
    let shown = tracer.surfaces(&scene.camera, SIZE)?;
    let mean = |truth: &Render| {
        let sum: f32 = truth.image.iter().map(|p| p.element_sum()).sum();
        f64::from(sum / 3.0 / shown.len() as f32)
    };
    let error = |truth: &Render, pixel: &dyn Fn(&Surface) -> Vec3| {
        let pixels = shown.iter().map(|s| s.as_ref().map_or(Vec3::ZERO, pixel));
        rmse(&truth.image, pixels) / mean(truth)
    };
    let noise = |truth: &Render| rmse(&truth.error, shown.iter().map(|_| Vec3::ZERO)) / mean(truth);
    println!("| N | step | opacity | first bounce | second bounce | shadow |\n|---|---|---|---|---|---|");
    let [first, second, soft] = [noise(&truths[0]), noise(&truths[1]), noise(&shadow)];
    println!("| | | noise of the path tracer | {first:.2} | {second:.2} | {soft:.2} |");
    for n in SIZES {
        let mut voxels = Voxels::new(&scene, n);
        let off = 0.01 * voxels.cell;
        for how in STEPS.into_iter().flat_map(|step| [(step, false), (step, true)]) {
            voxels.fill(|_, v| direct(&scene, &tracer, v, off));
            let albedo = |s: &Surface| scene.materials[s.material].albedo;
            let indirect = |voxels: &Voxels, s: &Surface| {
                albedo(s) * voxels.gather(s.point.as_vec3(), s.normal.as_vec3(), how)
            };
            let first = error(&truths[0], &|s| indirect(&voxels, s));
            let soft = error(&shadow, &|s| {
                let (at, normal) = (s.point.as_vec3(), s.normal.as_vec3());
                let seen = scene.lights.first().and_then(|light| light.incident(at));
                let seen = seen.filter(|seen| seen.direction.dot(normal) > 0.0);
                seen.map_or(Vec3::ZERO, |seen| {
                    let cosine = seen.cos_half_angle.max(0.1);
                    let tan = ((1.0 - cosine * cosine).sqrt() / cosine).max(NARROWEST);
                    Vec3::splat(voxels.cone((at, normal), seen.direction, tan, seen.distance, how).w)
                })
            });
            voxels.fill(|lit, v| v.albedo * lit.gather(v.point, v.normal, how));
            let second = error(&truths[1], &|s| indirect(&voxels, s));
            let opacity = if how.1 { "of its step" } else { "of a cell" };
            println!("| {n} | {} | {opacity} | {first:.2} | {second:.2} | {soft:.2} |", how.0);
        }
    }
    Ok(())
}
