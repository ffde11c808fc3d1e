//! The tightest rolls: symmetry, and that they do not depend on how the sheet is written.

use maille::{Across, Effort, Question, Sheet, Status, lattice::Cell};

/// A built-in design in one cell.
fn sheet(name: &str, cell: &str) -> Sheet {
    let design = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
    Sheet::in_cells(&design, cell.parse::<Cell>().unwrap().into()).unwrap()
}

const FREE: Across = Across { lateral_free: true, shear_free: true };

#[test]
fn a_mirror_symmetric_sheet_bends_both_ways_alike() {
    for (name, direction_deg, free) in [
        ("european-4-in-1", 90.0, Across::HELD),
        ("european-4-in-1", 90.0, FREE),
        ("european-4-in-1", 0.0, Across::HELD),
        // An element that is held beside the axis ended these.
        ("2", 0.0, Across::HELD),
        ("2", 45.0, Across::HELD),
    ] {
        let sheet = sheet(name, "1x1");
        let [below, above] = [1.0, -1.0].map(|sign| {
            let question = Question::curvature_along(direction_deg, sign).with_free(free);
            sheet.answer(&Question { effort: Effort::Low, ..question }).unwrap()
        });
        assert_eq!((below.status, above.status), (Status::Local, Status::Local), "{name} {direction_deg}");
        let [below, above] = [below, above].map(|answer| answer.value.unwrap());
        assert!((below + above).abs() < 1e-9, "{name} {direction_deg}: {below} {above}");
    }
}

#[test]
fn neither_basis_nor_the_sign_of_the_direction_counts() {
    let answer = |cell: &str, direction_deg: f64| {
        let question = Question { effort: Effort::Low, ..Question::curvature_along(direction_deg, 1.0) };
        sheet("european-4-in-1", cell).answer(&question).unwrap().value.unwrap()
    };
    let known = answer("1x1", 70.0);
    for (cell, direction_deg) in [("2,1;1,1", 70.0), ("1x1", 250.0)] {
        let found = answer(cell, direction_deg);
        assert!((found - known).abs() < 1e-9, "{cell} {direction_deg}: {found} {known}");
    }
}
