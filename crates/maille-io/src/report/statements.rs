//! What chapter 6 of the thesis says, and what records say to it: one function a statement.
//!
//! A statement is broken into cases, as "1.1 at r = R/10 with l2 = 0". It holds if every case shows it, holds with
//! exceptions if at least three quarters do (of what is said to be usual: more than half), and else fails. A tie shows
//! nothing: what does not change is neither larger nor blunter. Parts are judged apart; the worst counts. A part that
//! only says that something is to be seen fails where no case shows it.

use super::{EXACT_TIE, Map, apart, extreme, midway, ratio_label, signed, spread, step};
use serde::Serialize;

/// What became of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No record speaks of it.
    NotMeasured,
    /// No case contradicts it.
    Holds,
    /// Some cases do.
    HoldsWithExceptions,
    /// More than a quarter of the cases do.
    Fails,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::NotMeasured => "not measured",
            Verdict::Holds => "holds",
            Verdict::HoldsWithExceptions => "holds with exceptions",
            Verdict::Fails => "fails",
        }
    }
}

/// A statement beside what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Number of the statement.
    pub number: u32,
    /// What the thesis says.
    pub statement: &'static str,
    /// What became of it.
    pub verdict: Verdict,
    /// What was measured.
    pub evidence: Vec<String>,
    /// The cases that contradict it.
    pub exceptions: Vec<String>,
}

/// All statements.
pub fn statements(maps: &[Map]) -> Vec<Finding> {
    vec![
        least_along_interlocking(maps),
        thinner_goes_further(maps),
        compression_raises(maps),
        major_radius(maps),
        scale(maps),
        arrangement(maps),
        steps(maps),
        sharpness(maps),
        shown(maps),
    ]
}

/// Exceptions up to this part of the cases leave a statement standing.
const MOST_EXCEPTIONS: f64 = 0.25;
/// The same where the thesis says "usually".
const MOST_OF_USUAL: f64 = 0.5;

/// How verdicts come about, for readers of the page.
pub(super) const RULE: &str = "Each statement is broken into cases. It holds if every case shows it, holds with exceptions if at \
    least three quarters do (more than half, where the thesis says \u{201c}usually\u{201d}), and fails otherwise. What stays the \
    same has not become larger. Parts are judged apart, and the worst counts.";

/// Cases of one part of a statement.
#[derive(Default)]
struct Cases {
    count: usize,
    exceptions: Vec<String>,
    /// It is enough that some cases show it.
    some: bool,
    /// The thesis says "usually".
    usual: bool,
}

impl Cases {
    fn add(&mut self, holds: bool, what: impl FnOnce() -> String) {
        self.count += 1;
        if !holds {
            self.exceptions.push(what());
        }
    }

    fn verdict(&self) -> Verdict {
        match self.exceptions.len() {
            _ if self.count == 0 => Verdict::NotMeasured,
            0 => Verdict::Holds,
            n if self.some && n < self.count => Verdict::HoldsWithExceptions,
            n if self.usual && (n as f64) < MOST_OF_USUAL * self.count as f64 => Verdict::HoldsWithExceptions,
            n if n as f64 <= MOST_EXCEPTIONS * self.count as f64 => Verdict::HoldsWithExceptions,
            _ => Verdict::Fails,
        }
    }

    /// `61 of 64 cases`.
    fn score(&self) -> String {
        format!("{} of {} cases", self.count - self.exceptions.len(), self.count)
    }
}

impl Finding {
    /// Names a case that keeps the statement from holding as it stands, whatever the other cases say.
    fn except(mut self, what: String) -> Self {
        if self.verdict != Verdict::NotMeasured {
            self.verdict = self.verdict.max(Verdict::HoldsWithExceptions);
        }
        self.exceptions.push(what);
        self
    }
}

