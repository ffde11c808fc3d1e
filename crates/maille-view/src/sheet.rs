//! Designs and states as the page shows them.

use crate::api::{Limit, Pair, Ring, Sheet, ShownMap, Subject};
use crate::refusal::Refusal;
use maille::{
    design::{CurveKind, Design},
    lattice::Cell,
    model::Model,
    record::{LimitRow, StateRecord, pose_records},
    state::State,
    topology,
};
use maille_io::{DesignSource, record::Record, set_parameters};

/// Pairs of rings are listed if their gap is below this many of the largest major radius.
const NEAR: f64 = 0.5;
/// Pairs of rings that may have to be looked at, at most.
const MOST_PAIRS: f64 = 2e6;
/// Rings of a cell, at most.
const MOST_RINGS: usize = 2_000;
/// Rings of a finite sheet, at most.
const MOST_OF_SHEET: usize = 50_000;

/// A subject as read, its design changed as the sliders say.
pub struct Read {
    /// For errors.
    pub source: DesignSource,
    /// As the file says.
    pub written: Design,
    /// As the sliders say.
    pub design: Design,
}

impl Subject {
    /// Reads the design file, and changes it.
    pub fn read(&self) -> Result<Read, Refusal> {
        let source = DesignSource::new(&*self.name, &*self.text);
        let written = source.read().map_err(|e| Refusal::design(&e))?;
        let mut design = written.clone();
        if !self.parameters.is_empty() {
            let values: Vec<_> = self.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            design = set_parameters(&design, &values).map_err(|e| Refusal::design(&source.explain(&e)))?;
        }
        if let Some(r) = self.minor_radius {
            if !(r.is_finite() && r > 0.0) {
                return Err(Refusal::wrong(
                    format!("the minor radius {r} is not a positive length"),
                    "give one above 0",
                ));
            }
            design = design.with_minor_radius(r);
        }
        if let Some(factor) = self.spacing {
            if !(factor.is_finite() && factor > 0.0) {
                return Err(Refusal::wrong(format!("the spacing {factor} is not positive"), "give one above 0"));
            }
            design = design.spaced(factor);
        }
        Ok(Read { source, written, design })
    }
}

impl Read {
    /// Compiles the design for `cell`.
    pub fn compile(&self, design: &Design, cell: Cell) -> Result<Model, Refusal> {
        self.compile_for(design, cell, false)
    }

    /// Compiles the design for `cell`, which may be the whole of a finite sheet.
    pub fn compile_for(&self, design: &Design, cell: Cell, finite: bool) -> Result<Model, Refusal> {
        let model = if finite {
            small_enough(design, Cell::PRIMITIVE)?;
            let count = design.elements.iter().map(|e| e.rings.len()).sum::<usize>().saturating_mul(cell.copies());
            if count > MOST_OF_SHEET {
                return Err(Refusal::wrong(format!("{count} rings are too many to show"), "take a smaller tile"));
            }
            Model::compile_sheet(design, cell)
        } else {
            small_enough(design, cell)?;
            Model::compile(design, cell)
        };
        model.map_err(|problems| Refusal::design(&self.source.explain(&problems)))
    }
}

/// The design with overlaps of its start accepted.
pub fn tolerant(design: &Design) -> Design {
    Design { allow_initial_overlap: true, ..design.clone() }
}

/// A server must not be kept busy by a design of a million neighbours: the cells within two reaches of a ring are counted
/// by the heights of the cell.
fn small_enough(design: &Design, cell: Cell) -> Result<(), Refusal> {
    if !design.problems().is_empty() {
        return Ok(()); // compiling says which
    }
    let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let wire = |own: Option<f64>| own.or(design.minor_radius).unwrap_or(0.0);
    let reaches: Vec<f64> = design
        .elements
        .iter()
        .flat_map(|e| {
            let rings = e.rings.iter().map(|ring| norm(ring.offset) + ring.major_radius + wire(ring.minor_radius));
            let curves = e.curves.iter().map(|c| norm(c.offset) + c.shape.reach() + wire(c.minor_radius));
            rings.chain(curves).collect::<Vec<_>>()
        })
        .collect();
    let reach = reaches.iter().copied().fold(0.0, f64::max);
    let count = reaches.len() * cell.copies();
    let (a, b) = (design.lattice.a1, design.lattice.a2);
    let area = (a[0] * b[1] - a[1] * b[0]).abs();
    let along = |other: [f64; 3]| 4.0 * reach * norm(other) / area + 1.0;
    let pairs = (count as f64).powi(2) * along(a) * along(b);
    // Centres may lie cells away from each other: that moves the images, and adds none.
    if count > MOST_RINGS || pairs.is_nan() || pairs > MOST_PAIRS {
        let problem =
            format!("{count} rings a cell, with about {pairs:.0} pairs in reach of each other, are too many to show");
        return Err(Refusal::wrong(problem, "give the lattice vectors the size of the rings, or fewer elements"));
    }
    Ok(())
}

