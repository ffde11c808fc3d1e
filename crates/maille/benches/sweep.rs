//! Maps on one thread and on two: `cargo bench -p maille --bench sweep`. Each figure is for one limit (divan's items).

use divan::{Bencher, counter::ItemsCount};
use maille::{
    lattice::Cell,
    model::Model,
    search::ExactOptions,
    survey::{CellChoice, MapQuestion, Method, characterize},
};
use maille_io::{builtin, read_design};
use std::sync::atomic::AtomicBool;

fn main() {
    divan::main();
}

/// The exact method over 37 directions and five l2 of 1.1, 185 limits.
#[divan::bench(args = [1, 2], sample_count = 5, sample_size = 1)]
fn map(bencher: Bencher<'_, '_>, threads: usize) {
    let design = read_design("1.1", builtin("1.1").expect("built in")).expect("valid");
    let models = [Model::compile(&design, Cell::PRIMITIVE).expect("compiles")];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let method = Method::Exact(ExactOptions::default());
    let question = MapQuestion::new(method, CellChoice::Auto, None, None, None).expect("the usual map");
    bencher.counter(ItemsCount::new(question.tasks().len())).bench_local(|| {
        let (all, cancel) = (|_| true, AtomicBool::new(false));
        pool.install(|| characterize(&models, None, &question, &all, &cancel, &|_, _| (), &|found| drop(found)));
    });
}
