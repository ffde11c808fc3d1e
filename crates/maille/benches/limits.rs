//! Time of a limit, one core: `cargo bench -p maille`. Each figure is for one limit (divan's items).

use divan::{Bencher, counter::ItemsCount};
use maille::{
    lattice::{Cell, Direction},
    model::Model,
    record::Status,
    relaxation::limit::{EnergyMethod, EnergyOptions},
    search::{ExactOptions, stretch::ExactMethod},
};
use maille_io::{builtin, read_design};
use std::{sync::atomic::AtomicBool, time::Instant};

fn main() {
    if std::env::args().all(|argument| argument != "--test") {
        medians();
        scaling();
    }
    divan::main();
}

fn model(name: &str, cell: &str) -> Model {
    let design = read_design(name, builtin(name).expect("built in")).expect("valid");
    Model::compile(&design, cell.parse::<Cell>().expect("a cell")).expect("compiles")
}

/// Directions of a map, 7.5° apart.
fn directions() -> impl Iterator<Item = f64> {
    (0..24).map(|k| 7.5 * f64::from(k))
}

const L2: [f64; 3] = [0.0, -0.125, 0.125];

/// Median wall times of single limits, each the best of five: the maps of small cells, and lines of larger ones.
fn medians() {
    let median = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let mut joint = Vec::new();
    for (name, cell) in [("1.1", "1x1"), ("2-oblong", "1x1"), ("3.1", "1x1"), ("1.1", "2x2"), ("1.1", "3x3")] {
        let models = [model(name, cell)];
        let starts = if cell == "1x1" { Some(4) } else { Some(1) };
        let method =
            ExactMethod::new(&models, ExactOptions { starts, ..ExactOptions::default() }, &AtomicBool::new(false));
        let mut times = Vec::new();
        for direction in directions().step_by(if cell == "1x1" { 1 } else { 4 }) {
            let mut best = [f64::INFINITY; L2.len()];
            for _ in 0..5 {
                let mut begun = Instant::now();
                method.limits(
                    Direction::of_degrees(direction),
                    &L2,
                    &AtomicBool::new(false),
                    &|_| (),
                    &mut |k, limit, _| {
                        best[k] = best[k].min(begun.elapsed().as_secs_f64());
                        drop(divan::black_box(limit));
                        begun = Instant::now();
                    },
                );
            }
            times.extend(best);
        }
        if cell == "1x1" {
            joint.extend(times.iter().copied());
        }
        println!("{name} {cell}: median {:.2} ms of {} limits", 1e3 * median(&mut times), times.len());
    }
    println!("maps of 1.1, 2 and 3.1 together: median {:.2} ms", 1e3 * median(&mut joint));
}

/// Single limits of ever larger cells of 1.1 along six directions: median time and programs, and the exponent p of time ~ Nᵖ
/// that fits the medians best.
fn scaling() {
    let mut points = Vec::new();
    for cell in ["2x2", "3x3", "4x4", "6x6", "10x10"] {
        let models = [model("1.1", cell)];
        let method = ExactMethod::new(
            &models,
            ExactOptions { starts: Some(1), ..ExactOptions::default() },
            &AtomicBool::new(false),
        );
        let mut found: Vec<(f64, u64)> = Vec::new();
        let mut global = 0;
        for direction in [0.0, 15.0, 30.0, 75.0, 100.0, 140.0] {
            let begun = Instant::now();
            method.limits(
                Direction::of_degrees(direction),
                &[0.0],
                &AtomicBool::new(false),
                &|_| (),
                &mut |_, limit, _| {
                    found.push((begun.elapsed().as_secs_f64(), limit.iterations));
                    global += usize::from(limit.status == Status::Global);
                },
            );
        }
        let mut times: Vec<f64> = found.iter().map(|f| f.0).collect();
        let mut programs: Vec<u64> = found.iter().map(|f| f.1).collect();
        times.sort_by(f64::total_cmp);
        programs.sort_unstable();
        let middle = found.len() / 2;
        let median = 0.5 * (times[middle - 1] + times[middle]);
        let n = models[0].elements.len();
        points.push(((n as f64).ln(), median.ln()));
        println!(
            "1.1 {cell}: {n} elements: median {:.1} ms, {:.1} to {:.1}; programs {} to {}; {global} of {} global",
            1e3 * median,
            1e3 * times[0],
            1e3 * times[times.len() - 1],
            programs[0],
            programs[programs.len() - 1],
            found.len()
        );
    }
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let exponent = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    println!("median time ~ N^{exponent:.2}");
}

/// Small cells with continuation in l2: 2 to 4 elements.
#[divan::bench(args = ["1.1", "2-oblong", "3.1"], sample_count = 5, sample_size = 1)]
fn exact_map(bencher: Bencher<'_, '_>, name: &str) {
    let models = [model(name, "1x1")];
    bencher.counter(ItemsCount::new(24 * L2.len())).bench_local(|| {
        let method = ExactMethod::new(&models, ExactOptions::default(), &AtomicBool::new(false));
        for direction in directions() {
            method.limits(
                Direction::of_degrees(direction),
                &L2,
                &AtomicBool::new(false),
                &|_| (),
                &mut |_, limit, _| drop(divan::black_box(limit)),
            );
        }
    });
}

/// One limit of larger cells: 12, 27 and 48 elements of 1.1, and 36 of 3.1.
#[divan::bench(args = ["1.1 2x2", "1.1 3x3", "1.1 4x4", "3.1 3x3"], sample_count = 3, sample_size = 1)]
fn exact_cell(bencher: Bencher<'_, '_>, what: &str) {
    one_limit(bencher, what);
}

/// The same of much larger ones, once: 108 and 300 elements of 1.1, and 100 of 3.1. Seconds.
#[divan::bench(args = ["1.1 6x6", "3.1 5x5", "1.1 10x10"], sample_count = 1, sample_size = 1)]
fn exact_large_cell(bencher: Bencher<'_, '_>, what: &str) {
    one_limit(bencher, what);
}

fn one_limit(bencher: Bencher<'_, '_>, what: &str) {
    let (name, cell) = what.split_once(' ').expect("a design and a cell");
    let models = [model(name, cell)];
    bencher.counter(ItemsCount::new(1usize)).bench_local(|| {
        let method = ExactMethod::new(
            &models,
            ExactOptions { starts: Some(1), ..ExactOptions::default() },
            &AtomicBool::new(false),
        );
        method.limits(Direction::of_degrees(15.0), &[0.0], &AtomicBool::new(false), &|_| (), &mut |_, limit, _| {
            drop(divan::black_box(limit))
        });
    });
}

/// The energy method on the same small cells.
#[divan::bench(args = ["1.1", "2-oblong", "3.1"], sample_count = 3, sample_size = 1)]
fn energy_limit(bencher: Bencher<'_, '_>, name: &str) {
    let model = model(name, "1x1");
    bencher.counter(ItemsCount::new(1usize)).bench_local(|| {
        let cancel = AtomicBool::new(false);
        EnergyMethod::new(&model, EnergyOptions::default(), &cancel).limit(Direction::of_degrees(15.0), 0.0, &cancel)
    });
}
