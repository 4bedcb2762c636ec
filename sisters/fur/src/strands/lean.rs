//! Strands that follow gravity, wind and the motion of their animal, by bending.

use glam::{Mat3, Vec3};

use super::fur::Fur;
use crate::error::{Error, range};
use crate::numeric::LEAST_DIVISOR;

/// How all strands of an animal lean in the world, besides the bend that their fur has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lean {
    /// How far tips are moved, in multiples of the fur's height, in world space.
    pub towards: Vec3,
    /// The longest bend with what the fur has of its own: longer ones are shortened to it. 0 for no
    /// lean at all.
    pub most: f32,
}

impl Lean {
    /// The bend of strands in the mesh at rest, whose axes in the world are the columns of `axes`:
    /// of the fur and of the lean, no longer than [`Lean::most`]. Axes turn the lean back, whatever
    /// their lengths. The twin of what the vertex stage does.
    pub fn bend(&self, own: Vec3, axes: Mat3) -> Vec3 {
        if self.most.is_nan() || self.most <= 0.0 {
            return own;
        }
        let back = |axis: Vec3| axis.dot(self.towards) / axis.length().max(LEAST_DIVISOR);
        let sum = own + Vec3::new(back(axes.x_axis), back(axes.y_axis), back(axes.z_axis));
        sum * (self.most / sum.length().max(LEAST_DIVISOR)).min(1.0)
    }
}

/// Forces that bend strands. There is no memory: a strand is where its animal's motion puts it now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// How far gravity pulls tips down (against y), in multiples of the fur's height.
    pub gravity: f32,
    /// The velocity of the air, in units a second.
    pub wind: Vec3,
    /// How far tips go for each unit a second that the air is faster than the animal.
    pub drag: f32,
    /// How far tips stay behind for each unit a second, squared, that the animal speeds up.
    pub inertia: f32,
    /// The longest bend, at most 4.
    pub most: f32,
}

impl Default for Forces {
    /// Still air; fur of an animal of a unit's length that walks.
    fn default() -> Self {
        Self { gravity: 0.3, wind: Vec3::ZERO, drag: 0.35, inertia: 0.05, most: 1.5 }
    }
}

impl Forces {
    /// How strands lean on an animal of this velocity and acceleration, in world units and seconds.
    /// Numbers that are not finite count as 0.
    ///
    /// # Errors
    /// Refuses a longest bend outside of 0 to 4.
    pub fn lean(&self, velocity: Vec3, acceleration: Vec3) -> Result<Lean, Error> {
        range("the longest bend", self.most.into(), 0.0, 4.0)?;
        let towards =
            Vec3::NEG_Y * self.gravity + (self.wind - velocity) * self.drag - acceleration * self.inertia;
        let towards = if towards.is_finite() { towards } else { Vec3::ZERO };
        Ok(Lean { towards, most: self.most })
    }
}

impl Fur {
    /// The fur as bounds must take it where strands [lean](Lean) with bends of up to `most`: its
    /// reach holds all of them.
    ///
    /// A bend of length b moves no tip farther than `height * sqrt(1 + b²)` from its root: only the
    /// part along the surface counts, at right angles to the height ([`Fur::extruded`]). Between
    /// the vertices of a triangle bends are means of three, which are no longer than the longest.
    ///
    /// # Errors
    /// Refuses bends outside of 0 to 4.
    pub fn leaning(&self, most: f32) -> Result<Self, Error> {
        range("the longest bend", most.into(), 0.0, 4.0)?;
        let longest = self.bend.length().max(most);
        Ok(Self { bend: Vec3::X * longest, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use casca_scenes::random::Dice;

    #[test]
    fn tips_stay_within_the_reach_however_strands_lean() {
        let mut random = Dice::new(8, 0);
        let mut farthest = 0f32;
        for case in 0..20_000 {
            let fur = Fur { bend: random.ball() * 2.0, ..Fur::for_radius(1.0, 0.3, 0.25).unwrap() };
            let most = if case % 10 == 0 { 0.0 } else { 4.0 * random.range(0.0, 1.0) };
            let lean = Lean { towards: random.ball() * 100f32.powf(random.range(0.0, 1.0)), most };
            let turn = Quat::from_axis_angle(random.ball().normalize(), random.range(0.0, 6.0));
            let axes = Mat3::from_quat(turn) * Mat3::from_diagonal(random.ball() * 3.0);
            let bends = [0; 3].map(|_| lean.bend(fur.bend, axes * (0.5 + random.range(0.0, 1.0))));
            let bend = bends[0].lerp(bends[1], random.range(0.0, 1.0)).lerp(bends[2], random.range(0.0, 1.0));
            let bent = Fur { bend, ..fur };
            let (p, n, h) = (random.ball(), random.ball().normalize(), random.range(0.0, 1.0));
            let reach = fur.leaning(most).unwrap().reach(1.0);
            let way = (bent.extruded(p, n, h) - p).length().max((bent.extruded(p, n, 1.0) - p).length());
            assert!(way <= reach, "{lean:?}: {way} > {reach}");
            farthest = farthest.max(way / reach);
        }
        assert!(farthest > 0.95, "{farthest}");
    }

    #[test]
    fn strands_lean_in_the_world_however_their_skin_is_turned() {
        let lean = Lean { towards: Vec3::NEG_Y, most: 1.0 };
        let mut random = Dice::new(2, 0);
        for _ in 0..100 {
            let turn = Quat::from_axis_angle(random.ball().normalize(), random.range(0.0, 6.0));
            let scale = 0.1 + random.range(0.0, 1.0);
            let bend = lean.bend(Vec3::ZERO, Mat3::from_quat(turn) * scale);
            assert!((turn * bend).distance(Vec3::NEG_Y) < 1e-5);
        }
        // None without a longest bend, and a number for axes that are flat.
        assert_eq!(Lean { most: 0.0, ..lean }.bend(Vec3::X * 3.0, Mat3::IDENTITY), Vec3::X * 3.0);
        assert!(lean.bend(Vec3::X, Mat3::ZERO).is_finite());
    }

    #[test]
    fn strands_stay_behind_and_hang_down() {
        let forces = Forces::default();
        let still = forces.lean(Vec3::ZERO, Vec3::ZERO).unwrap().towards;
        assert_eq!(still, Vec3::NEG_Y * 0.3);
        let running = forces.lean(Vec3::X * 2.0, Vec3::X).unwrap().towards;
        assert!(running.x < -0.7 && running.y == still.y);
        let windy = Forces { wind: Vec3::Z * 2.0, ..forces }.lean(Vec3::Z * 2.0, Vec3::ZERO).unwrap();
        assert_eq!(windy.towards, still, "as fast as the air");
        assert_eq!(forces.lean(Vec3::NAN, Vec3::ZERO).unwrap().towards, Vec3::ZERO);
        assert!(Forces { most: f32::NAN, ..forces }.lean(Vec3::ZERO, Vec3::ZERO).is_err());
        assert!(Fur::for_radius(1.0, 0.1, 0.2).unwrap().leaning(5.0).is_err());
    }
}
