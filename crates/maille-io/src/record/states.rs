//! `states.jsonl`.

use super::error::{RecordError, complete};
use maille::record::{RollRecord, StateRecord};

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

fn finite(state: &StateRecord) -> Result<(), RecordError> {
    let check = |field: &'static str, numbers: &[f64]| match numbers.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(RecordError::NotFinite { direction_deg: state.direction_deg, l2: state.l2, field, value }),
    };
    check("direction_deg", &[state.direction_deg])?;
    check("l2", &[state.l2])?;
    check("a1", &state.a1)?;
    check("a2", &state.a2)?;
    if let Some(RollRecord { along, turn_rad }) = &state.roll {
        check("along", along)?;
        check("turn_rad", turn_rad)?;
    }
    check("deformation_gradient", state.deformation_gradient.as_flattened())?;
    for pose in &state.poses {
        check("position", &pose.position)?;
        check("rotation", &pose.rotation)?;
    }
    check("residual", state.residual.as_slice())
}
