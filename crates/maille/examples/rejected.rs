//! What the thesis tried and rejects, measured: the quadratic contact energy, gradient descent, contacts without samples;
//! and its Algorithm 4.3.2 beside what minimises here.
//!
//!     cargo run --release -p maille --example rejected

use maille::{
    design::{Design, RingSpec},
    lattice::{Cell, Direction},
    model::Model,
    record::Status,
    relaxation::{
        Configuration, SheetEnergy,
        barrier::ContactLaw,
        limit::{EnergyMethod, EnergyOptions, Minimiser},
        load::Loads,
        target::{Protocol, Target},
    },
    solver::{
        curvature::Decomposed,
        descent::steepest_descent,
        newton::{NewtonOptions, Objective, Outcome, minimize},
        sparse::Patterns,
    },
    topology::{links_kept, smallest_gap},
};
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::{sync::atomic::AtomicBool, time::Instant};

static NO_CANCEL: AtomicBool = AtomicBool::new(false);

fn design(name: &str) -> Design {
    let text = maille_io::builtin(name).expect("a built-in design");
    maille_io::read_design(name, text).expect("built-in designs are valid").with_minor_radius(0.1)
}

fn main() {
    laws();
    beyond();
    descent();
    shifts();
    tilt();
}

/// Limits by Algorithm 4.3.2, with its line search put right and to the letter, beside ours.
fn shifts() {
    println!();
    println!("pull                   minimiser       iterations  wall s  ended              l1");
    let cases = [
        ("1.1", 0.0, 0.0),
        ("1.1", 45.0, 0.0),
        ("2", 0.0, 0.0),
        ("3.1", 30.0, 0.0),
        ("1.3", 0.0, 0.0),
        ("5.1", 0.0, 0.0),
        ("5.1", 45.0, -0.25),
    ];
    let minimisers = [
        ("newton", Minimiser::Newton),
        ("newton-shifted", Minimiser::NewtonShifted),
        ("newton-printed", Minimiser::NewtonPrinted),
    ];
    for (name, direction, l2) in cases {
        let model = Model::compile(&design(name), Cell::PRIMITIVE).expect("it compiles");
        for (minimiser_name, minimiser) in minimisers {
            let begun = Instant::now();
            let options = EnergyOptions { minimiser, ..usual() };
            let found =
                EnergyMethod::new(&model, options, &NO_CANCEL).limit(Direction::of_degrees(direction), l2, &NO_CANCEL);
            let wall = begun.elapsed().as_secs_f64();
            let (sin, cos) = direction.to_radians().sin_cos();
            let d = nalgebra::Vector2::new(cos, sin);
            let l1 = match found.status {
                Status::ThresholdReached => format!("{:.5}", d.dot(&(found.gradient * d)) - 1.0),
                _ => "none".into(),
            };
            let pull = format!("{name}, {direction}°, l2 = {l2}");
            let status = format!("{:?}", found.status);
            println!("{pull:<21}  {minimiser_name:<14}  {:>10}  {wall:>6.2}  {status:<17}  {l1}", found.iterations);
        }
    }
}

/// Default options with a threshold that lets the energy method show what it does.
fn usual() -> EnergyOptions {
    EnergyOptions { tau: 0.002, ..EnergyOptions::default() }
}

