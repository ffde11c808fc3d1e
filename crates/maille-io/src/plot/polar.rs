//! Polar plots of limits against the direction of the pull: 0° right, counter-clockwise.

mod figure;
mod roll;

pub use figure::polar_svg;
pub use roll::roll_svg;

use super::compare::{
    captions, differences, directions, growing, heading, inputs, l2_label, l2_values, missing, title,
};
use super::curve::{Curve, CurveKind};
use super::look::{self, Look};
use super::records::Looks;
use super::tolerance::{Band, Tolerance};
use crate::{
    quantity::Quantity,
    record::{NamedRecord, Reference, ReferenceCell, SensitivityRow},
};
use maille::design::Design;
use maille::record::{LimitRow, Status};

impl Quantity {
    pub(super) fn of(self, row: &LimitRow) -> Option<f64> {
        match self {
            Quantity::Stretch => row.l1.map(|l1| 1.0 + l1),
            Quantity::L1 => row.l1,
            Quantity::Lambda1 => row.lambda1.map(|lambda1| lambda1 - 1.0),
        }
    }

    /// The same of the proven bound: of λ1, the larger eigenvalue that F = diag(1 + bound, 1 + l2) has.
    pub(super) fn of_bound(self, row: &LimitRow) -> Option<f64> {
        let bound = row.bound_l1?;
        Some(match self {
            Quantity::Stretch => 1.0 + bound,
            Quantity::L1 => bound,
            Quantity::Lambda1 => (1.0 + bound).max(1.0 + row.l2).powi(2) - 1.0,
        })
    }

    /// The value of the sheet as it lies, in the centre of the plot.
    pub(super) fn base(self) -> f64 {
        match self {
            Quantity::Stretch => 1.0,
            Quantity::L1 | Quantity::Lambda1 => 0.0,
        }
    }

    pub(super) fn symbol(self) -> &'static str {
        match self {
            Quantity::Stretch => "1 + l₁",
            Quantity::L1 => "l₁",
            Quantity::Lambda1 => "λ₁ − 1",
        }
    }

    fn subtitle(self) -> &'static str {
        match self {
            Quantity::Stretch => "stretch 1 + l₁ along each direction of pull",
            Quantity::L1 => "elongation l₁ along each direction of pull",
            Quantity::Lambda1 => "Larger eigenvalue λ₁ of C = FᵀF, less 1, at the limit of each direction of pull",
        }
    }
}

/// A polar plot, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarPlot {
    /// Heading.
    pub title: String,
    /// What the radius shows.
    pub quantity: Quantity,
    /// Which ends of l1, as `Largest`.
    pub ends: &'static str,
    /// Of several records: what tells them apart, and the label of each; otherwise empty.
    pub records: (String, Vec<String>),
    /// Curves, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Directions that are marked.
    pub rays: Vec<Ray>,
    /// Of the curves of kind [`CurveKind::Check`]: what they are; otherwise empty.
    pub check: String,
    /// Paragraphs below the plot.
    pub caption: Vec<String>,
    /// Whether the width was left to the sheet in all limits.
    pub lateral_free: bool,
    /// Which cell the radius is measured from.
    pub reference: Reference,
    /// What tolerances do to the curves.
    pub bands: Vec<Band>,
    /// Values that the scale has room for, too: those of a plot that is compared with this one.
    pub room_for: Vec<f64>,
}

/// A direction that a plot marks, with its opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Degrees counter-clockwise from x.
    pub degrees: f64,
    /// What it is.
    pub kind: RayKind,
}

/// What a marked direction is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// Neighbours interlock along it.
    Interlocking,
    /// The limit is largest.
    Largest,
    /// The limit is least.
    Least,
}

impl RayKind {
    const ALL: [RayKind; 3] = [RayKind::Interlocking, RayKind::Largest, RayKind::Least];

    fn look(self) -> Look {
        let (color, width, dash) = match self {
            RayKind::Interlocking => ("#c1121f", 1.6, ""),
            RayKind::Largest => ("#111111", 1.3, "6 4"),
            RayKind::Least => ("#111111", 4.0, ""),
        };
        Look { color: color.into(), width, dash, ..look::hollow() }
    }

    fn label(self) -> &'static str {
        match self {
            RayKind::Interlocking => "interlocking direction",
            RayKind::Largest => "largest limit",
            RayKind::Least => "least limit (at the rim)",
        }
    }
}

