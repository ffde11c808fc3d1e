//! `states.jsonl`.

use super::error::{RecordError, complete};
use maille::{
    model::Model,
    record::{PoseRecord, StateRecord},
    state::{Pose, State},
};
use maille_geometry::Vec3;
use nalgebra::{Quaternion, UnitQuaternion};

/// The states as text, one a line.
///
/// Fails with [`RecordError::NotFinite`] on a number that JSON cannot hold.
pub fn write_states(states: &[StateRecord]) -> Result<String, RecordError> {
    let mut out = String::new();
    for state in states {
        finite(state)?;
        out.push_str(&serde_json::to_string(state).expect("a state has no map with odd keys"));
        out.push('\n');
    }
    Ok(out)
}

/// Reads the states; `file` is the name to show in errors.
pub fn read_states(file: &str, text: &str) -> Result<Vec<StateRecord>, RecordError> {
    complete(file, text)?;
    let read = |(i, line): (usize, &str)| serde_json::from_str(line).map_err(|e| RecordError::json(file, i + 1, &e));
    text.lines().enumerate().map(read).collect()
}

/// The state of a line, for the model of its cell; `None` where it has other elements.
pub(crate) fn state_at(model: &Model, record: &StateRecord) -> Option<State> {
    let names = model.elements.iter().map(|e| e.name.as_str());
    if !record.poses.iter().map(|p| p.element.as_str()).eq(names) {
        return None;
    }
    let length = |x: [f64; 3]| Vec3::from(x) / model.unit;
    let pose = |p: &PoseRecord| {
        let [w, x, y, z] = p.rotation;
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        Pose { position: length(p.position), rotation }
    };
    Some(State { poses: record.poses.iter().map(pose).collect(), a1: length(record.a1), a2: length(record.a2) })
}

fn finite(state: &StateRecord) -> Result<(), RecordError> {
    let check = |field: &'static str, numbers: &[f64]| match numbers.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(RecordError::NotFinite { direction_deg: state.direction_deg, l2: state.l2, field, value }),
    };
    check("direction_deg", &[state.direction_deg])?;
    check("l2", &[state.l2])?;
    check("a1", &state.a1)?;
    check("a2", &state.a2)?;
    check("deformation_gradient", state.deformation_gradient.as_flattened())?;
    for pose in &state.poses {
        check("position", &pose.position)?;
        check("rotation", &pose.rotation)?;
    }
    check("residual", state.residual.as_slice())
}
