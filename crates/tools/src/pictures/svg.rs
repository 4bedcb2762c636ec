//! Charts as SVG: the head with title and legend, marks, and the file.

use std::path::Path;

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::PictureError;
use super::palette::{Marker, QUIET, Style, TEXT};

/// Fonts of the reader's machine; the reader's program sets the text.
const FONT: &str = "Inter, Helvetica, Arial, sans-serif";

/// The page, or a part of it.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Nothing, or why nothing is drawn.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Pixels from one line of a legend to the next.
const LEGEND_LINE: i32 = 26;

/// Draws an SVG of this size on white ground.
pub fn save(
    path: &Path,
    size: (u32, u32),
    draw: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<(), PictureError> {
    let fail = PictureError::at(path);
    if path.extension().is_none_or(|e| e != "svg") {
        return Err(fail("charts are written as .svg".to_owned()));
    }
    let mut document = String::new();
    {
        let root = SVGBackend::with_string(&mut document, size).into_drawing_area();
        let drawn = root.fill(&WHITE).map_err(Into::into).and_then(|()| draw(&root));
        drawn.and_then(|()| Ok(root.present()?)).map_err(|e| fail(e.to_string()))?;
    }
    // Without this, scaled pictures show seams between touching rectangles.
    let document = document.replace("<rect ", "<rect shape-rendering=\"crispEdges\" ");
    std::fs::write(path, document).map_err(|e| fail(e.to_string()))
}

/// The size of text on the page, which plotters divides by 1.24.
pub fn font(size: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::Name(FONT), size * 1.24, FontStyle::Normal)
}

/// The greatest width that text of this size has in the usual fonts, in pixels.
fn width_of(text: &str, size: f64) -> i32 {
    (text.chars().count() as f64 * size * 0.58).ceil() as i32
}

/// Text whose middle is at this height.
pub fn text(area: &Area<'_>, at: (i32, i32), size: f64, color: RGBColor, anchor: HPos, text: &str) -> Drawn {
    let style = font(size).color(&color).pos(Pos::new(anchor, VPos::Center));
    Ok(area.draw_text(text, &style, at)?)
}

/// Words put into lines of at most this many pixels.
fn wrap(text: &str, size: f64, room: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_of(line, size) + width_of(word, size) < room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// What a legend shows before a label.
#[derive(Debug, Clone, Copy)]
pub enum Sample {
    /// A line with its mark.
    Line(Style),
    /// A mark alone.
    Mark(Style),
    /// The outline of a mark.
    Open(Style),
    /// A ring around a mark.
    Ring,
}

/// The head of a chart: its finding, its quantities, and the legend.
pub struct Head {
    title: Vec<String>,
    subtitle: Vec<String>,
    /// Samples and labels with their places.
    keys: Vec<(Sample, String, i32, i32)>,
    /// Pixels from the top to where the drawing may start.
    pub height: i32,
}

const TITLE: f64 = 20.0;
const SUBTITLE: f64 = 15.0;
const LABEL: f64 = 14.0;
const LEFT: i32 = 20;

impl Head {
    /// A head for a picture this many pixels wide.
    pub fn new(width: u32, title: &str, subtitle: &str, keys: Vec<(Sample, String)>) -> Self {
        let room = width as i32 - 2 * LEFT;
        // Bold letters are wider.
        let title = wrap(title, TITLE * 1.08, room);
        let subtitle = wrap(subtitle, SUBTITLE, room);
        let mut y = 16 + 27 * title.len() as i32 + 21 * subtitle.len() as i32 + 18;
        let mut x = LEFT;
        let mut placed = Vec::new();
        for (sample, label) in keys {
            let wide = 40 + width_of(&label, LABEL) + 22;
            if x > LEFT && x + wide > width as i32 {
                (x, y) = (LEFT, y + LEGEND_LINE);
            }
            placed.push((sample, label, x, y));
            x += wide;
        }
        let height = if placed.is_empty() { y } else { y + LEGEND_LINE };
        Self { title, subtitle, keys: placed, height }
    }

    /// Draws it at the top of a page.
    ///
    /// # Errors
    /// Those of the drawing library.
    pub fn draw(&self, area: &Area<'_>) -> Drawn {
        let mut y = 28;
        for line in &self.title {
            let style = FontDesc::new(FontFamily::Name(FONT), TITLE * 1.24, FontStyle::Bold).color(&TEXT);
            area.draw_text(line, &style.pos(Pos::new(HPos::Left, VPos::Center)), (LEFT, y))?;
            y += 27;
        }
        for line in &self.subtitle {
            text(area, (LEFT, y), SUBTITLE, QUIET, HPos::Left, line)?;
            y += 21;
        }
        for (sample, label, x, y) in &self.keys {
            let (middle, ends) = ((x + 16, *y), [(*x, *y), (x + 32, *y)]);
            match sample {
                Sample::Line(style) => {
                    path(area, &ends, style)?;
                    mark(area, middle, 5, style, true)?;
                }
                Sample::Mark(style) => mark(area, middle, 6, style, true)?,
                Sample::Open(style) => mark(area, middle, 6, style, false)?,
                Sample::Ring => area.draw(&Circle::new(middle, 9, TEXT.stroke_width(2)))?,
            }
            text(area, (x + 40, *y), LABEL, TEXT, HPos::Left, label)?;
        }
        Ok(())
    }
}

/// A line through points of the page.
pub fn path(area: &Area<'_>, points: &[(i32, i32)], style: &Style) -> Drawn {
    if points.len() < 2 {
        return Ok(());
    }
    let stroke = style.color.stroke_width(2);
    match style.dashed {
        true => area.draw(&DashedPathElement::new(points.to_vec(), 8, 5, stroke))?,
        false => area.draw(&PathElement::new(points.to_vec(), stroke))?,
    }
    Ok(())
}

/// Corners of a regular polygon, or with two reaches, of a star.
fn corners(at: (i32, i32), count: usize, reach: [f64; 2], turn: f64) -> Vec<(i32, i32)> {
    let corner = |i: usize| {
        let angle = turn + std::f64::consts::TAU * i as f64 / count as f64;
        let r = reach[i % 2];
        (at.0 + (angle.sin() * r).round() as i32, at.1 - (angle.cos() * r).round() as i32)
    };
    (0..count).map(corner).collect()
}

/// A mark on the page, `r` pixels from its middle to its border: filled, or only its outline on
/// white.
pub fn mark(area: &Area<'_>, at: (i32, i32), r: i32, style: &Style, filled: bool) -> Drawn {
    use std::f64::consts::PI;
    let wide = f64::from(r);
    let outline = match style.marker {
        Marker::Disc => {
            let inner = if filled { style.color } else { WHITE };
            area.draw(&Circle::new(at, r, inner.filled()))?;
            return Ok(area.draw(&Circle::new(at, r, style.color.stroke_width(2)))?);
        }
        Marker::Square => corners(at, 4, [wide * 1.3; 2], PI / 4.0),
        Marker::Triangle => corners(at, 3, [wide * 1.4; 2], 0.0),
        Marker::Wedge => corners(at, 3, [wide * 1.4; 2], PI),
        Marker::Diamond => corners(at, 4, [wide * 1.4; 2], 0.0),
        Marker::Star => corners(at, 10, [wide * 1.7, wide * 0.75], 0.0),
        Marker::Hexagon => corners(at, 6, [wide * 1.2; 2], 0.0),
        Marker::Bar => vec![
            (at.0 - r / 3, at.1 - r),
            (at.0 + r / 3, at.1 - r),
            (at.0 + r / 3, at.1 + r),
            (at.0 - r / 3, at.1 + r),
        ],
    };
    let inner = if filled { style.color } else { WHITE };
    area.draw(&Polygon::new(outline.clone(), inner.filled()))?;
    let closed = outline.iter().chain(&outline[..2]).copied();
    Ok(area.draw(&PathElement::new(closed.collect::<Vec<_>>(), style.color.stroke_width(2)))?)
}

/// A number in as few digits as tell it.
pub fn short(v: f64) -> String {
    let trimmed = |text: String| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    };
    match v.abs() {
        a if a >= 1e6 || a > 0.0 && a < 9e-4 => format!("{v:.0e}"),
        a if a >= 1e3 => {
            let whole = format!("{:.0}", a);
            let (head, tail) = whole.split_at(whole.len() - 3);
            format!("{}{head},{tail}", if v < 0.0 { "-" } else { "" })
        }
        a if a >= 100.0 => format!("{v:.0}"),
        a if a >= 1.0 => trimmed(format!("{v:.2}")),
        _ => trimmed(format!("{v:.3}")),
    }
}

