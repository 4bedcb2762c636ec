//! The roles of objects in a view from above, and the legend: the colours in a picture and their
//! meanings, and no others.

use casca_scenes::world::{Object, Shape};
use casca_stage::report::{Entry, Sample};
use casca_tools::pictures::palette::{self, rgba};
use glam::Vec3;

use crate::scene::overlays::{FRUSTUM, HIDDEN, LOST, VOLUME};
use crate::scene::renderer::Marks;

/// The meanings of the colours of marks.
const MARKS: [([u8; 4], Sample, &str); 4] = [
    (LOST, Sample::Line, "visible, but not drawn: lost"),
    (HIDDEN, Sample::Line, "hidden object, culled"),
    (VOLUME, Sample::Line, "volume that a hidden moving object stays in"),
    (FRUSTUM, Sample::Framed([250, 244, 180]), "the camera's frustum"),
];

/// Entries for the colours of marks.
pub fn of_marks(marks: &Marks) -> Vec<Entry> {
    let colours = || marks.lines.iter().map(|line| line.colour).chain(marks.fills.iter().map(|c| c.colour));
    let shown = MARKS.into_iter().filter(|mark| colours().any(|colour| colour == mark.0));
    shown.map(|(colour, sample, text)| Entry { colour, sample, text: text.to_owned() }).collect()
}

/// Adds the entries whose colours are not in a legend yet.
pub fn join(legend: &mut Vec<Entry>, more: Vec<Entry>) {
    for entry in more {
        if legend.iter().all(|known| known.colour != entry.colour) {
            legend.push(entry);
        }
    }
}

/// Entries for the objects in a view from above, with the number in each of [`COUNTED`].
pub fn of_roles(counts: [usize; COUNTED.len()]) -> Vec<Entry> {
    let entries = COUNTED.into_iter().zip(counts).filter(|(_, count)| *count > 0);
    let entry = |((_, colour, meaning), count)| {
        let text = format!("{meaning}: {count}");
        Entry { colour, sample: Sample::Area, text }
    };
    entries.map(entry).collect()
}

/// Whether an object is drawn, or the reason why it is not; grounds and ceilings are set apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Found visible and drawn.
    Drawn,
    /// Visible, but not drawn. Only methods that promise nothing lose objects.
    Lost,
    /// In the frustum, found hidden and left out.
    Culled,
    /// Outside the frustum.
    Outside,
    /// The ground under everything, which has a quiet colour.
    Ground,
    /// A ceiling, taken off so that one sees in.
    Ceiling,
}

/// The roles that culling gives, with their colours and names in legends.
pub const COUNTED: [(Role, [u8; 4], &str); 4] = [
    (Role::Drawn, rgba(palette::DRAWN, 255), "visible, drawn"),
    (Role::Lost, LOST, "visible, lost"),
    (Role::Culled, rgba(palette::CULLED, 255), "hidden, culled"),
    (Role::Outside, rgba(palette::OUTSIDE, 255), "outside the frustum"),
];

impl Role {
    /// The colour of objects in this role.
    pub fn colour(self) -> [u8; 4] {
        COUNTED.iter().find(|known| known.0 == self).map_or(rgba(palette::GROUND, 255), |known| known.1)
    }

    /// Wide flat boxes are grounds or ceilings, the others keep the role that culling gave them.
    pub fn of(object: &Object, given: Self, eye: Vec3, extent: Vec3) -> Self {
        match object.shape {
            Shape::Box { min, max } if (max - min).cmpgt(0.5 * extent).bitmask() & 0b101 == 0b101 => {
                if max.y <= eye.y {
                    Self::Ground
                } else if min.y >= eye.y {
                    Self::Ceiling
                } else {
                    given
                }
            }
            _ => given,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(entries: &[Entry]) -> Vec<&str> {
        entries.iter().map(|entry| entry.text.as_str()).collect()
    }

    #[test]
    fn each_mark_has_a_colour_of_its_own() {
        for (i, mark) in MARKS.iter().enumerate() {
            assert!(MARKS[..i].iter().all(|other| other.0 != mark.0), "{}", mark.2);
        }
    }

    #[test]
    fn only_roles_that_some_object_has_are_named() {
        let mut legend = of_roles([26, 3, 0, 0]);
        assert_eq!(texts(&legend), ["visible, drawn: 26", "visible, lost: 3"]);
        let mark = |colour, text: &str| Entry { colour, sample: Sample::Line, text: text.to_owned() };
        join(&mut legend, vec![mark(LOST, "lost"), mark(HIDDEN, "hidden")]);
        assert_eq!(
            texts(&legend),
            ["visible, drawn: 26", "visible, lost: 3", "hidden"],
            "one entry for a colour"
        );
    }

    #[test]
    fn wide_flat_boxes_are_ground_below_the_eye_and_ceilings_above() {
        let role = |min: Vec3, max: Vec3| {
            let shape = Shape::Box { min, max };
            let (name, motion) = (String::new(), casca_scenes::world::Motion::Static);
            let object = Object { name, shape, motion, occludes: true, tested: true };
            Role::of(&object, Role::Drawn, Vec3::new(5.0, 2.0, 5.0), Vec3::new(10.0, 4.0, 10.0))
        };
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 0.2, 10.0)), Role::Ground);
        assert_eq!(role(Vec3::Y * 3.0, Vec3::new(10.0, 3.2, 10.0)), Role::Ceiling);
        assert_eq!(role(Vec3::ZERO, Vec3::new(10.0, 3.0, 0.2)), Role::Drawn, "a wall");
        assert_eq!(role(Vec3::ZERO, Vec3::splat(10.0)), Role::Drawn, "around the eye");
    }
}
