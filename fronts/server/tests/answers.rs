//! Answers: who is told of whom, and what calls are refused: those change nothing.

use std::collections::BTreeSet;

use casca_server::bots::{Level, Match};
use casca_server::casca::glam::Vec3;
use casca_server::casca::{Aabb, ObjectDesc, Scene};
use casca_server::{
    Answer, ClientDesc, ClientId, EntityDesc, EntityId, ServerError, ServerOptions, VisibilityServer,
};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// A field of 64 m with a wall across its middle, at z from 32 to 33.
fn field() -> Scene {
    let all = Aabb::new(Vec3::new(0.0, -1.0, 0.0), Vec3::new(64.0, 12.0, 64.0));
    let mut level = Scene::new(1.0).unwrap();
    let ground = Aabb::new(all.min, Vec3::new(64.0, 0.0, 64.0));
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 32.0), Vec3::new(64.0, 12.0, 33.0));
    for solid in [ground, wall] {
        level.insert(ObjectDesc::fixed(solid).occluder(solid)).unwrap();
    }
    level
}

fn server(options: ServerOptions) -> VisibilityServer {
    VisibilityServer::new(field(), options).unwrap()
}

fn eye(z: f32) -> Vec3 {
    Vec3::new(32.0, 1.7, z)
}

fn person(x: f32, z: f32) -> Aabb {
    Aabb::from_center(Vec3::new(x, 0.95, z), Vec3::new(0.4, 0.9, 0.4))
}

fn told(server: &VisibilityServer, client: ClientId) -> Vec<EntityId> {
    server.answer(client).unwrap().told.clone()
}

#[test]
fn own_entities_and_those_of_the_team_are_told_behind_walls() {
    let mut server = server(ServerOptions::new());
    let desc = ClientDesc::new(eye(20.0), 5.0, 0.1);
    let (red, other) = (server.add_client(desc.team(1), 0.0).unwrap(), server.add_client(desc, 0.0).unwrap());
    let behind = |x| EntityDesc::new(person(x, 50.0), 5.0);
    let own = server.add_entity(behind(20.0).owner(red), 0.0).unwrap();
    let of_team = server.add_entity(behind(25.0).team(1), 0.0).unwrap();
    let enemy = server.add_entity(behind(30.0).team(2), 0.0).unwrap();
    server.tick(0.0).unwrap();
    assert_eq!(told(&server, red), [own, of_team]);
    assert_eq!(told(&server, other), []);
    // A hook adds those that are heard.
    let hears = |(client, _): (ClientId, &ClientDesc), (entity, desc): (EntityId, &EntityDesc)| {
        client == other && entity == enemy && desc.team == Some(2)
    };
    server.tick_with(0.1, hears).unwrap();
    assert_eq!(server.answer(other).unwrap().new, [enemy]);
    server.tick(0.2).unwrap();
    assert_eq!(server.answer(other).unwrap().forgotten, [enemy]);
    // The entity of one who left is nobody's, and hidden.
    server.remove_client(red).unwrap();
    let red = server.add_client(desc.team(1), 0.2).unwrap();
    server.tick(0.3).unwrap();
    assert_eq!(told(&server, red), [of_team]);
}

#[test]
fn an_eye_that_jumps_gets_a_fresh_answer_in_the_same_tick() {
    let mut server = server(ServerOptions::new());
    let client = server.add_client(ClientDesc::new(eye(20.0), 5.0, 0.1), 0.0).unwrap();
    let [here, there] =
        [10.0, 60.0].map(|z| server.add_entity(EntityDesc::new(person(32.0, z), 5.0), 0.0).unwrap());
    server.tick(0.0).unwrap();
    assert!(server.answer(client).unwrap().is_fresh, "the first one");
    server.move_eye(client, eye(20.1), 0.03).unwrap();
    server.tick(0.03).unwrap();
    let walked = server.answer(client).unwrap();
    assert!(!walked.is_fresh && walked.told == [here] && walked.new.is_empty());
    server.move_eye(client, eye(50.0), 0.06).unwrap();
    server.tick(0.06).unwrap();
    let Answer { told, new, forgotten, is_fresh, .. } = server.answer(client).unwrap();
    assert_eq!((told, new, forgotten, is_fresh), (&vec![there], &vec![there], &vec![here], &true));
}

#[test]
fn reports_that_are_late_widen_the_reach_until_a_client_is_stale() {
    let mut server = server(ServerOptions::new().tick(0.05).most_age(0.5));
    let client = server.add_client(ClientDesc::new(eye(20.0), 4.0, 0.1), 0.0).unwrap();
    let reach = |server: &mut VisibilityServer, now| {
        server.tick(now).unwrap();
        let answer = server.answer(client).unwrap();
        (answer.reach, answer.is_stale)
    };
    for (now, expected, stale) in [(0.0, 0.6, false), (0.25, 1.6, false), (0.5, 2.6, false), (9.0, 2.6, true)]
    {
        let (reach, is_stale) = reach(&mut server, now);
        assert!((reach - expected).abs() < 1e-6 && is_stale == stale, "{now}: {reach}");
    }
    server.move_eye(client, eye(20.0), 9.0).unwrap();
    assert!(!reach(&mut server, 9.0).1);
}

