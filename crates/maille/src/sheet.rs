//! A sheet to which questions are put: a design compiled for its own cell and for larger ones.

use crate::{
    answer::{Answer, CellTrend},
    lattice::{Across, Cell, Direction},
    model::{Model, of_cell},
    program::{Contact, metric::factor},
    question::{Goal, Question, Sense},
    record::Status,
    search::{
        ExactOptions, ExtremeOptions,
        curl::{Curl, tightest_roll},
        extreme::{Extreme, extreme},
        rolled::{Rolled, rolled},
        strain::{StrainMethod, StrainOptions},
        stretch::ExactMethod,
    },
    state::{Pose, State},
    survey::{CellChoice, KnownRoll, RollTask, one, rolls},
};
use maille_design::{Design, InvalidInput};
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Rotation3, UnitQuaternion};
use std::{
    borrow::Cow,
    sync::atomic::{AtomicBool, Ordering},
};

/// A design, compiled for cells of growing size.
#[derive(Clone, Debug)]
pub struct Sheet {
    models: Vec<Model>,
}

impl Sheet {
    /// The sheet of a design: its own cell, and the larger ones to which a search goes on where it has reason to.
    ///
    /// # Errors
    /// Everything that is wrong with the design.
    pub fn compile(design: &Design) -> Result<Self, Vec<InvalidInput>> {
        Self::in_cells(design, CellChoice::Auto)
    }

    /// The same with a choice of cells.
    ///
    /// # Errors
    /// Everything that is wrong with the design; a choice of no cell.
    pub fn in_cells(design: &Design, cells: CellChoice) -> Result<Self, Vec<InvalidInput>> {
        cells.check().map_err(|problem| vec![problem])?;
        let cells = cells.exact_cells(design.elements.len());
        let models = cells.into_iter().map(|cell| Model::compile(design, cell)).collect::<Result<_, _>>()?;
        Ok(Sheet { models })
    }

    /// The design's own cell, or the one that was chosen.
    pub fn model(&self) -> &Model {
        &self.models[0]
    }

    /// The model in whose cell a state of an answer is.
    pub fn model_of(&self, answer: &Answer) -> Cow<'_, Model> {
        of_cell(&self.models, answer.cell)
    }

    /// Whether a question can be asked of this sheet.
    ///
    /// # Errors
    /// What [`Question::check`] and [`Question::suits`] refuse; a tube that does not close.
    pub fn check(&self, question: &Question) -> Result<(), InvalidInput> {
        question.check()?;
        question.suits(self.model())?;
        match question.goal {
            Goal::Rolled { .. } => Rolled::new(self.model(), question).map(drop),
            _ => Ok(()),
        }
    }

    /// The answer to a question, by the exact method, on the current thread pool; it does not depend on the number of threads.
    ///
    /// # Errors
    /// What [`check`](Self::check) refuses.
    pub fn answer(&self, question: &Question) -> Result<Answer, InvalidInput> {
        self.answer_until(question, &AtomicBool::new(false))
    }

    /// The same; after `cancel` the answer comes back as interrupted.
    ///
    /// # Errors
    /// What [`check`](Self::check) refuses.
    pub fn answer_until(&self, question: &Question, cancel: &AtomicBool) -> Result<Answer, InvalidInput> {
        self.check(question)?;
        let Question { effort, starts, seed, sense, .. } = *question;
        let extreme = |what: Extreme, lattice_free: bool| {
            extreme(&self.models[0], what, &ExtremeOptions { lattice_free, effort, starts, seed }, cancel)
        };
        Ok(match question.goal {
            Goal::Stretch { direction_deg, l2, across } => {
                let options = ExactOptions { effort, starts, seed, across, compression: sense == Sense::Least };
                one(&self.models, &options, direction_deg, l2, cancel).1
            }
            Goal::Wire { lattice_free } => extreme(Extreme::ThickestWire, lattice_free),
            Goal::Clearance { lattice_free } => extreme(Extreme::LargestClearance, lattice_free),
            Goal::Area { min_gap } => extreme(Extreme::ClosestCell { gap: min_gap / self.model().unit }, true),
            Goal::Strain { .. } | Goal::Ray { .. } => self.strain(question, cancel)?,
            Goal::Rolled { .. } => {
                let target = Rolled::new(self.model(), question)?;
                rolled(self.model(), target, None, &ExtremeOptions { lattice_free: true, effort, starts, seed }, cancel)
            }
            Goal::Curvature { direction_deg, strains } => {
                let curl = Curl { direction: Direction::of_degrees(direction_deg), sign: sense.sign(), strains };
                let options = ExtremeOptions { lattice_free: true, effort, starts, seed };
                tightest_roll(&self.models, curl, &options, cancel)
            }
        })
    }

    /// Finds the rolls of `tasks` that are not in `known`, with what `question`, one on a curvature or on a rolled sheet, seeks and holds and with
    /// its effort; then hands states on between all of them, and to them from `others`: what else is known of the same turns. `finished` gets each roll as it is found, and again where it goes further, with the
    /// seconds that it took. After `cancel` the rest does not come.
    ///
    /// # Errors
    /// What [`check`](Self::check) refuses of any of them, and a question on something else.
    pub fn rolls(
        &self,
        question: &Question,
        tasks: &[RollTask],
        (known, others): (Vec<KnownRoll>, &[KnownRoll]),
        cancel: &AtomicBool,
        finished: &mut dyn FnMut(RollTask, &Answer, f64),
    ) -> Result<(), InvalidInput> {
        if !matches!(question.goal, Goal::Curvature { .. } | Goal::Rolled { .. }) {
            return Err(InvalidInput::new("goal", "no roll is asked for", "ask for a curvature, or of a rolled sheet"));
        }
        tasks.iter().try_for_each(|task| self.check(&task.question(question)))?;
        rolls(&self.models, question, tasks, (known, others), cancel, finished);
        Ok(())
    }

    /// The limit of a stretch whose width is held, searched from the state of `near` first: the same limit of another design whose rings are linked
    /// alike. Every other question is answered as usual.
    ///
    /// # Errors
    /// What [`Question::check`] refuses.
    #[doc(hidden)]
    pub fn answer_near(&self, question: &Question, near: &Answer, cancel: &AtomicBool) -> Result<Answer, InvalidInput> {
        let Question { effort, starts, seed, sense, .. } = *question;
        match question.goal {
            Goal::Stretch { direction_deg, l2, across } if across == Across::HELD && sense == Sense::Largest => {
                question.check()?;
                let options = ExactOptions { effort, starts, seed, ..ExactOptions::default() };
                let exact = ExactMethod::new(&self.models, options, cancel);
                Ok(exact.limit_near(Direction::of_degrees(direction_deg), l2, near, cancel))
            }
            _ => self.answer_until(question, cancel),
        }
    }

    /// l1 and l2 of a stretch whose width is free, where one local search from the state of `near` ends: the same limit of another design whose
    /// rings are linked alike. `None` where it does not end in a certified limit.
    pub(crate) fn strains_near(&self, question: &Question, near: &Answer, cancel: &AtomicBool) -> Option<[f64; 2]> {
        let Goal::Stretch { direction_deg, across, .. } = question.goal else { return None };
        let exact = ExactMethod::new(&self.models, ExactOptions { across, ..ExactOptions::default() }, cancel);
        exact.strains_near(Direction::of_degrees(direction_deg), across, near, cancel)
    }

    /// One strain: where a stretch asks the same, found as that, so that one question has one answer.
    fn strain(&self, question: &Question, cancel: &AtomicBool) -> Result<Answer, InvalidInput> {
        let Question { effort, starts, seed, sense, .. } = *question;
        let Some(query) = question.strain_query()? else { unreachable!("a strain or a ray is asked for") };
        let options = StrainOptions { effort, starts, seed, sense, follow_waves: self.models.len() > 1 };
        let method = StrainMethod::new(&self.models, options);
        let Some(stretch) = question.as_stretch() else { return Ok(method.solve(&query, &[], cancel)) };
        let answer = self.answer_until(&stretch, cancel)?;
        let answer = as_strain(answer);
        let answer = if answer.is_limit() { method.with_ranges(&query, answer, cancel) } else { answer };
        let interrupted = cancel.load(Ordering::Relaxed);
        Ok(if interrupted { Answer::new(self.model(), Status::Interrupted) } else { answer })
    }
}

