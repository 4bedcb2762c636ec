//! Tables and words from what was found.

use super::run::{CAUSES, Finding, Outcome};
use crate::lab::Table;

/// Times and ratios are compared with the last calm case before.
pub(super) fn with_calm(findings: &[Finding]) -> impl Iterator<Item = (&Finding, &Finding)> {
    let mut calm = None;
    findings.iter().map(move |f| {
        if f.calm || calm.is_none() {
            calm = Some(f);
        }
        (f, calm.unwrap_or(f))
    })
}

fn ratio(a: f64, b: f64) -> Option<f64> {
    (b > 0.0).then_some(a / b)
}

/// Objects found over objects visible.
pub(super) fn accuracy(finding: &Finding, outcome: &Outcome) -> Option<f64> {
    let found: usize = outcome.found.iter().map(Vec::len).sum();
    ratio(found as f64, finding.visible() as f64)
}

/// What was lost and why, in a few words.
fn causes(outcome: &Outcome) -> String {
    let counts = outcome.causes.iter().zip(CAUSES).filter(|c| *c.0 > 0);
    let words: Vec<String> = counts.map(|(n, why)| format!("{n} {why}")).collect();
    words.join("; ")
}

/// The table of a group: a row for each case and method but the frustum.
pub(super) fn table(name: &str, findings: &[Finding]) -> Table {
    let columns = [
        "case",
        "method",
        "frames",
        "visible",
        "false negatives",
        "PVS/EVS",
        "time / calm",
        "why objects were lost",
    ];
    let mut table = Table::new(name, &columns);
    for (finding, calm) in with_calm(findings) {
        for outcome in finding.outcomes.iter().filter(|o| o.method != "frustum") {
            let frames = finding.exact.len();
            let time = match calm.of(outcome.method) {
                Some(base) if !std::ptr::eq(finding, calm) => ratio(outcome.ms, base.ms),
                _ => None,
            };
            let two = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.2}"));
            table.row([
                finding.case.clone(),
                outcome.method.to_owned(),
                frames.to_string(),
                format!("{:.1}", finding.visible() as f64 / frames.max(1) as f64),
                outcome.lost.to_string(),
                two(accuracy(finding, outcome)),
                two(time),
                causes(outcome),
            ]);
        }
    }
    table
}

/// What each method did with the cases of a group, in a sentence each.
pub(super) fn words(findings: &[Finding]) -> String {
    let mut out = Vec::new();
    let names: Vec<&str> =
        findings.first().map_or(Vec::new(), |f| f.outcomes.iter().map(|o| o.method).collect());
    let sure: usize = findings.iter().map(|f| f.sure).sum();
    for name in names.into_iter().filter(|n| *n != "frustum") {
        let outcomes: Vec<(&Finding, &Outcome)> =
            findings.iter().filter_map(|f| f.of(name).map(|o| (f, o))).collect();
        let lost: usize = outcomes.iter().map(|(_, o)| o.lost).sum();
        let cases = outcomes.iter().filter(|(_, o)| o.lost > 0).count();
        let mut why: Vec<(usize, &str)> = CAUSES
            .iter()
            .enumerate()
            .map(|(i, &c)| (outcomes.iter().map(|(_, o)| o.causes[i]).sum(), c))
            .filter(|(n, _)| *n > 0)
            .collect();
        why.sort_unstable_by_key(|w| std::cmp::Reverse(w.0));
        let why: Vec<String> = why.iter().map(|(n, c)| format!("{n} {c}")).collect();
        let mut sentence = if lost == 0 {
            format!("`{name}` lost none of {sure} sightings")
        } else {
            format!("`{name}` lost {lost} of {sure} sightings, in {cases} of {} cases", findings.len())
        };
        if !why.is_empty() {
            sentence += &format!(" ({})", why.join("; "));
        }
        let widest = outcomes
            .iter()
            .filter_map(|(f, o)| Some((accuracy(f, o)?, &f.case)))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((ratio, case)) = widest {
            sentence += &format!("; at most it found {ratio:.2} times what is visible ({case})");
        }
        out.push(format!("- {sentence}."));
    }
    out.join("\n")
}

/// One row for each method: how it fared in all cases.
pub(super) fn summary(findings: &[&Finding]) -> Table {
    let columns =
        ["method", "rows", "rows with losses", "false negatives", "of sightings", "worst row", "lost in it"];
    let mut table = Table::new("stability-summary", &columns);
    let names: Vec<&str> =
        findings.first().map_or(Vec::new(), |f| f.outcomes.iter().map(|o| o.method).collect());
    let sure: usize = findings.iter().map(|f| f.sure).sum();
    for name in names {
        let outcomes: Vec<(&str, &Outcome)> =
            findings.iter().filter_map(|f| Some((f.case.as_str(), f.of(name)?))).collect();
        let worst = outcomes.iter().max_by_key(|(_, o)| o.lost).filter(|(_, o)| o.lost > 0);
        let lost: usize = outcomes.iter().map(|(_, o)| o.lost).sum();
        table.row([
            name.to_owned(),
            outcomes.len().to_string(),
            outcomes.iter().filter(|(_, o)| o.lost > 0).count().to_string(),
            lost.to_string(),
            sure.to_string(),
            worst.map_or("-".to_owned(), |(case, _)| (*case).to_owned()),
            worst.map_or(0, |(_, o)| o.lost).to_string(),
        ]);
    }
    table
}
