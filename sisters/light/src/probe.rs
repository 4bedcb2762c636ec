//! Light in the open: what arrives at a point from a direction, what a glossy surface mirrors, and
//! probes for objects that are not in the cache.
//!
//! All of it is found by rays that read the states which they hit, so that no light crosses walls
//! here either, and there is no grid of probes to leak (Majercik et al. 2019 test such grids by
//! depths). Lobes are those of Trowbridge and Reitz (GGX, Walter et al. 2007), sampled by visible
//! normals (Heitz 2018); probes are spherical harmonics (Ramamoorthi and Hanrahan 2001).

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use crate::cache::{Cache, in_parallel};
use crate::checks::{numbers, way};
use crate::colours::Colour;
use crate::direct::Spot;
use crate::error::LightError;
use crate::numeric::{LEAST_ROUGH, MOST_RAYS};
use crate::spread::{Lobe, mix, on_ball};
use crate::states::lifted;

/// The indirect light around a point, for objects that are not in the cache: nine spherical
/// harmonics of its radiance.
///
/// An irradiance of them errs by 1 to 3% of the greatest one where light comes from all sides, and
/// more where it comes from one small place: harmonics of the second order blur that.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Probe {
    /// Real spherical harmonics with the signs of Ramamoorthi and Hanrahan (2001), in the order
    /// 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y²; radiance, by channel.
    pub harmonics: [Vec3; 9],
}

/// The harmonics in a direction.
fn harmonics(d: Vec3) -> [f32; 9] {
    // The roots of 3 and 15 over 4 pi: those of order 1 and 2.
    let (a, b) = (0.488_602_5, 1.092_548_4);
    [
        0.282_094_8,
        a * d.y,
        a * d.z,
        a * d.x,
        b * d.x * d.y,
        b * d.y * d.z,
        0.315_391_57 * (3.0 * d.z * d.z - 1.0),
        b * d.x * d.z,
        0.5 * b * (d.x * d.x - d.y * d.y),
    ]
}

impl Probe {
    /// The irradiance of a surface with a unit normal, in watts per square metre; not below 0.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        // What a cosine keeps of harmonics of order 0, 1 and 2.
        let kept = [PI, 2.0 / 3.0 * PI, 0.25 * PI];
        let order = |i: usize| if i == 0 { 0 } else { 1 + usize::from(i > 3) };
        let all = self.harmonics.iter().zip(harmonics(normal)).enumerate();
        all.map(|(i, (of, y))| *of * (kept[order(i)] * y)).sum::<Vec3>().max(Vec3::ZERO)
    }
}

/// A surface that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Where, in metres.
    pub point: Vec3,
    /// Unit normal on the side that the ray comes from.
    pub normal: Vec3,
    /// Index into [`crate::Scene::materials`].
    pub material: u32,
}

/// What a ray meets: the surface, the spot above it, and its side.
struct Met {
    surface: u32,
    point: DVec3,
    spot: Spot,
}

impl Cache {
    /// The radiance that arrives at a point from a direction, in watts per square metre and
    /// steradian: emission, and what the surface there scatters. The light that it scatters is
    /// that of the gathered states around: shadows are as soft as a cell is wide.
    ///
    /// For mirrors, and for rays of one's own. Costs a ray, and a question without direct light.
    ///
    /// # Errors
    /// If a number is not finite, or the direction has no length.
    pub fn radiance(&self, point: Vec3, direction: Vec3) -> Result<Vec3, LightError> {
        let (from, direction) = self.open_ray(point, direction)?;
        Ok(self.along(from, direction, true))
    }

    /// Asks for the states that [`Cache::radiance`] will read, and returns the surface that the ray
    /// meets. A camera asks so for its picture, and needs no picture of positions.
    ///
    /// # Errors
    /// As there.
    pub fn request_radiance(&mut self, point: Vec3, direction: Vec3) -> Result<Option<Seen>, LightError> {
        Ok(self.request_radiances(&[(point, direction)])?[0])
    }

