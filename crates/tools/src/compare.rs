//! Two pictures, compared pixel by pixel.

/// A picture and its item buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shot {
    /// Red, green, blue, opacity, row by row.
    pub pixels: Vec<u8>,
    /// The number of the object in each pixel.
    pub items: Vec<u32>,
}

impl Shot {
    /// For each pixel, whether its colour or its object is another in `other`, a shot of the same
    /// size.
    pub fn differing(&self, other: &Self) -> Vec<bool> {
        let colours = self.pixels.chunks(4).zip(other.pixels.chunks(4));
        let items = self.items.iter().zip(&other.items);
        colours.zip(items).map(|((a, b), (i, j))| a != b || i != j).collect()
    }
}

/// The colour of pixels that differ.
const MARK: [u8; 4] = [220, 0, 30, 255];

/// A pale picture with the pixels that differ in red, and some around each.
pub fn marked(picture: &[u8], differing: &[bool], (width, height): (u32, u32)) -> Vec<u8> {
    let mut pale: Vec<u8> = picture.iter().map(|v| 140 + v / 3).collect();
    let (width, height) = (width as usize, height as usize);
    for (p, _) in differing.iter().enumerate().filter(|(_, d)| **d) {
        let (x, y) = (p % width, p / width);
        for near_y in y.saturating_sub(1)..(y + 2).min(height) {
            for near_x in x.saturating_sub(1)..(x + 2).min(width) {
                pale[(near_y * width + near_x) * 4..][..4].copy_from_slice(&MARK);
            }
        }
    }
    pale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_with_another_colour_or_object_differs() {
        let shot = |colour: u8, item: u32| {
            let (mut pixels, mut items) = (vec![9; 4 * 12], vec![7; 12]);
            (pixels[4 * 5], items[11]) = (colour, item);
            Shot { pixels, items }
        };
        let where_not_equal = |a: &Shot, b: &Shot| -> Vec<usize> {
            let differing = a.differing(b);
            (0..12).filter(|&p| differing[p]).collect()
        };
        assert_eq!(where_not_equal(&shot(9, 7), &shot(9, 7)), []);
        assert_eq!(where_not_equal(&shot(9, 7), &shot(8, 7)), [5]);
        assert_eq!(where_not_equal(&shot(9, 7), &shot(8, 6)), [5, 11]);
    }

    #[test]
    fn marks_stay_in_the_picture() {
        let differing: Vec<bool> = (0..12).map(|p| p == 0 || p == 11).collect();
        let picture = marked(&[0; 4 * 12], &differing, (4, 3));
        let red: Vec<usize> = (0..12).filter(|p| picture[4 * p] == 220).collect();
        assert_eq!(red, [0, 1, 4, 5, 6, 7, 10, 11]);
    }
}
