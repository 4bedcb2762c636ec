//! The command line, and what it asks for, done.

use std::path::PathBuf;

use casca_lines::gpu::antialiasing::Antialiasing;
use casca_lines::gpu::numeric::MOST_THICK;
use casca_lines::gpu::renderer::Look;
use casca_lines::numeric::{USUAL_RAYS, USUAL_SIDE_RAYS};
use casca_lines::occlusion::Estimator;
use casca_lines::places::Places;
use casca_lines::sets::LineSet;
use casca_lines::sets::colour::Colouring;
use casca_lines::sets::generate::Family;
use casca_lines::sets::region::Region;
use casca_tools::command_line::{EXIT_CODES, direction};
use clap::{Args, ValueEnum};
use glam::Vec3;

use crate::common::{Common, number, one_of};

/// The radius of the thesis' hemispheres, as a share of the extent of the scene.
const RADIUS: f32 = 0.13;
/// Places at most so many times as far apart as they should be take the place of rays. At 16 times,
/// a million streamlines, pictures by places are wrong (Pearson 0.81, rays 0.996).
const MOST_APART: f64 = 2.0;

/// Draws dense sets of lines and darkens lines among other lines, so that one sees which lie in
/// front
///
/// In the window: W A S D Q E fly (Shift: faster), the right mouse button looks around, Space
/// starts and stops the motion, 1 to 4 choose the picture, C switches culling, Escape quits.
/// Sliders set the radius, samples and factor of the occlusion, the tubes that it takes lines for,
/// and the thickness of smooth lines.
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("set", |set| set.help(format!("A generated set: {}", family_names()))),
    mut_arg("file", |file| file.help("A file of lines: .obj, .ply, .tck, .trk or .vtk"))
)]
pub struct Options {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// A generated set, by its name
    #[arg(long, default_value = "spiral", value_parser = parse_family, conflicts_with = "file")]
    pub set: Family,
    /// The number of lines of a generated set; with --rooms of each room [default: what suits the
    /// set]
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub lines: Option<u32>,
    /// Seed of generated sets and motions
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// A house of N x N rooms with a set in each, whose walls hide lines
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=32), conflicts_with_all = ["file", "set"])]
    pub rooms: Option<u32>,
    /// How lines are coloured: "own" (by the file, or a pale colour for each line), "direction" (x
    /// is red, y green, z blue), "scalar" or "scalar=NAME" (a number of the file, or "length")
    #[arg(long, value_name = "WHAT", default_value = "own", value_parser = parse_colour)]
    pub colour: Colouring,
    /// Only lines that cross this region: box:X0,Y0,Z0,X1,Y1,Z1 or sphere:X,Y,Z,RADIUS. May be
    /// given several times, for lines that cross all of them
    #[arg(long, value_name = "REGION")]
    pub include: Vec<Region>,
    /// No lines that cross this region. May be given several times
    #[arg(long, value_name = "REGION")]
    pub exclude: Vec<Region>,
    /// A mesh that hides lines, and is drawn: a file (.obj, .ply, .glb or .gltf). May be given
    /// several times
    #[arg(long, value_name = "FILE")]
    pub context: Vec<PathBuf>,
    /// The direction that the set is seen from
    #[arg(long, default_value = "0.5,0.6,1", value_parser = direction)]
    pub from: Vec3,
    /// Magnifies the middle of the picture
    #[arg(long, default_value = "1", value_parser = |t: &str| number(t, 0.1..=100.0f32))]
    pub zoom: f32,
    /// The radius of the occlusion, as a share of the extent; a slider.
    #[arg(skip = RADIUS)]
    pub radius: f32,
    /// The rays of a side of a place, or of a pixel [default: 12 of a side, 24 of a pixel]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub samples: Option<u32>,
    /// The occlusion is multiplied by this; a slider.
    #[arg(skip = 1.0_f32)]
    pub factor: f32,
    /// How the lines around a pixel become an occlusion
    #[arg(long, value_enum, default_value = "auto")]
    pub estimator: Way,
    /// Tubes of other lines also stop rays that start in them: dense bundles come out darker
    #[arg(long)]
    pub solid: bool,
    /// The radius of the tubes that lines are taken for, in pixels; a slider.
    #[arg(skip = 0.5_f32)]
    pub tube: f32,
    /// Smooth lines of so many pixels, 1 to 16, by four samples a pixel
    #[arg(long, value_name = "PIXELS", num_args = 0..=1, require_equals = true,
        default_missing_value = "1", value_parser = |t: &str| number(t, 1.0..=MOST_THICK))]
    pub antialias: Option<f32>,
    /// Leaves out lines that walls and meshes hide; the picture stays the same
    #[arg(long)]
    pub cull: bool,
    /// The pictures that --headless draws, comma-separated: plain, diffuse, occluded, occlusion
    #[arg(long, value_delimiter = ',', default_value = "plain,diffuse,occluded", requires = "headless",
        value_parser = |t: &str| one_of(t, &LOOKS))]
    pub look: Vec<Look>,
}

