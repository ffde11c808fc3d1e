//! How tightly a sheet can be rolled: the largest curvature of either sign along a direction.
//!
//! Images are turned about one axis across the direction u (`docs/theory/roll.md`). κ is the turn for each unit of length of the written
//! sheet along u, and F = (1 + l1) u uᵀ + (1 + l2) w wᵀ + γ w uᵀ: lines of the sheet along the axis w stay along it. The height of the
//! elements and l1 with κ are one geometry in many ways, so the first element's place is held, over the axis, and l1 is free in any case. l2 and γ
//! are held at given values or left to the sheet; a start is first strained to them, flat. Nothing bounds κ by links: where it stops rings crowd
//! each other, and the most that is claimed is `local`.
//!
//! Starts are the written state, flat states that are stretched and pressed as far as they go, and those that are drawn.

use super::{
    local::LocalSolution,
    multistart::{CellStarts, Entered, FollowedWaves, LargerCells, Multistart, SearchResult, Target, verdict},
    options::{ExtremeOptions, FEASIBLE, STRAIGHT},
    starts::{Start, Use, perturbed, rng},
    stop::StopRule,
};
use crate::{
    answer::{Answer, CellTrend},
    lattice::{Across, Cell, Direction},
    model::{Model, of_cell},
    program::{LatticeFamily, Parameter, SheetProgram},
    question::RollStrains,
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::{Pose, Roll, State},
    topology::{links_kept, winding::winds},
};
use maille_geometry::Vec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curl {
    /// u, the direction that is rolled.
    pub direction: Direction,
    /// Sign of the curvature: 1 where the axis lies below the sheet.
    pub sign: f64,
    /// What is held of l2, the width along the axis, and of the shear γ.
    pub strains: RollStrains,
}

/// Nearer to the axis than this an element lies on it, in R.
const ON_AXIS: f64 = 1e-6;
/// See [`is_on_axis`].
pub(super) const ON_AXIS_NOTE: &str = "the first element lies on the axis: whether it could move off it is not known";

/// Whether the first element lies on the axis: there its place is no longer held without loss.
pub(super) fn is_on_axis(model: &Model, state: &State) -> bool {
    state.axis_distance(0, model.elements[0].anchor).is_some_and(|away| away < ON_AXIS)
}

impl Curl {
    /// Rates of the lattice with l1, l2 and γ.
    fn rates(&self, model: &Model) -> [[Vec3; 2]; 3] {
        let (u, w) = (self.direction.along().push(0.0), self.direction.across().push(0.0));
        [(u, u), (w, w), (w, u)].map(|(to, of)| [model.start.a1, model.start.a2].map(|a| to * of.dot(&a)))
    }

    /// l1 and what else is free, each with its weight in what is maximised.
    fn strains(&self, model: &Model, weights: [f64; 3]) -> Vec<Parameter> {
        let Across { lateral_free, shear_free } = self.strains.free;
        let free = [true, lateral_free, shear_free];
        let of = |(rate, weight): ([Vec3; 2], f64)| Parameter { rate, weight, ..Parameter::default() };
        let all = self.rates(model).into_iter().zip(weights).map(of);
        all.zip(free).filter(|(_, free)| *free).map(|(parameter, _)| parameter).collect()
    }

    /// The lattice vectors where all parameters are 0.
    fn base(&self, model: &Model) -> [Vec3; 2] {
        let ([_, lateral, shear], RollStrains { l2, shear: gamma, .. }) = (self.rates(model), self.strains);
        let written = [model.start.a1, model.start.a2];
        [0, 1].map(|k| written[k] + lateral[k] * l2 + shear[k] * gamma)
    }

