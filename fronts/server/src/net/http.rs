//! Metrics and the map by HTTP.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{CACHE_CONTROL, CONTENT_TYPE};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};

use crate::net::map::Map;
use crate::net::metrics::Metrics;

/// The most connections at the same time.
const CONNECTIONS: usize = 64;

/// How long the head of a request may take.
const HEAD: Duration = Duration::from_secs(5);

/// How long a connection may last.
const LONGEST: Duration = Duration::from_secs(60);

const PAGE: &str = include_str!("map.html");

/// Answers until the server stops.
pub(crate) async fn listen(
    listener: TcpListener,
    metrics: Arc<Metrics>,
    map: Arc<Map>,
    mut stopped: watch::Receiver<bool>,
) {
    let seats = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stopped.wait_for(|stopped| *stopped) => return,
        };
        let (Ok((stream, _)), Ok(seat)) = (accepted, seats.clone().try_acquire_owned()) else {
            tokio::time::sleep(Duration::from_millis(10)).await;
            continue;
        };
        let (metrics, map) = (metrics.clone(), map.clone());
        tokio::spawn(async move {
            let service = service_fn(move |request| {
                let response = respond(&request, &metrics, &map);
                async move { Ok::<_, Infallible>(response) }
            });
            let mut builder = http1::Builder::new();
            builder.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(16 * 1024);
            let serve = builder.serve_connection(TokioIo::new(stream), service);
            let _ = tokio::time::timeout(LONGEST, serve).await;
            drop(seat);
        });
    }
}

fn respond(request: &Request<Incoming>, metrics: &Metrics, map: &Map) -> Response<Full<Bytes>> {
    let (status, kind, body) = match (request.method(), request.uri().path()) {
        (&Method::GET, "/metrics") => (StatusCode::OK, "text/plain; version=0.0.4", metrics.text()),
        (&Method::GET, "/") => (StatusCode::OK, "text/html; charset=utf-8", PAGE.to_owned()),
        (&Method::GET, "/level.json") => (StatusCode::OK, "application/json", map.level().to_owned()),
        (&Method::GET, "/now.json") => (StatusCode::OK, "application/json", map.now().to_string()),
        (&Method::GET, _) => (StatusCode::NOT_FOUND, "text/plain", "not found\n".to_owned()),
        _ => (StatusCode::METHOD_NOT_ALLOWED, "text/plain", "only GET\n".to_owned()),
    };
    let response = Response::builder().status(status).header(CONTENT_TYPE, kind);
    let response = response.header(CACHE_CONTROL, "no-store").body(Full::new(Bytes::from(body)));
    response.unwrap_or_else(|_| Response::new(Full::new(Bytes::new())))
}
