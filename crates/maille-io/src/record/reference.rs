//! The reference cell of a record: the state of the lattice that stretches are measured from.
//!
//! The record gives lattices A = (a1 a2), columns in units of R, one a limit, and the design file the start A₀. The largest
//! cell is the one of greatest |det A| among them, the smallest that of least. A line of rings that lies along the unit
//! vector D at a limit lay along A_ref A⁻¹ D in the reference cell, so it is stretched by
//!
//! λ(D) = 1 / |A_ref A⁻¹ D|.
//!
//! A pull along D keeps D: A A₀⁻¹ D = (1 + l1) D. So from the start λ = 1 + l1, and otherwise (1 + l1) / |F_ref D| with
//! F_ref = A_ref A₀⁻¹: l1 and its bound change by one factor. The spacing of the file does not enter λ, D being the
//! direction at the limit. `docs/theory/reference.md` has the same with its consequences.

use super::folder::Record;
use maille::lattice::Direction;
use maille::record::LimitRow;
use nalgebra::{Matrix2, Vector2};

/// Which cell stretches are measured from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// That of the design file.
    #[default]
    Start,
    /// That of greatest area.
    LargestCell,
    /// That of least area.
    SmallestCell,
}

/// Areas that differ by less than this share are one area: the first in order of direction and l2 is taken.
const SAME_AREA: f64 = 1e-9;

/// A cell of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceCell {
    /// Its lattice vectors, as columns, in units of R.
    pub lattice: Matrix2<f64>,
    /// Direction and l2 of the limit that has it; the start has none.
    pub limit: Option<(f64, f64)>,
    /// Area for each element, in R².
    pub area: f64,
    /// Further limits of the same area, whose cells may have another shape.
    pub ties: usize,
    /// From the start's plane to this cell's.
    gradient: Matrix2<f64>,
}

/// The lattice at a limit, columns in units of R.
fn lattice(row: &LimitRow) -> Option<Matrix2<f64>> {
    Some(Matrix2::new(row.a1_x?, row.a2_x?, row.a1_y?, row.a2_y?))
}

impl Record {
    /// The reference cell among the start and all limits of the record. Nothing where a limit has no lattice, as in
    /// records older than its columns, or where the design's lattice has no area.
    pub fn reference(&self, reference: Reference) -> Option<ReferenceCell> {
        let design = &self.run.design;
        let [a1, a2] = [design.lattice.a1, design.lattice.a2].map(|a| Vector2::new(a[0], a[1]));
        let start = Matrix2::from_columns(&[a1, a2]) / design.reference_radius;
        let inverse = start.try_inverse()?;
        let mut cells = vec![(None, start)];
        if reference != Reference::Start {
            let mut limits: Vec<&LimitRow> = self.rows.iter().filter(|row| row.l1.is_some()).collect();
            limits.sort_by(|a, b| a.direction_deg.total_cmp(&b.direction_deg).then(a.l2.total_cmp(&b.l2)));
            for row in limits {
                cells.push((Some((row.direction_deg, row.l2)), lattice(row)?));
            }
        }
        let area = |cell: &Matrix2<f64>| cell.determinant().abs();
        let sign = if reference == Reference::SmallestCell { -1.0 } else { 1.0 };
        let best = cells.iter().map(|(_, cell)| sign * area(cell)).fold(f64::NEG_INFINITY, f64::max);
        let mut same = cells.into_iter().filter(|(_, cell)| sign * area(cell) >= best - SAME_AREA * best.abs());
        let (limit, lattice) = same.next()?;
        Some(ReferenceCell {
            lattice,
            limit,
            area: area(&lattice) / design.elements.len() as f64,
            ties: same.count(),
            gradient: lattice * inverse,
        })
    }
}

impl ReferenceCell {
    /// λ / (1 + l1) of a pull along this direction.
    fn factor(&self, direction_deg: f64) -> f64 {
        1.0 / (self.gradient * Direction::of_degrees(direction_deg).along()).norm()
    }

