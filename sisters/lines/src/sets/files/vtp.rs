//! VTK's XML files of lines.
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>

mod numbers;

use roxmltree::{Document, Node};

use super::bytes::Kind;
use super::error::{FileError, refused};
use super::polydata::{Array, Piece, lines};
use crate::sets::LineSet;
use numbers::{Store, kind_named};

/// Starts the part that follows the XML and need not be text.
const APPENDED: &[u8] = b"<AppendedData";

/// The lines of a file of PolyData, with the arrays of their points and cells.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let start = bytes.windows(APPENDED.len()).position(|w| w == APPENDED);
    let (text, appended) = bytes.split_at(start.unwrap_or(bytes.len()));
    // Letters of other encodings stand in names and comments only.
    let text = String::from_utf8_lossy(text);
    let closed = if start.is_some() { format!("{text}</VTKFile>") } else { text.into_owned() };
    let document = Document::parse(&closed).map_err(|why| refused(format!("the XML is broken: {why}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" {
        return Err(refused("the XML is no VTKFile"));
    }
    let kind = root.attribute("type").unwrap_or_default();
    let Some(data) = child(root, "PolyData").filter(|_| kind == "PolyData") else {
        let kind: String = kind.chars().take(30).collect();
        return Err(refused(format!("a VTKFile of {kind}: only PolyData is read")));
    };
    let mut store = Store::new(root, appended, bytes.len())?;
    let pieces = data.children().filter(|n| n.has_tag_name("Piece"));
    let pieces = pieces.map(|n| piece(n, &mut store)).collect::<Result<Vec<_>, _>>()?;
    lines(pieces, bytes.len())
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|n| n.has_tag_name(name))
}

fn arrays<'a>(node: Node<'a, 'a>, of: &str) -> impl Iterator<Item = Node<'a, 'a>> + use<'a> {
    child(node, of).into_iter().flat_map(|n| n.children().filter(|n| n.has_tag_name("DataArray")))
}

fn piece<'a>(node: Node<'a, 'a>, store: &mut Store<'_>) -> Result<Piece, FileError> {
    let count = |name: &str| -> Result<usize, FileError> {
        let text = node.attribute(name).unwrap_or("0");
        let number: u32 =
            text.trim().parse().map_err(|_| refused(format!("{name} is no number of something")))?;
        Ok(number as usize)
    };
    let mut piece = Piece {
        vertices: count("NumberOfVerts")?,
        surfaces: count("NumberOfPolys")?.saturating_add(count("NumberOfStrips")?),
        ..Piece::default()
    };
    if let Some(points) = arrays(node, "Points").next() {
        let values = store.floats(points)?;
        piece.points = values.as_chunks::<3>().0.iter().map(|p| (*p).into()).collect();
    }
    if piece.points.len() != count("NumberOfPoints")? {
        return Err(refused(format!("a piece has {} points, not as many as it says", piece.points.len())));
    }
    for array in arrays(node, "Lines") {
        match array.attribute("Name") {
            Some("connectivity") => piece.connectivity = store.indices(array)?,
            Some("offsets") => piece.ends = store.indices(array)?,
            _ => {}
        }
    }
    if piece.ends.len() != count("NumberOfLines")? {
        return Err(refused(format!("a piece has {} lines, not as many as it says", piece.ends.len())));
    }
    piece.point_data = data(node, "PointData", store)?;
    piece.cell_data = data(node, "CellData", store)?;
    Ok(piece)
}

/// The arrays of points or cells; those of other things than numbers are left out.
fn data<'a>(node: Node<'a, 'a>, of: &str, store: &mut Store<'_>) -> Result<Vec<Array>, FileError> {
    let mut all = Vec::new();
    for (i, array) in arrays(node, of).enumerate() {
        let Some(kind) = kind_named(array) else { continue };
        let name = array.attribute("Name").map_or_else(|| format!("array {}", i + 1), str::to_owned);
        let components = array.attribute("NumberOfComponents").unwrap_or("1");
        let components: u32 = components
            .trim()
            .parse()
            .map_err(|_| refused(format!("the array {name} has no number of components")))?;
        let (values, bytes) = (store.floats(array)?, kind == Kind::Unsigned(1));
        all.push(Array { name, components: components as usize, values, bytes });
    }
    Ok(all)
}
