//! Plays the frames of several connections, sane and insane, and a server that obeys them. Frames
//! that are read are written as they came, no connection gets in without the token, nothing that is
//! not finite gets through, and a server that refuses a call answers as before.
#![no_main]

use std::sync::OnceLock;

use arbitrary::Arbitrary;
use casca_server::casca::{Aabb, ObjectDesc, Scene};
use casca_server::session::{Event, Limits, Session, Token};
use casca_server::wire::{ToClient, ToServer};
use casca_server::{ClientDesc, ClientId, EntityDesc, EntityId, ServerOptions, VisibilityServer};
use glam::Vec3;
use libfuzzer_sys::fuzz_target;

#[derive(Debug, Arbitrary)]
enum Op {
    /// Bytes as they are.
    Raw(Vec<u8>),
    Hello {
        right: bool,
        latency: u16,
        token: [u8; 9],
    },
    Eye {
        sequence: u32,
        eye: [f32; 3],
    },
    Ping(u64),
    /// Another connection.
    Connect,
    Wait(u16),
    Add {
        at: [f32; 3],
        size: f32,
        speed: f32,
    },
    Move {
        which: u8,
        at: [f32; 3],
    },
    Remove(u8),
    Tick,
}

const SECRET: &[u8] = b"fuzzfuzz!";

fn level() -> &'static Scene {
    static LEVEL: OnceLock<Scene> = OnceLock::new();
    LEVEL.get_or_init(|| {
        let mut level = Scene::new(1.0).unwrap();
        for z in [-4.0, 4.0] {
            let wall = Aabb::new(Vec3::new(-16.0, -16.0, z), Vec3::new(12.0, 16.0, z + 0.5));
            level.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        }
        level
    })
}

fn connect(now: f64) -> (Session, Option<ClientId>) {
    (Session::new(Token::new(SECRET).unwrap(), Limits::default(), now), None)
}

fuzz_target!(|ops: Vec<Op>| {
    let mut server = VisibilityServer::new(level().clone(), ServerOptions::new().most(8, 16)).unwrap();
    let mut session = connect(0.0);
    let mut entities: Vec<EntityId> = Vec::new();
    let (mut now, mut ticks) = (0.0, 0);
    for op in ops.into_iter().take(200) {
        let frame = match op {
            Op::Raw(bytes) => bytes,
            Op::Hello { right, latency, token } => {
                let token = if right { SECRET } else { &token };
                ToServer::Hello { token, latency }.encode()
            }
            Op::Eye { sequence, eye } => ToServer::Eye { sequence, eye: eye.into() }.encode(),
            Op::Ping(number) => ToServer::Ping(number).encode(),
            Op::Connect => {
                session = connect(now);
                continue;
            }
            Op::Wait(ms) => {
                now += f64::from(ms) / 1000.0;
                continue;
            }
            Op::Add { at, size, speed } => {
                let at = Vec3::from(at);
                let desc = EntityDesc::new(Aabb::new(at, at + size), speed);
                entities.extend(server.add_entity(desc, now));
                continue;
            }
            Op::Move { which, at } => {
                if let Some(id) = entities.get(usize::from(which)) {
                    let _ = server.move_entity(*id, Aabb::from_center(at.into(), Vec3::splat(0.4)), now);
                }
                continue;
            }
            Op::Remove(which) => {
                if let Some(id) = entities.get(usize::from(which)) {
                    let _ = server.remove_entity(*id);
                }
                continue;
            }
            Op::Tick => {
                // Ticks cost more than the rest.
                ticks += 1;
                if ticks <= 20 {
                    for answer in server.tick(now).unwrap() {
                        assert!(answer.told.is_sorted() && answer.reach.is_finite());
                    }
                }
                continue;
            }
        };
        if let Ok(read) = ToServer::decode(&frame) {
            assert_eq!(read.encode(), frame);
        }
        if let Ok(read) = ToClient::decode(&frame) {
            let _ = read.encode();
        }
        let (state, client) = &mut session;
        match state.take(&frame, now) {
            Ok(Event::Join { latency }) => {
                assert!(matches!(ToServer::decode(&frame), Ok(ToServer::Hello { token: SECRET, .. })));
                *client = server.add_client(ClientDesc::new(Vec3::ZERO, 5.0, latency), now).ok();
            }
            Ok(Event::Eye(eye)) => {
                assert!(eye.is_finite() && state.has_joined());
                if let Some(client) = client {
                    server.move_eye(*client, eye, now).unwrap();
                }
            }
            Ok(_) => {}
            Err(_) => {
                if let Some(client) = client.take() {
                    server.remove_client(client).unwrap();
                }
                session = connect(now);
            }
        }
    }
});