    /// A row with l1 and its bound measured from this cell. Its other strains, l2 among them, stay as they are.
    pub fn measured(&self, row: &LimitRow) -> LimitRow {
        let factor = self.factor(row.direction_deg);
        let from_here = |l1: Option<f64>| l1.map(|l1| factor * (1.0 + l1) - 1.0);
        LimitRow {
            l1: from_here(row.l1),
            bound_l1: from_here(row.bound_l1),
            bound_gap: row.bound_gap.map(|gap| factor * gap),
            ..row.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Counters, RunRecord};
    use maille::record::RECORD_SCHEMA;
    use serde_json::Value;

    /// A limit of 1.1, whose square has the side 2.5 R, with this gradient.
    fn limit(direction_deg: f64, l2: f64, f: [[f64; 2]; 2]) -> LimitRow {
        let d = Direction::of_degrees(direction_deg).along();
        let f = Matrix2::new(f[0][0], f[0][1], f[1][0], f[1][1]);
        let a = 2.5 * f;
        LimitRow {
            direction_deg,
            l2,
            l1: Some(d.dot(&(f * d)) - 1.0),
            bound_l1: Some(d.dot(&(f * d)) - 0.5),
            bound_gap: Some(0.5),
            a1_x: Some(a.m11),
            a1_y: Some(a.m21),
            a2_x: Some(a.m12),
            a2_y: Some(a.m22),
            ..LimitRow::default()
        }
    }

    fn record(rows: Vec<LimitRow>, spacing: f64) -> Record {
        let design = crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap().spaced(spacing);
        let run = RunRecord {
            schema: RECORD_SCHEMA,
            program_version: "0.1.0".into(),
            input_hash: "0".into(),
            design,
            curve_deviation: None,
            parameters: Value::Null,
            counters: Counters::of(&rows),
            files: Default::default(),
        };
        Record { run, rows, states: Vec::new() }
    }

    /// The straight chains of 1.1 bind at 1.44 along both axes, and its trellis at 1.774 along 45°, the width held.
    fn limits() -> Vec<LimitRow> {
        let half = |l1: f64, l2: f64| [[(l1 + l2) / 2.0, (l1 - l2) / 2.0], [(l1 - l2) / 2.0, (l1 + l2) / 2.0]];
        vec![
            limit(90.0, 0.0, [[1.0, 0.0], [0.0, 1.44]]),
            limit(0.0, 0.0, [[1.44, 0.0], [0.0, 1.0]]),
            limit(0.0, -0.5, [[1.44, 0.0], [0.0, 0.5]]),
            limit(45.0, 0.0, half(1.774, 1.0)),
        ]
    }

    #[test]
    fn cells_are_those_of_greatest_and_least_area() {
        let all = record(limits(), 1.0);
        let largest = all.reference(Reference::LargestCell).unwrap();
        assert_eq!((largest.limit, largest.ties), (Some((45.0, 0.0)), 0));
        // Of three elements.
        assert!((largest.area - 1.774 * 6.25 / 3.0).abs() < 1e-12);
        let smallest = all.reference(Reference::SmallestCell).unwrap();
        assert_eq!((smallest.limit, smallest.ties), (Some((0.0, -0.5)), 0));
        let start = all.reference(Reference::Start).unwrap();
        assert_eq!((start.limit, start.lattice), (None, Matrix2::new(2.5, 0.0, 0.0, 2.5)));
        // Without the trellis two limits are as wide; the first direction is taken, and nothing is tighter than the start.
        let held = record(limits()[..2].to_vec(), 1.0);
        let largest = held.reference(Reference::LargestCell).unwrap();
        assert_eq!((largest.limit, largest.ties), (Some((0.0, 0.0)), 1));
        assert_eq!(held.reference(Reference::SmallestCell).unwrap().limit, None);
    }

    /// 1 / |A_ref A⁻¹ D|, from the recorded lattices alone.
    fn definition(cell: &ReferenceCell, row: &LimitRow) -> f64 {
        let back = cell.lattice * lattice(row).unwrap().try_inverse().unwrap();
        1.0 / (back * Direction::of_degrees(row.direction_deg).along()).norm()
    }

    #[test]
    fn stretches_are_measured_from_the_cell() {
        let all = record(limits(), 1.0);
        for reference in [Reference::Start, Reference::LargestCell, Reference::SmallestCell] {
            let cell = all.reference(reference).unwrap();
            for row in &all.rows {
                let measured = cell.measured(row);
                let lambda = 1.0 + measured.l1.unwrap();
                assert!((lambda - definition(&cell, row)).abs() < 1e-12, "{reference:?}, {}", row.direction_deg);
                let (bound, gap) = (measured.bound_l1.unwrap(), measured.bound_gap.unwrap());
                assert!((bound - (lambda - 1.0) - gap).abs() < 1e-12);
            }
        }
        // Closed forms: the largest cell without the trellis is diag(1.44, 1).
        let cell = record(limits()[..2].to_vec(), 1.0).reference(Reference::LargestCell).unwrap();
        let lambda = |row: &LimitRow| 1.0 + cell.measured(row).l1.unwrap();
        assert!((lambda(&all.rows[1]) - 1.0).abs() < 1e-12);
        assert!((lambda(&all.rows[0]) - 1.44).abs() < 1e-12);
        assert!((lambda(&all.rows[3]) - 1.774 / (1.44_f64.powi(2) / 2.0 + 0.5).sqrt()).abs() < 1e-12);
    }

    /// A file that starts from another spacing has other l1 of the same limits, and the same stretch from the largest cell.
    #[test]
    fn the_spacing_of_the_file_does_not_enter() {
        let spacing = 1.2;
        let respaced = |row: &LimitRow| LimitRow { l1: row.l1.map(|l1| (1.0 + l1) / spacing - 1.0), ..row.clone() };
        let (one, other) = (record(limits(), 1.0), record(limits().iter().map(respaced).collect(), spacing));
        for reference in [Reference::LargestCell, Reference::SmallestCell] {
            let cells = [&one, &other].map(|record| record.reference(reference).unwrap());
            for (a, b) in one.rows.iter().zip(&other.rows) {
                let [a, b] = [(a, &cells[0]), (b, &cells[1])].map(|(row, cell)| cell.measured(row).l1.unwrap());
                assert!((a - b).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_limit_without_a_lattice_gives_no_reference() {
        let mut rows = limits();
        rows[1].a1_x = None;
        let old = record(rows.clone(), 1.0);
        assert_eq!(old.reference(Reference::LargestCell), None);
        assert!(old.reference(Reference::Start).is_some());
        // A search without a limit has none, and needs none.
        rows[1].l1 = None;
        assert!(record(rows, 1.0).reference(Reference::LargestCell).is_some());
    }
}
