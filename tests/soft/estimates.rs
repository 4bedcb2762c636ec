//! Fractions, ambient occlusion and visibility volumes against closed forms and single walks.

use casca::soft::{Layer, March, VisibilityVolume};
use casca::{Aabb, DrawOptions, GridSpec, Light, ObjectDesc, Query, Scene, Sphere, View};
use glam::{IVec3, UVec3, Vec3};

use crate::{Dice, soft};

#[test]
fn fractions_are_shares_of_solid_angles() {
    let mut grid = soft(UVec3::splat(96));
    let eye = Vec3::new(4.3, 48.2, 48.4);
    // A half-space hides one half of what is behind its edge.
    let wall = grid
        .insert(Aabb::new(Vec3::new(30.0, 48.0, 0.0), Vec3::new(32.0, 96.0, 96.0)), Layer::Fixed)
        .unwrap();
    grid.rebuild();
    let ball = Sphere::new(eye + Vec3::X * 60.0, 12.0);
    let cube = Aabb::from_center(ball.center, Vec3::splat(10.0));
    for seen in [grid.visible_fraction(eye, ball, 256), grid.visible_fraction(eye, cube, 256)] {
        let seen = seen.unwrap();
        assert!((seen.least - 0.5).abs() < 0.05 && (seen.most - 0.5).abs() < 0.05, "{seen:?}");
    }
    // A ball on the way takes its solid angle.
    grid.update(wall, Sphere::new(eye + Vec3::X * 30.0, 4.0)).unwrap();
    grid.rebuild();
    let cap = |sine: f32| 1.0 - (1.0 - sine * sine).sqrt();
    let hidden = |radius: f32| cap(radius / 30.0) / cap(12.0 / 60.0);
    let seen = grid.visible_fraction(eye, ball, 1024).unwrap();
    assert!((1.0 - hidden(5.75)..=1.0 - hidden(4.0)).contains(&seen.least), "{seen:?}");
    assert!((1.0 - hidden(4.0)..=1.0 - hidden(2.25)).contains(&seen.most), "{seen:?}");
    // What is in the grid does not hide itself, and an eye in a cell of a surface sees.
    grid.update(wall, ball).unwrap();
    grid.rebuild();
    assert_eq!(grid.visible_fraction(eye, ball, 64).unwrap().least, 1.0);
    assert_eq!(grid.visible_fraction(ball.center, ball, 64).unwrap().least, 1.0);
    // Behind a closed wall nothing is seen, in the grid or beyond.
    grid.update(wall, Aabb::new(Vec3::new(30.0, 0.0, 0.0), Vec3::new(31.0, 96.0, 96.0))).unwrap();
    grid.rebuild();
    for target in [ball, Sphere::new(eye + Vec3::X * 500.0, 3.0)] {
        assert_eq!(grid.visible_fraction(eye, target, 64).unwrap().most, 0.0);
    }
}

#[test]
fn corners_hide_half_of_the_sky() {
    let mut grid = soft(UVec3::splat(64));
    grid.insert(Aabb::new(Vec3::ZERO, Vec3::new(64.0, 64.0, 8.5)), Layer::Fixed).unwrap();
    grid.rebuild();
    let on_floor = |x: f32| Vec3::new(x, 32.0, 8.5);
    let rays = March::Rays(1024);
    let hidden = |grid: &casca::soft::SoftGrid, x: f32, march: &March| {
        grid.ambient_occlusion(on_floor(x), Vec3::Z, f32::INFINITY, march).unwrap()
    };
    assert_eq!(hidden(&grid, 32.0, &rays), 0.0);
    assert!(hidden(&grid, 32.0, &March::Slabs) < 0.05);
    // A wall as high as the grid, seen from its foot: of an infinite one, exactly half.
    grid.insert(Aabb::new(Vec3::new(40.0, 0.0, 8.0), Vec3::new(64.0, 64.0, 64.0)), Layer::Fixed).unwrap();
    grid.rebuild();
    let (exact, cones) = (hidden(&grid, 39.5, &rays), hidden(&grid, 39.5, &March::Slabs));
    assert!((exact - 0.5).abs() < 0.01 && (0.45..0.60).contains(&cones), "{exact} {cones}");
    println!("half of the sky: rays {exact:.3}, cones {cones:.3}");
    let far = grid.ambient_occlusion(on_floor(20.0), Vec3::Z, 5.0, &rays).unwrap();
    assert_eq!(far, 0.0, "the wall is out of reach");
}