/// Points along a curve: so many on each arc that its chords turn by a quarter of a radian or less.
fn shown(curve: &maille::model::Curve) -> impl Iterator<Item = maille_geometry::Vec3> {
    let points = |piece: &maille_geometry::Piece| {
        let n = match piece {
            // Near its ends, too, so that a smooth line through the points keeps corners.
            maille_geometry::Piece::Segment(_) => return [0.0, 0.02, 0.98].map(|t| piece.point(t)).to_vec(),
            maille_geometry::Piece::Arc(arc) => (4.0 * arc.sweep_rad()).ceil().max(1.0),
        };
        (0..n as usize).map(|k| piece.point(k as f64 / n)).collect()
    };
    let (shown, end) = match curve.kind {
        CurveKind::Open => {
            let own: Vec<_> = curve.own_pieces().collect();
            let end = own.last().map(|piece| piece.point(1.0));
            (own, end)
        }
        CurveKind::Closed | CurveKind::Frame => (curve.pieces.iter().collect(), None),
    };
    shown.into_iter().flat_map(points).chain(end).collect::<Vec<_>>().into_iter()
}

/// The model as the page shows it.
pub fn sheet(model: &Model, design: &Design) -> Sheet {
    let length = |v: maille_geometry::Vec3| -> [f64; 3] { (v * model.unit).into() };
    let ring = |ring: &maille::model::Ring| Ring {
        element: ring.element,
        offset: length(ring.offset),
        normal: ring.normal.into_inner().into(),
        major_radius: ring.major_radius * model.unit,
        minor_radius: ring.minor_radius * model.unit,
        curve: ring.curve.as_ref().map(|curve| shown(curve).map(|p| length(p - ring.offset)).collect()),
        open: ring.curve.as_ref().is_some_and(|curve| curve.kind == CurveKind::Open),
    };
    Sheet {
        name: design.name.clone(),
        title: design.title.clone(),
        unit: design.unit.clone(),
        cell: model.cell.to_string(),
        reference_radius: design.reference_radius,
        a1: length(model.start.a1),
        a2: length(model.start.a2),
        kinds: maille_render::kinds(model),
        first_ring: model.elements.iter().map(|e| e.rings.start).collect(),
        poses: pose_records(model, &model.start),
        rings: model.rings.iter().map(ring).collect(),
        pairs: pairs(model, &model.start),
    }
}

/// The pairs of rings that are linked or near each other.
pub fn pairs(model: &Model, state: &State) -> Vec<Pair> {
    let near = topology::close_pairs(model, state, NEAR * model.largest_radius);
    let links = topology::links(model, state, &near);
    let number = |pair| links.iter().find(|link| link.pair == pair).map_or(0, |link| link.number);
    let one = |pair: topology::RingPair| Pair {
        ring_a: pair.ring_a,
        ring_b: pair.ring_b,
        shift: pair.shift,
        number: number(pair),
        gap: (topology::core_distance(model, state, &pair) - model.contact_distance(pair.ring_a, pair.ring_b))
            * model.unit,
    };
    let listed = |pair: &Pair| pair.number != 0 || pair.gap < NEAR * model.largest_radius * model.unit;
    near.into_iter().map(one).filter(listed).collect()
}

/// A row with its state as the page shows it; `models` has its cell.
pub fn limit(models: &[Model], row: &LimitRow, state: &StateRecord) -> Limit {
    let model = models.iter().find(|model| model.cell.to_string() == row.cell);
    let at = model.and_then(|model| Some((model, maille_mesh::state_of(model, state).ok()?)));
    let pairs = at.map_or(Vec::new(), |(model, state)| pairs(model, &state));
    Limit { row: row.clone(), state: state.clone(), pairs }
}

/// A record as the page shows it.
pub fn shown_map(source: String, record: &Record) -> Result<ShownMap, Refusal> {
    let design = &record.run.design;
    let mut cells: Vec<&str> = vec!["1x1"];
    for row in &record.rows {
        if !cells.contains(&row.cell.as_str()) {
            cells.push(&row.cell);
        }
    }
    let compile = |text: &&str| {
        let unusable =
            |problem: String| Refusal::wrong(format!("the record cannot be used: {problem}"), "compute it again");
        let cell: Cell = text.parse().map_err(|e: maille::error::InvalidInput| unusable(e.problem))?;
        Model::compile(&tolerant(design), cell).map_err(|problems| {
            unusable(problems.iter().map(|p| format!("{}: {}", p.field, p.problem)).collect::<Vec<_>>().join("; "))
        })
    };
    let models = cells.iter().map(compile).collect::<Result<Vec<_>, _>>()?;
    let key = |direction: f64, l2: f64| (direction.to_bits(), l2.to_bits());
    let states: std::collections::BTreeMap<_, _> =
        record.states.iter().map(|state| (key(state.direction_deg, state.l2), state)).collect();
    let of = |row: &LimitRow| Some(limit(&models, row, states.get(&key(row.direction_deg, row.l2))?));
    Ok(ShownMap {
        source,
        sheets: models.iter().map(|model| sheet(model, design)).collect(),
        limits: record.rows.iter().filter_map(of).collect(),
    })
}