    /// The same for many rays, each a point and a direction, by all threads.
    ///
    /// # Errors
    /// As there; then nothing is asked for.
    pub fn request_radiances(&mut self, rays: &[(Vec3, Vec3)]) -> Result<Vec<Option<Seen>>, LightError> {
        let open = rays.iter().map(|(point, direction)| self.open_ray(*point, *direction));
        let open = open.collect::<Result<Vec<_>, _>>()?;
        let ask = |&(from, direction): &(DVec3, DVec3)| {
            self.meets(from, direction).map(|met| (self.answering(&met.spot), self.seen_at(&met)))
        };
        let found = in_parallel(&open, self.settings.threads, ask);
        found.iter().flatten().for_each(|(targets, _)| self.want_all(targets));
        Ok(found.into_iter().map(|f| f.map(|(_, seen)| seen)).collect())
    }

    fn seen_at(&self, met: &Met) -> Seen {
        Seen {
            point: self.voxels.lattice.metres(met.point),
            normal: met.spot.normal.as_vec3(),
            material: self.voxels.surfaces[met.surface as usize].material,
        }
    }

    /// The mean radiance that a glossy surface mirrors towards an eye: over the lobe of a
    /// roughness, by so many rays. Multiply it by the surface's directional albedo (the usual
    /// table of two sums).
    ///
    /// `roughness` is the width of GGX, the square of the roughness of most engines: 0 is a
    /// mirror and takes one ray, 1 is dull. An eye below the surface sees nothing.
    ///
    /// # Errors
    /// If a number is not finite, the normal has no length, the roughness is not within 0 and 1,
    /// or there are no or too many rays.
    pub fn reflection(
        &self,
        point: Vec3,
        normal: Vec3,
        eye: Vec3,
        roughness: f32,
        rays: u32,
    ) -> Result<Vec3, LightError> {
        let (mut light, mut sum) = (Vec3::ZERO, 0.0);
        self.mirrored((point, normal), eye, roughness, rays, |from, direction, weight| {
            light += self.along(from, direction, true) * weight as f32;
            sum += weight;
        })?;
        Ok(if sum > 0.0 { light / sum as f32 } else { Vec3::ZERO })
    }

    /// Asks for the states that [`Cache::reflection`] will read.
    ///
    /// # Errors
    /// As there.
    pub fn request_reflection(
        &mut self,
        point: Vec3,
        normal: Vec3,
        eye: Vec3,
        roughness: f32,
        rays: u32,
    ) -> Result<(), LightError> {
        self.request_reflections(&[(point, normal, roughness)], eye, rays)
    }

    /// The same for many points, each with its normal and roughness, by all threads.
    ///
    /// # Errors
    /// As there; then nothing is asked for.
    pub fn request_reflections(
        &mut self,
        points: &[(Vec3, Vec3, f32)],
        eye: Vec3,
        rays: u32,
    ) -> Result<(), LightError> {
        let ask = |&(point, normal, roughness): &(Vec3, Vec3, f32)| {
            let mut targets = Vec::new();
            self.mirrored((point, normal), eye, roughness, rays, |from, direction, _| {
                targets.extend(self.meets(from, direction).map(|met| self.answering(&met.spot)));
            })?;
            Ok(targets.concat())
        };
        let found = in_parallel(points, self.settings.threads, ask);
        let found = found.into_iter().collect::<Result<Vec<_>, LightError>>()?;
        found.iter().for_each(|targets| self.want_all(targets));
        Ok(())
    }

    /// The indirect light around a point, with that of the sky, by so many rays; without lights
    /// and lamps, whose light [`Cache::irradiance`] finds at any point. 64 to 256 rays do.
    ///
    /// For an object that moves and is not in the cache: one probe in its middle, or a few. Costs
    /// the rays, and for each a question without direct light.
    ///
    /// # Errors
    /// If a number is not finite, or there are no or too many rays.
    pub fn probe(&self, point: Vec3, rays: u32) -> Result<Probe, LightError> {
        let mut probe = Probe::default();
        self.all_around(point, rays, |from, direction| {
            let light = self.along(from, direction, false) * (4.0 * PI / rays as f32);
            let of = harmonics(direction.as_vec3());
            probe.harmonics.iter_mut().zip(of).for_each(|(sum, y)| *sum += light * y);
        })?;
        Ok(probe)
    }

