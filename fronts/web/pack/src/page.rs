//! Makes the static page of the viewer: one file that holds its script and the WebAssembly that
//! cargo built, packed.
//!
//! `casca-page-pack FILE.wasm FOLDER TEMPLATE.html PAGE.html`: see `fronts/page/build`. The folder
//! keeps what is put into the page.

use std::error::Error;
use std::io::Write;
use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use flate2::Compression;
use flate2::write::GzEncoder;
use wasm_bindgen_cli_support::Bindgen;

/// The name of the files in the folder.
const NAME: &str = "page";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder, template, page] = arguments.as_slice() else {
        return Err("usage: casca-page-pack FILE.wasm FOLDER TEMPLATE.html PAGE.html".into());
    };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).out_name(NAME).typescript(false).no_modules(true)?;
    bindgen.remove_name_section(true).remove_producers_section(true);
    bindgen.generate(folder)?;

    let bindings = std::fs::read_to_string(Path::new(folder).join(NAME).with_extension("js"))?;
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(&std::fs::read(Path::new(folder).join(format!("{NAME}_bg.wasm")))?)?;
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
