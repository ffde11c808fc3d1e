//! The steps of one run of the energy method, one after the other: how long each took, or how far it went (Figure 6.1 of the
//! thesis).

use super::chart::{Chart, Point, Series, hollow_note, sample};
use super::compare::{captions, differences, l2_label, title};
use super::frame::{Entry, Frame, INK, Layout};
use super::look::{self, Look};
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::record::StepRecord;

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

/// The plot of one record or several, as SVG; of each l2 the first direction. `None` where no record kept its steps.
pub fn run_svg(records: &[NamedRecord], shown: OfStep, layout: Layout) -> Option<String> {
    let kept: Vec<NamedRecord> = records
        .iter()
        .filter(|named| named.record.states.iter().any(|state| !state.steps.is_empty()))
        .cloned()
        .collect();
    let (apart, labels) = differences(&kept);
    let states = || {
        kept.iter().enumerate().flat_map(|(i, named)| {
            let with_row = |state: &&maille::record::StateRecord| {
                let same =
                    |row: &maille::record::LimitRow| (row.direction_deg, row.l2) == (state.direction_deg, state.l2);
                !state.steps.is_empty() && named.record.rows.iter().any(same)
            };
            named.record.states.iter().filter(with_row).map(move |state| (i, state))
        })
    };
    let mut l2: Vec<f64> = states().map(|(_, state)| state.l2).collect();
    l2.sort_by(f64::total_cmp);
    l2.dedup();
    let (of_l2, of_record) = (look::of_l2(&l2), look::of_records(kept.len()));
    let look = |record: usize, k: usize| match (kept.len(), l2.len()) {
        (1, _) => of_l2[k].clone(),
        (_, 1) => of_record[record].clone(),
        _ => of_record[record].with_l2(&of_l2[k]),
    };
    let mut chosen = Vec::new();
    for i in 0..kept.len() {
        for (k, l2) in l2.iter().enumerate() {
            let first = states().find(|(record, state)| *record == i && state.l2 == *l2);
            chosen.extend(first.map(|(_, state)| (look(i, k), state, furthest(&state.steps))));
        }
    }
    let values: Vec<f64> = chosen.iter().flat_map(|(_, _, steps)| steps.iter().map(|step| shown.of(step))).collect();
    if values.is_empty() {
        return None;
    }
    let y = Axis::of_effort(&values);
    let point = |(n, step): (usize, &&StepRecord)| {
        let value = shown.of(step);
        let drawn = !y.is_logarithmic() || value > 0.0;
        Point { x: (n + 1) as f64, y: drawn.then_some(value), hollow: step.perturbed }
    };
    let series: Vec<Series> = chosen
        .iter()
        .map(|(look, _, steps)| Series { look: look.clone(), points: steps.iter().enumerate().map(point).collect() })
        .collect();
    let mut legend = Vec::new();
    if kept.len() > 1 {
        legend.push(Entry::Heading(apart));
        legend.extend(labels.iter().zip(&of_record).map(|(label, look)| sample(look, true, l2.len() == 1, label)));
    }
    legend.push(Entry::Heading("l₂ across the pull".into()));
    legend.extend(l2.iter().zip(&of_l2).map(|(l2, look)| match kept.len() {
        1 => sample(look, true, true, &l2_label(*l2)),
        _ => sample(&Look { color: INK.into(), ..look.clone() }, false, true, &l2_label(*l2)),
    }));
    if series.iter().any(|series| series.points.iter().any(|point| point.hollow)) {
        legend.push(hollow_note("after a perturbation"));
    }
    let mut caption = captions(&kept, &labels);
    caption
        .push("Of each limit the run towards the first target that it misses: the sheet is pulled out fully.".into());
    if shown == OfStep::Size {
        caption.push("Size: the farthest that an element or a lattice vector moved in the step.".into());
    }
    let mut directions: Vec<f64> = chosen.iter().map(|(_, state, _)| state.direction_deg).collect();
    directions.dedup();
    caption.extend((directions.len() == 1).then(|| format!("Pulled along {}°.", directions[0])));
    let scale = if y.is_logarithmic() { ", logarithmic" } else { "" };
    let (subtitle, axis) = match shown {
        OfStep::Time => ("Time of each step of one run", "Wall time of the step (ms"),
        OfStep::Size => ("Size of each step of one run", "Size of the step (R"),
    };
    let longest = chosen.iter().map(|(_, _, steps)| steps.len()).max().unwrap_or(1);
    let chart = Chart {
        frame: Frame { title: title(&kept), subtitle: subtitle.into(), legend, caption },
        x: Axis::linear([0.0, longest as f64].into_iter()),
        names: ["Step of the run (Newton iteration)".into(), format!("{axis}{scale})")],
        y,
        series,
        bands: Vec::new(),
    };
    Some(chart.svg(layout))
}
