//! Limits with width or shear free, and queries in the space of strains.

use crate::common::{builtin, map};
use maille::{
    answer::Answer,
    lattice::{Across, Cell},
    model::Model,
    question::{Effort, Goal, Question, Sense, Strain, StrainQuery},
    record::{LimitRow, Status},
    search::{
        ExactOptions,
        strain::{StrainMethod, StrainOptions},
    },
    sheet::Sheet,
    state::State,
    survey::surface::{Boundary, BoundaryOptions, BoundaryVertex, Pass, boundary},
};
use nalgebra::Matrix2;
use std::{
    slice,
    sync::{Mutex, atomic::AtomicBool},
};

fn model(name: &str) -> Model {
    Model::compile(&builtin(name), Cell::PRIMITIVE).unwrap()
}

fn rows(model: &Model, directions: &[f64], l2: &[f64], across: Across) -> Vec<LimitRow> {
    let options = ExactOptions { effort: Effort::Low, across, ..ExactOptions::default() };
    map(slice::from_ref(model), directions, l2, &options).into_iter().map(|f| f.row).collect()
}

const LATERAL: Across = Across { lateral_free: true, shear_free: false };

/// Never below the best of a scan of l2, and not above it by more than the scan can miss.
#[test]
fn free_width_is_the_best_of_a_scan() {
    for (name, direction, step) in
        [("1.1", 0.0, 0.05), ("1.1", 45.0, 0.02), ("3.1", 30.0, 0.02), ("european-4-in-1", 45.0, 0.005)]
    {
        let model = model(name);
        let free = &rows(&model, &[direction], &[0.0], LATERAL)[0];
        let l1 = free.l1.unwrap_or_else(|| panic!("{name} {direction}: {:?}", free.status));
        let at = free.l2_min.unwrap();
        let scan: Vec<f64> = (-2..=2).map(|k| at + f64::from(k) * step).filter(|l2| *l2 > -1.0).collect();
        let held = rows(&model, &[direction], &scan, Across::HELD);
        let best = held.iter().filter_map(|row| row.l1).fold(f64::NEG_INFINITY, f64::max);
        assert!(l1 >= best - 1e-9, "{name} {direction}: {l1} < {best}");
        assert!(l1 <= best + 0.2 * step, "{name} {direction}: {l1}, scan {best}");
        assert_eq!((free.lateral.as_deref(), free.shear.as_deref()), (Some("free"), Some("fixed")));
        assert!(free.l2_min <= free.l2_max && free.bound_l1.unwrap() >= l1 - 1e-9);
    }
}

/// Freeing more never costs anything, and along a straight chain the width is not unique.
#[test]
fn freeing_more_is_never_less() {
    let model = model("1.1");
    let both = Across { lateral_free: true, shear_free: true };
    let [held, free, all] = [Across::HELD, LATERAL, both].map(|across| rows(&model, &[0.0], &[0.0], across).remove(0));
    assert_eq!([held.status, free.status, all.status], [Status::Global; 3]);
    let ends = (free.l2_min.unwrap(), free.l2_max.unwrap());
    assert!(ends.0 < -0.3 && ends.1 > 0.439, "{ends:?}");
    assert_eq!((held.l2_min, held.l2_max, held.shear_max), (Some(0.0), Some(0.0), Some(0.0)));
    assert!((all.l1.unwrap() - 0.44).abs() < 1e-9);
}

/// The width at a limit is found with l1 given way a little, but no width is reported that is proved to be out of reach.
#[test]
fn no_width_lies_above_what_is_proved() {
    for name in ["3.1", "1.1", "european-4-in-1"] {
        let model = model(name);
        // The largest stretch across the pull, whatever becomes of the length.
        let most = rows(&model, &[90.0], &[0.0], Across { lateral_free: true, shear_free: true })[0].bound_l1.unwrap();
        for across in [LATERAL, Across { lateral_free: true, shear_free: true }] {
            let row = &rows(&model, &[0.0], &[0.0], across)[0];
            let [least, largest] = [row.l2_min, row.l2_max].map(Option::unwrap);
            assert!(largest <= most + 1e-12, "{name}: l2 up to {largest}, proved {most}");
            assert!(least <= largest, "{name}: {least} {largest}");
            let [low, high] = [row.shear_min, row.shear_max].map(Option::unwrap);
            assert!(low <= 1e-12 && high >= -1e-12, "{name}: shear {low} to {high}");
        }
    }
    // It is reached: 3.1 is as wide at 0° as it can be at all.
    let row = &rows(&model("3.1"), &[0.0], &[0.0], LATERAL)[0];
    assert!((row.l2_max.unwrap() - 0.44).abs() < 1e-6, "{:?}", row.l2_max);
}

