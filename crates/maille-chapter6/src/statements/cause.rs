//! Causes of exceptions, from records.

use crate::map::{ENERGY_TIE, EXACT_TIE, Map};
use maille::record::LimitRow;

/// Why a case of these maps is an exception, as far as the records tell: the energy method stopped in a local minimum short of an
/// exact limit, or rings stack.
pub(crate) fn cause(of: &[&Map], maps: &[Map], l2: f64) -> String {
    if of.iter().any(|map| map.method != "exact") {
        let short = |map: &&Map| {
            let alike = |other: &&Map| {
                (&other.design, other.ratio, other.rearranged) == (&map.design, map.ratio, map.rearranged)
                    && other.method == "exact"
                    && !other.minima
            };
            let exact = maps.iter().find(alike);
            let of_row = |row: &LimitRow| Some((exact?.l1(row.direction_deg, l2)? - row.l1?, row.direction_deg));
            map.rows_at(l2).filter_map(of_row).collect::<Vec<_>>()
        };
        return match of.iter().flat_map(short).max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((short, degrees)) if short > ENERGY_TIE => format!(
                "The energy method stopped {short:.3} short of the exact limit at {degrees}°: a local minimum, of which the thesis's chapter 7 \
                 warns."
            ),
            Some(_) => format!("It lies within what the energy method leaves open, {ENERGY_TIE} in l₁."),
            None => "There is no exact limit in these directions to compare with.".into(),
        };
    }
    let of_2 = of.iter().any(|map| map.design == "2");
    let fallen = |map: &&Map| {
        let of_row = |row: &LimitRow| Some((map.l1(row.direction_deg, 0.0)? - row.l1?, row.direction_deg, row.l1?));
        map.rows_at(l2).filter(|_| l2 < 0.0).filter_map(of_row).collect::<Vec<_>>()
    };
    match of.iter().flat_map(fallen).max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((fall, degrees, l1)) if fall > EXACT_TIE => format!(
            "Rings stack under compression, as the thesis says {}: at {degrees}° the limit falls from {:.4} at l₂ = 0 to {l1:.4}.",
            if of_2 { "of design 2" } else { "of rare cases" },
            l1 + fall,
        ),
        _ if of_2 => "Rows of rings stack along 0°, too thick to pass: of design 2 the thesis names this.".into(),
        _ => "No limit falls under compression here: a cause that the records do not tell.".into(),
    }
}