/// Estimators by their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Way {
    /// In a window "places" while the lines stand still, "rays" while they move; "rays" otherwise
    Auto,
    /// The share of rays that tubes stop, from places along the lines; they serve all frames
    Places,
    /// The share of rays that tubes stop, from each pixel, through a grid of the lines
    Rays,
}

/// The pictures of lines by their names, in the order of their keys.
pub const LOOKS: [(&str, Look); 4] = [
    // Flat colours; lit as tubes; and darkened by the occlusion; the occlusion alone.
    ("plain", Look::Plain),
    ("diffuse", Look::Diffuse),
    ("occluded", Look::Occluded),
    ("occlusion", Look::Occlusion),
];

impl Options {
    /// Whether borders of lines are smooth.
    pub fn antialiasing(&self) -> Antialiasing {
        self.antialias.map_or(Antialiasing::None, |thickness| Antialiasing::Four { thickness })
    }

    /// The rays of a pixel or of a side of a place.
    pub fn samples(&self) -> u32 {
        self.samples.unwrap_or(match self.estimator {
            Way::Places => USUAL_SIDE_RAYS,
            Way::Auto | Way::Rays => USUAL_RAYS,
        })
    }
}

impl Way {
    /// The one for a window whose lines move or stand still: those that move lose the values of all
    /// places in each frame.
    pub fn in_window(self, moving: bool) -> Self {
        match self {
            Self::Auto if moving => Self::Rays,
            Self::Auto => Self::Places,
            other => other,
        }
    }

    /// As asked for, but rays for sets with so many lines that places would lie too far apart.
    pub fn for_lines(self, lines: &LineSet, estimator: &Estimator) -> Self {
        match *estimator {
            Estimator::Places { step, .. }
                if self == Self::Auto && Places::step_for(lines, step) > MOST_APART * f64::from(step) =>
            {
                Self::Rays
            }
            _ => self,
        }
    }

    /// The estimator, for hemispheres and tubes of these radii.
    pub fn estimator(self, [radius, line_radius]: [f32; 2]) -> Estimator {
        match self {
            Self::Places => Estimator::places(radius, line_radius),
            Self::Auto | Self::Rays => Estimator::Rays { line_radius },
        }
    }
}

fn parse_family(text: &str) -> Result<Family, String> {
    one_of(text, &Family::ALL.map(|family| (family.name(), family)))
}

fn family_names() -> String {
    Family::ALL.map(Family::name).join(", ")
}

