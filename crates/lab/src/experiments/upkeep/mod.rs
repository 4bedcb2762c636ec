//! Upkeep of moving objects: the library's grid against the structures that the thesis wished to
//! compare it with.

mod arena;
mod structures;

use casca::{Aabb, MOST_NEW_VOLUMES, Method, cell_for};

use super::stage::{Stage, Telling, frame_of, ms};
use super::{ASPECT, Lab, LabError, Section, Table, grouped, median};
use arena::Arena;
use casca_scenes::drive::view_of;
use casca_scenes::measure::timed;
use casca_scenes::world::{Camera, FRAME_SECONDS, Object};
use casca_truth::oracle::ItemBuffer;
use structures::{Box3, Frustum, Structure};

/// Frames between two steps of settling.
const STRIDE: usize = 30;
/// The library's ways: name, method and how motion is told.
const WAYS: [(&str, Method, Telling); 4] = [
    ("casca point", Method::point(), Telling::Always),
    ("casca point, on expiry", Method::point(), Telling::OnExpiry),
    ("casca cell", Method::cell(), Telling::Always),
    ("casca frustum", Method::Frustum, Telling::Always),
];

/// The linear array and the default method among the rows of an arena.
const LINEAR: usize = 0;
const POINT: usize = 2;

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Sampling {
    /// Steps of half a second before the first frames.
    settle: usize,
    /// Frames before the first one that counts: after such steps all volumes are about to end.
    steady: usize,
    frames: usize,
    /// How many of those are compared with what is exactly visible.
    judged: usize,
    /// Pixels of a row of the item buffer.
    width: usize,
}

/// The results of one structure in one arena, for a frame.
#[derive(Debug, Clone)]
struct Row {
    name: &'static str,
    /// Medians in milliseconds.
    update: f64,
    query: f64,
    /// Moving objects returned, and exactly visible: means over the judged frames.
    returned: f64,
    visible: f64,
    /// Visible objects that were not returned, in all judged frames.
    lost: usize,
}

/// What is measured of a structure, frame by frame.
#[derive(Default)]
struct Record {
    update: Vec<f64>,
    query: Vec<f64>,
    returned: usize,
    lost: usize,
    judged: usize,
}

fn boxes(objects: &[Object]) -> Vec<Box3> {
    objects.iter().map(|object| object.shape.bounds()).collect()
}

/// Updates and asks all structures but the library's ways. `seen` are the moving objects that are
/// exactly visible in a frame, where it is judged; `first` is the first moving object of the world.
fn measure_others(
    structures: &mut [Structure],
    records: &mut [Record],
    now: &[Box3],
    camera: &Camera,
    (first, seen): (usize, Option<&[usize]>),
) -> Result<(), LabError> {
    let frustum = Frustum::of(camera);
    let mut expected: Option<Vec<u32>> = None;
    for (structure, record) in structures.iter_mut().zip(records) {
        let ((), time) = timed(|| structure.update(now));
        record.update.push(ms(time));
        let mut found = Vec::new();
        let ((), time) = timed(|| structure.query(&frustum, &mut found));
        record.query.push(ms(time));
        found.sort_unstable();
        if let Some(seen) = seen {
            record.judged += 1;
            record.returned += found.len();
            let lost = |&&i: &&usize| found.binary_search(&((i - first) as u32)).is_err();
            record.lost += seen.iter().filter(lost).count();
        }
        match &expected {
            None => expected = Some(found),
            Some(linear) if *linear != found => {
                let name = structure.name();
                return Err(format!("{name} finds other boxes than the linear array").into());
            }
            Some(_) => {}
        }
    }
    Ok(())
}

/// Measures all structures in one arena, in turns.
fn measure(arena: Arena, sampling: Sampling, progress: &dyn Fn(&str)) -> Result<Vec<Row>, LabError> {
    let mut world = arena.build();
    let first = arena.first();
    let cell = cell_for(Aabb::new(world.grid.min, world.grid.max), arena.count)?;
    let mut stages = Vec::new();
    for (_, method, telling) in WAYS {
        stages.push(Stage::new(&world, cell, method, telling)?);
    }
    let mut buffer = ItemBuffer::new(sampling.width, (sampling.width as f32 / ASPECT) as usize);
    let mut structures: Vec<Structure> = Vec::new();
    let mut records: Vec<Record> = Vec::new();
    let (mut visible, mut judged) = (0, 0);
    let begin = sampling.settle + sampling.steady;
    for step in 0..begin + sampling.frames {
        progress(&format!("upkeep of {}, step {step}", arena.count));
        let measured = step >= begin;
        let frame = frame_of(step, sampling.settle, STRIDE);
        let moved = world.set_frame(frame);
        let camera = world.camera(frame, ASPECT);
        let view = view_of(&camera)?;
        // The others need no time to settle; they start a frame before the first that counts.
        if step + 1 == begin || structures.is_empty() && measured {
            let now = boxes(&world.objects[first..]);
            structures = vec![Structure::linear(&now), Structure::tree(&now)];
            records.resize_with(structures.len() + stages.len(), Record::default);
        }
        let judge = measured && judged < sampling.judged;
        let seen: Vec<usize> = if judge {
            judged += 1;
            buffer.render(&world.objects, &camera);
            (first..world.objects.len()).filter(|&i| buffer.visible()[i] > 0).collect()
        } else {
            Vec::new()
        };
        visible += seen.len();
        if measured {
            let now = boxes(&world.objects[first..]);
            let seen = judge.then_some(&seen[..]);
            measure_others(&mut structures, &mut records, &now, &camera, (first, seen))?;
        }
        let others = structures.len();
        for (i, stage) in stages.iter_mut().enumerate() {
            let before = stage.upkeep(frame as f64 * FRAME_SECONDS, &world.objects, &moved)?;
            let query = stage.look(&view, 1);
            let after = stage.end()?;
            if measured {
                let record = &mut records[others + i];
                if judge {
                    record.judged += 1;
                    record.returned += stage.found().filter(|&o| o >= first).count();
                }
                record.lost += seen.iter().filter(|&&o| !stage.sees(o)).count();
                record.query.push(query);
                record.update.push(before + after);
            }
        }
    }
    let names = structures.iter().map(|s| s.name()).chain(WAYS.map(|w| w.0));
    let rows = names.zip(records).map(|(name, mut r)| Row {
        name,
        update: median(&mut r.update),
        query: median(&mut r.query),
        returned: r.returned as f64 / r.judged.max(1) as f64,
        visible: visible as f64 / judged.max(1) as f64,
        lost: r.lost,
    });
    Ok(rows.collect())
}

