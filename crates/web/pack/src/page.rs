//! Makes the static page of the viewer: one file that holds its script and the WebAssembly that
//! cargo built, packed.
//!
//! `casca-page-pack bind FILE.wasm FOLDER` makes the bindings; between the two a program may make
//! the WebAssembly in the folder smaller. `casca-page-pack join FOLDER TEMPLATE.html PAGE.html`
//! makes the page. See `.ci/page`.

use std::error::Error;
use std::io::Write;
use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use flate2::Compression;
use flate2::write::GzEncoder;
use wasm_bindgen_cli_support::Bindgen;

/// The name of what is between the two steps.
const NAME: &str = "page";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["bind", wasm, folder] => {
            let mut bindgen = Bindgen::new();
            bindgen.input_path(wasm).out_name(NAME).typescript(false).no_modules(true)?;
            bindgen.remove_name_section(true).remove_producers_section(true);
            Ok(bindgen.generate(folder)?)
        }
        ["join", folder, template, page] => join(Path::new(folder), template, page),
        _ => Err("usage: casca-page-pack bind FILE.wasm FOLDER, or join FOLDER TEMPLATE.html PAGE.html".into()),
    }
}

fn join(folder: &Path, template: &str, page: &str) -> Result<(), Box<dyn Error>> {
    let bindings = std::fs::read_to_string(folder.join(NAME).with_extension("js"))?;
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&std::fs::read(folder.join(format!("{NAME}_bg.wasm")))?)?;
    let packed = BASE64_STANDARD.encode(packed.finish()?);
    let mut text = std::fs::read_to_string(template)?;
    // An end of a script inside of it would end it.
    for (mark, with) in [("{{BINDINGS}}", bindings.replace("</", "<\\/")), ("{{WASM}}", packed)] {
        if text.matches(mark).count() != 1 {
            return Err(format!("{template} does not have {mark} once").into());
        }
        text = text.replace(mark, &with);
    }
    if let Some(parent) = Path::new(page).parent() {
        std::fs::create_dir_all(parent)?;
    }
    Ok(std::fs::write(page, text)?)
}
