//! A record, row by row.

use crate::{
    apart::{Apart, apart, some_distance},
    balance::{Balance, COMPLEMENTARITY, Free, RESIDUAL, balance, points},
    chain::{self, ChainBound},
    claims,
    curvature::{Curvature, ZERO_MODE, curvature},
    dual::{self, Held, Starts},
    endless::could_meet,
    files,
    image::too_near,
    linking::linking_number,
    record::{Row, Run, State, Texts, Unreadable, read_rows, read_run, read_states},
    report::{Check, Finding, RowReport, Verdict},
    sheet::{self, Cell, Pair, Sheet},
    strain,
    tie::Linked,
};
use std::collections::{BTreeMap, BTreeSet};

/// Overlap that a limit may have, in reference radii.
pub const OVERLAP: f64 = 1e-9;
/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// The smallest gap is the recorded one within this, in reference radii.
const GAP: f64 = 1e-8;
/// A curvature below this share of the largest, with a minus, is no rounding.
const SADDLE: f64 = 1e-6;
/// `min_curvature` is the one that is found within this share of it.
const CURVATURE: f64 = 1e-3;

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
    columns: BTreeSet<String>,
    states: BTreeMap<(u64, u64), State>,
    files: Vec<Finding>,
    /// By cell, with the elements in the order of the first state that has this cell.
    starts: BTreeMap<String, Result<Start, String>>,
    /// Name of a cell that is one copy of the design: the first of the run if it is, else 1x1. Ties are counted in it.
    own_cell: String,
    own: Result<Start, String>,
}

