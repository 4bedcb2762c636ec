//! The thesis' text format and Wavefront OBJ.

use glam::Vec3;

use super::error::{FileError, Lines, broken};
use super::words::{Words, parse, words};

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
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let words = words(line);
        match words.split_first() {
            Some((&"v", rest)) => {
                let [x, y, z] = rest
                    .first_chunk()
                    .ok_or_else(|| broken("line", i + 1, "a vertex of less than 3 numbers"))?;
                let number = |w| parse(w, "a coordinate", i + 1);
                points.push(Vec3::new(number(x)?, number(y)?, number(z)?));
            }
            Some((&"l", rest)) => {
                let vertex = |word: &&str| {
                    // Texture coordinates may follow a slash; negative numbers count from the last
                    // vertex.
                    let number: i64 =
                        parse(word.split('/').next().unwrap_or(word), "a vertex number", i + 1)?;
                    let index = if number < 0 { points.len() as i64 + number } else { number - 1 };
                    let point = usize::try_from(index).ok().and_then(|p| points.get(p)).copied();
                    point.ok_or_else(|| broken("line", i + 1, format!("there is no vertex {number}")))
                };
                lines.push(rest.iter().map(vertex).collect::<Result<_, _>>()?);
            }
            _ => {}
        }
    }
    Ok(lines)
}