    /// Strains a flat state until what is held has its values; gives it with the quadratic programs that took, and `None` where the sheet locks
    /// before.
    fn strained(&self, model: &Model, state: State, cancel: &AtomicBool) -> (Option<State>, u64) {
        let (u, w) = (self.direction.along(), self.direction.across());
        let f = state.deformation_gradient(model);
        let RollStrains { free, l2, shear } = self.strains;
        let missing = |free: bool, held: f64, now: f64| if free { 0.0 } else { held - now };
        let wider = missing(free.lateral_free, l2, w.dot(&(f * w)) - 1.0);
        let leaning = missing(free.shear_free, shear, w.dot(&(f * u)));
        // A rolled state of another direction has other images: it is taken as it is, and the search mends what then overlaps.
        let is_rolled = state.roll.is_some_and(|roll| roll.turn_rad != [0.0; 2]);
        if is_rolled || wider.abs().max(leaning.abs()) < HELD {
            return (Some(state), 0);
        }
        let [_, lateral, shearing] = self.rates(model);
        let rate = [0, 1].map(|k| lateral[k] * wider + shearing[k] * leaning);
        let share = Parameter { rate, weight: 1.0, most: Some(1.0), ..Parameter::default() };
        let parameters: Vec<Parameter> = std::iter::once(share).chain(self.strains(model, [0.0; 3])).collect();
        let zero = vec![0.0; parameters.len()];
        let family = LatticeFamily { base: [state.a1, state.a2], parameters, metric: None, roll: state.roll };
        let program = SheetProgram::new(model, &family);
        let options = SqpOptions { enough: 1.0 - REACHED, ..SqpOptions::default() };
        let end = maximize(&program, program.posed(state, zero), Vec::new(), &options, cancel);
        let there = end.point.p[0] >= 1.0 - HELD && end.violation < FEASIBLE;
        (there.then_some(end.point.state), end.iterations as u64)
    }

    /// How far the sheet is stretched in a state that is not, or so rolled.
    fn parameters(&self, model: &Model, state: &State) -> Vec<f64> {
        let (u, w) = (self.direction.along(), self.direction.across());
        let f = state.deformation_gradient(model);
        let curvature = state.roll.map_or(0.0, |roll| self.sign * roll.curvature(&model.reference_inverse));
        let along = u.dot(&(f * u)) - 1.0;
        let lateral = self.strains.free.lateral_free.then(|| w.dot(&(f * w)) - 1.0);
        let shear = self.strains.free.shear_free.then(|| w.dot(&(f * u)));
        [Some(curvature), Some(along), lateral, shear].into_iter().flatten().collect()
    }

    /// The written state, and the same stretched and pressed, flat, along each strain that is free.
    pub(super) fn usual_starts(&self, model: &Model, seed: u64, cancel: &AtomicBool) -> Vec<Start> {
        let straight = perturbed(model, &model.start, STRAIGHT, &mut rng(seed, Use::Start, u64::from(u32::MAX)));
        let mut out = vec![Start::written(straight)];
        for k in 0..3 {
            for sign in [1.0, -1.0] {
                let mut weights = [0.0; 3];
                weights[k] = sign;
                let parameters = self.strains(model, weights);
                if parameters.iter().all(|parameter| parameter.weight == 0.0) {
                    continue;
                }
                let base = [model.start.a1, model.start.a2];
                let zero = vec![0.0; parameters.len()];
                let family = LatticeFamily { base, parameters, metric: None, roll: None };
                let program = SheetProgram::new(model, &family);
                let mut stream = rng(seed, Use::Start, u64::from(u32::MAX) - out.len() as u64);
                let state = perturbed(model, &model.start, STRAIGHT, &mut stream);
                // Only where it leads to matters.
                let options = SqpOptions { pause_at: FLAT_PAUSE, ..SqpOptions::default() };
                let end = maximize(&program, program.posed(state, zero), Vec::new(), &options, cancel);
                out.push(Start::written(end.point.state));
            }
        }
        out
    }
}

/// A flat state is stretched until its steps are shorter than this.
const FLAT_PAUSE: f64 = 1e-2;
/// What is to be reached is, where it is short by this share.
pub(super) const REACHED: f64 = 1e-12;
/// Strains within this of a value are held at it.
const HELD: f64 = 1e-9;

impl Target for Curl {
    /// κ first, then l1, and what else is free.
    fn family(&self, model: &Model) -> LatticeFamily {
        let (base, u) = (self.base(model), self.direction.along());
        let written = [model.start.a1, model.start.a2];
        let curvature =
            Parameter { turn_rad: written.map(|a| self.sign * a.xy().dot(&u)), weight: 1.0, ..Parameter::default() };
        let parameters = std::iter::once(curvature).chain(self.strains(model, [0.0; 3])).collect();
        LatticeFamily { base, parameters, metric: None, roll: Some(Roll::flat(u)) }
    }

