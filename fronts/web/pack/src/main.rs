//! Makes the npm package: the modules for the WebAssembly that cargo built, and their types.
//!
//! `casca-web-pack FILE.wasm FOLDER`: see `.ci/web`.

use std::error::Error;
use std::path::Path;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder] = arguments.as_slice() else {
        return Err("usage: casca-web-pack FILE.wasm FOLDER".into());
    };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).out_name("casca").typescript(true).omit_default_module_path(false).web(true)?;
    bindgen.generate(folder)?;
    // They stand beside this program.
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (from, to) in [("package.json", "package.json"), ("README.md", "README.md")] {
        std::fs::copy(here.join(from), Path::new(folder).join(to))?;
    }
    Ok(())
}
