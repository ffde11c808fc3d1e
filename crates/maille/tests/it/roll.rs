//! Rolled sheets: images, gaps with their derivatives, steps, and what must not depend on how a sheet is written.

use crate::common;
use maille::{
    lattice::{Cell, Direction},
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    solver::{
        constraints::{Derivatives, Loads, Multiplier, Row},
        sqp::Program,
    },
    state::{Pose, Roll, State},
    topology,
};
use maille_geometry::Vec3;
use nalgebra::{Rotation3, UnitQuaternion};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// κ, l1, l2 and γ of a roll along a direction, none of them weighted but κ.
fn family(model: &Model, direction_deg: f64) -> LatticeFamily {
    let direction = Direction::of_degrees(direction_deg);
    let u = direction.along().push(0.0);
    let w = Vec3::z().cross(&u);
    let base = [model.start.a1, model.start.a2];
    let of = |(to, of): (Vec3, Vec3)| Parameter { rate: base.map(|a| to * of.dot(&a)), ..Parameter::default() };
    let curvature = Parameter { turn_rad: base.map(|a| a.dot(&u)), weight: 1.0, ..Parameter::default() };
    let parameters = std::iter::once(curvature).chain([(u, u), (w, w), (w, u)].map(of)).collect();
    LatticeFamily { base, parameters, metric: None, roll: Some(Roll::flat(direction.along())) }
}

/// The written state, centred, its elements moved and turned at random.
fn shaken(model: &Model, size: f64, seed: u64) -> State {
    let state = common::shaken(model, size, seed);
    let middle = state.poses.iter().map(|pose| pose.position).sum::<Vec3>() / state.poses.len() as f64;
    let centred = |pose: &Pose| Pose { position: pose.position - middle, ..*pose };
    State { poses: state.poses.iter().map(centred).collect(), ..state }
}

fn rows(program: &SheetProgram<'_>, x: &maille::program::Posed, band: f64) -> Vec<Row> {
    let load = |row: Row| Multiplier {
        key: row.key,
        angle: row.angle,
        angle_a: row.angle_a,
        minimum: row.minimum,
        value: 1.0,
    };
    let all: Vec<Multiplier> = program.rows(x, band, Derivatives::None).into_iter().map(load).collect();
    program.rows(x, band, Derivatives::Second(&Loads::new(&all)))
}

