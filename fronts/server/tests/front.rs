//! The front on the loopback: clients that behave are answered whatever others do.

use std::time::Duration;

use casca_server::bots::Level;
use casca_server::casca::glam::Vec3;
use casca_server::net::{Front, FrontOptions};
use casca_server::session::Token;
use casca_server::wire::{AnswerFrame, ToClient, ToServer};
use futures_util::{SinkExt, StreamExt};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpSocket, TcpStream};
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, client_async, connect_async};

type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

/// All that a test waits for comes within this.
const LONGEST: Duration = Duration::from_secs(120);

fn options() -> FrontOptions {
    let mut options = FrontOptions::new(Token::new("open sesame").unwrap());
    options.bots = 6;
    options
}

async fn start(options: FrontOptions) -> Front {
    let level = tokio::task::spawn_blocking(|| Level::open("rooms").unwrap()).await.unwrap();
    Front::start(level, options).await.unwrap()
}

async fn connect(front: &Front) -> Socket {
    timeout(LONGEST, connect_async(format!("ws://{}/", front.clients()))).await.unwrap().unwrap().0
}

async fn send(socket: &mut Socket, frame: &ToServer<'_>) {
    socket.send(Message::binary(frame.encode())).await.unwrap();
}

/// The next frame; `None` at the end of the connection.
async fn next(socket: &mut Socket) -> Option<ToClient> {
    loop {
        match timeout(LONGEST, socket.next()).await.expect("the server says something") {
            Some(Ok(Message::Binary(bytes))) => return Some(ToClient::decode(&bytes).unwrap()),
            Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
            Some(Ok(_)) => {}
        }
    }
}

/// Comes in; returns the own entity, and where the eye is.
async fn join(front: &Front) -> (Socket, u64, Vec3) {
    let mut socket = connect(front).await;
    send(&mut socket, &ToServer::Hello { token: b"open sesame", latency: 50 }).await;
    let Some(ToClient::Welcome { entity, eye, .. }) = next(&mut socket).await else { panic!("no welcome") };
    (socket, entity, eye)
}

async fn answer(socket: &mut Socket) -> AnswerFrame {
    loop {
        match next(socket).await.expect("the connection lasts") {
            ToClient::Answer(answer) => return answer,
            _ => continue,
        }
    }
}

/// The number of the last frame, if it is a farewell.
async fn farewell(socket: &mut Socket) -> Option<u8> {
    let mut code = None;
    while let Some(frame) = next(socket).await {
        if let ToClient::Bye(reason) = frame {
            code = Some(reason);
        }
    }
    code
}

/// A number among the metrics.
fn metric(front: &Front, name: &str) -> f64 {
    let text = front.metrics();
    let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name} in {text}"));
    line.rsplit(' ').next().unwrap().parse().unwrap()
}

