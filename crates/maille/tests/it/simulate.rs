//! Finite sheets: loads against finite differences, links, falling energy, closed forms.

use crate::common::{design, shaken};
use maille::{
    lattice::Cell,
    model::Model,
    record::ForceRow,
    relaxation::{
        Configuration, ContactOptions, MinimaMethod, SheetEnergy,
        barrier::ContactLaw,
        limit::EnergyOptions,
        load::{Bend, Drag, Floor, Loads, PositionTarget},
        simulate::{
            End, Setup, Simulation, Step, TAU, WEIGHT_UNIT, along, elements_at,
            force::{Grip, deformation_gradient, force_row},
            simulate, simulate_from,
        },
    },
    solver::{newton::Objective, sparse::Patterns},
    state::State,
};
use maille_geometry::Vec3;
use std::sync::atomic::AtomicBool;

fn sheet(name: &str, tile: &str) -> Model {
    Model::compile_sheet(&design(name, 0.1), tile.parse::<Cell>().unwrap()).unwrap()
}

fn setup(model: &Model, fix: &str, pull: Option<(&str, Vec3)>, gravity: Vec3) -> Setup {
    let at = |place: &str| elements_at(model, place).unwrap();
    Setup {
        fix: if fix.is_empty() { Vec::new() } else { at(fix) },
        pull: pull.map_or(Vec::new(), |(place, by)| at(place).into_iter().map(|e| (e, vec![by])).collect()),
        gravity,
        forces: Vec::new(),
        floor: None,
        bend: None,
        steps: 4,
        drag: None,
        options: EnergyOptions { tau: TAU, ..EnergyOptions::default() },
    }
}

/// Runs, and checks what holds of every run: the energy falls from state to state, links are kept.
fn run(model: &Model, setup: &Setup) -> Simulation {
    let mut last = (u32::MAX, f64::INFINITY);
    let mut seen = 0;
    let mut rises = 0;
    let end = simulate(model, setup, &AtomicBool::new(false), &mut |x| {
        seen += 1;
        // The line search and the next step sum the energy on their own: it is the same but for rounding.
        if x.run == last.0 && x.energy > last.1 + 1e-12 * last.1.abs() {
            rises += 1;
        }
        last = (x.run, x.energy);
    })
    .unwrap();
    assert!(rises <= end.kicks, "{rises} rises, {} kicks", end.kicks);
    assert!(seen == end.iterations && seen > 3);
    assert!(end.links_ok, "links");
    end
}

fn run_unchecked(model: &Model, setup: &Setup) -> Simulation {
    simulate(model, setup, &AtomicBool::new(false), &mut |_| {}).unwrap()
}

/// From any of its steps on a run comes to the same end, bit for bit, and solves no step again: one that locks, and one under weight.
#[test]
fn a_run_goes_on_from_its_steps() {
    let model = sheet("1.1", "2x2");
    let pulled = setup(&model, "left", Some(("right", Vec3::new(2.5, 0.0, 0.0))), Vec3::zeros());
    let weighed = setup(&model, "top", Some(("bottom", Vec3::new(0.0, -0.5, 0.0))), Vec3::new(0.0, 0.0, -1.0));
    for setup in [pulled, weighed] {
        let go = |known: &[Step]| {
            let mut kept = Vec::new();
            let mut keep = |step: &Step| kept.push(step.clone());
            let go = AtomicBool::new(false);
            let end = simulate_from(&model, &setup, known.to_vec(), &go, &mut |_| {}, &mut keep).unwrap();
            (kept, format!("{end:?}"))
        };
        let (steps, whole) = go(&[]);
        assert!(steps.len() > 4);
        // As they are written and read.
        let text = serde_json::to_string(&steps).unwrap();
        let steps: Vec<Step> = serde_json::from_str(&text).unwrap();
        for known in [1, 3, steps.len() - 1, steps.len()] {
            let (rest, end) = go(&steps[..known]);
            assert_eq!(rest, steps[known..], "after {known}");
            assert!(end == whole, "after {known}");
        }
        // Steps of another run are none of this one.
        let other = Step { share: 0.123, ..steps[1].clone() };
        assert_eq!(go(&[steps[0].clone(), other]).0, steps[1..]);
    }
}

