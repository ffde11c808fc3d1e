//! One row of `limits.csv`: what its columns hold, and how they are read and shown.

use serde::{Deserialize, Serialize};

/// Declares [`Status`]: each with its name in tables and JSON.
macro_rules! statuses {
    ($($(#[$note:meta])* $status:ident = $name:literal,)*) => {
        /// Outcome of the search for one limit.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Status {
            $($(#[$note])* #[serde(rename = $name)] $status,)*
        }

        impl Status {
            /// All of them, in the order of the documentation.
            pub const ALL: [Status; [$($name),*].len()] = [$(Status::$status),*];

            /// The name in tables.
            pub fn name(self) -> &'static str {
                match self {
                    $(Status::$status => $name,)*
                }
            }
        }
    };
}

statuses! {
    /// Exact, certified, and a proven bound is attained.
    Global = "global",
    /// Exact, certified, bound not attained.
    Local = "local",
    /// Energy method: the last state within the threshold.
    ThresholdReached = "threshold-reached",
    /// Exact: best feasible state, certificate incomplete.
    Uncertified = "uncertified",
    /// The bound proves that no state has this l2.
    L2Unreachable = "l2-unreachable",
    /// The search failed; nothing is proved.
    L2NotReached = "l2-not-reached",
    /// The sheet comes apart: a state was found from which l1 can grow for ever.
    Unbounded = "unbounded",
    /// The minimisation did not reach its tolerance.
    NotConverged = "not-converged",
    /// The starting state overlaps and could not be resolved.
    InfeasibleStart = "infeasible-start",
    /// Stopped by the user; also of a row that nothing is known of yet.
    #[default]
    Interrupted = "interrupted",
}

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A name or a word.
    Text,
    /// A finite number of 64 bits.
    Number,
    /// A whole number, 0 or more.
    Count,
    /// True or false.
    Flag,
}

impl Kind {
    /// The name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Text => "text",
            Kind::Number => "number",
            Kind::Count => "count",
            Kind::Flag => "flag",
        }
    }
}

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

/// One value of a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Entry<'a> {
    /// Nothing: it could not be computed.
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

impl<'a> Entry<'a> {
    /// Its text, if it is one.
    #[doc(hidden)]
    pub fn text(self) -> Option<&'a str> {
        if let Entry::Text(text) = self { Some(text) } else { None }
    }

    /// Its number, if it is one.
    #[doc(hidden)]
    pub fn number(self) -> Option<f64> {
        if let Entry::Number(x) = self { Some(x) } else { None }
    }

    /// Its whole number, if it is one.
    #[doc(hidden)]
    pub fn count(self) -> Option<u64> {
        if let Entry::Count(n) = self { Some(n) } else { None }
    }

    /// Its flag, if it is one.
    #[doc(hidden)]
    pub fn flag(self) -> Option<bool> {
        if let Entry::Flag(flag) = self { Some(flag) } else { None }
    }
}

/// A type of the fields of [`LimitRow`]: as a cell, and read from the text of one. The error completes `"…" is `.
trait Value: Sized {
    const KIND: Kind;
    fn cell(&self) -> Entry<'_>;
    fn read(text: &str) -> Result<Self, &'static str>;
}

impl Value for String {
    const KIND: Kind = Kind::Text;
    fn cell(&self) -> Entry<'_> {
        Entry::Text(self)
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        Ok(text.to_owned())
    }
}

impl Value for Status {
    const KIND: Kind = Kind::Text;
    fn cell(&self) -> Entry<'_> {
        Entry::Text(self.name())
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        Status::ALL.into_iter().find(|status| status.name() == text).ok_or("not a status")
    }
}

impl Value for f64 {
    const KIND: Kind = Kind::Number;
    fn cell(&self) -> Entry<'_> {
        Entry::Number(*self)
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        let x: f64 = text.parse().map_err(|_| "not a number")?;
        if x.is_finite() { Ok(x) } else { Err("not finite") }
    }
}

impl Value for u64 {
    const KIND: Kind = Kind::Count;
    fn cell(&self) -> Entry<'_> {
        Entry::Count(*self)
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        text.parse().map_err(|_| "not a whole number")
    }
}

impl Value for bool {
    const KIND: Kind = Kind::Flag;
    fn cell(&self) -> Entry<'_> {
        Entry::Flag(*self)
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        text.parse().map_err(|_| "not true or false")
    }
}

/// What may be empty.
impl<T: Value> Value for Option<T> {
    const KIND: Kind = T::KIND;
    fn cell(&self) -> Entry<'_> {
        self.as_ref().map_or(Entry::Empty, T::cell)
    }
    fn read(text: &str) -> Result<Self, &'static str> {
        if text.is_empty() { Ok(None) } else { T::read(text).map(Some) }
    }
}

/// A column of `limits.csv`.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name: that of the field.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// What its numbers are measured in.
    pub unit: Unit,
    /// Version of the record's files that first had it.
    pub since: u32,
    /// What it says.
    pub meaning: &'static str,
    /// The value of a row.
    pub get: fn(&LimitRow) -> Entry<'_>,
    /// Reads the value from the text of a cell. The error says what the text is, as `not a number`.
    pub set: fn(&mut LimitRow, &str) -> Result<(), &'static str>,
}

