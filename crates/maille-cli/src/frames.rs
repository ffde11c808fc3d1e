//! The states of a source that are written: one, or a series.

use crate::source::Source;
use maille::state::State;

/// One state of a series.
pub struct Frame {
    /// The poses.
    pub state: State,
    /// Part of the way to the locked state.
    pub time: f64,
    /// Added to the names of files.
    pub suffix: String,
    /// What it is, in words.
    pub description: String,
}

impl Source {
    /// The states to write: one, or `count` frames to the locked one.
    pub fn frames(&self, count: Option<u32>) -> Vec<Frame> {
        let title = format!("{} {}", self.design.name, self.design.title);
        let one = |state: &State, time: f64, description: String| Frame {
            state: state.clone(),
            time,
            suffix: String::new(),
            description,
        };
        if let Some((states, shown)) = &self.simulated {
            let Some(count) = count else {
                let place = format!("frame {shown} of {} of a simulated sheet", states.len());
                return vec![one(&states[*shown], 1.0, format!("{title}; {place}"))];
            };
            // As many of the recorded states, spread evenly.
            let count = (count as usize).min(states.len());
            let (last, digits) = (states.len() - 1, count.saturating_sub(1).to_string().len());
            let of = |k: usize| k * last / (count - 1).max(1);
            let frame = |k: usize| Frame {
                suffix: format!("_f{k:0digits$}"),
                ..one(&states[of(k)], of(k) as f64 / last.max(1) as f64, format!("{title}; simulated, frame {}", of(k)))
            };
            return (0..count).map(frame).collect();
        }
        let Some((record, state)) = &self.locked else {
            let place =
                self.extreme.as_ref().map_or_else(|| maille_mesh::state_words(None), |(_, words)| words.clone());
            return vec![one(&self.model.start, 0.0, format!("{title}; {place}"))];
        };
        let place = maille_mesh::state_words(Some(record));
        let Some(count) = count else {
            return vec![one(state, 1.0, format!("{title}; {place}"))];
        };
        let digits = (count - 1).to_string().len();
        let frame = |k: u32| {
            let time = f64::from(k) / f64::from(count - 1);
            Frame {
                state: maille_mesh::between(&self.model.start, state, time),
                suffix: format!("_f{k:0digits$}"),
                time,
                description: format!(
                    "{title}; frame {} of {count} from the starting state to {place}; interpolated, may overlap",
                    k + 1
                ),
            }
        };
        (0..count).map(frame).collect()
    }
}
