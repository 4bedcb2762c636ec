//! Fields of animals that stand or walk among walls: no tip in sight is lost.

use casca::{Aabb, ObjectId, Query, View};
use casca_fur::Error;
use casca_fur::scenes::field::{Field, Kind};
use casca_fur::strands::{Forces, Fur};
use casca_fur::visibility::inflate;
use glam::{Affine3A, Mat3, Vec3};

/// The fur of animals, whose radius is about this.
fn fur() -> Fur {
    Fur::for_radius(0.7, 0.08, 0.2).unwrap()
}

fn forces() -> Forces {
    Forces { wind: Vec3::new(2.0, 0.0, 1.0), ..Forces::default() }
}

fn field(count: usize, species: usize, seed: u64, forces: Option<Forces>) -> Result<Field, Error> {
    Field::new(count, species, seed, fur(), forces)
}

/// Whether a segment meets a box.
fn meets(from: Vec3, to: Vec3, aabb: &Aabb) -> bool {
    let way = to - from;
    let (a, b) = ((aabb.min - from) / way, (aabb.max - from) / way);
    let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
    enter <= leave && leave >= 0.0 && enter <= 1.0
}

/// Tips of an animal as it stands, or walks and leans now.
fn tips(field: &Field, animal: usize) -> Vec<Vec3> {
    let resident = &field.animals()[animal];
    let (kind, fur) = (&field.species()[resident.species], fur());
    let tip = |(v, vertex): (usize, &casca_fur::mesh::Vertex)| {
        let (mut m, mut bent) = (resident.placement, fur);
        if let Some(pose) = field.pose(animal) {
            m *= kind.rig().weights[3].blend(v, pose);
            bent.bend = field.lean(animal).bend(fur.bend, Mat3::from(m.matrix3));
        }
        m.transform_point3(bent.extruded(vertex.position, vertex.normal, 1.0))
    };
    kind.levels()[3].vertices().iter().enumerate().map(tip).collect()
}

/// Walks along the path of a field of 200 animals. Returns how many animals are found visible of
/// 1,000, how many tips are in sight, and how many of them are outside of the bounds at rest.
fn walk_along(mut field: Field) -> [usize; 3] {
    let mut query = Query::new();
    let (mut seen, mut in_sight, mut outside_of_rest) = (0, 0, 0);
    for frame in 0..5 {
        let time = 0.37 * f64::from(frame);
        field.scene.begin_frame(time).unwrap();
        field.walk(time).unwrap();
        let ((eye, _), ground) = (field.eye(frame as f32 / 5.0), field.ground());
        let visible: Vec<ObjectId> =
            query.run(&field.scene, &View::omnidirectional(eye).unwrap()).visible().to_vec();
        field.scene.end_frame([query.pvs()]).unwrap();
        seen += visible.iter().filter(|id| matches!(field.kind(**id), Some(Kind::Animal(_)))).count();
        for (animal, resident) in field.animals().iter().enumerate() {
            let bounds = field.scene.bounds(resident.id).unwrap().aabb();
            let rest = inflate(field.species()[resident.species].aabb(), fur().reach(1.0));
            for tip in tips(&field, animal) {
                assert!(bounds.contains(tip), "frame {frame}: {tip} is outside of {bounds:?}");
                let own = resident.placement.inverse().transform_point3(tip);
                outside_of_rest += usize::from(!rest.contains(own));
                // Animals that stand hide others, too.
                let is_near = |place: Affine3A| {
                    let (way, middle) = (tip - eye, Vec3::from(place.translation));
                    let t = ((middle - eye).dot(way) / way.length_squared()).clamp(0.0, 1.0);
                    (eye + way * t).distance(middle) < 1.2
                };
                let is_before = field.pose(animal).is_none()
                    && field.animals().iter().any(|a| a.id != resident.id && is_near(a.placement));
                let mut solid = field.walls().iter().chain([&ground]);
                if is_before || solid.any(|solid| meets(eye, tip, solid)) {
                    continue;
                }
                in_sight += 1;
                assert!(visible.contains(&resident.id), "frame {frame}: a tip at {tip} is lost");
            }
        }
    }
    println!("{seen} animals found, {in_sight} tips in sight, {outside_of_rest} beyond the bounds at rest");
    [seen, in_sight, outside_of_rest]
}

#[test]
fn walls_hide_most_animals_that_stand_and_no_tip_in_sight() {
    let [seen, in_sight, _] = walk_along(field(200, 2, 3, None).unwrap());
    assert!(seen < 500 && in_sight > 300);
}

#[test]
fn no_tip_in_sight_of_a_walking_herd_is_lost() {
    let [seen, in_sight, outside_of_rest] = walk_along(field(200, 2, 3, Some(forces())).unwrap());
    assert!(seen < 600 && in_sight > 5000 && outside_of_rest > 100);
}

#[test]
fn fields_repeat_and_know_their_objects() {
    let make = |seed| field(31, 3, seed, None).unwrap();
    let (a, b, c) = (make(1), make(1), make(2));
    let places = |f: &Field| f.animals().iter().map(|a| a.placement).collect::<Vec<_>>();
    assert!(places(&a) == places(&b) && a.walls() == b.walls());
    assert!(places(&a) != places(&c));
    assert_eq!(a.scene.len(), 31 + 1 + a.walls().len());
    let kinds: Vec<_> = a.scene.ids().map(|id| a.kind(id).unwrap()).collect();
    let count = |f: fn(&Kind) -> bool| kinds.iter().filter(|k| f(k)).count();
    assert_eq!(count(|k| matches!(k, Kind::Animal(_))), 31);
    assert_eq!(count(|k| matches!(k, Kind::Wall(_))), a.walls().len());
    for (number, resident) in a.animals().iter().enumerate() {
        assert_eq!(a.kind(resident.id), Some(Kind::Animal(number)));
        // Feet on the ground, within the lot.
        let kind = &a.species()[resident.species];
        let feet = resident.placement.transform_point3(Vec3::Y * kind.aabb().min.y);
        assert!(feet.y.abs() < 1e-5 && feet.x > 0.0 && feet.z > 0.0);
    }
    assert_eq!(c.kind(a.animals()[0].id), None);
}

#[test]
fn herds_repeat_and_walk_and_absurd_fields_are_refused() {
    let make = || field(6, 1, 7, Some(forces())).unwrap();
    let (mut a, mut b) = (make(), make());
    a.walk(1.3).unwrap();
    b.walk(0.2).unwrap();
    assert!((0..6).all(|i| a.pose(i) != b.pose(i)));
    b.walk(1.3).unwrap();
    assert!((0..6).all(|i| a.pose(i) == b.pose(i) && a.lean(i) == b.lean(i) && a.lean(i).most > 0.0));
    assert_eq!((a.pose(6), a.lean(6).most), (None, 0.0));
    assert!(a.walk(f64::NAN).is_err() && a.eye(f32::NAN).0.is_finite());
    assert!(field(6, 1, 7, Some(Forces { most: 9.0, ..forces() })).is_err());
    for (count, species) in [(0, 1), (100_001, 1), (1, 0), (1, 17)] {
        assert!(matches!(field(count, species, 1, None), Err(Error::Range { .. })));
    }
    assert!(Field::new(1, 1, 1, Fur { height: -1.0, ..fur() }, None).is_err());
}
