//! Frames that are sound arrive as they were sent; all others are refused, whatever they are.

use casca_server::casca::Aabb;
use casca_server::casca::glam::Vec3;
use casca_server::session::{Event, Limits, Refusal, Session, Token};
use casca_server::wire::{AnswerFrame, MOST_FRAME, ToClient, ToServer, WireError};
use casca_truth::places::points;
use proptest::prelude::*;

fn place() -> impl Strategy<Value = Vec3> {
    points(-1e6..1e6, 2.5e5)
}

fn answers() -> impl Strategy<Value = AnswerFrame> {
    let keys = prop::collection::vec(any::<u64>(), 0..20);
    let new = prop::collection::vec((any::<u64>(), place(), place()), 0..20);
    let moved = prop::collection::vec((any::<u64>(), place()), 0..20);
    (any::<u64>(), any::<bool>(), keys, new, moved).prop_map(|(tick, fresh, forgotten, new, moved)| {
        let new = new.into_iter().map(|(key, min, max)| (key, Aabb::new(min, max))).collect();
        AnswerFrame { tick, fresh, forgotten, new, moved }
    })
}

fn session() -> Session {
    Session::new(Token::new("secret").unwrap(), Limits::default(), 0.0)
}

proptest! {
    #![proptest_config(casca_truth::cases(500))]
    #[test]
    fn frames_arrive_as_they_were_sent(
        (token, latency) in (prop::collection::vec(any::<u8>(), 0..64), any::<u16>()),
        (sequence, eye, number, answer) in (any::<u32>(), place(), any::<u64>(), answers()),
    ) {
        for frame in [ToServer::Hello { token: &token, latency }, ToServer::Eye { sequence, eye }, ToServer::Ping(number)] {
            let bytes = frame.encode();
            prop_assert!(bytes.len() <= MOST_FRAME);
            prop_assert_eq!(ToServer::decode(&bytes), Ok(frame));
            for end in 0..bytes.len() {
                prop_assert!(ToServer::decode(&bytes[..end]).is_err());
            }
            let longer = [bytes, vec![0]].concat();
            prop_assert_eq!(ToServer::decode(&longer), Err(WireError::Trailing(1)));
        }
        let welcome = ToClient::Welcome { client: number, entity: 2, tick: sequence, speed: 5.0, eye };
        for frame in [welcome, ToClient::Answer(answer), ToClient::Pong(number), ToClient::Bye(3)] {
            let bytes = frame.encode();
            prop_assert_eq!(ToClient::decode(&bytes), Ok(frame));
            prop_assert!(ToClient::decode(&bytes[..bytes.len() - 1]).is_err());
        }
    }

    #[test]
    fn garbage_ends_a_session_and_nothing_else(
        frames in prop::collection::vec((prop::collection::vec(any::<u8>(), 0..160), 0u8..6, 0.0f64..0.1), 0..60),
        joins in any::<bool>(),
    ) {
        let mut session = session();
        let mut now = 0.0;
        if joins {
            let hello = ToServer::Hello { token: b"secret", latency: 9 }.encode();
            prop_assert_eq!(session.take(&hello, 0.0), Ok(Event::Join { latency: 0.009 }));
        }
        for (mut frame, kind, passed) in frames {
            now += passed;
            // Most begin as a frame does.
            if let Some(first) = frame.first_mut().filter(|_| kind < 4) {
                *first = kind;
            }
            match session.take(&frame, now) {
                Ok(Event::Eye(eye)) => prop_assert!(joins && eye.is_finite()),
                Ok(Event::Join { .. }) => prop_assert!(false, "no garbage holds the token"),
                Ok(_) => prop_assert!(joins),
                Err(_) => break,
            }
            let _ = ToClient::decode(&frame);
        }
        prop_assert_eq!(session.has_joined(), joins);
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let hello = ToServer::Hello { token: b"secret", latency: 100 }.encode();
    let changed = |at: usize, with: u8| {
        let mut bytes = hello.clone();
        bytes[at] = with;
        ToServer::decode(&bytes).unwrap_err()
    };
    assert_eq!(changed(0, 9), WireError::Kind(9));
    assert_eq!(changed(1, b'X'), WireError::Magic);
    assert_eq!(changed(5, 2), WireError::Version(2));
    assert_eq!(changed(9, 65), WireError::Token(65));
    assert_eq!(ToServer::decode(&[0; 200]), Err(WireError::Long(200)));
    assert_eq!(ToServer::decode(&[]), Err(WireError::Short(0)));
    for eye in [Vec3::NAN, Vec3::X * f32::INFINITY, Vec3::Y * 2e6] {
        assert_eq!(ToServer::decode(&ToServer::Eye { sequence: 1, eye }.encode()), Err(WireError::Place));
    }
}

#[test]
fn sessions_need_the_token_first_and_once() {
    let hello = |token: &[u8]| ToServer::Hello { token, latency: 900 }.encode();
    let eye = |sequence| ToServer::Eye { sequence, eye: Vec3::ONE }.encode();
    assert_eq!(session().take(&eye(1), 0.0), Err(Refusal::Order));
    for wrong in [b"".as_slice(), b"secre", b"secret!", b"Secret"] {
        assert_eq!(session().take(&hello(wrong), 0.0), Err(Refusal::Token));
    }
    let mut session = session();
    assert_eq!(session.deadline(), 5.0);
    assert_eq!(
        session.take(&hello(b"secret"), 1.0),
        Ok(Event::Join { latency: 0.25 }),
        "no more is believed"
    );
    assert_eq!(session.deadline(), 11.0);
    assert_eq!(session.take(&eye(5), 1.1), Ok(Event::Eye(Vec3::ONE)));
    assert_eq!(session.take(&eye(5), 1.2), Ok(Event::Old));
    assert_eq!(session.take(&eye(4), 1.2), Ok(Event::Old));
    assert_eq!(session.take(&ToServer::Ping(7).encode(), 1.2), Ok(Event::Ping(7)));
    assert_eq!(session.take(&hello(b"secret"), 1.3), Err(Refusal::Order));
    assert_eq!(format!("{:?}", Token::new("secret").unwrap()), "Token");
    assert!(Token::new("").is_none() && Token::new([0; 65]).is_none());
}

#[test]
fn floods_end_a_session() {
    let mut session = session();
    session.take(&ToServer::Hello { token: b"secret", latency: 0 }.encode(), 0.0).unwrap();
    let ping = ToServer::Ping(0).encode();
    // 100 a second for a minute are fine.
    assert!((0..6000).all(|i| session.take(&ping, f64::from(i) * 0.01).is_ok()));
    let many = (0..200).find(|_| session.take(&ping, 60.0).is_err());
    assert!(many.is_some_and(|many| many > 30), "{many:?}");
    assert_eq!(session.take(&ping, 60.0), Err(Refusal::Flood));
}
