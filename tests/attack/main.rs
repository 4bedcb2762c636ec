//! The attack, in its two forms.

#[path = "../common/mod.rs"]
mod common;

mod grazing;
mod plays;

/// A number of the environment.
fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|v| v.parse().ok())
}
