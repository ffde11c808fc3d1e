//! In which directions the limit is least and largest, and what compression and the cell do to that.

use super::{
    cases::{Cases, Finding, Verdict, finding},
    cause::cause,
};
use crate::map::{Map, apart, at, degrees, extreme, midway, signed, step};

/// Statement 1.
pub(super) fn least_along_interlocking(maps: &[Map]) -> Finding {
    let mut least = Cases::of("least along every interlocking direction");
    let mut largest = Cases::of("largest midway between two");
    let mut apart_from_all = Vec::new();
    for map in maps.iter().filter(|map| map.is_plain()) {
        for l2 in map.l2() {
            let Some(turn) = map.turn(l2) else { continue };
            // The nearest directions that were computed count.
            let reach = 0.5 * step(&turn) + 1e-6;
            let near = |d: f64, wanted: &[f64]| wanted.iter().any(|w| apart(d, *w) <= reach);
            let (min, max) = (extreme(&turn, 1.0, map.tie()), extreme(&turn, -1.0, map.tie()));
            let between = midway(&map.interlocking_deg);
            // A curve without contrast has no least direction.
            if min.iter().any(|d| max.contains(d)) {
                least.ties += 1;
                largest.ties += 1;
                continue;
            }
            let all = map.interlocking_deg.iter().all(|w| min.iter().any(|d| apart(*d, *w) <= reach));
            let because = || cause(&[map], maps, l2);
            least.add(all, || format!("{}: least at {}. {}", at(map, l2), degrees(&min), because()));
            largest.add(max.iter().any(|d| near(*d, &between)), || {
                format!("{}: largest at {}. {}", at(map, l2), degrees(&max), because())
            });
            if between.iter().any(|w| !max.iter().any(|d| apart(*d, *w) <= reach)) {
                apart_from_all.push(map.design.clone());
            }
        }
    }
    apart_from_all.sort();
    apart_from_all.dedup();
    let mut evidence = vec![
        format!("The limit is least along every interlocking direction in {}.", least.score()),
        format!("It is largest midway between two in {}.", largest.score()),
        "A case is a design, r, method and l₂ with a limit in every direction.".into(),
    ];
    if !apart_from_all.is_empty() {
        evidence.push(format!("Not all midway directions are alike in {}.", apart_from_all.join(", ")));
    }
    finding(
        1,
        "The limit is least along interlocking directions (1.x, 4.x: 0° and 90°; 3.x: 0°, 60°, 120°) and largest midway \
         between them.",
        evidence,
        vec![least, largest],
    )
}

/// Within this angle of 0° the thesis sees compression lower the limit of design 2, at R/10; as r falls it vanishes.
const STACKED_DEG: f64 = 15.0;

/// A line of the directions that are lowered at some l2.
fn lowered_at(map: &Map, maps: &[Map], what: &str, of_l2: &[f64]) -> String {
    let list: Vec<String> = of_l2.iter().map(|l2| signed(*l2)).collect();
    format!("{}, l₂ = {}: {what}. {}", map.label(), list.join(", "), cause(&[map], maps, of_l2[0]))
}

