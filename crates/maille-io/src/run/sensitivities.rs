//! Derivatives of the limits of a record: from its states and forces, with no further solve.

use crate::{
    record::{Record, RecordError, SensitivityRow},
    sensitivity::shared_numbers,
};
use maille::{
    Answer, Certificate, Contact, Goal, Model, Question, Sense, Sensitivity, Status,
    model::RingPair,
    record::{LimitRow, StateRecord},
    survey::Method,
};
use maille_geometry::Vec3;
use nalgebra::Matrix2;

/// The derivatives of every certified limit by the wire, the spacing and the parameters of the file, in the order of the rows.
///
/// A derivative is absent where no state is left, and all those of a limit whose recorded forces do not balance its state.
pub fn sensitivities(record: &Record) -> Result<Vec<SensitivityRow>, RecordError> {
    let asked = record.run.question()?;
    let Method::Exact(options) = &asked.method else { return Ok(Vec::new()) };
    let numbers = shared_numbers(&record.run.design);
    let mut models: Vec<Model> = Vec::new();
    let mut out = Vec::new();
    for row in record.rows.iter().filter(|row| matches!(row.status, Status::Global | Status::Local)) {
        let here = |state: &&StateRecord| (state.direction_deg, state.l2) == (row.direction_deg, row.l2);
        let Some(state) = record.states.iter().find(here) else { continue };
        let Some(model) = model_of(&mut models, record, row) else { continue };
        let goal = Goal::Stretch { direction_deg: row.direction_deg, l2: row.l2, across: options.across };
        let sense = if options.compression { Sense::Least } else { Sense::Largest };
        let question = Question::new(goal, sense);
        let found = answer(model, row, state).and_then(|answer| Sensitivity::of(model, &question, &answer).ok());
        out.extend(numbers.iter().map(|(number, change)| {
            let slope = found.as_ref().map(|found| found.one_sided(change));
            SensitivityRow {
                direction_deg: row.direction_deg,
                l2: row.l2,
                number: number.name(),
                derivative: slope.and_then(|slope| slope.forward.finite()),
                derivative_back: slope.and_then(|slope| slope.backward.finite()),
            }
        }));
    }
    Ok(out)
}

/// The model of a row's cell.
fn model_of<'a>(models: &'a mut Vec<Model>, record: &Record, row: &LimitRow) -> Option<&'a Model> {
    let cell = row.cell.parse().ok()?;
    let known = models.iter().position(|model| model.cell == cell);
    let k = match known {
        Some(k) => k,
        None => {
            models.push(Model::compile(&record.run.design, cell).ok()?);
            models.len() - 1
        }
    };
    Some(&models[k])
}

/// The answer that was recorded, as far as derivatives need it.
fn answer(model: &Model, row: &LimitRow, state: &StateRecord) -> Option<Answer> {
    let length = |x: [f64; 3]| Vec3::from(x) / model.unit;
    let contact = |c: &maille::record::ContactRecord| Contact {
        pair: RingPair { ring_a: c.ring_a, ring_b: c.ring_b, shift: c.shift },
        point_a: length(c.point_a),
        point_b: length(c.point_b),
        force: c.force,
    };
    let certificate = Certificate {
        smallest_gap: row.min_gap?.min(0.0) / model.unit,
        dual_residual: row.dual_residual?,
        complementarity: row.complementarity?,
        min_multiplier: row.min_multiplier?,
        min_curvature: row.min_curvature,
        zero_modes: usize::try_from(row.zero_modes?).ok()?,
        multipliers: Vec::new(),
    };
    let [[xx, xy], [yx, yy]] = state.deformation_gradient;
    Some(Answer {
        value: row.l1,
        state: state.state(model)?,
        gradient: Matrix2::new(xx, xy, yx, yy),
        contacts: state.contacts.iter().map(contact).collect(),
        certificate: Some(certificate),
        ..Answer::new(model, row.status)
    })
}
