//! QUIC on the loopback: clients are told the same, under the same limits, as by WebSocket.

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use casca_server::bots::Level;
use casca_server::net::{Front, FrontOptions, Identity, PROTOCOL, QuicOptions};
use casca_server::session::Token;
use casca_server::wire::{AnswerFrame, ToClient, ToServer};
use futures_util::{SinkExt, StreamExt};
use quinn::crypto::rustls::QuicClientConfig;
use quinn::{
    ClientConfig, Connection, ConnectionError, Endpoint, RecvStream, SendStream, TransportConfig, VarInt,
};
use rustls::pki_types::CertificateDer;
use tokio::net::UdpSocket;
use tokio::time::timeout;
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::Message;

/// All that a test waits for comes within this.
const LONGEST: Duration = Duration::from_secs(120);

async fn start(change: impl FnOnce(&mut FrontOptions)) -> (Front, Vec<u8>) {
    let mut options = FrontOptions::new(Token::new("open sesame").unwrap());
    options.bots = 6;
    let identity = Identity::self_signed(&["localhost"]).unwrap();
    let certificate = identity.certificate().to_vec();
    options.quic = Some(QuicOptions::new(SocketAddr::from(([127, 0, 0, 1], 0)), identity));
    change(&mut options);
    let level = tokio::task::spawn_blocking(|| Level::rooms().unwrap()).await.unwrap();
    (Front::start(level, options).await.unwrap(), certificate)
}

