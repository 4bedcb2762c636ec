//! What can be chosen about a front.

use std::net::SocketAddr;

use crate::options::ServerOptions;
use crate::session::{Limits, Token};

/// What can be chosen about a [`Front`](crate::net::Front).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FrontOptions {
    /// Where clients connect by WebSocket. Default: 127.0.0.1, any free port.
    pub clients: SocketAddr,
    /// Where metrics and the map are. They tell all that is secret: keep the address to yourself.
    /// Default: 127.0.0.1, any free port.
    pub http: SocketAddr,
    /// Lets clients in.
    pub token: Token,
    /// What a connection may cost.
    pub limits: Limits,
    /// The most connections of clients at the same time. Default: 1,000.
    pub connections: usize,
    /// The most answers that wait for a client, which is dropped if one more comes. Default: 32.
    pub queue: usize,
    /// Options of the server; [`ServerOptions::tick`] is the time from tick to tick.
    pub server: ServerOptions,
    /// Bots that play.
    pub bots: usize,
}

impl FrontOptions {
    /// The default options, with a token.
    pub fn new(token: Token) -> Self {
        let any = SocketAddr::from(([127, 0, 0, 1], 0));
        Self {
            clients: any,
            http: any,
            token,
            limits: Limits::default(),
            connections: 1000,
            queue: 32,
            server: ServerOptions::new(),
            bots: 0,
        }
    }
}
