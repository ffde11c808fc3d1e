//! Closed tubes: a sheet that goes round an axis, its copies after a whole turn the same elements.
//!
//! N times the shortest lattice vector v along the direction goes once round, so the turn for each unit of the written length is
//! κ = 2π / (N |v|). The shear is 0, or the tube would not close; l1 and l2 are free. Elements that count for each other are at most half a turn
//! apart, which names each pair of the tube once. What is sought is the state with the widest gaps, or the largest or least length along the axis
//! or radius of the neutral surface.
//!
//! A start is first rolled until its turn is that of the tube, as in [`super::curl`].

use super::{
    curl::Curl,
    local::LocalSolution,
    multistart::{Entered, Multistart, SearchResult, Target, verdict},
    options::{ExtremeOptions, FEASIBLE, STRAIGHT},
    starts::{Start, Use, perturbed, rng},
    stop::StopRule,
};
use crate::{
    answer::Answer,
    error::InvalidInput,
    lattice::{Across, Direction},
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    question::OfTube,
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::Roll,
    topology::{links_kept, smallest_gap, winding::winds},
};
use std::{
    f64::consts::TAU,
    sync::atomic::{AtomicBool, Ordering},
};

/// A turn that is short by this share is reached.
const REACHED: f64 = 1e-12;

/// What is sought of a tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tube {
    /// The direction that goes round.
    pub direction: Direction,
    /// Sign of the curvature: 1 where the axis lies below the written sheet.
    pub sign: f64,
    /// Turn for each unit of the written length, in 1/R.
    pub curvature: f64,
    /// What is as large as can be, or as small.
    pub sought: OfTube,
    /// 1 for the largest, −1 for the least.
    pub sense: f64,
}

impl Tube {
    /// The tube of so many of the shortest lattice vectors along the direction.
    ///
    /// # Errors
    /// Where no lattice vector lies along it, or the cell of `model` does not fit into it.
    pub(crate) fn new(
        model: &Model,
        direction: Direction,
        sign: f64,
        cells: u32,
        (sought, sense): (OfTube, f64),
    ) -> Result<Self, InvalidInput> {
        let primitive = model.cell.primitive(model.start.a1, model.start.a2);
        let degrees = direction.degrees();
        let Some(vector) = direction.shortest_vector(primitive) else {
            let [first, second] = primitive.map(|a| a.y.atan2(a.x).to_degrees());
            let problem =
                format!("no lattice vector lies along {degrees}\u{b0}, so that no number of cells goes round");
            let help =
                format!("take a direction of the lattice: a1 lies along {first:.6}\u{b0}, a2 along {second:.6}\u{b0}");
            return Err(InvalidInput::new("direction_deg", problem, help));
        };
        let around = (primitive[0] * f64::from(vector[0]) + primitive[1] * f64::from(vector[1])) * f64::from(cells);
        let steps = model.reference_inverse * around.xy();
        let fits = (steps - steps.map(f64::round)).norm() < 1e-6;
        if !fits {
            let problem = format!("{cells} cells along {degrees}\u{b0} are not whole cells of {}", model.cell);
            return Err(InvalidInput::new("cells", problem, "take another number of cells, or the cell 1x1"));
        }
        Ok(Tube { direction, sign, curvature: TAU / around.norm(), sought, sense })
    }

    fn curl(&self) -> Curl {
        Curl { direction: self.direction, sign: self.sign, free: Across { lateral_free: true, shear_free: false } }
    }
}

impl Target for Tube {
    /// What is sought, then l1 and l2.
    fn family(&self, model: &Model) -> LatticeFamily {
        let (base, u) = ([model.start.a1, model.start.a2], self.direction.along());
        let mut strains = self.curl().family(model).parameters.split_off(1);
        let sought = match self.sought {
            OfTube::Gap => Parameter { widen: 1.0, ..Parameter::default() },
            OfTube::Radius => Parameter { radius_sign: self.sense, ..Parameter::default() },
            OfTube::Length => {
                let width = strains.pop().unwrap_or_default();
                Parameter { rate: width.rate.map(|rate| rate * self.sense), ..width }
            }
        };
        let turn_rad = base.map(|a| self.sign * self.curvature * a.xy().dot(&u));
        let parameters = std::iter::once(Parameter { weight: 1.0, ..sought }).chain(strains).collect();
        LatticeFamily { base, parameters, metric: None, roll: Some(Roll { turn_rad, ..Roll::flat(u) }) }
    }

    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered {
        let curl = self.curl();
        let Entered { at: Some((state, p)), iterations } = curl.enter(model, start, cancel) else {
            return Entered { at: None, iterations: 0 };
        };
        let mut family = curl.family(model);
        family.parameters[0].most = Some(self.curvature);
        let program = SheetProgram::new(model, &family);
        let enough = self.curvature * (1.0 - REACHED);
        let options = SqpOptions { enough, ..SqpOptions::default() };
        let end = maximize(&program, program.posed(state, p), Vec::new(), &options, cancel);
        let iterations = iterations + end.iterations as u64;
        let (state, [turned, l1, l2]) = (end.point.state, [end.point.p[0], end.point.p[1], end.point.p[2]]);
        let there = turned >= self.curvature * (1.0 - 1e-6) && end.violation < FEASIBLE;
        if !there || !winds(model, &state) || !links_kept(model, &state) {
            return Entered { at: None, iterations };
        }
        let p = match self.sought {
            OfTube::Gap => vec![smallest_gap(model, &state).map_or(0.0, |(gap, _)| gap.min(0.0)), l1, l2],
            OfTube::Length => vec![self.sense * l2, l1],
            OfTube::Radius => {
                let radius = state.neutral_surface_of(model).map_or(0.0, |surface| surface.radius);
                vec![self.sense * radius, l1, l2]
            }
        };
        Entered { at: Some((state, p)), iterations }
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

/// Searches for what is sought of a tube on the current thread pool. The value is the gap, l2, or the radius of the neutral surface, in R.
pub(crate) fn tube(model: &Model, target: Tube, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
    let search = Multistart { target: &target, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let straight = perturbed(model, &model.start, STRAIGHT, &mut rng(options.seed, Use::Start, u64::from(u32::MAX)));
    let flat = target.curl().flat_starts(model, options.seed, cancel);
    let given = std::iter::once(Start::written(straight)).chain(flat).collect();
    let mut found: SearchResult = search.run(model, given, StopRule::of(options.effort, options.starts));
    let interrupted = cancel.load(Ordering::Relaxed);
    let Some(best) = found.best.take() else {
        let status = if interrupted { Status::Interrupted } else { Status::NotConverged };
        let note = Some("no start could be rolled so far: that no such tube exists is not proved".to_owned());
        return found.counted(Answer { note, ..Answer::new(model, status) });
    };
    let status = if interrupted { Status::Interrupted } else { verdict(&best, f64::INFINITY) };
    let sense = if target.sought == OfTube::Gap { 1.0 } else { target.sense };
    let (value, gradient) = (Some(sense * best.value()), best.state.deformation_gradient(model));
    found.counted(Answer { value, gradient, ..Answer::new(model, status) }).with_solution(model, best)
}
