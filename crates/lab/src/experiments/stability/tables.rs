//! Tables and words from the findings.

use super::run::{CAUSES, Finding, Outcome};
use crate::experiments::{Table, grouped};

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

/// Why objects were lost, in a few words.
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
        "objects lost",
        "PVS/visible",
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

/// Names with commas, and "and" before the last.
fn listed(names: &[String]) -> String {
    match names {
        [first @ .., a, b] => {
            first.iter().map(|n| format!("{n}, ")).collect::<String>() + &format!("{a} and {b}")
        }
        _ => names.concat(),
    }
}

/// A count and its noun.
fn counted(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}

/// How many objects each method lost in the cases of a group, and mainly why, in a sentence or two.
pub(super) fn words(findings: &[Finding]) -> String {
    let names: Vec<&str> =
        findings.first().map_or(Vec::new(), |f| f.outcomes.iter().map(|o| o.method).collect());
    let sure: usize = findings.iter().map(|f| f.sure).sum();
    let (mut safe, mut lossy) = (Vec::new(), Vec::new());
    let mut why: Vec<(usize, &str)> = CAUSES.iter().map(|&c| (0, c)).collect();
    for name in names.into_iter().filter(|n| *n != "frustum") {
        let outcomes: Vec<&Outcome> = findings.iter().filter_map(|f| f.of(name)).collect();
        let lost: usize = outcomes.iter().map(|o| o.lost).sum();
        let cases = outcomes.iter().filter(|o| o.lost > 0).count();
        match lost {
            0 => safe.push(format!("`{name}`")),
            _ => lossy.push(format!("`{name}` loses {} in {}", grouped(lost), counted(cases, "case"))),
        }
        for (total, i) in why.iter_mut().zip(0..) {
            total.0 += outcomes.iter().map(|o| o.causes[i]).sum::<usize>();
        }
    }
    let mut said = format!("Of {} sightings in {}, ", grouped(sure), counted(findings.len(), "case"));
    if !safe.is_empty() {
        lossy.insert(0, format!("{} lose{} none", listed(&safe), if safe.len() == 1 { "s" } else { "" }));
    }
    said += &lossy.join("; ");
    match why.into_iter().max_by_key(|w| w.0) {
        Some((n, cause)) if n > 0 => format!("{said}; most of these are {cause}."),
        _ => said + ".",
    }
}

/// One row for each method: how it fared in all cases.
pub(super) fn summary(findings: &[&Finding]) -> Table {
    let columns =
        ["method", "cases", "cases with losses", "objects lost", "of sightings", "worst case", "lost in it"];
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
