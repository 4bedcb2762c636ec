//! What thin walls let through, by each way to follow a cone: `docs/soft-walls.csv` and
//! `docs/soft-blind-zone.csv`, written anew by `cargo run --release --features soft --example
//! soft_walls`.

use std::fmt::Write;

use casca::soft::March;

mod leak;

use leak::{Wall, near_wall, through_walls};

const STEPS: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.5];

/// Half-angles of cones by name, and their tangents.
fn cones() -> [(&'static str, f32); 3] {
    [("1 degree", 1f32.to_radians().tan()), ("5 degrees", 5f32.to_radians().tan()), ("30 degrees", 0.57735)]
}

/// Each way by name, with its step.
fn marches(steps: &[f32]) -> Vec<(&'static str, String, March)> {
    let mut all = Vec::new();
    for (name, corrected) in [("old rule", false), ("opacity for the step's length", true)] {
        for &step in steps {
            all.push((name, step.to_string(), March::Samples { step, start: 2.0, first: 2.0, corrected }));
        }
    }
    all.push(("slabs", String::new(), March::Slabs));
    all.push(("exact segment on the axis", String::new(), March::Rays(1)));
    all
}

fn walls() -> Result<String, Box<dyn std::error::Error>> {
    let mut csv = String::from(
        "wall,angle of the ray,half-angle of the cone,way,step,mean leak,greatest leak,mean steps\n",
    );
    let walls = [
        ("1 cell", Wall::Straight(1), [0.0, 45.0].as_slice()),
        ("2 cells", Wall::Straight(2), &[0.0]),
        ("askew by 1:2", Wall::Askew, &[0.0]),
    ];
    for (wall, shape, degrees) in walls {
        for &angle in degrees {
            for (cone, tan) in cones() {
                for (way, step, march) in marches(&STEPS) {
                    let leak = through_walls(shape, angle, tan, &march)?;
                    let (mean, greatest, steps) = (leak.mean, leak.greatest, leak.steps);
                    writeln!(csv, "{wall},{angle},{cone},{way},{step},{mean:.3},{greatest:.3},{steps:.0}")?;
                }
            }
        }
    }
    Ok(csv)
}

fn blind_zone() -> Result<String, Box<dyn std::error::Error>> {
    let mut csv = String::from("cells to the wall,half-angle of the cone,way,leak\n");
    for (cone, tan) in [cones()[0], cones()[2]] {
        for (way, _, march) in marches(&[0.5]) {
            for ahead in 0..9 {
                writeln!(csv, "{ahead},{cone},{way},{:.3}", near_wall(ahead, tan, &march)?)?;
            }
        }
    }
    Ok(csv)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (file, csv) in [("docs/soft-walls.csv", walls()?), ("docs/soft-blind-zone.csv", blind_zone()?)] {
        print!("{csv}");
        std::fs::write(file, csv).map_err(|error| format!("{file}: {error}"))?;
    }
    Ok(())
}
