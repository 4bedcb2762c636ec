//! Where a report was made.

use std::process::Command;

/// The first value of a key in a file of `key: value` lines.
fn value(file: &str, key: &str) -> Option<String> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find(|l| l.split(':').next().is_some_and(|k| k.trim() == key))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let out = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(out.stdout).ok()?.trim().to_owned();
    (out.status.success() && !text.is_empty()).then_some(text)
}

/// The processor, memory and system, as far as they can be told.
pub(super) fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let processor = value("/proc/cpuinfo", "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let memory = value("/proc/meminfo", "MemTotal")
        .and_then(|m| m.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(String::new(), |kib| format!(", {:.0} GiB of memory", kib / f64::from(1 << 20)));
    // Other programs slow the queries down: readers should know.
    let load = std::fs::read_to_string("/proc/loadavg").ok();
    let load = load.as_deref().and_then(|l| l.split_whitespace().nth(2));
    let load = load.map_or(String::new(), |l| format!(", load {l} in the last 15 minutes"));
    format!("{processor}, {threads} threads{memory}, {}{load}", std::env::consts::OS)
}

/// The commit of the working tree, and whether it was changed; of the compiler, its version.
pub(super) fn commit() -> String {
    let commit = output("git", &["rev-parse", "--short", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let changed = output("git", &["status", "--porcelain", "--untracked-files=no", "--", "src", "crates"]);
    let changed = if changed.is_some() { " with changes" } else { "" };
    let compiler = output("rustc", &["--version"]).unwrap_or_else(|| "rustc unknown".to_owned());
    format!("{commit}{changed}, {compiler}")
}
