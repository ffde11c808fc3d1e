//! Fits from request to record: what is written is what was found, and the design of a fit has the limits that the record says.

use maille::{
    CellChoice, Design, Sheet,
    fit::{Ended, FitOptions, Measure, Norm, Target, Wanted},
};
use maille_io::{
    builtin,
    fit::{FIT, FitRecord, FitRequest, FreeSpec, document, fitted_design, open_fit, target_rows},
    read_design, write_design,
};
use std::sync::atomic::AtomicBool;

fn design(name: &str) -> Design {
    read_design(name, builtin(name).unwrap()).unwrap()
}

fn specs(texts: &[&str]) -> Vec<FreeSpec> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn along(direction_deg: f64, wanted: Wanted) -> Target {
    Target { measure: Measure::Stretch { direction_deg, l2: 0.0 }, wanted, weight: 1.0 }
}

fn options() -> FitOptions {
    FitOptions { cells: CellChoice::These(vec![maille::Cell::PRIMITIVE]), ..FitOptions::default() }
}

fn solve(request: &FitRequest) -> (maille::fit::Fit, Design) {
    let cancel = AtomicBool::new(false);
    let found = request.solve(None, &|_| (), &cancel).unwrap();
    let design = fitted_design(request, &found.numbers, &cancel).unwrap();
    (found, design)
}

/// l1 of a design that is written and read again.
fn l1(design: &Design, target: &Target) -> f64 {
    let again = read_design("fitted", &write_design(design)).unwrap();
    let sheet = Sheet::in_cells(&again, options().cells).unwrap();
    sheet.answer(&target.question()).unwrap().limit().unwrap()
}

#[test]
fn a_fitted_design_has_the_wanted_limits() {
    let mut wanted = [(0.0, 0.40), (90.0, 0.48), (45.0, 0.6)].map(|(angle, l1)| along(angle, Wanted::Value(l1)));
    wanted[2].wanted = Wanted::AtLeast(0.6);
    let (free, each) = (specs(&["minor_radius=0.05:0.2"]), specs(&["elements.*.rings.major_radius=25%"]));
    let request =
        FitRequest::new(&design("1.1"), [1, 1], (&free, &each), (wanted.to_vec(), false), None, options()).unwrap();
    let (found, fitted) = solve(&request);
    assert_eq!(found.ended, Ended::Reached);
    assert!(!fitted.allow_initial_overlap && fitted.name == "1.1-fitted" && fitted.varied.is_empty());
    for target in &wanted {
        let off = l1(&fitted, target) - target.wanted.value();
        let right = if matches!(target.wanted, Wanted::Value(_)) { off.abs() < 2e-6 } else { off > -2e-6 };
        assert!(right, "{target:?}: {off}");
    }
    let record = FitRecord::finished(&request, &found).unwrap();
    assert!(record.is_final(&request));
    let folder = tempfile::tempdir().unwrap();
    record.save(folder.path()).unwrap();
    let read = open_fit(folder.path()).unwrap();
    assert_eq!(read, record);
    assert_eq!(target_rows(&read).len(), 3);
    assert_eq!(document(&read)["numbers"].as_array().unwrap().len(), 4);
    let file = folder.path().join(FIT);
    let edited = std::fs::read_to_string(&file).unwrap().replacen("\"reached\"", "\"missed\"", 1);
    std::fs::write(&file, edited).unwrap();
    assert!(open_fit(folder.path()).unwrap_err().to_string().contains("edited"));
}

/// The largest miss of two limits that cannot both be had is smallest where both are missed alike.
#[test]
fn minimax_misses_alike() {
    // Along both directions the wire alone counts: l1 = 0.6 − 1.6 r.
    let wanted = vec![along(0.0, Wanted::Value(0.40)), along(90.0, Wanted::Value(0.50))];
    let free = specs(&["minor_radius=0.05:0.2"]);
    let minimax = FitOptions { norm: Norm::Minimax, starts: 2, ..options() };
    let request = FitRequest::new(&design("1.1"), [1, 1], (&free, &[]), (wanted, false), None, minimax).unwrap();
    let (found, _) = solve(&request);
    assert_eq!(found.ended, Ended::Missed);
    assert!((found.misses[0] - 0.05).abs() < 1e-6 && (found.misses[1] + 0.05).abs() < 1e-6, "{:?}", found.misses);
    // 0.5 is within the bound of the thinnest wire: nothing forbids it.
    let record = FitRecord::finished(&request, &found).unwrap();
    assert!(record.outcome.targets.iter().all(|target| !target.forbidden));
    assert!((record.outcome.targets[1].family_bound.unwrap() - 0.52).abs() < 1e-9);
}

