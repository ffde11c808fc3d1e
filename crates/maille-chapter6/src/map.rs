//! A record as the report sees it, and what is asked of its directions.

use maille::{
    bound::ChainBound,
    error::InvalidInput,
    lattice::Cell,
    model::Model,
    record::{LimitRow, Status},
    relaxation::target::Protocol,
    survey::Method,
};
use maille_io::record::{NamedRecord, RecordError};

/// A record as the statements see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Name of the design.
    pub design: String,
    /// r/R.
    pub ratio: f64,
    /// `exact` or `energy`.
    pub method: String,
    /// The energy method imposes the deformation on the cell's corners, as the thesis does.
    pub corners: bool,
    /// Another cell was asked for than the design's own.
    pub rearranged: bool,
    /// Of the directions beside the minima of a curve alone.
    pub minima: bool,
    /// Of some pulls alone, whose steps were kept.
    pub steps: bool,
    /// Directions along which neighbours interlock, degrees in [0, 180), sorted.
    pub interlocking_deg: Vec<f64>,
    /// The rows.
    pub rows: Vec<LimitRow>,
}

impl Map {
    /// What a record is; the interlocking directions are found from the links of its design.
    pub fn of(named: &NamedRecord) -> Result<Map, Vec<InvalidInput>> {
        let run = &named.record.run;
        let damaged = |e: RecordError| vec![InvalidInput::new("parameters", e.to_string(), "compute the record again")];
        let question = run.question().map_err(damaged)?;
        Ok(Map {
            design: run.design.name.clone(),
            ratio: run.design.minor_radius.unwrap_or(f64::NAN) / run.design.reference_radius,
            method: question.method.name().to_owned(),
            corners: matches!(&question.method, Method::Energy(options) if options.protocol == Protocol::Corners),
            rearranged: question.cells.cells(&question.method, 1).first() != Some(&Cell::PRIMITIVE),
            minima: named.name.ends_with(MINIMA),
            steps: named.name.ends_with(STEPS),
            interlocking_deg: interlocking(&Model::compile(&run.design, Cell::PRIMITIVE)?),
            rows: named.record.rows.clone(),
        })
    }

    /// Whether this is of the same design in the same cell, without the bias of the corners.
    pub(crate) fn alike(&self, map: &Map) -> bool {
        (&self.design, self.rearranged, self.corners) == (&map.design, map.rearranged, false)
    }

    /// Whether its limits are the markers on the curves of `map`: those of the energy method, but for pulls whose steps were kept.
    pub(crate) fn checks(&self, map: &Map) -> bool {
        self.alike(map) && self.ratio == map.ratio && self.method == "energy" && !self.steps
    }

    /// A design of the thesis in its own cell, and no bias of the corners.
    pub(crate) fn is_plain(&self) -> bool {
        !self.rearranged && !self.corners && !self.minima && !self.steps && !self.design.ends_with(SCALED)
    }

    /// `1.1, r = R/10, exact`.
    pub(crate) fn label(&self) -> String {
        let cell = if self.rearranged { ", rectangular cell" } else { "" };
        let corners = if self.corners { ", corners" } else { "" };
        let minima = if self.minima { ", beside the minima" } else { "" };
        let steps = if self.steps { ", steps kept" } else { "" };
        format!("{}, {}, {}{corners}{cell}{minima}{steps}", self.design, ratio_label(self.ratio), self.method)
    }

    /// Of a ring of the thesis's larger minor radius, R/10.
    pub(crate) fn is_thick(&self) -> bool {
        (self.ratio - 0.1).abs() < 1e-9
    }

    /// The l2 of the rows, from least to largest.
    pub(crate) fn l2(&self) -> Vec<f64> {
        let mut l2: Vec<f64> = self.rows.iter().map(|row| row.l2 + 0.0).collect();
        l2.sort_by(f64::total_cmp);
        l2.dedup();
        l2
    }

    /// The rows of one l2.
    pub(crate) fn rows_at(&self, l2: f64) -> impl Iterator<Item = &LimitRow> {
        self.rows.iter().filter(move |row| row.l2 == l2)
    }

    fn row(&self, direction_deg: f64, l2: f64) -> Option<&LimitRow> {
        self.rows_at(l2).find(|row| row.direction_deg == direction_deg)
    }

