use super::*;
use crate::occlusion::pixels::PixelRect;
use crate::random::Random;
use crate::simd::vectorized;

type Point = (f64, f64);

fn edges(ring: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// A width of edges far below a pixel, and far above the rounding of coordinates here.
const THIN: f64 = 1e-3;

/// A number in single precision, as edges have them.
fn single(v: f64) -> f64 {
    f64::from(v as f32)
}

fn draw(raster: &mut Raster, all: impl IntoIterator<Item = (Point, Point, bool)>, wide: f64) {
    let unsure = THIN.min(wide / 2.0);
    let all: Vec<_> = all.into_iter().collect();
    for some in all.chunks(LANES) {
        let mut group =
            Edges { wide: [wide as f32; LANES], unsure: [unsure as f32; LANES], ..Edges::default() };
        for (i, &(from, to, seam)) in some.iter().enumerate() {
            (group.x0[i], group.y0[i]) = (from.0 as f32, from.1 as f32);
            (group.x1[i], group.y1[i]) = (to.0 as f32, to.1 as f32);
            group.plain |= 1 << i;
            group.seams |= u8::from(seam) << i;
        }
        vectorized!(simd => raster.edges(simd, &group.vectors(simd, 1.0), false));
    }
}

fn unshared(ring: &[Point]) -> impl Iterator<Item = (Point, Point, bool)> {
    edges(ring).map(|(from, to)| (from, to, false))
}

/// The sum over all edges that pass the line to the left of a point.
fn winding(ring: &[Point], p: Point) -> i32 {
    edges(ring)
        .map(|(a, b)| {
            let (lo, hi, by) = if a.1 <= b.1 { (a, b, 1) } else { (b, a, -1) };
            let passes = lo.1 < p.1 && p.1 <= hi.1;
            let x = lo.0 + (p.1 - lo.1) * (hi.0 - lo.0) / (hi.1 - lo.1);
            if passes && x < p.0 { by } else { 0 }
        })
        .sum()
}

/// Whether a segment comes closer to a square than `wide` along both axes.
fn touches((a, b): (Point, Point), x: f64, y: f64, wide: f64) -> bool {
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for (from, to, lo) in [(a.0, b.0, x), (a.1, b.1, y)] {
        let (lo, hi) = (lo - wide, lo + 1.0 + wide);
        if from == to {
            if from < lo || from > hi {
                return false;
            }
            continue;
        }
        let (s, t) = ((lo - from) / (to - from), (hi - from) / (to - from));
        (t0, t1) = (t0.max(s.min(t)), t1.min(s.max(t)));
    }
    t0 <= t1
}

/// The block of a pixel, and its row and column there.
fn place(area: &Area, x: i64, y: i64) -> (usize, usize, usize) {
    let (x, y) = (x - area.x, y - area.y);
    (((y / 8) * area.nx + x / 32) as usize, y as usize % 8, x as usize % 32)
}

#[test]
fn pixels_are_marked_as_the_outline_says() {
    let mut random = Random::new(1);
    let mut raster = Raster::default();
    let (mut covered, mut open) = (0, 0);
    for round in 0..700 {
        // Outlines reach beyond the area on all sides; some are small, some flat.
        let height = if round % 5 == 0 { 0.01 } else { 30.0 };
        // Edges of small ones mostly stay in one block.
        let (middle, size) = match round % 7 {
            0..=2 => ((25.0, 30.0), (45.0, height)),
            _ => ((random.within(5.0, 60.0), random.within(15.0, 50.0)), (6.0, 5.0)),
        };
        let ring: Vec<Point> = (0..3 + round % 5)
            .map(|_| (middle.0 + random.within(-size.0, size.0), middle.1 + random.within(-size.1, size.1)))
            .map(|(x, y)| (single(x), single(y)))
            .collect();
        // One raster for areas of all kinds: nothing may be left in it.
        let (x, y) = (round as i64 % 3 * 20, round as i64 % 4 * 9);
        let area =
            Area::around(&PixelRect { x: (x, x + 5 + round as i64 % 37), y: (y, y + 9 + round as i64 % 31) });
        let wide = [THIN, 0.3, 2.5][round % 3];
        raster.begin(area, (0, 0));
        draw(&mut raster, unshared(&ring), wide);
        for y in area.y..area.y + i64::from(area.height()) {
            for x in area.x..area.x + i64::from(area.width()) {
                let (block, row, column) = place(&area, x, y);
                let marks = raster.whole(block);
                let (left, low) = (x as f64, y as f64);
                let near = edges(&ring).any(|e| touches(e, left, low, wide));
                let (marked, own) = marks.pixel(PixelMarks::OPEN, row, column);
                assert!(marked || !near, "round {round}: {x} {y} is touched and not marked");
                if marked {
                    open += 1;
                    continue;
                }
                let number = winding(&ring, (left + 0.5, low + 0.5));
                assert_eq!(own, number & 3, "round {round}: {x} {y}");
                assert_eq!(marks.covered()[row] >> column & 1 == 1, number != 0);
                covered += u32::from(number != 0);
            }
        }
    }
    assert!(covered > 20_000 && open > 20_000, "{covered} {open}");
}

#[test]
fn narrow_edges_touch_few_pixels() {
    let ring = [(2.5, 2.5), (29.5, 2.5), (29.5, 29.5), (2.5, 29.5)];
    let mut raster = Raster::default();
    raster.begin(Area::around(&PixelRect { x: (0, 32), y: (0, 32) }), (0, 0));
    draw(&mut raster, unshared(&ring), THIN);
    let area = *raster.area();
    for (x, y) in (0..32).flat_map(|y| (0..32).map(move |x| (x, y))) {
        let (block, row, column) = place(&area, x, y);
        let border =
            (2..30).contains(&x) && (2..30).contains(&y) && ([2, 29].contains(&x) || [2, 29].contains(&y));
        assert_eq!(raster.whole(block).pixel(PixelMarks::OPEN, row, column).0, border, "{x} {y}");
        let inside = (3..29).contains(&x) && (3..29).contains(&y);
        assert_eq!(raster.whole(block).covered()[row] >> column & 1 == 1, inside, "{x} {y}");
    }
}

#[test]
fn seams_of_two_patches_cancel() {
    let mut random = Random::new(7);
    let area = Area::around(&PixelRect { x: (0, 64), y: (0, 64) });
    let (mut first, mut second) = (Raster::default(), Raster::default());
    let mut seams = 0;
    for _ in 0..200 {
        // Two triangles that share the side from a to b, on different sides of it.
        let (a, b) = ((single(random.within(2.0, 60.0)), 3.0), (single(random.within(2.0, 60.0)), 60.0));
        let (c, d) = ((-9.0, single(random.within(0.0, 60.0))), (75.0, single(random.within(0.0, 60.0))));
        for (raster, ring) in [(&mut first, [c, a, b]), (&mut second, [d, b, a])] {
            raster.begin(area, (0, 0));
            let seam = |from, to| [from, to].iter().all(|p| [a, b].contains(p));
            draw(raster, edges(&ring).map(|(from, to)| (from, to, seam(from, to))), THIN);
        }
        let quad = [c, a, d, b];
        for y in 0..64 {
            for x in 0..64 {
                let (block, row, column) = place(&area, x, y);
                let mut both = first.whole(block);
                both.add(&second.whole(block));
                if both.covered_seams()[row] >> column & 1 == 1 {
                    seams += 1;
                    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.5)] {
                        let p = (x as f64 + dx, y as f64 + dy);
                        assert_ne!(winding(&quad, p), 0, "{a:?} {b:?} {c:?} {d:?}: {x} {y}");
                    }
                }
            }
        }
    }
    assert!(seams > 5000, "{seams}");
}

