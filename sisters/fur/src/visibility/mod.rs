//! Furry objects in a scene of casca: what may be culled, what hides, and how many layers each
//! object gets.
//!
//! Three rules keep the picture whole: the bounds contain the fur ([`furry_object`]); only what
//! lies inside the base mesh hides others ([`base_occluder`], [`inner_ball`]), never the fur, which
//! has gaps; and a budget takes layers, never objects ([`plan_layers`]).

mod objects;
mod plan;

pub use objects::{base_occluder, furry_object, inflate, inner_ball};
pub use plan::{PlanOptions, Sight, level_for, pixels_of, plan_layers};
