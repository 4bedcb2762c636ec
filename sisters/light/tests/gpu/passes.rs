//! Passes along stored hits.

use casca_radiosity::gpu::{GpuCache, GpuError};
use casca_radiosity::{Cache, Grid, Settings, Sky};
use casca_stage::gpu::Gpu;
use glam::Vec3;

use crate::common::{indirect, lamp, lit};
use crate::device::{furnished, points, read, run};

/// Passes of the device until nothing changes: 0.7 to the power of 64 is 1e-10.
const PASSES: u32 = 64;

/// The processor passes until nothing changes by more than single precision rounds; it stops before
/// so many.
const SETTLED: f64 = 1e-7;
const MOST_PASSES: u32 = 200;

/// The greatest difference of the indirect light of all states, over the mean.
fn apart(gpu: &Gpu, light: &GpuCache, cache: &Cache) -> f64 {
    // The cache answers at states only: two caches with the light of each are asked.
    let mut other = cache.clone();
    light.read_back(&mut other, &read(gpu, light.indirect())).unwrap();
    let of = |c: &Cache| points().iter().map(|(p, n)| indirect(c, *p, *n)).collect::<Vec<_>>();
    let (a, b) = (of(cache), of(&other));
    let mean = a.iter().sum::<f64>() / a.len() as f64;
    assert!(mean > 0.1);
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / mean
}

#[test]
fn passes_on_the_device_end_in_the_same_light() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut cache = lit(&furnished(), 24, 32, 0);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    cache.converge(SETTLED, MOST_PASSES);
    // A pass at a time, and many at once, from both halves.
    run(&gpu, |encoder| light.pass(encoder, 1));
    assert!(apart(&gpu, &light, &cache) > 0.1, "one pass is not all light");
    run(&gpu, |encoder| light.pass(encoder, PASSES));
    let found = apart(&gpu, &light, &cache);
    println!("passes: {found:e}");
    assert!(found < 1e-5, "{found}");
    // Other lights and another sky.
    cache.set_lights(&[lamp(Vec3::new(0.6, 0.4, 3.3), 20.0)]).unwrap();
    cache.set_sky(Sky::Even(Vec3::new(0.1, 0.5, 2.0))).unwrap();
    cache.direct();
    run(&gpu, |encoder| light.set_direct(&gpu.device, &gpu.queue, encoder, &cache).unwrap());
    cache.converge(SETTLED, MOST_PASSES);
    assert!(apart(&gpu, &light, &cache) > 0.1);
    run(&gpu, |encoder| light.pass(encoder, PASSES));
    let found = apart(&gpu, &light, &cache);
    println!("after other lights: {found:e}");
    assert!(found < 1e-5, "{found}");
}

#[test]
fn other_direct_light_is_sent_with_the_light_that_is_there() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let cache = lit(&furnished(), 16, 16, 60);
    let mut light = GpuCache::new(&gpu.device, &cache).unwrap();
    // Nothing changed, so that one pass changes nothing, whichever half it reads.
    for _ in 0..3 {
        run(&gpu, |encoder| {
            light.set_direct(&gpu.device, &gpu.queue, encoder, &cache).unwrap();
            light.pass(encoder, 1);
        });
        assert!(apart(&gpu, &light, &cache) < 1e-5);
    }
    // The next pass reads other direct light with the indirect light of before, as a fresh upload
    // does.
    let mut cache = cache;
    cache.set_lights(&[lamp(Vec3::new(0.6, 0.4, 3.3), 20.0)]).unwrap();
    cache.direct();
    let mut fresh = GpuCache::new(&gpu.device, &cache).unwrap();
    run(&gpu, |encoder| {
        light.set_direct(&gpu.device, &gpu.queue, encoder, &cache).unwrap();
        light.pass(encoder, 1);
        fresh.pass(encoder, 1);
    });
    let [a, b] = [&light, &fresh].map(|l| read(&gpu, l.indirect()));
    let largest = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
    assert!(largest < 1e-4, "{largest}");
    // A cache with fewer gathered states is not the one on the device.
    let grid = Grid::around(&furnished().objects, 16);
    let mut other = Cache::new(&furnished(), Settings::new(grid)).unwrap();
    other.request(Vec3::new(2.0, 0.0, 3.0), Vec3::Y).unwrap();
    other.gather_part((4, 4), usize::MAX).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let refused = light.set_direct(&gpu.device, &gpu.queue, &mut encoder, &other);
    assert!(matches!(refused, Err(GpuError::Changed { .. })));
}
