//! The columns of `limits.csv`: the one list that reading, writing, tables and documents go by.

use maille::record::LimitRow;

/// What a column's numbers are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Not a number.
    None,
    /// A plain number, or a count.
    One,
    /// Degrees.
    Degree,
    /// Seconds.
    Second,
    /// The unit of lengths in the design's file.
    Length,
    /// The reference radius R of the design's file.
    Radius,
}

impl Unit {
    /// Its name, where the design's file calls its unit of lengths `length`; none where there is nothing to measure.
    pub fn name(self, length: Option<&str>) -> Option<&str> {
        match self {
            Unit::None => None,
            Unit::One => Some("1"),
            Unit::Degree => Some("deg"),
            Unit::Second => Some("s"),
            Unit::Length => Some(length.unwrap_or("length")),
            Unit::Radius => Some("R"),
        }
    }
}

/// Type of a column, and where its value stands in a row; nothing where it was not earned.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// A name or a word.
    Text(fn(&LimitRow) -> Option<&str>),
    /// A finite number of 64 bits.
    Number(fn(&LimitRow) -> Option<f64>),
    /// A whole number, 0 or more.
    Count(fn(&LimitRow) -> Option<u64>),
    /// True or false.
    Flag(fn(&LimitRow) -> Option<bool>),
}

/// One value of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// Nothing.
    Empty,
    /// A name or a word.
    Text(&'a str),
    /// A number.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// True or false.
    Flag(bool),
}

impl Values {
    /// The type's name in documents.
    pub fn kind(self) -> &'static str {
        match self {
            Values::Text(_) => "text",
            Values::Number(_) => "number",
            Values::Count(_) => "count",
            Values::Flag(_) => "flag",
        }
    }

    /// The value of a row.
    pub fn of(self, row: &LimitRow) -> Cell<'_> {
        match self {
            Values::Text(of) => of(row).map_or(Cell::Empty, Cell::Text),
            Values::Number(of) => of(row).map_or(Cell::Empty, Cell::Number),
            Values::Count(of) => of(row).map_or(Cell::Empty, Cell::Count),
            Values::Flag(of) => of(row).map_or(Cell::Empty, Cell::Flag),
        }
    }
}

/// A column of `limits.csv`.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// What its numbers are measured in.
    pub unit: Unit,
    /// Version of the record's files that first had it.
    pub since: u32,
    /// What it says.
    pub meaning: &'static str,
    /// Its type and values.
    pub values: Values,
}

const fn column(name: &'static str, unit: Unit, values: Values, meaning: &'static str) -> Column {
    Column { name, unit, since: 1, meaning, values }
}

use Unit::{Degree, Length, None as Word, One, Radius, Second};
use Values::{Count, Flag, Number, Text};

/// Lengths of earlier tables: one that ends after so many columns is read too, the others being empty.
pub(super) const EARLIER_COLUMNS: [usize; 4] = [30, 36, 40, 42];