    /// A flat state is brought to where it is rolled about. The first element's place is held, so it is put over the axis: held beside the axis it could
    /// not come nearer to it than it is then.
    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered {
        let mut state = start.state;
        if state.roll.is_none() {
            let own = |(pose, e): (&Pose, &crate::model::Element)| state.motion_to(e.anchor).back(&pose.position);
            let places: Vec<Vec3> = state.poses.iter().zip(&model.elements).map(own).collect();
            let height = places.iter().map(|place| place.z).sum::<f64>() / places.len() as f64;
            let origin = places[0].xy().push(height);
            state.poses.iter_mut().for_each(|pose| pose.position -= origin);
        }
        let (state, iterations) = self.strained(model, state, cancel);
        let Some(state) = state else { return Entered { at: None, iterations } };
        let p = self.parameters(model, &state);
        let family = self.family(model);
        // A state of another direction has other images.
        let linked = || links_kept(model, &SheetProgram::new(model, &family).posed(state.clone(), p.clone()).state);
        let kept = state.roll.is_none() || linked();
        Entered { at: kept.then_some((state, p)), iterations }
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

/// Searches for the largest curvature on the current thread pool. The value is κ in 1/R, with its sign. The result does not depend on the
/// number of threads.
pub(crate) fn tightest_roll(models: &[Model], target: Curl, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
    let model = &models[0];
    let search = Multistart { target: &target, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let stop = StopRule::of(options.effort, options.starts);
    let given = target.usual_starts(model, options.seed, cancel);
    let first = search.run(model, given, stop);
    in_larger_cells(&search, models, first, stop.of_larger_cell(false))
}

/// The same from one state of a cell alone.
pub(crate) fn roll_from(
    models: &[Model],
    (cell, state): (Cell, State),
    target: Curl,
    options: &ExtremeOptions,
    cancel: &AtomicBool,
) -> Answer {
    let one;
    let models = if cell == models[0].cell {
        models
    } else {
        one = [of_cell(models, cell).into_owned()];
        &one
    };
    let search = Multistart { target: &target, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let first = search.run(&models[0], vec![Start::written(state)], StopRule::given_only());
    in_larger_cells(&search, models, first, 0)
}

/// Goes on to larger cells where an element presses on its own image.
fn in_larger_cells(search: &Multistart<'_, Curl>, models: &[Model], first: SearchResult, own_starts: u64) -> Answer {
    let target = search.target;
    let rule = LargerCells {
        every: false,
        own_starts,
        waves: FollowedWaves::None,
        where_none: false,
        fallback: None,
        beyond: f64::NEG_INFINITY,
        neighbours: &CellStarts::default(),
    };
    let found = search.larger_cells(models, first, &rule);
    let model = found.model(models).clone();
    target.answered(&model, found.result, found.by_cell, search.cancel.load(Ordering::Relaxed))
}

impl Curl {
    /// The answer of what a search found in the cell of `model`.
    fn answered(&self, model: &Model, mut result: SearchResult, by_cell: Vec<CellTrend>, interrupted: bool) -> Answer {
        let by_cell = by_cell.into_iter().map(|t| CellTrend { value: t.value.map(|value| self.sign * value), ..t });
        let by_cell = by_cell.collect();
        let best = result.best.take();
        let counted = |answer: Answer| Answer { by_cell, ..result.counted(answer) };
        let Some(best) = best else {
            let status = if interrupted { Status::Interrupted } else { Status::NotConverged };
            return counted(Answer::new(model, status));
        };
        let outside = !winds(model, &best.state);
        let on_axis = is_on_axis(model, &best.state);
        let status = match () {
            () if interrupted => Status::Interrupted,
            () if outside || on_axis => Status::Uncertified,
            () => verdict(&best, f64::INFINITY),
        };
        let note = match () {
            () if outside => Some("the axis comes to pass through the sheet: nothing else stops the roll".to_owned()),
            () if on_axis => Some(ON_AXIS_NOTE.to_owned()),
            () => None,
        };
        let value = Some(self.sign * best.value());
        let gradient = best.state.deformation_gradient(model);
        counted(Answer { value, gradient, note, ..Answer::new(model, status) }).with_solution(model, best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lattice::Cell,
        search::local::{Course, local_maximize},
    };

    /// The largest l1 with the images of a flat sheet, or of a rolled one whose κ is held, from the written state or from another.
    fn stretch(model: &Model, curl: &Curl, held: Option<f64>, from: Option<&LocalSolution>) -> Option<LocalSolution> {
        let mut family = curl.family(model);
        let curvature = family.parameters.remove(0);
        family.parameters[0].weight = 1.0;
        family.roll =
            family.roll.zip(held).map(|(roll, k)| Roll { turn_rad: curvature.turn_rad.map(|t| t * k), ..roll });
        let straight = || perturbed(model, &model.start, STRAIGHT, &mut rng(1, Use::Start, 0));
        let (state, p) = from.map_or_else(
            || (straight(), vec![0.0; family.parameters.len()]),
            |from| (from.state.clone(), from.p.clone()),
        );
        let mut program = SheetProgram::new(model, &family);
        let x = program.posed(state, p);
        let stream = &mut rng(1, Use::Restart, 0);
        let course = Course { restarts: 3, first_radius: 0.1, floor: f64::NEG_INFINITY };
        let (found, _) = local_maximize(model, &mut program, x, course, stream, &AtomicBool::new(false));
        found.filter(|found| found.certified)
    }

    fn model(name: &str) -> Model {
        let design = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
        // Models of the crate that is tested, by what the design says.
        let text = serde_json::to_string(&design).unwrap();
        Model::compile(&serde_json::from_str(&text).unwrap(), Cell::PRIMITIVE).unwrap()
    }

    /// Sheets whose flat limits have a motion that costs nothing, which κ drives until one more contact closes. Its force is proportional to κ, and
    /// too small to be told from none below this κ: so much is held for a little.
    const DRIVEN: [(&str, f64); 2] = [("cages", 1e-3), ("octahedra", 1e-3)];

    /// With κ held at 0 the limits are those of a flat sheet, and with little κ they are near them: all built-in sheets, from the flat limit, each in
    /// one of three ways. Pairs that touch along whole circles nearly do with little κ, and then have no certificate.
    #[test]
    fn a_roll_without_curvature_is_flat() {
        flat_again(|k, name| if name == SLOW { vec![] } else { vec![WAYS[k % WAYS.len()]] });
    }

    #[test]
    #[ignore = "two minutes"]
    fn a_roll_without_curvature_is_flat_in_all_ways() {
        flat_again(|_, _| WAYS.to_vec());
    }

    /// Takes as long as all others.
    const SLOW: &str = "ellipses";

    /// A direction, in degrees, and whether width and shear are free.
    const WAYS: [(f64, bool); 3] = [(0.0, false), (35.0, false), (90.0, true)];

    fn flat_again(ways: impl Fn(usize, &str) -> Vec<(f64, bool)>) {
        let mut lost = Vec::new();
        for (k, name) in maille_io::builtin_designs().iter().map(|design| design.name).enumerate() {
            let model = model(name);
            if model.single {
                continue;
            }
            for (direction_deg, lateral_free) in ways(k, name) {
                let free = Across { lateral_free, shear_free: lateral_free };
                let strains = RollStrains::free(free);
                let curl = Curl { direction: Direction::of_degrees(direction_deg), sign: 1.0, strains };
                let Some(flat) = stretch(&model, &curl, None, None) else { continue };
                let driven = DRIVEN.iter().find(|(driven, _)| *driven == name);
                let little = driven.map_or((1e-7, 1e-5), |(_, held)| (*held, *held));
                for (held, within) in [(0.0, 1e-9), (1e-12, 1e-9), little] {
                    let rolled = stretch(&model, &curl, Some(held), Some(&flat)).map(|found| found.value());
                    match rolled {
                        Some(value) => assert!(
                            (value - flat.value()).abs() < within,
                            "{name} {direction_deg} {held}: {value} {}",
                            flat.value()
                        ),
                        None if held > 1e-9 && !flat.flat.is_empty() => {}
                        None => lost.push((name, direction_deg, held)),
                    }
                }
            }
        }
        assert!(lost.is_empty(), "{lost:?}");
    }
}
