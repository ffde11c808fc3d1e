//! A record, row by row.

use crate::{
    apart::{Apart, apart, some_distance},
    balance::{COMPLEMENTARITY, Free, RESIDUAL, balance},
    chain::{self, ChainBound},
    endless::could_meet,
    files,
    linking::linking_number,
    record::{Chain, Row, Run, State, Texts, Unreadable, read_rows, read_run, read_states},
    report::{Check, Finding, RowReport, Verdict},
    sheet::{self, Cell, Pair, Sheet},
    strain,
};
use std::collections::BTreeMap;

/// Overlap that a limit may have, in reference radii.
pub const OVERLAP: f64 = 1e-9;
/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// Tolerance of the record's own figures of a certificate.
const CERTIFIED: f64 = 1e-9;

/// A start with its links.
struct Start {
    sheet: Sheet,
    links: Result<Links, String>,
}

/// The linked pairs with their linking numbers, in order.
type Links = Vec<(Pair, i32)>;

/// A record that was read, with what all its rows need.
pub struct Verifier {
    run: Run,
    rows: Vec<Row>,
    states: BTreeMap<(u64, u64), State>,
    files: Vec<Finding>,
    /// By cell, with the elements in the order of the first state that has this cell.
    starts: BTreeMap<String, Result<Start, String>>,
}

impl Verifier {
    /// Reads the files and checks that they fit together.
    pub fn new(texts: &Texts<'_>) -> Result<Verifier, Unreadable> {
        let run = read_run(texts.run)?;
        let rows = texts.limits.map(read_rows).transpose()?.unwrap_or_default();
        let states = texts.states.map(read_states).transpose()?.unwrap_or_default();
        let files = files::check(texts, &run, &rows, &states);
        let key = |state: &State| files::key(state.direction_deg, state.l2);
        let states: BTreeMap<_, _> = states.into_iter().map(|state| (key(&state), state)).collect();
        let mut starts = BTreeMap::new();
        for row in &rows {
            let Some(state) = states.get(&files::key(row.direction_deg, row.l2)) else { continue };
            starts.entry(row.cell.clone()).or_insert_with(|| start(&run, &row.cell, state));
        }
        Ok(Verifier { run, rows, states, files, starts })
    }

    /// What is known of the files.
    pub fn files(&self) -> &[Finding] {
        &self.files
    }

    /// Name of the design.
    pub fn design(&self) -> &str {
        &self.run.design.name
    }

    /// Rows of the record.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Verifies row `k`, counted from 0.
    pub fn row(&self, k: usize) -> RowReport {
        let row = &self.rows[k];
        let (direction_deg, l2, status) = (row.direction_deg, row.l2, row.status.clone());
        let findings = match self.states.get(&files::key(direction_deg, l2)) {
            Some(state) => self.findings(row, state),
            None => vec![Finding::new(Check::Files, Verdict::False, None, "the row has no state")],
        };
        RowReport { direction_deg, l2, status, certified: row.certified(), findings }
    }

    fn findings(&self, row: &Row, state: &State) -> Vec<Finding> {
        let found = matches!(row.status.as_str(), "threshold-reached" | "uncertified");
        let solved = row.certified() || row.comes_apart() || found;
        if !solved {
            return self.bound(row, state).into_iter().collect();
        }
        let refused = |words: String| vec![Finding::new(Check::Files, Verdict::False, None, words)];
        let unit = self.run.design.reference_radius;
        let start = match &self.starts[&row.cell] {
            Ok(start) => start,
            Err(words) => return refused(words.clone()),
        };
        let Some(cell) = sheet::cell(&row.cell) else { return refused(format!("\"{}\" is no cell", row.cell)) };
        // The same elements in the same order as in the state that the start was made for.
        let here = match Sheet::start(&self.run.design, &cell, &state.poses).and_then(|own| own.at(state, unit)) {
            Ok(here) if same_rings(&here, &start.sheet) => here,
            Ok(_) => return refused("the poses are not in the order of the other rows".into()),
            Err(words) => return refused(words),
        };
        let mut out = Vec::new();
        out.push(match strain::deformation(row, state, here.lattice, start.sheet.lattice, &cell) {
            Ok(largest) => Finding::new(
                Check::Deformation,
                Verdict::Proved,
                Some(largest),
                format!("the row's strains are those of the lattice, to {largest:.1e}"),
            ),
            Err(words) => Finding::new(Check::Deformation, Verdict::False, None, words),
        });
        self.overlap_and_links(row, &here, start, &mut out);
        if row.certified() {
            out.push(self.balance(row, state, &here, start));
            out.extend(self.bound(row, state));
        }
        if row.comes_apart() {
            out.push(match could_meet(&here, &start.sheet, strain::axes(row.direction_deg).0) {
                Ok(None) => Finding::new(Check::Bound, Verdict::Proved, None, "from this state l1 can grow for ever"),
                Ok(Some((a, b, shift))) => {
                    let words = format!("rings {a} and {b} at {shift:?} could meet where l1 grows on from this state");
                    Finding::new(Check::Bound, Verdict::False, None, words)
                }
                Err(words) => Finding::new(Check::Bound, Verdict::Open, None, words),
            });
        }
        out
    }

