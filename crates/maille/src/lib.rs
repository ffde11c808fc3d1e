//! Mechanics of discrete interlocking materials: sheets of rigid rings that hold together only because they are linked.
//!
//! A [`Design`] lists elements of rings and two lattice vectors. [`Sheet::compile`] checks it and prepares it for its own unit
//! cell and for larger ones. A [`Question`] asks for something as large or as small as it can be: the stretch along a direction
//! before the sheet locks, a Green strain, the wire, the clearance. [`Sheet::answer`] searches for it and returns an [`Answer`]:
//! a value, a proven bound, the state with its contact forces, and a certificate of what is proved of it.
//!
//! ```
//! use maille::{Question, Sheet, Status};
//!
//! let text = maille_io::builtin("1.1").ok_or("no such design")?;
//! let sheet = Sheet::compile(&maille_io::read_design("1.1", text)?).map_err(|problems| format!("{problems:?}"))?;
//!
//! // How far does it stretch along 45° before it locks, with its width held?
//! let answer = sheet.answer(&Question::stretch_along(45.0))?;
//! assert_eq!(answer.status, Status::Global); // no state of this sheet, in any cell, stretches further: proved
//! assert!((answer.value.unwrap() - 0.774034949).abs() < 1e-8); // by 77 %
//! assert_eq!(answer.contacts.len(), 4); // these contacts carry the load
//!
//! // What is the thickest wire with which it can be woven? R (1 − √½), 2.93 times the design's.
//! let answer = sheet.answer(&Question::thickest_wire())?;
//! assert!((answer.value.unwrap() - 10.0 * (1.0 - 0.5_f64.sqrt())).abs() < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where a question goes
//!
//! | module | what happens there |
//! | --- | --- |
//! | [`design`], [`model`], [`state`], [`lattice`] | the file's content; compiled to indices and units of R; poses and lattice vectors; cells |
//! | [`question`], [`sheet`], [`answer`] | what is asked, to whom, and what came of it |
//! | [`search`] | the exact method: many starts, local maximisation, certificate, larger cells |
//! | `program` | one strain to maximise, under the gaps between rings as inequalities, with derivatives |
//! | `bound` | proofs that no state lies beyond a value |
//! | `solver` | solvers that know nothing of rings: sequential quadratic programming, Newton's method, certificates |
//! | [`relaxation`] | the thesis's energy method, and finite sheets under weight and pulls |
//! | [`sensitivity`] | how a certified value changes with the numbers of its design |
//! | [`fit`] | a design for wanted limits |
//! | [`survey`] | many questions: maps over directions and lateral strains, as rows of a [`record`], and the surface of all strains |
//!
//! Inside, lengths are in units of the design's reference radius R; records are in the file's unit. The searches use the current
//! rayon thread pool, and no result depends on its size. Files are read and written by the crate `maille-io`, and records are
//! checked independently by `maille-verify`.
//!
//! The formulas and proofs are in the repository's `docs/theory`.

pub mod answer;
pub mod fit;
pub mod lattice;
pub mod model;
pub mod question;
pub mod record;
pub mod relaxation;
pub mod search;
pub mod sensitivity;
pub mod sheet;
pub mod state;
pub mod survey;

// The machinery: open to the other crates of the project, its tests and benches, but without any promise.
#[doc(hidden)]
pub mod bound;
#[doc(hidden)]
pub mod program;
#[doc(hidden)]
pub mod solver;
#[doc(hidden)]
pub mod symmetry;
#[doc(hidden)]
pub mod topology;

pub use answer::Answer;
pub use bound::BoundKind;
pub use lattice::{Across, Cell, Direction};
pub use maille_design::{self as design, Design, InvalidInput, error, formula};
pub use model::Model;
pub use program::Contact;
pub use question::{Effort, Goal, Question, Sense, Strain};
pub use record::Status;
pub use sensitivity::Sensitivity;
pub use sheet::Sheet;
pub use solver::certificate::Certificate;
pub use state::State;
pub use survey::{CellChoice, MapQuestion};

/// The README's example is run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
