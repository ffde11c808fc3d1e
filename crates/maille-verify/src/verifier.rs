//! A record, row by row.

use crate::{
    claims,
    endless::could_meet,
    files,
    forces::forces,
    gaps::gaps_and_links,
    record::{Row, Run, State, Texts, Unreadable, read_rows, read_run, read_states},
    report::{Check, Finding, RowReport, Verdict},
    sensitivities,
    sheet::{self, Sheet},
    start::{Start, names, same_rings, start},
    strain,
};
use std::collections::{BTreeMap, BTreeSet};

/// A record that was read, with what all its rows need.
pub struct Verifier {
    pub(crate) run: Run,
    pub(crate) rows: Vec<Row>,
    pub(crate) columns: BTreeSet<String>,
    pub(crate) states: BTreeMap<(u64, u64), State>,
    pub(crate) files: Vec<Finding>,
    /// By cell, with the elements in the order of the first state that has this cell.
    pub(crate) starts: BTreeMap<String, Result<Start, String>>,
    /// Name of a cell that is one copy of the design: the first of the run if it is, else 1x1. Ties are counted in it.
    pub(crate) own_cell: String,
    pub(crate) own: Result<Start, String>,
}

impl Verifier {
    /// Reads the files and checks that they fit together.
    pub fn new(texts: &Texts<'_>) -> Result<Verifier, Unreadable> {
        let run = read_run(texts.run)?;
        let (rows, columns) = texts.limits.map(read_rows).transpose()?.unwrap_or_default();
        let states = texts.states.map(read_states).transpose()?.unwrap_or_default();
        let mut files = files::check(texts, &run, &rows, &states);
        files.extend(
            texts.sensitivities.into_iter().flat_map(|text| sensitivities::check(text, &run.design, &rows, &states)),
        );
        let key = |state: &State| files::key(state.direction_deg, state.l2);
        let states: BTreeMap<_, _> = states.into_iter().map(|state| (key(&state), state)).collect();
        let mut starts = BTreeMap::new();
        for row in &rows {
            let Some(state) = states.get(&files::key(row.direction_deg, row.l2)) else { continue };
            starts.entry(row.cell.clone()).or_insert_with(|| match sheet::cell(&row.cell) {
                Some(cell) => start(&run.design, &cell, &names(state)),
                None => Err(format!("\"{}\" is not a cell", row.cell)),
            });
        }
        let first = run.parameters["cells"][0].as_str().unwrap_or_default();
        let (own_cell, cell) = match sheet::cell(first).filter(|cell| sheet::copies(cell) == 1) {
            Some(cell) => (first.to_owned(), cell),
            None => ("1x1".to_owned(), [[1, 0], [0, 1]]),
        };
        let elements: Vec<&str> = run.design.elements.iter().map(|element| element.name.as_str()).collect();
        let own = start(&run.design, &cell, &elements);
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
        let Some(cell) = sheet::cell(&row.cell) else { return refused(format!("\"{}\" is not a cell", row.cell)) };
        // The same elements in the same order as in the state that the start was made for.
        let here = match Sheet::start(&self.run.design, &cell, &names(state)).and_then(|own| own.at(state, unit)) {
            Ok(here) if same_rings(&here, &start.sheet) => here,
            Ok(_) => return refused("the poses are not in the order of the other rows".into()),
            Err(words) => return refused(words),
        };
        let mut out = Vec::new();
        let corners = row.method == "energy" && self.run.parameters["options"]["protocol"] == "corners";
        out.push(match strain::deformation(row, state, here.lattice, start.sheet.lattice, &cell, corners) {
            Ok(largest) if corners => Finding::new(
                Check::Deformation,
                Verdict::Open,
                Some(largest),
                "the row's strains are those of deformation_gradient, and that is of the lattice along one diagonal; along the other \
                 it is of the fourth corner, which no record has",
            ),
            Ok(largest) => Finding::new(
                Check::Deformation,
                Verdict::Proved,
                Some(largest),
                format!("the row's strains are those of the lattice, to {largest:.1e}"),
            ),
            Err(words) => Finding::new(Check::Deformation, Verdict::False, None, words),
        });
        out.extend(gaps_and_links(row, &here, start, 0.0, unit));
        if row.certified() {
            out.extend(forces(row, state, &here, start, unit, &self.columns));
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
}
