//! Independent verification of a record: each reported state is derived anew, by other means than it was found.
//!
//! Nothing is shared with the solver but the type of a circle: files are read anew as plain data, and distances, links, strains and
//! balances have their own formulas here. What is proved and what is not stands in `docs/reliability.md`.

mod apart;
mod balance;
mod ball;
mod bounds;
mod chain;
mod claims;
mod curvature;
mod curve;
mod curve_pair;
mod dual;
mod endless;
mod files;
mod forces;
mod gaps;
mod image;
mod linking;
pub mod proof;
mod record;
mod report;
mod roll;
mod roll_forces;
mod rolled;
mod sensitivities;
mod sheet;
mod start;
mod strain;
mod surface;
mod tie;
mod verifier;
mod waves;
mod width;

pub use balance::{COMPLEMENTARITY, RESIDUAL};
pub use gaps::OVERLAP;
pub use record::{Texts, Unreadable};
pub use report::{Check, Finding, RowReport, Verdict};
pub use roll::{RollReport, RollTexts, RollVerifier};
pub use surface::{SurfaceTexts, SurfaceVerifier, VertexReport};
pub use verifier::Verifier;
