//! The energy's derivatives against finite differences, and its invariances.

use crate::common::{design, model, shaken};
use maille::{
    design::Design,
    lattice::{Cell, Direction},
    model::Model,
    relaxation::{
        Configuration, ContactOptions, MinimaMethod, SheetEnergy,
        barrier::ContactLaw,
        target::{Protocol, Target},
    },
    solver::newton::Objective,
    state::State,
};
use maille_geometry::Vec3;
use nalgebra::UnitQuaternion;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

type Count = std::cell::Cell<usize>;

/// Rings thick enough that a shaken state overlaps in many places; the overlap of the start is allowed.
fn thick(name: &str, minor_radius: f64) -> Model {
    let design = Design { allow_initial_overlap: true, ..design(name, minor_radius) };
    Model::compile(&design, Cell::PRIMITIVE).unwrap()
}

fn options() -> ContactOptions {
    let law = ContactLaw::Barrier;
    ContactOptions {
        law,
        alpha: 30.0,
        sample_offsets_rad: vec![-0.1, 0.1],
        minima: MinimaMethod::Enumeration,
        flat_points: 64,
    }
}

/// Runs `check` on shaken states of single-ring and multi-ring designs under both protocols.
fn for_random_states(check: impl Fn(&SheetEnergy<'_>, &Configuration, &str)) {
    let contacts = options();
    for (name, radius) in
        [("1.1", 0.2), ("2-oblong", 0.16), ("3.1", 0.2), ("1.3-small", 0.16), ("3.4", 0.2), ("4.2", 0.2), ("5.1", 0.13)]
    {
        let model = thick(name, radius);
        for protocol in [Protocol::Strain, Protocol::Corners] {
            let target =
                Target::new(&model, protocol, Direction::of_degrees(20.0).gradient(0.3, -0.1, 0.0), 1.0, 100.0);
            let energy = SheetEnergy { target: Some(&target), ..SheetEnergy::new(&model, &contacts) };
            for seed in 0..3 {
                let mut x = Configuration::start(shaken(&model, 0.05, seed));
                if protocol == Protocol::Corners {
                    x.corner += Vec3::new(0.02, -0.01, 0.03);
                }
                check(&energy, &x, &format!("{name} {protocol:?} seed {seed}"));
            }
        }
    }
}

#[test]
fn gradient_matches_differences_of_the_energy() {
    let (overlapping, checked, jumps) = (Count::new(0), Count::new(0), Count::new(0));
    for_random_states(|energy, x, what| {
        let (value, gradient) = energy.gradient(x);
        assert!((value - energy.energy(x)).abs() <= 1e-12 * value.abs(), "{what}: two energies");
        let contact = value - energy.target.unwrap().energy(&x.state, &x.corner);
        overlapping.set(overlapping.get() + usize::from(contact > 1e-3));
        let size = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        for k in 0..energy.unknowns() {
            let mut unit = vec![0.0; energy.unknowns()];
            unit[k] = 1.0;
            let at = |e: f64| energy.energy(&energy.moved(x, &unit, e));
            // Five-point differences: the error is of fourth order.
            let differences = |e: f64| (8.0 * (at(e) - at(-e)) - (at(2.0 * e) - at(-2.0 * e))) / (12.0 * e);
            let difference = differences(2e-5);
            checked.set(checked.get() + 1);
            if (difference - differences(1e-5)).abs() > 1e-6 * size {
                // A minimum is born or dies within the stencil, where the energy jumps: no derivative to compare with.
                jumps.set(jumps.get() + 1);
                continue;
            }
            assert!(
                (gradient[k] - difference).abs() < 1e-6 * size,
                "{what}, unknown {k}: {} {difference}",
                gradient[k]
            );
        }
    });
    assert!(jumps.get() * 25 < checked.get(), "{} of {} unknowns at a jump", jumps.get(), checked.get());
    assert!(overlapping.get() >= 30, "only {} states overlap: the test tests little", overlapping.get());
}

#[test]
fn analytic_hessian_matches_the_thesis_difference() {
    let (states, agreeing) = (Count::new(0), Count::new(0));
    for_random_states(|energy, x, what| {
        let analytic = energy.derivatives(x).hessian.to_dense();
        let difference = energy.finite_difference_hessian(x);
        let error = (&analytic - &difference).norm_max() / analytic.norm_max();
        states.set(states.get() + 1);
        if error < 2e-6 {
            agreeing.set(agreeing.get() + 1);
        } else {
            println!("{what}: {error:e}"); // a minimum about to be born or to die within ε
        }
    });
    assert!(agreeing.get() + 2 >= states.get(), "{} of {} agree", agreeing.get(), states.get());
}

/// A rotation of the whole sheet about z, lattice included, changes no contact energy.
#[test]
fn contact_energy_is_invariant_under_rigid_motion() {
    let model = thick("1.3-small", 0.16);
    let contacts = options();
    let target = Target::new(&model, Protocol::Strain, Direction::of_degrees(0.0).gradient(0.0, 0.0, 0.0), 0.0, 0.0);
    let energy = SheetEnergy { target: Some(&target), ..SheetEnergy::new(&model, &contacts) };
    let state = shaken(&model, 0.05, 4);
    let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.4, -1.0, 0.7));
    let shift = Vec3::new(3.0, -2.0, 1.0);
    let mut turned: State = state.clone();
    for pose in &mut turned.poses {
        pose.position = turn * pose.position + shift;
        pose.rotation = turn * pose.rotation;
    }
    turned.a1 = turn * state.a1;
    turned.a2 = turn * state.a2;
    let (before, after) = (energy.energy(&Configuration::start(state)), energy.energy(&Configuration::start(turned)));
    assert!(before > 1e-3 && (before - after).abs() < 1e-10 * before, "{before} {after}");
}

