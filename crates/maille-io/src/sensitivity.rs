//! The numbers of a design, ranked by how much a limit changes with them.

use crate::unit::millimetres;
use maille::{
    answer::Answer,
    design::{Design, Parameter},
    model::RingPair,
    record::Status,
    sensitivity::{DesignVector, OneSided, RingVector, Sensitivity},
};
use serde_json::{Value, json};

/// One number of a design, changed by a step.
pub struct NumberChange {
    /// Which number.
    pub number: String,
    /// Size of the step: a length in the file's unit, a share (spacing), radians (tilt), or in the unit of the parameter.
    pub step: f64,
    /// The step with its unit.
    pub step_words: String,
    /// Derivatives of the limit by the number.
    pub slope: OneSided,
    /// Whether states that symmetries of the design make of each other tie along this change.
    pub images_tie: bool,
    /// The pairs of rings that carry most of it, each with its share of all that is carried up or down.
    pub through: Vec<(String, f64)>,
    /// What the limit of the changed design is, for a step back and one forward, where it was solved.
    pub solved: [Option<SolvedChange>; 2],
    change: Change,
}

/// The limit of a changed design, solved anew.
#[derive(Clone, Copy, Debug)]
pub struct SolvedChange {
    /// Outcome of the search; `None` where the changed numbers are no design that can be used.
    pub status: Option<Status>,
    /// How far its limit is from that of the design; `None` where none was found.
    pub change: Option<f64>,
}

/// How a design is changed.
enum Change {
    Numbers(DesignVector),
    Spacing,
    Parameter { name: String, value: f64 },
}

/// A change below this is 0.
pub const NO_CHANGE: f64 = 1e-12;
/// Pairs that are named.
const NAMED: usize = 2;
/// Step of a length in millimetres.
const STEP_MM: f64 = 0.1;
/// Step of the spacing, and of a length in a design without a unit of length, as a share of the reference radius.
const SHARE: f64 = 0.01;

impl NumberChange {
    /// Changes of the limit for a step back and a step forward, to first order; `None` where no state is left, or it is not known.
    pub fn changes(&self) -> [Option<f64>; 2] {
        [self.slope.backward.finite().map(|x| -x * self.step), self.slope.forward.finite().map(|x| x * self.step)]
    }

    /// The larger of both changes; infinite where one of them is not known.
    pub fn largest(&self) -> f64 {
        self.changes().into_iter().map(|change| change.map_or(f64::INFINITY, f64::abs)).fold(0.0, f64::max)
    }

    /// The design with this number changed by its step, back or forward; `None` where a rule of its parameter forbids it.
    pub fn changed(&self, design: &Design, forward: bool) -> Option<Design> {
        let step = if forward { self.step } else { -self.step };
        match &self.change {
            Change::Numbers(change) => Some(change.applied(design, step)),
            Change::Spacing => Some(design.spaced(1.0 + step)),
            Change::Parameter { name, value } => design.with_parameters(&[(name, value + step)]).ok(),
        }
    }

    fn json(&self) -> Value {
        let [back, forward] = self.changes();
        let [solved_back, solved] = self.solved.map(|solved| {
            solved.map(|s| json!({ "status": s.status.map_or("no-design", Status::name), "change": s.change }))
        });
        let through = self.through.iter().map(|(pair, share)| json!({ "pair": pair, "share": share }));
        json!({
            "number": self.number,
            "step": self.step,
            "step_words": self.step_words,
            "change": forward,
            "change_back": back,
            "derivative": self.slope.forward.finite(),
            "derivative_back": self.slope.backward.finite(),
            "kink": self.slope.is_kink(),
            "images_tie": self.images_tie,
            "solved": solved,
            "solved_back": solved_back,
            "through": through.collect::<Vec<_>>(),
        })
    }
}