fn unit(i: usize, j: usize) -> Matrix2<f64> {
    let mut e = Matrix2::zeros();
    (e[(i, j)], e[(j, i)]) = (1.0, 1.0);
    e
}

fn solve(model: &Model, query: &StrainQuery) -> Answer {
    let models = slice::from_ref(model);
    StrainMethod::new(models, StrainOptions::default()).solve(query, &[], &AtomicBool::new(false))
}

/// With the others free E_xx is l1 + l1²/2 of a pull with width and shear free; in between lies the trellis of 1.1.
#[test]
fn green_strains_of_known_limits() {
    let model = model("1.1");
    let all = |first: usize| {
        let mut free = vec![unit(0, 0), unit(1, 1), unit(0, 1)];
        free.swap(0, first);
        StrainQuery { held: Matrix2::zeros(), free }
    };
    let xx = solve(&model, &all(0));
    assert_eq!(xx.status, Status::Global);
    assert!((xx.value.unwrap() - (0.44 + 0.5 * 0.44 * 0.44)).abs() < 1e-9, "{xx:?}");
    // F = diag(1.774, 1) at 45°: E_xx = E_yy = E_xy = ½ E_11, on the line E_xx = E_yy = t + s, E_xy = t − s at s = 0.
    let diagonal = StrainQuery { held: Matrix2::zeros(), free: vec![Matrix2::from_element(0.5)] };
    let along = solve(&model, &diagonal);
    let l1 = 0.774034949;
    assert_eq!(along.status, Status::Global);
    assert!((along.value.unwrap() - (l1 + 0.5 * l1 * l1)).abs() < 1e-8, "{along:?}");
    let held = StrainQuery { held: unit(1, 1) * 0.05, free: vec![unit(0, 0), unit(0, 1)] };
    let with_width = solve(&model, &held);
    assert!((with_width.green_strain()[(1, 1)] - 0.05).abs() < 1e-12);
    assert_eq!(with_width.status, Status::Global);
    let impossible = StrainQuery { held: unit(1, 1) * 0.6, free: vec![unit(0, 0), unit(0, 1)] };
    assert_eq!(solve(&model, &impossible).status, Status::L2Unreachable);
}

/// Where a straight chain binds, the free strains of the state that is found are some of many; where rings lock they are not.
#[test]
fn free_strains_that_are_not_unique_have_a_range() {
    let model = model("1.1");
    let query = StrainQuery { held: Matrix2::zeros(), free: vec![unit(0, 0), unit(1, 1), unit(0, 1)] };
    let found = solve(&model, &query);
    let [yy, xy] = found.ranges[..] else { panic!("{:?}", found.ranges) };
    // As wide as the sheet can be, by its own chain, and narrow by folding.
    assert!((yy[1] - (0.44 + 0.5 * 0.44 * 0.44)).abs() < 1e-5 && yy[1] <= 0.5368 + 1e-9, "{yy:?}");
    assert!(yy[0] < -0.25, "{yy:?}");
    for (range, value) in [(yy, found.green_strain()[(1, 1)]), (xy, found.green_strain()[(0, 1)])] {
        assert!(range[0] <= value + 1e-9 && value <= range[1] + 1e-9, "{value} of {range:?}");
    }
    // The largest E_yy of European 4-in-1 with all else free: a single state, but for the slack's root.
    let model = self::model("european-4-in-1");
    let query = StrainQuery { held: Matrix2::zeros(), free: vec![unit(1, 1), unit(0, 0), unit(0, 1)] };
    let found = solve(&model, &query);
    assert_eq!(found.ranges.len(), 2);
    assert!(found.ranges.iter().all(|range| range[1] - range[0] < 2e-3), "{:?}", found.ranges);
    assert!(solve(&model, &StrainQuery { held: Matrix2::zeros(), free: vec![unit(1, 1)] }).ranges.is_empty());
}

