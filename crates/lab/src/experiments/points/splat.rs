//! The splat operator: radius, filter, size of the picture, tolerance, and the automatic radius.

use std::collections::HashMap;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use casca_points::Camera;
use casca_points::spacing::{automatic_radius, radii};
use casca_points::splat::{Bias, Filter, Radius, SplatOptions};

use super::cloud::Cloud;
use super::judge::{COLUMNS, Confusion};
use super::study::{RADII, SIZE, Study, Sweep, THESIS_BIAS, TOLERANCE, best, by_splats, line, steps, sweep};
use crate::experiments::{LabError, Table};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::random::Generator;

const FILTERS: [(&str, Filter); 4] =
    [("none", Filter::None), ("max", Filter::Max), ("plain max", Filter::PlainMax), ("min", Filter::Min)];

/// Radii in spacings.
fn radii_of(study: &Study) -> Vec<f64> {
    let logs = steps(-2.0, 1.5, study.lab.pick(0.125, 0.5));
    logs.into_iter().map(|log| log.exp2()).collect()
}

/// The nearest of the marked points in each pixel.
fn one_per_pixel(cloud: &Cloud, camera: &Camera, marked: &BitSlice) -> BitVec {
    let mut nearest: HashMap<(u32, u32), (f32, usize)> = HashMap::new();
    for i in marked.iter_ones() {
        let Some(at) = camera.project(cloud.points[i]) else { continue };
        let place = nearest.entry((at.x as u32, at.y as u32)).or_insert((at.depth, i));
        if at.depth < place.0 {
            *place = (at.depth, i);
        }
    }
    let mut kept = BitVec::repeat(false, marked.len());
    nearest.values().for_each(|&(_, i)| kept.set(i, true));
    kept
}

/// Errors against the radius for each filter and size of picture, by both protocols.
pub(super) fn filters(study: &mut Study) -> Result<(), LabError> {
    let hare = study.hare();
    let sizes = study.lab.pick(vec![SIZE, (1024, 768), (2048, 1536)], vec![SIZE]);
    let heads: Vec<&str> =
        ["picture", "filter", "protocol", "R / spacing"].into_iter().chain(COLUMNS).collect();
    let (mut rows, mut table) = (Table::new("points-splat", &heads), Table::new("points-splat-best", &heads));
    let values = radii_of(study);
    let mut first: Vec<(&str, Sweep)> = Vec::new();
    for size in sizes {
        let camera = hare.look.camera(size)?;
        let truth = one_per_pixel(hare, &camera, &hare.truth);
        for (name, filter) in FILTERS {
            (study.lab.progress)(&format!("splats: {}x{}, {name}", size.0, size.1));
            let (mut all, mut single) = (Sweep::new(), Sweep::new());
            for &value in &values {
                let radius = Radius::Same(value as f32 * hare.spacing);
                let found = by_splats(
                    hare,
                    size,
                    &SplatOptions { radius, bias: THESIS_BIAS, filter, slopes: false },
                )?;
                all.push((value, Confusion::of(&hare.truth, &found)));
                single.push((value, Confusion::of(&truth, &one_per_pixel(hare, &camera, &found))));
            }
            for (protocol, sweep) in [("all points", &all), ("one per pixel", &single)] {
                let cells = |(r, counts): &(f64, Confusion)| {
                    let about = [
                        format!("{}x{}", size.0, size.1),
                        name.to_owned(),
                        protocol.to_owned(),
                        format!("{r:.2}"),
                    ];
                    about.into_iter().chain(counts.cells())
                };
                sweep.iter().for_each(|at| rows.row(cells(at)));
                table.row(cells(&best(sweep)));
            }
            if size == SIZE {
                first.push((name, all));
            }
        }
    }
    study.section.text(
        "### Splats: radius, filter and size of the picture\n\nPoints of the hare are drawn as squares into a depth image, which a 3x3 filter changes; points more \
         than 0.05 of the depth range behind it are hidden (the thesis' tolerance). The table has the best radius of each row. *All points*: each point is judged. \
         *One per pixel*, as in the thesis: of the truly visible and of the found points only the nearest in each pixel counts, and the two sets are compared.",
    );
    let least = |name: &str| first.iter().find(|f| f.0 == name).map_or(f64::NAN, |f| best(&f.1).1.error());
    let title = format!(
        "Splats at 640x480: the least E is {:.2}% with the max filter, {:.2}% without, {:.2}% with the min filter",
        least("max"),
        least("none"),
        least("min")
    );
    let drawn: Vec<Line> = first
        .iter()
        .enumerate()
        .map(|(i, (name, s))| Line::new(*name, other(i), line(s, Confusion::error)))
        .collect();
    let axes = (&Axis::log("half side of the squares, in spacings"), &Axis::log("E, percent"));
    let file = "points-splat.svg";
    lines(
        &study.lab.folder.join(file),
        &title,
        "Small squares leave gaps, large ones hide what is beside silhouettes.",
        axes,
        &drawn,
    )?;
    study.section.picture(file, &title);
    study.section.table(table);
    study.section.rows("All radii as CSV", rows);
    let none = least("none");
    study.target(
        "Splats at 640x480 with the thesis' tolerance: least E with the max filter, beside that without",
        least("max"),
        none,
        "%",
    );
    Ok(())
}

