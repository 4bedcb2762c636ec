//! Places that the camera does not see receive no shadows, so that a large ground does not make
//! everything a caster.

use crate::common::*;
use crate::scenes::{ABOVE, ahead, solid};

/// A ground with a wall across the view, crates behind the wall, and a tower behind them.
struct Walled {
    scene: Scene,
    ground: ObjectId,
    wall: ObjectId,
    crates: Vec<ObjectId>,
    tower: ObjectId,
}

fn walled() -> Walled {
    let mut scene = empty();
    let ground = solid(&mut scene, [0.0, 0.0, 0.0], [64.0, 1.0, 64.0]);
    let wall = solid(&mut scene, [0.0, 1.0, 30.0], [64.0, 12.0, 32.0]);
    let tower = solid(&mut scene, [30.0, 1.0, 24.0], [34.0, 31.0, 28.0]);
    let places = (0..24).map(|i| Vec3::new(18.0 + (i % 8) as f32 * 4.0, 1.0, 12.0 + (i / 8) as f32 * 4.0));
    let crates = places.map(|p| solid(&mut scene, p.to_array(), (p + Vec3::splat(2.0)).to_array())).collect();
    Walled { scene, ground, wall, crates, tower }
}

impl Walled {
    fn casters(&self, camera: &Query, sun: Method, light: &Light) -> Vec<ObjectId> {
        let (mut sun, mut out) = (query_by(sun), Vec::new());
        sun.shadow_casters(&self.scene, camera, light, &mut out).unwrap();
        out
    }

    fn crates_in(&self, casters: &[ObjectId]) -> usize {
        self.crates.iter().filter(|id| casters.contains(id)).count()
    }
}

#[test]
fn a_large_ground_does_not_make_everything_a_caster() {
    let walled = walled();
    let mut camera = Query::new();
    let seen = camera.run(&walled.scene, &ahead()).visible().to_vec();
    assert!(seen.contains(&walled.ground) && seen.contains(&walled.wall) && seen.len() == 2, "{seen:?}");
    for sun in [Method::point(), Method::cell(), Method::Frustum] {
        let found = walled.casters(&camera, sun, &ABOVE);
        assert!(found.contains(&walled.ground) && found.contains(&walled.wall), "{found:?}");
        assert_eq!(walled.crates_in(&found), 0, "{sun:?}: their shadows fall on hidden ground");
        assert!(!found.contains(&walled.tower), "{sun:?}: so does the tower's at noon");
    }
    // In the evening its shadow falls over the wall.
    let evening = Light::directional(Vec3::new(0.0, -2.0, 1.0));
    let found = walled.casters(&camera, Method::point(), &evening);
    assert!(found.contains(&walled.tower) && walled.crates_in(&found) == 0, "{found:?}");
    // A lamp behind the wall shines through nothing but the wall and the tower; one above it shines
    // past the tower too.
    let bulb = |y| Light::point(Vec3::new(32.0, y, 22.0), 60.0);
    for y in [5.0, 31.5] {
        let found = walled.casters(&camera, Method::point(), &bulb(y));
        assert!(found.contains(&walled.wall) && walled.crates_in(&found) == 0, "{y}: {found:?}");
    }
}

#[test]
fn other_methods_and_old_results_mask_nothing() {
    let mut walled = walled();
    let mut camera = query_by(Method::Frustum);
    camera.run(&walled.scene, &ahead());
    let all = walled.crates.len();
    assert_eq!(walled.crates_in(&walled.casters(&camera, Method::point(), &ABOVE)), all);
    camera.set_method(Method::point()).unwrap();
    assert_eq!(
        walled.crates_in(&walled.casters(&camera, Method::point(), &ABOVE)),
        all,
        "a method that has not run has drawn nothing"
    );
    camera.run(&walled.scene, &ahead());
    assert_eq!(walled.crates_in(&walled.casters(&camera, Method::point(), &ABOVE)), 0);
    // Without the wall, the ground behind it comes into sight.
    walled.scene.remove(walled.wall).unwrap();
    assert_eq!(walled.crates_in(&walled.casters(&camera, Method::point(), &ABOVE)), all);
    camera.run(&walled.scene, &ahead());
    let behind_the_tower = 4;
    let seen = walled.crates_in(&walled.casters(&camera, Method::point(), &ABOVE));
    assert!((all - behind_the_tower..=all).contains(&seen), "{seen}");
}

#[test]
fn the_query_of_a_light_stands_for_no_view() {
    let walled = walled();
    let (mut camera, mut sun, mut out) = (Query::new(), Query::new(), Vec::new());
    camera.run(&walled.scene, &ahead());
    let spot = Light::spot(ahead());
    sun.shadow_casters(&walled.scene, &camera, &spot, &mut out).unwrap();
    // For a light at the camera, only objects that it sees come before objects that it sees.
    assert_eq!(out, camera.pvs().visible());
    assert!(camera.pvs().is_valid_for(&walled.scene, &ahead()));
    assert!(!sun.pvs().is_valid_for(&walled.scene, &ahead()), "objects beside all receivers are left out");
    // As a camera, its buffers count for nothing: they hide what lies before no receiver.
    let again = walled.casters(&sun, Method::point(), &ABOVE);
    assert!(again.contains(&walled.ground) && walled.crates_in(&again) == walled.crates.len(), "{again:?}");
}
