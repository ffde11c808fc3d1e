//! The design's start in a cell, with its links.

use crate::{
    apart::some_distance,
    curve_pair,
    linking::linking_number,
    record::{Design, State},
    report::Verdict,
    sheet::{Cell, Pair, Ring, Sheet},
    tie::Linked,
};

/// A start with its links.
pub(crate) struct Start {
    pub sheet: Sheet,
    pub links: Result<Links, String>,
}

/// The linked pairs with their linking numbers, in order.
pub(crate) type Links = Vec<(Pair, i32)>;

/// The start in `cell`, with the elements in the order of `poses`.
pub(crate) fn start(design: &Design, cell: &Cell, names: &[&str]) -> Result<Start, String> {
    let sheet = Sheet::start(design, cell, names)?;
    let mut links = Ok(Vec::new());
    match sheet.pairs(|_, _| 0.0) {
        Ok(pairs) => {
            for pair in pairs {
                add_link(&mut links, pair, &sheet, None);
            }
        }
        Err(words) => links = Err(words),
    }
    Ok(Start { sheet, links })
}

/// Names of the elements in a state.
pub(crate) fn names(state: &State) -> Vec<&str> {
    state.poses.iter().map(|pose| pose.element.as_str()).collect()
}

/// Adds the pair if it is linked. `proved` is a distance that the circles are known to keep.
pub(crate) fn add_link(links: &mut Result<Links, String>, pair: Pair, sheet: &Sheet, proved: Option<f64>) {
    let Ok(known) = links else { return };
    let slack = sheet.slack(pair);
    let number = if sheet.is_round(pair) {
        let (one, other) = (sheet.circle(pair.0, [0, 0]), sheet.circle(pair.1, pair.2));
        let apart = proved.or_else(|| some_distance(&one, &other, slack)).ok_or("core circles meet".to_owned());
        apart.and_then(|apart| linking_number(&one, &other, apart))
    } else {
        let (one, other) = (sheet.curve(pair.0, [0, 0]), sheet.curve(pair.1, pair.2));
        let apart = proved.or_else(|| curve_pair::some_distance(&one, &other, slack)).ok_or("cores meet".to_owned());
        apart.and_then(|apart| curve_pair::linking_number(&one, &other, apart))
    };
    match number {
        Ok(0) => {}
        Ok(number) => known.push((pair, number)),
        Err(words) => *links = Err(format!("rings {} and {} at {:?}: {words}", pair.0, pair.1, pair.2)),
    }
}

/// The start with its links, or why they are not known.
pub(crate) fn linked(start: &Result<Start, String>) -> Result<Linked<'_>, (Verdict, String)> {
    let start = start.as_ref().map_err(|words| (Verdict::False, words.clone()))?;
    let links = start.links.as_ref().map_err(|words| (Verdict::Open, words.clone()))?;
    Ok(Linked { sheet: &start.sheet, links })
}

/// Whether two sheets have the same elements in the same order.
pub(crate) fn same_rings(a: &Sheet, b: &Sheet) -> bool {
    let same = |(x, y): (&Ring, &Ring)| x.element == y.element && x.arm == y.arm && x.normal == y.normal;
    a.rings.len() == b.rings.len() && a.rings.iter().zip(&b.rings).all(same)
}
