//! The legend: the colours in a picture and their meanings, and no others.

use casca_scenes::world::Camera;
use casca_stage::report::{Entry, Sample};
use glam::Vec3;

use crate::scene::camera_fit::in_view;
use crate::scene::overlays::{FRUSTUM, HIDDEN, HIDDEN_CELL, LIT, LOST, OPAQUE_CELL, VISIBLE_CELL, VOLUME};
use crate::scene::renderer::Marks;
use crate::scene::role::Role;

/// The meanings of the colours of marks.
const MARKS: [([u8; 4], Sample, &str); 7] = [
    (LOST, Sample::Line, "visible, but not drawn: lost"),
    (HIDDEN, Sample::Line, "hidden object, culled"),
    (VOLUME, Sample::Line, "volume that a hidden moving object stays in"),
    (OPAQUE_CELL, Sample::Area, "opaque cell, which hides"),
    (HIDDEN_CELL, Sample::Area, "hidden cell"),
    (VISIBLE_CELL, Sample::Area, "cell that may be seen"),
    (FRUSTUM, Sample::Framed([250, 244, 180]), "the camera's frustum"),
];

/// Entries for the marks in the picture of a camera.
pub fn of_marks(marks: &Marks, watcher: &Camera) -> Vec<Entry> {
    let lines = marks.lines.iter().map(|line| (line.colour, vec![line.start, line.end]));
    let fills = marks.fills.chunks(3).map(|fill| (fill[0].colour, fill.iter().map(|c| c.position).collect()));
    let mut shown = [false; MARKS.len()];
    for (colour, corners) in lines.chain(fills) {
        let colour = if colour == LIT { FRUSTUM } else { colour };
        let Some(at) = MARKS.iter().position(|mark| mark.0 == colour).filter(|&at| !shown[at]) else {
            continue;
        };
        let corners: Vec<Vec3> = corners.into_iter().map(Vec3::from).collect();
        shown[at] = in_view(watcher, &corners);
    }
    let shown = MARKS.into_iter().zip(shown).filter(|(_, shown)| *shown);
    shown.map(|((colour, sample, text), _)| Entry { colour, sample, text: text.to_owned() }).collect()
}

/// Adds the entries whose colours are not in a legend yet.
pub fn join(legend: &mut Vec<Entry>, more: Vec<Entry>) {
    for entry in more {
        if legend.iter().all(|known| known.colour != entry.colour) {
            legend.push(entry);
        }
    }
}

/// Entries for the objects in a view from above, with their numbers.
pub fn of_roles(counts: &[(Role, usize)]) -> Vec<Entry> {
    let entries = counts.iter().filter(|(_, count)| *count > 0);
    let entries = entries.filter_map(|&(role, count)| Some((role, format!("{}: {count}", role.meaning()?))));
    entries.map(|(role, text)| Entry { colour: role.colour(), sample: Sample::Area, text }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::renderer::Corner;

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
    fn only_marks_in_the_picture_are_named() {
        let watcher = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 1.0, 0.1, 100.0);
        let mut marks = Marks::default();
        assert!(of_marks(&marks, &watcher).is_empty());
        let ahead = Vec3::NEG_Z * 5.0;
        marks.line(ahead, ahead + Vec3::Y, 1.0, FRUSTUM);
        marks.line(-ahead, Vec3::Y - ahead, 1.0, LOST);
        for position in [ahead, ahead + Vec3::X, ahead + Vec3::Y] {
            marks.fills.push(Corner { position: position.to_array(), colour: HIDDEN_CELL });
        }
        assert_eq!(texts(&of_marks(&marks, &watcher)), ["hidden cell", "the camera's frustum"]);
    }

    #[test]
    fn only_roles_that_some_object_has_are_named() {
        let counts = [(Role::Drawn, 26), (Role::Culled, 0), (Role::Lost, 3), (Role::Ground, 1)];
        let mut legend = of_roles(&counts);
        assert_eq!(texts(&legend), ["visible, drawn: 26", "visible, lost: 3"]);
        let mark = |colour, text: &str| Entry { colour, sample: Sample::Line, text: text.to_owned() };
        join(&mut legend, vec![mark(LOST, "lost"), mark(HIDDEN, "hidden")]);
        assert_eq!(
            texts(&legend),
            ["visible, drawn: 26", "visible, lost: 3", "hidden"],
            "one entry for a colour"
        );
    }
}
