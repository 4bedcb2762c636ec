//! Boxes and spheres that lines are chosen by.

use std::str::FromStr;

use glam::Vec3;

use crate::sets::LineSet;

/// A part of space with its border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// A box along the axes.
    Box {
        /// The least corner.
        min: Vec3,
        /// The greatest corner.
        max: Vec3,
    },
    /// A ball.
    Sphere {
        /// The middle.
        middle: Vec3,
        /// The radius, not below 0.
        radius: f32,
    },
}

/// Why a text names no region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected box:X0,Y0,Z0,X1,Y1,Z1 with its least corner first, or sphere:X,Y,Z,RADIUS")]
pub struct RegionError;

impl FromStr for Region {
    type Err = RegionError;

    /// From `box:X0,Y0,Z0,X1,Y1,Z1` or `sphere:X,Y,Z,RADIUS`.
    fn from_str(text: &str) -> Result<Self, RegionError> {
        let (kind, numbers) = text.split_once(':').ok_or(RegionError)?;
        let number = |word: &str| word.trim().parse::<f32>().ok().filter(|v| v.is_finite());
        let numbers: Option<Vec<f32>> = numbers.split(',').take(7).map(number).collect();
        let region = match (kind.trim(), &numbers.ok_or(RegionError)?[..]) {
            ("box", &[a, b, c, d, e, f]) => Self::Box { min: Vec3::new(a, b, c), max: Vec3::new(d, e, f) },
            ("sphere", &[x, y, z, radius]) => Self::Sphere { middle: Vec3::new(x, y, z), radius },
            _ => return Err(RegionError),
        };
        if region.is_empty() { Err(RegionError) } else { Ok(region) }
    }
}

impl Region {
    /// Whether nothing is in it: a corner or the radius is the wrong way round or NaN.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Box { min, max } => !min.cmple(*max).all(),
            Self::Sphere { middle, radius } => middle.is_nan() || radius.is_nan() || *radius < 0.0,
        }
    }

    /// Whether a segment has a point in the region or on its border, also where both ends lie
    /// outside. In double precision: segments that come nearer to the border than about 1e-15 of
    /// the coordinates may be taken either way.
    pub fn meets(&self, a: Vec3, b: Vec3) -> bool {
        if self.is_empty() || !(a.is_finite() && b.is_finite()) {
            return false;
        }
        let (a, b) = (a.as_dvec3(), b.as_dvec3());
        match self {
            // The axes that can separate a segment from a box are those of the box and their products
            // with the segment (Gottschalk, Lin and Manocha 1996).
            Self::Box { min, max } => {
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                let (middle, half) = ((min + max) / 2.0, (max - min) / 2.0);
                let (from, way) = (a - middle, b - a);
                let (cross, wide) = (from.cross(way).abs(), way.abs());
                let reach = |i: usize, j: usize| half[i] * wide[j] + half[j] * wide[i];
                let is_beside = a.min(b).cmpgt(max).any() || a.max(b).cmplt(min).any();
                !is_beside && cross.x <= reach(1, 2) && cross.y <= reach(2, 0) && cross.z <= reach(0, 1)
            }
            Self::Sphere { middle, radius } => {
                let (from, way) = (a - middle.as_dvec3(), b - a);
                let along = -from.dot(way) / way.length_squared();
                // A dot has no way.
                let nearest = from + way * if along > 0.0 { along.min(1.0) } else { 0.0 };
                nearest.length_squared() <= f64::from(*radius).powi(2)
            }
        }
    }

    /// Whether a line has a point in the region; a line of one vertex is a dot.
    pub fn meets_line(&self, line: &[Vec3]) -> bool {
        match line {
            [dot] => self.meets(*dot, *dot),
            _ => line.windows(2).any(|pair| self.meets(pair[0], pair[1])),
        }
    }
}

impl LineSet {
    /// The lines that meet all regions of `include` and none of `exclude`, whole and with their
    /// attributes.
    ///
    /// Time: the segments times the regions.
    pub fn within(&self, include: &[Region], exclude: &[Region]) -> Self {
        self.chosen(|_, line| {
            include.iter().all(|r| r.meets_line(line)) && !exclude.iter().any(|r| r.meets_line(line))
        })
    }
}

#[cfg(test)]
mod tests {
    use casca_truth::cases;
    use glam::vec3;
    use proptest::prelude::*;

    use super::*;

    const CUBE: Region = Region::Box { min: Vec3::ZERO, max: Vec3::ONE };
    const BALL: Region = Region::Sphere { middle: Vec3::ZERO, radius: 5.0 };

