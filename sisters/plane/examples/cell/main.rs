//! The thesis' claims about the plane, measured again: what extended occluders add, how volumes
//! behave over time, and which cells suit a scene. Prints tables in Markdown.
//!
//! ```sh
//! cargo run --release -p casca-plane --features maps --example cell
//! ```

mod extension;
mod resolution;
mod setup;
mod volumes;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    extension::print()?;
    extension::print_angles()?;
    extension::print_sizes()?;
    resolution::print()?;
    volumes::print()
}
