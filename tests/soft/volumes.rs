//! Visibility volumes that follow a changing grid.

use casca::soft::{Layer, SoftGrid, VisibilityVolume};
use casca::{Aabb, Light, Sphere, View};
use glam::{IVec3, UVec3, Vec3};

use crate::{Dice, soft};

/// The bits of all shares of a volume.
fn bits(volume: &VisibilityVolume, dims: IVec3) -> Vec<Option<u32>> {
    let cell = |i| IVec3::new(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y);
    (0..dims.element_product()).map(|i| volume.get(cell(i)).map(f32::to_bits)).collect()
}

fn lights() -> Vec<Light> {
    // Rays between middles of cells pass through many corners of cells, where rounding decides.
    let aligned = Vec3::new(20.5, 20.5, 30.5);
    let point = |position, range| Light::point(position, range);
    vec![
        point(aligned, f32::INFINITY),
        point(Vec3::new(61.3, 7.7, 20.1), 30.0),
        point(Vec3::new(-3e30, 1e28, 2e30), f32::INFINITY),
        Light::spot(View::omnidirectional(Vec3::new(9.0, 40.0, 5.0)).unwrap()),
        Light::directional(Vec3::NEG_Z),
        Light::directional(Vec3::ONE),
        Light::directional(Vec3::new(0.3, -0.2, 1.0)),
    ]
}

#[test]
fn an_updated_volume_is_that_of_a_new_one_to_the_bit() {
    // Two pages of bricks along x, and bricks that the border cuts.
    let dims = UVec3::new(76, 44, 36);
    for (number, light) in lights().iter().enumerate() {
        let mut dice = Dice(number as u64 + 3);
        let mut grid = soft(dims);
        let mut shapes = Vec::new();
        let top = dims.max_element() as f32;
        let block = |dice: &mut Dice| Aabb::from_center(dice.point(0.0, top), dice.point(0.2, 3.0));
        for _ in 0..20 {
            shapes.push(grid.insert(block(&mut dice), Layer::Fixed).unwrap());
        }
        grid.rebuild();
        let mut volume = VisibilityVolume::new(&grid, light, 2).unwrap();
        assert_eq!(volume.update(&grid), 0);
        for step in 0..10 {
            let one = shapes[(dice.next() * shapes.len() as f32) as usize];
            match step % 5 {
                0 => drop(grid.update(one, Sphere::new(dice.point(0.0, 40.0), 2.0))),
                1 => shapes.push(grid.insert(block(&mut dice), Layer::Moving).unwrap()),
                2 => {
                    // Nothing is left of a page; small things stand far from each other in the
                    // other one.
                    shapes.drain(..).for_each(|id| grid.remove(id).unwrap());
                    for _ in 0..16 {
                        let small = Aabb::from_center(dice.point(1.0, 38.0), dice.point(0.2, 1.5));
                        shapes.push(grid.insert(small, Layer::Fixed).unwrap());
                    }
                }
                _ => {
                    let near = Aabb::from_center(dice.point(4.0, 34.0), dice.point(0.2, 3.0));
                    shapes.push(grid.insert(near, Layer::Moving).unwrap());
                }
            }
            grid.rebuild();
            volume.update(&grid);
            let new = VisibilityVolume::new(&grid, light, 2).unwrap();
            assert!(bits(&volume, dims.as_ivec3()) == bits(&new, dims.as_ivec3()), "{light:?}, step {step}");
        }
    }
}

/// A floor of 96 x 96 cells under a ball.
fn floor(ball: Vec3) -> (SoftGrid, casca::soft::SoftId) {
    let mut grid = soft(UVec3::splat(96));
    grid.insert(Aabb::new(Vec3::ZERO, Vec3::new(96.0, 96.0, 3.5)), Layer::Fixed).unwrap();
    let id = grid.insert(Sphere::new(ball, 2.0), Layer::Moving).unwrap();
    grid.rebuild();
    (grid, id)
}

#[test]
fn only_bricks_beside_and_behind_a_change_are_walked_again() {
    let (mut grid, ball) = floor(Vec3::new(20.0, 20.0, 60.0));
    let sun = Light::directional(Vec3::NEG_Z);
    let mut volume = VisibilityVolume::new(&grid, &sun, 1).unwrap();
    grid.update(ball, Sphere::new(Vec3::new(68.0, 68.0, 60.0), 2.0)).unwrap();
    // Nothing changes before the rebuild.
    assert_eq!(volume.update(&grid), 0);
    grid.rebuild();
    let done = volume.update(&grid);
    // Both places have at most 2x2x2 bricks with 4x4x4 around them, and 4x4 bricks of the floor
    // below: of 144 in all.
    assert!((8..=2 * (64 + 16)).contains(&done), "{done}");
    // On the floor, and in the open cells above.
    for z in [3.5, 4.5] {
        let shade = |x, y| volume.least(Vec3::new(x, y, z));
        assert_eq!(
            [shade(20.5, 20.5), shade(68.5, 68.5), shade(40.5, 40.5)],
            [Some(1.0), Some(0.0), Some(1.0)]
        );
    }
    let new = VisibilityVolume::new(&grid, &sun, 1).unwrap();
    assert!(bits(&volume, IVec3::splat(96)) == bits(&new, IVec3::splat(96)));
}

