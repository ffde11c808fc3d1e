//! The native part of the Python package `maille`: a front end like the program, with no mechanics of its own.
//!
//! What is here turns Python's arguments into those of the crates, lets other Python threads run meanwhile, listens for
//! Ctrl-C, and turns errors into the classes of `maille.errors`. What needs no native code is Python, in `python/maille`.

mod chain;
mod design;
mod error;
mod fit;
mod geometry;
mod map;
mod question;
mod roll;
mod simulate;
mod study;
mod surface;
mod view;
mod wait;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::chain::{OpenMap, joint_csv};
    #[pymodule_export]
    use crate::design::{Design, builtin_names, nearest_builtin_name};
    #[pymodule_export]
    use crate::fit::{fit, fit_request};
    #[pymodule_export]
    use crate::geometry::{circle_distance_minima, linking_number, torus_gap};
    #[pymodule_export]
    use crate::map::{Record, characterize, effort, map_question, numbers, read_record};
    #[pymodule_export]
    use crate::question::{answer, sensitivity};
    #[pymodule_export]
    use crate::roll::rolls;
    #[pymodule_export]
    use crate::simulate::{check_records_folder, check_simulation_folder, open_simulation, save_simulation, simulate};
    #[pymodule_export]
    use crate::study::{folder_name, study};
    #[pymodule_export]
    use crate::surface::{SurfaceFolder, boundary, boundary_by, boundary_options, solve_rays};
    #[pymodule_export]
    use crate::view::Sheet;

    /// Version of the package, that of the program.
    #[pymodule_export]
    const __VERSION__: &str = env!("CARGO_PKG_VERSION");
}
