//! A long run needs no more memory than a short one.
#![cfg(target_os = "linux")]

use maille::{
    lattice::Cell,
    limit::exact::{ExactMethod, ExactOptions},
    model::Model,
};
use std::sync::atomic::AtomicBool;

/// Resident memory of this process in KiB.
fn resident_kib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_thousand_limits_leave_nothing_behind() {
    let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    let models = [Model::compile(&design, Cell::PRIMITIVE).unwrap()];
    let mut limits = 0;
    let mut map = || {
        let method = ExactMethod::new(&models, ExactOptions::default());
        for k in 0..24 {
            let mut count = |_, outcome: maille::limit::LimitOutcome| limits += usize::from(outcome.exact.is_some());
            method.limits(7.5 * f64::from(k), &[-0.125, 0.0, 0.125], &AtomicBool::new(false), &mut count);
        }
    };
    (0..3).for_each(|_| map());
    let before = resident_kib();
    (0..14).for_each(|_| map());
    let grown = resident_kib() - before;
    assert_eq!(limits, 17 * 72);
    assert!(grown < 2048.0, "{grown} KiB more after 1,008 further limits");
}
