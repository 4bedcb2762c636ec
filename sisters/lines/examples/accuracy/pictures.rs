//! A kind of set by each method and by rays, as pictures.

use std::error::Error;
use std::path::Path;

use casca_lines::glam::UVec2;
use casca_tools::image::write_png;

use crate::kinds::Kind;
use crate::methods::METHODS;
use crate::{Case, SIZES};

/// Pixels around the lines.
const BORDER: u32 = 4;
/// The square root of the rays of a pixel.
const RAYS: u32 = 10;

/// Draws pale lines that are darkened by the occlusion: a picture for each method, and one for
/// rays.
pub fn draw(kind: &Kind, folder: &Path) -> Result<(), Box<dyn Error>> {
    let case = Case::new(kind, SIZES[0], usize::MAX)?;
    let name = kind.name.replace(' ', "_");
    // What shows lines, with a border, at twice the size.
    let places = case.receivers.iter().map(|(place, _)| UVec2::from_array(*place));
    let low = places.clone().fold(UVec2::MAX, UVec2::min).saturating_sub(UVec2::splat(BORDER));
    let high = places.fold(UVec2::ZERO, UVec2::max).saturating_add(UVec2::splat(BORDER));
    let size = (high - low + 1) * 2;
    let save = |method: &str, values: &[f64]| {
        let path = folder.join(format!("lines_{name}_{}.png", method.replace([' ', '(', ')'], "")));
        let mut pixels = vec![255; (size.element_product() * 4) as usize];
        for ((place, fragment), value) in case.receivers.iter().zip(values) {
            let shade = f64::from(fragment.line.wrapping_mul(0x9e37_79b1) >> 24) / 255.0;
            let colour =
                [242.0, 184.0 + 40.0 * shade, 107.0 + 90.0 * shade].map(|c| (c * (1.0 - value)) as u8);
            let corner = (UVec2::from_array(*place) - low) * 2;
            for i in 0..4 {
                let at = (((corner.y + i / 2) * size.x + corner.x + i % 2) * 4) as usize;
                pixels[at..at + 3].copy_from_slice(&colour);
            }
        }
        write_png(&path, (size.x, size.y), &pixels)
    };
    for method in METHODS {
        save(method.name, &method.prepared(&case, &case.view).values(&case.receivers))?;
    }
    save("truth", &case.truth(&case.view, &case.receivers, RAYS))?;
    Ok(())
}
