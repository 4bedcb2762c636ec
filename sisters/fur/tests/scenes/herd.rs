//! A herd that walks among walls: no tip in sight is lost.

use casca::{Aabb, ObjectId, Query, View};
use casca_fur::scenes::field::{Field, Kind, generated};
use casca_fur::scenes::import::{Coated, read_coated};
use casca_fur::scenes::sample::character_glb;
use casca_fur::scenes::{Character, Masks, Species};
use casca_fur::skin::Weights;
use casca_fur::strands::{Forces, Fur};
use glam::{Mat3, Vec3};

fn fur(radius: f32) -> Result<Fur, casca_fur::Error> {
    Fur::for_radius(radius, 0.08, 0.2)
}

fn forces() -> Forces {
    Forces { wind: Vec3::new(2.0, 0.0, 1.0), ..Forces::default() }
}

fn herd(count: usize, species: usize, seed: u64, forces: Forces) -> Result<Field, casca_fur::Error> {
    Field::new(count, generated(species, seed, fur)?, seed, Some(forces))
}

/// Whether a segment meets a box.
fn meets(from: Vec3, to: Vec3, aabb: &Aabb) -> bool {
    let way = to - from;
    let (a, b) = ((aabb.min - from) / way, (aabb.max - from) / way);
    let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
    enter <= leave && leave >= 0.0 && enter <= 1.0
}

/// Tips of an animal as it walks and leans now.
fn tips(field: &Field, animal: usize) -> Vec<Vec3> {
    let resident = &field.animals()[animal];
    let (kind, fur) = &field.species()[resident.species];
    let (mesh, weights) = (&kind.levels()[3], &kind.rig().unwrap().weights[3]);
    let (pose, lean) = (field.pose(animal).unwrap(), field.lean(animal));
    let tip = |(v, vertex): (usize, &casca_fur::mesh::Vertex)| {
        let m = resident.placement * weights.blend(v, pose);
        let bent = Fur { bend: lean.bend(fur.bend, Mat3::from(m.matrix3)), ..*fur };
        m.transform_point3(bent.extruded(vertex.position, vertex.normal, 1.0))
    };
    mesh.vertices().iter().enumerate().map(tip).collect()
}

#[test]
fn no_tip_in_sight_of_a_walking_herd_is_lost() {
    walk_among_walls(herd(200, 2, 3, forces()).unwrap());
}

fn character(seed: u64) -> Coated {
    read_coated(&character_glb(seed, 48).unwrap(), None).unwrap()
}

fn species(coated: &Coated) -> (Species, Fur) {
    let character = Character::new(coated, &Masks::default(), 4).unwrap();
    let species = Species::of_character(&character).unwrap();
    let fur = fur(species.radius()).unwrap();
    (species, fur)
}

#[test]
fn no_tip_in_sight_of_a_walking_herd_of_files_is_lost() {
    let own = [10, 11].map(|seed| species(&character(seed))).to_vec();
    let field = Field::new(200, own, 3, Some(forces())).unwrap();
    for (animal, resident) in field.animals().iter().enumerate() {
        let (kind, pose) = (&field.species()[resident.species].0, field.pose(animal).unwrap());
        let weights = &kind.rig().unwrap().weights[0];
        let heights = kind.levels()[0].vertices().iter().enumerate().map(|(v, vertex)| {
            let m = resident.placement * weights.blend(v, pose);
            m.transform_point3(vertex.position).y
        });
        let low = heights.fold(f32::INFINITY, f32::min);
        assert!((-0.02..0.05).contains(&low), "feet at {low}");
    }
    walk_among_walls(field);
}

#[test]
fn weights_that_are_not_those_of_the_levels_are_refused() {
    let whole = Character::new(&character(10), &Masks::default(), 3).unwrap();
    let refused = |change: fn(&mut Vec<Weights>)| {
        let mut character = whole.clone();
        change(&mut character.rig.as_mut().unwrap().weights);
        Species::of_character(&character).is_err()
    };
    assert!(!refused(|_| ()) && refused(|w| w.truncate(1)) && refused(Vec::clear));
    assert!(refused(|w| w.swap(0, 2)) && refused(|w| w.swap(1, 2)));
}

