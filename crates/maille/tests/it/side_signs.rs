//! What keeps a neighbour in its place at an element of several rings: linking numbers do not, the step bound does, and
//! the thesis's side signs forbid more than crossings.

use crate::common::design;
use maille::{
    design::{Design, ElementSpec, RingSpec},
    lattice::Cell,
    model::Model,
    relaxation::{Configuration, ContactOptions, MinimaMethod, SheetEnergy, barrier::ContactLaw},
    solver::newton::Objective,
    topology::{links_kept, side_signs::SideSigns, smallest_gap},
};

/// The gyroscope of 1.3 with one neighbour, no lattice.
fn gyroscope_and(neighbour: ElementSpec) -> Model {
    let mut design: Design = design("1.3-small", 0.1);
    design.elements.truncate(1);
    design.elements.push(neighbour);
    Model::compile_sheet(&design, Cell::PRIMITIVE).unwrap()
}

fn ring(center: [f64; 3], major_radius: f64, normal: [f64; 3]) -> ElementSpec {
    let rings = vec![RingSpec { major_radius, normal, offset: [0.0; 3], minor_radius: None }];
    ElementSpec { name: "neighbour".into(), center, rings, curves: Vec::new() }
}

fn contacts() -> ContactOptions {
    let law = ContactLaw::Barrier;
    ContactOptions { law, alpha: 1e5, sample_offsets_rad: vec![], minima: MinimaMethod::Enumeration, flat_points: 64 }
}

/// The connector of 1.3 hangs at the gyroscope's +x vertex. At the −x vertex, turned round by half a turn about x, it
/// has the same signed linking numbers with all three rings, and every gap is as wide: before and after look alike.
/// The step between the two crosses circles, and the step bound stops it.
#[test]
fn linking_numbers_would_let_a_neighbour_slip_through_a_gyroscope() {
    let model = gyroscope_and(ring([1.25, 0.0, 0.0], 0.5, [0.0, 1.0, 1.0]));
    assert_eq!(model.links.len(), 2);
    let contacts = contacts();
    let energy = SheetEnergy::new(&model, &contacts);
    let start = Configuration::start(model.start.clone());
    let mut step = vec![0.0; energy.unknowns()];
    (step[6], step[9]) = (-2.5, std::f64::consts::PI);
    let there = energy.moved(&start, &step, 1.0);
    assert!(links_kept(&model, &there.state), "linking numbers see nothing");
    let gap = |x: &Configuration| smallest_gap(&model, &x.state).unwrap().0;
    assert!((gap(&there) - gap(&start)).abs() < 1e-12 && gap(&start) > 0.04, "gaps see nothing");
    let signs = SideSigns::new(&model);
    assert!(signs.kept(&model, &start.state) && !signs.kept(&model, &there.state), "side signs do");

    // The way leads to a crossing at a quarter of it. However often the step is tried again, the bound stops before.
    let (mut x, mut done) = (start, 0.0);
    for _ in 0..10 {
        let guard = energy.slope(&x).2;
        let rest: Vec<f64> = step.iter().map(|s| s * (1.0 - done)).collect();
        let fraction = energy.largest_step(&guard, &rest);
        x = energy.moved(&x, &rest, fraction);
        done += (1.0 - done) * fraction;
    }
    assert!(done < 0.25, "{done} of the way");
    assert!(links_kept(&model, &x.state) && signs.kept(&model, &x.state));
}

/// A ring passes through the gyroscope's z ring alone. Its innermost part bulges over the plane of the x ring and back:
/// nothing is crossed, every gap stays open, the links stay, and a side sign flips.
#[test]
fn a_side_sign_flips_though_nothing_is_crossed() {
    let model = gyroscope_and(ring([1.1, 0.4, 0.0], 0.9, [0.0, 1.0, 0.0]));
    assert_eq!(model.links.len(), 1);
    let signs = SideSigns::new(&model);
    assert_eq!(signs.sides.len(), 2, "{signs:?}");
    let contacts = contacts();
    let free = SheetEnergy::new(&model, &contacts);
    let ruled = SheetEnergy { side_signs: Some(&signs), ..SheetEnergy::new(&model, &contacts) };
    let start = Configuration::start(model.start.clone());
    let mut step = vec![0.0; free.unknowns()];
    step[6] = -0.3;
    let mut least = f64::INFINITY;
    for k in 0..=400 {
        let x = free.moved(&start, &step, f64::from(k) / 400.0);
        assert!(links_kept(&model, &x.state));
        least = least.min(smallest_gap(&model, &x.state).unwrap().0);
    }
    println!("smallest gap on the way: {least:.4}");
    assert!(least > 0.08, "{least}");
    let there = free.moved(&start, &step, 1.0);
    assert!(!signs.kept(&model, &there.state), "the sign flipped");
    assert!(free.allows(&start, &there) && !ruled.allows(&start, &there));
    assert!(ruled.allows(&start, &free.moved(&start, &step, 0.5)));
}