#[test]
fn edges_and_names_are_places() {
    let model = sheet("1.1", "3x2");
    let names = |place: &str| -> Vec<String> {
        elements_at(&model, place).unwrap().iter().map(|e| model.elements[*e].name.clone()).collect()
    };
    let kinds: Vec<String> = design("1.1", 0.1).elements.iter().map(|e| e.name.clone()).collect();
    let of = |kind: usize, cells: &[&str]| -> Vec<String> {
        cells.iter().map(|cell| format!("{}@{cell}", kinds[kind])).collect()
    };
    assert_eq!(names("right"), of(1, &["2,0", "2,1"]));
    assert_eq!(names("top"), of(2, &["0,1", "1,1", "2,1"]));
    assert_eq!(names("left").len(), 4);
    assert_eq!(names(&kinds[0]).len(), 6);
    assert_eq!(names(&format!("{}@1,1", kinds[0])), of(0, &["1,1"]));
    let wrong = elements_at(&model, "north").unwrap_err();
    assert!(wrong.help.contains("left, right, top or bottom") && wrong.help.contains(&kinds[0]), "{wrong:?}");
}

#[test]
fn a_finite_sheet_has_no_images() {
    let model = sheet("1.1", "2x2");
    assert!(model.links.iter().all(|l| l.pair.shift == [0, 0]));
    // Twelve elements; of the sixteen links of the periodic cell those across the edges are missing.
    assert_eq!((model.elements.len(), model.links.len()), (12, 12));
}

#[test]
fn loads_match_finite_differences() {
    let model = sheet("1.3-small", "2x1");
    let contacts = ContactOptions {
        law: ContactLaw::Barrier,
        alpha: 30.0,
        sample_offsets_rad: vec![],
        minima: MinimaMethod::Enumeration,
        flat_points: 64,
    };
    let loads = Loads {
        forces: vec![(0, Vec3::new(0.1, -0.2, -0.3)), (2, Vec3::new(0.0, 0.5, 0.0))],
        targets: vec![PositionTarget { element: 3, position: Vec3::new(2.0, 1.0, -0.5), weight: 2.0 }],
        held: vec![1],
        floor: Some(Floor { height: -1.08, alpha: 30.0 }),
        drag: Some(Drag { from: shaken(&model, 0.4, 6).poses, coefficient: 0.7 }),
        bend: Some(Bend {
            curvature: [0.3, -0.2],
            middle: [0.4, 0.1],
            heights: vec![(0, 0.2), (2, -0.1)],
            weight: 1.5,
        }),
    };
    let energy = SheetEnergy { loads, ..SheetEnergy::new(&model, &contacts) };
    let x = Configuration::start(shaken(&model, 0.03, 5));
    let (value, gradient) = energy.gradient(&x);
    assert!((value - energy.energy(&x)).abs() < 1e-12 * value.abs());
    let hessian = energy.derivatives(&x).hessian.to_dense();
    let size = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    let mut floor_turns = 0;
    for k in 0..energy.unknowns() {
        let mut unit = vec![0.0; energy.unknowns()];
        unit[k] = 1.0;
        if (6..9).contains(&k) {
            assert!(gradient[k] == 0.0 && hessian[(k, k)] == 1.0, "a held unknown");
            continue;
        }
        let at = |e: f64| energy.moved(&x, &unit, e);
        let e = 1e-5;
        let difference = (energy.energy(&at(e)) - energy.energy(&at(-e))) / (2.0 * e);
        assert!((gradient[k] - difference).abs() < 1e-7 * size, "{k}: {} {difference}", gradient[k]);
        let (plus, minus) = (energy.gradient(&at(e)).1, energy.gradient(&at(-e)).1);
        for j in (0..energy.unknowns()).filter(|j| !(6..9).contains(j) && *j <= k) {
            // The gradient is by a rotation vector at the moved pose: symmetrised, its difference is the Hessian.
            let (mut other, mut sum) = (vec![0.0; energy.unknowns()], (plus[j] - minus[j]) / (2.0 * e));
            other[j] = 1.0;
            let there = |e: f64| energy.gradient(&energy.moved(&x, &other, e)).1[k];
            sum += (there(e) - there(-e)) / (2.0 * e);
            assert!((hessian[(k, j)] - 0.5 * sum).abs() < 1e-5 * hessian.norm_max(), "{k},{j}");
        }
        floor_turns += usize::from((3..6).contains(&k) && gradient[k].abs() > 1e-3);
    }
    assert!(floor_turns > 0, "the gyroscope presses on the floor off its centre");
}

