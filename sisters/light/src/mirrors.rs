//! Light in the open: what rays meet, and what a glossy surface mirrors.
//!
//! All of it is found by rays that read the states which they hit, so that no light crosses walls
//! here either. Lobes are those of Trowbridge and Reitz (GGX, Walter et al. 2007), sampled by
//! visible normals (Heitz 2018).

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::cache::Cache;
use crate::direct::Spot;
use crate::error::{LightError, numbers, some_rays, way};
use crate::numeric::LEAST_ROUGH;
use crate::spread::Lobe;
use crate::states::lifted;

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

/// What a ray meets: the surface, and the spot above it.
struct Met {
    surface: u32,
    point: DVec3,
    spot: Spot,
}

impl Cache {
    /// Asks for the states around what rays meet, each a point and a direction, by all threads of rayon,
    /// and returns the surfaces that they meet. A camera asks so for its picture, and needs no
    /// picture of positions.
    ///
    /// # Errors
    /// If a number is not finite, or a direction has no length; then nothing is asked for.
    pub fn request_radiances(&mut self, rays: &[(Vec3, Vec3)]) -> Result<Vec<Option<Seen>>, LightError> {
        let open = |&(point, direction): &(Vec3, Vec3)| {
            numbers("the point of question", 0, point, -f32::MAX..=f32::MAX)?;
            way("the direction of question", 0, direction)?;
            Ok((self.voxels.lattice.cells(point), direction.as_dvec3().normalize()))
        };
        let open = rays.iter().map(open).collect::<Result<Vec<_>, _>>()?;
        let ask = |&(from, direction): &(DVec3, DVec3)| {
            self.meets(from, direction).map(|met| (self.answering(&met.spot), self.seen_at(&met)))
        };
        let found: Vec<_> = open.par_iter().map(ask).collect();
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
            light += self.along(from, direction) * weight as f32;
            sum += weight;
        })?;
        Ok(if sum > 0.0 { light / sum as f32 } else { Vec3::ZERO })
    }

    /// Asks for the states that [`Cache::reflection`] will read at points, each with its normal and
    /// roughness, by all threads of rayon.
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
        let found = points.par_iter().map(ask).collect::<Result<Vec<_>, LightError>>()?;
        found.iter().for_each(|targets| self.want_all(targets));
        Ok(())
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
        some_rays("rays", rays)?;
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

    fn meets(&self, from: DVec3, direction: DVec3) -> Option<Met> {
        let hit = self.voxels.first(from, direction, f64::INFINITY)?;
        let point = from + direction * hit.distance;
        let (normal, _) = self.voxels.facing(hit.surface, direction);
        let spot = Spot { at: lifted(point, normal).as_dvec3(), normal, key: 0 };
        Some(Met { surface: hit.surface, point, spot })
    }

    /// The radiance along a ray: emission, and what the surface there scatters of the light of the
    /// gathered states around. So shadows are as soft as a cell is wide.
    fn along(&self, from: DVec3, direction: DVec3) -> Vec3 {
        let Some(met) = self.meets(from, direction) else { return self.sky.radiance(direction.as_vec3()) };
        let surface = &self.voxels.surfaces[met.surface as usize];
        let emission = self.materials[surface.material as usize].emission;
        emission + surface.mean().0 / PI * self.stored(&met.spot)
    }
}