impl PolarPlot {
    /// The plot of a record's rows: one curve for each l2, ordered by value.
    ///
    /// `parameters` are further words for the caption, as `τ = 0.01`.
    pub fn from_rows(design: &Design, rows: &[LimitRow], quantity: Quantity, parameters: &[String]) -> Self {
        let l2 = l2_values(rows.iter());
        // Where every limit attains its bound the two curves are one.
        let open = |l2: &&f64| rows.iter().any(|row| row.l2 == **l2 && row.bound_gap.is_some_and(|gap| gap > 1e-6));
        let bound = |&l2: &f64| {
            let of_l2 = rows.iter().filter(|row| row.l2 == l2);
            // A bound without its limit is a line to nowhere.
            let of_limit = |row: &LimitRow| quantity.of(row).and(quantity.of_bound(row));
            let points: Vec<_> = of_l2.map(|row| (row.direction_deg, of_limit(row), row.status)).collect();
            Curve::new(0, l2, CurveKind::Bound, &points)
        };
        let mut caption = vec![inputs(design, rows, parameters)];
        caption.extend(directions(rows).map(|directions| format!("{directions}. {}", symmetry(quantity))));
        caption.extend(proven(rows));
        caption.extend(missing(rows, |row| quantity.of(row)));
        caption.extend(growing(rows));
        let curves = l2.iter().map(|&l2| limits(0, rows, l2, quantity));
        let curves = curves.chain(l2.iter().filter(open).map(bound)).collect();
        Self { title: heading(design), curves, caption, ..Self::of(quantity, rows.iter()) }
    }

    /// An empty plot of limits.
    fn of<'a>(quantity: Quantity, rows: impl Iterator<Item = &'a LimitRow> + Clone) -> Self {
        Self {
            title: String::new(),
            quantity,
            ends: ends(rows.clone()),
            records: Default::default(),
            curves: Vec::new(),
            rays: Vec::new(),
            check: String::new(),
            caption: Vec::new(),
            lateral_free: lateral_free(rows),
            reference: Reference::Start,
            bands: Vec::new(),
            room_for: Vec::new(),
        }
    }

    /// The plot of several records: one curve for each record and l2, without bounds.
    pub fn from_records(records: &[NamedRecord], quantity: Quantity) -> Self {
        let labels = differences(records);
        let curve = |(i, named): (usize, &NamedRecord)| {
            let rows = named.record.rows.clone();
            l2_values(rows.iter()).into_iter().map(move |l2| limits(i, &rows, l2, quantity)).collect::<Vec<_>>()
        };
        let mut caption = captions(records, &labels.1);
        caption.push(symmetry(quantity));
        let curves = records.iter().enumerate().flat_map(curve).collect();
        let rows = records.iter().flat_map(|named| &named.record.rows);
        Self { title: title(records), records: labels, curves, caption, ..Self::of(quantity, rows) }
    }

    /// The same plot with words for the cells that its rows are measured from, one for each record.
    pub fn measured_from(mut self, reference: Reference, cells: &[ReferenceCell]) -> Self {
        self.reference = reference;
        let labels = &self.records.1;
        let extreme = if reference == Reference::SmallestCell { "small" } else { "large" };
        let caption = |(i, cell): (usize, &ReferenceCell)| {
            let whose = labels.get(i).map(|label| format!("{label}:  ")).unwrap_or_default();
            let place = match cell.limit {
                Some((direction, l2)) => format!("the limit at {direction}°, l₂ = {}", l2_label(l2)),
                None => "the start".into(),
            };
            let ties = match cell.ties {
                0 => String::new(),
                1 => format!(", as {extreme} as 1 other limit"),
                n => format!(", as {extreme} as {n} other limits"),
            };
            format!("{whose}{} cell: {place}, {:.4} R² an element{ties}.", self.cell_word(), cell.area)
        };
        let words: Vec<String> = cells.iter().enumerate().map(caption).collect();
        self.caption.extend(words);
        self.caption.push("λ: length along the pull, by the length of the same line of rings in that cell; l₂ is relative to the start.".into());
        self
    }

    fn cell_word(&self) -> &'static str {
        match self.reference {
            Reference::Start => "Starting",
            Reference::LargestCell => "Largest",
            Reference::SmallestCell => "Smallest",
        }
    }

    fn subtitle(&self) -> String {
        let area = match self.reference {
            Reference::Start if self.quantity == Quantity::Lambda1 => return self.quantity.subtitle().to_owned(),
            Reference::Start => return format!("{} {}", self.ends, self.quantity.subtitle()),
            Reference::LargestCell => "greatest",
            Reference::SmallestCell => "least",
        };
        let quantity = if self.quantity == Quantity::Stretch { "stretch λ" } else { "elongation λ − 1" };
        format!("{} {quantity} along each direction of pull, from the cell of {area} area", self.ends)
    }

    fn symbol(&self) -> &'static str {
        match (self.reference, self.quantity) {
            (Reference::Start, quantity) => quantity.symbol(),
            (_, Quantity::Stretch) => "λ",
            _ => "λ − 1",
        }
    }

    /// The same plot without the bounds of limits.
    pub fn without_bounds(mut self) -> Self {
        self.curves.retain(|curve| curve.kind != CurveKind::Bound);
        self.caption.iter_mut().for_each(|words| *words = words.replace(WHERE_NOT, "."));
        self
    }

    /// The same plot with the limits of another record of this sheet as markers, which `what` names in the legend. Only
    /// these have markers then, and bounds are left out.
    pub fn checked_by(self, rows: &[LimitRow], what: &str) -> Self {
        let mut out = self.without_bounds();
        let quantity = out.quantity;
        let check = |l2: f64| {
            let mut curve = limits(0, rows, l2, quantity);
            curve.kind = CurveKind::Check;
            curve
        };
        out.curves.extend(l2_values(rows.iter()).into_iter().map(check));
        out.check = what.into();
        out
    }

    /// The same plot with the band that a tolerance makes of each curve of limits, from the derivatives of the record's rows. The radius
    /// is 1 + l1 or l1.
    pub fn with_tolerance(
        mut self,
        rows: &[LimitRow],
        derivatives: &[SensitivityRow],
        tolerance: &Tolerance,
        unit: &str,
    ) -> Self {
        let quantity = self.quantity;
        let band = |l2: f64| tolerance.band(rows, derivatives, l2, |row| quantity.of(row));
        self.bands = l2_values(rows.iter()).into_iter().map(band).collect();
        self.room_for.extend(self.bands.iter().flat_map(|band| band.low.values().chain(band.high.values())));
        let (name, amount) = (tolerance.number.trim_start_matches("parameters."), tolerance.amount);
        self.caption.push(format!("Shaded: {name} ± {amount}{unit}, to first order of the derivatives at each limit."));
        self
    }

    fn looks(&self) -> Looks {
        let mut l2: Vec<f64> = self.curves.iter().map(|curve| curve.l2).collect();
        l2.sort_by(f64::total_cmp);
        l2.dedup();
        Looks::new(self.records.1.len(), l2)
    }

    /// How a curve looks.
    fn look(&self, looks: &Looks, curve: &Curve) -> Look {
        let look = looks.of(curve.record, looks.l2.iter().position(|x| *x == curve.l2).unwrap_or(0));
        match curve.kind {
            CurveKind::Bound if self.records.1.is_empty() => Look { width: 1.4, dash: "5 4", ..look },
            // Those of no record.
            CurveKind::Check if !self.records.1.is_empty() => Look { color: "#111111".into(), ..look },
            _ => look,
        }
    }
}