/// Measures upkeep and query of moving objects in the library and in other structures.
///
/// # Errors
/// If a structure finds other boxes in the frustum than a linear array, or a scene is refused.
pub fn upkeep(lab: &Lab) -> Result<Section, LabError> {
    let count = lab.pick(100_000, 2000);
    let mut arenas = Vec::new();
    for (hidden, fast) in [(true, false), (true, true), (false, false), (false, true)] {
        let sampling = Sampling {
            // A frame puts at most `MOST_NEW_VOLUMES` objects into volumes; in the open, only those
            // outside the frustum get one.
            settle: lab.pick(if hidden { 15 + usize::div_ceil(count, MOST_NEW_VOLUMES) } else { 3 }, 4),
            steady: lab.pick(45, 1),
            frames: lab.pick(9, 3),
            judged: lab.pick(2, 1),
            width: lab.pick(1920, 960),
        };
        arenas.push(measure(Arena { count, hidden, fast, seed: lab.seed }, sampling, lab.progress)?);
    }
    let mut section = Section::new("Upkeep of moving objects, against trees and arrays");
    section.text(
        "The thesis ends with the wish to compare its grid with hierarchies. Here all objects move in every \
         frame: small spheres in a hall of 128x48x128 m, slowly (up to 0.5 m/s) or fast (up to 20 m/s), in \
         the open (*visible*) or behind a wall with a gate of 3x3 m (*hidden*). An array and a bounding \
         volume hierarchy collect the boxes in the frustum; **casca answers a harder question:** which \
         objects are not hidden. Its *update* is the clock, all reports and the feedback of the result; *on \
         expiry*, hidden objects are reported only when asked for. Medians over frames.",
    );
    section.table(summary(count, &arenas));
    let lost: usize = arenas.iter().flatten().map(|r| r.lost).sum();
    section.text(match lost {
        0 => "No visible object is missing from any result, in all frames compared.".to_owned(),
        n => format!("{n} visible objects are missing from results, in all frames compared."),
    });
    Ok(section)
}

/// Update + query, by structure and arena.
fn summary(count: usize, arenas: &[Vec<Row>]) -> Table {
    let first = format!("{} moving objects: update + query, ms", grouped(count));
    let columns = [&*first, "hidden, slow", "hidden, fast", "visible, slow", "visible, fast"];
    let mut table = Table::new("upkeep-summary", &columns);
    let mut add = |name: &str, cell: &dyn Fn(&[Row]) -> String| {
        table.row(std::iter::once(name.to_owned()).chain(arenas.iter().map(|rows| cell(rows))));
    };
    for (i, row) in arenas[0].iter().enumerate() {
        add(row.name, &|rows| {
            let Row { update, query, .. } = &rows[i];
            format!("{update:.2} + {query:.2} = {:.2}", update + query)
        });
    }
    add("objects in the frustum", &|rows| format!("{:.0}", rows[LINEAR].returned));
    add("objects in the PVS of point", &|rows| format!("{:.0}", rows[POINT].returned));
    add("exactly visible", &|rows| format!("{:.0}", rows[POINT].visible));
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: Sampling = Sampling { settle: 5, steady: 2, frames: 4, judged: 4, width: 640 };

    #[test]
    fn all_structures_find_what_the_array_finds_and_the_library_all_that_is_visible() {
        for (hidden, fast) in [(true, true), (true, false), (false, true)] {
            let arena = Arena { count: 400, hidden, fast, seed: 5 };
            let rows = measure(arena, SMALL, &|_| ()).expect("structures agree");
            assert_eq!(rows.len(), 2 + WAYS.len());
            let [linear, point] = [LINEAR, POINT].map(|i| &rows[i]);
            assert_eq!([linear.name, point.name], ["linear array", "casca point"]);
            assert!(linear.returned > 50.0 && linear.visible > 0.0, "{linear:?}");
            for row in &rows {
                assert_eq!(row.lost, 0, "{row:?}");
                assert!(row.returned + 1e-9 >= row.visible, "{row:?}");
            }
            assert_eq!(point.returned < 0.5 * linear.returned, hidden, "{point:?}");
        }
    }
}