#[test]
fn a_pull_within_reach_is_reached_and_one_beyond_locks() {
    let model = sheet("1.1", "2x2");
    let easy = run(&model, &setup(&model, "left", Some(("right", Vec3::new(0.8, 0.0, 0.0))), Vec3::zeros()));
    assert_eq!((easy.end, easy.share), (End::Reached, 1.0));
    // Left and right are three links apart: 3.75 at the start, 3 · 1.8 at most.
    let far = run(&model, &setup(&model, "left", Some(("right", Vec3::new(2.0, 0.0, 0.0))), Vec3::zeros()));
    assert_eq!(far.end, End::Locked, "{:?}", far.note);
    let reached = 2.0 * far.share;
    assert!((reached - 1.65).abs() < 0.003, "{reached}: τ is 0.002, and the halvings end at a quarter of it");
    assert!(far.smallest_gap.unwrap() > -1e-3);
}

/// The strip hangs by its highest ring: to the lowest flat ring there are five links of 1.8 each.
#[test]
fn a_hanging_strip_stretches_to_its_chain() {
    let model = sheet("1.1", "1x3");
    let end = run(&model, &setup(&model, "top", None, Vec3::new(0.0, -1.0, 0.0)));
    assert_eq!(end.end, End::Reached, "{:?}", end.note);
    let top = elements_at(&model, "top").unwrap();
    assert_eq!(top.len(), 1);
    let length = end.state.poses[top[0]].position - end.state.poses[0].position;
    assert!((length.norm() - 9.0).abs() < 2e-3, "{} should be 9.0", length.norm());
    assert!(length.y > 8.99, "it hangs straight");
}

/// A load on the lowest ring alone pulls the same chain straight, and weighs on nothing else.
#[test]
fn a_load_on_one_ring_hangs_by_its_chain() {
    let model = sheet("1.1", "1x3");
    let lowest = elements_at(&model, "flat@0,0").unwrap();
    let loaded = |fix: &str| Setup {
        forces: lowest.iter().map(|e| (*e, Vec3::new(0.0, -5.0, 0.0))).collect(),
        ..setup(&model, fix, None, Vec3::zeros())
    };
    let refused = simulate(&model, &loaded(""), &AtomicBool::new(false), &mut |_| {}).unwrap_err();
    assert_eq!(refused.field, "force");
    let end = run(&model, &loaded("top"));
    assert_eq!(end.end, End::Reached, "{:?}", end.note);
    let top = elements_at(&model, "top").unwrap();
    let length = end.state.poses[top[0]].position - end.state.poses[lowest[0]].position;
    assert!((length.norm() - 9.0).abs() < 2e-3, "{} should be 9.0", length.norm());
}