#[test]
fn all_vectors_draw_the_same() {
    let mut random = Random::new(23);
    let area = Area::around(&PixelRect { x: (0, 96), y: (0, 48) });
    let (mut least, mut best) = (Raster::default(), Raster::default());
    let mut marked = 0;
    for round in 0..500 {
        let size = [2.0, 15.0, 200.0][round % 3];
        let mut end = || random.within(-size, size) as f32;
        let mut edges = Edges { plain: 0xff, seams: 0b1010_0110, ..Edges::default() };
        for i in 0..LANES {
            let (x, y) = (40.0 + 5.0 * i as f32, 24.0 - i as f32);
            (edges.x0[i], edges.y0[i]) = (x + end(), y + end());
            (edges.x1[i], edges.y1[i]) = (x + end(), y + end());
            (edges.wide[i], edges.unsure[i]) = (1e-3 + end().abs() * 1e-2, 5e-4);
        }
        edges.x1[0] = edges.x0[0];
        edges.y1[7] = edges.y0[7];
        least.begin(area, (0, 0));
        best.begin(area, (0, 0));
        let baseline = ::fearless_simd::Level::baseline();
        ::fearless_simd::dispatch!(baseline, simd => least.edges(simd, &edges.vectors(simd, 1.0), false));
        vectorized!(simd => best.edges(simd, &edges.vectors(simd, 1.0), false));
        for block in 0..area.block_count() {
            assert_eq!(least.whole(block), best.whole(block), "{round} {edges:?}");
            marked += least.whole(block).marked_columns().count_ones();
        }
    }
    assert!(marked > 10_000, "{marked}");
}
