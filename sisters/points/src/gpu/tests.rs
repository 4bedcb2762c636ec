//! The splat operator beside the processor's, and pictures of surfels beside analytic ones.

use super::*;
use crate::Camera;
use crate::samples::{cases, sphere};
use crate::splat::{self, Bias, Filter, Radius, SplatError, SplatOptions};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, Gpu};
use casca_stage::wgpu::{self, Color};
use glam::Vec3;
use proptest::prelude::*;

fn floats(points: impl IntoIterator<Item = glam::DVec3>) -> Vec<Vec3> {
    points.into_iter().map(|p| p.as_vec3()).collect()
}

const FILTERS: [Filter; 4] = [Filter::None, Filter::Max, Filter::PlainMax, Filter::Min];

#[test]
fn answers_are_those_of_the_processor_bit_by_bit() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let operator = SplatOperator::new(&gpu);
    let config = cases(60);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let coordinate = || prop_oneof![-1.0..1.0_f32, Just(0.0_f32), -1e-3..1e-3_f32];
    let cloud = (prop::collection::vec([coordinate(), coordinate(), coordinate()], 0..200), 0..3000_usize);
    let camera =
        ([-3.0..3.0_f32, -3.0..3.0_f32, 0.1..3.0_f32], 0.2..2.5_f32, (1..300_u32, 1..200_u32), 1e-3..0.5_f32);
    let bias = prop_oneof![(0.0..0.2_f32).prop_map(Bias::Window), (0.0..0.3_f32).prop_map(Bias::World)];
    let radius = prop_oneof![0.0..0.05_f32, 0.0..3.0_f32, Just(0.0_f32)];
    let options = (0..4_usize, bias, radius, any::<[bool; 2]>(), -10..10_i32);
    let done = runner.run(
        &(cloud, camera, options),
        |((random, even), (eye, fov, size, near), (filter, bias, radius, [each, slopes], scale))| {
            // The scale of the world moves exponents, and with them the rounding.
            let scale = 3_f32.powi(scale);
            let random = random.iter().copied().map(Vec3::from_array);
            let points: Vec<Vec3> = random.chain(floats(sphere(even))).map(|p| p * scale).collect();
            let camera = Camera::look_at(
                Vec3::from(eye) * scale,
                Vec3::ZERO,
                Vec3::Y,
                fov,
                size,
                near * scale,
                20.0 * scale,
            )
            .unwrap();
            let radii: Vec<f32> = (0..points.len()).map(|i| radius * scale * (i % 7) as f32).collect();
            let radius = if each { Radius::Each(&radii) } else { Radius::Same(radius * scale) };
            let bias = if let Bias::World(length) = bias { Bias::World(length * scale) } else { bias };
            let options = SplatOptions { radius, bias, filter: FILTERS[filter], slopes };
            let expected = splat::visible_points(&points, &camera, &options).unwrap().visible;
            let uploaded = GpuPoints::new(&gpu, &points).unwrap();
            for _ in 0..2 {
                let found = operator.visible_points(&gpu, &uploaded, &camera, &options).unwrap();
                prop_assert_eq!(
                    &found,
                    &expected,
                    "{} of {} points",
                    (found.clone() ^ &expected).count_ones(),
                    points.len()
                );
            }
            Ok(())
        },
    );
    done.unwrap();
}

#[test]
fn quotients_of_the_shader_are_rounded_as_those_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let entry = "@compute @workgroup_size(1) fn quotients(@builtin(workgroup_id) group: vec3u) {
        limits[group.x] = quotient(points[2u * group.x], points[2u * group.x + 1u]);
    }";
    let source = wgpu::ShaderSource::Wgsl([include_str!("splat.wgsl"), entry].concat().into());
    let shader = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &shader,
        entry_point: Some("quotients"),
        compilation_options: Default::default(),
        cache: None,
    });
    // Mantissas from a sequence that meets all of them, and those at the ends.
    let mantissa = |i: u32| {
        if i.is_multiple_of(9) { [0, 1, 0x7f_ffff][i as usize % 3] } else { i.wrapping_mul(0x9e37_79b1) >> 9 }
    };
    let float = |i: u32| f32::from_bits((100 + i * 7 % 55) << 23 | mantissa(i));
    let pairs: Vec<[f32; 2]> = (0..60_000).map(|i| [float(i), float(i * 5 + 1)]).collect();
    let buffer = |size| gpu.buffer(size, wgpu::BufferUsages::STORAGE).unwrap();
    let (points, quotients) = (buffer(480_000), buffer(240_000));
    gpu.queue.write_buffer(&points, 0, bytemuck::cast_slice(&pairs));
    let entries = [(3, &quotients), (5, &points)]
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    let layout = &pipeline.get_bind_group_layout(0);
    let group =
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(60_000, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let found: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&quotients).unwrap());
    for ([a, b], found) in pairs.iter().zip(found) {
        assert_eq!(found, a / b, "{a} / {b}");
    }
}

#[test]
fn clouds_of_several_buffers_and_none_are_answered() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let operator = SplatOperator::new(&gpu);
    let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y, 0.8, (640, 480), 0.1, 10.0).unwrap();
    let options = SplatOptions {
        radius: Radius::Same(1e-3),
        bias: Bias::World(0.01),
        filter: Filter::Max,
        slopes: false,
    };
    // One buffer holds 2^22 points.
    for count in [0, (1 << 22) + 77] {
        let points = floats(sphere(count));
        let uploaded = GpuPoints::new(&gpu, &points).unwrap();
        let found = operator.visible_points(&gpu, &uploaded, &camera, &options).unwrap();
        assert!(found == splat::visible_points(&points, &camera, &options).unwrap().visible);
        assert!(count == 0 || found.count_ones() > count / 4);
    }
}

#[test]
fn errors_name_the_cause() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let bad = [Vec3::ONE, Vec3::NAN];
    let error = GpuPoints::new(&gpu, &bad).err().unwrap();
    assert!(matches!(error, GpuSplatError::Splat(SplatError::PointNotFinite { index: 1 })), "{error}");
    let points = GpuPoints::new(&gpu, &bad[..1]).unwrap();
    let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 0.8, (640, 480), 0.1, 10.0).unwrap();
    let options = SplatOptions {
        radius: Radius::Each(&[]),
        bias: Bias::World(0.01),
        filter: Filter::Max,
        slopes: false,
    };
    let error = SplatOperator::new(&gpu).visible_points(&gpu, &points, &camera, &options).unwrap_err();
    assert!(matches!(error, GpuSplatError::Splat(SplatError::Radii { radii: 0, points: 1 })), "{error}");
}

const BLUE: [u8; 4] = [0, 0, 200, 255];
const STYLE: Style = Style { scale: 1.0, least_pixels: 0.7, offset: 0.1, lit: false };

/// A ball of discs, red where the coordinate `axis` is positive and green elsewhere.
fn ball(count: usize, axis: usize) -> Vec<Surfel> {
    let radius = (24.0 / count as f32).sqrt();
    let surfel = |p: Vec3| {
        let colour = if p[axis] > 0.0 { [200, 0, 0, 255] } else { [0, 200, 0, 255] };
        Surfel { position: p.to_array(), radius, normal: p.to_array(), colour }
    };
    floats(sphere(count)).into_iter().map(surfel).collect()
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
    let second = picture(&gpu, &[(&surfels, style)]);
    surfels.reverse();
    let third = picture(&gpu, &[(&surfels, style)]);
    for other in [second, third] {
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
