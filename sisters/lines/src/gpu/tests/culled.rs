//! Pictures with and without culling, and views of scenes.

use casca_truth::cases;
use proptest::prelude::*;

use super::*;
use crate::gpu::lens::view_of_scene;
use crate::sets::rooms::House;
use crate::view::Lens;

#[test]
fn pictures_with_and_without_culling_are_the_same_in_every_pixel() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let house = House::new(4, 120, 5, 0.0).unwrap();
    let walls = [Context::of_boxes(&house.walls)];
    let mut culled = Culled::new(&gpu, &house.lines, &walls, Settings::new(0.35, 0.01));
    let (mut drawn, mut dark) = (0, 0.0);
    for frame in 0..8 {
        let [eye, target] = house.eye(frame * 2);
        let (lens, depths) = match frame {
            // Parallel rays that look down over the walls.
            7 => (Lens::Orthographic { half_height: 2.0 }, [-1.0, 6.0]),
            _ => (Lens::Perspective { fov_y: 1.1 }, [0.05, 15.0]),
        };
        let view = View::look_at([eye, target, Vec3::Y], lens, depths, [160, 120]).unwrap();
        let (bundles, occlusion) = culled.changes_nothing(&view);
        (drawn, dark) = (drawn + bundles, dark + occlusion);
    }
    let total = 8 * culled.lines.bundles().len();
    assert!(drawn * 2 < total && dark > 500.0, "{drawn} {total} {dark}");
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn views_of_scenes_hold_just_the_points_of_the_picture(
        p in [-2.0f32..2.0, -2.0f32..2.0, -2.0f32..2.0], from in [-1.0f32..1.0, -1.0f32..1.0, 0.1f32..1.0], perspective: bool
    ) {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::from(from), perspective.then_some(0.7), [48, 33]).unwrap();
        let eye = view.to_eye(Vec3::from(p));
        let (place, [near, far]) = (view.project(eye), view.depths());
        // How far inside of each side, as a share of the view; negative outside.
        let inside = [place.x / place.z / 48.0, place.y / place.z / 33.0, (-eye.z - near) / (far - near)];
        let inside = inside.map(|share| share.min(1.0 - share)).into_iter().fold(f64::MAX, f64::min);
        prop_assume!(inside.abs() > 1e-4);
        let scene = casca::Scene::new(1.0).unwrap();
        let mut query = casca::Query::new();
        query.run(&scene, &view_of_scene(&view).unwrap());
        let sight = query.sight(&scene).unwrap();
        prop_assert_eq!(sight.may_see_point(Vec3::from(p)), inside > 0.0, "{:?} {}", view, inside);
    }
}

#[test]
fn lines_before_walls_are_shown_those_behind_are_not_and_moved_ones_are_followed() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let at = |z: f32| LineSet::new([[vec3(-0.5, 0.02, z), vec3(0.5, 0.02, z)]]).unwrap();
    let wall = [Context::of_boxes(&[[vec3(-2.0, -2.0, -0.1), vec3(2.0, 2.0, 0.1)]])];
    let shown_wall = [GpuContext::new(&gpu, &wall[0]).unwrap()];
    for fov in [None, Some(0.8)] {
        let view = View::around([-Vec3::ONE, Vec3::ONE], Vec3::Z, fov, SIZE).unwrap();
        let mut renderer = Renderer::new(&gpu, COLOUR, Settings::new(0.3, 0.01)).unwrap();
        let mut lines = GpuLines::new(&gpu, &at(0.5), &of_margin(0.04)).unwrap();
        let mut culling = Culling::new(lines.bundles(), &wall).unwrap();
        for z in [0.5, -0.9, 0.6] {
            lines = GpuLines::new(&gpu, &at(z), &of_margin(0.04)).unwrap();
            culling.follow(lines.bundles()).unwrap();
            let seen = culling.look(&view, 0.01).unwrap();
            assert_eq!(seen.drawn.len(), usize::from(z > 0.0), "{z}");
            for seen in [&seen, &Seen::all(1)] {
                renderer.update(&gpu, &view, (&lines, seen), &shown_wall, &mut Clock::off()).unwrap();
                let shown = renderer.read_fragments(&gpu).unwrap().iter().flatten().count();
                assert_eq!(shown > 10, z > 0.0, "{z}: {shown}");
            }
        }
        culling.follow(&[]).unwrap();
        assert_eq!(culling.look(&view, 0.0).unwrap(), Seen::default());
        drop(lines);
    }
}