    /// Asks for the states that [`Cache::probe`] will read.
    ///
    /// # Errors
    /// As there.
    pub fn request_probe(&mut self, point: Vec3, rays: u32) -> Result<(), LightError> {
        let mut met = Vec::new();
        self.all_around(point, rays, |from, direction| met.extend(self.meets(from, direction)))?;
        met.iter().for_each(|m| self.want_at(&m.spot));
        Ok(())
    }

    fn open_ray(&self, point: Vec3, direction: Vec3) -> Result<(DVec3, DVec3), LightError> {
        numbers("the point of question", 0, point, -f32::MAX..=f32::MAX)?;
        way("the direction of question", 0, direction)?;
        Ok((self.voxels.lattice.cells(point), direction.as_dvec3().normalize()))
    }

    /// Calls `visit` with rays of a lobe and their weights.
    fn mirrored(
        &self,
        (point, normal): (Vec3, Vec3),
        eye: Vec3,
        roughness: f32,
        rays: u32,
        mut visit: impl FnMut(DVec3, DVec3, f64),
    ) -> Result<(), LightError> {
        let spot = self.spot(point, normal)?;
        numbers("the eye of question", 0, eye, -f32::MAX..=f32::MAX)?;
        numbers("the roughness of question", 0, Vec3::splat(roughness), 0.0..=1.0)?;
        some_rays(rays)?;
        let Some(view) = (eye.as_dvec3() - point.as_dvec3()).try_normalize() else { return Ok(()) };
        if view.dot(spot.normal) <= 0.0 {
            return Ok(());
        }
        if roughness < LEAST_ROUGH {
            visit(spot.at, spot.normal * (2.0 * view.dot(spot.normal)) - view, 1.0);
            return Ok(());
        }
        let lobe = Lobe::new(spot.normal, view, f64::from(roughness), rays, spot.key);
        for (direction, weight) in (0..rays).filter_map(|i| lobe.direction(i)) {
            visit(spot.at, direction, weight);
        }
        Ok(())
    }

    /// Calls `visit` with rays from a point into all directions.
    fn all_around(
        &self,
        point: Vec3,
        rays: u32,
        mut visit: impl FnMut(DVec3, DVec3),
    ) -> Result<(), LightError> {
        numbers("the point of question", 0, point, -f32::MAX..=f32::MAX)?;
        some_rays(rays)?;
        let from = self.voxels.lattice.cells(point);
        let key = mix(u64::from(self.settings.seed));
        (0..rays).for_each(|i| visit(from, on_ball(i, rays, key)));
        Ok(())
    }

    fn meets(&self, from: DVec3, direction: DVec3) -> Option<Met> {
        let hit = self.voxels.first(from, direction, f64::INFINITY)?;
        let point = from + direction * hit.distance;
        let (normal, _) = self.voxels.facing(hit.surface, direction);
        let spot = Spot { at: lifted(point, normal).as_dvec3(), normal, key: 0 };
        Some(Met { surface: hit.surface, point, spot })
    }

    /// The radiance along a ray.
    fn along(&self, from: DVec3, direction: DVec3, with_emission: bool) -> Vec3 {
        let Some(met) = self.meets(from, direction) else { return self.sky.radiance(direction.as_vec3()) };
        let surface = &self.voxels.surfaces[met.surface as usize];
        let colour = |which| self.materials.at(surface, met.point, which);
        let emission = if with_emission { colour(Colour::Emission) } else { Vec3::ZERO };
        emission + colour(Colour::Albedo) / PI * self.stored(&met.spot)
    }
}

fn some_rays(value: u32) -> Result<(), LightError> {
    match (1..=MOST_RAYS).contains(&value) {
        true => Ok(()),
        false => Err(LightError::Rays { what: "rays", value }),
    }
}
