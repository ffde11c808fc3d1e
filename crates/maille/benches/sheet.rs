//! Time of a Newton step of the energy method on growing sheets of 1.1: `cargo bench -p maille --bench sheet`.
//!
//! The sheet is taut: stretched a little beyond the limit in both directions and shaken, so that every link presses and
//! none of the work falls away. 300, 3,000 and 30,000 rings; items are rings.

use divan::{Bencher, black_box, counter::ItemsCount};
use maille::{
    lattice::Cell,
    model::Model,
    relaxation::{Configuration, ContactOptions, HessianMethod, SheetEnergy, limit::EnergyOptions},
    solver::{
        curvature::{Curvature, Decomposed},
        newton::Objective,
        sparse::Patterns,
    },
};
use maille_geometry::Vec3;
use maille_io::{builtin, read_design};
use rand::{RngExt, SeedableRng};
use rayon::{ThreadPool, ThreadPoolBuilder};

fn main() {
    divan::main();
}

const TILES: [&str; 3] = ["10x10", "32x32", "100x100"];
/// Newton's floor of the curvature.
const FLOOR: f64 = 1e-3;

struct Sheet {
    model: Model,
    contacts: ContactOptions,
    x: Configuration,
}

impl Sheet {
    fn new(tile: &str) -> Self {
        let design = read_design("1.1", builtin("1.1").expect("built in")).expect("valid").with_minor_radius(0.1);
        let model = Model::compile_sheet(&design, tile.parse::<Cell>().expect("a cell")).expect("compiles");
        let contacts = EnergyOptions::default().contacts(&model);
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(7);
        let mut shake = || Vec3::from_fn(|_, _| 1e-3 * rng.random_range(-1.0..1.0));
        let mut state = model.start.clone();
        for pose in &mut state.poses {
            pose.position = Vec3::new(1.4405 * pose.position.x, 1.4405 * pose.position.y, pose.position.z);
            *pose = pose.moved(&shake(), &shake());
        }
        Sheet { model, contacts, x: Configuration::start(state) }
    }

    fn energy(&self) -> SheetEnergy<'_> {
        SheetEnergy::new(&self.model, &self.contacts)
    }

    fn rings(&self) -> ItemsCount {
        ItemsCount::new(self.model.rings.len())
    }
}

fn threads(count: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(count).build().expect("threads")
}

/// A whole step: derivatives, direction, bound, one trial. The pattern of the matrix is known from the step before.
#[divan::bench(args = TILES, consts = [1, 2], sample_count = 5, sample_size = 1)]
fn step<const THREADS: usize>(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    let energy = sheet.energy();
    let mut patterns = Patterns::default();
    let pool = threads(THREADS);
    let mut once = || -> f64 {
        let here = energy.derivatives(&sheet.x);
        let curvature = here.hessian.decompose(&mut patterns).expect("finite");
        let step = curvature.descent_step(&here.gradient, FLOOR).expect("a step");
        let fraction = energy.largest_step(&here.guard, &step);
        energy.energy(&energy.moved(&sheet.x, &step, fraction))
    };
    pool.install(&mut once);
    bencher.counter(sheet.rings()).bench_local(|| pool.install(&mut once));
}

/// Energy, gradient, Hessian and the step bound.
#[divan::bench(args = TILES, sample_count = 5, sample_size = 1)]
fn derivatives(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    bencher.counter(sheet.rings()).bench_local(|| drop(black_box(sheet.energy().derivatives(&sheet.x))));
}

/// A trial.
#[divan::bench(args = TILES, sample_count = 5, sample_size = 1)]
fn energy(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    bencher.counter(sheet.rings()).bench_local(|| sheet.energy().energy(&sheet.x));
}

/// The direction, with the pattern and without.
#[divan::bench(args = TILES, consts = [false, true], sample_count = 5, sample_size = 1)]
fn direction<const PATTERN_IS_KNOWN: bool>(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    let mut patterns = Patterns::default();
    let made = bencher.counter(sheet.rings()).with_inputs(|| sheet.energy().derivatives(&sheet.x));
    made.bench_local_values(|here| {
        if !PATTERN_IS_KNOWN {
            patterns = Patterns::default();
        }
        let curvature = here.hessian.decompose(&mut patterns).expect("finite");
        curvature.descent_step(&here.gradient, FLOOR)
    });
}

/// The direction by eigenvalues, and by the sparse factor, at sizes where both can be had.
#[divan::bench(args = ["3x3", "5x5", "7x7"], consts = [false, true], sample_count = 5, sample_size = 1)]
fn dense<const DENSE: bool>(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    let mut patterns = Patterns::default();
    let made = bencher.counter(sheet.rings()).with_inputs(|| {
        let here = sheet.energy().derivatives(&sheet.x);
        let hessian = if DENSE { Curvature::dense(here.hessian.to_dense()) } else { here.hessian };
        (hessian, here.gradient)
    });
    made.bench_local_values(|(hessian, gradient)| -> Option<Vec<f64>> {
        let curvature: Decomposed = hessian.decompose(&mut patterns).expect("finite");
        curvature.descent_step(&gradient, FLOOR)
    });
}

/// The Hessian from formulas, and by differences as in the thesis.
#[divan::bench(args = ["1x1", "2x2", "4x4"], consts = [false, true], sample_count = 3, sample_size = 1)]
fn hessian<const DIFFERENCES: bool>(bencher: Bencher<'_, '_>, tile: &str) {
    let sheet = Sheet::new(tile);
    let method = if DIFFERENCES { HessianMethod::FiniteDifference } else { HessianMethod::Analytic };
    let energy = SheetEnergy { hessian: method, ..sheet.energy() };
    bencher.counter(sheet.rings()).bench_local(|| drop(black_box(energy.derivatives(&sheet.x))));
}
