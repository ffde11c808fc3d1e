//! Rows of the constrained program in a cell of several copies, whose elements the lattice carries along.

use crate::common;
use maille::{
    lattice::Cell,
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    solver::{
        constraints::{Derivatives, Loads, Multiplier},
        sqp::Program,
    },
};
use maille_geometry::Vec3;

fn supercell() -> (Model, LatticeFamily) {
    let model = Model::compile(&common::design("3.1", 0.1), "2,1;0,2".parse::<Cell>().unwrap()).unwrap();
    let stretch = |along: Vec3| [model.start.a1, model.start.a2].map(|a| along * a.dot(&along));
    let parameter = |rate| Parameter { rate, weight: 1.0, ..Parameter::default() };
    let parameters = vec![parameter(stretch(Vec3::x())), parameter(stretch(Vec3::y()))];
    let pull = LatticeFamily { base: [model.start.a1, model.start.a2], parameters, metric: None, roll: None };
    (model, pull)
}

#[test]
fn derivatives_are_those_of_the_gaps() {
    let (model, pull) = supercell();
    let program = SheetProgram::new(&model, &pull);
    let x = program.posed(common::shaken(&model, 0.02, 3), vec![0.02, -0.01]);
    let n = program.objective().len();
    let gaps = program.rows(&x, 0.3, Derivatives::None);
    let all: Vec<Multiplier> = gaps
        .iter()
        .map(|row| Multiplier {
            key: row.key,
            angle: row.angle,
            angle_a: row.angle_a,
            minimum: row.minimum,
            value: 1.0,
        })
        .collect();
    let loads = Loads::new(&all);
    let rows = program.rows(&x, 0.3, Derivatives::Second(&loads));
    assert!(rows.iter().filter(|row| row.minimum).count() > 20);
    let h = 1e-4;
    let mut carried = 0;
    for row in rows.iter().filter(|row| row.minimum) {
        // The gap of this row after a step; the minimum moves little.
        let gap = |step: &[f64]| {
            let there = program.rows(&program.moved(&x, step), 1.0, Derivatives::None);
            let same = there.iter().filter(|other| other.key == row.key);
            same.min_by(|a, b| (a.angle - row.angle).abs().total_cmp(&(b.angle - row.angle).abs())).unwrap().gap
        };
        for (k, &column) in row.columns.iter().enumerate().filter(|(_, c)| **c >= n - 2) {
            let along = |t: f64| (0..n).map(|i| if i == column { t } else { 0.0 }).collect::<Vec<f64>>();
            let [up, down] = [h, -h].map(|t| gap(&along(t)));
            let (slope, bend) = ((up - down) / (2.0 * h), (up - 2.0 * row.gap + down) / (h * h));
            assert!((slope - row.gradient[k]).abs() < 1e-6, "{slope} {}", row.gradient[k]);
            let second = row.hessian[k * row.columns.len() + k];
            assert!((bend - second).abs() < 1e-4 * second.abs().max(1.0), "{bend} {second}");
            carried += 1;
        }
    }
    assert!(carried > 20, "strains change the gaps within the cell, too: {carried}");
}

/// A common strain of all copies is a step of the parameters alone, and a small one however large the cell.
#[test]
fn a_common_strain_moves_nothing_else() {
    let (model, pull) = supercell();
    let program = SheetProgram::new(&model, &pull);
    let x = program.posed(model.start.clone(), vec![0.0; 2]);
    let n = program.objective().len();
    let mut step = vec![0.0; n];
    step[n - 2] = 0.01;
    let there = program.moved(&x, &step).state;
    for (e, element) in model.elements.iter().enumerate() {
        let [u, v] = element.anchor;
        let anchor = |state: &maille::state::State| state.poses[e].position - state.a1 * u - state.a2 * v;
        assert!((anchor(&there) - anchor(&model.start)).norm() < 1e-14);
    }
    let guard = program.guard(&x);
    assert_eq!(program.largest_step(&x, &guard, &step), 1.0);
}
