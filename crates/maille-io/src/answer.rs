//! Answers to single questions as JSON documents, with the keys of `docs/json.md`. A number that is not finite is `null`.

use maille::{
    answer::{Answer, CellTrend},
    design::Design,
    lattice::Direction,
    model::Model,
    question::{Goal, Question, Strain},
    record::{Status, pose_records},
    search::extreme::Extreme,
    solver::certificate::Certificate,
};
use maille_geometry::Vec3;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// A question on one strain, and what came of it.
pub struct StrainAnswer<'a> {
    /// Name of the design.
    pub design: &'a str,
    /// What was asked.
    pub question: &'a Question,
    /// The strain that was sought.
    pub goal: Strain,
    /// Strains that were left to the sheet.
    pub free: &'a [Strain],
    /// Direction of the strains' x axis.
    pub direction: Direction,
    /// The design, compiled for the cell of the answer.
    pub model: &'a Model,
    /// What was found.
    pub found: &'a Answer,
}

impl<'a> StrainAnswer<'a> {
    /// The answer to a question on a strain; `None` of other goals.
    pub fn new(design: &'a str, question: &'a Question, model: &'a Model, found: &'a Answer) -> Option<Self> {
        let Goal::Strain { component, direction_deg, free, .. } = &question.goal else { return None };
        let direction = Direction::of_degrees(*direction_deg);
        Some(StrainAnswer { design, question, goal: *component, free, direction, model, found })
    }

    /// The status in words of strains.
    pub fn status(&self) -> &'static str {
        match self.found.status {
            Status::L2Unreachable => "unreachable",
            Status::L2NotReached => "not-reached",
            status => status.name(),
        }
    }

    /// What a strain is in the question: `largest`, `least`, `free` or `held`.
    pub fn role(&self, strain: Strain) -> &'static str {
        match strain {
            goal if goal == self.goal => self.question.sense.name(),
            free if self.free.contains(&free) => "free",
            _ => "held",
        }
    }

    /// Least and largest value found of a strain that was left to the sheet, with the one that was sought given way by a millionth.
    pub fn range(&self, strain: Strain) -> Option<[f64; 2]> {
        self.found.ranges.get(self.free.iter().position(|free| *free == strain)?).copied()
    }

    /// A strain of the state.
    pub fn strain(&self, strain: Strain) -> f64 {
        strain.of(&self.found.green_strain(), self.direction)
    }

    /// l1 of lines along a normal strain that was sought: λ = √(1 + 2 E), l1 = λ − 1.
    pub fn stretch(&self) -> Option<f64> {
        let normal = self.goal != Strain::Exy;
        self.found.value.filter(|_| normal).map(|e| (1.0 + 2.0 * e).max(0.0).sqrt() - 1.0)
    }

    /// The document.
    pub fn json(&self) -> Value {
        let found = self.found;
        let solved = found.value.is_some();
        let strain = |s: Strain| {
            let value = solved.then(|| self.strain(s));
            let [least, largest] = self.range(s).map_or([None; 2], |range| range.map(Some));
            (s.name().to_owned(), json!({ "value": value, "is": self.role(s), "min": least, "max": largest }))
        };
        let cell = |t: &CellTrend| {
            json!({
                "cell": t.cell.to_string(),
                "value": t.value,
                "n_starts": t.n_starts,
                "n_distinct": t.n_distinct,
            })
        };
        json!({
            "design": self.design,
            "status": self.status(),
            "value": found.value,
            "bound": found.bound,
            "strains": Strain::ALL.map(strain).into_iter().collect::<Map<_, _>>(),
            "cell": self.model.cell.to_string(),
            "by_cell": found.by_cell.iter().map(cell).collect::<Vec<_>>(),
            "direction_deg": self.direction.degrees(),
            "l1": self.stretch(),
            "a1": solved.then(|| length(self.model, found.state.a1)),
            "a2": solved.then(|| length(self.model, found.state.a2)),
            "poses": solved.then(|| pose_records(self.model, &found.state)),
            "certificate": found.certificate.as_ref().map(|c| certificate(c, self.model.unit)),
            "links_ok": found.links_ok.filter(|_| solved),
            "n_starts": found.n_starts,
            "n_distinct": found.n_distinct,
            "better_chance": found.better_chance,
        })
    }
}

/// The thickest wire, the largest clearance or the closest cell of a design, and the state.
pub fn extreme(design: &Design, model: &Model, what: Extreme, lattice_free: bool, found: &Answer) -> Value {
    let sizes = what.sizes(found, model).into_iter().map(|size| {
        json!({
            "major_radius": size.major_radius,
            "minor_radius": size.minor_radius,
            "aspect_ratio": size.aspect_ratio(),
        })
    });
    json!({
        "design": design.name,
        "status": found.status.name(),
        "lattice": if lattice_free { "free" } else { "fixed" },
        "gap": what.clearance(found, model),
        "area_share": what.area_share(found),
        "widest_gap": what.widest_instead(found, model),
        "sizes": sizes.collect::<Vec<_>>(),
        "a1": length(model, found.state.a1),
        "a2": length(model, found.state.a2),
        "poses": pose_records(model, &found.state),
        "certificate": found.certificate.as_ref().map(|c| certificate(c, model.unit)),
        "links_ok": found.links_ok.unwrap_or(false),
        "n_starts": found.n_starts,
        "n_distinct": found.n_distinct,
        "better_chance": found.better_chance,
    })
}

/// A vector in the file's unit.
fn length(model: &Model, a: Vec3) -> [f64; 3] {
    (a * model.unit).into()
}

/// Figures of a certificate; the gap in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertificateRecord {
    /// Smallest gap of two rings.
    pub smallest_gap: f64,
    /// Largest component of the unbalanced force, for a unit pull.
    pub dual_residual: f64,
    /// Largest product of a force and its gap.
    pub complementarity: f64,
    /// Smallest force; none where no contact carries.
    pub min_multiplier: Option<f64>,
    /// Smallest curvature on the motions that keep the loaded contacts.
    pub min_curvature: Option<f64>,
    /// Motions without curvature.
    pub zero_modes: usize,
}

impl CertificateRecord {
    /// That of a certificate, where R is `unit`.
    pub fn new(c: &Certificate, unit: f64) -> Self {
        CertificateRecord {
            smallest_gap: c.smallest_gap * unit,
            dual_residual: c.dual_residual,
            complementarity: c.complementarity,
            min_multiplier: Some(c.min_multiplier).filter(|x| x.is_finite()),
            min_curvature: c.min_curvature.filter(|x| x.is_finite()),
            zero_modes: c.zero_modes,
        }
    }
}

fn certificate(c: &Certificate, unit: f64) -> Value {
    json!(CertificateRecord::new(c, unit))
}
