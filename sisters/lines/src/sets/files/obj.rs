//! Wavefront OBJ.

use glam::Vec3;

use super::error::{Lines, Lists, broken};
use super::words::{lines, parse, real, words};

/// The lines of an OBJ file; statements other than `v` and `l` are passed over.
pub(super) fn read(bytes: &[u8]) -> Lines {
    let (points, lines) = lists(bytes, "l")?;
    Ok(lines.iter().map(|line| line.iter().map(|&v| points[v as usize]).collect()).collect())
}

/// The vertices of an OBJ file, and their numbers in each statement with a name; these are there.
pub(super) fn lists(bytes: &[u8], statement: &str) -> Lists {
    let (mut points, mut named) = (Vec::new(), Vec::new());
    for (i, line) in lines(bytes).enumerate() {
        let fail = |why: String| broken("line", i + 1, why);
        let words = words(line);
        match words.split_first() {
            Some((&"v", rest)) => {
                let few = || fail("a vertex of less than 3 numbers".to_owned());
                let [x, y, z] = rest.first_chunk().ok_or_else(few)?;
                let coordinate = |w| real(w, "a coordinate").map_err(fail);
                points.push(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?));
            }
            Some((name, rest)) if *name == statement => {
                let vertex = |word: &&str| {
                    // Texture coordinates may follow a slash; negative numbers count from the last
                    // vertex.
                    let word = word.split('/').next().unwrap_or(word);
                    let named: i64 = parse(word, "a vertex number").map_err(fail)?;
                    let index = if named < 0 { points.len() as i64 + named } else { named - 1 };
                    let index = usize::try_from(index).ok().filter(|&p| p < points.len());
                    let index = index.ok_or_else(|| fail(format!("there is no vertex {named}")))?;
                    u32::try_from(index).map_err(|_| fail("more vertices than 32 bits can number".into()))
                };
                named.push(rest.iter().map(vertex).collect::<Result<_, _>>()?);
            }
            _ => {}
        }
    }
    Ok((points, named))
}