    #[test]
    fn segments_cross_regions_without_an_end_in_them_and_borders_count() {
        let huge = Region::Box { min: Vec3::splat(-f32::MAX), max: Vec3::splat(f32::MAX) };
        for (region, a, b, wanted) in [
            (CUBE, [-1.0, 0.5, 0.5], [2.0, 0.5, 0.5], true),
            // Along an edge, through one, past one, and before it.
            (CUBE, [-1.0, 1.0, 1.0], [2.0, 1.0, 1.0], true),
            (CUBE, [-1.0, 1.0, 0.5], [1.0, -1.0, 0.5], true),
            (CUBE, [-1.0, 0.75, 0.5], [0.75, -1.0, 0.5], false),
            (CUBE, [2.0, 0.5, 0.5], [3.0, 0.5, 0.5], false),
            (CUBE, [0.5; 3], [0.5; 3], true),
            (CUBE, [1.5; 3], [1.5; 3], false),
            (BALL, [-9.0, 3.0, 4.0], [9.0, 3.0, 4.0], true),
            (BALL, [-9.0, 3.0, 4.001], [9.0, 3.0, 4.001], false),
            (BALL, [6.0, 0.0, 0.0], [9.0, 0.0, 0.0], false),
            (BALL, [0.0, 0.0, 5.0], [0.0, 0.0, 5.0], true),
            (BALL, [0.0, 0.0, 5.1], [0.0, 0.0, 5.1], false),
            (huge, [-f32::MAX; 3], [f32::MAX; 3], true),
            (CUBE, [f32::NAN; 3], [1.0; 3], false),
            (Region::Box { min: Vec3::ONE, max: Vec3::ZERO }, [0.0; 3], [1.0; 3], false),
            (Region::Box { min: Vec3::NAN, max: Vec3::ONE }, [0.0; 3], [1.0; 3], false),
            (Region::Sphere { middle: Vec3::ZERO, radius: f32::NAN }, [0.0; 3], [1.0; 3], false),
        ] {
            assert_eq!(region.meets(a.into(), b.into()), wanted, "{region:?} {a:?} {b:?}");
            assert_eq!(region.meets(b.into(), a.into()), wanted, "{region:?} {a:?} {b:?}");
        }
    }

    #[test]
    fn texts_name_regions() {
        assert_eq!("box:0,0,0,1,1,1".parse(), Ok(CUBE));
        assert_eq!("sphere: 0, 0,0 ,5".parse(), Ok(BALL));
        for wrong in
            ["", "box", "box:1,2", "sphere:0,0,0,-1", "box:1,0,0,0,1,1", "sphere:0,0,0,inf", "disc:0,0,0,1"]
        {
            assert_eq!(wrong.parse::<Region>(), Err(RegionError), "{wrong}");
        }
        assert_eq!("box:0,0,0,1,1,1,1".parse::<Region>(), Err(RegionError));
    }

    #[test]
    fn lines_must_meet_all_that_include_and_none_that_exclude() {
        let lines = [
            vec![vec3(-1.0, 0.5, 0.5), vec3(2.0, 0.5, 0.5)],
            vec![vec3(0.5, 0.5, 0.5)],
            vec![vec3(-1.0, 0.5, 0.5), vec3(-1.0, 9.0, 9.0)],
            vec![],
        ];
        let set = LineSet::new(lines).unwrap();
        let first = |line: Vec<Vec3>| LineSet::new([line]).unwrap();
        assert_eq!(set.within(&[], &[]), set);
        assert_eq!(set.within(&[CUBE], &[]).len(), 2);
        let far = Region::Sphere { middle: vec3(2.0, 0.5, 0.5), radius: 0.1 };
        assert_eq!(set.within(&[CUBE, far], &[]), first(set.points()[..2].to_vec()));
        assert_eq!(set.within(&[CUBE], &[far]), first(vec![Vec3::splat(0.5)]));
    }

    proptest! {
        #![proptest_config(cases(256))]

        /// Against the least distance over many points of the segment.
        #[test]
        fn segments_agree_with_points_on_them(a in point(), b in point(), size in prop_oneof![0.1f32..3.0, Just(1.0f32), Just(2.0)]) {
            let cube = Region::Box { min: Vec3::splat(-size), max: Vec3::splat(size) };
            let ball = Region::Sphere { middle: Vec3::ZERO, radius: size };
            const STEPS: i32 = 4000;
            let along = |i: i32| a.as_dvec3().lerp(b.as_dvec3(), f64::from(i) / f64::from(STEPS));
            let farthest = (0..=STEPS).map(|i| along(i).abs().max_element()).fold(f64::INFINITY, f64::min);
            let nearest = (0..=STEPS).map(|i| along(i).length()).fold(f64::INFINITY, f64::min);
            // Between two points the segment may come nearer by half of a step.
            let step = f64::from(a.distance(b)) / f64::from(STEPS);
            for (region, least) in [(cube, farthest), (ball, nearest)] {
                if (least - f64::from(size)).abs() > step {
                    prop_assert_eq!(region.meets(a, b), least < f64::from(size), "{:?}", region);
                }
            }
        }
    }

    fn point() -> impl Strategy<Value = Vec3> {
        let number =
            prop_oneof![(-800i32..800).prop_map(|n| n as f32 / 100.0), (-8i32..8).prop_map(|n| n as f32)];
        [number.clone(), number.clone(), number].prop_map(Vec3::from)
    }
}