/// Statement 3.
pub(super) fn compression_raises(maps: &[Map]) -> Finding {
    let mut usual = Cases { usual: true, ..Cases::of("compression raises the limit") };
    let mut named = Cases { some: true, ..Cases::of("of 2, near 0°, the thicker ring: compression lowers it") };
    let mut evidence = Vec::new();
    for map in maps.iter().filter(|map| map.is_plain()) {
        let thicker =
            |other: &Map| (&other.design, &other.method) == (&map.design, &map.method) && other.ratio > map.ratio;
        let excepted = map.design == "2" && !maps.iter().any(thicker);
        let near_0 = |degrees: f64| map.design == "2" && apart(degrees, 0.0) < STACKED_DEG;
        // Near 0° of design 2: raised, the same, lowered.
        let mut of_2 = [0_usize; 3];
        // Directions, and the l2 at which just they are lowered.
        let mut groups: Vec<(String, Vec<f64>)> = Vec::new();
        let (mut lowered_in_all, mut stacked) = (0, Vec::new());
        for l2 in map.l2().into_iter().filter(|l2| *l2 < 0.0) {
            let mut lower = Vec::new();
            for row in map.rows_at(l2) {
                let (Some(held), Some(free)) = (row.l1, map.l1(row.direction_deg, 0.0)) else { continue };
                let is = if held < free - map.tie() { 2 } else { usize::from(held <= free + map.tie()) };
                if near_0(row.direction_deg) {
                    of_2[is] += 1;
                    stacked.extend((is == 2).then_some(row.direction_deg));
                }
                if excepted && near_0(row.direction_deg) {
                    continue;
                }
                match is {
                    0 => usual.shown += 1,
                    1 => usual.ties += 1,
                    _ => lower.push(row.direction_deg),
                }
            }
            if !lower.is_empty() {
                lowered_in_all += lower.len();
                let what = format!("lower than at l₂ = 0 at {}", degrees(&lower));
                match groups.iter_mut().find(|(group, _)| *group == what) {
                    Some((_, of_l2)) => of_l2.push(l2),
                    None => groups.push((what, vec![l2])),
                }
            }
        }
        // Each direction counts, and one line names them all.
        let before = usual.exceptions.len();
        usual.exceptions.extend(groups.iter().map(|(what, of_l2)| lowered_at(map, maps, what, of_l2)));
        usual.exceptions.resize(before + lowered_in_all, String::new());
        if of_2.iter().sum::<usize>() > 0 {
            stacked.sort_by(f64::total_cmp);
            stacked.dedup();
            if excepted {
                named.add(!stacked.is_empty(), || {
                    format!("{}: the exception within ±{STACKED_DEG}° is not seen with these coordinates", map.label())
                });
            }
            let [raised, same, lowered] = of_2;
            let seen = if stacked.is_empty() { String::new() } else { format!(", at {}", degrees(&stacked)) };
            evidence.push(format!(
                "{}, near 0°: compression raises the limit in {raised} cases, leaves it in {same}, lowers it in {lowered}{seen}.",
                map.label()
            ));
        }
    }
    evidence.insert(
        0,
        format!(
            "Compression raises the limit in {} outside the named exception (a direction and an l₂). Ties are mostly \
             interlocking directions, where the same chain binds for every l₂.",
            usual.score()
        ),
    );
    let mut found = finding(
        3,
        "Compression across the pull (l₂ < 0) usually raises the limit; design 2 within ±15° of 0° is the exception at R/10, \
         where its rings stack, which vanishes as r falls.",
        evidence,
        vec![named, usual],
    );
    found.exceptions.retain(|text| !text.is_empty());
    found
}

/// A peak is wider than others from this difference of l1 beside it on.
const WIDER: f64 = 0.005;

/// Statement 6.
pub(super) fn arrangement(maps: &[Map]) -> Finding {
    let mut biased = Cases::of("corner distances, sheared cell: the peak at 30° is wider");
    let mut others = Cases::of("exact limits, strains, rectangular cell: no peak is wider");
    let mut evidence = Vec::new();
    for map in maps.iter().filter(|map| map.design.starts_with("3.")) {
        for l2 in map.l2() {
            let Some(width) = peak_30_against_others(map, l2) else { continue };
            let word = |l1: f64| {
                format!("{}: beside the peak at 30°, l₁ less that beside 90° and 150° is {l1:+.4}", at(map, l2))
            };
            let because = || match map.corners && map.rearranged {
                true => "The corner distances judge the rectangular cell unevenly, too, though less.".into(),
                false => cause(&[map], maps, l2),
            };
            if map.corners && !map.rearranged {
                biased.add(width > WIDER, || format!("{}. {}", word(width), because()));
                evidence.push(word(width) + ".");
            } else {
                if map.corners {
                    evidence.push(word(width) + ".");
                }
                others.add(width.abs() <= WIDER, || format!("{}. {}", word(width), because()));
            }
        }
    }
    evidence.push(format!(
        "Exact limits, limits with the strain protocol and those of the rectangular cell favour no peak (within {WIDER}) in {}.",
        others.score()
    ));
    if matches!(biased.verdict(), Verdict::Holds | Verdict::HoldsWithExceptions) {
        evidence.push(
            "So the wide peak comes from the distance of the cell's corners, which judges the target in a sheared cell \
             unevenly, and not from the material."
                .into(),
        );
    }
    finding(
        6,
        "Open question: in a sheared arrangement of the same topology (3.x) the peak at 30° is wider than those at 90° and \
         150°; in a rectangular one it is not.",
        evidence,
        // What nobody looked for was not found either.
        if biased.count() == 0 { vec![biased] } else { vec![biased, others] },
    )
}

/// How much larger the limit is beside 30° than beside 90° and 150°, on average.
fn peak_30_against_others(map: &Map, l2: f64) -> Option<f64> {
    let beside = |peak: f64, off: f64| Some((map.l1(peak - off, l2)? + map.l1(peak + off, l2)?) / 2.0);
    [10.0, 15.0].into_iter().find_map(|off| Some(beside(30.0, off)? - (beside(90.0, off)? + beside(150.0, off)?) / 2.0))
}