    pub(crate) fn l1(&self, direction_deg: f64, l2: f64) -> Option<f64> {
        self.row(direction_deg, l2)?.l1
    }

    /// λ1 − 1 of a limit, λ1 being the larger eigenvalue of C = FᵀF.
    pub(crate) fn lambda1(&self, direction_deg: f64, l2: f64) -> Option<f64> {
        Some(self.row(direction_deg, l2)?.lambda1? - 1.0)
    }

    /// Directions with their limits at one l2; nothing unless every direction has one.
    pub(crate) fn turn(&self, l2: f64) -> Option<Vec<(f64, f64)>> {
        let turn: Option<Vec<_>> = self.rows_at(l2).map(|row| Some((row.direction_deg, row.l1?))).collect();
        turn.filter(|turn| turn.len() > 2)
    }

    /// Largest less smallest λ1 of all directions at one l2; nothing unless every direction has a limit.
    pub(crate) fn spread(&self, l2: f64) -> Option<f64> {
        let of_l2: Option<Vec<f64>> = self.rows_at(l2).map(|row| row.lambda1).collect();
        let (low, high) = range(of_l2.filter(|all| all.len() > 2)?);
        Some(high - low)
    }

    /// The limits that this map and another one have: each with its row here, and l1 of either.
    pub(crate) fn both<'a>(&'a self, other: &'a Map) -> impl Iterator<Item = (&'a LimitRow, f64, f64)> {
        self.rows.iter().filter_map(|row| Some((row, row.l1?, other.l1(row.direction_deg, row.l2)?)))
    }

    /// The spreads that this map and another one have, each with its l2.
    pub(crate) fn spreads<'a>(&'a self, other: &'a Map) -> impl Iterator<Item = (f64, f64, f64)> {
        self.l2().into_iter().filter_map(|l2| Some((l2, self.spread(l2)?, other.spread(l2)?)))
    }

    /// Mean of what limits cost, of the l2 that are wanted; nothing where there is no limit.
    pub(crate) fn mean(&self, wanted: impl Fn(f64) -> bool, cost: impl Fn(&LimitRow) -> f64) -> Option<f64> {
        let found = self.rows.iter().filter(|row| row.l1.is_some() && wanted(row.l2));
        let costs: Vec<f64> = found.map(cost).collect();
        (!costs.is_empty()).then(|| costs.iter().sum::<f64>() / costs.len() as f64)
    }

    /// Limits that differ by less are the same.
    pub(crate) fn tie(&self) -> f64 {
        if self.method == "exact" { EXACT_TIE } else { ENERGY_TIE }
    }
}

/// Added to the name of a design that is another one in another size.
pub const SCALED: &str = "-scaled";
/// Added to the name of a record of the directions beside the minima.
pub const MINIMA: &str = "-minima";
/// Added to the name of a record that keeps its steps.
pub const STEPS: &str = "-steps";

/// The same limit, of the exact method.
pub(crate) const EXACT_TIE: f64 = 1e-6;
/// The same limit, of the energy method: its threshold and its overlap move a limit by this much at most, where it does
/// not jam (docs/theory/comparison.md).
pub(crate) const ENERGY_TIE: f64 = 0.003;

