//! The limit of one pull, by the thesis's energy method or by the exact one; and extremes that are no pulls.

pub mod boundary;
mod climb;
pub mod energy;
pub mod exact;
pub mod extreme;
mod least;
mod overlap;
mod pull;
pub mod sphere;
pub mod strain;
mod unlinked;

use crate::{
    bound::{BindingChain, Bound, BoundKind, DualForce},
    constraint::Contact,
    record::{Status, StepRecord},
    solve::certificate::Certificate,
    state::State,
};
use nalgebra::Matrix2;

/// What the search of one cell found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellTrend {
    /// Which of the cells.
    pub cell: usize,
    /// Its best certified value.
    pub value: Option<f64>,
    /// Starts that were solved.
    pub n_starts: u64,
    /// Distinct certified values among them.
    pub n_distinct: u64,
}

/// What the search for one limit found.
#[derive(Clone, Debug)]
pub struct LimitOutcome {
    /// Outcome.
    pub status: Status,
    /// The state at the limit, or the last one of a failed search.
    pub state: State,
    /// Measured F of that state.
    pub gradient: Matrix2<f64>,
    /// Last residual: how far that state is from its target (energy), or its largest violation (exact).
    pub residual: Option<f64>,
    /// Newton iterations, or quadratic programs, of all runs.
    pub iterations: u64,
    /// Minimisations, or solves from a start.
    pub runs: u64,
    /// What happened, where the status does not say it.
    pub note: Option<String>,
    /// What the exact method adds.
    pub exact: Option<ExactFigures>,
    /// The steps of all runs of the energy method, where they were asked for.
    pub steps: Vec<StepRecord>,
}

/// The exact method's figures of one limit.
#[derive(Clone, Debug, Default)]
pub struct ExactFigures {
    /// Proven bound of l1 and where it comes from.
    pub bound: Option<(f64, BoundKind)>,
    /// Which of the method's cells gave the limit.
    pub cell: usize,
    /// The chain of links that binds in the bound.
    pub chain: Option<BindingChain>,
    /// The forces that prove the bound, or that there is no limit, where one chain does not.
    pub dual: Vec<DualForce>,
    /// The certificate, complete or not.
    pub certificate: Option<Certificate>,
    /// Whether the links are those of the start.
    pub links_ok: Option<bool>,
    /// Starts that were solved.
    pub n_starts: u64,
    /// Distinct certified limits among them (apart by more than 1e-7).
    pub n_distinct: u64,
    /// Largest force between an element and its own image in the solved cell.
    pub own_image_force: Option<f64>,
    /// Best feasible l1 without a complete certificate.
    pub l1_uncertified: Option<f64>,
    /// Loaded contacts.
    pub contacts: Vec<Contact>,
    /// Where larger cells were searched, and of a least l1: what each cell's search found.
    pub trend: Vec<CellTrend>,
    /// Where something was free: the ranges in which it can be at the limit.
    pub free: Option<FreeRanges>,
}

impl ExactFigures {
    /// Those of a bound, before anything is solved.
    fn of_bound(bound: &Bound) -> Self {
        ExactFigures {
            bound: bound.l1().zip(bound.kind()),
            chain: bound.chain().cloned(),
            dual: bound.dual().to_vec(),
            ..ExactFigures::default()
        }
    }
}

/// Least and largest value found at a limit, of l2 and of the shear γ; both the same where it was held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRanges {
    /// Of l2.
    pub l2: [f64; 2],
    /// Of γ.
    pub shear: [f64; 2],
}
