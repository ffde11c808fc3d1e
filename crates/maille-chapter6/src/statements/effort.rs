//! What limits cost, and which were found.

use super::cases::{Cases, Finding, finding};
use crate::{
    map::{Map, answered, at},
    plan::shown_l2,
};

/// Designs that the thesis calls dense.
const DENSE: [&str; 2] = ["3.1", "5.2"];

/// Statement 7.
pub(super) fn steps(maps: &[Map]) -> Finding {
    let mut dense = Cases::of("a dense topology takes more than the median");
    let mut compressed = Cases::of("compression takes more");
    let mut evidence = Vec::new();
    let mean = |map: &Map, of: &dyn Fn(f64) -> bool| map.mean(of, |row| row.iterations as f64);
    let plain: Vec<&Map> = maps.iter().filter(|map| map.is_plain()).collect();
    for map in plain.iter().filter(|map| DENSE.contains(&map.design.as_str())) {
        let alike = |other: &&&Map| {
            (other.ratio, &other.method) == (map.ratio, &map.method) && !DENSE.contains(&other.design.as_str())
        };
        let mut rest: Vec<f64> = plain.iter().filter(alike).filter_map(|other| mean(other, &|_| true)).collect();
        rest.sort_by(f64::total_cmp);
        let (Some(own), Some(median)) = (mean(map, &|_| true), rest.get(rest.len() / 2)) else { continue };
        let text = format!("{}: {own:.0} steps a limit, median of the other designs {median:.0}", map.label());
        evidence.push(text.clone() + ".");
        if map.method == "energy" {
            dense.add(own > *median, || text);
        }
    }
    let mut of_exact = Cases::default();
    for map in &plain {
        let (Some(below), Some(above)) = (mean(map, &|l2| l2 < 0.0), mean(map, &|l2| l2 >= 0.0)) else { continue };
        let cases = if map.method == "energy" { &mut compressed } else { &mut of_exact };
        cases.add(below > above, || {
            let runs = |of: &dyn Fn(f64) -> bool| map.mean(of, |row| row.runs as f64).unwrap_or(f64::NAN);
            let [fewer, more] = [runs(&|l2| l2 < 0.0), runs(&|l2| l2 >= 0.0)];
            format!(
                "{}: {below:.0} steps a limit with l₂ < 0, {above:.0} with l₂ ≥ 0. The limit is found in {fewer:.1} runs of {:.0} \
                 steps there, and here in {more:.1} runs of {:.0}.",
                map.label(),
                below / fewer,
                above / more
            )
        });
    }
    evidence.insert(
        0,
        format!("Energy method, the thesis's: compression takes more steps in {} (a map).", compressed.score()),
    );
    evidence.push(format!(
        "The exact method takes other steps, and is not judged: compression takes more in {}.",
        of_exact.score()
    ));
    let by_energy = |design: &str| {
        plain.iter().any(|map| map.design == design && map.method == "energy" && mean(map, &|_| true).is_some())
    };
    let unseen: Vec<&str> = DENSE.into_iter().filter(|design| !by_energy(design)).collect();
    let found = finding(
        7,
        "Denser topologies (3.1, 5.2) and compression (l₂ < 0) take more steps.",
        evidence,
        vec![dense, compressed],
    );
    unseen.into_iter().fold(found, |found, design| {
        found.except(format!("{design}: the energy method has no limit of it here, so its steps are not judged"))
    })
}

/// Statement 9.
pub(super) fn shown(maps: &[Map]) -> Finding {
    let mut cases = Cases::of("every direction has a limit, or a proof that there is none");
    let mut proved = 0;
    for map in maps.iter().filter(|map| map.is_plain() && map.method == "exact") {
        for l2 in shown_l2(&map.design) {
            let rows: Vec<_> = map.rows_at(*l2).collect();
            let missing = rows.iter().filter(|row| !answered(row)).count();
            let complete = !rows.is_empty() && missing == 0;
            proved += usize::from(complete && rows.iter().all(|row| row.l1.is_none()));
            cases.add(complete, || match rows.len() {
                0 => format!("{}: not computed", at(map, *l2)),
                n => format!("{}: {missing} of {n} directions without an answer", at(map, *l2)),
            });
        }
    }
    let evidence = vec![
        format!(
            "Every direction has a limit, or a proof that there is none, in {} (a design, r and l₂).",
            cases.score()
        ),
        format!("In {proved} of them no direction can be reached, which is proved."),
    ];
    finding(
        9,
        "Shown are l₂ from −0.375 (1.1, 1.2) or −0.25 to 0.25 by 0.125, at r = R/10 and R/20.",
        evidence,
        vec![cases],
    )
}
