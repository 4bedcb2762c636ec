//! Direct light: lights that are no surfaces, and lamps, which are emissive triangles.
//!
//! Lamps are weighed at many points without shadows, and shadow rays go to a few of these, chosen
//! by weight (resampled importance sampling, Talbot et al. 2005, with systematic resampling). The
//! weights of a lamp are scaled to what the whole of it would give, which is known (Lambert 1760).

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::input::{Light, Material, Settings};
use crate::numeric::{GOLDEN, LIFT};
use crate::spread::{in_triangle, mix, on_disc, unit};
use crate::states::mixed;
use crate::voxels::Voxels;

/// A lamp.
#[derive(Debug, Clone, Copy)]
struct Lamp {
    surface: u32,
    radiance: Vec3,
    /// Luminance of the radiance.
    bright: f64,
    /// The share of the power of all lamps that lies before it and in it.
    share: f64,
}

/// All lamps of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lamps {
    all: Vec<Lamp>,
}

/// A point above a surface that asks for light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// In cells, above the surface.
    pub(crate) at: DVec3,
    /// Unit normal.
    pub(crate) normal: DVec3,
    /// The seed of the choices that are made at this point.
    pub(crate) key: u64,
}

impl Lamps {
    /// The emissive triangles; O(triangles).
    pub(crate) fn new(voxels: &Voxels, materials: &[Material]) -> Self {
        let (mut all, mut power) = (Vec::new(), 0.0);
        for (surface, s) in (0..).zip(&voxels.surfaces) {
            let material = &materials[s.material as usize];
            // Nothing shines in holes.
            let radiance = material.emission * s.mean().1;
            // As the eye weighs it (Rec. 709).
            let bright = radiance.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722));
            // Shares of what single precision takes for no light are no numbers.
            if bright as f32 > 0.0 {
                power += bright * s.area;
                all.push(Lamp { surface, radiance, bright, share: power });
            }
        }
        all.iter_mut().for_each(|l| l.share /= power);
        Self { all }
    }

    /// Each lamp's triangle, mean radiance, luminance and share up to it; and the power of all:
    /// luminance times square cells.
    #[cfg(feature = "gpu")]
    pub(crate) fn described(&self, voxels: &Voxels) -> (Vec<(u32, Vec3, f64, f64)>, f64) {
        let of = |l: &Lamp| (l.surface, l.radiance, l.bright, l.share);
        let power = self.all.iter().map(|l| l.bright * voxels.surfaces[l.surface as usize].area).sum();
        (self.all.iter().map(of).collect(), power)
    }

    /// The irradiance at a spot by so many weighed points and shadow rays.
    fn irradiance(&self, sources: &Sources, spot: &Spot, points: u32, rays: u32) -> Vec3 {
        let voxels = sources.voxels;
        if self.all.is_empty() {
            return Vec3::ZERO;
        }
        let choices = self.choices(voxels, spot, points);
        let Some(sum) = choices.last().map(|c| c.sum).filter(|s| *s > 0.0) else { return Vec3::ZERO };
        let start = unit(spot.key, 6);
        let mut light = Vec3::ZERO;
        for i in 0..rays {
            let along = (f64::from(i) + start) / f64::from(rays) * sum;
            let at = choices.partition_point(|c| c.sum <= along).min(choices.len() - 1);
            let (lamp, point) = (&self.all[choices[at].lamp], choices[at].point);
            let normal = voxels.facing(lamp.surface, point - spot.at).0;
            if voxels.free(spot.at, point + normal * LIFT) {
                light += lamp.radiance / lamp.bright as f32;
            }
        }
        light * (sum / f64::from(rays)) as f32
    }

    /// Points of lamps with their weights: those of one lamp are in sum what the whole of it would
    /// give if nothing hid it.
    fn choices(&self, voxels: &Voxels, spot: &Spot, points: u32) -> Vec<Choice> {
        let (turn, shift) = (unit(spot.key, 4), unit(spot.key, 5));
        let (mut choices, mut sum, mut i) = (Vec::with_capacity(points as usize), 0.0, 0);
        let along = |i: u32| (f64::from(i) + turn) / f64::from(points);
        while i < points {
            let at = self.all.partition_point(|l| l.share <= along(i)).min(self.all.len() - 1);
            let before = if at == 0 { 0.0 } else { self.all[at - 1].share };
            let part = self.all[at].share - before;
            let surface = &voxels.surfaces[self.all[at].surface as usize];
            let (first, start) = (choices.len(), sum);
            while i < points && (along(i) < self.all[at].share || at + 1 == self.all.len()) {
                let across = (f64::from(i) * GOLDEN + shift).fract();
                let inside = ((along(i) - before) / part).clamp(0.0, 1.0);
                let point = mixed(surface, in_triangle(inside, across));
                sum += small(spot, point, surface.normal);
                choices.push(Choice { lamp: at, point, sum });
                i += 1;
            }
            // A lamp that is chosen by chance stands for others.
            let stands_for = (part * f64::from(points)).min(1.0);
            let whole = self.all[at].bright * polygon(spot, &surface.corners) / stands_for;
            let scale = if sum > start { whole / (sum - start) } else { 0.0 };
            choices[first..].iter_mut().for_each(|c| c.sum = start + (c.sum - start) * scale);
            sum = start + (sum - start) * scale;
        }
        choices
    }
}

/// A point of a lamp, and the weights up to it.
struct Choice {
    lamp: usize,
    point: DVec3,
    sum: f64,
}