#[test]
fn who_may_have_passed_a_door_before_it_closed_is_told() {
    // One runs towards the other.
    for (z, speed, far, fast) in [(50.0, 0.0, 39.0, 10.0), (39.0, 10.0, 50.0, 0.0)] {
        let mut server = server(ServerOptions::new());
        let wall = server.level().ids().last().unwrap();
        server.level_mut().remove(wall).unwrap();
        let client = server.add_client(ClientDesc::new(eye(z), speed, 0.05), 0.0).unwrap();
        let entity = server.add_entity(EntityDesc::new(person(32.0, far), fast), 0.0).unwrap();
        server.tick(0.0).unwrap();
        let door = Aabb::new(Vec3::new(0.0, 0.0, 40.0), Vec3::new(64.0, 12.0, 41.0));
        server.level_mut().insert(ObjectDesc::fixed(door).occluder(door)).unwrap();
        server.tick(0.2).unwrap();
        assert_eq!(told(&server, client), [entity]);
        server.move_eye(client, eye(z), 0.3).unwrap();
        server.move_entity(entity, person(32.0, far), 0.3).unwrap();
        server.tick(0.3).unwrap();
        assert_eq!(told(&server, client), [], "it stands before the door");
    }
}

#[test]
fn changes_of_the_level_count_from_the_next_tick_on() {
    let mut server = server(ServerOptions::new());
    let client = server.add_client(ClientDesc::new(eye(20.0), 2.0, 0.05), 0.0).unwrap();
    let far = server.add_entity(EntityDesc::new(person(32.0, 50.0), 2.0), 0.0).unwrap();
    server.tick(0.0).unwrap();
    assert!(told(&server, client).is_empty() && server.wall_count() > 3);
    assert!(server.has_wall_between(eye(30.0), eye(34.0)) && !server.has_wall_between(eye(30.0), eye(31.0)));
    let wall = server.level().ids().last().unwrap();
    server.level_mut().remove(wall).unwrap();
    server.tick(0.1).unwrap();
    assert_eq!(told(&server, client), [far]);
    // A door that closes.
    let door = Aabb::new(Vec3::new(0.0, 0.0, 40.0), Vec3::new(64.0, 12.0, 41.0));
    server.level_mut().insert(ObjectDesc::fixed(door).occluder(door)).unwrap();
    server.tick(0.2).unwrap();
    assert!(told(&server, client).is_empty());
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let level = Level::open("rooms").unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut game = Match::new(&level, 16, 1, [1.0; 2]).unwrap();
            let mut all = Vec::new();
            for _ in 0..40 {
                let answers = game.answer(|server, now| {
                    server.tick(now).map(|answers| answers.into_iter().cloned().collect::<Vec<Answer>>())
                });
                all.push(answers.unwrap().unwrap().into_iter().map(plain).collect::<Vec<_>>());
                game.advance();
            }
            all
        })
    };
    let one = run(1);
    assert!(one.iter().flatten().any(|answer| answer.1.len() < 16 && !answer.2.is_empty()));
    assert!(one == run(2) && one == run(3));
}

/// An answer without the number of its server.
type Plain = (u64, Vec<u64>, Vec<u64>, Vec<u64>, u64, [bool; 2]);

fn plain(answer: Answer) -> Plain {
    let keys = |list: &[EntityId]| list.iter().map(|id| id.key()).collect();
    let Answer { client, told, new, forgotten, reach, is_fresh, is_stale, .. } = &answer;
    let flags = [*is_fresh, *is_stale];
    (client.key(), keys(told), keys(new), keys(forgotten), reach.to_bits(), flags)
}