/// Declares [`LimitRow`] and its columns: name, type, unit and meaning of each.
macro_rules! columns {
    ($($name:ident: $type:ty, $unit:ident, $meaning:literal;)*) => {
        /// One row of `limits.csv`: the field order is the column order. A number that could not be computed is `None` and stays
        /// empty.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct LimitRow {
            $(#[doc = $meaning] pub $name: $type,)*
        }

        /// The columns of `limits.csv`, in order. A later version may add columns at the end; it renames and moves none.
        pub const LIMIT_COLUMNS: [Column; [$($meaning),*].len()] = [$(
            Column {
                name: stringify!($name),
                kind: <$type as Value>::KIND,
                unit: Unit::$unit,
                since: 1,
                meaning: $meaning,
                get: |row| row.$name.cell(),
                set: |row, text| Value::read(text).map(|value| row.$name = value),
            },
        )*];
    };
}

columns! {
    design: String, None, "name of the design; text, also where it looks like a number";
    minor_radius: Option<f64>, Length, "common minor radius of the rings; empty where each ring gives its own";
    direction_deg: f64, Degree, "direction of the pull, counter-clockwise from x";
    l2: f64, One, "stretch held across the pull, minus 1; 0 where lateral is free";
    method: String, None, "exact or energy";
    cell: String, None, "the cell that was solved, such as 2x1 or 1,0;-1,2";
    status: Status, None, "outcome of the search";
    l1: Option<f64>, One, "the limit: largest (or smallest, see end) stretch along the pull, minus 1";
    lambda1: Option<f64>, One, "larger eigenvalue of C = FᵀF at the limit, the square of stretch1";
    lambda2: Option<f64>, One, "smaller eigenvalue of C = FᵀF at the limit, the square of stretch2";
    stretch1: Option<f64>, One, "larger principal stretch at the limit, the square root of lambda1";
    stretch2: Option<f64>, One, "smaller principal stretch at the limit, the square root of lambda2";
    max_overlap: Option<f64>, Length, "deepest overlap of two rings at the limit, 0 if none";
    min_gap: Option<f64>, Length, "smallest gap of two rings at the limit, negative where they overlap";
    iterations: u64, One, "quadratic programs (exact) or Newton iterations (energy)";
    runs: u64, One, "local maximisations (exact) or minimisations (energy)";
    wall_s: f64, Second, "wall time of the row";
    bound_l1: Option<f64>, One, "proven upper bound: no state has a larger l1";
    bound_kind: Option<String>, None, "where the bound comes from: chain or link";
    bound_gap: Option<f64>, One, "bound_l1 minus l1";
    dual_residual: Option<f64>, One, "largest component of the unbalanced force, for a unit pull";
    complementarity: Option<f64>, One, "largest product of a contact force and its gap";
    min_multiplier: Option<f64>, One, "smallest force of a loaded contact, for a unit pull";
    min_curvature: Option<f64>, One, "smallest curvature on the motions that keep the loaded contacts";
    zero_modes: Option<u64>, One, "number of motions without curvature, such as rings that rattle";
    links_ok: Option<bool>, None, "whether the links are those of the start";
    n_starts: Option<u64>, One, "number of local maximisations, repeated ones included";
    n_distinct: Option<u64>, One, "number of distinct certified limits that the starts found";
    own_image_force: Option<f64>, One, "largest force between an element and its own image, for a unit pull";
    l1_uncertified: Option<f64>, One, "best feasible l1 where the certificate is incomplete";
    lateral: Option<String>, None, "fixed if l2 is held, free if not";
    shear: Option<String>, None, "fixed if the shear is held at 0, free if not";
    l2_min: Option<f64>, One, "smallest l2 found at the limit; l2 where it is held";
    l2_max: Option<f64>, One, "largest l2 found at the limit; l2 where it is held";
    shear_min: Option<f64>, One, "smallest shear found at the limit; 0 where it is held";
    shear_max: Option<f64>, One, "largest shear found at the limit; 0 where it is held";
    a1_x: Option<f64>, Radius, "first lattice vector of the design's own cell at the limit";
    a1_y: Option<f64>, Radius, "its y";
    a2_x: Option<f64>, Radius, "second lattice vector of the design's own cell at the limit";
    a2_y: Option<f64>, Radius, "its y";
    end: Option<String>, None, "largest, or least for a compression: which end of the range of l1 the limit is";
    by_cell: Option<String>, None, "what each cell reached, with its starts and its distinct certified limits; for a compression, and where larger cells were tried";
    image_of_deg: Option<f64>, Degree, "the solved direction of which this row is the image under a symmetry of the design; empty where the row itself was solved";
    grows_with_cell: Option<bool>, None, "whether the last cell that was tried still gave more; false where larger cells gave nothing more or the limit is proved; empty where no larger cell was tried";
    better_chance: Option<f64>, One, "estimated chance that another start of the same kinds finds a larger limit in this cell; empty where the bound is attained";
    wave_curvature: Option<f64>, One, "least curvature found on waves through the sheet that keep the loaded contacts; negative where a larger cell may go further; empty where it was not sought or the limit is proved";
    wave_q1: Option<f64>, One, "its wave vector: phase from one solved cell to the next along the first lattice vector, in units of 2π";
    wave_q2: Option<f64>, One, "the same along the second";
    extreme: Option<String>, None, "largest or smallest: the l1 of this row is the largest, or smallest, of its l2 over all directions, found between those that were asked for; empty for these";
}