impl Verifier {
    /// Reads the files and checks that they fit together.
    pub fn new(texts: &Texts<'_>) -> Result<Verifier, Unreadable> {
        let run = read_run(texts.run)?;
        let (rows, columns) = texts.limits.map(read_rows).transpose()?.unwrap_or_default();
        let states = texts.states.map(read_states).transpose()?.unwrap_or_default();
        let files = files::check(texts, &run, &rows, &states);
        let key = |state: &State| files::key(state.direction_deg, state.l2);
        let states: BTreeMap<_, _> = states.into_iter().map(|state| (key(&state), state)).collect();
        let mut starts = BTreeMap::new();
        for row in &rows {
            let Some(state) = states.get(&files::key(row.direction_deg, row.l2)) else { continue };
            starts.entry(row.cell.clone()).or_insert_with(|| match sheet::cell(&row.cell) {
                Some(cell) => start(&run, &cell, &names(state)),
                None => Err(format!("\"{}\" is no cell", row.cell)),
            });
        }
        let first = run.parameters["cells"][0].as_str().unwrap_or_default();
        let (own_cell, cell) = match sheet::cell(first).filter(|cell| sheet::copies(cell) == 1) {
            Some(cell) => (first.to_owned(), cell),
            None => ("1x1".to_owned(), [[1, 0], [0, 1]]),
        };
        let elements: Vec<&str> = run.design.elements.iter().map(|element| element.name.as_str()).collect();
        let own = start(&run, &cell, &elements);
        Ok(Verifier { run, rows, columns, states, files, starts, own_cell, own })
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
        let mut findings = vec![match claims::contradiction(row, &self.columns) {
            Some(words) => Finding::new(Check::Status, Verdict::False, None, words),
            None => Finding::new(Check::Status, Verdict::Proved, None, "the row has what its status says"),
        }];
        match self.states.get(&files::key(direction_deg, l2)) {
            Some(state) => findings.extend(self.findings(row, state)),
            None => findings.push(Finding::new(Check::Files, Verdict::False, None, "the row has no state")),
        }
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
        let here = match Sheet::start(&self.run.design, &cell, &names(state)).and_then(|own| own.at(state, unit)) {
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
            self.forces(row, state, &here, start, &mut out);
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
        let (mut deepest, mut open) = (None::<(f64, Pair)>, None::<Pair>);
        let mut links = Ok(Vec::new());
        for pair in pairs {
            let (a, b, shift) = pair;
            let (one, other) = (here.circle(a, [0, 0]), here.circle(b, shift));
            let (touching, slack) = (here.touching(a, b), here.slack(pair));
            let least = touching - claimed - OVERLAP;
            let proved = match apart(&one, &other, least, slack) {
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
                add_link(&mut links, pair, (&one, &other), proved.filter(|d| *d > 0.0), slack);
            }
        }
        let name = |(a, b, shift): Pair| format!("rings {a} and {b} at {shift:?}");
        out.push(match (deepest, open) {
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
        });
        out.push(links_finding(row, links, &start.links));
    }

    /// The forces of the state, and the curvature with them.
    fn forces(&self, row: &Row, state: &State, here: &Sheet, start: &Start, out: &mut Vec<Finding>) {
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
        let free = Free(rates);
        let points = match points(here, &state.contacts, self.run.design.reference_radius) {
            Ok(points) => points,
            Err(words) => return out.push(Finding::new(Check::Balance, Verdict::False, None, words)),
        };
        out.push(balance_finding(row, &balance(here, &points, &free)));
        let anchors = start.sheet.carried();
        out.push(match curvature(here, &points, &free.0, anchors) {
            Ok(found) => curvature_finding(row, &found, free.0.len() > 1),
            Err(words) => Finding::new(Check::Curvature, Verdict::Open, None, words),
        });
    }

    /// The bound of a row that has one; of a row without a limit the proof that there is none.
    fn bound(&self, row: &Row, state: &State) -> Option<Finding> {
        let say = |verdict, figure, words: String| Some(Finding::new(Check::Bound, verdict, figure, words));
        if row.status == "l2-unreachable" {
            return Some(self.unreachable(row, state));
        }
        let (true, Some(l1), Some(bound)) = (row.certified(), row.l1, row.bound_l1) else { return None };
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
        // A chain in the state is that of the chain bound, also where the link bound is lower.
        let without_forces = row.bound_kind.as_deref() == Some("link") && state.dual.is_empty();
        let (means, most) = match self.derived(row, state) {
            Ok(Some(derived)) if !without_forces => derived,
            Ok(_) => {
                let words = "nothing in the state proves the bound: older versions wrote no forces of link bounds";
                return say(Verdict::Open, Some(gap), words.into());
            }
            Err((verdict, words)) => return say(verdict, None, words),
        };
        let named = if means == LINKS { "link" } else { "chain" };
        if row.bound_kind.as_deref() != Some(named) {
            let kind = row.bound_kind.as_deref().unwrap_or("none");
            return say(Verdict::False, None, format!("bound_kind is {kind}; the state has {means}"));
        }
        let tolerance = if means == A_CHAIN { strain::SAME * (2.0 + bound) } else { ATTAINED };
        if most < -1.0 {
            say(Verdict::False, Some(most), format!("{means} forbids this l2"))
        } else if (most - bound).abs() > tolerance {
            say(Verdict::False, Some(most), format!("{means} proves l1 ≤ {most:?}, bound_l1 is {bound:?}"))
        } else {
            say(Verdict::Proved, Some(gap), format!("{means} proves the bound"))
        }
    }

    /// A row that claims that no state has its l2.
    fn unreachable(&self, row: &Row, state: &State) -> Finding {
        let say = |verdict, words: String| Finding::new(Check::Bound, verdict, None, words);
        if self.has_its_l2(row, state) {
            return say(
                Verdict::False,
                "the state has this l2, without overlap and with the links of the design".into(),
            );
        }
        let (means, most) = match self.derived(row, state) {
            Ok(Some((means, most))) if most < -1.0 => {
                return say(Verdict::Proved, format!("{means} forbids this l2"));
            }
            Ok(Some(derived)) => derived,
            Ok(None) => return say(Verdict::Open, "nothing in the state proves that no state has this l2".into()),
            Err((verdict, words)) => return say(verdict, words),
        };
        match self.images(row, most) {
            Ok(Some((element, shift))) => {
                let name = &state.poses[element].element;
                say(Verdict::Proved, format!("\"{name}\" would overlap its image at {shift:?}, or be linked with it"))
            }
            // Older versions wrote no forces where the links together forbid it.
            Ok(None) => {
                let words = format!("{means} allows this l2, and no images of an element are shown to be too near");
                say(Verdict::Open, words)
            }
            Err((verdict, words)) => say(verdict, words),
        }
    }

    /// Whether the state is one of this sheet with the row's l2.
    fn has_its_l2(&self, row: &Row, state: &State) -> bool {
        let unit = self.run.design.reference_radius;
        let (Ok(start), Some(cell)) = (&self.starts[&row.cell], sheet::cell(&row.cell)) else { return false };
        let own = Sheet::start(&self.run.design, &cell, &names(state));
        let Ok(here) = own.and_then(|own| own.at(state, unit)) else { return false };
        // What a limit in this state would have to show.
        let limit = Row {
            status: "local".into(),
            max_overlap: None,
            min_gap: None,
            links_ok: None,
            l1: None,
            l1_uncertified: None,
            ..row.clone()
        };
        let mut found = Vec::new();
        self.overlap_and_links(&limit, &here, start, &mut found);
        strain::deformation(&limit, state, here.lattice, start.sheet.lattice, &cell).is_ok()
            && found.iter().all(|finding| finding.verdict == Verdict::Proved)
    }

    /// An element of the row's cell whose image would be too near at every l1 up to `most`.
    fn images(&self, row: &Row, most: f64) -> Result<Option<(usize, [i32; 2])>, (Verdict, String)> {
        if [&row.lateral, &row.shear].iter().any(|word| word.as_deref() == Some("free")) {
            return Ok(None);
        }
        Ok(too_near(linked(&self.starts[&row.cell])?, most, row.l2, strain::axes(row.direction_deg)))
    }

    /// By what means the state bounds l1, and the bound; below −1 where no state has this l2. `None` if it names nothing.
    fn derived(&self, row: &Row, state: &State) -> Result<Option<(&'static str, f64)>, (Verdict, String)> {
        let free = |word: &Option<String>| word.as_deref() == Some("free");
        let [lateral, shear] = [free(&row.lateral), free(&row.shear)];
        let wrong = |words: String| (Verdict::False, words);
        if let Some(first) = state.dual.first() {
            let means = if first.tie == "chain" { CHAINS } else { LINKS };
            let starts = Starts { own: linked(&self.own)?, first: linked(self.first()?).ok() };
            let held = Held { l2: (!lateral).then_some(row.l2), shear_free: shear };
            let most = dual::bound(starts, &state.dual, row.direction_deg, held).map_err(wrong)?;
            return Ok(Some((means, most - 1.0)));
        }
        let Some(chain) = state.chain.as_ref().filter(|_| !lateral && !shear) else { return Ok(None) };
        let unit = self.run.design.reference_radius;
        let of_chain = linked(self.first()?)?;
        let most = match chain::bound(of_chain, chain, unit, row.direction_deg, row.l2).map_err(wrong)? {
            ChainBound::Impossible => f64::NEG_INFINITY,
            ChainBound::AtMost(most) => most,
        };
        Ok(Some((A_CHAIN, most)))
    }

    /// The start in the first cell of the run, in which chains are counted.
    fn first(&self) -> Result<&Result<Start, String>, (Verdict, String)> {
        let first = self.run.parameters["cells"][0].as_str().unwrap_or_default();
        if first == self.own_cell {
            return Ok(&self.own);
        }
        self.starts
            .get(first)
            .ok_or_else(|| (Verdict::Open, format!("no state of the cell {first}, whose rings the chain counts")))
    }
}

/// Means of a bound.
const A_CHAIN: &str = "a chain of links";
const CHAINS: &str = "a chain of links with others";
const LINKS: &str = "a balance of forces in the links";

fn linked(start: &Result<Start, String>) -> Result<Linked<'_>, (Verdict, String)> {
    let start = start.as_ref().map_err(|words| (Verdict::False, words.clone()))?;
    let links = start.links.as_ref().map_err(|words| (Verdict::Open, words.clone()))?;
    Ok(Linked { sheet: &start.sheet, links })
}