#[test]
fn what_no_design_of_the_family_reaches_is_said() {
    let wanted = vec![along(0.0, Wanted::AtLeast(0.6)), along(45.0, Wanted::AtMost(1.0))];
    let free = specs(&["minor_radius=0.05:0.2"]);
    let request = FitRequest::new(&design("1.1"), [1, 1], (&free, &[]), (wanted, false), None, options()).unwrap();
    let (found, _) = solve(&request);
    let targets = FitRecord::finished(&request, &found).unwrap().outcome.targets;
    assert!(targets[0].forbidden && !targets[1].forbidden && targets[1].miss == 0.0);
    assert!((found.misses[0] + 0.08).abs() < 1e-9 && !targets[0].held_by.is_empty());
}

/// A wider gap costs stretch: thinner wire is found that leaves it.
#[test]
fn a_gap_is_kept() {
    let wanted = vec![along(0.0, Wanted::AtLeast(0.3))];
    let free = specs(&["minor_radius=0.02:0.2"]);
    let roomy = FitRequest::new(&design("1.1"), [1, 1], (&free, &[]), (wanted, false), Some(0.17), options()).unwrap();
    let (found, fitted) = solve(&roomy);
    assert_eq!(found.ended, Ended::Reached, "{:?}", found.misses);
    let gap = Sheet::compile(&fitted).unwrap().answer(&roomy.targets[1].question()).unwrap().limit().unwrap();
    assert!(gap >= 0.17 - 2e-6, "{gap}");
}

/// Each copy of a ring gets a number of its own, and a sheet of alike cells is the same sheet.
#[test]
fn supercells_have_numbers_for_each_copy() {
    let wanted = vec![along(0.0, Wanted::AtLeast(0.44))];
    let each = specs(&["elements.*.rings.major_radius=10%"]);
    let request = FitRequest::new(&design("1.1"), [2, 1], (&[], &each), (wanted, false), None, options()).unwrap();
    assert_eq!(request.free.len(), 6);
    assert_eq!(request.free[3].name, "elements.flat-1-0.rings.0.major_radius");
    let (found, _) = solve(&request);
    assert!((found.before[0].limit().unwrap() - 0.44).abs() < 1e-9);
    for wrong in [[0, 1], [100, 100]] {
        let request =
            FitRequest::new(&design("1.1"), wrong, (&[], &each), (request.targets.clone(), false), None, options());
        assert!(request.unwrap_err().problem.contains("not a supercell"));
    }
}

/// Formulas of a design hold in its copies: parameters move the supercell as they move the cell.
#[test]
fn parameters_move_supercells() {
    let design = read_design("square", include_str!("../../../../examples/parameters/square.toml")).unwrap();
    let repeated = design.repeated(2, 3);
    assert!(repeated.problems().is_empty(), "{:?}", repeated.problems());
    assert_eq!(repeated.elements.len(), 18);
    let values = [("radius", 5.0), ("play", 1.1), ("tilt", 12.0)];
    let moved = repeated.with_parameters(&values).unwrap();
    let expected = design.with_parameters(&values).unwrap().repeated(2, 3);
    for (a, b) in moved.elements.iter().zip(&expected.elements) {
        assert_eq!((&a.name, &a.rings), (&b.name, &b.rings));
        assert!((0..3).all(|k| (a.center[k] - b.center[k]).abs() < 1e-12));
    }
    assert!((0..3).all(|k| (moved.lattice.a1[k] - expected.lattice.a1[k]).abs() < 1e-12));
    let question = along(30.0, Wanted::Value(0.0)).question();
    let limit = |design: &Design| {
        let sheet = Sheet::in_cells(design, options().cells).unwrap();
        sheet.answer(&question).unwrap().limit().unwrap()
    };
    let (one, two) = (limit(&design), limit(&design.repeated(2, 1)));
    assert!(two >= one - 1e-9, "{two} in two cells, {one} in one");
}