fn finding(number: u32, statement: &'static str, evidence: Vec<String>, parts: Vec<Cases>) -> Finding {
    Finding {
        number,
        statement,
        verdict: parts.iter().map(Cases::verdict).max().unwrap_or(Verdict::NotMeasured),
        evidence,
        exceptions: parts.into_iter().flat_map(|part| part.exceptions).collect(),
    }
}

/// `0°, 5°`; many directions are counted.
fn degrees(list: &[f64]) -> String {
    match list.len() {
        n if n > 6 => format!("{n} directions"),
        _ => list.iter().map(|d| format!("{d}°")).collect::<Vec<_>>().join(", "),
    }
}

fn at(map: &Map, l2: f64) -> String {
    format!("{}, l₂ = {}", map.label(), signed(l2))
}

/// Maps of two radii of the same sheet and method, the thicker first.
fn by_radius(maps: &[Map]) -> Vec<(&Map, &Map)> {
    let mut pairs = Vec::new();
    for thick in maps {
        let same = |thin: &&Map| {
            (&thin.design, &thin.method, thin.corners, thin.rearranged)
                == (&thick.design, &thick.method, thick.corners, thick.rearranged)
                && thin.ratio < thick.ratio
        };
        pairs.extend(maps.iter().filter(same).map(|thin| (thick, thin)));
    }
    pairs
}

