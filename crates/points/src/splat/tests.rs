//! The operator beside squares that are drawn one by one, and beside analytic truth.

use super::*;
use crate::samples::cases;
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn a_depth_image_has_the_nearest_square_of_each_pixel(
        size in (1..40_u32, 1..40_u32),
        squares in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64, 0..13_u32, 0..10_000_i32, 1..50_u8), 0..30),
    ) {
        let drawn = Squares::new(size);
        let mut image = vec![f32::INFINITY; (size.0 * size.1) as usize];
        for (x, y, magnitude, half, depth) in squares {
            let (x, y) = ((x * f64::from(size.0 * 256)) as i32, (y * f64::from(size.1 * 256)) as i32);
            let half = half >> magnitude;
            drawn.draw(&[x], &[y], &[half], &[f32::from(depth)]);
            let covers = |pixel: u32, at: i32| {
                let (low, high) = (pixel as i32 * 256, pixel as i32 * 256 + 255);
                low <= at + half && high >= at - half
            };
            for (i, pixel) in (0..).zip(&mut image) {
                if covers(i % size.0, x) && covers(i / size.0, y) {
                    *pixel = pixel.min(f32::from(depth));
                }
            }
        }
        prop_assert_eq!(drawn.into_image().depths, image);
    }
}