fn limits(record: usize, rows: &[LimitRow], l2: f64, quantity: Quantity) -> Curve {
    let of_l2 = rows.iter().filter(|row| row.l2 == l2);
    let points: Vec<_> = of_l2.map(|row| (row.direction_deg, quantity.of(row), row.status)).collect();
    Curve::new(record, l2, CurveKind::Limits, &points)
}

/// Whether the width was left to the sheet in all of them.
fn lateral_free<'a>(mut rows: impl Iterator<Item = &'a LimitRow>) -> bool {
    rows.all(|row| row.lateral.as_deref() == Some("free"))
}

/// Which ends of l1 are shown.
fn ends<'a>(rows: impl Iterator<Item = &'a LimitRow>) -> &'static str {
    let is_least = |row: &LimitRow| row.end.as_deref() == Some("least");
    match rows.fold([false; 2], |[largest, least], row| [largest || !is_least(row), least || is_least(row)]) {
        [true, true] => "Largest and least",
        [_, true] => "Least",
        _ => "Largest",
    }
}

/// Why the plot goes all the way round.
fn symmetry(quantity: Quantity) -> String {
    let symbol = if quantity == Quantity::Lambda1 { "λ₁" } else { "l₁" };
    format!("A pull along D is the same pull along −D: {symbol} repeats after 180°.")
}

/// What the dashed lines are.
const WHERE_NOT: &str = "; dashed: the bound where others do not.";

/// How many limits attain a proven bound, where a record has bounds.
fn proven(rows: &[LimitRow]) -> Option<String> {
    let limits = rows.iter().filter(|row| row.l1.is_some()).count();
    let global = rows.iter().filter(|row| row.status == Status::Global).count();
    rows.iter().any(|row| row.bound_l1.is_some()).then(|| match limits - global {
        0 => format!("All {limits} limits attain their proven bound: none can be larger."),
        _ => format!("{global} of {limits} limits attain their proven bound{WHERE_NOT}"),
    })
}
