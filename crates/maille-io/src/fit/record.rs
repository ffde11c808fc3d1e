//! `fit.json`: what was asked of a fit, and what came out.

use super::request::FitRequest;
use crate::{
    files,
    record::{RecordError, sha256},
    sensitivity::ring_labels,
};
use maille::{
    answer::Answer,
    fit::{Ended, Fit, Measure, Target, Wanted},
    record::{LimitRow, Status},
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::{fs, path::Path};

/// Name of the record's file; beside it are the records of the given and of the fitted design.
pub const FIT: &str = "fit.json";

/// A fit as its folder holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitRecord {
    /// Version of the format, 1.
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// What was asked.
    pub request: FitRequest,
    /// What came out; of a fit that is not finished, the best numbers yet.
    pub outcome: FitOutcome,
    /// SHA-256, in hexadecimal, of this document without this field, on one line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// What came of a fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitOutcome {
    /// How it ended.
    pub ended: Ended,
    /// Starts that were searched.
    pub starts: usize,
    /// Designs that were solved.
    pub designs: usize,
    /// The free numbers, in the order of the request.
    pub numbers: Vec<f64>,
    /// Factor of the wanted limits: 1 but for a shape.
    pub factor: f64,
    /// What came of each target, in their order; empty while the fit is not finished.
    pub targets: Vec<FittedTarget>,
}

/// What came of one target. Limits are l1, Poisson ratios those of their states; a clearance is in reference radii.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedTarget {
    /// Its value in the given design.
    pub before: Option<f64>,
    /// Its value in the fitted one.
    pub after: Option<f64>,
    /// Outcome of the search for it.
    pub status: Status,
    /// How far it is from what is wanted, of a shape relative to its factor: 0 where that is reached.
    pub miss: f64,
    /// What is proved of the fitted design: its limit is not larger.
    pub bound: Option<f64>,
    /// What is proved of every design with the free numbers between their bounds, where it is known.
    pub family_bound: Option<f64>,
    /// Whether that bound forbids what is wanted.
    pub forbidden: bool,
    /// The pairs of rings that carry the load, the largest force first.
    pub held_by: Vec<String>,
}

impl FitRecord {
    /// A fit that is not finished: the best numbers yet, after so many starts and designs.
    pub fn begun(request: &FitRequest, numbers: Vec<f64>, starts: usize, designs: usize) -> Self {
        let outcome =
            FitOutcome { ended: Ended::Interrupted, starts, designs, numbers, factor: 1.0, targets: Vec::new() };
        Self::new(request, outcome)
    }

    /// A finished fit.
    pub fn finished(request: &FitRequest, found: &Fit) -> Result<Self, maille::InvalidInput> {
        let targets = request.checked_targets()?;
        let labels = ring_labels(&request.design);
        let of = |(k, (before, after)): (usize, (&Answer, &Answer))| FittedTarget {
            before: request.targets[k].measure.value(before),
            after: request.targets[k].measure.value(after),
            status: after.status,
            miss: found.misses[k],
            bound: after.bound.filter(|_| !matches!(request.targets[k].measure, Measure::PoissonRatio { .. })),
            family_bound: found.bounds[k],
            forbidden: found.is_forbidden(&targets, k),
            held_by: held_by(&labels, after),
        };
        let fitted = found.before.iter().zip(&found.answers).enumerate().map(of).collect();
        let outcome = FitOutcome {
            ended: found.ended,
            starts: found.starts,
            designs: found.designs,
            numbers: found.numbers.clone(),
            factor: found.factor,
            targets: fitted,
        };
        Ok(Self::new(request, outcome))
    }

    fn new(request: &FitRequest, outcome: FitOutcome) -> Self {
        let version = env!("CARGO_PKG_VERSION").into();
        FitRecord { schema: 1, version, request: request.clone(), outcome, sha256: None }.sealed()
    }

    fn sealed(mut self) -> Self {
        self.sha256 = None;
        let text = serde_json::to_string(&self).expect("no map with odd keys");
        self.sha256 = Some(sha256(text.as_bytes()));
        self
    }

    /// Whether a run that asks `request` would add nothing: it is finished, reached or with as many starts.
    pub fn is_final(&self, request: &FitRequest) -> bool {
        match self.outcome.ended {
            Ended::Reached => true,
            Ended::Missed => self.outcome.starts >= request.options.starts,
            Ended::Interrupted => false,
        }
    }

    /// Writes it into a folder, which must be there.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), RecordError> {
        let path = folder.join(FIT);
        let text = serde_json::to_string_pretty(self).expect("no map with odd keys") + "\n";
        files::write(&path, text.as_bytes()).map_err(RecordError::io("write", &path))
    }
}

