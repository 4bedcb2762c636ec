//! The header is what the sources say. `CASCA_HEADER=write cargo test -p casca-capi --test header`
//! makes it anew.

use std::fs;
use std::path::Path;

use cbindgen::{Builder, Config};

/// The header, as the sources and the chapter at its head make it.
fn generated() -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut config = Config::from_file(here.join("cbindgen.toml")).unwrap();
    config.header = Some(fs::read_to_string(here.join("src/manual.h")).unwrap().trim_end().to_owned());
    config.after_includes =
        Some(fs::read_to_string(here.join("src/before.h")).unwrap().trim_end().to_owned());
    let mut builder = Builder::new().with_config(config);
    for file in ORDER {
        builder = builder.with_src(here.join("src").join(file));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

/// The sources in the order of the header's chapters.
const ORDER: [&str; 12] = [
    "version.rs",
    "error.rs",
    "view.rs",
    "mesh.rs",
    "shape.rs",
    "scene.rs",
    "query.rs",
    "frame.rs",
    "sight.rs",
    "job.rs",
    "plane.rs",
    "plane_query.rs",
];

#[test]
fn the_header_is_that_of_the_sources() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/casca.h");
    let generated = generated();
    if std::env::var("CASCA_HEADER").is_ok_and(|how| how == "write") {
        fs::write(&path, &generated).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let differs = kept.lines().zip(generated.lines()).position(|(kept, new)| kept != new);
    assert!(
        kept == generated,
        "include/casca.h differs from line {:?} on: CASCA_HEADER=write cargo test -p casca-capi --test header",
        differs.map(|line| line + 1)
    );
}
