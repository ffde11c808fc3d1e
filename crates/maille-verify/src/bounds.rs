//! Whether a row's bound follows from what its state names, and whether no state has its l2.

use crate::{
    chain::{self, ChainBound},
    dual::{self, Held, Proven, Starts},
    gaps::gaps_and_links,
    image::too_near,
    record::{Row, State},
    report::{Check, Finding, Verdict},
    sheet::{self, Sheet},
    start::{Start, linked, names},
    strain,
    tie::Place,
    verifier::Verifier,
};

/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// Means of a bound.
const A_CHAIN: &str = "a chain of links";
const CHAINS: &str = "a chain of links with others";
const LINKS: &str = "a balance of forces in the links";

impl Verifier {
    /// The bound of a row that has one; of a row without a limit the proof that there is none.
    pub(crate) fn bound(&self, row: &Row, state: &State) -> Option<Finding> {
        let say = |verdict, figure, words: String| Some(Finding::new(Check::Bound, verdict, figure, words));
        if row.status == "l2-unreachable" {
            return Some(self.unreachable(row, state));
        }
        let (true, Some(l1), Some(bound)) = (row.certified(), row.l1, row.bound_l1) else { return None };
        let gap = bound - l1;
        if let Some(written) = row.bound_gap.filter(|written| (written - gap).abs() > strain::SAME) {
            return say(Verdict::False, Some(gap), format!("bound_gap is {written:?}, bound_l1 − l1 is {gap:?}"));
        }
        if gap < -ATTAINED || (row.status == "global" && gap > ATTAINED * (1.0 + 1e-6)) {
            return say(Verdict::False, Some(gap), format!("l1 is {l1:?}, its bound {bound:?}, status {}", row.status));
        }
        // A chain in the state is that of the chain bound, also where the link bound is lower.
        let without_forces = row.bound_kind.as_deref() == Some("link") && state.dual.is_empty();
        let (means, proven) = match self.derived(row, state) {
            Ok(Some(derived)) if !without_forces => derived,
            Ok(_) => {
                let words = "nothing in the state proves the bound: older versions wrote no forces of link bounds";
                return say(Verdict::Open, Some(gap), words.into());
            }
            Err((_, words)) if !self.run.design.is_round() => return say(Verdict::Open, None, words),
            Err((verdict, words)) => return say(verdict, None, words),
        };
        let named = if means == LINKS { "link" } else { "chain" };
        if row.bound_kind.as_deref() != Some(named) {
            let kind = row.bound_kind.as_deref().unwrap_or("none");
            return say(Verdict::False, None, format!("bound_kind is {kind}; the state has {means}"));
        }
        let tolerance = if means == A_CHAIN { strain::SAME * (2.0 + bound) } else { ATTAINED };
        // What lies between the two is proved; the maximum over normals is found to other digits each time.
        // Older versions had larger balls around curves: from these follows less, which holds, too.
        let curved = !self.run.design.is_round();
        let largest = if curved { f64::INFINITY } else { proven.by_lengths + tolerance };
        let proved = proven.least() - tolerance..=largest;
        let most = proven.least();
        if curved && bound < *proved.start() {
            say(Verdict::Open, Some(most), format!("{means} proves l1 ≤ {most:?}; bound_l1 is lower, {bound:?}"))
        } else if most < -1.0 {
            say(Verdict::False, Some(most), format!("{means} forbids this l2"))
        } else if !proved.contains(&bound) {
            say(Verdict::False, Some(most), format!("{means} proves l1 ≤ {most:?}, bound_l1 is {bound:?}"))
        } else if l1 > most + ATTAINED {
            say(Verdict::False, Some(most), format!("{means} proves l1 ≤ {most:?}, l1 is {l1:?}"))
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
            Ok(Some((means, proven))) if proven.least() < -1.0 => {
                return say(Verdict::Proved, format!("{means} forbids this l2"));
            }
            Ok(Some((means, proven))) => (means, proven.least()),
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
        let found = gaps_and_links(&limit, &here, start, 0.0, unit);
        strain::deformation(&limit, state, here.lattice, start.sheet.lattice, &cell, false).is_ok()
            && found.iter().all(|finding| finding.verdict == Verdict::Proved)
    }

    /// An element of the row's cell whose image would be too near at every l1 up to `most`.
    fn images(&self, row: &Row, most: f64) -> Result<Option<Place>, (Verdict, String)> {
        if [&row.lateral, &row.shear].iter().any(|word| word.as_deref() == Some("free")) {
            return Ok(None);
        }
        Ok(too_near(linked(&self.starts[&row.cell])?, most, row.l2, strain::axes(row.direction_deg)))
    }

    /// By what means the state bounds l1, and the bounds; below −1 where no state has this l2. `None` if it names nothing.
    fn derived(&self, row: &Row, state: &State) -> Result<Option<(&'static str, Proven)>, (Verdict, String)> {
        let free = |word: &Option<String>| word.as_deref() == Some("free");
        let [lateral, shear] = [free(&row.lateral), free(&row.shear)];
        let wrong = |words: String| (Verdict::False, words);
        if let Some(first) = state.dual.first() {
            let means = if first.tie == "chain" { CHAINS } else { LINKS };
            let starts = Starts { own: linked(&self.own)?, first: linked(self.first()?).ok() };
            let held = Held { l2: (!lateral).then_some(row.l2), shear_free: shear };
            let Proven { by_lengths, by_normals } =
                dual::bound(starts, &state.dual, row.direction_deg, held).map_err(wrong)?;
            return Ok(Some((means, Proven { by_lengths: by_lengths - 1.0, by_normals: by_normals - 1.0 })));
        }
        let Some(chain) = state.chain.as_ref().filter(|_| !lateral && !shear) else { return Ok(None) };
        let unit = self.run.design.reference_radius;
        let of_chain = linked(self.first()?)?;
        let most = match chain::bound(of_chain, chain, unit, row.direction_deg, row.l2).map_err(wrong)? {
            ChainBound::Impossible => f64::NEG_INFINITY,
            ChainBound::AtMost(most) => most,
        };
        Ok(Some((A_CHAIN, Proven { by_lengths: most, by_normals: most })))
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