#[test]
fn what_nothing_holds_is_refused_and_a_floor_holds_it() {
    let model = sheet("1.1", "2x1");
    let free = setup(&model, "", None, Vec3::new(0.0, 0.0, -1.0));
    let refused = |setup: &Setup| simulate(&model, setup, &AtomicBool::new(false), &mut |_| {}).unwrap_err();
    let problem = refused(&free);
    assert!(problem.problem.contains("nothing holds") && problem.help.contains("floor"), "{problem:?}");
    let sideways = Setup { gravity: Vec3::new(0.1, 0.0, -1.0), floor: Some(-3.0), ..free.clone() };
    assert!(refused(&sideways).problem.contains("nothing holds"), "it would slide for ever");
    let inside = Setup { floor: Some(-0.5), ..free.clone() };
    assert_eq!(refused(&inside).field, "floor");

    let end = run(&model, &Setup { floor: Some(-2.0), ..free });
    assert_eq!(end.end, End::Reached, "{:?}", end.note);
    let lowest = |ring: usize| {
        let c = end.state.circle(&model, ring, [0, 0]);
        c.center.z - c.radius * (1.0 - c.normal.z.powi(2)).max(0.0).sqrt() - 0.1
    };
    let lowest = (0..model.rings.len()).map(lowest).fold(f64::INFINITY, f64::min);
    assert!(lowest > -2.01 && lowest < -1.99, "{lowest}: on the floor, which may be entered a little between points");
}

/// A way is made in equal shares, corner by corner, by the formula and by a sheet.
#[test]
fn a_way_has_corners() {
    let way = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 2.0, 0.0), Vec3::zeros()];
    for (share, at) in
        [(0.0, [0.0, 0.0]), (0.25, [0.75, 0.0]), (0.5, [1.0, 1.0]), (2.0 / 3.0, [1.0, 2.0]), (1.0, [0.0, 0.0])]
    {
        assert!((along(&way, share) - Vec3::new(at[0], at[1], 0.0)).norm() < 1e-12, "{share}");
    }
    assert_eq!(along(&[], 0.5), Vec3::zeros());
    let model = sheet("1.1", "2x1");
    let mut setup = setup(&model, "left", Some(("right", Vec3::new(0.8, 0.0, 0.0))), Vec3::zeros());
    setup.pull.iter_mut().for_each(|(_, way)| way.push(Vec3::new(-0.3, 0.0, 0.2)));
    let end = run(&model, &setup);
    assert_eq!((end.end, end.share, end.path.len()), (End::Reached, 1.0, 5));
    let right = setup.pull[0].0;
    let moved = |frame: usize| Vec3::from(end.path[frame].poses[right].position) - model.start.poses[right].position;
    assert!((moved(2) - Vec3::new(0.8, 0.0, 0.0)).norm() < 2e-3, "half of the way is its first corner");
    assert!((moved(4) - Vec3::new(-0.3, 0.0, 0.2)).norm() < 2e-3);
}

/// A sheet under weight between a held edge and a floor: the fall, then a pull.
#[test]
fn a_heavy_sheet_comes_to_rest_and_is_pulled() {
    let model = sheet("1.1", "4x3");
    let mut setup = setup(&model, "left", Some(("right", Vec3::new(0.5, 0.0, 0.0))), Vec3::new(0.0, 0.0, -1.0));
    (setup.floor, setup.steps) = (Some(-3.0), 2);
    let end = run(&model, &setup);
    assert_eq!((end.end, end.share), (End::Reached, 1.0), "{:?}", end.note);
    assert!(end.smallest_gap.unwrap() > -1e-4);
}

