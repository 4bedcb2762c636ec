//! The legend: the colours in a picture and their meanings, and no others.

use casca_stage::report::{Entry, Sample};

use crate::scene::overlays::{FRUSTUM, HIDDEN, LOST, VOLUME};
use crate::scene::renderer::Marks;
use crate::scene::role::COUNTED;

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
}