/// The product of the solid angle and the cosine of a small part of a lamp, as seen from a spot, by
/// its area.
fn small(spot: &Spot, point: DVec3, normal: DVec3) -> f64 {
    let way = point - spot.at;
    let square = way.length_squared();
    let cosines = way.dot(spot.normal).max(0.0) * way.dot(normal).abs();
    if square > 0.0 { cosines / (square * square) } else { 0.0 }
}

/// The irradiance of a spot by a polygon of radiance 1 that nothing hides (Lambert 1760): exact,
/// however near it is.
fn polygon(spot: &Spot, corners: &[DVec3]) -> f64 {
    // What is above the horizon.
    let mut above: SmallVec<[DVec3; 6]> = SmallVec::new();
    for (i, corner) in corners.iter().enumerate() {
        let (p, q) = (*corner - spot.at, corners[(i + 1) % corners.len()] - spot.at);
        let (hp, hq) = (p.dot(spot.normal), q.dot(spot.normal));
        if hp >= 0.0 {
            above.push(p);
        }
        if hp * hq < 0.0 {
            above.push(p + (q - p) * (hp / (hp - hq)));
        }
    }
    let edge = |i: usize| {
        let (p, q) = (above[i], above[(i + 1) % above.len()]);
        let cross = p.cross(q);
        let angle = cross.length().atan2(p.dot(q));
        cross.try_normalize().map_or(0.0, |c| angle * c.dot(spot.normal))
    };
    let sum: f64 = (0..above.len()).map(edge).sum();
    0.5 * sum.abs()
}

/// Everything that shines directly.
pub(crate) struct Sources<'a> {
    pub(crate) voxels: &'a Voxels,
    pub(crate) lights: &'a [Light],
    pub(crate) lamps: &'a Lamps,
    pub(crate) settings: &'a Settings,
}

impl Sources<'_> {
    /// The direct irradiance at a spot with `1 / share` of the settings' rays.
    pub(crate) fn irradiance(&self, spot: &Spot, share: u32) -> Vec3 {
        let of = |count: u32| count.div_ceil(share);
        let (points, rays) = (of(self.settings.lamp_points), of(self.settings.lamp_rays));
        let lights = self.lights.iter().enumerate().map(|(i, light)| {
            let key = mix(spot.key ^ mix(i as u64));
            self.of_light(light, &Spot { key, ..*spot }, of(self.settings.light_rays))
        });
        lights.sum::<Vec3>() + self.lamps.irradiance(self, spot, points, rays)
    }

    fn of_light(&self, light: &Light, spot: &Spot, rays: u32) -> Vec3 {
        let lattice = &self.voxels.lattice;
        match *light {
            Light::Point { position, intensity, radius } => {
                let centre = lattice.cells(position);
                intensity * self.of_ball(centre, f64::from(radius), spot, rays)
            }
            Light::Spot { position, direction, intensity, inner, outer, radius } => {
                let centre = lattice.cells(position);
                let axis = direction.as_dvec3().normalize_or_zero();
                let cosine = (spot.at - centre).normalize_or_zero().dot(axis);
                let (low, high) = (f64::from(outer).cos(), f64::from(inner).cos());
                let share = match cosine {
                    c if c >= high => 1.0,
                    c if c <= low => return Vec3::ZERO,
                    c => (c - low) / (high - low),
                };
                let smooth = share * share * (3.0 - 2.0 * share);
                intensity * smooth as f32 * self.of_ball(centre, f64::from(radius), spot, rays)
            }
            Light::Sun { direction, irradiance, half_angle } => {
                let way = -direction.as_dvec3().normalize_or_zero();
                let cosine = way.dot(spot.normal);
                if cosine <= 0.0 {
                    return Vec3::ZERO;
                }
                let tangent = f64::from(half_angle).tan();
                let share = self.seen(way, tangent, rays, spot, |d| {
                    self.voxels.first(spot.at, d.normalize(), f64::INFINITY).is_none()
                });
                irradiance * (cosine * share) as f32
            }
        }
    }

    /// The share of a disc around a way, as wide as a tangent, that is seen.
    fn seen(&self, way: DVec3, tangent: f64, rays: u32, spot: &Spot, free: impl Fn(DVec3) -> bool) -> f64 {
        let rays = if tangent > 0.0 { rays } else { 1 };
        let (right, up) = way.any_orthonormal_pair();
        let see = |i: &u32| {
            let (x, y) = on_disc(*i, rays, spot.key);
            free(way + (right * x + up * y) * tangent)
        };
        (0..rays).filter(see).count() as f64 / f64::from(rays)
    }

    /// The irradiance of a ball of one watt per steradian, in 1 / m².
    fn of_ball(&self, centre: DVec3, radius: f64, spot: &Spot, rays: u32) -> f32 {
        let way = centre - spot.at;
        let distance = way.length();
        let Some(unit) = way.try_normalize() else { return 0.0 };
        let cosine = unit.dot(spot.normal);
        if cosine <= 0.0 {
            return 0.0;
        }
        let cell = self.voxels.lattice.cell;
        let tangent = radius / cell / distance;
        let free = |d: DVec3| self.voxels.free(spot.at, spot.at + d * distance);
        let share = self.seen(unit, tangent, rays, spot, free);
        let metres = distance * cell;
        let irradiance = cosine * share / (metres * metres);
        if irradiance.is_finite() { irradiance as f32 } else { 0.0 }
    }
}
