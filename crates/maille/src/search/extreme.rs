//! Extremes of a weave that are no strains: the thickest wire with which it exists, the state with the largest clearance
//! (`room.rs`), and the closest cell (`closest.rs`).

use super::{
    closest::closest_cell,
    options::ExtremeOptions,
    room::{Room, largest_room},
};
use crate::{answer::Answer, lattice::Cell, model::Model};
use maille_design::Design;
use std::sync::atomic::AtomicBool;

/// What is as large, or as small, as can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extreme {
    /// All minor radii, in the proportions of the design.
    ThickestWire,
    /// The smallest gap between the tori of two rings.
    LargestClearance,
    /// The least area of the cell in which every gap is at least this, in reference radii. The lattice is free.
    ClosestCell {
        /// The gap.
        gap: f64,
    },
}

/// A ring's size in the design's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// R.
    pub major_radius: f64,
    /// r.
    pub minor_radius: f64,
}

impl Size {
    /// Makers' aspect ratio: inner diameter / wire diameter.
    pub fn aspect_ratio(&self) -> f64 {
        (self.major_radius - self.minor_radius) / self.minor_radius
    }
}

/// A saved design is thinner by this share: what its rounding could make overlap.
const SPARED: f64 = 1e-9;

impl Extreme {
    /// Different sizes of rings with the wire that was found; NaN where none was.
    pub fn sizes(self, answer: &Answer, model: &Model) -> Vec<Size> {
        let factor = if self == Extreme::ThickestWire { answer.value.unwrap_or(f64::NAN) } else { 1.0 };
        let mut out: Vec<Size> = Vec::new();
        for ring in &model.rings {
            let [major_radius, minor_radius] = [ring.major_radius, ring.minor_radius * factor].map(|x| x * model.unit);
            if !out.iter().any(|s| (s.major_radius, s.minor_radius) == (major_radius, minor_radius)) {
                out.push(Size { major_radius, minor_radius });
            }
        }
        out
    }

    /// The smallest gap of the state, in the design's unit; `None` where the wire was sought, or no state was found.
    pub fn clearance(self, answer: &Answer, model: &Model) -> Option<f64> {
        let gap = match self {
            Extreme::ThickestWire => None,
            Extreme::LargestClearance => answer.value,
            Extreme::ClosestCell { .. } => answer.value.and(answer.gap),
        };
        gap.map(|gap| gap * model.unit)
    }

    /// The area of the closest cell as a share of the written one; `None` where something else was sought.
    pub fn area_share(self, answer: &Answer) -> Option<f64> {
        answer.value.filter(|_| matches!(self, Extreme::ClosestCell { .. }))
    }

    /// The widest gap that was found where no cell has the one that was asked for, in the design's unit.
    pub fn widest_instead(self, answer: &Answer, model: &Model) -> Option<f64> {
        let Extreme::ClosestCell { gap } = self else { return None };
        answer.gap.filter(|widest| answer.value.is_none() && *widest < gap).map(|widest| widest * model.unit)
    }

    /// The state of the answer as a design. It allows overlaps at the start only where the design did and some are left.
    pub fn design(self, answer: &Answer, design: &Design, model: &Model) -> Design {
        let mut out = answer.state.design(design, model).rounded();
        let (word, words, factor) = match self {
            Extreme::ThickestWire => ("tightest", "thickest wire", answer.value.unwrap_or(1.0) * (1.0 - SPARED)),
            Extreme::LargestClearance => ("roomiest", "widest gaps", 1.0),
            Extreme::ClosestCell { .. } => ("closest", "closest cell", 1.0),
        };
        out.title = format!("{}, {words}", if out.title.is_empty() { &out.name } else { &out.title });
        // A name without spaces, which files and folders are called by.
        out.name = format!("{}-{word}", out.name.split_whitespace().collect::<Vec<_>>().join("-"));
        out.minor_radius = out.minor_radius.map(|r| r * factor);
        let rings = out.elements.iter_mut().flat_map(|element| &mut element.rings);
        rings.for_each(|ring| ring.minor_radius = ring.minor_radius.map(|r| r * factor));
        out = out.settled();
        if design.allow_initial_overlap {
            out.allow_initial_overlap = false;
            out.allow_initial_overlap = Model::compile(&out, Cell::PRIMITIVE).is_err();
        }
        out
    }
}

/// Searches for an extreme of `model` on the current thread pool. The result does not depend on the number of threads.
///
/// The value is the factor of the minor radii, the clearance in reference radii, or the area of the cell as a share of the written
/// one. The status is `local` with a complete certificate, else `uncertified`; `not-converged` where no start led to a state without
/// overlap, or to a cell with the gap: then the state is that of the widest gap that was found.
pub fn extreme(model: &Model, what: Extreme, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
    match what {
        Extreme::ThickestWire => largest_room(model, Room::Wire, options, cancel),
        Extreme::LargestClearance => largest_room(model, Room::Clearance, options, cancel),
        Extreme::ClosestCell { gap } => closest_cell(model, gap, options, cancel),
    }
}
