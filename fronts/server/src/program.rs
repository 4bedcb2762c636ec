//! The command `casca serve`: a server that tells each client of what it could see, and of nothing
//! else.

use std::net::SocketAddr;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use casca_tools::command_line::{EXIT_CODES, Outcome};
use clap::Args;

use crate::bots::Level;
use crate::net::{Front, FrontOptions};
use crate::session::Token;
use crate::{ClientDesc, ServerOptions, VisibilityServer};

/// Tells each client of a game of the entities that it could see, and of no others.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub struct Options {
    /// The level: `rooms`, another generated scene, or a .glb or .gltf file with a moving camera.
    #[arg(long, default_value = "rooms")]
    level: String,
    /// Looks at a level, says what it is made of, and ends: with 3 if it cannot be used.
    #[arg(long, value_name = "LEVEL")]
    check: Option<String>,
    /// Finds which cells of the level see each other, writes them to a file, and ends.
    #[arg(long, value_name = "FILE")]
    bake: Option<PathBuf>,
    /// The edge of a cell for that, in metres, 0.25 at least.
    #[arg(long, default_value_t = 2.0)]
    cell: f32,
    /// A file that was written by --bake for the same level: the server asks it first.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["bake", "check"])]
    baked: Option<PathBuf>,
    /// Where clients connect by WebSocket.
    #[arg(long, default_value = "127.0.0.1:4600")]
    listen: SocketAddr,
    /// Where metrics and the map are. They show all that is secret.
    #[arg(long, default_value = "127.0.0.1:4601")]
    http: SocketAddr,
    /// A file that holds the token of clients. Without one, a new token is made and printed.
    #[arg(long, value_name = "FILE")]
    token: Option<PathBuf>,
    /// Bots that play.
    #[arg(long, default_value_t = 0)]
    bots: usize,
    /// Ticks a second, from 1 to 240.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=240))]
    ticks: u16,
    /// The most connections of clients.
    #[arg(long, default_value_t = 1000)]
    connections: usize,
    /// Ends after so many seconds.
    #[arg(long, value_name = "SECONDS")]
    seconds: Option<u64>,
    /// Says more.
    #[arg(long)]
    verbose: bool,
}

/// Queries for each cell of a bake: walls decide most.
const QUERIES: u32 = 16;

/// Why it failed.
pub type Failure = Box<dyn std::error::Error>;

/// Does what the options say.
///
/// # Errors
/// The level, a file or an address cannot be used.
pub fn run(arguments: &Options) -> Result<Outcome, Failure> {
    let most = if arguments.verbose { tracing::Level::DEBUG } else { tracing::Level::INFO };
    tracing_subscriber::fmt().with_max_level(most).with_writer(std::io::stderr).init();
    if let Some(level) = &arguments.check {
        return check(level);
    }
    let mut level = open(&arguments.level)?;
    if let Some(file) = &arguments.bake {
        return bake(&level, arguments.cell, file);
    }
    if let Some(file) = &arguments.baked {
        level.baked = Some(std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?);
    }
    let mut options = FrontOptions::new(token(arguments)?);
    (options.clients, options.http) = (arguments.listen, arguments.http);
    (options.bots, options.connections) = (arguments.bots, arguments.connections);
    options.server = ServerOptions::new().tick(1.0 / f32::from(arguments.ticks));
    options.server.most_clients = arguments.bots + arguments.connections;
    let runtime = tokio::runtime::Runtime::new()?;
    runtime.block_on(async {
        let asked = asked_to_end()?;
        let front = Front::start(level, options).await?;
        println!("clients: ws://{}  map: http://{}/", front.clients(), front.http());
        tokio::select! {
            () = asked => {}
            () = passed(arguments.seconds) => {}
        }
        front.stop().await;
        Ok(Outcome::Well)
    })
}

fn open(name: &str) -> Result<Level, Failure> {
    let level = Level::open(name)?;
    level.source.tell();
    level.source.about_origin().iter().for_each(|line| println!("{line}"));
    Ok(level)
}

/// Prints the parts of a level, and runs one tick with a client to show that it can be served.
fn check(name: &str) -> Result<Outcome, Failure> {
    let level = open(name)?;
    let occluders = level.scene.len();
    let mut server = VisibilityServer::new(level.scene, ServerOptions::new())?;
    server.add_client(ClientDesc::new(level.track.path[0], 5.0, 0.1), 0.0)?;
    server.tick(0.0)?;
    let meters: f32 = level.track.path.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    println!(
        "{}: {} objects, {occluders} occluders, {} walls",
        level.name,
        level.objects.len(),
        server.wall_count()
    );
    println!("a path of {meters:.0} m");
    Ok(Outcome::Well)
}

/// Finds which cells of a level see each other.
fn bake(level: &Level, cell: f32, file: &Path) -> Result<Outcome, Failure> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let mut last = 0;
    let bytes = level.bake(cell, QUERIES, threads, &mut |done, all| {
        // A line for each tenth.
        if let Some(tenths) = (done * 10).checked_div(all).filter(|tenths| *tenths != last) {
            eprintln!("{done} of {all} cells");
            last = tenths;
        }
        ControlFlow::Continue(())
    })?;
    casca_bake::write_whole(file, &bytes)?;
    println!("{}: {} bytes", file.display(), bytes.len());
    Ok(Outcome::Well)
}

fn token(arguments: &Options) -> Result<Token, Failure> {
    if let Some(file) = &arguments.token {
        let text = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
        return Token::new(text.trim()).ok_or_else(|| "the token must have 1 to 64 bytes".into());
    }
    let mut bytes = [0u8; 16];
    getrandom::fill(&mut bytes).map_err(|error| format!("no random numbers: {error}"))?;
    let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    println!("token: {text}");
    Token::new(text).ok_or_else(|| "the token must have 1 to 64 bytes".into())
}

/// Ends when the process is asked to end. It listens from the call on.
#[cfg(unix)]
fn asked_to_end() -> Result<impl Future<Output = ()>, Failure> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}

/// Ends when the process is asked to end.
#[cfg(not(unix))]
fn asked_to_end() -> Result<impl Future<Output = ()>, Failure> {
    Ok(async {
        let _ = tokio::signal::ctrl_c().await;
    })
}

/// Ends after some time, if there is one.
async fn passed(longest: Option<u64>) {
    match longest {
        Some(seconds) => tokio::time::sleep(Duration::from_secs(seconds)).await,
        None => std::future::pending().await,
    }
}