/// A client that trusts a certificate, and reads so many bytes ahead.
fn endpoint(certificate: &[u8], protocol: &[u8], window: u32) -> Endpoint {
    let mut roots = rustls::RootCertStore::empty();
    roots.add(CertificateDer::from(certificate.to_vec())).unwrap();
    let provider = rustls::crypto::ring::default_provider().into();
    let mut tls = rustls::ClientConfig::builder_with_provider(provider)
        .with_protocol_versions(&[&rustls::version::TLS13])
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    tls.alpn_protocols = vec![protocol.to_vec()];
    let mut config = ClientConfig::new(Arc::new(QuicClientConfig::try_from(tls).unwrap()));
    let mut transport = TransportConfig::default();
    transport.stream_receive_window(VarInt::from_u32(window));
    // A connection is not ended because it is silent at this level.
    transport.keep_alive_interval(Some(Duration::from_millis(200)));
    config.transport_config(Arc::new(transport));
    let mut endpoint = Endpoint::client(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
    endpoint.set_default_client_config(config);
    endpoint
}

struct Client {
    /// Keeps its socket.
    _endpoint: Endpoint,
    connection: Connection,
    send: SendStream,
    receive: RecvStream,
}

impl Client {
    async fn connect(front: &Front, certificate: &[u8]) -> Result<Self, ConnectionError> {
        Self::connect_with(front, endpoint(certificate, PROTOCOL, 1 << 20)).await
    }

    async fn connect_with(front: &Front, endpoint: Endpoint) -> Result<Self, ConnectionError> {
        let connecting = endpoint.connect(front.quic().unwrap(), "localhost").unwrap();
        let connection = timeout(LONGEST, connecting).await.expect("an answer")?;
        let (send, receive) = connection.open_bi().await?;
        Ok(Self { _endpoint: endpoint, connection, send, receive })
    }

    /// Comes in; returns the own entity too, and where the eye is.
    async fn join(front: &Front, certificate: &[u8]) -> (Self, u64, casca_server::casca::glam::Vec3) {
        let mut client = Self::connect(front, certificate).await.unwrap();
        client.send(&ToServer::Hello { token: b"open sesame", latency: 50 }).await;
        let Some(ToClient::Welcome { entity, eye, .. }) = client.next().await else { panic!("no welcome") };
        (client, entity, eye)
    }

    async fn send(&mut self, frame: &ToServer<'_>) {
        self.raw(&framed(&frame.encode())).await;
    }

    /// Bytes as they are; the server may have ended the stream.
    async fn raw(&mut self, bytes: &[u8]) {
        let _ = timeout(LONGEST, self.send.write_all(bytes)).await.expect("it is written");
    }

    /// The next frame; `None` at the end of the connection.
    async fn next(&mut self) -> Option<ToClient> {
        let whole = async {
            let mut length = [0; 4];
            self.receive.read_exact(&mut length).await.ok()?;
            let mut frame = vec![0; u32::from_le_bytes(length) as usize];
            self.receive.read_exact(&mut frame).await.ok()?;
            Some(ToClient::decode(&frame).unwrap())
        };
        timeout(LONGEST, whole).await.expect("the server says something")
    }

    async fn answer(&mut self) -> AnswerFrame {
        loop {
            if let ToClient::Answer(answer) = self.next().await.expect("the connection lasts") {
                return answer;
            }
        }
    }

    /// The last frame's reason, and that with which the connection was closed.
    async fn farewell(&mut self) -> (Option<u8>, u64) {
        let mut reason = None;
        while let Some(frame) = self.next().await {
            if let ToClient::Bye(code) = frame {
                reason = Some(code);
            }
        }
        match timeout(LONGEST, self.connection.closed()).await.expect("the connection ends") {
            ConnectionError::ApplicationClosed(close) => (reason, close.error_code.into_inner()),
            other => panic!("{other}"),
        }
    }
}

/// A frame after its length.
fn framed(frame: &[u8]) -> Vec<u8> {
    [&(frame.len() as u16).to_le_bytes(), frame].concat()
}

fn metric(front: &Front, name: &str) -> f64 {
    let text = front.metrics();
    let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name} in {text}"));
    line.rsplit(' ').next().unwrap().parse().unwrap()
}

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
async fn a_client_is_told_the_same_as_by_websocket() {
    let (front, certificate) = start(|options| options.server = options.server.walls(false)).await;
    let (mut quic, own, eye) = Client::join(&front, &certificate).await;
    let url = format!("ws://{}/", front.clients());
    let (mut socket, _) = timeout(LONGEST, connect_async(url)).await.unwrap().unwrap();
    let hello = ToServer::Hello { token: b"open sesame", latency: 50 }.encode();
    socket.send(Message::binary(hello)).await.unwrap();
    // Without walls all is told: both know all eight, in each tick that both are in.
    let mut known = BTreeSet::new();
    let keep = |known: &mut BTreeSet<u64>, answer: &AnswerFrame| {
        answer.forgotten.iter().for_each(|key| assert!(known.remove(key)));
        answer.new.iter().for_each(|(key, _)| assert!(known.insert(*key)));
        (answer.tick, known.clone(), places(answer))
    };
    let first = quic.answer().await;
    assert!(first.fresh && first.new.iter().any(|(key, b)| *key == own && b.contains(eye)));
    let mut told = vec![keep(&mut known, &first)];
    let mut others = Vec::new();
    let mut known_there = BTreeSet::new();
    while others.len() < 30 {
        let message = timeout(LONGEST, socket.next()).await.unwrap().unwrap().unwrap();
        if let Ok(ToClient::Answer(answer)) = ToClient::decode(&message.into_data()) {
            others.push(keep(&mut known_there, &answer));
        }
    }
    let (first, last) = (others[0].0, others[29].0);
    while told.last().unwrap().0 < last {
        told.push(keep(&mut known, &quic.answer().await));
    }
    assert!(told.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1), "no tick is missed");
    let same: Vec<_> = told.into_iter().filter(|told| told.0 >= first).collect();
    assert_eq!(same, others);
    assert_eq!(others[29].1.len(), 8);

    quic.send(&ToServer::Ping(77)).await;
    while quic.next().await != Some(ToClient::Pong(77)) {}
    // A frame in parts, and two at once.
    let bytes = [framed(&ToServer::Ping(78).encode()), framed(&ToServer::Ping(79).encode())].concat();
    let (head, rest) = bytes.split_at(1);
    quic.raw(head).await;
    tokio::time::sleep(Duration::from_millis(100)).await;
    quic.raw(rest).await;
    while quic.next().await != Some(ToClient::Pong(78)) {}
    while quic.next().await != Some(ToClient::Pong(79)) {}
    let far = eye + casca_server::casca::glam::Vec3::X * 1000.0;
    quic.send(&ToServer::Eye { sequence: 1, eye: far }).await;
    until("the refusal", || metric(&front, "casca_refused_moves_total") >= 1.0).await;
    front.stop().await;
    assert_eq!(quic.farewell().await, (Some(8), 8));
}

