//! Calls that are refused change nothing; those that are taken do all that they say.

use casca_server::casca::glam::Vec3;
use casca_server::casca::{Aabb, GridSpec, ObjectDesc, Scene};
use casca_server::{ClientDesc, EntityDesc, ServerOptions, VisibilityServer};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// A field of 32 m with a wall across its middle.
fn server(options: ServerOptions) -> VisibilityServer {
    let field = Aabb::new(Vec3::ZERO, Vec3::splat(32.0));
    let mut level = Scene::new(&GridSpec::covering(field, 1.0).unwrap()).unwrap();
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 16.0), Vec3::new(32.0, 12.0, 17.0));
    level.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
    VisibilityServer::new(level, options).unwrap()
}

fn eye(z: f32) -> Vec3 {
    Vec3::new(16.0, 1.7, z)
}

fn person(x: f32, z: f32) -> Aabb {
    Aabb::from_center(Vec3::new(x, 0.9, z), Vec3::new(0.4, 0.9, 0.4))
}

#[test]
fn calls_that_are_refused_change_nothing_and_others_do_all_they_say() {
    let (mut refused, mut taken) = ([0; 7], [0; 7]);
    for seed in 0..60 {
        let mut random = SmallRng::seed_from_u64(seed);
        let options = ServerOptions::new().most(3, 6);
        // Some ids are of another server.
        let mut other = server(ServerOptions::new());
        let mut server = server(options);
        let mut clients = vec![other.add_client(ClientDesc::new(eye(1.0), 1.0, 0.0), 0.0).unwrap()];
        let mut entities = vec![other.add_entity(EntityDesc::new(person(1.0, 1.0), 1.0), 0.0).unwrap()];
        let mut now = 0.0;
        for _ in 0..80 {
            let before = format!("{server:?}");
            let (client, entity) = (
                clients[random.random_range(0..clients.len())],
                entities[random.random_range(0..entities.len())],
            );
            let number = [f32::NAN, -1.0, 0.0, 1.0, 2.0, 20.0][random.random_range(0..6)];
            let place = person(20.0, 20.0 + number);
            now += 0.01 * f64::from(random.random_range(-1..5i8));
            let call = random.random_range(0..7);
            let result = match call {
                0 => {
                    server.add_client(ClientDesc::new(eye(9.0), number, 0.1), now).map(|id| clients.push(id))
                }
                1 => server.remove_client(client),
                2 => server.move_eye(client, eye(number), now),
                3 => {
                    let desc = EntityDesc::new(place, if random.random_bool(0.5) { number } else { 0.0 });
                    let desc = if random.random_bool(0.2) { desc.owner(client) } else { desc };
                    server.add_entity(desc, now).map(|id| entities.push(id))
                }
                4 => server.move_entity(entity, place, now),
                5 => server.remove_entity(entity),
                _ => server.tick(now).map(|_| ()),
            };
            match result {
                Ok(()) => taken[call] += 1,
                Err(why) => {
                    refused[call] += 1;
                    assert_eq!(format!("{server:?}"), before, "{seed}: call {call}, {why}");
                }
            }
        }
        for id in entities {
            let is_there = server.entity(id).is_ok();
            assert_eq!(server.remove_entity(id).is_ok(), is_there, "{seed}");
            assert!(server.entity(id).is_err());
        }
        assert_eq!(server.entities().count(), 0, "{seed}");
    }
    assert!(refused.iter().chain(&taken).all(|count| *count > 10), "{refused:?} {taken:?}");
}

#[test]
fn who_was_not_reported_for_ages_may_be_anywhere() {
    let mut server = server(ServerOptions::new());
    let client = server.add_client(ClientDesc::new(eye(10.0), 1.0, 0.1), 0.0).unwrap();
    let entity = server.add_entity(EntityDesc::new(person(16.0, 30.0), 1e5), -1e300).unwrap();
    for now in [0.0, 1e9, 1e300] {
        server.tick(now).unwrap();
        assert_eq!(server.answer(client).unwrap().told, [entity]);
    }
}