/// Against a drag a free sheet sinks by weight over drag in a step, and lies on the floor after some.
#[test]
fn a_sheet_sinks_against_its_drag() {
    let model = sheet("1.1", "2x2");
    let mut setup = setup(&model, "", None, Vec3::new(0.0, 0.0, -1.0));
    (setup.floor, setup.drag) = (Some(-3.0), Some(4.0));
    let end = run(&model, &setup);
    assert_eq!((end.end, end.path.len()), (End::Reached, 5));
    for (step, frame) in end.path.iter().enumerate() {
        let z: f64 = frame.poses.iter().map(|p| p.position[2]).sum::<f64>() / 12.0;
        let start: f64 = model.start.poses.iter().map(|p| p.position.z).sum::<f64>() / 12.0;
        assert!((z - (start - 0.25 * (step as f64 + 1.0))).abs() < 1e-4, "step {step}: {z}");
    }
    setup.steps = 40;
    let end = run(&model, &setup);
    let z: f64 = end.state.poses.iter().map(|p| p.position.z).sum::<f64>() / 12.0;
    assert!(end.end == End::Reached && z < -2.5 && z > -2.9, "{z}");
}

/// A step that is cut off before its pulled edge has arrived is no proof that the sheet has locked.
#[test]
fn a_step_that_is_cut_off_does_not_lock() {
    let model = sheet("1.1", "2x1");
    let mut setup = setup(&model, "left", Some(("right", Vec3::new(0.8, 0.0, 0.0))), Vec3::zeros());
    (setup.drag, setup.steps, setup.options.max_iterations) = (Some(4.0), 1, 2);
    let end = run_unchecked(&model, &setup);
    assert_eq!(end.end, End::NotConverged, "{:?}", end.note);
    setup.options.max_iterations = 400;
    assert_eq!(run_unchecked(&model, &setup).end, End::Reached);
}

/// 270 unknowns: the sparse solver.
#[test]
fn a_larger_sheet_moves_by_the_same_rules() {
    let model = sheet("1.1", "5x3");
    let end = run(&model, &setup(&model, "left", Some(("right", Vec3::new(4.8, 0.0, 0.0))), Vec3::zeros()));
    assert_eq!((end.end, end.share), (End::Reached, 1.0), "{:?}", end.note); // 11.25 + 4.95 is the most
}

/// Energy, gradient and Newton's step of a large sheet, to the bit.
#[test]
fn a_step_does_not_depend_on_the_number_of_threads() {
    let model = sheet("1.1", "12x10");
    let contacts = EnergyOptions::default().contacts(&model);
    let mut state = shaken(&model, 0.01, 8);
    state.poses.iter_mut().for_each(|p| p.position.x *= 1.45);
    let floor = Some(Floor { height: -1.05, alpha: 1e3 });
    let energy = SheetEnergy { loads: Loads { floor, ..Loads::default() }, ..SheetEnergy::new(&model, &contacts) };
    let x = Configuration::start(state);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let here = energy.derivatives(&x);
            let curvature = here.hessian.decompose(&mut Patterns::default()).unwrap();
            (here.energy, energy.energy(&x), curvature.descent_step(&here.gradient, 1e-3).unwrap(), here.gradient)
        })
    };
    let (one, two, five) = (run(1), run(2), run(5));
    assert!(one == two && one == five);
    assert!(one.0 > 1.0 && (one.0 - one.1).abs() < 1e-12 * one.0 && one.2.iter().all(|s| s.is_finite()));
}

/// The places of a setup as grips: what is fixed, and what is pulled.
fn grips(setup: &Setup) -> Vec<Grip> {
    let pulled = setup.pull.iter().map(|(e, _)| *e).collect();
    let way = setup.pull.first().map(|(_, way)| way.clone());
    let fixed = Grip { name: "fixed".into(), elements: setup.fix.clone(), way: None };
    let pulled = Grip { name: "pulled".into(), elements: pulled, way };
    [fixed, pulled].into_iter().filter(|grip| !grip.elements.is_empty()).collect()
}

