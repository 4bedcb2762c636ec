//! The colours and marks of all pictures.
//!
//! Methods have the colours of Okabe and Ito, other series those of Paul Tol's muted scheme: people
//! with any kind of colour blindness can tell both apart. Every series has a mark of its own
//! besides, for print in grey.

pub use plotters::style::RGBColor;

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A triangle on its base.
    Triangle,
    /// A triangle on its tip.
    Wedge,
    /// A square on its tip.
    Diamond,
    /// A star of five points.
    Star,
    /// A hexagon.
    Hexagon,
    /// A tall, narrow bar.
    Bar,
}

/// How a series looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Its colour.
    pub color: RGBColor,
    /// The mark at its points.
    pub marker: Marker,
    /// Whether its line is dashed.
    pub dashed: bool,
}

impl Style {
    const fn new(color: RGBColor, marker: Marker) -> Self {
        Self { color, marker, dashed: false }
    }

    /// The same with a dashed line: a second variant of one method.
    pub const fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
}

/// `Method::Point`.
pub const POINT: Style = Style::new(RGBColor(0, 114, 178), Marker::Disc);
/// `Method::Cell`.
pub const CELL: Style = Style::new(RGBColor(230, 159, 0), Marker::Square);
/// `Method::Frustum`: nothing but the view is culled to.
pub const FRUSTUM: Style = Style::new(RGBColor(120, 120, 120), Marker::Bar);
/// The hierarchical depth buffer.
pub const HZB: Style = Style::new(RGBColor(204, 121, 167), Marker::Triangle);
/// The ray-cast depth buffer.
pub const RAYS: Style = Style::new(RGBColor(213, 94, 0), Marker::Diamond);
/// Exact visibility.
pub const EXACT: Style = Style::new(RGBColor(0, 0, 0), Marker::Hexagon);
/// Series that are no methods: scenes, data structures, stages of a frame.
pub const OTHERS: [Style; 9] = [
    Style::new(RGBColor(136, 34, 85), Marker::Disc),
    Style::new(RGBColor(68, 170, 153), Marker::Square),
    Style::new(RGBColor(51, 34, 136), Marker::Triangle),
    Style::new(RGBColor(153, 153, 51), Marker::Diamond),
    Style::new(RGBColor(204, 102, 119), Marker::Wedge),
    Style::new(RGBColor(17, 119, 51), Marker::Hexagon),
    Style::new(RGBColor(136, 204, 238), Marker::Star),
    Style::new(RGBColor(221, 204, 119), Marker::Bar),
    Style::new(RGBColor(90, 90, 90), Marker::Disc),
];

/// The style of a method, by the word that its name starts with: "point", "cell", "frustum", "hzb"
/// or "rays".
pub fn method(name: &str) -> Option<Style> {
    match name.split(|c: char| !c.is_alphanumeric()).next()? {
        "point" => Some(POINT),
        "cell" => Some(CELL),
        "frustum" => Some(FRUSTUM),
        "hzb" => Some(HZB),
        "rays" => Some(RAYS),
        _ => None,
    }
}

/// The style of the series with this number among those that are no methods.
pub fn other(number: usize) -> Style {
    OTHERS[number % OTHERS.len()]
}

/// Hidden, and left out by the method.
pub const HIDDEN: RGBColor = RGBColor(0, 158, 115);
/// Visible, but lost by the method.
pub const LOST: RGBColor = RGBColor(213, 94, 0);
/// Hidden, but drawn.
pub const SPARE: RGBColor = RGBColor(240, 228, 66);
/// Visible, and found by the method.
pub const VISIBLE: RGBColor = RGBColor(130, 140, 160);
/// An object that is drawn, in a view from above.
pub const DRAWN: RGBColor = RGBColor(230, 159, 0);
/// An object in the frustum that is culled, in a view from above.
pub const CULLED: RGBColor = RGBColor(86, 140, 200);
/// An object outside the frustum, in a view from above.
pub const OUTSIDE: RGBColor = RGBColor(214, 214, 216);
/// The inside of the frustum, in a view from above.
pub const LIT: RGBColor = RGBColor(240, 228, 66);
/// The ground, in a view from above.
pub const GROUND: RGBColor = RGBColor(246, 245, 242);
/// A temporal bounding volume.
pub const VOLUME: RGBColor = RGBColor(175, 60, 130);
/// The camera.
pub const CAMERA: RGBColor = RGBColor(213, 94, 0);
/// Titles and labels.
pub const TEXT: RGBColor = RGBColor(30, 30, 34);
/// Words that matter less.
pub const QUIET: RGBColor = RGBColor(95, 95, 102);

/// A colour of the palette with an opacity, for pictures that a graphics device draws.
pub const fn rgba(color: RGBColor, opacity: u8) -> [u8; 4] {
    [color.0, color.1, color.2, opacity]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_known_by_their_first_word_and_differ_in_colour_and_mark() {
        let names = ["point, 50x30x50", "cell (mask 64)", "frustum", "hzb (640x360)", "rays"];
        let styles: Vec<Style> = names.iter().filter_map(|n| method(n)).collect();
        assert_eq!(styles.len(), names.len());
        for (i, a) in styles.iter().enumerate() {
            assert!(styles[..i].iter().all(|b| a.color != b.color && a.marker != b.marker));
        }
        assert_eq!(method("spheres"), None);
    }
}
