//! Arguments that hold numbers: what each must be, and its numbers.

use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyException, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBool, PyList, PyTuple};

use crate::error::{check, refused};

/// An argument as Python gives it.
pub type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// What an argument must be.
pub struct Form {
    name: &'static str,
    /// 0 stands for any length.
    shape: &'static [usize],
    /// In words.
    what: &'static str,
}

const FLOATS: &str = "floats";
const INTEGERS: &str = "integers";

impl Form {
    pub const fn new(name: &'static str, shape: &'static [usize], what: &'static str) -> Self {
        Self { name, shape, what }
    }

    /// What is said of an argument that is something else.
    fn wanted(&self, numbers: &str, came: &str) -> String {
        let mut any = ["n", "m"].into_iter();
        let side = |&side: &usize| match side {
            0 => any.next().unwrap_or("any").into(),
            side => side.to_string(),
        };
        let sides = self.shape.iter().map(side).collect::<Vec<String>>().join(", ");
        let comma = if self.shape.len() == 1 { "," } else { "" };
        format!("{} must have shape ({sides}{comma}): {}, as {numbers}; got {came}", self.name, self.what)
    }

    /// Whether an array has the shape. A list without entries has it, too.
    fn fits(&self, shape: &[usize]) -> bool {
        let is_side = |(wanted, side): (&usize, &usize)| *wanted == 0 || wanted == side;
        let is_empty = self.shape[0] == 0 && shape == [0];
        is_empty || shape.len() == self.shape.len() && self.shape.iter().zip(shape).all(is_side)
    }

    /// The name of a number of the array, as in "boxes[3, 0, 1]".
    fn at(&self, shape: &[usize], index: usize) -> String {
        let mut left = index;
        let mut places: Vec<String> = Vec::new();
        for side in shape.iter().rev() {
            places.push((left % side).to_string());
            left /= side;
        }
        places.reverse();
        format!("{}[{}]", self.name, places.join(", "))
    }
}

/// Numbers one after the other, and the shape that they had.
enum Flat<'py, T: Element> {
    Lent(PyReadonlyArrayDyn<'py, T>),
    Made(Vec<T>, Vec<usize>),
}

impl<'py, T: Element + Copy> Flat<'py, T> {
    /// An array whose numbers can be read where they are. Those that came over a network often do
    /// not lie at addresses of their size.
    fn lent(array: &Bound<'py, PyAny>) -> Option<Self> {
        let array = array.cast::<PyArrayDyn<T>>().ok()?;
        let usable = array.is_c_contiguous() && (array.data() as usize).is_multiple_of(align_of::<T>());
        usable.then(|| array.try_readonly().ok().map(Self::Lent)).flatten()
    }

    fn numbers(&self) -> &[T] {
        match self {
            Self::Lent(array) => array.as_slice().unwrap_or_default(),
            Self::Made(numbers, _) => numbers,
        }
    }

    fn shape(&self) -> &[usize] {
        match self {
            Self::Lent(array) => array.shape(),
            Self::Made(_, shape) => shape,
        }
    }
}

/// What numpy makes of an argument, of the shape, and of one of some kinds of types.
fn array<'py>(
    form: &Form,
    object: Given<'_, 'py>,
    kinds: &str,
    numbers: &str,
) -> PyResult<(Bound<'py, PyUntypedArray>, char)> {
    let py = object.py();
    let (is_array, numpy) = (object.cast::<PyUntypedArray>().is_ok(), py.import(intern!(py, "numpy"))?);
    // As objects: of integers of two types numpy makes floats, and of bools integers.
    let list = (numbers == INTEGERS && !is_array && !object.hasattr(intern!(py, "__array__"))?)
        .then(|| [("dtype", "O")].into_py_dict(py))
        .transpose()?;
    let array = numpy.call_method(intern!(py, "asarray"), (object,), list.as_ref()).map_err(|why| {
        let came = format!("a {} that numpy makes no array of: {}", type_name(object), why.value(py));
        if why.is_instance_of::<PyValueError>(py) {
            refused(form.wanted(numbers, &came))
        } else if why.is_instance_of::<PyException>(py) {
            PyTypeError::new_err(form.wanted(numbers, &came))
        } else {
            // What a keyboard interrupts is no fault of the argument.
            why
        }
    })?;
    let array = array.cast_into::<PyUntypedArray>()?;
    let (shape, kind) = (array.shape(), char::from(array.dtype().kind()));
    if shape.is_empty() && !is_array {
        return Err(PyTypeError::new_err(form.wanted(numbers, &format!("a {}", type_name(object)))));
    }
    let came = || match PyTuple::new(py, shape) {
        Ok(shape) => format!("shape {shape} of {}", array.dtype()),
        Err(why) => why.to_string(),
    };
    // What numpy makes of an empty list are floats.
    if !kinds.contains(kind) && list.is_none() && !(shape == [0] && kind == 'f') {
        return Err(PyTypeError::new_err(form.wanted(numbers, &came())));
    }
    check(form.fits(shape), || form.wanted(numbers, &came()))?;
    let masked = object.hasattr(intern!(py, "mask"))? && {
        let of = py.import(intern!(py, "numpy.ma"))?.call_method1(intern!(py, "is_masked"), (object,));
        of?.is_truthy()?
    };
    check(!masked, || format!("{} has entries that are masked: fill them or leave them out", form.name))?;
    Ok((array, kind))
}