/// The rows of a run, and the sum of all forces on the sheet from outside in each, which is what is left unbalanced.
fn forces(model: &Model, setup: &Setup, end: &Simulation) -> Vec<(ForceRow, Vec3)> {
    let constant: Vec3 =
        setup.forces.iter().map(|(_, f)| *f).sum::<Vec3>() + setup.gravity * model.elements.len() as f64;
    assert_eq!(end.path.len(), end.rests.len());
    let row = |(frame, state): (&maille::record::FrameRecord, &State)| {
        let row = force_row(model, setup, &grips(setup), frame.share, frame.energy, state);
        let held: Vec3 = row.forces.iter().map(|f| Vec3::from(*f)).sum();
        let sum = held + constant + Vec3::z() * row.floor_force.unwrap_or(0.0);
        (row, sum)
    };
    end.path.iter().zip(&end.rests).map(row).collect()
}

/// In a state that is not at rest: fixed elements against the energy's differences in their position, pulled ones against
/// those of their target, and no floor but where there is one.
#[test]
fn grips_push_as_the_energy_says() {
    let model = sheet("1.3-small", "2x1");
    let by = Vec3::new(0.7, 0.2, -0.1);
    let setup = Setup {
        fix: vec![0, 1],
        pull: vec![(3, vec![by]), (4, vec![by])],
        gravity: Vec3::new(0.1, -0.2, -3.0),
        forces: vec![(1, Vec3::new(5.0, 0.0, 1.0))],
        floor: Some(-1.08),
        options: EnergyOptions { alpha: 30.0, tau: TAU, ..EnergyOptions::default() },
        ..setup(&model, "", None, Vec3::zeros())
    };
    let x = Configuration::start(shaken(&model, 0.03, 5));
    let each: Vec<Grip> = grips(&setup)
        .iter()
        .flat_map(|grip| grip.elements.iter().map(|e| Grip { elements: vec![*e], ..grip.clone() }))
        .collect();
    let row = force_row(&model, &setup, &each, 0.5, 1.0, &x.state);
    let contacts = setup.options.contacts(&model);
    let constant = (0..model.elements.len()).map(|e| (e, setup.gravity * WEIGHT_UNIT));
    let loads = Loads {
        forces: constant.chain([(1, setup.forces[0].1 * WEIGHT_UNIT)]).collect(),
        floor: Some(Floor { height: -1.08, alpha: 30.0 }),
        ..Loads::default()
    };
    let energy = SheetEnergy { loads, ..SheetEnergy::new(&model, &contacts) };
    // Targets are stiff enough for all loads together to move two of them by half of τ.
    let all: f64 = energy.loads.forces.iter().map(|(_, f)| f.norm()).sum();
    let stiffness = (all / (2.0 * setup.options.tau)).max(1.0);
    let targets = [3, 4].map(|element| PositionTarget {
        element,
        position: model.start.poses[element].position + by * 0.5,
        weight: stiffness,
    });
    let pulls = Loads { targets: targets.into(), ..Loads::default() };
    let h = 1e-6;
    let moved = |e: usize, axis: usize, by: f64| {
        let mut state = x.state.clone();
        state.poses[e].position[axis] += by;
        state
    };
    for (grip, force) in each.iter().zip(&row.forces) {
        let e = grip.elements[0];
        for axis in 0..3 {
            let [plus, minus] = [h, -h].map(|by| match grip.way {
                None => energy.energy(&Configuration::start(moved(e, axis, by))),
                Some(_) => -pulls.energy(&model, &moved(e, axis, by)),
            });
            let difference = (plus - minus) / (2.0 * h) / WEIGHT_UNIT;
            let size = Vec3::from(*force).norm().max(1.0);
            assert!((force[axis] - difference).abs() < 1e-5 * size, "{e}, {axis}: {} {difference}", force[axis]);
        }
    }
    assert!(row.forces[0][0].abs() > 1.0, "rings overlap");
    // The floor's force is that which its height feels.
    let at = |height: f64| {
        let floor = Some(Floor { height, alpha: 30.0 });
        Loads { floor, ..Loads::default() }.energy(&model, &x.state)
    };
    let floor = (at(-1.08 + h) - at(-1.08 - h)) / (2.0 * h) / WEIGHT_UNIT;
    assert!(floor > 1.0 && (row.floor_force.unwrap() - floor).abs() < 1e-5 * floor, "{row:?} {floor}");
}