/// The least and the largest of some numbers.
pub(crate) fn range(numbers: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let all = numbers.into_iter();
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// `r = R/10`.
pub(crate) fn ratio_label(ratio: f64) -> String {
    let whole = (1.0 / ratio).round();
    if (whole * ratio - 1.0).abs() < 1e-9 { format!("r = R/{whole}") } else { format!("r = {ratio} R") }
}

/// With a minus sign, not a hyphen.
pub(crate) fn signed(number: f64) -> String {
    number.to_string().replace('-', "−")
}

/// Directions of the shortest chains of links: of those that can bind, the ones of fewest links.
fn interlocking(model: &Model) -> Vec<f64> {
    let bound = ChainBound::new(model);
    let element = |(ring, shift): (usize, [i32; 2])| (model.rings[ring].element, shift);
    // How far each chain reaches for its length, its direction and its links.
    let mut chains: Vec<(f64, f64, usize)> = bound
        .chains()
        .map(|chain| {
            let v = model.start.translation(chain.vector);
            let links = chain.rings.windows(2).filter(|w| element(w[0]) != element(w[1])).count();
            (half_turn(v.y.atan2(v.x).to_degrees()), v.norm() / chain.length, links)
        })
        .collect();
    chains.sort_by(|a, b| a.0.total_cmp(&b.0));
    chains.dedup_by(|a, b| apart(a.0, b.0) < 1e-6);
    // One on the straight line between its neighbours follows from them.
    let n = chains.len();
    let point = |k: usize| {
        let (degrees, reach, _) = chains[k % n];
        let (sin, cos) = (degrees + 180.0 * (k / n) as f64).to_radians().sin_cos();
        [reach * cos, reach * sin]
    };
    let is_corner = |k: usize| {
        let [a, b, c] = [k + n - 1, k + n, k + n + 1].map(point);
        n < 3 || ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])).abs() > 1e-9
    };
    let corners: Vec<_> = (0..n).filter(|&k| is_corner(k)).map(|k| chains[k]).collect();
    let fewest = corners.iter().map(|chain| chain.2).min();
    corners.into_iter().filter(|chain| Some(chain.2) == fewest).map(|chain| chain.0).collect()
}

/// Half-way between neighbouring interlocking directions.
pub(crate) fn midway(interlocking_deg: &[f64]) -> Vec<f64> {
    let n = interlocking_deg.len();
    let next = |i: usize| if i + 1 < n { interlocking_deg[i + 1] } else { interlocking_deg[0] + 180.0 };
    (0..n).map(|i| half_turn((interlocking_deg[i] + next(i)) / 2.0)).collect()
}

/// The same axis in [0, 180).
pub(crate) fn half_turn(degrees: f64) -> f64 {
    let rest = degrees.rem_euclid(180.0);
    if 180.0 - rest < 1e-9 { 0.0 } else { rest }
}

/// Angle between two axes.
pub(crate) fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(180.0);
    d.min(180.0 - d)
}

/// The directions with the least (`sign` 1) or largest (`sign` −1) limit of a turn, ties included.
pub(crate) fn extreme(turn: &[(f64, f64)], sign: f64, tie: f64) -> Vec<f64> {
    let best = turn.iter().map(|(_, l1)| sign * l1).fold(f64::INFINITY, f64::min);
    let mut degrees: Vec<f64> =
        turn.iter().filter(|(_, l1)| sign * l1 <= best + tie).map(|(d, _)| half_turn(*d)).collect();
    degrees.sort_by(f64::total_cmp);
    degrees.dedup();
    degrees
}

/// Angle between neighbouring directions of a map.
pub(crate) fn step(turn: &[(f64, f64)]) -> f64 {
    let mut degrees: Vec<f64> = turn.iter().map(|(d, _)| *d).collect();
    degrees.sort_by(f64::total_cmp);
    degrees.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 1e-9).fold(f64::INFINITY, f64::min)
}

/// Whether a limit was found, or proved not to be there.
pub(crate) fn answered(row: &LimitRow) -> bool {
    row.l1.is_some() || matches!(row.status, Status::L2Unreachable | Status::Unbounded)
}

/// `0°, 5°`; many directions are counted.
pub(crate) fn degrees(list: &[f64]) -> String {
    match list.len() {
        n if n > 6 => format!("{n} directions"),
        _ => list.iter().map(|d| format!("{d}°")).collect::<Vec<_>>().join(", "),
    }
}

/// `1.1, r = R/10, exact, l₂ = −0.25`.
pub(crate) fn at(map: &Map, l2: f64) -> String {
    format!("{}, l₂ = {}", map.label(), signed(l2))
}

/// Maps of two radii of the same sheet and method, the thicker first.
pub(crate) fn by_radius(maps: &[Map]) -> Vec<(&Map, &Map)> {
    let mut pairs = Vec::new();
    for thick in maps {
        let same = |thin: &&Map| {
            (&thin.design, &thin.method, thin.corners, thin.rearranged, thin.minima)
                == (&thick.design, &thick.method, thick.corners, thick.rearranged, thick.minima)
                && thin.ratio < thick.ratio
        };
        pairs.extend(maps.iter().filter(same).map(|thin| (thick, thin)));
    }
    pairs
}