#[test]
fn rotations_stay_orthonormal_over_ten_thousand_updates() {
    let mut pose = model("1.1", 0.1).start.poses[0];
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..10_000 {
        pose = pose.moved(&Vec3::zeros(), &Vec3::from_fn(|_, _| rng.random_range(-0.3..0.3)));
    }
    let r = pose.rotation.to_rotation_matrix().into_inner();
    assert!((r * r.transpose() - nalgebra::Matrix3::identity()).amax() < 1e-12);
}

/// Along any step that the bound lets through, no pair of circles crosses: checked on 200 points of long random steps.
#[test]
fn the_step_bound_keeps_every_link() {
    for name in ["1.1", "2-oblong", "3.1", "1.3-small", "5.1"] {
        let model = model(name, if name == "5.1" { 0.05 } else { 0.1 });
        let contacts = options();
        let target =
            Target::new(&model, Protocol::Strain, Direction::of_degrees(0.0).gradient(0.0, 0.0, 0.0), 1.0, 0.0);
        let energy = SheetEnergy { target: Some(&target), ..SheetEnergy::new(&model, &contacts) };
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut cut = 0;
        for round in 0..5 {
            let x = Configuration::start(shaken(&model, 0.02, round));
            let step: Vec<f64> = (0..energy.unknowns()).map(|_| rng.random_range(-2.0..2.0)).collect();
            let fraction = energy.largest_step(&energy.derivatives(&x).guard, &step);
            cut += usize::from(fraction < 1.0);
            for k in 1..=40 {
                let there = energy.moved(&x, &step, fraction * f64::from(k) / 40.0);
                assert!(maille::topology::links_kept(&model, &there.state), "{name}: a link changed");
            }
        }
        assert!(cut == 5, "{name}: long steps must be cut");
    }
}