/// Waits until something is so: for two minutes at most, since the machine may be busy.
async fn until(what: &str, is: impl Fn() -> bool) {
    for _ in 0..2400 {
        if is() {
            return;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("{what} does not come");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_is_told_of_itself_and_of_changes() {
    let front = start(options()).await;
    let (mut socket, own, eye) = join(&front).await;
    let first = answer(&mut socket).await;
    assert!(first.fresh && first.moved.is_empty());
    assert!(first.new.iter().any(|(key, b)| *key == own && b.contains(eye)));
    let mut known: std::collections::BTreeSet<u64> = first.new.iter().map(|(key, _)| *key).collect();
    for sequence in 1..40 {
        send(&mut socket, &ToServer::Eye { sequence, eye }).await;
        let answer = answer(&mut socket).await;
        assert!(!answer.fresh && answer.tick > first.tick);
        assert!(answer.forgotten.iter().all(|key| known.remove(key)));
        assert!(answer.new.iter().all(|(key, _)| known.insert(*key)));
        let moved: std::collections::BTreeSet<u64> = answer.moved.iter().map(|(key, _)| *key).collect();
        assert!(known.iter().all(|key| moved.contains(key) || answer.new.iter().any(|new| new.0 == *key)));
        assert!(known.contains(&own));
    }
    send(&mut socket, &ToServer::Ping(77)).await;
    while next(&mut socket).await != Some(ToClient::Pong(77)) {}
    // An eye that goes too far, or through a wall, is not believed.
    assert_eq!(metric(&front, "casca_refused_moves_total"), 0.0);
    send(&mut socket, &ToServer::Eye { sequence: 99, eye: eye + Vec3::X * 1000.0 }).await;
    until("the refusal", || metric(&front, "casca_refused_moves_total") >= 1.0).await;
    // It runs across the rooms until a wall stops it.
    let mut at = eye;
    for sequence in 100..220 {
        at += Vec3::new(0.1, 0.0, 0.1);
        send(&mut socket, &ToServer::Eye { sequence, eye: at }).await;
        let told = answer(&mut socket).await;
        let own_place = told.moved.iter().find(|(key, _)| *key == own).unwrap().1;
        assert!((own_place.x - at.x).abs() < 12.0);
        if metric(&front, "casca_refused_moves_total") >= 4.0 {
            break;
        }
    }
    assert!(metric(&front, "casca_refused_moves_total") >= 4.0 && at.distance(eye) > 0.5);
    front.stop().await;
    assert_eq!(farewell(&mut socket).await, Some(8));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bad_clients_lose_their_connection_and_others_miss_no_tick() {
    let mut options = options();
    (options.connections, options.queue) = (12, 8);
    (options.limits.hello, options.limits.idle) = (0.5, 20.0);
    let front = start(options).await;
    let (mut good, ..) = join(&front).await;
    let mut last = answer(&mut good).await.tick;

    // Garbage, texts, frames that are too long, a wrong token, and frames out of order.
    let eye = ToServer::Eye { sequence: 1, eye: Vec3::ZERO }.encode();
    let wrong = ToServer::Hello { token: b"open sesamf", latency: 1 }.encode();
    let bad = [
        (Message::binary(vec![0xee; 40]), Some(1)),
        (Message::text("hello"), Some(1)),
        (Message::binary(wrong), Some(2)),
        (Message::binary(eye), Some(3)),
    ];
    for (message, code) in bad {
        let mut socket = connect(&front).await;
        socket.send(message).await.unwrap();
        assert_eq!(farewell(&mut socket).await, code);
    }
    let mut socket = connect(&front).await;
    let _ = socket.send(Message::binary(vec![1; 100_000])).await;
    farewell(&mut socket).await;

    // No WebSocket at all, and half open: neither says anything.
    let mut raw = TcpStream::connect(front.clients()).await.unwrap();
    raw.write_all(b"GET / HTTP/1.1\r\n\r\n\x00\xff\xff").await.unwrap();
    let mut rest = Vec::new();
    let _ = timeout(LONGEST, raw.read_to_end(&mut rest)).await.expect("the connection ends");
    let mut silent = TcpStream::connect(front.clients()).await.unwrap();
    let ended = timeout(LONGEST, silent.read(&mut [0; 16])).await.expect("the connection ends");
    assert!(matches!(ended, Ok(0) | Err(_)));
    let mut mute = connect(&front).await;
    assert_eq!(farewell(&mut mute).await, Some(5));

    // A flood.
    let (mut flood, ..) = join(&front).await;
    for _ in 0..500 {
        if flood.send(Message::binary(ToServer::Ping(1).encode())).await.is_err() {
            break;
        }
    }
    farewell(&mut flood).await;
    until("the end of the flood", || metric(&front, "casca_dropped_total{reason=\"flood\"}") >= 1.0).await;

    // Too many.
    let mut many = Vec::new();
    for _ in 0..20 {
        if let Ok(Ok((socket, _))) =
            timeout(LONGEST, connect_async(format!("ws://{}/", front.clients()))).await
        {
            many.push(socket);
        }
    }
    assert!(many.len() <= 12 && metric(&front, "casca_dropped_total{reason=\"full\"}") >= 1.0);
    drop(many);

    // The good one was answered in each tick.
    let now = metric(&front, "casca_ticks_total") as u64;
    while last < now {
        let next = answer(&mut good).await.tick;
        assert_eq!(next, last + 1);
        last = next;
    }
    front.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_does_not_read_is_dropped() {
    let mut options = options();
    (options.queue, options.bots) = (4, 250);
    // On a busy machine, it would be idle before the buffers are full.
    options.limits.idle = 600.0;
    options.server = options.server.tick(0.004).walls(false);
    let front = start(options).await;
    // It never reads, until the buffers of the system are full: its own is small.
    let socket = TcpSocket::new_v4().unwrap();
    socket.set_recv_buffer_size(4096).unwrap();
    let stream = timeout(LONGEST, socket.connect(front.clients())).await.unwrap().unwrap();
    let (mut slow, _) = client_async(format!("ws://{}/", front.clients()), stream).await.unwrap();
    let hello = ToServer::Hello { token: b"open sesame", latency: 50 }.encode();
    slow.send(Message::binary(hello)).await.unwrap();
    until("the end of the slow one", || metric(&front, "casca_dropped_total{reason=\"slow\"}") >= 1.0).await;
    let (mut good, ..) = join(&front).await;
    answer(&mut good).await;
    drop(slow);
    front.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_map_and_the_metrics_are_served_and_nothing_else() {
    let front = start(options()).await;
    let get = async |head: &str| {
        let mut stream = TcpStream::connect(front.http()).await.unwrap();
        let request = format!("{head} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut text = String::new();
        timeout(LONGEST, stream.read_to_string(&mut text)).await.unwrap().unwrap();
        text
    };
    until("a tick", || metric(&front, "casca_ticks_total") >= 5.0).await;
    assert!(get("GET /metrics").await.contains("# TYPE casca_tick_seconds histogram"));
    assert!(get("GET /").await.contains("<canvas"));
    let body = |text: String| text.split("\r\n\r\n").nth(1).unwrap().to_owned();
    let level: serde_json::Value = serde_json::from_str(&body(get("GET /level.json").await)).unwrap();
    assert!(level["boxes"].as_array().unwrap().len() > 50);
    let now: serde_json::Value = serde_json::from_str(&body(get("GET /now.json").await)).unwrap();
    assert_eq!(now["clients"].as_array().unwrap().len(), 6);
    assert!(get("GET /etc/passwd").await.starts_with("HTTP/1.1 404"));
    assert!(get("POST /metrics").await.starts_with("HTTP/1.1 405"));
    front.stop().await;
}
