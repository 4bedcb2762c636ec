//! Pictures of surfels beside analytic ones.

use super::*;
use crate::samples::sphere;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::COLOUR;

const BLUE: [u8; 4] = [0, 0, 200, 255];
const STYLE: Style = Style { scale: 1.0, least_pixels: 0.7, offset: 0.1, lit: false };

/// A ball of discs, red where the coordinate `axis` is positive and green elsewhere.
fn ball(count: usize, axis: usize) -> Vec<Surfel> {
    let radius = (24.0 / count as f32).sqrt();
    let surfel = |p: Vec3| {
        let colour = if p[axis] > 0.0 { [200, 0, 0, 255] } else { [0, 200, 0, 255] };
        Surfel { position: p.to_array(), radius, normal: p.to_array(), colour }
    };
    sphere(count).into_iter().map(|p| surfel(p.as_vec3())).collect()
}

/// A blue wall of discs without normals behind the ball.
fn backdrop() -> Vec<Surfel> {
    let at = |i: u16| [f32::from(i % 50) * 0.15 - 3.75, f32::from(i / 50) * 0.15 - 3.75, -2.0];
    let surfel = |i| Surfel { position: at(i), radius: 0.2, normal: [0.0; 3], colour: BLUE };
    (0..2500).map(surfel).collect()
}

const SIZE: (u32, u32) = (160, 120);

fn picture(gpu: &Gpu, panes: &[(&[Surfel], Style)]) -> Vec<u8> {
    let canvas = Canvas::new(gpu, (SIZE.0 * panes.len() as u32, SIZE.1));
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, Vec3::Y, 0.8, SIZE, 0.1, 10.0).unwrap();
    let uploaded: Vec<Surfels> =
        panes.iter().map(|(surfels, _)| Surfels::new(gpu, surfels).unwrap()).collect();
    let pane = |(i, (_, style)): (usize, &(&[Surfel], Style))| Pane {
        surfels: &uploaded[i],
        style: *style,
        corner: (SIZE.0 * i as u32, 0),
    };
    let panes: Vec<_> = panes.iter().enumerate().map(pane).collect();
    let renderer = SurfelRenderer::new(gpu, COLOUR);
    renderer.draw(gpu, &canvas.picture(), &camera, Color::WHITE, &panes);
    canvas.read_picture(gpu).unwrap()
}

fn pixel(pixels: &[u8], width: u32, x: u32, y: u32) -> [u8; 3] {
    let at = 4 * (y * width + x) as usize;
    [pixels[at], pixels[at + 1], pixels[at + 2]]
}

#[test]
fn a_ball_is_closed_and_hides_what_is_behind_it() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let surfels = [ball(3000, 1), backdrop()].concat();
    let pixels = picture(&gpu, &[(&surfels, STYLE)]);
    // The ball's outline in pixels: its tangents leave the eye, at distance 4, by the sine 1/4.
    let outline = (1.0_f32 / 15.0).sqrt() * 60.0 / 0.4_f32.tan();
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        let (right, down) = (x as f32 + 0.5 - 80.0, y as f32 + 0.5 - 60.0);
        let found = pixel(&pixels, SIZE.0, x, y);
        let expected = match right.hypot(down) {
            r if r < outline - 3.0 && down < -4.0 => [200, 0, 0],
            r if r < outline - 3.0 && down > 4.0 => [0, 200, 0],
            r if r > outline + 3.0 => [0, 0, 200],
            _ => continue,
        };
        let differences = found.iter().zip(&expected).map(|(a, b): (&u8, &u8)| a.abs_diff(*b));
        assert!(differences.max() <= Some(2), "{x} {y}: {found:?}, not {expected:?}");
    }
}

#[test]
fn the_order_of_surfels_does_not_matter() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut surfels = [ball(3000, 1), backdrop()].concat();
    let style = Style { lit: true, ..STYLE };
    let first = picture(&gpu, &[(&surfels, style)]);
    // A permutation, since 5500 and 7 have no common factor.
    surfels = (0..surfels.len()).map(|i| surfels[i * 7 % surfels.len()]).collect();
    for _ in 0..2 {
        let other = picture(&gpu, &[(&surfels, style)]);
        surfels.reverse();
        let differences = first.iter().zip(&other).map(|(a, b)| a.abs_diff(*b));
        assert!(differences.max() <= Some(2), "rounding of sums");
    }
}

#[test]
fn back_faces_are_culled_and_panes_keep_apart() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut inside_out = ball(3000, 2);
    inside_out.iter_mut().for_each(|s| s.normal = s.normal.map(|x| -x));
    let broken = Surfel { radius: f32::NAN, ..inside_out[0] };
    let dots = Style { scale: 0.0, ..STYLE };
    let panes: [(&[Surfel], Style); 4] =
        [(&ball(3000, 2), STYLE), (&inside_out, STYLE), (&[broken], STYLE), (&ball(300, 2), dots)];
    let pixels = picture(&gpu, &panes);
    let colours = |pane| {
        let all = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let count = |colour| {
            let has = |&(x, y): &(u32, u32)| pixel(&pixels, SIZE.0 * 4, SIZE.0 * pane + x, y) == colour;
            all.clone().filter(has).count()
        };
        [count([200, 0, 0]), count([0, 200, 0])]
    };
    // The near side of a ball, the far side of one turned inside out, whose rim is on the near
    // side, nothing, and dots.
    let [near, far, nothing, dots] = [0, 1, 2, 3].map(colours);
    assert!(near[0] > 4000 && near[1] == 0 && far[1] > 3500 && far[0] < 400, "{near:?} {far:?}");
    assert!(nothing == [0, 0] && (50..1000).contains(&dots[0]) && dots[1] == 0, "{nothing:?} {dots:?}");
}
