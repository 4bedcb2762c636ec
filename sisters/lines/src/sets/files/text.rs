//! The thesis' text format and Wavefront OBJ.

use glam::Vec3;

use super::error::{FileError, Lines, Lists, broken};
use super::words::{Words, lines, parse, real, words};

/// The thesis' format: the number of lines, the number of vertices of each, and the vertices.
pub(super) fn thesis(bytes: &[u8]) -> Lines {
    let mut file = Words::new(bytes, 1);
    let lines: usize = file.number("the number of lines")?;
    // Each line needs at least a digit and a space: a header cannot ask for more than the file
    // holds.
    let mut counts = Vec::with_capacity(lines.min(bytes.len() / 2));
    for _ in 0..lines {
        counts.push(file.number::<usize>("a number of vertices")?);
    }
    let mut line = |n: usize| (0..n).map(|_| file.point()).collect::<Result<Vec<Vec3>, FileError>>();
    let all = counts.into_iter().map(&mut line).collect::<Result<_, _>>()?;
    match file.next() {
        Some(_) => Err(broken("line", file.line, "the file goes on after the last vertex")),
        None => Ok(all),
    }
}

/// The lines of an OBJ file; statements other than `v` and `l` are passed over.
pub(super) fn obj(bytes: &[u8]) -> Lines {
    let (points, lines) = lists(bytes, "l")?;
    Ok(lines.iter().map(|line| line.iter().map(|&v| points[v as usize]).collect()).collect())
}

/// The vertices of an OBJ file, and their numbers in each statement with a name; these are there.
pub(super) fn lists(bytes: &[u8], statement: &str) -> Lists {
    let (mut points, mut named) = (Vec::new(), Vec::new());
    for (i, line) in lines(bytes).enumerate() {
        let words = words(line);
        match words.split_first() {
            Some((&"v", rest)) => {
                let [x, y, z] = rest
                    .first_chunk()
                    .ok_or_else(|| broken("line", i + 1, "a vertex of less than 3 numbers"))?;
                let coordinate = |w| real(w, "a coordinate", i + 1);
                points.push(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?));
            }
            Some((name, rest)) if *name == statement => {
                let vertex = |word: &&str| {
                    // Texture coordinates may follow a slash; negative numbers count from the last
                    // vertex.
                    let named: i64 = parse(word.split('/').next().unwrap_or(word), "a vertex number", i + 1)?;
                    let index = if named < 0 { points.len() as i64 + named } else { named - 1 };
                    let index = usize::try_from(index).ok().filter(|&p| p < points.len());
                    let none = || broken("line", i + 1, format!("there is no vertex {named}"));
                    number(index.ok_or_else(none)?, i + 1)
                };
                named.push(rest.iter().map(vertex).collect::<Result<_, _>>()?);
            }
            _ => {}
        }
    }
    Ok((points, named))
}

/// The number of a vertex as 32 bits.
fn number(index: usize, line: usize) -> Result<u32, FileError> {
    u32::try_from(index).map_err(|_| broken("line", line, "more vertices than 32 bits can number"))
}