fn type_name(object: Given) -> String {
    object.get_type().name().map_or_else(|_| "object".into(), |name| name.to_string())
}

/// The same numbers, of a type and one after the other.
fn cast<'py, T: Element + Copy>(form: &Form, array: &Bound<'py, PyUntypedArray>) -> PyResult<Flat<'py, T>> {
    if let Some(flat) = Flat::lent(array.as_any()) {
        return Ok(flat);
    }
    let how = [("order", "C")].into_py_dict(array.py())?;
    let cast = array.call_method("astype", (T::get_dtype(array.py()),), Some(&how))?;
    Flat::lent(&cast).ok_or_else(|| refused(format!("{} cannot be read", form.name)))
}

/// A float of one of two sizes.
pub trait Float: Element + Copy + Into<f64> {
    fn of(number: f64) -> Self;
}

impl Float for f32 {
    fn of(number: f64) -> Self {
        number as f32
    }
}

impl Float for f64 {
    fn of(number: f64) -> Self {
        number
    }
}

/// Whether numbers must be finite.
#[derive(Clone, Copy, PartialEq)]
pub enum Rule {
    Finite,
    Any,
}

/// The numbers of an argument.
fn floats<'py, T: Float>(form: &Form, object: Given<'_, 'py>, rule: Rule) -> PyResult<Flat<'py, T>> {
    if let Some(few) = few(form, object) {
        let few: Vec<T> = few.into_iter().map(T::of).collect();
        if few.iter().all(|&number| number.into().is_finite()) {
            return Ok(Flat::Made(few, form.shape.to_vec()));
        }
    }
    let (array, _) = array(form, object, "fiu", FLOATS)?;
    let flat = match Flat::<T>::lent(array.as_any()) {
        Some(flat) => flat,
        None => {
            let wide = cast::<f64>(form, &array)?;
            Flat::Made(wide.numbers().iter().map(|n| T::of(*n)).collect(), wide.shape().to_vec())
        }
    };
    let bad = flat.numbers().iter().position(|&n| rule == Rule::Finite && !n.into().is_finite());
    if let Some(bad) = bad {
        let (at, was) = (form.at(flat.shape(), bad), cast::<f64>(form, &array)?.numbers()[bad]);
        return Err(refused(match was.is_finite() {
            true => format!("{at} is {was:e}, which is too large for float32"),
            false => format!("{at} is {was}, but numbers must be finite"),
        }));
    }
    Ok(flat)
}

/// The numbers of a tuple or list that is one entry, without an array in between.
fn few(form: &Form, object: Given) -> Option<Vec<f64>> {
    let &[count] = form.shape else { return None };
    let is_list = object.is_instance_of::<PyTuple>() || object.is_instance_of::<PyList>();
    (is_list && count > 0 && object.len().ok()? == count).then(|| object.extract().ok()).flatten()
}

/// The integer that something is. A bool is none.
pub fn whole<'py>(item: Given<'_, 'py>) -> Option<Bound<'py, PyAny>> {
    let whole = item.call_method0(intern!(item.py(), "__index__"));
    whole.ok().filter(|_| !item.is_instance_of::<PyBool>())
}