/// The largest strains of the published surface of European 4-in-1, each with the other two free.
#[test]
fn european_4_in_1_reaches_the_published_strains() {
    let model = model("european-4-in-1");
    for (name, (i, j), mark) in [("xx", (0, 0), 0.0556), ("yy", (1, 1), 0.1539), ("xy", (0, 1), 0.1115)] {
        let others = [(0, 0), (1, 1), (0, 1)].into_iter().filter(|at| *at != (i, j)).map(|(i, j)| unit(i, j));
        let query = StrainQuery { held: Matrix2::zeros(), free: std::iter::once(unit(i, j)).chain(others).collect() };
        let found = solve(&model, &query);
        let value = found.value.unwrap();
        assert!(value >= mark, "E_{name} = {value}");
        assert!(matches!(found.status, Status::Local | Status::Global), "{:?}", found.status);
        assert!(found.links_ok == Some(true) && found.certificate.unwrap().smallest_gap > -1e-12);
        assert!(found.bound.unwrap() >= value - 1e-9);
    }
}

/// Compression: the least l1 of a map, with width and shear free, is the least E_xx of a query, 1 + 2 E_xx = (1 + l1)²; each
/// larger cell is at least as low as the smallest, whose answer it starts from; and nothing is called proved.
#[test]
fn the_least_l1_is_that_of_the_query_and_falls_with_the_cell() {
    let name = "european-4-in-1";
    let design = builtin(name);
    let models = ["1x1", "2x1", "1x2"].map(|cell| Model::compile(&design, cell.parse().unwrap()).unwrap());
    let cancel = AtomicBool::new(false);
    let free = vec![-unit(0, 0), unit(1, 1), unit(0, 1)];
    let options = StrainOptions { starts: Some(6), sense: Sense::Least, ..StrainOptions::default() };
    let query = StrainMethod::new(&models, options).solve(&StrainQuery { held: Matrix2::zeros(), free }, &[], &cancel);
    assert_eq!((query.status, query.cell.to_string().as_str(), query.by_cell.len()), (Status::Local, "2x1", 3));
    assert!(query.by_cell.iter().all(|t| t.n_starts >= 6 && t.n_distinct >= 1));
    assert!(query.by_cell[1..].iter().all(|t| t.value.unwrap() <= query.by_cell[0].value.unwrap() + 1e-7));
    let across = Across { lateral_free: true, shear_free: true };
    let options = ExactOptions { starts: Some(6), across, compression: true, ..ExactOptions::default() };
    let found = map(&models, &[0.0], &[0.0], &options).remove(0);
    let (row, l1) = (&found.row, found.row.l1.unwrap());
    let strain = l1 + 0.5 * l1 * l1;
    assert!((strain - query.value.unwrap()).abs() < 1e-7, "{strain}, query {:?}", query.value);
    assert_eq!((row.status, row.cell.as_str(), row.end.as_deref()), (Status::Local, "2x1", Some("least")));
    assert_eq!(row.by_cell.as_ref().unwrap().matches("starts").count(), 3);
    assert!(row.bound_l1.is_none() && row.links_ok == Some(true));
    assert!(row.min_gap.unwrap() > -1e-12 * design.reference_radius);
    // Where both ends are asked for the least is below.
    let largest = rows(&models[0], &[0.0], &[0.0], across).remove(0);
    assert!(l1 < largest.l1.unwrap() && largest.end.as_deref() == Some("largest"));
}

/// A bound that is attained proves a largest strain; the same strain as a compression is not called global.
#[test]
fn a_compression_is_never_global() {
    let model = model("1.1");
    let query = StrainQuery { held: Matrix2::zeros(), free: vec![Matrix2::from_element(0.5)] };
    let status = |sense: Sense| {
        let options = StrainOptions { sense, ..StrainOptions::default() };
        StrainMethod::new(slice::from_ref(&model), options).solve(&query, &[], &AtomicBool::new(false)).status
    };
    assert_eq!([status(Sense::Largest), status(Sense::Least)], [Status::Global, Status::Local]);
}

