//! Queries that keep their result while the eye moves little.

use casca::KeptOptions;
use wasm_bindgen::prelude::*;

use crate::arrays::refused;
use crate::query::options;
use crate::scene::{Scene, keys};
use crate::view::View;

/// Finds what views can see, and keeps it for views nearby: most runs cost a small part of one of
/// `Query`, and sets are somewhat larger.
#[wasm_bindgen]
pub struct KeptQuery {
    query: casca::KeptQuery,
}

#[wasm_bindgen]
impl KeptQuery {
    /// A query: "fast", "balanced" (the default) or "tight".
    #[wasm_bindgen(constructor)]
    pub fn new(preset: Option<String>) -> Result<KeptQuery, JsError> {
        let mut query = casca::KeptQuery::with_options(KeptOptions::default()).map_err(refused)?;
        if preset.is_some() {
            query.set_point_options(options(preset.as_deref())?).map_err(refused)?;
        }
        Ok(Self { query })
    }

    /// Finds the objects that a view can see. No visible object is missing.
    pub fn run(&mut self, scene: &Scene, view: &View) -> Result<Vec<u64>, JsError> {
        keys(scene, self.query.run(&scene.scene, &view.view).iter())
    }

    /// How often a result was found anew so far.
    #[wasm_bindgen(getter)]
    pub fn refreshes(&self) -> f64 {
        self.query.refreshes() as f64
    }
}
