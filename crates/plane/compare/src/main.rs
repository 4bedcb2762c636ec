use casca_plane::maps::MapKind;
use casca_plane::{FieldOfView, FovOptions, OpaqueTiles, TilePoint};
use std::time::Instant;
fn main() {
    for kind in MapKind::ALL {
        for size in [64, 256, 1024, 4096u32] {
            let map = OpaqueTiles::new(kind.generate(size, size, 1));
            let mut eyes = vec![];
            let mut s = 5u64;
            while eyes.len() < 100 {
                let mut next = || { s = s.wrapping_mul(6364136223846793005).wrapping_add(1); (s >> 33) as u32 % size };
                let (x, y) = (next(), next());
                if !map.get(x, y) { eyes.push((x, y)); }
            }
            for (name, off) in [("centre", 0.5), ("odd", 0.3712391)] {
                let mut fov = FieldOfView::new();
                let mut times = vec![];
                let mut tiles = 0;
                for &(x, y) in &eyes {
                    let eye = TilePoint::new(x as f64 + off, y as f64 + off * 0.7).unwrap();
                    let t = Instant::now();
                    fov.run(&map, eye, &FovOptions::default());
                    times.push(t.elapsed().as_secs_f64() * 1e6);
                    tiles += fov.seen().count();
                }
                times.sort_by(f64::total_cmp);
                println!("{:7} {size:5} {name:7} median {:9.1} us  mean {:9.1}  max {:9.1}  tiles {}", kind.name(), times[50], times.iter().sum::<f64>() / 100.0, times[99], tiles / 100);
            }
        }
    }
}