/// A surface to a tolerance from one start, and the ends of its rays as a journal keeps them: before neighbours hand on their states.
fn surface(
    model: &Model,
    tolerance: f64,
    most: usize,
    known: &[BoundaryVertex],
) -> (Boundary, Vec<BoundaryVertex>, usize) {
    let options = BoundaryOptions { tolerance, most, starts: Some(1), ..BoundaryOptions::default() };
    let (planned, first) = (Mutex::new(0), Mutex::new(Vec::new()));
    let found = |vertex: &BoundaryVertex| first.lock().unwrap().push(vertex.clone());
    let mut passes = |pass| match pass {
        Pass::New(rays) => *planned.lock().unwrap() += rays,
        Pass::Again(rays) => assert!(rays > 0),
    };
    let surface = boundary(model, &options, known, &AtomicBool::new(false), &mut passes, &found);
    (surface, first.into_inner().unwrap(), planned.into_inner().unwrap())
}

/// Each ray ends within its bound, and a run that goes on from some vertices gives the same.
#[test]
fn the_surface_is_that_of_its_rays_and_goes_on() {
    let model = model("4.1");
    let all = StrainQuery { held: Matrix2::zeros(), free: vec![unit(0, 0), unit(1, 1), unit(0, 1)] };
    let most_xx = solve(&model, &all).bound.unwrap();
    let (whole, found, planned) = surface(&model, 0.02, 200, &[]);
    assert!(whole.complete && whole.vertices.len() > 162 && whole.vertices.len() <= 200);
    assert_eq!(planned, whole.vertices.len());
    for vertex in &whole.vertices {
        let (distance, bound) = (vertex.distance.unwrap(), vertex.bound.unwrap());
        assert!(distance > 0.0 && distance <= bound + 1e-9, "{vertex:?}");
        assert!(vertex.point(distance)[0] <= most_xx + 1e-9);
    }
    let global = whole.vertices.iter().filter(|v| v.status == Status::Global).count();
    assert!(global > whole.vertices.len() / 4, "{global}");
    let is_known = |v: &&BoundaryVertex| whole.vertices.iter().step_by(2).any(|even| even.direction == v.direction);
    let known: Vec<BoundaryVertex> = found.iter().filter(is_known).cloned().collect();
    let (again, _, planned) = surface(&model, 0.02, 200, &known);
    assert_eq!(again.vertices, whole.vertices);
    assert_eq!(planned, whole.vertices.len() / 2);
    assert!(whole.open == 0 && (whole.jumps > 0 || whole.arch <= 0.02));
    // A finer tolerance stops where there is no room.
    let (stopped, ..) = surface(&model, 0.017, 200, &found);
    assert!(stopped.open > 0 && stopped.arch > 0.017 && stopped.vertices.len() == 200);
}

/// With room a finer tolerance goes on, and no ray ends earlier.
#[test]
fn a_surface_is_made_finer() {
    let model = model("1.1");
    let (coarse, ..) = surface(&model, 0.1, 200, &[]);
    // No chain along x is longer than 3.6 for 2.5.
    let most_xx = 0.44 + 0.5 * 0.44 * 0.44 + 1e-9;
    assert!(coarse.complete && coarse.vertices.iter().all(|v| v.point(v.distance.unwrap())[0] <= most_xx));
    let (finer, _, planned) = surface(&model, 0.05, 1000, &coarse.vertices);
    assert!(finer.open == 0 && finer.vertices.len() < 1000, "{} {}", finer.open, finer.vertices.len());
    assert!(planned < finer.vertices.len());
    for old in &coarse.vertices {
        let new = finer.vertices.iter().find(|new| new.direction == old.direction).unwrap();
        assert!(new.distance.unwrap() >= old.distance.unwrap(), "{old:?} {new:?}");
    }
    if finer.jumps == 0 {
        assert!(finer.arch <= 0.05);
    }
}