fn parse_colour(text: &str) -> Result<Colouring, String> {
    match text.split_once('=') {
        Some(("scalar", name)) => Ok(Colouring::Scalar(Some(name.to_owned()))),
        None if text == "scalar" => Ok(Colouring::Scalar(None)),
        None if text == "own" => Ok(Colouring::Own),
        None if text == "direction" => Ok(Colouring::Direction),
        _ => Err("expected own, direction, scalar or scalar=NAME".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Command;

    use super::*;
    use crate::common::{Shows, parsed};

    fn options(words: &[&str]) -> Options {
        parsed(words).unwrap()
    }

    #[test]
    fn the_estimator_follows_the_motion_unless_one_is_asked_for() {
        let usual = options(&[]);
        assert_eq!([false, true].map(|m| usual.estimator.in_window(m)), [Way::Places, Way::Rays]);
        assert!(matches!(usual.estimator.estimator([1.0, 0.1]), Estimator::Rays { .. }));
        // A line of 2^22 times a step has room for its places, one four times as long has not.
        let line = |long: f32| LineSet::new([[Vec3::ZERO, Vec3::X * long]]).unwrap();
        let places = Estimator::Places { line_radius: 0.1, step: 1.0 };
        let [few, many] = [4.2e6, 1.7e7].map(|long| usual.estimator.for_lines(&line(long), &places));
        assert_eq!([few, many], [Way::Auto, Way::Rays]);
        assert_eq!(Way::Places.for_lines(&line(1.7e7), &places), Way::Places);
        let rays = options(&["--estimator", "rays"]).estimator;
        assert_eq!([false, true].map(|m| rays.in_window(m)), [Way::Rays; 2]);
    }

    #[test]
    fn smooth_lines_are_one_pixel_thick_unless_a_thickness_is_asked_for() {
        assert_eq!(options(&[]).antialiasing(), Antialiasing::None);
        // The word after it is a file.
        let usual = options(&["--antialias", "lines.obj"]);
        assert_eq!(usual.antialiasing(), Antialiasing::SMOOTH);
        assert_eq!(usual.common.file.unwrap().to_str(), Some("lines.obj"));
        assert_eq!(options(&["--antialias=2.5"]).antialias, Some(2.5));
    }

    #[test]
    fn the_help_names_all_generated_sets() {
        let help = Options::augment_args(Command::new("lines")).render_long_help().to_string();
        let line = help.lines().find(|line| line.contains("A generated set: ")).unwrap();
        assert!(Family::ALL.iter().all(|f| line.contains(f.name())), "{line}");
    }

    fn said(words: &[&str]) -> String {
        let options = parsed::<Options>(words);
        options.and_then(|o| o.run().map_err(|e| e.to_string())).expect_err(words[0])
    }

    #[test]
    fn wrong_values_and_files_are_named_with_what_is_possible() {
        let folder = std::env::temp_dir();
        let file = |name: &str, text: &str| {
            let path = folder.join(format!("casca-lines-{}-{name}", std::process::id()));
            std::fs::write(&path, text).unwrap();
            path.to_str().unwrap().to_owned()
        };
        let (broken, empty) = (file("broken.obj", "v 3 x 1"), file("empty.obj", "# nothing\n"));
        // Pictures of these would be empty, or have no depths.
        let [huge, tiny] = ["1e20", "1e-20"]
            .map(|far| file(&format!("{far}.obj"), &format!("v {far} 0 0\nv 0 {far} 0\nl 1 2\n")));
        for (words, part) in [
            (vec!["--headless", &*huge], "scale the lines"),
            (vec!["--headless", &*tiny], "1e-20 units wide"),
            (vec!["--headless", "no/such.obj"], "no/such.obj"),
            (vec!["--headless", "lines.stl"], ".trk"),
            (vec!["--headless", &*broken], &*broken),
            (vec!["--headless", &*empty], "empty.obj: there is no line in this file"),
            (vec!["--headless", "--lines", "0"], "spiral: there is no line"),
            (vec!["--headless", "--rooms", "32", "--lines", "1000000"], "vertices"),
            (vec!["--set", "hair"], "pompom"),
            (vec!["--zoom", "NaN"], "from 0.1 to 100"),
            (vec!["--antialias=0.5"], "from 1 to 16"),
            (vec!["--samples", "0"], "1..=4096"),
            (vec!["--from", "0,0,0"], "direction"),
            (vec!["--from", "1,2"], "three numbers"),
            (vec!["--size", "0x720"], "from 1 to 8192"),
            (vec!["--look", "photo", "--headless"], "occluded"),
            (vec!["x.obj", "--rooms", "3"], "cannot be used with"),
            (vec!["--headless", "--colour", "red"], "scalar or scalar=NAME"),
            (
                vec!["--headless", "--lines", "5", "--colour", "scalar=fa"],
                "no numbers \"fa\"; they have length",
            ),
            (vec!["--headless", "--lines", "5", "--context", "no/such.ply"], "no/such.ply"),
            (vec!["--headless", "--lines", "5", "--context", "no/such.glb"], "no/such.glb"),
            (vec!["--headless", "--lines", "5", "--context", "x.stl"], ".obj or .ply"),
            (vec!["--include", "sphere:0,0,0"], "sphere:X,Y,Z,RADIUS"),
            (
                vec!["--headless", "--lines", "5", "--exclude", "sphere:0,0,0,99"],
                "spiral: --include and --exclude leave no line",
            ),
        ] {
            let said = said(&words);
            assert!(said.contains(part), "{words:?}: {said}");
        }
        [broken, empty, huge, tiny].iter().for_each(|path| std::fs::remove_file(path).unwrap());
    }
}
