//! The broad phase against all pairs, on sheets, on cells with images and on scattered rings.

use crate::common::{design, shaken};
use maille::{
    lattice::{Cell, shifts_within},
    model::Model,
    state::State,
    topology::{RingPair, close_pairs},
};
use maille_geometry::Vec3;

/// Every pair by definition: of (a, b, s) and (b, a, −s) the one of the lower element, or of the positive shift.
fn all_pairs(model: &Model, state: &State, margin: f64) -> Vec<RingPair> {
    let mut out = Vec::new();
    for (a, ra) in model.rings.iter().enumerate() {
        for (b, rb) in model.rings.iter().enumerate().filter(|(_, rb)| rb.element >= ra.element) {
            let offset = state.circle(model, b, [0, 0]).center - state.circle(model, a, [0, 0]).center;
            let near = ra.major_radius + rb.major_radius + ra.minor_radius + rb.minor_radius + margin;
            let shifts = match model.periodic {
                true => shifts_within(&offset, &state.a1, &state.a2, near),
                false => vec![[0, 0]],
            };
            for shift in shifts {
                let counts = ra.element < rb.element || shift > [0, 0];
                if counts && (offset + state.translation(shift)).norm() <= near {
                    out.push(RingPair { ring_a: a, ring_b: b, shift });
                }
            }
        }
    }
    out.sort_unstable();
    out
}

fn check(model: &Model, state: &State, least: usize) {
    for margin in [0.0, 1.5] {
        let mut found = close_pairs(model, state, margin);
        found.sort_unstable();
        assert!(found.windows(2).all(|w| w[0] != w[1]), "a pair stands twice");
        assert!(found == all_pairs(model, state, margin) && found.len() >= least);
    }
}

#[test]
fn the_grid_finds_the_pairs_of_the_definition() {
    for (name, tile, least) in [("1.1", "7x7", 200), ("1.3-small", "4x4", 100), ("3.1", "1x1", 4)] {
        let tile: Cell = tile.parse().unwrap();
        let sheet = Model::compile_sheet(&design(name, 0.1), tile).unwrap();
        check(&sheet, &shaken(&sheet, 0.05, 1), least / 3);
        let cell = Model::compile(&design(name, 0.1), tile).unwrap();
        check(&cell, &shaken(&cell, 0.05, 2), least);
    }
    // A basis that is strongly sheared, and elements far out of the cell.
    let cell = Model::compile(&design("1.1", 0.1), "1,0;9,16".parse().unwrap()).unwrap();
    let mut state = shaken(&cell, 0.05, 3);
    check(&cell, &state, 60);
    for (k, pose) in state.poses.iter_mut().enumerate() {
        pose.position += Vec3::new(0.0, 0.0, if k % 5 == 0 { 40.0 } else { 0.0 });
    }
    check(&cell, &state, 20);
}
