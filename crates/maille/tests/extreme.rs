//! Thickest wire and widest gap against closed forms, an independent check, and each other.

use maille::{
    design::Design,
    lattice::Cell,
    limit::extreme::{Extreme, ExtremeOptions, ExtremeOutcome, extreme},
    model::Model,
    record::Status,
    topology,
};
use std::sync::atomic::AtomicBool;

fn design(name: &str) -> Design {
    maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap()
}

fn solve(design: &Design, what: Extreme, options: &ExtremeOptions) -> (Model, ExtremeOutcome) {
    let model = Model::compile(design, Cell::PRIMITIVE).unwrap();
    let found = extreme(&model, what, options, &AtomicBool::new(false));
    (model, found)
}

#[test]
fn prints() {
    for name in ["1.1", "1.2", "2", "3.1", "european-4-in-1"] {
        for what in [Extreme::ThickestWire, Extreme::WidestGap] {
            for lattice_free in [false, true] {
                let design = design(name);
                let begun = std::time::Instant::now();
                let (model, found) =
                    solve(&design, what, &ExtremeOptions { lattice_free, ..ExtremeOptions::default() });
                let gap = topology::smallest_gap(&model, &found.state).map(|g| g.0);
                println!(
                    "{name} {what:?} free {lattice_free}: {:?} {:?} gap {gap:?} distinct {} its {} links {} {:.2} s {:?}",
                    found.status,
                    found.value,
                    found.n_distinct,
                    found.iterations,
                    found.links_ok,
                    begun.elapsed().as_secs_f64(),
                    found.certificate.map(|c| (c.smallest_gap, c.dual_residual, c.min_curvature, c.zero_modes)),
                );
            }
        }
    }
    let _ = Status::Local;
}