/// 1.1 along x locks with straight chains, l1 = 0.44: F = diag(1.44, 0.875) of the square of side 2.5, in any cell.
#[test]
fn a_limit_has_the_lattice_of_the_design_s_own_cell() {
    let design = builtin("1.1");
    for (cell, scale) in [([[1, 0], [0, 1]], 1.0), ([[1, 1], [-1, 1]], 1.0), ([[1, 0], [0, 1]], 7.0)] {
        let model = Model::compile(&design.scaled(scale), Cell::new(cell).unwrap()).unwrap();
        let row = rows(&model, &[0.0], &[-0.125], Across::HELD).remove(0);
        let lattice = [row.a1_x, row.a1_y, row.a2_x, row.a2_y].map(Option::unwrap);
        for (found, expected) in lattice.into_iter().zip([1.44 * 2.5, 0.0, 0.0, 0.875 * 2.5]) {
            assert!((found - expected).abs() < 1e-8, "{cell:?}, {scale}: {lattice:?}");
        }
    }
}

/// Pushed together, with the width held, with it free, and with all free: one answer, whether it is asked for as a strain or as
/// a map.
#[test]
fn the_least_strain_is_the_compression_of_a_map() {
    let design = builtin("1.1");
    let sheet = Sheet::in_cells(&design, Cell::PRIMITIVE.into()).unwrap();
    for (free, across) in [
        (vec![], Across::HELD),
        (vec![Strain::Eyy], LATERAL),
        (vec![Strain::Eyy, Strain::Exy], Across { lateral_free: true, shear_free: true }),
    ] {
        let goal = Goal::Strain { component: Strain::Exx, direction_deg: 60.0, fix: vec![], free };
        let answer = sheet.answer(&Question::new(goal, Sense::Least)).unwrap();
        let options = ExactOptions { across, compression: true, ..ExactOptions::default() };
        let row = map(slice::from_ref(sheet.model()), &[60.0], &[0.0], &options).remove(0).row;
        let l1 = row.l1.unwrap_or_else(|| panic!("{across:?}: {:?}", row.status));
        assert_eq!(answer.status, row.status);
        assert!((answer.value.unwrap() - l1 - 0.5 * l1 * l1).abs() < 1e-12, "{across:?}: {l1}, {:?}", answer.value);
        assert!(l1 < -0.7 && answer.bound.is_none());
    }
}

/// Two places of one pair of rings, 0.01 R apart, hold 1.1 at 5° with the width free: they are closed to a certificate's tolerance.
#[test]
fn free_width_along_nearly_straight_chains() {
    let row = rows(&model("1.1"), &[5.0], &[0.0], LATERAL).remove(0);
    assert!(matches!(row.status, Status::Local | Status::Global), "{:?}", row.status);
    // With l2 held at −0.7 the bound is attained, 0.44526226.
    assert!(row.l1.is_some_and(|l1| (0.445262..0.445501).contains(&l1)), "{:?}", row.l1);
}

/// European 4-in-1 compressed along x folds in a larger cell, to which an unstable wave leads; a neighbouring ray goes on from that state
/// in its cell, without a wave of its own.
#[test]
fn states_of_larger_cells_are_handed_on() {
    let model = model("european-4-in-1");
    let solve = |free: Matrix2<f64>, from: &[(Cell, State)], follow_waves: bool| {
        let options = StrainOptions { starts: Some(1), follow_waves, ..StrainOptions::default() };
        let query = StrainQuery { held: Matrix2::zeros(), free: vec![free] };
        StrainMethod::new(slice::from_ref(&model), options).solve(&query, from, &AtomicBool::new(false))
    };
    let along = Matrix2::new(-1.0, 0.0, 0.0, 0.0);
    let [own, folded] = [false, true].map(|follow_waves| solve(along, &[], follow_waves));
    assert!(own.cell == Cell::PRIMITIVE && folded.cell.copies() > 1);
    assert!(folded.value.unwrap() > 2.0 * own.value.unwrap(), "{:?} {:?}", folded.value, own.value);
    let beside = solve(Matrix2::new(-1.0, 0.0, 0.0, 0.05), &[(folded.cell, folded.state.clone())], false);
    assert_eq!((beside.cell, beside.status), (folded.cell, Status::Local));
    assert!(beside.value.unwrap() > 2.0 * own.value.unwrap() && beside.links_ok == Some(true));
}