    fn overlap_and_links(&self, row: &Row, here: &Sheet, start: &Start, out: &mut Vec<Finding>) {
        let unit = self.run.design.reference_radius;
        let claimed = if row.certified() { 0.0 } else { row.max_overlap.unwrap_or(0.0) / unit };
        let pairs = match here.pairs(|a, b| here.touching(a, b)) {
            Ok(pairs) => pairs,
            Err(words) => return out.push(Finding::new(Check::Overlap, Verdict::Open, None, words)),
        };
        let (mut smallest, mut deepest, mut open) = (f64::INFINITY, None::<(f64, Pair)>, None::<Pair>);
        let mut links = Ok(Vec::new());
        for pair in pairs {
            let (a, b, shift) = pair;
            let (one, other) = (here.circle(a, [0, 0]), here.circle(b, shift));
            let (touching, slack) = (here.touching(a, b), here.slack(pair));
            let least = touching - claimed - OVERLAP;
            let proved = match apart(&one, &other, least, slack) {
                Apart::Proved(nearest) => {
                    smallest = smallest.min(nearest - touching);
                    Some(least)
                }
                Apart::Nearer(found) => {
                    smallest = smallest.min(found - touching);
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
                add_link(&mut links, pair, (&one, &other), proved.filter(|d| *d > 0.0), slack);
            }
        }
        let name = |(a, b, shift): Pair| format!("rings {a} and {b} at {shift:?}");
        let gap = row.min_gap.map(|gap| gap / unit);
        out.push(match (deepest, open, gap) {
            (Some((overlap, pair)), ..) => Finding::new(
                Check::Overlap,
                Verdict::False,
                Some(overlap),
                format!("{} overlap by {overlap:.3e} R", name(pair)),
            ),
            (None, Some(pair), _) => {
                let words = format!("{}: neither apart nor overlapping could be shown", name(pair));
                Finding::new(Check::Overlap, Verdict::Open, None, words)
            }
            // The least distance that was seen is above the true one by what the halving leaves.
            (None, None, Some(gap)) if smallest.is_finite() && (gap - smallest).abs() > 10.0 * OVERLAP => Finding::new(
                Check::Overlap,
                Verdict::False,
                Some(smallest),
                format!("the smallest gap is {smallest:.3e} R, {gap:.3e} R in limits.csv"),
            ),
            _ => Finding::new(
                Check::Overlap,
                Verdict::Proved,
                smallest.is_finite().then_some(smallest),
                format!("no two rings overlap by more than {:.1e} R", OVERLAP + claimed),
            ),
        });
        out.push(links_finding(row, links, &start.links));
    }

    fn balance(&self, row: &Row, state: &State, here: &Sheet, start: &Start) -> Finding {
        let wrong = |figure: Option<f64>, words: String| Finding::new(Check::Balance, Verdict::False, figure, words);
        let (d, side) = strain::axes(row.direction_deg);
        let rate = |to: &nalgebra::Vector2<f64>, of: &nalgebra::Vector2<f64>| {
            start.sheet.lattice.map(|a| {
                let v = to * of.dot(&a.xy());
                sheet::Vec3::new(v.x, v.y, 0.0)
            })
        };
        let free = |word: &Option<String>| word.as_deref() == Some("free");
        let sign = if row.end.as_deref() == Some("least") { -1.0 } else { 1.0 };
        let mut rates = vec![rate(&(d * sign), &d)];
        rates.extend(free(&row.lateral).then(|| rate(&side, &side)));
        rates.extend(free(&row.shear).then(|| rate(&d, &side)));
        let found = match balance(here, &state.contacts, self.run.design.reference_radius, &Free(rates)) {
            Ok(found) => found,
            Err(words) => return wrong(None, words),
        };
        if found.least_force < 0.0 {
            return wrong(Some(found.least_force), format!("a contact pulls: its force is {:.3e}", found.least_force));
        }
        if found.complementarity.is_nan() || found.complementarity > COMPLEMENTARITY {
            let words =
                format!("a contact that carries is not closed: force times gap is {:.3e}", found.complementarity);
            return wrong(Some(found.complementarity), words);
        }
        let residual = found.residual.max(found.slope);
        if residual.is_nan() || residual > RESIDUAL {
            return wrong(Some(residual), format!("the forces do not balance the pull: {residual:.3e} is left"));
        }
        let above = |x: Option<f64>, most: f64| x.is_some_and(|x| x > most);
        if above(row.dual_residual, CERTIFIED)
            || above(row.complementarity, CERTIFIED)
            || above(row.min_multiplier.map(|m| -m), CERTIFIED)
            || above(row.min_curvature.map(|c| -c), 0.0)
        {
            return wrong(None, "the row's own figures are none of a certificate".into());
        }
        if row.own_image_force.is_some_and(|written| (written - found.own_image).abs() > RESIDUAL) {
            let words = format!("own_image_force is {:?}, {:?} in the state", row.own_image_force, found.own_image);
            return wrong(Some(found.own_image), words);
        }
        let anew = if found.anew { "; those of flat pairs as heights, and others on closed points" } else { "" };
        let count = state.contacts.len();
        let words = format!("{count} forces, all pushing, balance the pull to {residual:.1e}{anew}");
        Finding::new(Check::Balance, Verdict::Proved, Some(residual), words)
    }

    /// The bound of a row that has one; of a row without a limit the proof that there is none, where a chain is it.
    fn bound(&self, row: &Row, state: &State) -> Option<Finding> {
        let say = |verdict, figure, words: String| Some(Finding::new(Check::Bound, verdict, figure, words));
        let held = row.end.as_deref() != Some("least")
            && [&row.lateral, &row.shear].iter().all(|word| word.as_deref() != Some("free"));
        let chain = state.chain.as_ref().filter(|_| held).map(|chain| self.chain(row, chain));
        if row.status == "l2-unreachable" {
            return match chain {
                Some(Ok(ChainBound::Impossible)) => {
                    say(Verdict::Proved, None, "a chain of links is too short for this l2".into())
                }
                Some(Err(words)) => say(Verdict::False, None, words),
                _ => None,
            };
        }
        if !row.certified() {
            return None;
        }
        let (Some(l1), Some(bound)) = (row.l1, row.bound_l1) else {
            let wrong = row.status == "global";
            return wrong.then(|| Finding::new(Check::Bound, Verdict::False, None, "a global row without a bound"));
        };
        let gap = bound - l1;
        if row.bound_gap.is_some_and(|written| (written - gap).abs() > strain::SAME) {
            return say(
                Verdict::False,
                Some(gap),
                format!("bound_gap is {:?}, bound_l1 − l1 is {gap:?}", row.bound_gap),
            );
        }
        if gap < -ATTAINED || (row.status == "global" && gap > ATTAINED * (1.0 + 1e-6)) {
            return say(Verdict::False, Some(gap), format!("l1 is {l1:?}, its bound {bound:?}, status {}", row.status));
        }
        match (chain, row.bound_kind.as_deref()) {
            (Some(Err(words)), _) => say(Verdict::False, None, words),
            (Some(Ok(ChainBound::Impossible)), _) => say(Verdict::False, None, "the chain forbids this l2".into()),
            (Some(Ok(ChainBound::AtMost(most))), Some("chain"))
                if (most - bound).abs() > strain::SAME * (2.0 + bound) =>
            {
                say(Verdict::False, Some(most), format!("the chain's bound is {most:?}, bound_l1 is {bound:?}"))
            }
            (Some(Ok(ChainBound::AtMost(_))), Some("chain")) => {
                say(Verdict::Proved, Some(gap), "the bound follows from the chain of links".into())
            }
            (_, kind) => {
                let kind = kind.unwrap_or("unnamed");
                say(Verdict::Consistent, Some(gap), format!("the {kind} bound is taken from the record"))
            }
        }
    }

    fn chain(&self, row: &Row, chain: &Chain) -> Result<ChainBound, String> {
        let first = self.run.parameters["cells"][0].as_str().unwrap_or_default();
        let unit = self.run.design.reference_radius;
        let of_chain = match self.starts.get(first) {
            Some(Ok(start)) => start,
            _ => return Err(format!("no state of the cell {first}, whose rings the chain counts")),
        };
        let links = of_chain.links.as_ref().map_err(Clone::clone)?;
        chain::bound(&of_chain.sheet, links, chain, unit, row.direction_deg, row.l2)
    }
}

fn same_rings(a: &Sheet, b: &Sheet) -> bool {
    let same = |(x, y): (&sheet::Ring, &sheet::Ring)| x.element == y.element && x.arm == y.arm && x.normal == y.normal;
    a.rings.len() == b.rings.len() && a.rings.iter().zip(&b.rings).all(same)
}

fn start(run: &Run, cell: &str, state: &State) -> Result<Start, String> {
    let cell: Cell = sheet::cell(cell).ok_or_else(|| format!("\"{cell}\" is no cell"))?;
    let sheet = Sheet::start(&run.design, &cell, &state.poses)?;
    let mut links = Ok(Vec::new());
    for pair in sheet.pairs(|_, _| 0.0)? {
        let circles = (&sheet.circle(pair.0, [0, 0]), &sheet.circle(pair.1, pair.2));
        add_link(&mut links, pair, circles, None, sheet.slack(pair));
    }
    Ok(Start { sheet, links })
}

/// Adds the pair if it is linked. `proved` is a distance that the circles are known to keep.
fn add_link(
    links: &mut Result<Links, String>,
    pair: Pair,
    (one, other): (&maille_geometry::Circle, &maille_geometry::Circle),
    proved: Option<f64>,
    slack: f64,
) {
    let Ok(known) = links else { return };
    let apart = proved.or_else(|| some_distance(one, other, slack)).ok_or("core circles meet".to_owned());
    match apart.and_then(|apart| linking_number(one, other, apart)) {
        Ok(0) => {}
        Ok(number) => known.push((pair, number)),
        Err(words) => *links = Err(format!("rings {} and {} at {:?}: {words}", pair.0, pair.1, pair.2)),
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