/// The columns, in order. A later version may add columns at the end; it renames and moves none.
#[rustfmt::skip] // a table
pub const LIMIT_COLUMNS: [Column; 44] = [
    column("design", Word, Text(|r| Some(&r.design)), "name of the design; text, also where it looks like a number"),
    column("minor_radius", Length, Number(|r| r.minor_radius), "common minor radius of the rings; empty where each ring gives its own"),
    column("direction_deg", Degree, Number(|r| Some(r.direction_deg)), "direction of the pull, counter-clockwise from x"),
    column("l2", One, Number(|r| Some(r.l2)), "stretch held across the pull, minus 1; 0 where lateral is free"),
    column("method", Word, Text(|r| Some(&r.method)), "exact or energy"),
    column("cell", Word, Text(|r| Some(&r.cell)), "the cell that was solved, such as 2x1 or 1,0;-1,2"),
    column("status", Word, Text(|r| Some(r.status.name())), "outcome of the search"),
    column("l1", One, Number(|r| r.l1), "the limit: largest (or smallest, see end) stretch along the pull, minus 1"),
    column("lambda1", One, Number(|r| r.lambda1), "larger eigenvalue of C = FᵀF at the limit, the square of stretch1"),
    column("lambda2", One, Number(|r| r.lambda2), "smaller eigenvalue of C = FᵀF at the limit, the square of stretch2"),
    column("stretch1", One, Number(|r| r.stretch1), "larger principal stretch at the limit, the square root of lambda1"),
    column("stretch2", One, Number(|r| r.stretch2), "smaller principal stretch at the limit, the square root of lambda2"),
    column("max_overlap", Length, Number(|r| r.max_overlap), "deepest overlap of two rings at the limit, 0 if none"),
    column("min_gap", Length, Number(|r| r.min_gap), "smallest gap of two rings at the limit, negative where they overlap"),
    column("iterations", One, Count(|r| Some(r.iterations)), "quadratic programs (exact) or Newton iterations (energy)"),
    column("runs", One, Count(|r| Some(r.runs)), "starts (exact) or minimisations (energy)"),
    column("wall_s", Second, Number(|r| Some(r.wall_s)), "wall time of the row"),
    column("bound_l1", One, Number(|r| r.bound_l1), "proven upper bound: no state has a larger l1"),
    column("bound_kind", Word, Text(|r| r.bound_kind.as_deref()), "where the bound comes from: chain or link"),
    column("bound_gap", One, Number(|r| r.bound_gap), "bound_l1 minus l1"),
    column("dual_residual", One, Number(|r| r.dual_residual), "largest component of the unbalanced force, for a unit pull"),
    column("complementarity", One, Number(|r| r.complementarity), "largest product of a contact force and its gap"),
    column("min_multiplier", One, Number(|r| r.min_multiplier), "smallest force of a loaded contact, for a unit pull"),
    column("min_curvature", One, Number(|r| r.min_curvature), "smallest curvature on the motions that keep the loaded contacts"),
    column("zero_modes", One, Count(|r| r.zero_modes), "number of motions without curvature, such as rings that rattle"),
    column("links_ok", Word, Flag(|r| r.links_ok), "whether the links are those of the start"),
    column("n_starts", One, Count(|r| r.n_starts), "number of starts that were solved"),
    column("n_distinct", One, Count(|r| r.n_distinct), "number of distinct certified limits that the starts found"),
    column("own_image_force", One, Number(|r| r.own_image_force), "largest force between an element and its own image, for a unit pull"),
    column("l1_uncertified", One, Number(|r| r.l1_uncertified), "best feasible l1 where the certificate is incomplete"),
    column("lateral", Word, Text(|r| r.lateral.as_deref()), "fixed if l2 is held, free if not"),
    column("shear", Word, Text(|r| r.shear.as_deref()), "fixed if the shear is held at 0, free if not"),
    column("l2_min", One, Number(|r| r.l2_min), "smallest l2 found at the limit; l2 where it is held"),
    column("l2_max", One, Number(|r| r.l2_max), "largest l2 found at the limit; l2 where it is held"),
    column("shear_min", One, Number(|r| r.shear_min), "smallest shear found at the limit; 0 where it is held"),
    column("shear_max", One, Number(|r| r.shear_max), "largest shear found at the limit; 0 where it is held"),
    column("a1_x", Radius, Number(|r| r.a1_x), "first lattice vector of the design's own cell at the limit"),
    column("a1_y", Radius, Number(|r| r.a1_y), "its y"),
    column("a2_x", Radius, Number(|r| r.a2_x), "second lattice vector of the design's own cell at the limit"),
    column("a2_y", Radius, Number(|r| r.a2_y), "its y"),
    column("end", Word, Text(|r| r.end.as_deref()), "largest, or least for a compression: which end of the range of l1 the limit is"),
    column("by_cell", Word, Text(|r| r.by_cell.as_deref()), "what each cell reached, with its starts and its distinct certified limits; for a compression, and where larger cells were tried"),
    column("image_of_deg", Degree, Number(|r| r.image_of_deg), "the solved direction of which this row is the image under a symmetry of the design; empty where the row itself was solved"),
    column("grows_with_cell", Word, Flag(|r| r.grows_with_cell), "whether the last cell that was tried still gave more; false where larger cells gave nothing more or the limit is proved; empty where no larger cell was tried"),
];