fn same_rings(a: &Sheet, b: &Sheet) -> bool {
    let same = |(x, y): (&sheet::Ring, &sheet::Ring)| x.element == y.element && x.arm == y.arm && x.normal == y.normal;
    a.rings.len() == b.rings.len() && a.rings.iter().zip(&b.rings).all(same)
}

/// The start in `cell`, with the elements in the order of `poses`.
fn start(run: &Run, cell: &Cell, names: &[&str]) -> Result<Start, String> {
    let sheet = Sheet::start(&run.design, cell, names)?;
    let mut links = Ok(Vec::new());
    match sheet.pairs(|_, _| 0.0) {
        Ok(pairs) => {
            for pair in pairs {
                let circles = (&sheet.circle(pair.0, [0, 0]), &sheet.circle(pair.1, pair.2));
                add_link(&mut links, pair, circles, None, sheet.slack(pair));
            }
        }
        Err(words) => links = Err(words),
    }
    Ok(Start { sheet, links })
}

fn names(state: &State) -> Vec<&str> {
    state.poses.iter().map(|pose| pose.element.as_str()).collect()
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
        let (one, other) = (here.circle(a, [0, 0]), here.circle(b, shift));
        let (touching, slack) = (here.touching(a, b), here.slack(pair));
        match apart(&one, &other, touching + gap - GAP, slack) {
            Apart::Nearer(found) => {
                let words = format!(
                    "rings {a} and {b} at {shift:?} have the gap {:.3e} R, {gap:.3e} R in limits.csv",
                    found - touching
                );
                return say(Verdict::False, words);
            }
            Apart::Unknown(_) => unknown = true,
            Apart::Proved => {}
        }
        if !attained {
            match apart(&one, &other, touching + gap + GAP, slack) {
                Apart::Nearer(_) => attained = true,
                Apart::Unknown(_) => unknown = true,
                Apart::Proved => {}
            }
        }
    }
    match (attained, unknown) {
        (true, false) => None,
        (false, false) => say(Verdict::False, format!("no two rings have the gap {gap:.3e} R of limits.csv")),
        _ => say(Verdict::Open, format!("whether the smallest gap is {gap:.3e} R could not be shown")),
    }
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

