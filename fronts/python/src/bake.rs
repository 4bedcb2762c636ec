//! Bakes, and the files that they make.

use std::ops::ControlFlow;
use std::path::PathBuf;

use casca::Aabb;
use casca::glam::Vec3;
use casca_bake::{BakeError, Baker, Cells, Level, Merger, Places, write_whole};
use casca_scenes::generated::SceneOptions;
use casca_scenes::import;
use casca_scenes::name::SceneName;
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{cells, place, span};
use crate::error::{refused, warn};
use crate::forms::{Form, Given, cell_number, one, own_threads, queries, threads};
use crate::mesh::{Progress, Told};

/// The exception for a bake that ended early.
fn ended(why: BakeError) -> PyErr {
    match why {
        BakeError::File { .. } => PyOSError::new_err(why.to_string()),
        BakeError::Level(ref level) if matches!(level.why, import::Trouble::Read(_)) => {
            PyOSError::new_err(why.to_string())
        }
        _ => refused(why),
    }
}

/// A level made ready for baking, and its cells.
#[pyclass(module = "casca.bake", frozen)]
pub struct Bake {
    level: Level,
    cells: Cells,
    numbers: Vec<u32>,
    queries: u32,
}

impl Bake {
    fn progress<T: Send>(
        &self,
        py: Python,
        progress: Progress,
        work: impl Send + FnOnce(&mut casca_bake::Progress) -> Result<T, BakeError>,
    ) -> PyResult<T> {
        py.detach(|| {
            let mut told = Told::new(progress);
            let done = work(&mut |done, total| match total {
                0 => ControlFlow::Continue(()),
                _ => told.tell(done as f32 / total as f32),
            });
            told.raised.map_or_else(|| done.map_err(ended), Err)
        })
    }
}

#[pymethods]
impl Bake {
    #[new]
    #[pyo3(signature = (level, *, cell=2.0, height=None, within=None, queries=50, grid=None, solid=false, cell_to_cell=false, content=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python,
        level: PathBuf,
        cell: f32,
        height: Option<Bound<PyAny>>,
        within: Option<Bound<PyAny>>,
        #[pyo3(from_py_with = queries)] queries: u32,
        grid: Option<f32>,
        solid: bool,
        cell_to_cell: bool,
        content: Option<&[u8]>,
    ) -> PyResult<Self> {
        let heights = Form::new("height", &[2], "the least and the greatest height of an eye");
        let height = height.map(|height| one(&heights, &height)).transpose()?;
        let within = within.map(|within| span("within", &within)).transpose()?;
        let places = Places {
            edge: cell,
            height: height.map(|[least, greatest]| (least, greatest)),
            within: within.map(|[low, high]| Aabb::new(Vec3::from(low), Vec3::from(high))),
        };
        let name = level.to_string_lossy();
        let scene = match name.parse().map_err(|why| refused(format!("{name}: {why}")))? {
            // Paths need not be text.
            SceneName::File(_) => SceneName::File(level.clone()),
            scene => scene,
        };
        let world = py.detach(|| match content {
            Some(bytes) => {
                let read = import::read(&name, bytes, level.parent());
                read.map_err(|why| ended(import::ImportError { path: level.clone(), why }.into()))
            }
            None => scene.open(&SceneOptions::default()).map_err(|why| ended(why.into())),
        })?;
        warn(py, &world)?;
        py.detach(|| {
            let mut level = Level::new(&world, grid, solid).map_err(|why| ended(why.into()))?;
            if cell_to_cell {
                let cells = places.cells(&level).map_err(ended)?;
                let numbers = places.numbers(&level).map_err(ended)?;
                level = level.cell_to_cell(&cells, &numbers).map_err(|why| ended(why.into()))?;
            }
            let baker = Baker::new(&level, &places, queries).map_err(ended)?;
            let (cells, numbers) = (*baker.cells(), baker.numbers().to_vec());
            Ok(Self { level, cells, numbers, queries })
        })
    }

    /// The cells to bake, neighbours near each other.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        self.numbers.clone().into_pyarray(py)
    }

    /// The number of objects, or of cells of the grid.
    #[getter]
    fn objects(&self) -> u32 {
        self.level.len()
    }

    /// Finds the sets of some cells: the bytes of a file with these.
    #[pyo3(signature = (cells, *, threads=1, progress=None))]
    fn find(
        &self,
        py: Python,
        cells: Given,
        #[pyo3(from_py_with = own_threads)] threads: usize,
        progress: Progress,
    ) -> PyResult<Py<PyBytes>> {
        let cells = self::cells(cells)?;
        let bytes = self.progress(py, progress, |progress| {
            let baker = Baker::of(&self.level, self.cells, &cells, self.queries);
            Ok(baker.run(threads, None, progress)?.finish()?)
        })?;
        Ok(PyBytes::new(py, &bytes).unbind())
    }

    /// Finds the sets of all cells and writes the file.
    #[pyo3(signature = (out, *, threads=0, progress=None))]
    fn write(
        &self,
        py: Python,
        out: PathBuf,
        #[pyo3(from_py_with = threads)] threads: usize,
        progress: Progress,
    ) -> PyResult<()> {
        let threads = match threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            threads => threads,
        };
        self.progress(py, progress, |progress| {
            Baker::of(&self.level, self.cells, &self.numbers, self.queries).write(&out, threads, progress)
        })
    }

    fn __len__(&self) -> usize {
        self.numbers.len()
    }

    fn __repr__(&self) -> String {
        format!("Bake({} cells, {} objects)", self.numbers.len(), self.level.len())
    }
}