/// Statement 1.
pub fn least_along_interlocking(maps: &[Map]) -> Finding {
    let (mut least, mut largest) = (Cases::default(), Cases::default());
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
            let contrast = !min.iter().any(|d| max.contains(d));
            let all = map.interlocking_deg.iter().all(|w| min.iter().any(|d| apart(*d, *w) <= reach));
            let alike = || format!("{}: alike in every direction", at(map, l2));
            least.add(contrast && all, || match contrast {
                true => format!("{}: least at {}", at(map, l2), degrees(&min)),
                false => alike(),
            });
            largest.add(contrast && max.iter().any(|d| near(*d, &between)), || match contrast {
                true => format!("{}: largest at {}", at(map, l2), degrees(&max)),
                false => alike(),
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

/// Statement 2.
pub fn thinner_goes_further(maps: &[Map]) -> Finding {
    let (mut limits, mut spreads) = (Cases::default(), Cases::default());
    let mut least_gain = f64::INFINITY;
    for (thick, thin) in by_radius(maps).into_iter().filter(|(thick, _)| thick.is_plain()) {
        for row in &thick.rows {
            let (Some(before), Some(after)) = (row.l1, thin.l1(row.direction_deg, row.l2)) else { continue };
            least_gain = least_gain.min(after - before);
            limits.add(after > before + thick.tie(), || {
                format!("{}, {}°: {before:.4}, thinner {after:.4}", at(thick, row.l2), row.direction_deg)
            });
        }
        for l2 in thick.l2() {
            let (Some(before), Some(after)) = (thick.turn(l2), thin.turn(l2)) else { continue };
            let (before, after) = (spread(&before), spread(&after));
            spreads.add(after > before + thick.tie(), || {
                format!("{}: largest less least λ₁ − 1 is {before:.4}, thinner {after:.4}", at(thick, l2))
            });
        }
    }
    let mut evidence = vec![
        format!("The thinner ring goes further in {} (a direction and an l₂).", limits.score()),
        format!("Largest less least λ₁ − 1 grows with it in {}.", spreads.score()),
    ];
    if limits.count > 0 {
        evidence.push(format!("Least gain in l₁: {least_gain:.4}."));
    }
    let of_2 = spreads.exceptions.iter().filter(|text| text.starts_with("2,")).count();
    let found = finding(
        2,
        "A smaller r/R raises the limit in every direction, and the difference between largest and least limit; for the \
         difference design 2 is somewhat of an exception.",
        evidence,
        vec![limits, spreads],
    );
    match of_2 {
        0 if maps.iter().any(|map| map.design == "2") => found.except(
            "2: the exception that the thesis names is not seen; the difference grows as in the other designs".into(),
        ),
        _ => found,
    }
}

/// Within this angle of 0° the thesis sees compression lower the limit of design 2.
const STACKED_DEG: f64 = 15.0;

/// Statement 3.
pub fn compression_raises(maps: &[Map]) -> Finding {
    let mut usual = Cases { usual: true, ..Cases::default() };
    let mut named = Cases { some: true, ..Cases::default() };
    let mut evidence = Vec::new();
    let mut lines = Vec::new();
    let [mut same_in_all, mut lower_in_all] = [0; 2];
    for map in maps.iter().filter(|map| map.is_plain()) {
        let compressed: Vec<f64> = map.l2().into_iter().filter(|l2| *l2 < 0.0).collect();
        let mut lowered = Vec::new();
        let mut stacked = 0;
        // Directions, and the l2 at which just they are unchanged or lowered.
        let mut groups: Vec<(String, Vec<String>)> = Vec::new();
        for l2 in compressed {
            let (mut same, mut lower) = (Vec::new(), Vec::new());
            for row in map.rows.iter().filter(|row| row.l2 == l2) {
                let (Some(held), Some(free)) = (row.l1, map.l1(row.direction_deg, 0.0)) else { continue };
                if map.design == "2" && apart(row.direction_deg, 0.0) < STACKED_DEG {
                    stacked += 1;
                    lowered.extend((held < free - map.tie()).then_some(row.direction_deg));
                    continue;
                }
                usual.count += 1;
                if held < free - map.tie() {
                    lower.push(row.direction_deg);
                } else if held <= free + map.tie() {
                    same.push(row.direction_deg);
                }
            }
            (same_in_all, lower_in_all) = (same_in_all + same.len(), lower_in_all + lower.len());
            for (list, word) in [(lower, "lower than"), (same, "as")].iter().filter(|(list, _)| !list.is_empty()) {
                // Each direction counts, and one line names them all.
                usual.exceptions.extend(std::iter::repeat_n(String::new(), list.len()));
                let what = format!("{word} at l₂ = 0 at {}", degrees(list));
                match groups.iter_mut().find(|(group, _)| *group == what) {
                    Some((_, of_l2)) => of_l2.push(signed(l2)),
                    None => groups.push((what, vec![signed(l2)])),
                }
            }
        }
        lines.extend(groups.iter().map(|(what, of_l2)| format!("{}, l₂ = {}: {what}", map.label(), of_l2.join(", "))));
        if stacked > 0 {
            lowered.sort_by(f64::total_cmp);
            lowered.dedup();
            named.add(!lowered.is_empty(), || {
                format!("{}: the exception within ±{STACKED_DEG}° is not seen", map.label())
            });
            let seen = if lowered.is_empty() { "in no direction".into() } else { format!("at {}", degrees(&lowered)) };
            evidence.push(format!("{}: compression lowers the limit near 0° {seen}.", map.label()));
        }
    }
    evidence.insert(
        0,
        format!(
            "Compression raises the limit in {} outside the named exception (a direction and an l₂), leaves it as it is \
             in {same_in_all}, and lowers it in {lower_in_all}.",
            usual.score()
        ),
    );
    let mut found = finding(
        3,
        "Compression across the pull (l₂ < 0) usually raises the limit; design 2 within ±15° of 0° is the exception.",
        evidence,
        vec![named, usual],
    );
    found.exceptions.retain(|text| !text.is_empty());
    found.exceptions.extend(lines);
    found
}

/// Designs that differ in the major radius of the standing rings, the larger first.
const MAJOR: [[&str; 2]; 4] = [["1.1", "1.2"], ["3.1", "3.2"], ["1.1t", "1.2t"], ["3.1t", "3.2t"]];
/// Rates that differ by less, relative to the larger, are roughly the same.
const SAME_RATE: f64 = 0.1;

/// Statement 4.
pub fn major_radius(maps: &[Map]) -> Finding {
    let (mut directions, mut larger, mut rates) = (Cases::default(), Cases::default(), Cases::default());
    for [big, small] in MAJOR {
        for a in maps.iter().filter(|map| map.design == big && map.is_plain()) {
            let same = |b: &&Map| b.design == small && b.is_plain() && (b.ratio, &b.method) == (a.ratio, &a.method);
            let Some(b) = maps.iter().find(same) else { continue };
            let mut before: Option<(f64, f64, f64)> = None;
            for row in &a.rows {
                let (Some(of_a), Some(of_b)) = (row.l1, b.l1(row.direction_deg, row.l2)) else { continue };
                larger.add(of_a > of_b + a.tie(), || {
                    format!("{}, {}°: {of_a:.4}, {small} {of_b:.4}", at(a, row.l2), row.direction_deg)
                });
            }
            for l2 in a.l2() {
                let (Some(turn_a), Some(turn_b)) = (a.turn(l2), b.turn(l2)) else { continue };
                for (sign, word) in [(1.0, "least"), (-1.0, "largest")] {
                    let [of_a, of_b] = [&turn_a, &turn_b].map(|turn| extreme(turn, sign, a.tie()));
                    let [best_a, best_b] = [&turn_a, &turn_b].map(|turn| extreme(turn, sign, EXACT_TIE));
                    let agree = best_a.iter().all(|d| of_b.contains(d)) && best_b.iter().all(|d| of_a.contains(d));
                    directions.add(agree, || {
                        format!("{}: {word} at {}, of {small} at {}", at(a, l2), degrees(&of_a), degrees(&of_b))
                    });
                }
                let (spread_a, spread_b) = (spread(&turn_a), spread(&turn_b));
                if let Some((l2_before, was_a, was_b)) = before {
                    let (fall_a, fall_b) = (was_a - spread_a, was_b - spread_b);
                    let off = (fall_a - fall_b).abs() / fall_a.abs().max(fall_b.abs()).max(f64::MIN_POSITIVE);
                    rates.add(off <= SAME_RATE, || {
                        format!(
                            "{}, l₂ from {} to {}: the difference falls by {fall_a:.3}, of {small} by {fall_b:.3}",
                            a.label(),
                            signed(l2_before),
                            signed(l2),
                        )
                    });
                }
                before = Some((l2, spread_a, spread_b));
            }
        }
    }
    let evidence = vec![
        format!("The directions of least and largest limit agree in {}.", directions.score()),
        format!("The larger R has the larger limit in {} (a direction and an l₂).", larger.score()),
        format!("Largest less least λ₁ − 1 falls with l₂ at the same rate (within 10 %) in {}.", rates.score()),
    ];
    finding(
        4,
        "1.1 against 1.2 and 3.1 against 3.2: the same directions of least and largest limit; the larger R has the larger \
         limit everywhere; the difference falls with l₂ at roughly the same rate, in λ₁ − 1.",
        evidence,
        vec![directions, larger, rates],
    )
}

/// Added to the name of a design that is another one in another size.
pub const SCALED: &str = "-scaled";
/// Limits of one sheet in two sizes differ by rounding alone.
const ROUNDING: f64 = 1e-9;

/// Statement 5.
pub fn scale(maps: &[Map]) -> Finding {
    let mut cases = Cases::default();
    let mut most: f64 = 0.0;
    for scaled in maps {
        let Some(name) = scaled.design.strip_suffix(SCALED) else { continue };
        let same = |map: &&Map| {
            map.design == name
                && map.is_plain()
                && map.method == scaled.method
                && (map.ratio - scaled.ratio).abs() < 1e-9
        };
        let Some(map) = maps.iter().find(same) else { continue };
        for row in &scaled.rows {
            let (Some(a), Some(b)) = (row.l1, map.l1(row.direction_deg, row.l2)) else { continue };
            most = most.max((a - b).abs());
            cases.add((a - b).abs() <= ROUNDING, || {
                format!("{}, {}°: {b}, scaled {a}", at(map, row.l2), row.direction_deg)
            });
        }
    }
    let evidence = vec![format!("{} agree to 1e-9; largest difference of l₁ {most:.1e}.", cases.score())];
    finding(5, "Scaling every length by one factor leaves the limits unchanged.", evidence, vec![cases])
}

/// A peak is wider than others from this difference of l1 beside it on.
const WIDER: f64 = 0.005;

/// Statement 6.
pub fn arrangement(maps: &[Map]) -> Finding {
    let (mut biased, mut others) = (Cases::default(), Cases::default());
    let mut evidence = Vec::new();
    for map in maps.iter().filter(|map| map.design.starts_with("3.")) {
        for l2 in map.l2() {
            let Some(width) = peak_30_against_others(map, l2) else { continue };
            let word = |l1: f64| {
                format!("{}: beside the peak at 30°, l₁ less that beside 90° and 150° is {l1:+.4}", at(map, l2))
            };
            if map.corners && !map.rearranged {
                biased.add(width > WIDER, || word(width));
                evidence.push(word(width) + ".");
            } else {
                if map.corners {
                    evidence.push(word(width) + ".");
                }
                others.add(width.abs() <= WIDER, || word(width));
            }
        }
    }
    evidence.push(format!(
        "Exact limits, limits with the strain protocol and those of the rectangular cell favour no peak (within {WIDER}) in {}.",
        others.score()
    ));
    if biased.verdict() == Verdict::Holds {
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
        if biased.count == 0 { vec![biased] } else { vec![biased, others] },
    )
}

/// How much larger the limit is beside 30° than beside 90° and 150°, on average.
fn peak_30_against_others(map: &Map, l2: f64) -> Option<f64> {
    let beside = |peak: f64, off: f64| Some((map.l1(peak - off, l2)? + map.l1(peak + off, l2)?) / 2.0);
    [10.0, 15.0].into_iter().find_map(|off| Some(beside(30.0, off)? - (beside(90.0, off)? + beside(150.0, off)?) / 2.0))
}

/// Designs that the thesis calls dense.
const DENSE: [&str; 2] = ["3.1", "5.2"];

/// Statement 7.
pub fn steps(maps: &[Map]) -> Finding {
    let (mut dense, mut compressed) = (Cases::default(), Cases::default());
    let mut evidence = Vec::new();
    let mean = |map: &Map, of: &dyn Fn(f64) -> bool| {
        let rows: Vec<f64> =
            map.rows.iter().filter(|row| row.l1.is_some() && of(row.l2)).map(|row| row.iterations as f64).collect();
        (!rows.is_empty()).then(|| rows.iter().sum::<f64>() / rows.len() as f64)
    };
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
            format!("{}: {below:.0} steps a limit with l₂ < 0, {above:.0} with l₂ ≥ 0", map.label())
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

/// Openings that differ by less are the same.
const SAME_OPENING_DEG: f64 = 0.05;

/// Statement 8.
pub fn sharpness(maps: &[Map]) -> Finding {
    let mut cases = Cases::default();
    // Blunter, unchanged, sharper: under compression, at l2 = 0 and under extension.
    let mut by_sign = [[0_usize; 3]; 3];
    let mut evidence = Vec::new();
    for (thick, thin) in by_radius(maps) {
        // The energy method's limits are not fine enough for the shape of a corner.
        let fine = thick.is_plain() && thick.method == "exact";
        if !fine || !["1.2", "4.3"].contains(&thick.design.as_str()) {
            continue;
        }
        for l2 in thick.l2() {
            for direction in [0.0, 90.0] {
                let (Some(before), Some(after)) = (opening(thick, l2, direction), opening(thin, l2, direction)) else {
                    continue;
                };
                let text = format!(
                    "{}, {direction}°: the curve's corner opens {before:.1}°, with {} {after:.1}°",
                    at(thick, l2),
                    ratio_label(thin.ratio)
                );
                if direction == 0.0 {
                    evidence.push(text.clone() + ".");
                }
                let outcome = match after - before {
                    more if more > SAME_OPENING_DEG => 0,
                    less if less < -SAME_OPENING_DEG => 2,
                    _ => 1,
                };
                by_sign[usize::from(l2 >= 0.0) + usize::from(l2 > 0.0)][outcome] += 1;
                cases.add(outcome == 0, || text);
            }
        }
    }
    let words =
        |[blunter, same, sharper]: [usize; 3]| format!("blunter {blunter}, unchanged {same}, sharper {sharper}");
    let [below, zero, above] = by_sign.map(words);
    evidence.insert(0, format!("With the thinner ring the minima at 0° and 90° are blunter in {}.", cases.score()));
    evidence.insert(1, format!("l₂ < 0: {below}. l₂ = 0: {zero}. l₂ > 0: {above}."));
    if cases.count > 0 {
        evidence.push(
            "Where a chain of length d along a lattice vector s binds, λ₁ − 1 = ((d/s)² − 1 + (1 − (1 + l₂)²) sin²θ) / \
             cos²θ beside it: at l₂ = 0 one shape for every r, under compression blunter the thinner the ring, under \
             extension sharper."
                .into(),
        );
    }
    finding(
        8,
        "The minima at 0° and 90° become less sharp as the minor radius falls (1.2, 4.3).",
        evidence,
        vec![cases],
    )
}

/// The angle, seen from outside, of the corner that the polar curve of λ1 − 1 has at a direction; from 180° on there is no notch.
fn opening(map: &Map, l2: f64, direction_deg: f64) -> Option<f64> {
    let turn = map.turn(l2)?;
    let step = step(&turn);
    let of = |d: f64| {
        let (_, l1) = turn.iter().find(|(at, _)| apart(*at, d) < 1e-9)?;
        Some((1.0 + l1).powi(2) - 1.0).filter(|radius| *radius > 0.0)
    };
    let here = of(direction_deg)?;
    let half = |to: f64| {
        let (radius, angle) = (of(direction_deg + to)?, to.abs().to_radians());
        Some((radius * angle.sin()).atan2(radius * angle.cos() - here).to_degrees())
    };
    Some(half(step)? + half(-step)?)
}

/// l2 that chapter 6 shows: of 1.1 and 1.2, and of most others.
const SHOWN: [f64; 6] = [-0.375, -0.25, -0.125, 0.0, 0.125, 0.25];

/// Statement 9.
pub fn shown(maps: &[Map]) -> Finding {
    let mut cases = Cases::default();
    let mut proved = 0;
    for map in maps.iter().filter(|map| map.is_plain() && map.method == "exact") {
        if map.design.ends_with('t') {
            continue;
        }
        let from = usize::from(!["1.1", "1.2"].contains(&map.design.as_str()));
        for l2 in &SHOWN[from..] {
            let rows: Vec<_> = map.rows.iter().filter(|row| row.l2 == *l2).collect();
            if !rows.is_empty() && rows.iter().all(|row| row.l1.is_none() && super::answered(row)) {
                proved += 1;
            }
            cases.add(!rows.is_empty() && rows.iter().all(|row| super::answered(row)), || {
                let missing = rows.iter().filter(|row| !super::answered(row)).count();
                if rows.is_empty() {
                    format!("{}: not computed", at(map, *l2))
                } else {
                    format!("{}: {missing} of {} directions without an answer", at(map, *l2), rows.len())
                }
            });
        }
    }
    let evidence = vec![
        format!(
            "Every direction has a limit, or a proof that there is none, in {} (a design, r and l₂).",
            cases.score()
        ),
        format!(
            "In {proved} of them no direction can be reached: this l₂ > 0 is too wide for the sheet as it is drawn here."
        ),
    ];
    finding(
        9,
        "Shown are l₂ from −0.375 (1.1, 1.2) or −0.25 to 0.25 by 0.125, at r = R/10 and R/20.",
        evidence,
        vec![cases],
    )
}

#[cfg(test)]
mod tests;