/// The limit of a stretch as an extreme of E_DD = l1 + l1²/2. Its state is turned so that F is triangular, as that of an extreme is.
fn as_strain(answer: Answer) -> Answer {
    let green = |l1: f64| l1 + 0.5 * l1 * l1;
    let (f, l1) = (answer.gradient, answer.value.unwrap_or(0.0));
    let turned = factor(&(f.transpose() * f)).zip(f.try_inverse()).filter(|_| answer.value.is_some());
    let turn = turned.map_or(Matrix2::identity(), |(triangular, inverse)| triangular * inverse);
    let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), turn[(1, 0)].atan2(turn[(0, 0)]));
    let pose = |pose: &Pose| Pose {
        position: turn * pose.position,
        rotation: UnitQuaternion::from_rotation_matrix(&turn) * pose.rotation,
    };
    // dE = (1 + l1) dl1.
    let contact = |c: &Contact| Contact {
        point_a: turn * c.point_a,
        point_b: turn * c.point_b,
        force: c.force * (1.0 + l1),
        ..*c
    };
    let cell = |t: &CellTrend| CellTrend { value: t.value.map(green), ..*t };
    let mut by_cell: Vec<CellTrend> = answer.by_cell.iter().map(cell).collect();
    if by_cell.is_empty() {
        let (n_starts, n_distinct) = (answer.n_starts.unwrap_or(0), answer.n_distinct.unwrap_or(0));
        by_cell.push(CellTrend { cell: answer.cell, value: answer.limit().map(green), n_starts, n_distinct });
    }
    let State { poses, a1, a2, .. } = &answer.state;
    let state = State { poses: poses.iter().map(pose).collect(), a1: turn * a1, a2: turn * a2, roll: None };
    let gradient = turn.matrix().fixed_view::<2, 2>(0, 0) * f;
    Answer {
        value: answer.value.map(green),
        bound: answer.bound.map(green),
        bound_kind: None,
        dual: Vec::new(),
        contacts: answer.contacts.iter().map(contact).collect(),
        own_image_force: answer.own_image_force.map(|force| force * (1.0 + l1)),
        free: None,
        by_cell,
        gradient,
        state,
        ..answer
    }
}

impl CellChoice {
    /// The cells that the exact method may search.
    fn exact_cells(self, elements: usize) -> Vec<Cell> {
        self.cells(&crate::survey::Method::Exact(ExactOptions::default()), elements)
    }
}
