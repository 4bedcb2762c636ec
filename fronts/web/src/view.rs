//! Views.

use wasm_bindgen::prelude::*;

use crate::arrays::{mat4, refused, vec3};

/// What can be looked at, and from where.
#[wasm_bindgen]
pub struct View {
    pub(crate) view: casca::View,
}

fn of(view: Result<casca::View, casca::Error>) -> Result<View, JsError> {
    Ok(View { view: view.map_err(refused)? })
}

#[wasm_bindgen]
impl View {
    /// A perspective camera: its place, and its matrix from world to clip space, 16 numbers as in
    /// `Matrix4.elements`. Depth goes from -1 to 1 as in WebGL, unless `zeroToOne` says that it
    /// goes from 0 to 1 as in WebGPU.
    pub fn perspective(eye: &[f32], matrix: &[f32], zero_to_one: Option<bool>) -> Result<View, JsError> {
        let (eye, matrix) = (vec3("the eye", eye)?, mat4("the matrix", matrix)?);
        of(match zero_to_one.unwrap_or(false) {
            true => casca::View::perspective(eye, matrix),
            false => casca::View::perspective_gl(eye, matrix),
        })
    }

    /// A camera of either kind by its matrix alone. Give the eye where it is known: that is exact.
    #[wasm_bindgen(js_name = fromMatrix)]
    pub fn from_matrix(matrix: &[f32], zero_to_one: Option<bool>) -> Result<View, JsError> {
        let matrix = mat4("the matrix", matrix)?;
        of(match zero_to_one.unwrap_or(false) {
            true => casca::View::from_view_projection(matrix),
            false => casca::View::from_view_projection_gl(matrix),
        })
    }

    /// All directions from a place.
    pub fn omnidirectional(eye: &[f32]) -> Result<View, JsError> {
        of(casca::View::omnidirectional(vec3("the eye", eye)?))
    }

    /// The same for all eyes that are no farther than this, in world units.
    #[wasm_bindgen(js_name = withReach)]
    pub fn with_reach(&self, reach: f32) -> Result<View, JsError> {
        of(self.view.clone().with_reach(reach))
    }

    /// The same for cameras that are turned by no more than this, in radians.
    #[wasm_bindgen(js_name = withTurn)]
    pub fn with_turn(&self, angle: f32) -> Result<View, JsError> {
        of(self.view.clone().with_turn(angle))
    }

    /// The same for objects that share a layer with this mask.
    #[wasm_bindgen(js_name = withLayers)]
    pub fn with_layers(&self, mask: u64) -> View {
        View { view: self.view.clone().with_layers(mask) }
    }
}