#[test]
fn an_affine_map_is_its_own_deformation_gradient() {
    let model = sheet("1.1", "3x2");
    let f = nalgebra::Matrix2::new(1.3, -0.2, 0.05, 0.9);
    let mut state = shaken(&model, 0.5, 3);
    for (pose, start) in state.poses.iter_mut().zip(&model.start.poses) {
        let xy = f * start.position.xy();
        pose.position = Vec3::new(xy.x + 4.0, xy.y - 3.0, pose.position.z);
    }
    let found = deformation_gradient(&model, &state).unwrap();
    assert!((found - f).norm() < 1e-12, "{found}");
    // Its grips are stretched as the lines along the pull are.
    let by = Vec3::new(2.0, 0.0, 0.0);
    let pulled = setup(&model, "left", Some(("right", by)), Vec3::zeros());
    let row = force_row(&model, &pulled, &grips(&pulled), 0.0, 0.0, &state);
    assert_eq!(row.deformation, Some([[found.m11, found.m12], [found.m21, found.m22]]));
    let middle = |edge: &str| {
        let e = elements_at(&model, edge).unwrap();
        e.iter().map(|e| model.start.poses[*e].position).sum::<Vec3>() / e.len() as f64
    };
    let apart = (middle("right") - middle("left")).xy();
    assert!((row.stretch.unwrap() - (f * apart).x / apart.x).abs() < 1e-12);
    // Pushed together it is the same stretch; the pull is then a push, and across the grips there is none.
    let pushed = setup(&model, "left", Some(("right", -by)), Vec3::zeros());
    assert_eq!(force_row(&model, &pushed, &grips(&pushed), 0.0, 0.0, &state).stretch, row.stretch);
    let sheared = setup(&model, "left", Some(("right", Vec3::y())), Vec3::zeros());
    let across = force_row(&model, &sheared, &grips(&sheared), 0.0, 0.0, &state);
    assert!(across.stretch.is_none() && across.mean_force.is_some());
    // A strip one ring wide has no F.
    let line = sheet("1.1", "1x1");
    let on_one_line = |model: &Model| {
        let mut model = model.clone();
        model.start.poses.iter_mut().for_each(|pose| pose.position.y = 0.0);
        deformation_gradient(&model, &model.start)
    };
    assert!(deformation_gradient(&line, &line.start).is_some() && on_one_line(&line).is_none());
}

/// Chains of three links, 3.75 long at the start and 5.4 at most, give way without a force, and then stop: 5.4/3.75 = 1.44. The
/// stop does not depend on how far a target may be missed, which decides how hard the pull is at the end.
#[test]
fn a_sheet_is_free_and_then_stops() {
    let model = sheet("1.1", "2x2");
    for tau in [0.002, 0.02] {
        let mut pulled = setup(&model, "left", Some(("right", Vec3::new(2.0, 0.0, 0.0))), Vec3::zeros());
        (pulled.steps, pulled.options.tau) = (if tau < 0.01 { 2 } else { 20 }, tau);
        let end = run(&model, &pulled);
        assert_eq!(end.end, End::Locked);
        let rows = forces(&model, &pulled, &end);
        for (row, sum) in &rows {
            let (stretch, force) = (row.stretch.unwrap(), row.mean_force.unwrap());
            assert!(sum.norm() < 1e-2, "{stretch}: {sum:?} is unbalanced");
            assert!(stretch > 1.4399 || force.abs() < 1e-3, "{stretch}: {force}");
            let [fixed, pulling] = [row.forces[0], row.forces[1]].map(Vec3::from);
            assert!(
                (pulling.x / 2.0 - force).abs() < 1e-12 * force.abs().max(1.0) && (fixed + pulling - sum).norm() == 0.0
            );
        }
        let last = &rows.last().unwrap().0;
        assert!((last.stretch.unwrap() - 1.44).abs() < 3e-4, "{last:?}");
        let hardest = 2.0 * tau / WEIGHT_UNIT;
        assert!((0.7 * hardest..=hardest).contains(&last.mean_force.unwrap()), "{last:?}");
    }
}

