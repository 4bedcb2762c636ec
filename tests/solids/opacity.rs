//! What solids leave behind: opaque cells go with the last solid that fills them, and stay until
//! then.

use casca::internals::SceneInternals;
use casca_scenes::world::Mesh;

use crate::common::*;

#[test]
fn occluders_that_nobody_reported_leave_no_opaque_cells() {
    for method in [Method::point(), Method::cell()] {
        let mut scene = empty();
        let at = |x: f32| Aabb::new(Vec3::new(x, 4.0, 10.0), Vec3::new(x + 8.0, 20.0, 14.0));
        let movers = [6.0, 9.0].map(|x| {
            let desc = ObjectDesc::dynamic(at(x)).occluder(at(x)).max_speed(1.0);
            scene.insert(desc.reported_on_expiry()).unwrap()
        });
        let ball = scene.fixed(Sphere::new(Vec3::new(11.5, 12.0, 18.0), 0.4));
        // A view beside both from so near that no volume fits.
        let away = Plane { normal: Vec3::NEG_Z, offset: 9.0 };
        let mut query = query_by(method);
        scene.begin_frame(0.0).unwrap();
        look(&mut scene, &mut query, &View::from_planes(Vec3::new(11.5, 12.0, 9.5), &[away]).unwrap());
        let due = scene.begin_frame(1.0).unwrap();
        assert!(movers.iter().all(|id| due.contains(id)));
        for id in movers {
            let far = Aabb::new(Vec3::new(1.0, 1.0, 20.0), Vec3::new(2.0, 2.0, 22.0));
            scene.update(id, far, Some(far.into())).unwrap();
        }
        let pvs = query.run(&scene, &around(Vec3::new(11.5, 12.5, 2.5)));
        assert!(pvs.contains(ball), "{method:?}");
        movers.iter().for_each(|&id| scene.remove(id).unwrap());
        assert_eq!(scene.dynamic_opacity().count(), 0);
    }
}

#[test]
fn an_eye_in_a_closed_mesh_sees_what_is_in_it_whatever_came_and_went() {
    for (abut, method) in
        [(false, Method::point()), (true, Method::point()), (false, Method::cell()), (true, Method::cell())]
    {
        let mut scene = empty();
        let Mesh { positions, triangles, .. } = Mesh::cuboid(Vec3::splat(2.3), Vec3::splat(12.3));
        scene.solid(mesh(positions, triangles));
        if abut {
            let slab = Aabb::new(Vec3::ONE, Vec3::new(14.0, 14.0, 2.6));
            scene.solid(slab);
        }
        let inside = scene.fixed(Sphere::new(Vec3::new(10.5, 10.5, 4.5), 0.1));
        let opaque = scene.static_opacity().count();
        // A solid at the eye comes and goes.
        let guest = scene.solid(Sphere::new(Vec3::splat(5.5), 0.9));
        scene.remove(guest).unwrap();
        assert_eq!(scene.static_opacity().count(), opaque);
        scene.begin_frame(0.1).unwrap();
        let mut query = query_by(method);
        let pvs = query.run(&scene, &around(Vec3::splat(5.6)));
        assert!(pvs.contains(inside), "{method:?}, a slab beside it: {abut}");
    }
}
