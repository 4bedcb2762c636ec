//! Prepared meshes.

use std::ops::ControlFlow;
use std::sync::Arc;

use casca::glam::Vec3;
use casca::{Facing, MeshOptions, TriMesh};
use pyo3::prelude::*;

use crate::arrays::{points, triangles};
use crate::error::refused;
use crate::forms::{Given, Rule};

/// Triangles that were prepared once, for any number of objects.
#[pyclass(frozen, module = "casca")]
pub struct Mesh {
    pub(crate) mesh: Arc<TriMesh>,
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (positions, triangles, *, occludes=true, two_sided=true, progress=None))]
    fn new(
        py: Python<'_>,
        positions: Given,
        triangles: Given,
        occludes: bool,
        two_sided: bool,
        progress: Progress,
    ) -> PyResult<Self> {
        let positions: Vec<Vec3> = points("positions", positions, Rule::Finite)?;
        let triangles = self::triangles(triangles)?;
        let facing = if two_sided { Facing::Both } else { Facing::Front };
        let how = MeshOptions::default().facing(facing).occludes(occludes);
        let mesh = py.detach(|| {
            let mut told = Told::new(progress);
            let mesh = TriMesh::prepare(positions, triangles, &how, &mut |share| told.tell(share));
            told.raised.map_or_else(|| mesh.map_err(refused), Err)
        })?;
        Ok(Self { mesh: Arc::new(mesh) })
    }

    /// Whether every edge has two triangles.
    #[getter]
    fn is_closed(&self) -> bool {
        self.mesh.is_closed()
    }

    fn __len__(&self) -> usize {
        self.mesh.triangles().len()
    }

    fn __repr__(&self) -> String {
        format!("Mesh({} triangles)", self.mesh.triangles().len())
    }
}

/// What is told the share of the work that is done.
pub type Progress = Option<Py<PyAny>>;

/// A callback that is told it.
pub struct Told {
    callback: Progress,
    /// What it raised: then the work ends.
    pub raised: Option<PyErr>,
}

impl Told {
    pub fn new(callback: Progress) -> Self {
        Self { callback, raised: None }
    }

    /// Tells it. Looks for an interrupt from the keyboard as well.
    pub fn tell(&mut self, share: f32) -> ControlFlow<()> {
        let asked = Python::attach(|py| {
            py.check_signals()?;
            self.callback.as_ref().map_or(Ok(()), |callback| callback.call1(py, (share,)).map(drop))
        });
        if let Err(raised) = asked {
            self.raised = Some(raised);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}
