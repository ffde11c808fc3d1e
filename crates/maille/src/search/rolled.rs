//! Sheets whose turn is given: closed tubes, a sheet that goes round an axis, its copies after a whole turn the same elements; and sheets of
//! given curvature.
//!
//! N times the shortest lattice vector v along the direction goes once round a tube, so the turn for each unit of the written length is
//! κ = 2π / (N |v|). The shear is 0, or the tube would not close; l1 is free, and l2 where it is not held. Elements that count for
//! each other are at most half a turn apart, which names each pair of the tube once. What is sought is the state with the widest gaps, or
//! the largest or least length along the axis or radius of the neutral surface.
//!
//! A start is first rolled until its turn is the given one, as in [`super::curl`].

use super::{
    curl::{Curl, ON_AXIS_NOTE, REACHED, is_on_axis},
    local::LocalSolution,
    multistart::{Entered, Multistart, SearchResult, Target, verdict},
    options::{ExtremeOptions, FEASIBLE},
    starts::Start,
    stop::StopRule,
};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    question::{Goal, OfRolled, Question, Turn},
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::{Roll, State},
    topology::{links_kept, smallest_gap, winding::winds},
};
use maille_design::InvalidInput;
use std::{
    f64::consts::TAU,
    sync::atomic::{AtomicBool, Ordering},
};

/// What is sought of a sheet whose turn is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rolled {
    /// How it is rolled.
    curl: Curl,
    /// Turn for each unit of the written length, in 1/R.
    curvature: f64,
    /// What is as large as can be, or as small.
    sought: OfRolled,
    /// 1 for the largest, −1 for the least.
    sense: f64,
}

impl Rolled {
    /// That of a question on a sheet whose turn is given.
    ///
    /// # Errors
    /// Of another question; of a tube where no lattice vector lies along the direction, or the cell of `model` does not fit into it.
    pub(crate) fn new(model: &Model, question: &Question) -> Result<Self, InvalidInput> {
        let Goal::Rolled { direction_deg, above, turn, strains, sought } = question.goal else {
            return Err(InvalidInput::new("goal", "no turn is given", "ask for something of a rolled sheet"));
        };
        let curvature = match turn {
            Turn::Cells(cells) => TAU / around(model, direction_deg, cells)?,
            Turn::Curvature(curvature) => curvature,
        };
        let (direction, sign) = (Direction::of_degrees(direction_deg), if above { -1.0 } else { 1.0 });
        Ok(Rolled { curl: Curl { direction, sign, strains }, curvature, sought, sense: question.sense.sign() })
    }
}

/// The written length of so many of the shortest lattice vectors along the direction.
fn around(model: &Model, direction_deg: f64, cells: u32) -> Result<f64, InvalidInput> {
    let primitive = model.cell.primitive(model.start.a1, model.start.a2);
    let Some(vector) = Direction::of_degrees(direction_deg).shortest_vector(primitive) else {
        let [first, second] = primitive.map(|a| a.y.atan2(a.x).to_degrees());
        let problem =
            format!("no lattice vector lies along {direction_deg}\u{b0}, so that no number of cells goes round");
        let help =
            format!("take a direction of the lattice: a1 lies along {first:.6}\u{b0}, a2 along {second:.6}\u{b0}");
        return Err(InvalidInput::new("direction_deg", problem, help));
    };
    let around = (primitive[0] * f64::from(vector[0]) + primitive[1] * f64::from(vector[1])) * f64::from(cells);
    let steps = model.reference_inverse * around.xy();
    let fits = (steps - steps.map(f64::round)).norm() < 1e-6;
    if !fits {
        let problem = format!("{cells} cells along {direction_deg}\u{b0} are not whole cells of {}", model.cell);
        return Err(InvalidInput::new("cells", problem, "take another number of cells, or the cell 1x1"));
    }
    Ok(around.norm())
}

impl Target for Rolled {
    /// What is sought, then l1 and what else is free.
    fn family(&self, model: &Model) -> LatticeFamily {
        let mut family = self.curl.family(model);
        let curvature = family.parameters.remove(0);
        let sought = match self.sought {
            OfRolled::Gap => Parameter { widen: 1.0, ..Parameter::default() },
            OfRolled::Radius => Parameter { radius_sign: self.sense, ..Parameter::default() },
            OfRolled::Length => {
                let width = family.parameters.remove(1);
                Parameter { rate: width.rate.map(|rate| rate * self.sense), ..width }
            }
        };
        family.parameters.insert(0, Parameter { weight: 1.0, ..sought });
        let turn_rad = curvature.turn_rad.map(|rate| rate * self.curvature);
        family.roll = family.roll.map(|roll| Roll { turn_rad, ..roll });
        family
    }

    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered {
        let Entered { at, iterations } = self.curl.enter(model, start, cancel);
        let Some((state, p)) = at else { return Entered { at: None, iterations } };
        let mut family = self.curl.family(model);
        family.parameters[0].most = Some(self.curvature);
        let program = SheetProgram::new(model, &family);
        let enough = self.curvature * (1.0 - REACHED);
        let options = SqpOptions { enough, ..SqpOptions::default() };
        let mut end = maximize(&program, program.posed(state, p), Vec::new(), &options, cancel);
        let iterations = iterations + end.iterations as u64;
        let (state, turned) = (end.point.state, end.point.p[0]);
        let there = turned >= self.curvature * (1.0 - 1e-6) && end.violation < FEASIBLE;
        if !there || !winds(model, &state) || !links_kept(model, &state) {
            return Entered { at: None, iterations };
        }
        let mut p = end.point.p.split_off(1);
        let sought = match self.sought {
            OfRolled::Gap => smallest_gap(model, &state).map_or(0.0, |(gap, _)| gap.min(0.0)),
            OfRolled::Length => self.sense * p.remove(1),
            OfRolled::Radius => self.sense * state.neutral_surface_of(model).map_or(0.0, |surface| surface.radius),
        };
        p.insert(0, sought);
        Entered { at: Some((state, p)), iterations }
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

/// Searches for what is sought of a rolled sheet on the current thread pool, or finds it from one state alone. The value is the gap, l2, or the
/// radius of the neutral surface, in R.
pub(crate) fn rolled(
    model: &Model,
    target: Rolled,
    from: Option<State>,
    options: &ExtremeOptions,
    cancel: &AtomicBool,
) -> Answer {
    let search = Multistart { target: &target, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let mut found: SearchResult = if let Some(state) = from {
        search.run(model, vec![Start::written(state)], StopRule::given_only())
    } else {
        let given = target.curl.usual_starts(model, options.seed, cancel);
        search.run(model, given, StopRule::of(options.effort, options.starts))
    };
    let interrupted = cancel.load(Ordering::Relaxed);
    let Some(best) = found.best.take() else {
        let status = if interrupted { Status::Interrupted } else { Status::NotConverged };
        let note = Some("no start could be rolled so far: that no such state exists is not proved".to_owned());
        return found.counted(Answer { note, ..Answer::new(model, status) });
    };
    let on_axis = is_on_axis(model, &best.state);
    let status = match () {
        () if interrupted => Status::Interrupted,
        () if on_axis => Status::Uncertified,
        () => verdict(&best, f64::INFINITY),
    };
    let note = on_axis.then(|| ON_AXIS_NOTE.to_owned());
    let sense = if target.sought == OfRolled::Gap { 1.0 } else { target.sense };
    let (value, gradient) = (Some(sense * best.value()), best.state.deformation_gradient(model));
    found.counted(Answer { value, gradient, note, ..Answer::new(model, status) }).with_solution(model, best)
}
