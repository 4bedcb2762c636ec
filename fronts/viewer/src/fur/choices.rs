//! The command line, and the fur that it stands for.

use casca_fur::gpu::look::Look;
use casca_fur::mesh::Mesh;
use casca_fur::scenes::Character;
use casca_fur::scenes::animals::{Animal, LEVELS};
use casca_fur::strands::Fur;
use casca_tools::command_line::EXIT_CODES;
use clap::{Args, value_parser};
use glam::Vec3;

use crate::common::{Common, Failed, number};
use crate::fur::walker::Walker;

/// The detail of the generated animal: some 10,000 vertices.
const DETAIL: u32 = 96;

/// Fur as shells, and what visibility saves on it
#[derive(Debug, Clone, Args)]
#[command(
    after_help = EXIT_CODES, allow_negative_numbers = true,
    mut_arg("file", |file| file.help("A glTF 2.0 file (.glb or .gltf) that grows fur [default: a generated animal]")),
    mut_arg("frames", |frames| frames.help("Pictures of a field along its path; a window closes after so many frames"))
)]
pub struct Choices {
    /// What all systems take.
    #[command(flatten)]
    pub common: Common,
    /// A field of so many generated animals among walls
    #[arg(long, conflicts_with = "file", value_parser = value_parser!(u32).range(1..=100_000))]
    pub field: Option<u32>,
    /// Animals walk on their legs, and their fur follows
    #[arg(long)]
    pub walk: bool,
    /// Materials of the file without fur, by their names: eyes, claws, a nose
    #[arg(long, value_name = "MATERIAL", value_delimiter = ',', requires = "file")]
    pub bald: Vec<String>,
    /// Layers above the skin, up to 256
    #[arg(long, default_value_t = 24, value_parser = value_parser!(u32).range(0..=256))]
    pub layers: u32,
    /// Length of the fur as a share of the object's radius, 0 to 1
    #[arg(long, default_value_t = 0.08, value_parser = share)]
    pub height: f32,
    /// The share of the skin that roots cover, 0.001 to 1
    #[arg(long, default_value_t = 0.45, value_parser = share)]
    pub density: f32,
    /// The distance between strands as a share of the radius, up to 1: strands grow thicker with it;
    /// a slider.
    #[arg(skip = 0.008_f32)]
    pub thickness: f32,
    /// How far tips hang down and lie back, in multiples of the fur's height; a slider.
    #[arg(skip = 0.7_f32)]
    pub bend: f32,
    /// How far the tips of a tuft come together, 0 to 1
    #[arg(long, default_value_t = 0.6, value_parser = share)]
    pub clump: f32,
    /// How far strands curl, 0 to 1
    #[arg(long, default_value_t = 0.0, value_parser = share)]
    pub curl: f32,
    /// Seed of the animal or the field
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

fn share(text: &str) -> Result<f32, String> {
    number(text, 0.0..=1.0)
}

/// A mesh that grows fur: its levels of detail, finest first, centred, with the radius of its box.
pub struct Subject {
    pub name: String,
    pub levels: Vec<Mesh>,
    pub radius: f32,
    /// The height of the ground on which it stands.
    pub low: f32,
    /// Its skeleton and walk, if it walks.
    pub walker: Option<Box<Walker>>,
}

impl Choices {
    /// The fur of a mesh of a radius.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn fur(&self, radius: f32) -> Result<Fur, casca_fur::Error> {
        let mut fur = Fur::for_radius(radius, self.height, self.density)?;
        fur.spacing = self.thickness * radius;
        (fur.clump, fur.curl) = (self.clump, self.curl);
        // Backwards and down.
        fur.bend = Vec3::new(-0.7, -0.7, 0.0) * self.bend;
        fur.check(radius)?;
        Ok(fur)
    }

    /// The look of a mesh of a radius.
    pub fn look(&self, radius: f32) -> Result<Look, casca_fur::Error> {
        Ok(Look::new(self.fur(radius)?))
    }

    /// The mesh that grows fur: of the file, or generated.
    pub fn subject(&self) -> Result<Subject, Failed> {
        let Some(path) = &self.common.file else {
            let animal = Animal::new(self.seed, DETAIL)?;
            let levels = animal.levels().to_vec();
            let walker = self.walk.then(|| Box::new(Walker::generated(animal.rig(), &levels[0])));
            let (radius, low) = (animal.radius(), animal.aabb().min.y);
            return Ok(Subject { name: "animal".into(), levels, radius, low, walker });
        };
        let character = Character::load(path, &self.bald, LEVELS)?;
        let levels = character.levels;
        let walker = match (self.walk, &character.rig) {
            (false, _) => None,
            (true, None) => return Err(format!("{}: has no mesh with a skin", path.display()).into()),
            (true, Some(rig)) => Some(Box::new(Walker::of_file(path, rig, &levels[0])?)),
        };
        let name = path.file_stem().map_or("file".into(), |s| s.to_string_lossy().into_owned());
        let (lo, hi) = (levels[0].aabb().min, levels[0].aabb().max);
        let low = walker.as_ref().map_or(lo.y, |walker| walker.low);
        Ok(Subject { name, levels, radius: (hi - lo).length() * 0.5, low, walker })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choices(words: &str) -> Result<Choices, String> {
        crate::common::parsed(&words.split_whitespace().collect::<Vec<_>>())
    }

    #[test]
    fn absurd_values_are_refused_with_what_is_expected() {
        for (words, expected) in [
            ("--layers 257", "0..=256"),
            ("--height NaN", "from 0 to 1"),
            ("--field 0", "1..=100000"),
            ("--bald eyes", "required"),
            ("--field 3 cat.glb", "cannot be used"),
        ] {
            let said = choices(words).expect_err(words);
            assert!(said.contains(expected), "{words}: {said}");
        }
        let said = choices("--density 0").unwrap().look(1.0).expect_err("no density").to_string();
        assert!(said.contains("must be from"), "{said}");
        assert_eq!(choices("--height 0.05").unwrap().fur(2.0).unwrap().height, 0.1);
    }
}
