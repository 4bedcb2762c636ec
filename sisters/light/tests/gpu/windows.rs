//! Windows of finer cells on the device: the light of the processor, also at their faces.

use casca_radiosity::gpu::{Answers, GpuCache};
use casca_radiosity::{Cache, Grid, Scene, Settings, Window};
use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::common::{gathered, lamp, leak_questions, matt, on_faces, rooms, scene, wall_questions};
use crate::device::{furnished, mirrored, points, shaded};
use crate::mirrors::ELSEWHERE;

/// Passes end with the first that changes less than this share of the light, a thousandth of what
/// tests allow, and after so many.
const SETTLED: f64 = 1e-6;
const MOST_PASSES: u32 = 60;

fn lit(scene: &Scene, cells: u32, windows: [Option<Window>; 2]) -> Cache {
    let settings = Settings { windows, ..Settings::new(Grid::around(&scene.objects, cells)) };
    let mut cache = gathered(scene, settings, 32);
    cache.converge(SETTLED, MOST_PASSES);
    cache
}

#[test]
fn windows_give_the_light_of_the_processor() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Faces that lie in no wall, and some that do.
    for (cells, half) in [(13, 1.3), (10, 2.0)] {
        let outer = Window { middle: Vec3::new(2.4, 1.1, 2.2), half, finer: 2 };
        let inner = Window { half: 0.6, finer: 4, ..outer };
        let mut cache = lit(&furnished(), cells, [Some(outer), Some(inner)]);
        let mut device = GpuCache::new(&gpu.device, &cache).unwrap();
        same(&gpu, &cache, &device);
        // The device follows when windows move.
        let moved = cache.move_windows(Vec3::new(0.5, 1.0, 3.5)).unwrap();
        assert!(moved.dropped > 0);
        cache.request_all();
        cache.gather(32).unwrap();
        cache.direct();
        cache.converge(SETTLED, MOST_PASSES);
        device = GpuCache::new(&gpu.device, &cache).unwrap();
        same(&gpu, &cache, &device);
    }
}

/// Whether answers and mirrors are those of the processor.
fn same(gpu: &Gpu, cache: &Cache, device: &GpuCache) {
    let points = points();
    let found = shaded(gpu, device, Answers::Indirect, &points);
    let (mut others, mut sum, mut light) = (0, 0.0, 0.0);
    for ((p, n), device) in points.iter().zip(&found) {
        let answer = cache.irradiance(*p, *n).unwrap();
        if (device[3] == 1.0) != (answer.states > 0) {
            others += 1;
        } else if answer.states > 0 {
            let error = (Vec3::from_slice(device) - answer.indirect).length();
            (sum, light) = (sum + error, light + answer.indirect.length());
            others += usize::from(error > ELSEWHERE * answer.indirect.length());
        }
    }
    println!("{others} of {} points differ, {} of the light", points.len(), sum / light);
    // Single precision chooses another side of a face for some points in it.
    assert!(others <= 4 && sum < ELSEWHERE * light, "{others} {}", sum / light);
    let eye = Vec3::new(2.0, 1.4, 2.1);
    let mirrors: Vec<_> = points.iter().map(|(p, n)| (*p, *n, 0.0)).collect();
    let of_device = mirrored(gpu, device, &mirrors, eye, 1);
    let of_device: f32 = of_device.iter().map(|m| m[..3].iter().sum::<f32>()).sum();
    let ask = |(p, n): &(Vec3, Vec3)| cache.reflection(*p, *n, eye, 0.0, 1).unwrap().element_sum();
    let known: f32 = points.iter().map(ask).sum();
    assert!((of_device / known - 1.0).abs() < 0.01, "{of_device} {known}");
}

#[test]
fn the_room_behind_a_wall_is_dark_also_at_the_faces_of_windows() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for thickness in [0.0, 0.02, 0.2] {
        for x in [f32::NAN, -1.0, -0.2, 0.4, 1.0] {
            // Without a window, too.
            let light = vec![lamp(Vec3::new(-2.0, 2.0, 0.3), 10.0)];
            let window = Window { middle: Vec3::new(x, 1.5, 0.0), half: 1.0, finer: 4 };
            let windows = [Some(window).filter(|_| x.is_finite()), None];
            let cache = lit(&scene(rooms(thickness), vec![matt(0.7)], light, 0.0), 20, windows);
            let device = GpuCache::new(&gpu.device, &cache).unwrap();
            let at = |side: f32| {
                let all = leak_questions(side, thickness);
                shaded(&gpu, &device, Answers::All, &all).iter().map(|p| p[0]).sum::<f32>()
            };
            assert!(at(-1.0) > 50.0, "{thickness} {x}");
            assert_eq!(at(1.0), 0.0, "{thickness} {x}");
        }
    }
}

#[test]
fn walls_in_the_faces_of_windows_have_their_states_on_the_device() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for x in [1.0, 3.5] {
        let window = Window { middle: Vec3::new(x, 3.0, 3.0), half: 1.0, finer: 2 };
        let cache = lit(&on_faces(), 16, [Some(window), None]);
        let device = GpuCache::new(&gpu.device, &cache).unwrap();
        let found = shaded(&gpu, &device, Answers::Indirect, &wall_questions());
        assert!(found.iter().all(|p| p[3] == 1.0), "{x}");
    }
}
