//! Messages to the page's script, as JSON: objects with a `kind` and the fields of that kind.

use casca_stage::dial::{Dial, Setting};
use casca_stage::report::{Entry, Report, Sample};
use casca_stage::window::Told;
use casca_viewer::systems::SYSTEMS;
use serde_json::{Value, json};

/// The JSON of a message.
pub fn json_of(told: &Told<'_>) -> Value {
    match told {
        Told::Opened(gpu) => {
            let system = |s: &casca_viewer::systems::System| {
                let refused = (s.computes && !gpu.computes()).then_some("needs WebGPU");
                json!({ "name": s.name, "line": s.line, "refused": refused })
            };
            let systems: Vec<Value> = SYSTEMS.iter().map(system).collect();
            json!({ "kind": "opened", "device": gpu.name, "systems": systems })
        }
        Told::Title(title) => json!({ "kind": "title", "title": title }),
        Told::Failed(why) => json!({ "kind": "failed", "why": why }),
        Told::Report(report) => report_of(report),
    }
}

fn report_of(Report { lines, legend, dials, .. }: &Report) -> Value {
    let legend: Vec<Value> = legend.iter().map(entry_of).collect();
    let dials: Vec<Value> = dials.iter().map(dial_of).collect();
    json!({ "kind": "report", "lines": lines, "legend": legend, "dials": dials })
}

fn entry_of(Entry { colour: [r, g, b, _], sample, text }: &Entry) -> Value {
    let around = match sample {
        Sample::Area => None,
        Sample::Line => Some("white".to_owned()),
        Sample::Framed([r, g, b]) => Some(format!("rgb({r} {g} {b})")),
    };
    json!({ "colour": format!("rgb({r} {g} {b})"), "around": around, "text": text })
}

fn dial_of(Dial { name, setting }: &Dial) -> Value {
    match setting {
        Setting::Number { value, range, step } => json!({
            "name": name, "is": "number", "value": value, "least": range.start(), "most": range.end(), "step": step,
        }),
        Setting::Switch(on) => json!({ "name": name, "is": "switch", "on": on }),
        Setting::Choice { names, chosen } => {
            json!({ "name": name, "is": "choice", "names": names, "chosen": chosen })
        }
        Setting::Button => json!({ "name": name, "is": "button" }),
    }
}