fn balance_finding(row: &Row, found: &Balance) -> Finding {
    let wrong = |figure: f64, words: String| Finding::new(Check::Balance, Verdict::False, Some(figure), words);
    if found.least_force < 0.0 {
        return wrong(found.least_force, format!("a contact pulls: its force is {:.3e}", found.least_force));
    }
    if found.complementarity.is_nan() || found.complementarity > COMPLEMENTARITY {
        let words = format!("a contact that carries is not closed: force times gap is {:.3e}", found.complementarity);
        return wrong(found.complementarity, words);
    }
    let residual = found.residual.max(found.slope);
    if residual.is_nan() || residual > RESIDUAL {
        return wrong(residual, format!("the recorded forces do not balance the pull: {residual:.3e} is left"));
    }
    // Contacts that carry next to nothing are not in the state: the least can be below all that are.
    if let Some(least) = row.min_multiplier.filter(|least| *least > found.least_force + RESIDUAL) {
        let words = format!("min_multiplier is {least:?}, a force of the state {:?}", found.least_force);
        return wrong(found.least_force, words);
    }
    if row.own_image_force.is_some_and(|written| (written - found.own_image).abs() > RESIDUAL) {
        let words = format!("own_image_force is {:?}, {:?} in the state", row.own_image_force, found.own_image);
        return wrong(found.own_image, words);
    }
    let words = format!("the recorded forces push, on closed contacts, and balance the pull to {residual:.1e}");
    Finding::new(Check::Balance, Verdict::Proved, Some(residual), words)
}

/// The curvature of a certified row. Its figures depend on the unknowns; where something is free, or a pair lies flat, they are not compared.
fn curvature_finding(row: &Row, found: &Curvature, is_free: bool) -> Finding {
    let say = |verdict, figure, words: String| Finding::new(Check::Curvature, verdict, figure, words);
    let (scale, least) = (found.scale(), found.least());
    match found.values.first() {
        Some(&lowest) if lowest < -SADDLE * scale => {
            let words = format!("a motion that keeps the loaded contacts has the curvature {lowest:.3e}: it raises l1");
            return say(Verdict::False, Some(lowest), words);
        }
        Some(&lowest) if lowest < -ZERO_MODE * scale => {
            let words = format!("the least curvature, {lowest:.3e}, is too near to 0");
            return say(Verdict::Open, Some(lowest), words);
        }
        _ => {}
    }
    if !(found.flat || is_free) {
        let apart = match (row.min_curvature, least) {
            (Some(written), Some(found)) => (written - found).abs() > CURVATURE * found.abs().max(written.abs()),
            (None, None) => false,
            _ => true,
        };
        let modes = found.zero_modes();
        if apart || row.zero_modes != Some(modes) {
            let words = format!(
                "min_curvature is {:?} with {:?} zero modes, {least:?} with {modes} in the state",
                row.min_curvature, row.zero_modes
            );
            // An eigenvalue about the size that counts as zero is none in one computation and one in another.
            let near = |v: &f64| (0.1..10.0).contains(&(v.abs() / (ZERO_MODE * scale)));
            let verdict = if found.values.iter().any(near) { Verdict::Open } else { Verdict::False };
            return say(verdict, least, words);
        }
    }
    let words = match least {
        Some(least) => format!("no motion raises l1, to second order: the least curvature is {least:.3e}"),
        None => "no motion that keeps the loaded contacts has a curvature".into(),
    };
    say(Verdict::Proved, least, words)
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
