//! The legend of the colours of lines.

use casca_lines::sets::colour::{Legend, viridis};
use casca_stage::report::{Entry, Sample};

/// Numbers of a scale, less one.
const TICKS: u8 = 4;

/// The colours and their meanings, one by one.
pub fn entries(legend: &Legend) -> Vec<Entry> {
    let entry =
        |[r, g, b]: [u8; 3], text: String| Entry { colour: [r, g, b, 255], sample: Sample::Area, text };
    match legend {
        Legend::Own => Vec::new(),
        Legend::Direction => [([255, 0, 0], "along x"), ([0, 255, 0], "along y"), ([0, 0, 255], "along z")]
            .map(|(colour, text)| entry(colour, text.to_owned()))
            .to_vec(),
        Legend::Scalar { name, range } => (0..=TICKS)
            .map(|tick| f32::from(tick) / f32::from(TICKS))
            .map(|t| entry(viridis(t), format!("{name} {}", number(value(*range, t)))))
            .collect(),
    }
}

/// The value at a share of a range; halves do not overflow.
fn value([low, high]: [f32; 2], share: f32) -> f64 {
    f64::from(low) + (f64::from(high) - f64::from(low)) * f64::from(share)
}

/// A number in at most four digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => {
            let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_legends_name_their_colours() {
        let said = [0.0, 0.25, -1234.56, 99999.0, 1e-9, f64::from(f32::MAX)].map(number);
        assert_eq!(said, ["0", "0.25", "-1235", "99999", "1.00e-9", "3.40e38"]);
        let scalar = Legend::Scalar { name: "fa".to_owned(), range: [-f32::MAX, f32::MAX] };
        let texts: Vec<String> = entries(&scalar).into_iter().map(|e| e.text).collect();
        assert_eq!((&*texts[0], &*texts[2], texts.len()), ("fa -3.40e38", "fa 0", 5));
        assert_eq!(entries(&Legend::Direction)[1].colour, [0, 255, 0, 255]);
    }
}