#[test]
fn open_floors_are_lit_and_those_in_shade_are_dark() {
    // Whatever part of its cell the top of the floor takes, whatever the height of the sun.
    for (height, degrees) in
        [3.05f32, 3.3, 3.5, 3.7, 3.95].into_iter().flat_map(|h| [5f32, 30.0, 60.0, 90.0].map(|d| (h, d)))
    {
        let mut grid = soft(UVec3::splat(48));
        grid.insert(Aabb::new(Vec3::ZERO, Vec3::new(48.0, 48.0, height)), Layer::Fixed).unwrap();
        grid.rebuild();
        let sun = Light::directional(-Vec3::new(degrees.to_radians().cos(), 0.1, degrees.to_radians().sin()));
        let open = VisibilityVolume::new(&grid, &sun, 4).unwrap();
        let roof = Aabb::new(Vec3::new(0.0, 0.0, 20.0), Vec3::new(48.0, 48.0, 20.5));
        grid.insert(roof, Layer::Fixed).unwrap();
        let wall = Aabb::new(Vec3::new(47.2, 0.0, 0.0), Vec3::new(47.8, 48.0, 20.5));
        grid.insert(wall, Layer::Fixed).unwrap();
        grid.rebuild();
        let shut = VisibilityVolume::new(&grid, &sun, 4).unwrap();
        let mut dice = Dice(7);
        for _ in 0..200 {
            let p = dice.point(4.0, 40.0).with_z(height);
            for p in [p, p.round().with_z(height), p.floor().with_z(height) + Vec3::new(0.5, 0.5, 0.0)] {
                let found = (open.least(p), open.smooth(p));
                assert_eq!(found, (Some(1.0), Some(1.0)), "{p}, sun at {degrees}");
                assert_eq!((shut.least(p), shut.smooth(p)), (Some(0.0), Some(0.0)), "{p}, sun at {degrees}");
            }
        }
    }
}

#[test]
fn shares_on_one_side_of_a_thin_wall_are_not_those_of_the_other() {
    let mut grid = soft(UVec3::splat(32));
    let wall = Aabb::new(Vec3::new(16.2, 0.0, 0.0), Vec3::new(16.6, 32.0, 32.0));
    grid.insert(wall, Layer::Fixed).unwrap();
    grid.rebuild();
    let sun = Light::directional(Vec3::new(-1.0, -0.1, -0.2));
    let volume = VisibilityVolume::new(&grid, &sun, 4).unwrap();
    for (x, share) in [(15.2, 0.0), (15.6, 0.0), (17.2, 1.0), (17.6, 1.0)] {
        let at = Vec3::new(x, 16.3, 16.8);
        assert_eq!((volume.least(at), volume.smooth(at)), (Some(share), Some(share)), "{x}");
    }
    // Deep inside a solid no cell is open: its own cells answer.
    grid.insert(Aabb::new(Vec3::ZERO, Vec3::splat(10.0)), Layer::Fixed).unwrap();
    grid.rebuild();
    let volume = VisibilityVolume::new(&grid, &sun, 1).unwrap();
    assert_eq!([volume.least(Vec3::splat(4.5)), volume.smooth(Vec3::splat(4.5))], [Some(0.0); 2]);
}

#[test]
fn updates_count_the_bricks_that_they_walk_in_and_let_go() {
    let mut grid = soft(UVec3::splat(64));
    let lamp = Light::point(Vec3::new(2.0, 2.0, 60.0), f32::INFINITY);
    let mut volume = VisibilityVolume::new(&grid, &lamp, 1).unwrap();
    let small = |x: f32| Aabb::from_center(Vec3::new(x, 28.5, 28.5), Vec3::splat(0.2));
    // All cells beside it are in its brick; then some are in the next one.
    let id = grid.insert(small(27.5), Layer::Moving).unwrap();
    for (x, done) in [(Some(27.5), 1), (Some(31.5), 2), (Some(32.5), 2), (Some(35.5), 2), (None, 1)] {
        match x {
            Some(x) => grid.update(id, small(x)).unwrap(),
            None => grid.remove(id).unwrap(),
        }
        grid.rebuild();
        assert_eq!(volume.update(&grid), done, "{x:?}");
    }
    assert!((0..64 * 64).all(|i| volume.get(IVec3::new(i % 64, 28, i / 64)).is_none()));
}

#[test]
fn a_volume_that_is_brought_to_another_grid_starts_anew() {
    let sun = Light::directional(Vec3::new(0.1, 0.2, -1.0));
    let (grid, _) = floor(Vec3::splat(30.0));
    let mut volume = VisibilityVolume::new(&grid, &sun, 1).unwrap();
    let mut other = soft(UVec3::new(40, 30, 20));
    other.insert(Sphere::new(Vec3::splat(10.0), 4.0), Layer::Fixed).unwrap();
    other.rebuild();
    volume.update(&other);
    let new = VisibilityVolume::new(&other, &sun, 1).unwrap();
    assert!(bits(&volume, IVec3::new(40, 30, 20)) == bits(&new, IVec3::new(40, 30, 20)));
}

#[cfg(feature = "rayon")]
#[test]
fn volumes_do_not_depend_on_the_number_of_threads() {
    let (grid, _) = floor(Vec3::new(20.0, 20.0, 30.0));
    let lamp = Light::point(Vec3::new(31.0, 40.0, 80.0), 100.0);
    let volume = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bits(&VisibilityVolume::new(&grid, &lamp, 4).unwrap(), IVec3::splat(96)))
    };
    assert!(volume(1) == volume(3));
}
