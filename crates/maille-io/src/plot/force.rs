//! Force against stretch of simulated sheets: free at first, then a hard stop.

use super::chart::{Chart, Point, Series};
use super::compare::title_of;
use super::frame::{Entry, Frame, Layout};
use super::look;
use super::scale::Axis;
use crate::record::{ForceTable, SimulationRecord};
use maille::relaxation::simulate::End;

/// A simulation and its table, for a plot.
#[derive(Clone, Debug)]
pub struct NamedSimulation {
    /// Its folder.
    pub name: String,
    /// What was done.
    pub record: SimulationRecord,
    /// What held the sheet.
    pub forces: ForceTable,
}

impl NamedSimulation {
    /// Stretch and force of each frame that has both.
    fn curve(&self) -> Vec<(f64, f64)> {
        self.forces.rows.iter().filter_map(|row| Some((row.stretch?, row.mean_force?))).collect()
    }

    /// What became of it, for the legend.
    fn outcome(&self) -> String {
        let stretch = self.curve().last().map_or(1.0, |last| last.0);
        match self.record.outcome.end {
            End::Locked => format!("stops at {stretch:.3}"),
            End::Reached => format!("no stop up to {stretch:.3}"),
            End::NotConverged | End::Interrupted => format!("given up at {stretch:.3}"),
        }
    }

    /// What was done to it, and its parameters.
    fn inputs(&self) -> String {
        let (design, plan) = (&self.record.design, &self.record.setup);
        let unit = design.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
        let vector = |v: &[f64; 3]| v.map(|x| x.to_string()).join(", ");
        let mut words = vec![format!("{} cells", self.record.tile.replace('x', " × "))];
        words.extend(design.minor_radius.map(|r| format!("r = {r}{unit}")));
        words.extend((!plan.fix.is_empty()).then(|| format!("{} held", plan.fix.join(" and "))));
        words.extend(plan.pull.iter().map(|pull| {
            let way: Vec<String> = pull.way.iter().map(|by| format!("({})", vector(by))).collect();
            format!("{} pulled by {}{unit}", pull.place, way.join(", then "))
        }));
        words.extend(plan.gravity.filter(|g| *g != [0.0; 3]).map(|g| format!("gravity ({})", vector(&g))));
        words.push(format!("{} steps", plan.steps));
        words.push(format!("α/β = {:.0e}", plan.alpha));
        words.push(format!("τ = {}", plan.tau));
        words.join("  ·  ")
    }
}

/// Labels of simulations: the design, the cells where designs are alike, and at last the folder.
fn labels(simulations: &[NamedSimulation]) -> Vec<String> {
    let mut labels: Vec<String> = simulations.iter().map(|s| s.record.design.name.clone()).collect();
    let more: [fn(&NamedSimulation) -> String; 2] =
        [|s| format!("{} cells", s.record.tile.replace('x', " × ")), |s| s.name.clone()];
    for more in more {
        let twice = |label: &String| labels.iter().filter(|other| *other == label).count() > 1;
        let alike: Vec<bool> = labels.iter().map(twice).collect();
        for (k, simulation) in simulations.iter().enumerate().filter(|(k, _)| alike[*k]) {
            labels[k] = format!("{}, {}", labels[k], more(simulation));
        }
    }
    labels
}

/// The plot of one simulation or several, as SVG; `None` where no frame has a stretch and a force.
pub fn force_svg(simulations: &[NamedSimulation], layout: Layout) -> Option<String> {
    let labels = labels(simulations);
    let looks = look::of_records(simulations.len());
    let series: Vec<Series> = simulations
        .iter()
        .zip(&looks)
        .map(|(simulation, look)| {
            let point = |(x, force): (f64, f64)| Point { x, y: Some(force), hollow: false };
            Series { look: look.clone(), points: simulation.curve().into_iter().map(point).collect() }
        })
        .collect();
    let points = || series.iter().flat_map(|series| &series.points);
    points().next()?;
    let mut legend = vec![Entry::Heading(if simulations.len() > 1 { "Finite sheet" } else { "Design" }.into())];
    for ((simulation, look), label) in simulations.iter().zip(&looks).zip(&labels) {
        legend.push(Entry::sample(look, true, true, label));
        legend.push(Entry::Note(simulation.outcome()));
    }
    let mut caption: Vec<String> = simulations
        .iter()
        .zip(&labels)
        .map(|(simulation, label)| match simulations.len() {
            1 => format!("{}.", simulation.inputs()),
            _ => format!("{label}:  {}.", simulation.inputs()),
        })
        .collect();
    caption.push(
        "Each marker is a sheet at rest. Free at first: rings give way without a force. Then the sheet locks, and the force \
         rises at once. Rings are rigid: where it rises is the sheet's, how steeply and how high the method's (its contacts \
         and targets; at most 2000 τ on an element without loads)."
            .into(),
    );
    let frame = Frame {
        title: title_of(simulations.iter().map(|simulation| &simulation.record.design)),
        subtitle: "Force against stretch of a finite sheet, pulled step by step".into(),
        legend,
        caption,
    };
    let axes = [Axis::of_stretch(points().map(|point| point.x)), Axis::linear(points().filter_map(|point| point.y))];
    let names = [
        "Stretch: distance between the pulled place and the opposite one, by that at the start".into(),
        "Mean force along the pull on a pulled element (βR/1000, the unit of --force)".into(),
    ];
    Some(Chart::of_lines(frame, axes, names, series).svg(layout))
}