#[test]
fn standing_characters_are_as_long_as_a_unit_whatever_their_files_are_in() {
    let mut coated = character(10);
    coated.rig = None;
    coated.mesh.positions.iter_mut().for_each(|p| *p = 100.0 * *p + Vec3::Y * 900.0);
    let own = species(&coated);
    assert!(own.0.rig().is_none());
    let refused = Field::new(3, vec![own.clone()], 3, Some(forces()));
    assert!(matches!(refused, Err(casca_fur::Error::Still)));
    let mut field = Field::new(20, vec![own], 3, None).unwrap();
    for (animal, resident) in field.animals().iter().enumerate() {
        let (kind, fur) = &field.species()[0];
        let at = |p: Vec3| resident.placement.transform_point3(p);
        let Aabb { min, max } = kind.aabb();
        let length = at(max).distance(at(Vec3::new(min.x, max.y, max.z)));
        assert!((0.74..1.01).contains(&length) && at(min).y.abs() < 1e-4, "{length}, feet at {}", at(min).y);
        let fur_there = at(Vec3::Y * fur.height).distance(at(Vec3::ZERO));
        assert!((field.fur_height(animal) / fur_there - 1.0).abs() < 1e-3);
        let hides = field.scene.bounds(resident.id).unwrap().aabb();
        assert!(hides.contains(at(kind.aabb().center())));
    }
    // Those that move look ahead: along z of their file.
    let before = field.animals().to_vec();
    field.walk(0.05).unwrap();
    let mut moved = 0;
    for (old, new) in before.iter().zip(field.animals()) {
        let way = Vec3::from(new.placement.translation - old.placement.translation);
        let ahead = new.placement.transform_vector3(Vec3::Z).normalize();
        moved += usize::from(way.length() > 0.0);
        assert!(way.length() == 0.0 || way.normalize().dot(ahead) > 0.99, "{way} {ahead}");
    }
    assert!(moved > 4, "{moved}");
}

fn walk_among_walls(mut field: Field) {
    let mut query = Query::new();
    let (mut seen, mut in_sight, mut outside_of_rest) = (0, 0, 0);
    for frame in 0..5 {
        let time = 0.37 * f64::from(frame);
        field.scene.begin_frame(time).unwrap();
        field.walk(time).unwrap();
        let (eye, _) = field.eye(frame as f32 / 5.0);
        let visible: Vec<ObjectId> =
            query.run(&field.scene, &View::omnidirectional(eye).unwrap()).visible().to_vec();
        field.scene.end_frame([query.pvs()]).unwrap();
        seen += visible.iter().filter(|id| matches!(field.kind(**id), Some(Kind::Animal(_)))).count();
        for (animal, resident) in field.animals().iter().enumerate() {
            let bounds = field.scene.bounds(resident.id).unwrap().aabb();
            let (kind, fur) = &field.species()[resident.species];
            let rest = casca_fur::visibility::inflate(kind.aabb(), fur.reach(1.0));
            for tip in tips(&field, animal) {
                assert!(bounds.contains(tip), "frame {frame}: {tip} is outside of {bounds:?}");
                let own = resident.placement.inverse().transform_point3(tip);
                outside_of_rest += usize::from(!rest.contains(own));
                if field.walls().iter().any(|wall| meets(eye, tip, wall)) || meets(eye, tip, &field.ground())
                {
                    continue;
                }
                in_sight += 1;
                assert!(visible.contains(&resident.id), "frame {frame}: a tip at {tip} is lost");
            }
        }
    }
    println!(
        "{seen} of 1000 animals visible, {in_sight} tips in sight, {outside_of_rest} beyond the bounds at rest"
    );
    assert!(seen < 600 && in_sight > 5000 && outside_of_rest > 100);
}

#[test]
fn herds_repeat_walk_and_refuse_absurd_forces() {
    let make = || herd(6, 1, 7, forces()).unwrap();
    let (mut a, mut b) = (make(), make());
    a.walk(1.3).unwrap();
    b.walk(0.2).unwrap();
    assert!((0..6).all(|i| a.pose(i) != b.pose(i)));
    b.walk(1.3).unwrap();
    assert!((0..6).all(|i| a.pose(i) == b.pose(i) && a.lean(i) == b.lean(i) && a.lean(i).most > 0.0));
    assert_eq!((a.pose(6), a.lean(6).most), (None, 0.0));
    assert!(a.walk(f64::NAN).is_err());
    assert!(herd(6, 1, 7, Forces { most: 9.0, ..forces() }).is_err());
}
