//! Proofs for the cell of two rings: a tree of boxes, each of which holds no state for a reason that is checked here.
//!
//! The search for a proof is another crate's. What is trusted is in this folder alone: the enclosures ([`form`]), the boxes that
//! hold all states ([`cell`]), the inequalities that each state satisfies ([`reason`]), and that the tree leaves nothing out ([`text`]).
//! The mathematics stands in `docs/theory/prove.md`.

pub mod cell;
mod direction;
pub mod form;
pub mod piece;
pub mod reason;
pub mod text;

#[cfg(test)]
mod tests;

pub use cell::{Cell, Pair};
pub use form::{Form, plain};
pub use piece::{Piece, Rings};
pub use reason::{Chosen, Reason};
pub use text::{Claim, Node, Proof, write};