#[test]
fn only_rays_converge_to_the_hidden_share_of_the_sky() {
    let mut dice = Dice(11);
    let mut grid = soft(UVec3::splat(64));
    for _ in 0..60 {
        let at = dice.point(0.0, 64.0);
        grid.insert(Aabb::from_center(at, dice.point(0.5, 4.0)), Layer::Fixed).unwrap();
    }
    grid.rebuild();
    let marches = [March::Slabs, March::OLD, March::Rays(16), March::default(), March::Rays(256)];
    let (mut errors, mut points) = ([0.0; 5], 0.0);
    while points < 100.0 {
        let (point, normal) = (dice.point(4.0, 60.0), dice.point(-1.0, 1.0));
        let hidden = |march: &March| grid.ambient_occlusion(point, normal, 30.0, march).unwrap();
        let exact = hidden(&March::Rays(4096));
        for (error, march) in errors.iter_mut().zip(&marches) {
            *error += (hidden(march) - exact).abs();
        }
        points += 1.0;
    }
    let [slabs, old, few, default, many] = errors.map(|e| e / points);
    println!("mean error: slabs {slabs:.4}, old rule {old:.4}, rays {few:.4}, {default:.4}, {many:.4}");
    assert!(many < default && default < few, "{few} {default} {many}");
    assert!(default * 2.0 < slabs && default * 2.0 < old, "{default} {slabs} {old}");
}

#[test]
fn ambient_occlusion_reaches_from_the_point() {
    let mut grid = soft(UVec3::splat(64));
    grid.insert(Aabb::new(Vec3::ZERO, Vec3::new(64.0, 64.0, 7.5)), Layer::Fixed).unwrap();
    let ball = Sphere::new(Vec3::new(32.0, 32.0, 8.0), 12.0);
    // A ceiling, and cells below it: all outside of the ball, but not of one that is a cell higher.
    grid.insert(Aabb::new(Vec3::new(0.0, 0.0, 20.2), Vec3::new(64.0, 64.0, 22.0)), Layer::Fixed).unwrap();
    for i in 0..64 * 64 {
        let low = Vec3::new((i % 64) as f32, (i / 64) as f32, 18.0);
        let nearest = ball.center.clamp(low, low + Vec3::ONE);
        if nearest.distance(ball.center) > 12.05 {
            grid.insert(Aabb::new(low + 0.2, low + 0.8), Layer::Fixed).unwrap();
        }
    }
    grid.rebuild();
    let hidden =
        |reach: f32| grid.ambient_occlusion(ball.center, Vec3::Z, reach, &March::Rays(1024)).unwrap();
    assert_eq!([hidden(0.5), hidden(11.99)], [0.0, 0.0]);
    assert!(hidden(13.5) > 0.3, "{}", hidden(13.5));
}

#[test]
fn a_lamp_shines_out_of_its_own_cell() {
    let mut grid = soft(UVec3::splat(24));
    let middle = Vec3::splat(12.5);
    grid.insert(Aabb::from_center(middle, Vec3::splat(0.4)), Layer::Fixed).unwrap();
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 20.2), Vec3::new(24.0, 24.0, 20.8));
    grid.insert(wall, Layer::Fixed).unwrap();
    grid.rebuild();
    let spot = View::omnidirectional(middle).unwrap();
    for lamp in [Light::point(middle, 40.0), Light::spot(spot)] {
        let volume = VisibilityVolume::new(&grid, &lamp, 4).unwrap();
        for (z, share) in [(11, 1.0), (12, 1.0), (13, 1.0), (19, 1.0), (20, 1.0), (21, 0.0)] {
            for x in 11..14 {
                assert_eq!(volume.get(IVec3::new(x, 12, z)), Some(share), "{x} {z}");
            }
        }
    }
}

