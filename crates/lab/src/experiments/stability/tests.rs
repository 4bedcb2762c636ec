//! No case may lose anything of the library's methods, and those of gaps must be hard.

use super::*;

fn quick(run: impl FnOnce(&Lab)) {
    let folder = std::env::temp_dir();
    run(&Lab { quick: true, seed: 1, files: Vec::new(), folder, progress: &|_| () });
}

fn of(lab: &Lab, name: &str) -> Vec<Finding> {
    let group = GROUPS.iter().find(|g| g.0 == name).unwrap();
    findings(lab, group.2).unwrap()
}

/// Nothing is lost in a group, each case of which shows something; returns what was found.
fn nothing_is_lost(lab: &Lab, name: &str) -> Vec<Finding> {
    let found = nothing_is_lost_of_any(lab, name);
    let empty = found.iter().find(|f| f.sure == 0).map(|f| &f.case);
    assert!(empty.is_none(), "{empty:?}: nothing is in sight");
    found
}

/// Nothing is lost in a group, if anything is in sight; returns what was found.
fn nothing_is_lost_of_any(lab: &Lab, name: &str) -> Vec<Finding> {
    let found = of(lab, name);
    for finding in &found {
        for outcome in finding.outcomes.iter().filter(|o| o.method != "hzb") {
            let first = outcome.first_lost;
            assert_eq!(outcome.lost, 0, "{} of {}: (frame, object) {first:?}", outcome.method, finding.case);
        }
    }
    found
}

#[test]
fn gaps_lose_nothing_but_samples_do() {
    quick(|lab| {
        let found = nothing_is_lost(lab, "gaps");
        let widths = gaps::widths_in_pixels();
        for (i, finding) in found.iter().enumerate() {
            assert_eq!(finding.refuted, 0, "{}", finding.case);
            assert!(finding.known > 0, "{}", finding.case);
            // Most is lost through the narrowest slits.
            if widths[i % widths.len()] < 0.05 {
                let outcome = finding.of("hzb").unwrap();
                assert!(outcome.lost_known * 4 > finding.known, "{}", finding.case);
            }
        }
    });
}

#[test]
fn small_worlds_lose_nothing() {
    quick(|lab| {
        for name in ["thin", "touching", "nested", "sizes", "meshes"] {
            let found = nothing_is_lost(lab, name);
            // Most of what was put there to be seen is in sight.
            let (known, refuted): (Vec<usize>, Vec<usize>) =
                found.iter().map(|f| (f.known, f.refuted)).unzip();
            let (known, refuted) = (known.iter().sum::<usize>(), refuted.iter().sum::<usize>());
            assert!(refuted * 3 <= known, "{name}: {refuted} of {known}");
            assert!(known > 0 || !["nested", "sizes"].contains(&name));
        }
    });
}

#[test]
fn views_along_walls_lose_nothing() {
    quick(|lab| drop(nothing_is_lost(lab, "grazing")));
}

#[test]
#[ignore = "takes a minute without optimisation"]
fn whole_scenes_lose_nothing() {
    quick(|lab| {
        let rest = GROUPS
            .iter()
            .filter(|g| !["gaps", "thin", "touching", "nested", "sizes", "meshes", "grazing"].contains(&g.0));
        for group in rest {
            // The few frames of the narrowest views may show the sky.
            let found = nothing_is_lost_of_any(lab, group.0);
            let empty = found.iter().filter(|f| f.sure == 0).count();
            assert!(empty * 10 <= found.len(), "{}: {empty} of {} show nothing", group.0, found.len());
        }
    });
}
