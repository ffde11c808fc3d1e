//! Pictures of a sheet, without a GPU: exact tori, cast by rays, lit for print.
//!
//! A [`Subject`] is a model in one of its states, perhaps with the contact forces of a limit. [`render`] draws a patch of
//! it as RGBA pixels. `docs/decisions/0006-renderer.md` says why the renderer is our own.
//!
//! The way of a picture: `scene` places rings and arrows, `camera` frames them, `stage` takes samples of every pixel through
//! `bvh` (which rings may a ray meet?) and `torus` and `tube` (where?), `shade` lights them by the distance `field`, and `overlay`
//! writes the scale bar and the keys. Work is shared by the threads of the current pool; the pixels do not depend on them.

mod arrow;
mod bvh;
mod camera;
mod color;
mod error;
mod field;
mod film;
mod ground;
mod options;
mod overlay;
mod picture;
mod scene;
mod shade;
mod stage;
mod torus;
mod tube;

pub use camera::View;
pub use color::{FORCE, KINDS, LOADS, UNLOADED};
pub use error::RenderError;
pub use film::film;
pub use options::{Background, Caption, ColorBy, Extent, Forces, RenderOptions};
pub use picture::{Picture, render, render_frames};
pub use scene::{Subject, kinds, members};
pub use torus::{Ray, first_hit};
