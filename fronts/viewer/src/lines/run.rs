//! What the command line asks for, done.

use casca_stage::window::Start;
use casca_tools::command_line::Outcome;

use crate::common::Failed;
use crate::lines::options::Options;
use crate::lines::source::Source;
use crate::lines::{headless, times, window};

impl Options {
    /// The window.
    ///
    /// # Errors
    /// The lines cannot be had.
    pub fn start(&self) -> Result<Start, Failed> {
        Ok(window::start(self.clone(), Source::open(self)?))
    }

    /// Opens a window, draws pictures or prints times.
    ///
    /// # Errors
    /// The lines cannot be had, drawn or written.
    pub fn run(&self) -> Result<Outcome, Failed> {
        if self.common.headless {
            headless::pictures(self, &Source::open(self)?)?;
        } else if self.time {
            times::print(self, &Source::open(self)?)?;
        } else {
            self.common.drawing.open(self.start()?)?;
        }
        Ok(Outcome::Well)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;

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
        let (broken, empty) = (file("broken.txt", "2\n3 x"), file("empty.obj", "# nothing\n"));
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
            (vec!["--radius", "0"], "from 0.001 to 1"),
            (vec!["--radius", "NaN"], "from 0.001 to 1"),
            (vec!["--factor", "inf"], "from 0 to 100"),
            (vec!["--fov", "180"], "from 1 to 150, or 0"),
            (vec!["--zoom", "0"], "from 0.1 to 100"),
            (vec!["--antialias=0.5"], "from 1 to 16"),
            (vec!["--samples", "0"], "1..=4096"),
            (vec!["--from", "0,0,0"], "direction"),
            (vec!["--from", "1,2"], "direction"),
            (vec!["--size", "0x720"], "from 1 to 8192"),
            (vec!["--look", "photo", "--headless"], "occluded"),
            (vec!["x.obj", "--rooms", "3"], "cannot be used with"),
            (vec!["--headless", "--colour", "red"], "scalar=NAME or group"),
            (
                vec!["--headless", "--lines", "5", "--colour", "scalar=fa"],
                "no numbers \"fa\"; they have length",
            ),
            (vec!["--headless", "--lines", "5", "--colour", "group"], "in no groups"),
            (vec!["--headless", "--lines", "5", "--context", "no/such.ply"], "no/such.ply"),
            (vec!["--headless", "--lines", "5", "--context", "no/such.glb"], "no/such.glb"),
            (vec!["--headless", "--lines", "5", "--context", "x.stl"], ".obj or .ply"),
            (vec!["--range", "-1,x"], "two numbers"),
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