/// Reads the fit of a folder.
///
/// # Errors
/// Where it is missing, no such document, or edited.
pub fn open_fit(folder: &Path) -> Result<FitRecord, RecordError> {
    let path = folder.join(FIT);
    let file = path.display().to_string();
    let text = fs::read_to_string(&path).map_err(RecordError::io("read", &path))?;
    let record: FitRecord =
        serde_json::from_str(&text).map_err(|e| RecordError::malformed(&file, e.line(), e.to_string()))?;
    if record.schema != 1 {
        let problem = format!("schema {} is not known; this program reads 1", record.schema);
        return Err(RecordError::malformed(&file, 1, problem));
    }
    let (expected, found) = (record.sha256.clone(), record.clone().sealed().sha256);
    match (expected, found) {
        (Some(expected), Some(found)) if expected != found => {
            Err(RecordError::Edited { file, found, expected, by: FIT })
        }
        _ => Ok(record),
    }
}

/// The wanted limits as rows that a plot can draw, of a shape times its factor.
pub fn target_rows(record: &FitRecord) -> Vec<LimitRow> {
    let factor = record.outcome.factor;
    let row = |target: &Target| match target.measure {
        Measure::Stretch { direction_deg, l2 } => {
            let l1 = Some(target.wanted.value() * factor);
            Some(LimitRow { direction_deg, l2, l1, status: Status::Global, ..LimitRow::default() })
        }
        Measure::PoissonRatio { .. } | Measure::Clearance => None,
    };
    record.request.targets.iter().filter_map(row).collect()
}

/// Pairs that are named.
const NAMED: usize = 3;

/// The pairs of rings with the largest forces.
fn held_by(labels: &[String], answer: &Answer) -> Vec<String> {
    let mut pairs: Vec<(String, f64)> = Vec::new();
    for contact in &answer.contacts {
        let [a, b] = [contact.pair.ring_a, contact.pair.ring_b].map(|ring| &labels[ring % labels.len()]);
        let name = format!("{a} on {b}");
        match pairs.iter_mut().find(|(known, _)| *known == name) {
            Some((_, force)) => *force += contact.force,
            None => pairs.push((name, contact.force)),
        }
    }
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    pairs.into_iter().take(NAMED).map(|(name, _)| name).collect()
}

/// The document of `maille fit --json`, with the keys of `docs/json.md`, without the folder.
pub fn document(record: &FitRecord) -> Value {
    let FitRecord { request, outcome, .. } = record;
    let numbers = request.free.iter().zip(&outcome.numbers).map(|(free, value)| {
        json!({ "number": free.name, "before": free.value, "after": value, "min": free.min, "max": free.max })
    });
    let targets = request.targets.iter().zip(&outcome.targets).map(|(target, found)| {
        let mut row = json!(found);
        let (direction_deg, l2) = match target.measure {
            Measure::Stretch { direction_deg, l2 } => (Some(direction_deg), Some(l2)),
            Measure::PoissonRatio { direction_deg } => (Some(direction_deg), None),
            Measure::Clearance => (None, None),
        };
        row["direction_deg"] = json!(direction_deg);
        row["l2"] = json!(l2);
        row["measure"] = json!(measure_word(target.measure));
        row["wanted"] = json!({ wanted_word(target): target.wanted.value() });
        row["weight"] = json!(target.weight);
        row
    });
    json!({
        "design": request.design.name,
        "ended": outcome.ended,
        "starts": outcome.starts,
        "designs": outcome.designs,
        "shape_factor": request.shape.then_some(outcome.factor),
        "worst_miss": worst(&outcome.targets),
        "numbers": numbers.collect::<Vec<_>>(),
        "targets": targets.collect::<Vec<_>>(),
    })
}

fn worst(targets: &[FittedTarget]) -> Option<f64> {
    targets.iter().map(|target| target.miss.abs()).reduce(f64::max)
}

/// What is measured, by its column in targets.
fn measure_word(measure: Measure) -> &'static str {
    match measure {
        Measure::Stretch { .. } => "l1",
        Measure::PoissonRatio { .. } => "poisson_ratio",
        Measure::Clearance => "widest_gap",
    }
}

/// The word of what is wanted.
fn wanted_word(target: &Target) -> &'static str {
    match target.wanted {
        Wanted::Value(_) => measure_word(target.measure),
        Wanted::AtLeast(_) => "at_least",
        Wanted::AtMost(_) => "at_most",
    }
}
