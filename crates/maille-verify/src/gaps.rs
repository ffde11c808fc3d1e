//! The distances of a state's rings, and their links.

use crate::{
    apart::{Apart, apart},
    curve_pair,
    record::Row,
    report::{Check, Finding, Verdict},
    sheet::{Pair, Sheet},
    start::{Links, Start, add_link},
};
use std::collections::BTreeMap;

/// Overlap that a limit may have, in reference radii.
pub const OVERLAP: f64 = 1e-9;
/// The smallest gap is the recorded one within this, in reference radii.
const GAP: f64 = 1e-8;

/// Whether rings overlap, the smallest gap is the row's, and links are those of the start; `unit` is that of the row's lengths.
pub(crate) fn gaps_and_links(row: &Row, here: &Sheet, start: &Start, keeps: f64, unit: f64) -> [Finding; 2] {
    let claimed = if row.certified() { -keeps } else { row.max_overlap.unwrap_or(0.0) / unit };
    let pairs = match here.pairs(|a, b| here.touching(a, b)) {
        Ok(pairs) => pairs,
        Err(words) => {
            return [Check::Overlap, Check::Links].map(|check| Finding::new(check, Verdict::Open, None, words.clone()));
        }
    };
    let (mut deepest, mut open) = (None::<(f64, Pair)>, None::<Pair>);
    let mut links = Ok(Vec::new());
    for pair in pairs {
        let (a, b, shift) = pair;
        let (one, other) = (here.circle(a, [0, 0]), here.circle(b, shift));
        let touching = here.touching(a, b);
        let least = touching - claimed - OVERLAP;
        let proved = match apart_in(here, pair, least) {
            Apart::Proved => Some(least),
            Apart::Nearer(found) => {
                let overlap = touching - found;
                if deepest.is_none_or(|(most, _)| overlap > most) {
                    deepest = Some((overlap, pair));
                }
                None
            }
            Apart::Unknown(_) => {
                open = Some(pair);
                None
            }
        };
        if (other.center - one.center).norm() <= one.radius + other.radius {
            add_link(&mut links, pair, here, proved.filter(|d| *d > 0.0));
        }
    }
    let name = |(a, b, shift): Pair| format!("rings {a} and {b} at {shift:?}");
    let overlap = match (deepest, open) {
        (Some((overlap, pair)), _) => Finding::new(
            Check::Overlap,
            Verdict::False,
            Some(overlap),
            format!("{} overlap by {overlap:.3e} R", name(pair)),
        ),
        (None, Some(pair)) => {
            let words = format!("{}: neither apart nor overlapping could be shown", name(pair));
            Finding::new(Check::Overlap, Verdict::Open, None, words)
        }
        (None, None) => {
            let words = format!("no two rings overlap by more than {:.1e} R", OVERLAP + claimed);
            let gap = row.min_gap.map(|gap| gap / unit);
            gap.and_then(|gap| smallest_gap_differs(here, gap))
                .unwrap_or_else(|| Finding::new(Check::Overlap, Verdict::Proved, gap, words))
        }
    };
    [overlap, links_finding(row, links, &start.links)]
}

/// Whether the cores of a pair are at least `least` apart.
fn apart_in(here: &Sheet, pair: Pair, least: f64) -> Apart {
    let (a, b, shift) = pair;
    match here.is_round(pair) {
        true => apart(&here.circle(a, [0, 0]), &here.circle(b, shift), least, here.slack(pair)),
        false => curve_pair::apart(&here.curve(a, [0, 0]), &here.curve(b, shift), least, here.slack(pair)),
    }
}

/// What is wrong with `gap` as the smallest gap, in reference radii: that rings are nearer, or that none are as near.
fn smallest_gap_differs(here: &Sheet, gap: f64) -> Option<Finding> {
    let say = |verdict, words: String| Some(Finding::new(Check::Overlap, verdict, Some(gap), words));
    let pairs = match here.pairs(|a, b| here.touching(a, b) + gap + GAP) {
        Ok(pairs) => pairs,
        Err(words) => return say(Verdict::Open, words),
    };
    let (mut attained, mut unknown) = (false, false);
    for pair in pairs {
        let (a, b, shift) = pair;
        let touching = here.touching(a, b);
        match apart_in(here, pair, touching + gap - GAP) {
            Apart::Nearer(found) => {
                let words = format!(
                    "rings {a} and {b} at {shift:?} have the gap {:.3e} R, {gap:.3e} R in the record",
                    found - touching
                );
                return say(Verdict::False, words);
            }
            Apart::Unknown(_) => unknown = true,
            Apart::Proved => {}
        }
        if !attained {
            match apart_in(here, pair, touching + gap + GAP) {
                Apart::Nearer(_) => attained = true,
                Apart::Unknown(_) => unknown = true,
                Apart::Proved => {}
            }
        }
    }
    match (attained, unknown) {
        (true, false) => None,
        (false, false) => say(Verdict::False, format!("no two rings have the gap {gap:.3e} R of the record")),
        _ => say(Verdict::Open, format!("whether the smallest gap is {gap:.3e} R could not be shown")),
    }
}

fn links_finding(row: &Row, found: Result<Links, String>, start: &Result<Links, String>) -> Finding {
    let (found, start) = match (found, start) {
        (Ok(found), Ok(start)) => (found, start),
        (Err(words), _) => return Finding::new(Check::Links, Verdict::Open, None, words),
        (_, Err(words)) => return Finding::new(Check::Links, Verdict::Open, None, format!("at the start, {words}")),
    };
    let kept = found == *start;
    let claimed = row.certified() || row.comes_apart() || row.links_ok.unwrap_or(kept);
    if kept == claimed && row.links_ok.is_none_or(|ok| ok == kept) {
        let words = if kept {
            "linking numbers are those of the design"
        } else {
            "links are not the design's, as the row says"
        };
        return Finding::new(Check::Links, Verdict::Proved, Some(found.len() as f64), words);
    }
    let by_pair: BTreeMap<Pair, i32> = start.iter().copied().collect();
    let now: BTreeMap<Pair, i32> = found.iter().copied().collect();
    let differs = by_pair.keys().chain(now.keys()).find(|pair| by_pair.get(pair) != now.get(pair));
    let words = match differs {
        Some(pair @ (a, b, shift)) => {
            let number = |of: &BTreeMap<Pair, i32>| of.get(pair).copied().unwrap_or(0);
            format!(
                "rings {a} and {b} at {shift:?} have linking number {}, {} in the design",
                number(&now),
                number(&by_pair)
            )
        }
        None => "the links are those of the design, and links_ok is false".to_owned(),
    };
    Finding::new(Check::Links, Verdict::False, None, words)
}