/// Errors against the tolerance, in depths of the window and in the world, each at the best radius.
pub(super) fn bias(study: &mut Study) -> Result<(), LabError> {
    let hare = study.hare();
    let values = radii_of(study);
    // The tolerance of a window's part in the middle of the hare, in spacings.
    let (far, middle) = (f64::from(hare.look.depths.1), f64::from(hare.look.eye.distance(hare.look.target)));
    let in_spacings =
        |part: f64| (middle * far / ((1.0 - part) * far + part * middle) - middle) / f64::from(hare.spacing);
    let parts = study
        .lab
        .pick(vec![0.005, 0.01, 0.015, 0.02, 0.025, 0.035, 0.05, 0.075, 0.1, 0.15], vec![0.02, 0.05]);
    let heads: Vec<&str> =
        ["tolerance", "filter", "in spacings", "R / spacing"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::new("points-bias", &heads);
    let mut drawn = Vec::new();
    let mut least: Vec<(f64, Confusion)> = Vec::new();
    let ways = [("window", Filter::Max), ("world", Filter::Max), ("world", Filter::None)];
    for (i, (way, filter)) in ways.into_iter().enumerate() {
        let name = FILTERS.iter().find(|f| f.1 == filter).map_or("", |f| f.0);
        let mut errors = Sweep::new();
        for &part in &parts {
            (study.lab.progress)(&format!("tolerance of splats: {way}, {name}, {part}"));
            let length = in_spacings(part);
            let bias = match way {
                "window" => Bias::Window(part as f32),
                _ => Bias::World(length as f32 * hare.spacing),
            };
            let ask = |r: f64| {
                let radius = Radius::Same(r as f32 * hare.spacing);
                by_splats(hare, SIZE, &SplatOptions { radius, bias, filter, slopes: false })
            };
            let (radius, counts) = best(&sweep(hare, &values, ask)?);
            let value = if way == "window" { format!("window {part}") } else { "world".to_owned() };
            let cells = [value, name.to_owned(), format!("{length:.2}"), format!("{radius:.2}")];
            table.row(cells.into_iter().chain(counts.cells()));
            errors.push((length, counts));
        }
        let style = if way == "world" { other(i) } else { other(i).dashed() };
        drawn.push(Line::new(format!("{way}, filter {name}"), style, line(&errors, Confusion::error)));
        least.push(best(&errors));
    }
    let [(_, window), (length, with), (_, without)] = least[..] else { return Ok(()) };
    let title = format!(
        "The tolerance matters as much as the radius: E is least at {length:.1} spacings, {:.2}% with the max filter and {:.2}% without",
        with.error(),
        without.error()
    );
    let axes = (&Axis::log("tolerance in the middle of the hare, in spacings"), &Axis::log("E, percent"));
    let file = "points-bias.svg";
    let subtitle = "E by the tolerance, at the best radius for each; 640x480.";
    lines(&study.lab.folder.join(file), &title, subtitle, axes, &drawn)?;
    study.section.text(format!(
        "### Splats: the tolerance\n\nThe thesis' 0.05 of the window's depth is {:.1} spacings in the middle of the hare, more than is good for it; the best part gives {:.2}%. A part \
         changes with the far plane and with the distance, a length in the world does not. Each row has the best of {} radii.",
        in_spacings(0.05), window.error(), values.len()
    ));
    study.section.picture(file, &title);
    study.section.table(table);
    study.target(
        "Splats at 640x480 with the best tolerance: least E with the max filter, beside that without",
        with.error(),
        without.error(),
        "%",
    );
    Ok(())
}

/// The automatic radius and that for each point, beside the best by hand.
pub(super) fn automatic(study: &mut Study) -> Result<(), LabError> {
    let seed = study.lab.seed;
    let uneven = study.hare().filtered(seed, thinned);
    let in_view = |cloud: &Cloud| -> Result<Cloud, LabError> {
        let camera = cloud.look.camera(SIZE)?;
        Ok(cloud.filtered(seed, |p, _| camera.project(p).is_some()))
    };
    let mut clouds: Vec<Cloud> = study.clouds.iter().map(in_view).collect::<Result<_, _>>()?;
    clouds.push(Cloud { name: "hare, one half thinned to a tenth".to_owned(), ..uneven });
    let heads: Vec<&str> =
        ["cloud, points in view", "radius", "R / spacing"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::new("points-automatic", &heads);
    let values = radii_of(study);
    let mut ratios = Vec::new();
    for cloud in &clouds {
        (study.lab.progress)(&format!("automatic radius, {}", cloud.name));
        // Near and far planes of rooms are far apart: a tolerance in the world is the one to
        // compare with.
        let bias = Bias::World(TOLERANCE * cloud.spacing);
        let ask = |radius, bias| {
            by_splats(cloud, SIZE, &SplatOptions { radius, bias, filter: Filter::Max, slopes: false })
        };
        let judge = |found: BitVec| Confusion::of(&cloud.truth, &found);
        let by_hand = best(&sweep(cloud, &values, |r| ask(Radius::Same(r as f32 * cloud.spacing), bias))?);
        let size = automatic_radius(&cloud.points)?;
        let own = judge(ask(Radius::Same(size), bias)?);
        let alone = judge(ask(Radius::Same(size), Bias::World(RADII * size))?);
        let each = radii(&cloud.points)?;
        let local = judge(ask(Radius::Each(&each), bias)?);
        let spacings = format!("{:.2}", size / cloud.spacing);
        for (way, at, counts) in [
            ("by hand", format!("{:.2}", by_hand.0), by_hand.1),
            ("automatic", spacings.clone(), own),
            ("automatic, as is the tolerance", spacings, alone),
            ("one for each point", String::new(), local),
        ] {
            table.row([cloud.name.clone(), way.to_owned(), at].into_iter().chain(counts.cells()));
        }
        ratios.push(own.error() - by_hand.1.error());
    }
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    study.section.text(format!(
        "### Splats: the automatic radius\n\n640x480, max filter, a tolerance of {TOLERANCE} spacings in the world. *By hand* is the best of {} radii, chosen with the truth at \
         hand. *Automatic* is half the distance to the sixth neighbour that 95% of the points do not exceed; with a tolerance of {RADII} such radii nothing is given by hand. *One for each point* is half of its own. On no cloud is the \
         automatic radius worse than the best by more than {worst:.1} points of E.",
        values.len()
    ));
    study.section.table(table);
    Ok(())
}

/// Keeps one in ten of the points of one half.
pub(super) fn thinned(p: glam::Vec3, random: &mut Generator) -> bool {
    use rand::RngExt;
    p.x < 0.2 || random.random::<f32>() < 0.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_each_pixel_the_nearest_marked_point_stays() {
        let mut cloud = Cloud::sphere(4);
        let eye = cloud.look.eye;
        cloud.points = vec![eye * 0.1, eye * 0.2, eye * 0.3, glam::Vec3::new(0.0, 0.5, 0.0)];
        let camera = cloud.look.camera(SIZE).unwrap();
        let kept = |marked: [bool; 4]| {
            let marked: BitVec = marked.into_iter().collect();
            one_per_pixel(&cloud, &camera, &marked).iter_ones().collect::<Vec<_>>()
        };
        assert_eq!(kept([true, true, false, true]), [1, 3]);
        assert_eq!(kept([true, false, false, false]), [0]);
        assert!(kept([false; 4]).is_empty());
    }
}