/// The least places of all boxes.
fn places(answer: &AnswerFrame) -> Vec<(u64, [u32; 3])> {
    let new = answer.new.iter().map(|(key, b)| (*key, b.min));
    let mut places: Vec<_> = new
        .chain(answer.moved.iter().copied())
        .map(|(key, at)| (key, at.to_array().map(f32::to_bits)))
        .collect();
    places.sort_unstable();
    places
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bad_clients_lose_their_connection_and_others_miss_no_tick() {
    let (front, certificate) = start(|options| {
        options.connections = 8;
        (options.limits.hello, options.limits.idle) = (0.5, 1.0);
    })
    .await;
    let (mut good, _, eye) = Client::join(&front, &certificate).await;
    let mut last = good.answer().await.tick;
    let reader = {
        let stay = Arc::new(std::sync::atomic::AtomicBool::new(true));
        let on = stay.clone();
        let task = tokio::spawn(async move {
            let mut sequence = 0;
            while on.load(std::sync::atomic::Ordering::Relaxed) {
                sequence += 1;
                good.send(&ToServer::Eye { sequence, eye }).await;
                let next = good.answer().await.tick;
                assert_eq!(next, last + 1);
                last = next;
            }
            (good, last)
        });
        (stay, task)
    };

    // Garbage, frames that are empty or too long, a wrong token, frames out of order, and a stream
    // that ends within a frame.
    let early = ToServer::Eye { sequence: 1, eye }.encode();
    let wrong = ToServer::Hello { token: b"open sesamf", latency: 1 }.encode();
    let long = [129u16.to_le_bytes().as_slice(), &[1; 129]].concat();
    let bad = [
        (framed(&[0xee; 40]), 1),
        (framed(&[]), 1),
        (vec![0xff; 5], 1),
        (long, 1),
        (vec![20, 0, 1], 1),
        (framed(&wrong), 2),
        (framed(&early), 3),
    ];
    for (bytes, code) in bad {
        let mut client = Client::connect(&front, &certificate).await.unwrap();
        client.raw(&bytes).await;
        if bytes.len() == 3 {
            client.send.finish().unwrap();
        }
        assert_eq!(client.farewell().await, (Some(code), code.into()), "{bytes:?}");
    }

    // No QUIC at all, another protocol, a certificate that nobody trusts.
    let udp = tokio::net::UdpSocket::bind("127.0.0.1:0").await.unwrap();
    for i in 0..500u32 {
        let bytes: Vec<u8> = (0..i * 3).map(|j| (i * 31 + j * 17) as u8 | 0xc0).collect();
        let _ = udp.send_to(&bytes, front.quic().unwrap()).await;
    }
    let other = endpoint(&certificate, b"h3", 1 << 20);
    assert!(Client::connect_with(&front, other).await.is_err());
    let own = Identity::self_signed(&["localhost"]).unwrap();
    assert!(Client::connect(&front, own.certificate()).await.is_err());

    // One that opens no stream, one that says no hello, and one that says nothing after it or is
    // within a frame for ever.
    let lone = endpoint(&certificate, PROTOCOL, 1 << 20);
    let lone = lone.connect(front.quic().unwrap(), "localhost").unwrap().await.unwrap();
    timeout(LONGEST, lone.closed()).await.expect("the connection ends");
    let mut mute = Client::connect(&front, &certificate).await.unwrap();
    mute.raw(&[30]).await;
    assert_eq!(mute.farewell().await, (Some(5), 5));
    let (mut idle, ..) = Client::join(&front, &certificate).await;
    idle.raw(&128u16.to_le_bytes()).await;
    for _ in 0..15 {
        idle.raw(&[3]).await;
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    assert_eq!(idle.farewell().await, (Some(5), 5));

    // A flood.
    let (mut flood, ..) = Client::join(&front, &certificate).await;
    flood.raw(&framed(&ToServer::Ping(1).encode()).repeat(400)).await;
    assert_eq!(flood.farewell().await.1, 4);
    assert!(metric(&front, "casca_dropped_total{reason=\"flood\"}") >= 1.0);

    // Too many, of both kinds together.
    until("free seats", || metric(&front, "casca_connections") <= 1.0).await;
    let mut sockets = Vec::new();
    for _ in 0..5 {
        sockets.push(connect_async(format!("ws://{}/", front.clients())).await.unwrap().0);
    }
    let mut many = Vec::new();
    for _ in 0..4 {
        many.push(Client::connect(&front, &certificate).await);
    }
    assert_eq!(many.iter().filter(|client| client.is_ok()).count(), 2);
    assert!(connect_async(format!("ws://{}/", front.clients())).await.is_err());
    drop((many, sockets));

    // The good one was answered in each tick.
    reader.0.store(false, std::sync::atomic::Ordering::Relaxed);
    let (mut good, last) = timeout(LONGEST, reader.1).await.unwrap().unwrap();
    assert!(last > 60);
    assert_eq!(good.answer().await.tick, last + 1);
    front.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_does_not_read_is_dropped() {
    let (front, certificate) = start(|options| {
        (options.queue, options.bots) = (4, 100);
        options.server = options.server.tick(0.004).walls(false).most_queries(0);
    })
    .await;
    let window = endpoint(&certificate, PROTOCOL, 8192);
    let mut slow = Client::connect_with(&front, window).await.unwrap();
    slow.send(&ToServer::Hello { token: b"open sesame", latency: 50 }).await;
    // It never reads more than its window lets in.
    until("the end of the slow one", || metric(&front, "casca_dropped_total{reason=\"slow\"}") >= 1.0).await;
    let (mut good, ..) = Client::join(&front, &certificate).await;
    good.answer().await;
    let closed = timeout(LONGEST, slow.connection.closed()).await.expect("the connection ends");
    assert!(
        matches!(closed, ConnectionError::ApplicationClosed(close) if close.error_code == VarInt::from_u32(6))
    );
    front.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn certificates_come_from_files() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [certificates, key, empty, none] =
        ["certificates.pem", "key.pem", "empty.pem", "none.pem"].map(|name| folder.join(name));
    let made = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    std::fs::write(&certificates, made.cert.pem()).unwrap();
    std::fs::write(&key, made.signing_key.serialize_pem()).unwrap();
    std::fs::write(&empty, "no certificate").unwrap();
    let error = |certificates, key| Identity::from_pem_files(certificates, key).unwrap_err().to_string();
    assert!(error(&none, &key).contains("none.pem"));
    assert!(error(&empty, &key).contains("empty.pem: there is no certificate"));
    assert!(error(&certificates, &certificates).contains("certificates.pem"));
    assert!(Identity::self_signed(&["\u{fc}"]).is_err());

    let identity = Identity::from_pem_files(&certificates, &key).unwrap();
    assert_eq!(format!("{identity:?}"), "Identity");
    let (front, _) = start(|options| options.quic.as_mut().unwrap().identity = identity).await;
    let (mut client, ..) = Client::join(&front, made.cert.der()).await;
    client.answer().await;
    front.stop().await;

    // A key of another certificate.
    let other = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    std::fs::write(&key, other.signing_key.serialize_pem()).unwrap();
    let mut options = FrontOptions::new(Token::new("open sesame").unwrap());
    let identity = Identity::from_pem_files(&certificates, &key).unwrap();
    options.quic = Some(QuicOptions::new(SocketAddr::from(([127, 0, 0, 1], 0)), identity));
    assert!(Front::start(Level::rooms().unwrap(), options).await.is_err());
}

/// The two bits of the first byte of a long header that tell a Retry packet of QUIC 1 (RFC 9000,
/// 17.2.5).
const IS_RETRY: (u8, u8) = (0xf0, 0xf0);

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_forged_address_gets_a_retry_and_no_seat() {
    let (front, certificate) = start(|options| options.connections = 2).await;
    let server = front.quic().unwrap();
    for _ in 0..8 {
        // A client's first packet, sent on from an address whose owner never answers.
        let between = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let client = endpoint(&certificate, PROTOCOL, 1 << 20);
        let connecting = client.connect(between.local_addr().unwrap(), "localhost").unwrap();
        let mut packet = [0; 2048];
        let (long, _) = timeout(LONGEST, between.recv_from(&mut packet)).await.unwrap().unwrap();
        drop(connecting);
        let forged = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        forged.send_to(&packet[..long], server).await.unwrap();
        let mut answer = [0; 2048];
        let (got, from) = timeout(LONGEST, forged.recv_from(&mut answer)).await.unwrap().unwrap();
        assert_eq!(from, server);
        assert!(answer[0] & IS_RETRY.0 == IS_RETRY.1 && got < long, "{:x}, {got} of {long} bytes", answer[0]);
        // Nothing else is sent there.
        assert!(timeout(Duration::from_millis(50), forged.recv_from(&mut answer)).await.is_err());
    }
    assert_eq!(metric(&front, "casca_connections"), 0.0);
    let (mut good, ..) = Client::join(&front, &certificate).await;
    good.answer().await;
    assert_eq!(metric(&front, "casca_connections"), 1.0);
    front.stop().await;
}