/// Arguments that are one integer, from the least to the greatest.
macro_rules! wholes {
    ($($function:ident, $name:literal, $type:ty, $least:literal..=$most:expr;)*) => {
        $(pub fn $function(object: Given) -> PyResult<$type> {
            let kind = || format!("{} must be an integer, not a {}", $name, type_name(object));
            let whole = whole(object).ok_or_else(|| PyTypeError::new_err(kind()))?;
            let number = whole.extract().ok().filter(|number| ($least..=$most).contains(number));
            let number = number.and_then(|number: u64| number.try_into().ok());
            let (least, most) = ($least, $most);
            number.ok_or_else(|| refused(format!("{} must lie between {least} and {most}, not {whole}", $name)))
        })*
    };
}

wholes! {
    queries, "queries", u32, 0..=u64::from(u32::MAX);
    cell_number, "number", u32, 0..=u64::from(u32::MAX);
    rays, "rays", u32, 1..=u64::from(casca_lines::samples::MOST_SAMPLES);
    width, "width", u32, 1..=16_384;
    height, "height", u32, 1..=16_384;
    seed, "seed", u64, 0..=u64::MAX;
    layers, "layers", u64, 0..=u64::MAX;
    mask, "mask", u64, 0..=u64::MAX;
    frame, "frame", usize, 0..=u64::MAX;
    // More threads are a mistake; 0 are those of the machine.
    threads, "threads", usize, 0..=1024;
    own_threads, "threads", usize, 1..=1024;
}

/// The integers of an argument, from 0 to the greatest.
pub fn integers(form: &Form, object: Given, most: u64) -> PyResult<Vec<u64>> {
    let (array, kind) = array(form, object, "iu", INTEGERS)?;
    let shape = array.shape().to_vec();
    let out = |index: usize, was: &dyn std::fmt::Display| {
        refused(format!("{} is {was}, but must lie between 0 and {most}", form.at(&shape, index)))
    };
    let of_item = |(index, item): (usize, PyResult<Bound<PyAny>>)| {
        let item = item?;
        match whole(&item) {
            Some(whole) => whole.extract::<u64>().map_err(|_| out(index, &whole)),
            None => {
                let came = format!("a {} as {}", type_name(&item), form.at(&shape, index));
                Err(PyTypeError::new_err(form.wanted(INTEGERS, &came)))
            }
        }
    };
    let of_signed = |(index, &n): (usize, &i64)| u64::try_from(n).map_err(|_| out(index, &n));
    let numbers: Vec<u64> = match kind {
        'O' => array.call_method0("ravel")?.try_iter()?.enumerate().map(of_item).collect::<PyResult<_>>()?,
        'i' => cast(form, &array)?.numbers().iter().enumerate().map(of_signed).collect::<PyResult<_>>()?,
        _ => cast(form, &array)?.numbers().to_vec(),
    };
    match numbers.iter().position(|number| *number > most) {
        Some(index) => Err(out(index, &numbers[index])),
        None => Ok(numbers),
    }
}

/// The entries of an argument, of so many numbers each.
pub fn entries<T: Float, const N: usize, U>(
    form: &Form,
    object: Given,
    rule: Rule,
    entry: impl FnMut(&[T; N]) -> U,
) -> PyResult<Vec<U>> {
    Ok(floats::<T>(form, object, rule)?.numbers().as_chunks().0.iter().map(entry).collect())
}

/// The numbers of an argument that is one entry.
pub fn one<T: Float, const N: usize>(form: &Form, object: Given) -> PyResult<[T; N]> {
    let numbers = floats::<T>(form, object, Rule::Finite)?;
    numbers.numbers().try_into().map_err(|_| refused(format!("{} must have {N} numbers", form.name)))
}

/// A map: which tiles block sight, row by row; its height and width.
pub fn map(object: Given) -> PyResult<(Vec<bool>, usize, usize)> {
    let form = Form::new("walls", &[0, 0], "n rows of m tiles, those that block sight");
    let (array, kind) = array(&form, object, "biuf", "bools")?;
    let tiles = match kind {
        'b' => cast(&form, &array)?.numbers().to_vec(),
        _ => floats::<f64>(&form, object, Rule::Finite)?.numbers().iter().map(|tile| *tile != 0.0).collect(),
    };
    let [height, width] = <[usize; 2]>::try_from(array.shape()).unwrap_or_default();
    Ok((tiles, height, width))
}
