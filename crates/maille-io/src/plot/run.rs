//! The steps of one run of the energy method, one after the other: how long each took, or how far it went (Figure 6.1 of the
//! thesis).

use super::chart::{Chart, Point, Series, hollow_note};
use super::compare::{captions, differences, title};
use super::frame::{Frame, Layout};
use super::records::Looks;
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::record::{StateRecord, StepRecord};

/// What is shown of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfStep {
    /// Its wall time, in ms.
    Time,
    /// The farthest that an element or a lattice vector moved in it, in R.
    Size,
}

impl OfStep {
    fn of(self, step: &StepRecord) -> f64 {
        match self {
            OfStep::Time => 1000.0 * step.wall_s,
            OfStep::Size => step.size,
        }
    }
}

/// The run of a limit that pulls furthest: towards the first target that is out of reach.
fn furthest(steps: &[StepRecord]) -> Vec<&StepRecord> {
    let most = steps.iter().max_by(|a, b| a.l1.total_cmp(&b.l1).then(b.run.cmp(&a.run)));
    most.map_or(Vec::new(), |most| steps.iter().filter(|step| step.run == most.run).collect())
}

/// The states of a record that kept their steps, of limits that it shows.
fn kept(named: &NamedRecord) -> impl Iterator<Item = &StateRecord> {
    let rows = &named.record.rows;
    let shown = |state: &StateRecord| rows.iter().any(|r| (r.direction_deg, r.l2) == (state.direction_deg, state.l2));
    named.record.states.iter().filter(move |state| !state.steps.is_empty() && shown(state))
}

/// The plot of one record or several, as SVG; of each l2 the first direction. `None` where no record kept its steps.
pub fn run_svg(records: &[NamedRecord], shown: OfStep, layout: Layout) -> Option<String> {
    let with_steps = |named: &&NamedRecord| named.record.states.iter().any(|state| !state.steps.is_empty());
    let records: Vec<NamedRecord> = records.iter().filter(with_steps).cloned().collect();
    let apart = differences(&records);
    let mut l2: Vec<f64> = records.iter().flat_map(kept).map(|state| state.l2).collect();
    l2.sort_by(f64::total_cmp);
    l2.dedup();
    let looks = Looks::new(records.len(), l2);
    let mut chosen = Vec::new();
    for (i, named) in records.iter().enumerate() {
        for (k, l2) in looks.l2.iter().enumerate() {
            let first = kept(named).find(|state| state.l2 == *l2);
            chosen.extend(first.map(|state| (looks.of(i, k), state.direction_deg, furthest(&state.steps))));
        }
    }
    let values: Vec<f64> = chosen.iter().flat_map(|(_, _, steps)| steps.iter().map(|step| shown.of(step))).collect();
    if values.is_empty() {
        return None;
    }
    let y = Axis::of_effort(&values);
    let point = |(n, step): (usize, &&StepRecord)| Point {
        x: (n + 1) as f64,
        y: y.shown(shown.of(step)),
        hollow: step.perturbed,
    };
    let series: Vec<Series> = chosen
        .iter()
        .map(|(look, _, steps)| Series { look: look.clone(), points: steps.iter().enumerate().map(point).collect() })
        .collect();
    let mut legend = looks.full_legend(&apart);
    if series.iter().any(|series| series.points.iter().any(|point| point.hollow)) {
        legend.push(hollow_note("after a perturbation"));
    }
    let mut caption = captions(&records, &apart.1);
    caption
        .push("Of each limit the run towards the first target that it misses: the sheet is pulled out fully.".into());
    if shown == OfStep::Size {
        caption.push("Size: the farthest that an element or a lattice vector moved in the step.".into());
    }
    let mut directions: Vec<f64> = chosen.iter().map(|(_, direction, _)| *direction).collect();
    directions.dedup();
    caption.extend((directions.len() == 1).then(|| format!("Pulled along {}°.", directions[0])));
    let (subtitle, axis) = match shown {
        OfStep::Time => ("Time of each step of one run", "Wall time of the step (ms"),
        OfStep::Size => ("Size of each step of one run", "Size of the step (R"),
    };
    let longest = chosen.iter().map(|(_, _, steps)| steps.len()).max().unwrap_or(1);
    let frame = Frame { title: title(&records), subtitle: subtitle.into(), legend, caption };
    let names = ["Step of the run (Newton iteration)".into(), format!("{axis}{})", y.words())];
    let axes = [Axis::linear([0.0, longest as f64].into_iter()), y];
    Some(Chart::of_lines(frame, axes, names, series).svg(layout))
}