#[test]
fn volumes_hold_what_single_walks_say() {
    let mut dice = Dice(9);
    let mut grid = soft(UVec3::splat(24));
    for _ in 0..12 {
        let at = dice.point(0.0, 24.0);
        grid.insert(Aabb::from_center(at, dice.point(0.2, 2.5)), Layer::Fixed).unwrap();
    }
    grid.rebuild();
    let lamp = Vec3::new(11.3, 12.7, 20.1);
    let lights =
        [(Light::point(lamp, 18.0), true), (Light::directional(Vec3::new(0.313, 0.171, -1.0)), false)];
    for (light, is_lamp) in lights {
        let volume = VisibilityVolume::new(&grid, &light, 1).unwrap();
        let (mut known, mut surfaces) = (0, 0);
        for i in 0..24 * 24 * 24 {
            let cell = IVec3::new(i % 24, i / 24 % 24, i / 576);
            let Some(share) = volume.get(cell) else { continue };
            known += 1;
            let from = cell.as_vec3() + 0.5;
            let to = if is_lamp { lamp } else { from + Vec3::new(-0.313, -0.171, 1.0) * 40.0 };
            if !grid.pyramid().any(0, cell) {
                let lit = from.distance(to) <= 18.0 || !is_lamp;
                let open = lit && grid.first_hit(from, to).unwrap().is_none();
                assert_eq!(share, f32::from(u8::from(open)), "{cell}");
                continue;
            }
            // At the middle of an occupied cell the open ones beside it count.
            let beside = (0..27).map(|k| cell + IVec3::new(k % 3, k / 3 % 3, k / 9) - 1);
            let open = beside.filter(|&c| !grid.pyramid().any(0, c)).filter_map(|c| volume.get(c));
            if let Some(least) = open.reduce(f32::min) {
                surfaces += 1;
                assert_eq!(volume.least(from), Some(least), "{cell}");
            }
        }
        assert!(known > 1500 && surfaces > 300, "{known} {surfaces}");
        for _ in 0..500 {
            let p = dice.point(-2.0, 26.0);
            let (least, smooth) = (volume.least(p), volume.smooth(p));
            assert!(
                least.is_none() && smooth.is_none_or(|s| s.is_finite())
                    || least.unwrap() <= smooth.unwrap() + 1e-5
            );
        }
    }
    // Nothing but cells near surfaces is held.
    let empty = VisibilityVolume::new(&soft(UVec3::splat(24)), &Light::directional(Vec3::Z), 1).unwrap();
    assert_eq!(empty.get(IVec3::splat(12)), None);
}

#[test]
fn draw_lists_keep_all_objects_and_their_order() {
    let spec = GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(64) };
    let mut scene = Scene::new(&spec).unwrap();
    let wall = Aabb::new(Vec3::new(0.0, 20.0, 0.0), Vec3::new(40.0, 21.0, 64.0));
    scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
    let ball = |i: u8| Sphere::new(Vec3::new(5.0 * f32::from(i), 30.0, 32.0), 2.4);
    let balls: Vec<_> = (0..12).map(|i| scene.insert(ObjectDesc::dynamic(ball(i))).unwrap()).collect();
    let mut grid = casca::soft::SoftGrid::new(&spec).unwrap();
    grid.follow(&scene).unwrap();
    let mut query = Query::new();
    let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(32.0, 4.0, 32.0)).unwrap());
    let mut items = Vec::new();
    pvs.draw_list(&scene, &DrawOptions::default(), &mut items).unwrap();
    assert!(items.iter().all(|i| i.fraction == 1.0 && i.seen_size() == i.size));
    let before = items.clone();
    grid.estimate(pvs, &scene, 256, &mut items).unwrap();
    for (a, b) in before.iter().zip(&items) {
        assert_eq!((a.id, a.distance, a.size), (b.id, b.distance, b.size));
        assert!((0.0..=1.0).contains(&b.fraction));
    }
    // The edge of the wall lies before the middle of this ball: one half of it is seen, and its
    // size times the root of a half.
    let half = items.iter().position(|i| i.id == balls[9]).unwrap();
    let levels = |thresholds: &[f32]| [before[half].level(thresholds), items[half].level(thresholds)];
    assert_eq!([levels(&[0.15, 0.1]), levels(&[0.15, 0.125])], [[0, 1], [0, 2]], "{:?}", items[half]);
    assert!(items.iter().any(|i| i.fraction < 0.9) && items.iter().any(|i| i.fraction == 1.0), "{items:?}");
    let other = Scene::new(&spec).unwrap();
    assert_eq!(grid.estimate(pvs, &other, 256, &mut items), Err(casca::Error::ForeignPvs));
}
