//! What came of one question.

use crate::{
    bound::{BindingChain, Bound, BoundKind, DualForce},
    lattice::Cell,
    model::Model,
    program::Contact,
    record::{Status, StepRecord},
    solver::certificate::Certificate,
    state::State,
};
use nalgebra::Matrix2;

/// What came of one question, by either method. Lengths are in reference radii.
#[derive(Clone, Debug)]
pub struct Answer {
    /// How sure it is, or why there is none.
    pub status: Status,
    /// What was asked for: l1 of a stretch, a Green strain, the distance along a ray of strains, the factor of the minor radii,
    /// the clearance, the area as a share of the written one, the curvature of a roll, or the gap, l2 or radius of a tube. Certified if the status says so; of an `uncertified` answer the best feasible value. `None` where
    /// nothing was found.
    pub value: Option<f64>,
    /// Proven bound of the value: no state lies beyond it.
    pub bound: Option<f64>,
    /// Where the bound of a stretch comes from; `None` for other goals.
    pub bound_kind: Option<BoundKind>,
    /// The chain of links that binds in the bound.
    pub chain: Option<BindingChain>,
    /// The forces that prove the bound, or that there is no state, where one chain does not.
    pub dual: Vec<DualForce>,
    /// The cell that was solved.
    pub cell: Cell,
    /// Its state: the answer's, or the last one of a failed search.
    pub state: State,
    /// Deformation gradient of that state.
    pub gradient: Matrix2<f64>,
    /// Smallest gap between the tori of two rings in it, where there is a value; where no cell has the gaps asked for, the widest
    /// that was found.
    pub gap: Option<f64>,
    /// Whether its links are those of the start.
    pub links_ok: Option<bool>,
    /// The certificate, complete or not (exact method).
    pub certificate: Option<Certificate>,
    /// Contacts that carry force, per unit of the value (exact method).
    pub contacts: Vec<Contact>,
    /// Largest force between an element and its own image in the solved cell (exact method).
    pub own_image_force: Option<f64>,
    /// The least curvature on waves through the sheet, where it was sought (exact method).
    pub wave: Option<WaveCurvature>,
    /// Ranges of l2 and of the shear at a stretch that leaves them free.
    pub free: Option<FreeRanges>,
    /// Least and largest value found of each strain that was left free, with the value given way by a millionth; cut off where
    /// the bound excludes them. A range of some width: the state is not the only one. Empty where the answer is not certified.
    pub ranges: Vec<[f64; 2]>,
    /// What each cell found, where larger cells were searched.
    pub by_cell: Vec<CellTrend>,
    /// Starts that were solved (exact method).
    pub n_starts: Option<u64>,
    /// Distinct certified values among them, more than 1e-7 from each other (exact method).
    pub n_distinct: Option<u64>,
    /// Estimated chance that another start finds more, where the bound is not attained (exact method).
    pub better_chance: Option<f64>,
    /// Minimisations, or local maximisations.
    pub runs: u64,
    /// Newton iterations, or quadratic programs, of all runs.
    pub iterations: u64,
    /// Last residual: how far the state is from its target (energy method), or its deepest overlap (exact method).
    pub residual: Option<f64>,
    /// What happened, where the status does not say it.
    pub note: Option<String>,
    /// The steps of all runs (energy method, where they were asked for).
    pub steps: Vec<StepRecord>,
}

/// The least curvature found of the Lagrangian on motions that repeat over the sheet as a wave and keep the loaded contacts. Where
/// it is negative, a larger cell may go further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveCurvature {
    /// The curvature, for a unit motion.
    pub least: f64,
    /// Its wave vector: phases from one solved cell to the next along its two lattice vectors, in units of 2π.
    pub q: [f64; 2],
}

/// What the search of one cell found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellTrend {
    /// The cell.
    pub cell: Cell,
    /// Its best certified value.
    pub value: Option<f64>,
    /// Starts that were solved.
    pub n_starts: u64,
    /// Distinct certified values among them.
    pub n_distinct: u64,
}

impl CellTrend {
    /// As `1x1 -0.037600000 (8 starts, 3 limits)`.
    pub fn label(&self) -> String {
        let value = self.value.map_or("none".to_owned(), |x| format!("{x:.9}"));
        let counted = |count: u64, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (starts, limits) = (counted(self.n_starts, "start"), counted(self.n_distinct, "limit"));
        format!("{} {value} ({starts}, {limits})", self.cell)
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

impl FreeRanges {
    /// A range narrower than this is one value: its ends are sought with the limit relaxed by 1e-6, which alone parts them by some
    /// thousandths.
    pub const ONE_VALUE: f64 = 3e-3;
}

impl Answer {
    /// An answer with the status, and with the start for its state.
    #[doc(hidden)]
    pub fn new(model: &Model, status: Status) -> Self {
        Answer {
            status,
            value: None,
            bound: None,
            bound_kind: None,
            chain: None,
            dual: Vec::new(),
            cell: model.cell,
            state: model.start.clone(),
            gradient: Matrix2::identity(),
            gap: None,
            links_ok: None,
            certificate: None,
            contacts: Vec::new(),
            own_image_force: None,
            wave: None,
            free: None,
            ranges: Vec::new(),
            by_cell: Vec::new(),
            n_starts: None,
            n_distinct: None,
            better_chance: None,
            runs: 0,
            iterations: 0,
            residual: None,
            note: None,
            steps: Vec::new(),
        }
    }

    /// The same with what a bound says of it.
    pub(crate) fn bounded_by(self, bound: &Bound) -> Self {
        Answer {
            bound: bound.l1(),
            bound_kind: bound.l1().and(bound.kind()),
            chain: bound.chain().cloned(),
            dual: bound.dual().to_vec(),
            ..self
        }
    }

    /// Whether the value is certified, or reached by the energy method: a search that ended well.
    pub fn is_limit(&self) -> bool {
        matches!(self.status, Status::ThresholdReached | Status::Global | Status::Local)
    }

    /// The certified value, or what the energy method reached.
    pub fn limit(&self) -> Option<f64> {
        self.value.filter(|_| self.is_limit())
    }

    /// Green strain E = (FᵀF − 1)/2 of the state.
    pub fn green_strain(&self) -> Matrix2<f64> {
        (self.gradient.transpose() * self.gradient - Matrix2::identity()) * 0.5
    }

    /// Eigenvalues of C = FᵀF of the state, the larger one first: squares of the principal stretches.
    pub fn principal_squared(&self) -> [f64; 2] {
        let c = self.gradient.transpose() * self.gradient;
        let (mean, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, ((c[(0, 0)] - c[(1, 1)]) / 2.0).hypot(c[(0, 1)]));
        [mean + half, mean - half]
    }
}
