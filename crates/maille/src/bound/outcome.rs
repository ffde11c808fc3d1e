//! What a bound says, and what proves it.

use super::tie::TieKind;
use crate::lattice::Shift;
use maille_geometry::Vec3;
use std::fmt;

/// A chain of links that joins a ring with its own image.
#[derive(Clone, Debug, PartialEq)]
pub struct BindingChain {
    /// The image's shift v, in lattice vectors of the model's cell.
    pub vector: Shift,
    /// The chain's length d(v), in units of the reference radius.
    pub length: f64,
    /// The rings along the chain with their shifts, from (ring, 0) to (the same ring, v).
    pub rings: Vec<(usize, Shift)>,
}

/// The force y of one tie.
#[derive(Clone, Debug, PartialEq)]
pub struct DualForce {
    /// What the tie is made of.
    pub kind: TieKind,
    /// Its rings with their cells, see [`TieKind`]: in the cell of the model that the bound is of.
    pub rings: Vec<(usize, Shift)>,
    /// y, for a unit pull and lengths in reference radii.
    pub force: Vec3,
}

/// Which bound is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BoundKind {
    /// Chains of links, [`super::ChainBound`].
    Chain,
    /// The convex program over all links, [`super::LinkBound`].
    Link,
}

impl fmt::Display for BoundKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            BoundKind::Chain => "chain",
            BoundKind::Link => "link",
        })
    }
}

/// What a bound says of one direction and one l2.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// No state has a larger l1.
    Finite {
        /// The bound.
        l1: f64,
        /// The bound that gives it.
        kind: BoundKind,
        /// The chain that binds, from the chain bound: also where the link bound is lower.
        chain: Option<BindingChain>,
        /// The forces that prove it, where one chain does not.
        dual: Vec<DualForce>,
    },
    /// No state with l1 > −1 has this l2 in this direction.
    L2Unreachable {
        /// The bound that proves it.
        kind: BoundKind,
        /// The chain that is too short, where one is.
        chain: Option<BindingChain>,
        /// The forces that prove it, where one chain does not.
        dual: Vec<DualForce>,
    },
    /// No chain of links joins lattice vectors along the direction: there is no bound, and only contacts without a link can hold it.
    Unbounded,
}

impl Bound {
    /// The bound of l1, where there is one.
    pub fn l1(&self) -> Option<f64> {
        match self {
            Bound::Finite { l1, .. } => Some(*l1),
            _ => None,
        }
    }

    /// The bound that speaks.
    pub fn kind(&self) -> Option<BoundKind> {
        match self {
            Bound::Finite { kind, .. } | Bound::L2Unreachable { kind, .. } => Some(*kind),
            Bound::Unbounded => None,
        }
    }

    /// The binding chain.
    pub fn chain(&self) -> Option<&BindingChain> {
        match self {
            Bound::Finite { chain, .. } | Bound::L2Unreachable { chain, .. } => chain.as_ref(),
            Bound::Unbounded => None,
        }
    }

    /// The forces that prove it, where one chain does not.
    pub(crate) fn dual(&self) -> &[DualForce] {
        match self {
            Bound::Finite { dual, .. } | Bound::L2Unreachable { dual, .. } => dual,
            Bound::Unbounded => &[],
        }
    }
}