/// The numbers of the design, those that matter most first.
///
/// `step` is that of all lengths, in the file's unit; by default 0.1 mm, or 1 % of the reference radius where the design has no unit
/// of length. The spacing and parameters of the file change by 1 % (a parameter that is 0 by 0.01), a tilt by 1°. A ring alone in its element has no offset and no tilt here: a limit is sought
/// over all positions and turns of the element.
pub fn ranked(design: &Design, found: &Sensitivity, step: Option<f64>) -> Vec<NumberChange> {
    let unit = design.unit.as_deref();
    let default = || unit.and_then(millimetres).map_or(design.reference_radius * SHARE, |mm| STEP_MM / mm);
    let length = step.unwrap_or_else(default);
    let in_unit = unit.map_or(format!("{length}"), |unit| format!("{length} {unit}"));
    let labels = ring_labels(design);
    let of = |number: String, change: &DesignVector, step: f64, words: &str| NumberChange {
        number,
        step,
        step_words: words.to_owned(),
        slope: found.one_sided(change),
        images_tie: found.images_tie(change),
        through: through(&labels, &found.by_pair(change)),
        solved: [None; 2],
        change: Change::Numbers(change.clone()),
    };
    let mut lines = Vec::new();
    for (number, rate) in shared_numbers(design) {
        lines.push(match number {
            Shared::Wire => of("minor_radius, the wire".into(), &rate, length, &in_unit),
            Shared::Spacing => NumberChange { change: Change::Spacing, ..of("spacing".into(), &rate, SHARE, "1 %") },
            Shared::Parameter(Parameter { name, value, .. }) => {
                let share = if *value == 0.0 { SHARE } else { SHARE * value.abs() };
                let words = if *value == 0.0 { format!("{SHARE}") } else { "1 %".into() };
                let change = Change::Parameter { name: name.clone(), value: *value };
                NumberChange { change, ..of(format!("parameter {name}"), &rate, share, &words) }
            }
        });
    }
    for (k, name) in ["a1.x", "a1.y", "a2.x", "a2.y"].into_iter().enumerate() {
        let mut change = DesignVector::zeros(labels.len());
        change.lattice[k / 2][k % 2] = 1.0;
        lines.push(of(format!("lattice {name}"), &change, length, &in_unit));
    }
    let gradient = found.gradient();
    let alone = design.elements.iter().flat_map(|e| e.rings.iter().map(|_| e.rings.len() == 1));
    for ((ring, label), alone) in labels.iter().enumerate().zip(alone) {
        let unit_change = |set: &dyn Fn(&mut RingVector)| {
            let mut change = DesignVector::zeros(labels.len());
            set(&mut change.rings[ring]);
            change
        };
        lines.push(of(format!("{label} major_radius"), &unit_change(&|r| r.major_radius = 1.0), length, &in_unit));
        lines.push(of(format!("{label} minor_radius"), &unit_change(&|r| r.minor_radius = 1.0), length, &in_unit));
        if alone {
            continue;
        }
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            lines.push(of(format!("{label} offset.{axis}"), &unit_change(&|r| r.offset[k] = 1.0), length, &in_unit));
        }
        let steepest = gradient.rings[ring].tilt;
        if steepest.norm() > NO_CHANGE {
            let axis = steepest.normalize();
            let [x, y, z] = [axis.x, axis.y, axis.z].map(|x| (x * 100.0).round() / 100.0 + 0.0);
            let change = unit_change(&|r| r.tilt = axis);
            lines.push(of(format!("{label} tilt about ({x}, {y}, {z})"), &change, 1f64.to_radians(), "1\u{b0}"));
        }
    }
    lines.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
    lines
}

/// A number that is of no single ring.
pub(crate) enum Shared<'a> {
    /// The minor radius that rings have in common.
    Wire,
    Spacing,
    /// A free one of the file.
    Parameter(&'a Parameter),
}

impl Shared<'_> {
    /// Its name in `sensitivities.csv`.
    pub fn name(&self) -> String {
        match self {
            Shared::Wire => "minor_radius".into(),
            Shared::Spacing => "spacing".into(),
            Shared::Parameter(parameter) => format!("parameters.{}", parameter.name),
        }
    }
}

/// The shared numbers of a design, each with how the raw numbers change with it. Left out are a wire that no ring has, and parameters
/// that cannot change.
pub(crate) fn shared_numbers(design: &Design) -> Vec<(Shared<'_>, DesignVector)> {
    let wire = DesignVector::common_minor_radius(design);
    let has_wire = wire.rings.iter().any(|ring| ring.minor_radius != 0.0);
    let mut out: Vec<_> = has_wire.then_some((Shared::Wire, wire)).into_iter().collect();
    out.push((Shared::Spacing, DesignVector::spacing(design)));
    out.extend(design.free_parameters().filter_map(|parameter| {
        let with = |value: f64| design.with_parameters(&[(&parameter.name, value)]).ok();
        Some((Shared::Parameter(parameter), DesignVector::by_number(parameter.value, &with)?))
    }));
    out
}

/// The document of `maille sensitivity --json`, with the keys of `docs/json.md`. `direction_deg` and `l2` are those of the question.
pub fn document(
    design: &Design,
    (direction_deg, l2): (f64, f64),
    answer: &Answer,
    found: &Sensitivity,
    numbers: &[NumberChange],
) -> Value {
    json!({
        "design": design.name,
        "direction_deg": direction_deg,
        "l2": l2,
        "cell": answer.cell.to_string(),
        "status": answer.status.name(),
        "l1": answer.value,
        "forces_are_unique": found.forces_are_unique(),
        "loose_motions": found.loose_motions(),
        "numbers": numbers.iter().map(NumberChange::json).collect::<Vec<_>>(),
    })
}

/// Names of all rings, in the order of the file.
pub(crate) fn ring_labels(design: &Design) -> Vec<String> {
    let rings = design.elements.iter().flat_map(|element| (0..element.rings.len()).map(move |ring| (element, ring)));
    let label = |(element, ring): (&maille::design::ElementSpec, usize)| match element.rings.len() {
        1 => format!("\"{}\"", element.name),
        _ => format!("\"{}\" ring {ring}", element.name),
    };
    rings.map(label).collect()
}

fn through(labels: &[String], parts: &[(RingPair, f64)]) -> Vec<(String, f64)> {
    let all: f64 = parts.iter().map(|(_, part)| part.abs()).sum();
    let label = |pair: &RingPair| {
        let image = match pair.shift {
            [0, 0] => String::new(),
            [i, j] => format!(" in cell ({i:+},{j:+})"),
        };
        format!("{} on {}{image}", labels[pair.ring_a], labels[pair.ring_b])
    };
    parts.iter().take(NAMED).map(|(pair, part)| (label(pair), part.abs() / all)).collect()
}