/// Both laws, the square as stiff as makes the same overlap at the threshold.
fn both_laws() -> [(&'static str, EnergyOptions); 2] {
    let barrier = usual();
    let touching = 0.2;
    let depth = (4.0 * barrier.tau * touching / (3.0 * barrier.alpha)).sqrt();
    let square = EnergyOptions {
        contact_law: ContactLaw::Quadratic,
        alpha: 1.5 * barrier.alpha * depth / touching,
        ..barrier.clone()
    };
    // The overlap that sets the samples' spacing is the same.
    let spacing = barrier.sample_offsets_rad(&Model::compile(&design("1.1"), Cell::PRIMITIVE).expect("it compiles"))[1];
    let square = EnergyOptions { sample_spacing_rad: Some(spacing), ..square };
    [("barrier", barrier), ("quadratic", square)]
}

/// One minimisation far beyond the limit of 1.1 along 0°, 0.44: does the overlap stay bounded?
fn beyond() {
    println!();
    println!("law        target l1  ended           iterations  least core distance / touching  links kept");
    let model = Model::compile(&design("1.1"), Cell::PRIMITIVE).expect("it compiles");
    for (name, options) in both_laws() {
        let contacts = options.contacts(&model);
        for l1 in [0.5, 0.7, 1.0, 1.5, 2.0] {
            let target =
                Target::new(&model, Protocol::Strain, Direction::of_degrees(0.0).gradient(l1, 0.0, 0.0), 1.0, 100.0);
            let energy = SheetEnergy { target: Some(&target), ..SheetEnergy::new(&model, &contacts) };
            let start = Configuration::start(model.start.clone());
            let end = minimize(&energy, start, &options.newton(), &NO_CANCEL, &mut |_, _, _| {});
            let (gap, _) = smallest_gap(&model, &end.point.state).expect("rings are near each other");
            let kept = links_kept(&model, &end.point.state);
            let ended = format!("{:?}", end.outcome);
            println!("{name:<9}  {l1:>9}  {ended:<14}  {:>10}  {:>30.5}  {kept}", end.iterations, 1.0 + gap / 0.2);
        }
    }
}

/// Limits of four designs under both laws.
fn laws() {
    println!("law        alpha     limits  not converged  Newton iterations  wall s  error, mean  error, most");
    // Exact limits, as the exact method certifies them: maille characterize DESIGN --directions … --l2 0
    let cases = [
        ("1.1", 0.0, 0.44),
        ("1.1", 15.0, 0.466520034632),
        ("1.1", 45.0, 0.774034949),
        ("1.2", 0.0, 0.04),
        ("1.2", 45.0, 0.078517501),
        ("3.1", 0.0, 0.44),
        ("3.1", 30.0, 0.559316089),
        ("3.2", 0.0, 0.04),
    ];
    for (name, options) in both_laws() {
        let begun = Instant::now();
        let (mut limits, mut stalled, mut iterations, mut errors) = (0, 0, 0, Vec::new());
        for (design_name, direction, exact) in cases {
            let model = Model::compile(&design(design_name), Cell::PRIMITIVE).expect("it compiles");
            let found = EnergyMethod::new(&model, options.clone(), &NO_CANCEL).limit(
                Direction::of_degrees(direction),
                0.0,
                &NO_CANCEL,
            );
            iterations += found.iterations;
            match found.status {
                Status::ThresholdReached => {
                    limits += 1;
                    let (sin, cos) = direction.to_radians().sin_cos();
                    let d = nalgebra::Vector2::new(cos, sin);
                    errors.push((d.dot(&(found.gradient * d)) - 1.0 - exact).abs());
                }
                _ => stalled += 1,
            }
        }
        let most = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        let wall = begun.elapsed().as_secs_f64();
        println!(
            "{name:<9}  {:<8.3e}  {limits:>6}  {stalled:>13}  {iterations:>17}  {wall:>6.2}  {mean:>11.5}  {most:>11.5}",
            options.alpha
        );
    }
}

/// One minimisation each, from the start of the design towards a pull within reach, then to one just beyond it.
fn descent() {
    println!();
    println!(
        "pull               minimiser         iterations  wall s  ended         |gradient|  energy      least curvature"
    );
    let options = usual();
    let within = [("1.1", 0.0, 0.3), ("2-oblong", 90.0, 0.4), ("3.1", 30.0, 0.4)];
    let missed = [("1.1", 0.0, 0.45), ("1.1", 45.0, 0.78), ("3.1", 30.0, 0.57)];
    for (name, direction, l1) in within.into_iter().chain(missed) {
        let model = Model::compile(&design(name), Cell::PRIMITIVE).expect("it compiles");
        let contacts = options.contacts(&model);
        let target =
            Target::new(&model, Protocol::Strain, Direction::of_degrees(direction).gradient(l1, 0.0, 0.0), 1.0, 100.0);
        let energy = SheetEnergy { target: Some(&target), ..SheetEnergy::new(&model, &contacts) };
        for newton in [true, false] {
            let begun = Instant::now();
            let start = Configuration::start(model.start.clone());
            let end = match newton {
                true => minimize(&energy, start, &options.newton(), &NO_CANCEL, &mut |_, _, _| {}),
                false => {
                    let many = NewtonOptions { max_iterations: 50_000, ..options.newton() };
                    steepest_descent(&energy, start, &many, &NO_CANCEL)
                }
            };
            let wall = begun.elapsed().as_secs_f64();
            let curvature = energy.derivatives(&end.point).hessian.decompose(&mut Patterns::default()).ok();
            let least = curvature.as_ref().and_then(Decomposed::lowest).map_or(f64::NAN, |(value, _)| value);
            let ended = match end.outcome {
                Outcome::Minimum => "small gradient",
                _ => "stalled",
            };
            println!(
                "{name:<4} {direction:>3}° l1 = {l1:<4}  {:<16}  {:>10}  {wall:>6.2}  {ended:<14}  {:>9.1e}  {:<10.3e}  {least:>15.1e}",
                if newton { "Newton" } else { "gradient descent" },
                end.iterations,
                end.gradient_norm,
                end.energy,
            );
        }
    }
}

/// Figure 4.2: a ring hangs in another, turned about the line of pull at random; how far from perpendicular does it end?
fn tilt() {
    println!();
    println!("alpha   samples  tilt at the start, mean  tilt at the end, mean  most");
    let mut pair = design("1.1");
    pair.elements.truncate(2);
    pair.elements[1].center = [1.25, 0.0, 0.0];
    pair.elements[1].rings =
        vec![RingSpec { major_radius: 1.0, normal: [0.0, 1.0, 0.0], offset: [0.0; 3], minor_radius: None }];
    let model = Model::compile_sheet(&pair, Cell::PRIMITIVE).expect("it compiles");
    for alpha in [1e2, 1e3, 1e5] {
        for samples in [0, 1, 2] {
            let options = EnergyOptions { alpha, samples, ..usual() };
            let contacts = options.contacts(&model);
            let loads = Loads { forces: vec![(1, Vec3::new(0.1, 0.0, 0.0))], held: vec![0], ..Loads::default() };
            let energy = SheetEnergy { loads, ..SheetEnergy::new(&model, &contacts) };
            let mut rng = ChaCha8Rng::seed_from_u64(42);
            let tilt = |x: &Configuration| {
                let [a, b] = [0, 1].map(|ring| x.state.circle(&model, ring, [0, 0]).normal);
                a.dot(&b).abs().asin().to_degrees()
            };
            let (mut before, mut after) = (Vec::new(), Vec::new());
            for _ in 0..30 {
                let mut x = Configuration::start(model.start.clone());
                let turn = Vec3::new(rng.random_range(-1.05..1.05), 0.0, 0.0);
                x.state.poses[1] = x.state.poses[1].moved(&Vec3::zeros(), &turn);
                before.push(tilt(&x));
                let end = minimize(&energy, x, &options.newton(), &NO_CANCEL, &mut |_, _, _| {});
                after.push(tilt(&end.point));
            }
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let most = after.iter().copied().fold(0.0, f64::max);
            println!("{alpha:<6.0e}  {samples:>7}  {:>22.1}°  {:>20.1}°  {most:>4.1}°", mean(&before), mean(&after));
        }
    }
}