/// Values to label on a logarithmic axis: four at least, if the range has room for as many round
/// ones.
pub fn log_ticks(lo: f64, hi: f64) -> Vec<f64> {
    const STEPS: [&[f64]; 4] = [
        &[1.0],
        &[1.0, 3.0],
        &[1.0, 2.0, 5.0],
        &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
    ];
    let decades = lo.log10().floor() as i32..=hi.log10().ceil() as i32;
    let mut ticks = Vec::new();
    for mantissas in STEPS {
        let all = decades.clone().flat_map(|d| mantissas.iter().map(move |m| m * 10f64.powi(d)));
        ticks = all.filter(|v| (lo * 0.999..=hi * 1.001).contains(v)).collect();
        if ticks.len() >= 4 {
            return ticks;
        }
    }
    for step in [0.1, 0.05, 0.02, 0.01] {
        let from = (lo / step).ceil() as i64;
        let fine: Vec<f64> =
            (from..).map(|i| i as f64 * step).take_while(|v| *v <= hi * 1.0001).take(12).collect();
        if fine.len() >= 4 {
            return fine;
        }
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_ticks_round() {
        let said = [0.0, 0.05, 1.0, 1.25, 20.0, 1000.0, 10_000.0, 1e-5].map(short);
        assert_eq!(said, ["0", "0.05", "1", "1.25", "20", "1,000", "10,000", "1e-5"]);
        let ticks = |lo, hi| log_ticks(lo, hi).into_iter().map(short).collect::<Vec<_>>().join(" ");
        assert_eq!(ticks(0.01, 100.0), "0.01 0.1 1 10 100");
        assert_eq!(ticks(0.2, 30.0), "0.3 1 3 10 30");
        assert_eq!(ticks(0.8, 7.5), "0.8 0.9 1 1.2 1.5 2 2.5 3 4 5 6 7");
        assert!(log_ticks(0.96, 1.14).len() >= 3);
        assert!(log_ticks(1.0, 1.0).len() <= 1);
    }

    #[test]
    fn long_titles_and_legends_take_more_lines() {
        let keys = |n: usize| (0..n).map(|i| (Sample::Ring, format!("series number {i}"))).collect();
        let low = Head::new(600, "A title", "", keys(2));
        let high = Head::new(600, &"words ".repeat(40), "", keys(9));
        assert!(high.height > low.height + 100);
        assert!(high.keys.iter().all(|k| k.2 + 40 + width_of(&k.1, LABEL) <= 600));
    }

    #[test]
    fn only_svg_is_written() {
        let path = std::env::temp_dir().join("casca-chart.png");
        let said = save(&path, (10, 10), |_| Ok(())).unwrap_err().to_string();
        assert!(said.contains(".svg"), "{said}");
    }
}