/// Two rings alone, turned by `tilt` against each other, with axes apart by `offset`; at the deepest point they overlap by
/// `depth`.
fn flat_path(model: &Model, tilt: f64, offset: f64, depth: f64) -> Configuration {
    let mut state = model.start.clone();
    let far = Vec3::new(0.0, 0.0, 50.0);
    state.poses[0].position = far;
    state.poses[1] = state.poses[1].moved(&Vec3::zeros(), &Vec3::new(0.6 * tilt, 0.8 * tilt, 0.0));
    let (mut near, mut apart) = (0.1, 0.3);
    for _ in 0..60 {
        let height = 0.5 * (near + apart);
        state.poses[1].position = far + Vec3::new(offset, 0.0, -height);
        let [a, b] = [0, 1].map(|ring| state.circle(model, ring, [0, 0]));
        let minima = maille_geometry::circle_distance_minima(&a, &b);
        let distance = minima.as_slice().iter().map(|m| m.distance).fold(f64::INFINITY, f64::min);
        *(if distance < 0.2 - depth { &mut near } else { &mut apart }) = height;
    }
    Configuration::start(state)
}

/// On ways from a touching circle to isolated minima the energy changes from step to step as its gradient says; with
/// minima alone it jumps where one is born or ends.
#[test]
fn flat_pairs_have_no_jump_on_the_way_to_isolated_minima() {
    let model = model("5.1", 0.1);
    let jumps = |flat_points: usize| {
        let sample_offsets_rad = vec![-0.003, 0.003];
        let contacts = ContactOptions { alpha: 1e5, sample_offsets_rad, flat_points, ..options() };
        let energy = SheetEnergy::new(&model, &contacts);
        let mut jumps = 0;
        const STEPS: u32 = 2000;
        for way in 0..4 {
            let at = |k: f64| {
                let share = k / f64::from(STEPS);
                let tilt = [0.03, 0.0, 0.02, 0.001][way] * share;
                let offset = [0.0, 0.09 * share, 0.06 * share, 0.005][way];
                flat_path(&model, tilt, offset, 5e-4)
            };
            for k in 1..STEPS {
                let [minus, x, plus] = [-0.5, 0.0, 0.5].map(|e| at(f64::from(k) + e));
                let (value, gradient) = energy.gradient(&x);
                assert!(value > 0.0, "the rings overlap on the whole way");
                // Ring 1 alone moves.
                let (to, from) = (&plus.state.poses[1], &minus.state.poses[1]);
                let (moved, turned) = (to.position - from.position, (to.rotation / from.rotation).scaled_axis());
                let slope: f64 = (0..3).map(|i| gradient[6 + i] * moved[i] + gradient[9 + i] * turned[i]).sum();
                let change = energy.energy(&plus) - energy.energy(&minus);
                jumps += usize::from((change - slope).abs() > 5e-3 * value);
            }
        }
        jumps
    };
    assert_eq!(jumps(64), 0);
    assert!(jumps(0) > 0);
}

/// Turning two flat rings as a whole, or a ring about its own axis, changes next to nothing.
#[test]
fn flat_energy_is_invariant() {
    let model = model("5.1", 0.1);
    let contacts = ContactOptions { alpha: 1e5, ..options() };
    let energy = SheetEnergy::new(&model, &contacts);
    for (tilt, offset) in [(0.0, 0.0), (0.002, 0.01), (0.004, 0.04), (0.012, 0.02)] {
        let x = flat_path(&model, tilt, offset, 2e-4);
        let before = energy.energy(&x);
        let turn = UnitQuaternion::from_scaled_axis(Vec3::new(1.9, -0.6, 0.4));
        let (mut turned, mut spun) = (x.clone(), x.clone());
        let pivot = x.state.poses[0].position;
        for pose in &mut turned.state.poses[..2] {
            pose.position = pivot + turn * (pose.position - pivot);
            pose.rotation = turn * pose.rotation;
        }
        let axis = x.state.circle(&model, 1, [0, 0]).normal;
        spun.state.poses[1] = spun.state.poses[1].moved(&Vec3::zeros(), &(axis.into_inner() * 0.7));
        let after = energy.energy(&turned);
        assert!(before > 0.0 && (before - after).abs() < 1e-9 * before, "{tilt} {offset}: {before} {after}");
        let after = energy.energy(&spun);
        assert!((before - after).abs() < 0.02 * before, "{tilt} {offset}, spun: {before} {after}");
    }
}