/// All first and second derivatives of all gaps, on random poses, with strong and weak rolls; in a cell of two copies, too.
#[test]
fn derivatives_are_those_of_the_gaps() {
    let mut checked = 0;
    for (name, cell, direction_deg, p) in [
        ("european-4-in-1", "1x1", 20.0, [0.3, -0.1, 0.05, 0.1]),
        ("european-4-in-1", "2x1", 70.0, [-0.15, 0.05, 0.0, -0.1]),
        ("japanese-4-in-1", "1,1;-1,1", 0.0, [0.0, 0.0, 0.0, 0.0]),
        ("1.3", "1x1", 35.0, [1e-4, 0.1, -0.1, 0.05]),
    ] {
        let model = Model::compile(&common::design(name, 0.1), cell.parse::<Cell>().unwrap()).unwrap();
        let pull = family(&model, direction_deg);
        let program = SheetProgram::new(&model, &pull);
        let x = program.posed(shaken(&model, 0.03, 5), p.to_vec());
        let n = program.objective().len();
        let rows = rows(&program, &x, 0.4);
        // The gap of a row after a step; its minimum moves little.
        let gaps = |step: &[f64]| {
            let there = program.rows(&program.moved(&x, step), 0.9, Derivatives::None);
            move |row: &Row| {
                let same = there.iter().filter(|other| other.key == row.key);
                let away = |other: &&Row| {
                    (other.angle - row.angle).sin().abs() + (other.angle - row.angle).cos().min(0.0).abs()
                };
                same.min_by(|a, b| away(a).total_cmp(&away(b))).map(|row| row.gap)
            }
        };
        let step = |moves: &[(usize, f64)]| {
            let mut y = vec![0.0; n];
            moves.iter().for_each(|(i, t)| y[*i] += t);
            y
        };
        let (h, h2) = (1e-5, 1e-4);
        for a in 0..n {
            let [up, down] = [h, -h].map(|t| gaps(&step(&[(a, t)])));
            for b in 0..=a {
                // Pairs with a parameter: those of poses alone are the kernel's.
                if a < n - 4 && a != b {
                    continue;
                }
                let [pp, pm, mp, mm] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
                    .map(|[s, t]| gaps(&step(&[(a, s * h2), (b, t * h2)])));
                for row in rows.iter().filter(|row| row.minimum) {
                    let place = |c: usize| row.columns.iter().position(|column| *column == c);
                    let slope = place(a).map_or(0.0, |k| row.gradient[k]);
                    let (Some(up), Some(down)) = (up(row), down(row)) else { continue };
                    assert!(
                        ((up - down) / (2.0 * h) - slope).abs() < 1e-6,
                        "{name} {a}: {} {slope}",
                        (up - down) / (2.0 * h)
                    );
                    let k = row.columns.len();
                    let second = place(a).zip(place(b)).map_or(0.0, |(r, c)| row.hessian[r * k + c]);
                    let mixed = [pp(row), pm(row), mp(row), mm(row)];
                    let [Some(pp), Some(pm), Some(mp), Some(mm)] = mixed else { continue };
                    let difference = (pp - pm - mp + mm) / (4.0 * h2 * h2);
                    let scale = row.hessian.iter().fold(1.0f64, |m, x| m.max(x.abs()));
                    assert!(
                        (difference - second).abs() < 1e-3 * scale,
                        "{name} {a} {b}: {difference} {second} {scale}"
                    );
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 1000, "{checked}");
}

/// Image by image the motions are a group, about one axis, and κ → 0 is the translation without a loss of digits.
#[test]
fn images_are_a_group_of_screw_motions() {
    let model = common::model("european-4-in-1", 0.1);
    for (direction_deg, curvature) in [(0.0, 0.7), (33.0, -0.2), (90.0, 1e-7), (120.0, 1e-13), (10.0, 0.0)] {
        let pull = family(&model, direction_deg);
        let program = SheetProgram::new(&model, &pull);
        let state = program.posed(model.start.clone(), vec![curvature, 0.1, -0.05, 0.2]).state;
        let roll = state.roll.unwrap();
        assert!((roll.curvature(&model.reference_inverse) - curvature).abs() < 1e-15);
        let x = Vec3::new(0.3, -0.8, 0.4);
        for [s, t] in [[[1, 0], [0, 1]], [[2, -3], [-1, 2]], [[5, 1], [-5, -1]]] {
            let [one, other, both] = [s, t, [s[0] + t[0], s[1] + t[1]]].map(|shift| state.image(shift));
            assert!((one.point(&other.point(&x)) - both.point(&x)).norm() < 1e-12);
            assert!((other.point(&one.point(&x)) - both.point(&x)).norm() < 1e-12);
            assert!((one.back(&one.point(&x)) - x).norm() < 1e-13);
        }
        let (u, w) = (roll.along, roll.axis());
        for shift in [[1, 0], [0, 1], [3, -2]] {
            let (a, y) = (state.translation(shift), state.image(shift).point(&x));
            assert!((w.dot(&(y - x)) - w.dot(&a)).abs() < 1e-13);
            // To second order in the turn, by its own formula.
            let turn = roll.turn_rad[0] * f64::from(shift[0]) + roll.turn_rad[1] * f64::from(shift[1]);
            let flat = x + a + u * (turn * x.z) - Vec3::z() * (turn * (u.dot(&x) + 0.5 * a.dot(&u)));
            assert!((y - flat).norm() <= 30.0 * turn * turn + 1e-14, "{shift:?}");
            // The distance from the axis stays.
            if turn.abs() > 1e-3 {
                let axis = -Vec3::z() * (a.dot(&u) / turn);
                let away = |p: &Vec3| (p - axis).cross(&w).norm();
                assert!((away(&x) - away(&y)).abs() < 1e-11);
            }
        }
    }
}

/// The smallest gap and the links are the same in another basis, for −u, from another image of an element, and after a rigid motion
/// about the axis.
#[test]
fn gaps_do_not_depend_on_how_the_sheet_is_written() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for name in ["european-4-in-1", "3.1", "1.2"] {
        let model = common::model(name, 0.1);
        let other = Model::compile(&common::design(name, 0.1), "2,1;1,1".parse::<Cell>().unwrap()).unwrap();
        let direction_deg = rng.random_range(0.0..360.0);
        let p = vec![rng.random_range(-0.4..0.4), 0.05, -0.02, 0.1];
        let of = |model: &Model, direction_deg: f64, state: &State, p: &[f64]| {
            let pull = family(model, direction_deg);
            let x = SheetProgram::new(model, &pull).posed(state.clone(), p.to_vec());
            x.state
        };
        let poses = shaken(&model, 0.05, 9);
        let state = of(&model, direction_deg, &poses, &p);
        let gap = |model: &Model, state: &State| topology::smallest_gap(model, state).unwrap().0;
        let count = |model: &Model, state: &State| {
            topology::links(model, state, &topology::close_pairs(model, state, 0.0)).len()
        };
        let (known, links) = (gap(&model, &state), count(&model, &state));
        let same = |model: &Model, state: &State, what: &str| {
            assert!((gap(model, state) - known).abs() < 1e-12, "{name}, {what}: {} {known}", gap(model, state));
            assert_eq!(count(model, state), links, "{name}, {what}");
        };
        same(&model, &of(&model, direction_deg + 180.0, &poses, &p), "-u");
        let based = State { poses: poses.poses.clone(), ..other.start.clone() };
        same(&other, &of(&other, direction_deg, &based, &p), "basis");
        // About the axis, which goes through −(1 + l1)/κ e_z.
        let roll = state.roll.unwrap();
        let (axis, turn) = (Vec3::z() * (-(1.0 + p[1]) / p[0]), Rotation3::new(roll.axis() * 0.3));
        let about = |pose: &Pose| Pose {
            position: axis + turn * (pose.position - axis) + roll.axis() * 0.7,
            rotation: UnitQuaternion::from_rotation_matrix(&turn) * pose.rotation,
        };
        same(&model, &State { poses: state.poses.iter().map(about).collect(), ..state.clone() }, "about the axis");
    }
}

/// What a step bound allows leaves every pair's circles apart all along, and bounds how far each point comes.
#[test]
fn no_circles_meet_on_an_allowed_step() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let mut cut = 0;
    for k in 0..60 {
        let (name, cell) = [("european-4-in-1", "1x1"), ("3.1", "1x1"), ("european-4-in-1", "2x1")][k % 3];
        let model = Model::compile(&common::design(name, 0.1), cell.parse::<Cell>().unwrap()).unwrap();
        let pull = family(&model, rng.random_range(0.0..180.0));
        let program = SheetProgram::new(&model, &pull);
        let p = vec![rng.random_range(-0.5..0.5), 0.0, 0.0, rng.random_range(-0.1..0.1)];
        let x = program.posed(shaken(&model, 0.02, k as u64), p);
        let n = program.objective().len();
        let step: Vec<f64> = (0..n).map(|_| rng.random_range(-0.3..0.3)).collect();
        let guard = program.guard(&x);
        let fraction = program.largest_step(&x, &guard, &step);
        assert!(fraction > 0.0);
        cut += usize::from(fraction < 1.0);
        // All pairs within reach at the start, along the way.
        let pairs = topology::close_pairs(&model, &x.state, 3.0);
        let linking = |state: &State| -> Vec<i32> {
            let circle = |ring: usize, shift| state.circle(&model, ring, shift);
            let of = |p: &topology::RingPair| {
                maille_geometry::linking_number(&circle(p.ring_a, [0, 0]), &circle(p.ring_b, p.shift))
            };
            pairs.iter().map(of).collect()
        };
        let known = linking(&x.state);
        for part in 1..=8 {
            let there =
                program.moved(&x, &step.iter().map(|s| s * fraction * f64::from(part) / 8.0).collect::<Vec<_>>());
            assert_eq!(linking(&there.state), known, "{name} {k} {part}");
            for pair in &pairs {
                let [before, after] =
                    [&x.state, &there.state].map(|state| topology::core_distance(&model, state, pair));
                // A step may use nine tenths of a pair's distance.
                assert!(after > 0.0999 * before.min(1.5) - 1e-12, "{name} {k} {part}: {before} {after}");
            }
        }
    }
    assert!(cut > 30, "{cut}");
}