#[test]
fn what_is_new_and_forgotten_adds_up() {
    let level = Level::open("rooms").unwrap();
    let mut game = Match::new(&level, 16, 1, [1.0; 2]).unwrap();
    let mut known: std::collections::BTreeMap<ClientId, BTreeSet<EntityId>> = Default::default();
    let (mut came, mut went) = (0, 0);
    for tick in 0..90 {
        if tick % 20 == 19 {
            // One comes and one goes.
            let now = game.now_seconds();
            let gone = game.server.entities().last().unwrap().0;
            let added =
                game.server.add_entity(EntityDesc::new(level.track.body(level.track.path[tick]), 1.0), now);
            if tick > 40 {
                game.server.remove_entity(added.unwrap()).unwrap();
                assert!(game.server.entity(gone).is_ok());
            }
        }
        let answers = game.answer(|server, now| {
            server.tick(now).map(|answers| answers.into_iter().cloned().collect::<Vec<Answer>>())
        });
        for answer in answers.unwrap().unwrap() {
            let known = known.entry(answer.client).or_default();
            assert!(answer.told.is_sorted() && answer.new.is_sorted() && answer.forgotten.is_sorted());
            assert!(answer.forgotten.iter().all(|id| known.remove(id)));
            assert!(answer.new.iter().all(|id| known.insert(*id)));
            assert!(known.iter().eq(&answer.told));
            (came, went) = (came + answer.new.len(), went + answer.forgotten.len());
        }
        game.advance();
    }
    assert!(came > 100 && went > 50, "{came} {went}");
}

#[test]
fn bad_input_is_refused_and_changes_nothing() {
    let mut server = server(ServerOptions::new().most(2, 2));
    let desc = ClientDesc::new(eye(20.0), 5.0, 0.1);
    let client = server.add_client(desc, 0.0).unwrap();
    let entity = server.add_entity(EntityDesc::new(person(32.0, 10.0), 5.0), 0.0).unwrap();
    server.tick(0.0).unwrap();
    let before = server.answer(client).unwrap().clone();

    for bad in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
        assert!(matches!(server.set_motion(client, bad, 0.1), Err(ServerError::Range { .. })), "{bad}");
        assert!(matches!(server.set_motion(client, 5.0, bad), Err(ServerError::Range { .. })), "{bad}");
        assert!(matches!(server.set_speed(entity, bad), Err(ServerError::Range { .. })), "{bad}");
        assert!(server.add_client(ClientDesc::new(eye(1.0), bad, 0.1), 0.0).is_err());
        assert!(server.add_entity(EntityDesc::new(person(1.0, 1.0), bad), 0.0).is_err());
        if bad != -1.0 {
            assert!(
                matches!(server.move_eye(client, eye(bad), 0.1), Err(ServerError::Range { .. })),
                "{bad}"
            );
            assert!(server.move_entity(entity, person(bad, 1.0), 0.1).is_err());
        }
        for options in [ServerOptions::new().tick(bad), ServerOptions::new().most_age(bad)] {
            assert!(VisibilityServer::new(field(), options).is_err());
        }
    }
    let inverted = Aabb::new(Vec3::ONE, Vec3::ZERO);
    assert!(matches!(server.move_entity(entity, inverted, 0.1), Err(ServerError::Inverted(_))));
    for now in [f64::NAN, f64::INFINITY] {
        assert!(server.tick(now).is_err() && server.move_eye(client, eye(20.0), now).is_err());
        assert!(server.add_client(desc, now).is_err());
    }
    assert!(matches!(server.tick(-1.0), Err(ServerError::Backwards { .. })));
    assert!(matches!(server.move_eye(client, eye(20.0), -1.0), Err(ServerError::Backwards { .. })));

    // Ids of others, and of those that are gone.
    let mut other = self::server(ServerOptions::new());
    let stranger = other.add_client(desc, 0.0).unwrap();
    let strange = other.add_entity(EntityDesc::new(person(1.0, 1.0), 1.0), 0.0).unwrap();
    assert_eq!(server.move_eye(stranger, eye(1.0), 0.1), Err(ServerError::UnknownClient(stranger)));
    assert_eq!(server.remove_client(stranger), Err(ServerError::UnknownClient(stranger)));
    assert!(server.answer(stranger).is_err() && server.client(stranger).is_err());
    assert_eq!(server.remove_entity(strange), Err(ServerError::UnknownEntity(strange)));
    assert!(server.add_entity(EntityDesc::new(person(1.0, 1.0), 1.0).owner(stranger), 0.0).is_err());

    server.add_client(desc, 0.0).unwrap();
    let full = server.add_client(desc, 0.0).unwrap_err();
    assert_eq!(full, ServerError::Full { what: "clients", most: 2 });
    assert_eq!(full.to_string(), "there are 2 clients already, as many as the options allow");
    assert_eq!(server.answer(client).unwrap(), &before);
    server.tick(0.1).unwrap();
    assert_eq!(told(&server, client), [entity]);
    server.remove_entity(entity).unwrap();
    assert!(server.move_entity(entity, person(1.0, 1.0), 0.2).is_err());
    server.tick(0.2).unwrap();
    assert_eq!(server.answer(client).unwrap().forgotten, [entity]);
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
    let entity = server.add_entity(EntityDesc::new(person(16.0, 50.0), 1e5), -1e300).unwrap();
    for now in [0.0, 1e9, 1e300] {
        server.tick(now).unwrap();
        assert_eq!(server.answer(client).unwrap().told, [entity]);
    }
}
