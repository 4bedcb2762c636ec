//! Numbers about the server, for Prometheus.

use prometheus::{
    Encoder, Histogram, HistogramOpts, IntCounter, IntCounterVec, IntGauge, Opts, Registry, TextEncoder,
};

use crate::session::Refusal;

/// Numbers about the server.
#[derive(Debug)]
pub(crate) struct Metrics {
    registry: Registry,
    pub(crate) connections: IntGauge,
    pub(crate) clients: IntGauge,
    pub(crate) entities: IntGauge,
    pub(crate) told: IntGauge,
    pub(crate) ticks: IntCounter,
    pub(crate) late_ticks: IntCounter,
    pub(crate) tick_seconds: Histogram,
    pub(crate) frames: IntCounter,
    pub(crate) bytes: IntCounter,
    pub(crate) refused_moves: IntCounter,
    dropped: IntCounterVec,
}

/// Buckets of the time of a tick, in seconds.
const SECONDS: [f64; 9] = [0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.033, 0.1, 1.0];

/// Why connections are ended, by [`Refusal::code`](crate::session::Refusal::code) less 1.
const REASONS: [&str; 9] = ["frame", "token", "order", "flood", "idle", "slow", "full", "stop", "gone"];

impl Metrics {
    /// Counts a connection that was ended.
    pub(crate) fn dropped(&self, refusal: Refusal) {
        if let Some(reason) = REASONS.get(usize::from(refusal.code()).wrapping_sub(1)) {
            self.dropped.with_label_values(&[*reason]).inc();
        }
    }

    pub(crate) fn new() -> Self {
        let registry = Registry::new();
        // Names are valid and there is one of each, so that none is refused.
        let gauge = |name: &str, help: &str| {
            let gauge = IntGauge::new(format!("casca_{name}"), help).expect("the name is valid");
            let _ = registry.register(Box::new(gauge.clone()));
            gauge
        };
        let counter = |name: &str, help: &str| {
            let counter = IntCounter::new(format!("casca_{name}_total"), help).expect("the name is valid");
            let _ = registry.register(Box::new(counter.clone()));
            counter
        };
        let times = HistogramOpts::new("casca_tick_seconds", "Time that the answers of a tick took.");
        let tick_seconds = Histogram::with_opts(times.buckets(SECONDS.to_vec())).expect("the buckets ascend");
        let _ = registry.register(Box::new(tick_seconds.clone()));
        let reasons = Opts::new("casca_dropped_total", "Connections that were ended, by reason.");
        let dropped = IntCounterVec::new(reasons, &["reason"]).expect("the name is valid");
        let _ = registry.register(Box::new(dropped.clone()));
        // All reasons are there from the beginning, at 0.
        REASONS.iter().for_each(|reason| dropped.with_label_values(&[*reason]).reset());
        Self {
            connections: gauge("connections", "Connections of clients that are open."),
            clients: gauge("clients", "Clients, bots included."),
            entities: gauge("entities", "Entities."),
            told: gauge("told", "Entities that clients are told of, over all clients."),
            ticks: counter("ticks", "Ticks."),
            late_ticks: counter("late_ticks", "Ticks that began later than answers allow for."),
            tick_seconds,
            frames: counter("frames", "Frames from clients."),
            bytes: counter("sent_bytes", "Bytes of answers."),
            refused_moves: counter("refused_moves", "Reports of eyes that went too far or through a wall."),
            dropped,
            registry,
        }
    }

    /// The numbers in Prometheus' text format.
    pub(crate) fn text(&self) -> String {
        let mut out = Vec::new();
        let _ = TextEncoder::new().encode(&self.registry.gather(), &mut out);
        String::from_utf8_lossy(&out).into_owned()
    }
}
