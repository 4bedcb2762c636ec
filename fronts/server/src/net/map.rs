//! What the map shows: the level once, and who is told of what again and again.

use std::sync::{Arc, Mutex, PoisonError};

use casca::Aabb;
use serde_json::{Value, json};

use crate::bots::Level;
use crate::server::VisibilityServer;

/// Boxes of the level that are drawn, at most: the largest ones.
const MOST_BOXES: usize = 4000;

/// Documents for the map.
#[derive(Debug)]
pub(crate) struct Map {
    level: String,
    now: Mutex<Arc<str>>,
}

impl Map {
    pub(crate) fn new(level: &Level) -> Self {
        let mut boxes: Vec<[f32; 6]> = level
            .objects
            .iter()
            .map(|object| {
                let Aabb { min, max } = casca_bake::bounds_of(&object.shape);
                [min.x, min.z, max.x, max.z, min.y, max.y]
            })
            .collect();
        let size = |b: &[f32; 6]| (b[2] - b[0]) * (b[3] - b[1]);
        boxes.sort_by(|a, b| size(b).total_cmp(&size(a)));
        boxes.truncate(MOST_BOXES);
        let level = json!({ "name": level.name, "boxes": boxes }).to_string();
        Self { level, now: Mutex::new("{\"tick\":0,\"clients\":[],\"entities\":[]}".into()) }
    }

    /// The level.
    pub(crate) fn level(&self) -> &str {
        &self.level
    }

    /// The last moment.
    pub(crate) fn now(&self) -> Arc<str> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes over what the server knows.
    pub(crate) fn update(&self, server: &VisibilityServer, tick: u64) {
        let clients: Vec<Value> = server
            .clients()
            .filter_map(|(id, desc)| {
                let answer = server.answer(id).ok()?;
                let told: Vec<u64> = answer.told.iter().map(|entity| entity.key()).collect();
                let at = [desc.eye.x, desc.eye.z];
                Some(json!({ "key": id.key(), "eye": at, "reach": answer.reach, "told": told }))
            })
            .collect();
        let entities: Vec<Value> = server
            .entities()
            .map(|(id, entity)| {
                let (b, owner) = (entity.bounds, entity.owner.map(|owner| owner.key()));
                json!({ "key": id.key(), "owner": owner, "box": [b.min.x, b.min.z, b.max.x, b.max.z] })
            })
            .collect();
        let now = json!({ "tick": tick, "clients": clients, "entities": entities }).to_string();
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = now.into();
    }
}
