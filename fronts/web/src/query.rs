//! Queries.

use casca::{KeptOptions, Light, Method, ObjectId, PointOptions};
use wasm_bindgen::prelude::*;

use crate::arrays::{boxes, points, refused, vec3};
use crate::scene::{Scene, keys};
use crate::view::View;

/// Finds what views can see of a scene.
#[wasm_bindgen]
pub struct Query {
    query: casca::Query,
    /// Another one, for lights.
    light: casca::Query,
}

/// The options of a preset, if it has a name.
fn options(preset: Option<&str>) -> Result<PointOptions, JsError> {
    match preset {
        None => Ok(PointOptions::new()),
        Some("fast") => Ok(PointOptions::fast()),
        Some("balanced") => Ok(PointOptions::balanced()),
        Some("tight") => Ok(PointOptions::tight()),
        Some(other) => {
            Err(refused(format!("the preset is \"fast\", \"balanced\" or \"tight\", not {other:?}")))
        }
    }
}

#[wasm_bindgen]
impl Query {
    /// A query: "fast", "balanced" (the default) or "tight".
    #[wasm_bindgen(constructor)]
    pub fn new(preset: Option<String>) -> Result<Query, JsError> {
        let method = Method::Point(options(preset.as_deref())?);
        let make = || casca::Query::with_method(method).map_err(refused);
        Ok(Self { query: make()?, light: make()? })
    }

    /// Finds the objects that a view can see. No visible object is missing.
    pub fn run(&mut self, scene: &Scene, view: &View) -> Result<Vec<u64>, JsError> {
        keys(scene, self.query.run(&scene.scene, &view.view).iter())
    }

    /// Whether the view of the last run may see each of some boxes: 1 or 0.
    #[wasm_bindgen(js_name = maySeeBoxes)]
    pub fn may_see_boxes(&self, scene: &Scene, boxes: &[f32]) -> Result<Vec<u8>, JsError> {
        let boxes = self::boxes(boxes)?;
        let sight = self.query.sight(&scene.scene).ok_or_else(has_not_run)?;
        Ok(boxes.iter().map(|b| sight.may_see_box(b).into()).collect())
    }

    /// Whether the view of the last run may see each of some points: 1 or 0.
    #[wasm_bindgen(js_name = maySeePoints)]
    pub fn may_see_points(&self, scene: &Scene, points: &[f32]) -> Result<Vec<u8>, JsError> {
        let points = self::points("points", points)?;
        let sight = self.query.sight(&scene.scene).ok_or_else(has_not_run)?;
        Ok(points.iter().map(|at| sight.may_see_point(*at).into()).collect())
    }

    /// The objects whose shadows by the sun may fall on what the view of the last run sees. Its
    /// light goes along the direction.
    #[wasm_bindgen(js_name = shadowCastersOfSun)]
    pub fn shadow_casters_of_sun(&mut self, scene: &Scene, direction: &[f32]) -> Result<Vec<u64>, JsError> {
        self.shadow_casters(scene, &Light::directional(vec3("the direction", direction)?))
    }

    /// The same by a lamp that shines so far.
    #[wasm_bindgen(js_name = shadowCastersOfLamp)]
    pub fn shadow_casters_of_lamp(
        &mut self,
        scene: &Scene,
        position: &[f32],
        reach: f32,
    ) -> Result<Vec<u64>, JsError> {
        self.shadow_casters(scene, &Light::point(vec3("the position", position)?, reach))
    }
}

impl Query {
    fn shadow_casters(&mut self, scene: &Scene, light: &Light) -> Result<Vec<u64>, JsError> {
        let mut casters: Vec<ObjectId> = Vec::new();
        let found = self.light.shadow_casters(&scene.scene, &self.query, light, &mut casters);
        found.map_err(refused)?;
        keys(scene, casters)
    }
}

fn has_not_run() -> JsError {
    refused("the query has not run, or the scene changed since")
}

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