/// Puts files of parts together, as they come.
#[pyclass(module = "casca.bake")]
pub struct Merge {
    merger: Merger,
}

#[pymethods]
impl Merge {
    #[new]
    fn new() -> Self {
        Self { merger: Merger::default() }
    }

    /// Takes the bytes of a file.
    fn put(&mut self, part: &[u8]) -> PyResult<()> {
        let baked = casca_bake::Baked::read(part).map_err(refused)?;
        self.merger.put(&baked).map_err(refused)
    }

    /// Writes the file, whole or not at all.
    fn write(&self, out: PathBuf) -> PyResult<()> {
        let bytes = self.merger.finish().map_err(|why| match why {
            BakeError::NoFiles => refused("no parts were put"),
            why => ended(why),
        })?;
        write_whole(&out, &bytes).map_err(ended)
    }

    /// The number of cells that have a set.
    fn __len__(&self) -> usize {
        self.merger.len()
    }
}

/// A file of sets, in memory.
#[pyclass(module = "casca.bake", frozen)]
pub struct Baked {
    bytes: Vec<u8>,
}

impl Baked {
    fn baked(&self) -> PyResult<casca_bake::Baked<'_>> {
        // All of it was checked when it was read.
        casca_bake::Baked::open(&self.bytes).map_err(refused)
    }
}

#[pymethods]
impl Baked {
    #[new]
    fn new(py: Python, file: PathBuf) -> PyResult<Self> {
        py.detach(|| {
            let name = file.display();
            let unread = |why| PyOSError::new_err(format!("cannot read {name}: {why}"));
            let bytes = std::fs::read(&file).map_err(unread)?;
            casca_bake::Baked::read(&bytes).map_err(|why| refused(format!("{name}: {why}")))?;
            Ok(Self { bytes })
        })
    }

    /// The objects that can be seen from a place; `None` if nothing is known about it.
    fn at<'py>(&self, py: Python<'py>, place: Given) -> PyResult<Option<Bound<'py, PyArray1<u32>>>> {
        let place = self::place("place", place)?;
        Ok(self.baked()?.set_at(place).map(|set| set.iter().collect::<Vec<_>>().into_pyarray(py)))
    }

    /// The set of a cell; `None` if it has none.
    fn cell<'py>(&self, py: Python<'py>, number: Given) -> PyResult<Option<Bound<'py, PyArray1<u32>>>> {
        let number = cell_number(number)?;
        Ok(self.baked()?.set(number).map(|set| set.iter().collect::<Vec<_>>().into_pyarray(py)))
    }

    /// Cells along x, y and z.
    #[getter]
    fn dims(&self) -> PyResult<(u32, u32, u32)> {
        Ok(self.baked()?.cells().dims.into())
    }

    /// The least corner of the grid.
    #[getter]
    fn low(&self) -> PyResult<(f64, f64, f64)> {
        Ok(self.baked()?.cells().low.into())
    }

    /// The edges of a cell.
    #[getter]
    fn size(&self) -> PyResult<(f64, f64, f64)> {
        Ok(self.baked()?.cells().size.into())
    }

    /// The number of objects.
    #[getter]
    fn objects(&self) -> PyResult<u32> {
        Ok(self.baked()?.objects())
    }

    /// Whether sets hold cells of the grid itself.
    #[getter]
    fn cell_to_cell(&self) -> PyResult<bool> {
        Ok(self.baked()?.is_cell_to_cell())
    }

    /// Whether an eye in one box may see a point in another; true in doubt.
    fn may_see(&self, eyes: Given, target: Given) -> PyResult<bool> {
        Ok(self.baked()?.may_see(span("eyes", eyes)?, span("target", target)?))
    }

    /// The number of cells that have a set.
    fn __len__(&self) -> PyResult<usize> {
        let baked = self.baked()?;
        let count: u32 = baked.cells().dims.iter().product();
        Ok((0..count).filter(|&cell| baked.set_number(cell).is_some()).count())
    }
}