/// What hangs is held with its weight, what has fallen is carried by the floor, and a sheet that is pulled under weight is
/// held by all of them.
#[test]
fn grips_and_floor_carry_the_weight() {
    let model = sheet("1.1", "1x3");
    let weight = Vec3::new(0.0, -1.0, 0.0);
    let hangs = setup(&model, "top", None, weight);
    let rows = forces(&model, &hangs, &run(&model, &hangs));
    let (row, sum) = rows.last().unwrap();
    let count = model.elements.len() as f64;
    assert!((row.forces[0][1] - count).abs() < 1e-2 * count && sum.norm() < 1e-2 * count, "{row:?}, {sum:?}");
    assert!(row.stretch.is_none() && row.mean_force.is_none() && row.floor_force.is_none());

    let model = sheet("1.1", "2x2");
    let down = Vec3::new(0.0, 0.0, -1.0);
    let lies = Setup { floor: Some(-2.0), ..setup(&model, "", None, down) };
    let pulled = setup(&model, "left", Some(("right", Vec3::new(0.6, 0.0, 0.0))), down);
    let count = model.elements.len() as f64;
    for setup in [lies, Setup { floor: Some(-2.0), ..pulled }] {
        let rows = forces(&model, &setup, &run(&model, &setup));
        assert!(!rows.is_empty());
        for (row, sum) in rows {
            assert!(sum.norm() < 1e-2 * count, "{sum:?} of {count} is unbalanced: {row:?}");
            assert!(row.floor_force.is_some_and(|force| force > 0.1 * count), "{row:?}");
        }
    }
}

/// Onto a gentle sphere and saddle a slack sheet comes without force; a sharp one stops it.
#[test]
fn a_sheet_is_bent_onto_a_surface_until_it_locks() {
    let model = sheet("1.1", "3x3");
    let bent = |curvature: [f64; 2], steps: u32| {
        let still = setup(&model, "left", None, Vec3::zeros());
        let setup = Setup { fix: Vec::new(), bend: Some(curvature), steps, ..still };
        let end = run(&model, &setup);
        let row = force_row(&model, &setup, &[], end.share, end.energy, &end.state);
        (end, row.bend_force.unwrap())
    };
    let middle = |axis: usize| {
        model.start.poses.iter().map(|pose| pose.position[axis]).sum::<f64>() / model.elements.len() as f64
    };
    let middle = [middle(0), middle(1)];
    for curvature in [[0.03, 0.03], [0.03, -0.03]] {
        let (end, force) = bent(curvature, 3);
        assert!(end.end == End::Reached && end.links_ok && force < 0.1, "{curvature:?}: {:?} {force}", end.end);
        for (now, start) in end.state.poses.iter().zip(&model.start.poses) {
            let at = now.position;
            let [x, y] = [at.x - middle[0], at.y - middle[1]];
            let height = start.position.z - 0.5 * (curvature[0] * x * x + curvature[1] * y * y);
            assert!((at.z - height).abs() < TAU, "{at:?} {height}");
        }
    }
    // Between two edges that are held it has to stretch, and locks.
    let held = setup(&model, "left", None, Vec3::zeros());
    let right = elements_at(&model, "right").unwrap();
    let fix = held.fix.iter().copied().chain(right).collect();
    let end = run(&model, &Setup { fix, bend: Some([2.0, 0.0]), steps: 8, ..held });
    assert!(end.end == End::Locked && (0.01..1.0).contains(&end.share), "{:?} {}", end.end, end.share);
    assert!(end.links_ok);
}
