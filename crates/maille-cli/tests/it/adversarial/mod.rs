//! Designs at the edge of what a design can be: each has a stated answer, and what is certified is verified.

mod curves;

use crate::common::outcome;
use serde_json::Value;
use std::{fmt::Write as _, fs, path::Path};

/// Direction, l2, status and l1 of the rows of a design in its own cell, at 0°, 45° and 90° with these l2; the exit codes of `characterize`
/// and of `verify`.
struct Answer {
    rows: Vec<(f64, f64, String, Option<f64>)>,
    codes: (i32, Option<i32>),
    said: String,
}

/// The rows of the record in a folder.
fn rows(folder: &Path) -> Vec<Value> {
    let table: Value = serde_json::from_str(&outcome(folder, "table record --format json").1).unwrap();
    table["rows"].as_array().unwrap().clone()
}

fn answer(design: &str, l2: &str) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("design.toml"), design).unwrap();
    let line = format!("characterize design.toml --directions 0,45,90 --l2={l2} --cell 1x1 --out record --quiet");
    let (code, _, said) = outcome(folder.path(), &line);
    if !folder.path().join("record/limits.csv").exists() {
        return Answer { rows: Vec::new(), codes: (code, None), said };
    }
    let number = |row: &Value, name: &str| row[name].as_f64();
    let row = |row: &Value| {
        let at = |name: &str| number(row, name).unwrap();
        (at("direction_deg"), at("l2"), row["status"].as_str().unwrap().to_owned(), number(row, "l1"))
    };
    let rows = rows(folder.path()).iter().map(row).collect();
    let (verified, said, _) = outcome(folder.path(), "verify record --quiet");
    Answer { rows, codes: (code, Some(verified)), said }
}

/// A ring as an element: centre, normal, major radius, and a minor radius of its own.
type Single = ([f64; 3], [f64; 3], f64, Option<f64>);

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

fn design(basis: [[f64; 3]; 2], minor_radius: f64, reference_radius: f64, rings: &[Single]) -> String {
    let [a1, a2] = basis;
    let mut out = format!(
        "schema = 1\nname = \"edge\"\nminor_radius = {minor_radius:?}\nreference_radius = {reference_radius:?}\n\n[lattice]\na1 = {a1:?}\na2 = {a2:?}\n"
    );
    for (k, (center, normal, radius, own)) in rings.iter().enumerate() {
        let own = own.map_or(String::new(), |r| format!(", minor_radius = {r:?}"));
        write!(
            out,
            "\n[[elements]]\nname = \"e{k}\"\ncenter = {center:?}\nrings = [{{ major_radius = {radius:?}, normal = {normal:?}{own} }}]\n"
        )
        .unwrap();
    }
    out
}

/// 1.1 with spacing a, minor radius r, all times `scale`, moved by `by`, in a basis whose second vector is a2 + shear a1.
fn grid(a: f64, r: f64, scale: f64, by: f64, shear: f64) -> String {
    let at = |x: f64, y: f64| [scale * x + by, scale * y - by, by];
    let basis = [[scale * a, 0.0, 0.0], [scale * a * shear, scale * a, 0.0]];
    let rings =
        [(at(0.0, 0.0), Z, scale, None), (at(a / 2.0, 0.0), Y, scale, None), (at(0.0, a / 2.0), X, scale, None)];
    design(basis, r * scale, scale, &rings)
}

/// The closed form of the grid at 0° and 90°, and at 45°: a chain of length d = 4 − 4r for a, or for both axes at once.
fn of_grid(a: f64, r: f64, direction_deg: f64, l2: f64) -> f64 {
    let d = 4.0 - 4.0 * r;
    if direction_deg == 45.0 {
        let part = a / 2.0_f64.sqrt();
        (d * d - ((1.0 + l2) * part).powi(2)).sqrt() / part - 1.0
    } else {
        d / a - 1.0
    }
}

/// All rows are global with the closed form's l1, and proved.
fn is_the_grid(answer: &Answer, a: f64, r: f64, within: f64) {
    assert_eq!(answer.codes, (0, Some(0)), "{}", answer.said);
    assert!(!answer.rows.is_empty());
    for (direction_deg, l2, status, l1) in &answer.rows {
        let expected = of_grid(a, r, *direction_deg, *l2);
        assert_eq!(status, "global", "{direction_deg}° {l2}");
        assert!((l1.unwrap() - expected).abs() < within, "{direction_deg}° {l2}: {l1:?}, {expected}");
    }
}

fn all_are(answer: &Answer, status: &str) {
    assert_eq!(answer.codes, (0, Some(0)), "{}", answer.said);
    assert!(!answer.rows.is_empty() && answer.rows.iter().all(|row| row.2 == status && row.3.is_none()));
}

#[test]
fn needles_have_the_closed_form() {
    is_the_grid(&answer(&grid(2.5, 1e-4, 1.0, 0.0, 0.0), "-0.1,0"), 2.5, 1e-4, 1e-12);
}

#[test]
fn lengths_of_a_million_and_of_a_millionth_change_nothing() {
    for scale in [1e6, 1e-6] {
        is_the_grid(&answer(&grid(2.5, 0.1, scale, 0.0, 0.0), "-0.1,0"), 2.5, 0.1, 1e-12);
    }
}

#[test]
fn lattice_vectors_at_one_degree_give_the_same_limits() {
    // 57 a1 + a2 stands at 1.005° from a1.
    is_the_grid(&answer(&grid(2.5, 0.1, 1.0, 0.0, 57.0), "-0.25,-0.1,0,0.1"), 2.5, 0.1, 1e-12);
}

/// What is far from the origin is solved near it.
#[test]
fn a_million_radii_from_the_origin_the_limits_are_the_same() {
    for by in [2e3, 1e6, -1e9] {
        is_the_grid(&answer(&grid(2.5, 0.1, 1.0, by, 0.0), "-0.1,0"), 2.5, 0.1, 1e-12);
    }
}

/// A floor is where the design's coordinates have it, and a design that is written keeps its place.
#[test]
fn far_designs_keep_their_place() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("far.toml"), grid(2.5, 0.1, 1.0, 1e6, 0.0)).unwrap();
    let drop = |floor: &str| {
        let line = format!("simulate far.toml --tile 1x1 --gravity 0,0,-1 --floor {floor} --steps 1 --out down --json");
        outcome(folder.path(), &line)
    };
    let (code, _, said) = drop("1000000");
    assert_eq!((code, said.contains("1000000 is above the lowest point of")), (2, true), "{said}");
    let (code, out, said) = drop("999997");
    assert_eq!(code, 0, "{said}");
    assert_eq!(serde_json::from_str::<Value>(&out).unwrap()["outcome"]["end"], "reached");
    let (code, out, said) = outcome(folder.path(), "roomiest far.toml --json --save roomy.toml");
    assert_eq!(code, 0, "{out}{said}");
    let roomy = fs::read_to_string(folder.path().join("roomy.toml")).unwrap();
    let center = roomy.lines().find_map(|line| line.strip_prefix("center = [")?.strip_suffix(']')).unwrap();
    for (x, expected) in center.split(',').zip([1e6, -1e6, 1e6]) {
        assert!((x.trim().parse::<f64>().unwrap() - expected).abs() < 3.0, "{center}");
    }
}

#[test]
fn elements_too_far_apart_to_be_solved_are_refused() {
    let square = [[2.5, 0.0, 0.0], [0.0, 2.5, 0.0]];
    let away = answer(&design(square, 0.1, 1.0, &[([0.0; 3], Z, 1.0, None), ([0.0, 0.0, 1e6], X, 1.0, None)]), "0");
    assert_eq!(away.codes, (3, None));
    assert!(away.said.contains("\"e1\" lies 1.0e6 R from the first element; at most 1e4"), "{}", away.said);
    let wide = answer(&design([[1e6, 0.0, 0.0], [0.0, 1e6, 0.0]], 0.1, 1.0, &[([0.0; 3], Z, 1e5, None)]), "0");
    assert_eq!(wide.codes, (3, None));
    assert!(wide.said.contains("reach 1.0e5 R from its center; at most 1e4"), "{}", wide.said);
}

/// At once, whatever the direction and the width; in another basis, and as a mirror image.
#[test]
fn cells_that_lie_apart_are_unbounded() {
    let pair = |sign: f64| [([0.0; 3], Z, 1.0, None), ([sign * 1.2, 0.0, 0.0], Y, 1.0, None)];
    for (basis, sign) in [
        ([[9e3, 0.0, 0.0], [0.0, 9e3, 0.0]], 1.0),
        ([[9e3, 0.0, 0.0], [9e3, 9e3, 0.0]], 1.0),
        ([[9e3, 0.0, 0.0], [0.0, 9e3, 0.0]], -1.0),
        ([[6.0, 0.0, 0.0], [0.0, 6.0, 0.0]], 1.0),
    ] {
        all_are(&answer(&design(basis, 0.1, 1.0, &pair(sign)), "-0.25,0,0.25"), "unbounded");
    }
}

#[test]
fn a_design_that_is_locked_already_has_no_way_to_go() {
    let answer = answer(&grid(3.6 - 1e-8, 0.1, 1.0, 0.0, 0.0), "0");
    is_the_grid(&answer, 3.6 - 1e-8, 0.1, 1e-12);
    assert!(answer.rows.iter().all(|row| row.3.unwrap() < 3e-8));
}

/// Rings of r/R = 0.49 hold two thin wires in their hole.
#[test]
fn fat_rings_hold_thin_ones() {
    let a = 4.5;
    let rings = [([0.0; 3], Z, 1.0, None), ([a / 2.0, 0.0, 0.0], Y, 2.0, Some(0.2))];
    let answer = answer(&design([[a, 0.0, 0.0], [0.0, 9.0, 0.0]], 0.49, 1.0, &rings), "0");
    assert_eq!(answer.codes, (0, Some(0)), "{}", answer.said);
    let (_, _, status, l1) = &answer.rows[0];
    assert_eq!(status, "global");
    assert!((l1.unwrap() - (2.0 * (3.0 - 0.69) / a - 1.0)).abs() < 1e-12, "{l1:?}");
}

#[test]
fn fat_rings_that_cannot_be_are_refused() {
    let rings = [([0.0; 3], Z, 1.0, None), ([1.25, 0.0, 0.0], Y, 1.0, None)];
    let answer = answer(&design([[2.5, 0.0, 0.0], [0.0, 2.5, 0.0]], 0.49, 1.0, &rings), "0");
    assert_eq!(answer.codes, (3, None));
    assert!(answer.said.contains("overlap by") && answer.said.contains("smaller minor_radius"), "{}", answer.said);
}

/// Rings of radius 1 joined by rings of 1e-4: feasible states are found, no certificate to 1e-12 R is claimed.
#[test]
fn radii_of_a_ratio_of_ten_thousand_are_never_wrongly_certified() {
    let a = 2.0 + 0.5e-4;
    let rings = [([0.0; 3], Z, 1.0, None), ([a / 2.0, 0.0, 0.0], Y, 1e-4, None), ([0.0, a / 2.0, 0.0], X, 1e-4, None)];
    let answer = answer(&design([[a, 0.0, 0.0], [0.0, a, 0.0]], 1e-5, 1.0, &rings), "0");
    let bound = 2.0 * (1.0 + 1e-4 - 2e-5) / a - 1.0;
    assert!(answer.codes.1 == Some(0), "{}", answer.said);
    for (direction_deg, _, status, l1) in &answer.rows {
        assert!(["global", "local", "uncertified"].contains(&status.as_str()), "{status}");
        assert!(*direction_deg == 45.0 || l1.is_none_or(|l1| l1 <= bound + 1e-9));
    }
}

#[test]
fn what_is_not_linked_is_unbounded() {
    let square = |a: f64| [[a, 0.0, 0.0], [0.0, a, 0.0]];
    let one = [([0.0; 3], Z, 1.0, None)];
    let coplanar = [([0.0; 3], Z, 1.0, None), ([0.0; 3], Z, 0.5, None)];
    let coaxial: Vec<Single> = (0..5).map(|k| ([0.0, 0.0, 0.25 * f64::from(k)], Z, 1.0, None)).collect();
    // Pairs that are linked among themselves, of the fattest rings that can be.
    let pairs = [([0.0; 3], Z, 1.0, None), ([1.0, 0.0, 0.0], Y, 1.0, None)];
    for (a, r, rings) in [(4.0, 0.1, &one[..]), (2.5, 0.1, &coplanar), (2.5, 0.1, &coaxial), (6.0, 0.49, &pairs)] {
        all_are(&answer(&design(square(a), r, 1.0, rings), "-0.1,0"), "unbounded");
    }
}

#[test]
fn a_chain_in_one_direction_binds_all_but_the_one_across() {
    let rings = [([0.0; 3], Z, 1.0, None), ([1.25, 0.0, 0.0], Y, 1.0, None)];
    let answer = answer(&design([[2.5, 0.0, 0.0], [0.0, 2.5, 0.0]], 0.1, 1.0, &rings), "0");
    assert_eq!(answer.codes, (0, Some(0)), "{}", answer.said);
    for (direction_deg, l2, status, l1) in &answer.rows {
        if *direction_deg == 90.0 {
            assert_eq!((status.as_str(), l1), ("unbounded", &None));
        } else {
            assert_eq!(status, "global");
            assert!((l1.unwrap() - of_grid(2.5, 0.1, *direction_deg, *l2)).abs() < 1e-12);
        }
    }
}

/// An element of several rings of one minor radius: name, centre, and radius, normal, offset of each ring.
type Multi<'a> = (&'a str, [f64; 3], &'a [(f64, [f64; 3], [f64; 3])]);

fn of_several(basis: [[f64; 3]; 2], minor_radius: f64, elements: &[Multi<'_>]) -> String {
    let mut text = design(basis, minor_radius, 1.0, &[]);
    for (name, center, rings) in elements {
        let ring = |(radius, normal, offset): &(f64, [f64; 3], [f64; 3])| {
            format!("{{ major_radius = {radius:?}, normal = {normal:?}, offset = {offset:?} }}")
        };
        let rings: Vec<String> = rings.iter().map(ring).collect();
        write!(text, "\n[[elements]]\nname = \"{name}\"\ncenter = {center:?}\nrings = [{}]\n", rings.join(", "))
            .unwrap();
    }
    text
}

/// Three elements of two rings each, across each other in the way of Borromean rings, no ring linked with another. In a wide cell
/// they come apart; `unbounded` says that a state was found from which they do.
#[test]
fn elements_that_are_linked_in_no_pair_of_rings_come_apart() {
    let two = |along: [f64; 3], normal| [-1.2, 1.2].map(|side| (1.0, normal, along.map(|x| side * x)));
    let rings = [two(X, Z), two(Y, X), two(Z, Y)];
    let elements = [("a", [0.0; 3], &rings[0][..]), ("b", [0.0; 3], &rings[1]), ("c", [0.0; 3], &rings[2])];
    all_are(&answer(&of_several([[8.0, 0.0, 0.0], [0.0, 8.0, 0.0]], 0.1, &elements), "0"), "unbounded");
}

/// A ring inside a cage of three rings is linked with none of them and cannot leave it. Elements of a cage and the ring of the next
/// cage make a chain that no linking number shows: its limit is certified, has no bound, and is never called unbounded.
#[test]
fn what_is_caged_is_held_without_a_link() {
    let (a, one) = (3.0, [1.0, 1.0, 1.0]);
    let cage = [(1.0, X, [0.0; 3]), (1.0, Y, [0.0; 3]), (1.0, Z, [0.0; 3]), (0.8, one, [a, 0.0, 0.0])];
    let text = of_several([[a, 0.0, 0.0], [0.0, 6.0, 0.0]], 0.05, &[("caged", [0.0; 3], &cage)]);
    let answer = answer(&text, "0");
    assert_eq!(answer.codes, (0, Some(0)), "{}", answer.said);
    for (direction_deg, _, status, l1) in &answer.rows {
        let expected = if *direction_deg == 90.0 { "unbounded" } else { "local" };
        assert_eq!(status, expected, "{direction_deg}°: {l1:?}");
        // The ring moves less than a cage is wide.
        assert!(l1.is_none_or(|l1| *direction_deg != 0.0 || (l1 > 0.0 && l1 * a < 2.0)), "{l1:?}");
    }
}

/// Rings one behind the other, pulled across with a little of a degree along: by l1 = 128 they are not past each other. Nothing holds
/// them, and nothing is shown: no number.
#[test]
fn what_is_neither_held_nor_apart_has_no_number() {
    let stack = design([[0.5, 0.0, 0.0], [0.0, 4.0, 0.0]], 0.1, 1.0, &[([0.0; 3], X, 1.0, None)]);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("stack.toml"), stack).unwrap();
    let (code, _, said) = outcome(
        folder.path(),
        "characterize stack.toml --directions 90.01 --l2 0 --cell 1x1 --effort low --out record --quiet",
    );
    assert_eq!(code, 5, "{said}");
    let row = &rows(folder.path())[0];
    assert_eq!(
        (&row["status"], &row["l1"], &row["l1_uncertified"]),
        (&"uncertified".into(), &Value::Null, &Value::Null)
    );
    assert_eq!(outcome(folder.path(), "verify record --quiet").0, 0);
    assert!(fs::read_to_string(folder.path().join("record/states.jsonl")).unwrap().contains("no contact held it"));
}

/// The least and the largest of what nothing holds are no numbers: the search was only stopped there.
#[test]
fn a_strain_that_nothing_holds_has_no_largest_value() {
    let rings = [([0.0; 3], Z, 1.0, None), ([1.25, 0.0, 0.0], Y, 1.0, None)];
    let folder = tempfile::tempdir().unwrap();
    let chains = design([[2.5, 0.0, 0.0], [0.0, 2.5, 0.0]], 0.1, 1.0, &rings);
    fs::write(folder.path().join("chains.toml"), chains).unwrap();
    let (code, out, _) = outcome(folder.path(), "limit chains.toml --maximize eyy");
    assert_eq!(code, 5);
    assert!(out.contains("unbounded") && out.contains("nothing holds the sheet along this direction"), "{out}");
    let (code, out, said) = outcome(folder.path(), "limit chains.toml --maximize eyy --json");
    let found: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &found["value"]), (5, &Value::Null), "{said}");
    let (code, out, said) = outcome(folder.path(), "limit chains.toml --maximize exx --json");
    let found: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(code, 0, "{said}");
    assert!((found["value"].as_f64().unwrap() - 0.5368).abs() < 1e-12, "{found}");
}

/// The images of such elements once had all memory.
#[test]
fn elements_over_more_cells_than_can_be_listed_are_refused() {
    let wide = answer(&design([[3.0, 0.0, 0.0], [0.0, 3.0, 0.0]], 0.1, 1.0, &[([0.0; 3], Z, 1e11, Some(0.1))]), "0");
    assert_eq!(wide.codes, (3, None));
    assert!(wide.said.contains("the rings of \"e0\" reach 1.0e11 R from its center"), "{}", wide.said);
    let narrow = answer(&grid(1e-9, 1e-10, 1.0, 0.0, 0.0), "0");
    assert_eq!(narrow.codes, (3, None), "{}", narrow.said);
    let away = [([0.0; 3], Z, 4e-3, Some(1e-4)), ([3e3, 0.0, 0.0], X, 4e-3, Some(1e-4))];
    let away = answer(&design([[3e-3, 0.0, 0.0], [0.0, 3e-3, 0.0]], 0.1, 0.35, &away), "0");
    assert_eq!(away.codes, (3, None));
    assert!(away.said.contains("\"e1\" lies 1.0e6 cells from the first element"), "{}", away.said);
}

/// n × n cells of the grid, written out as one cell.
fn written_out(n: i32) -> String {
    let a = 2.5;
    let mut rings: Vec<Single> = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (f64::from(i) * a, f64::from(j) * a))) {
        rings.extend([
            ([i, j, 0.0], Z, 1.0, None),
            ([i + a / 2.0, j, 0.0], Y, 1.0, None),
            ([i, j + a / 2.0, 0.0], X, 1.0, None),
        ]);
    }
    let side = f64::from(n) * a;
    design([[side, 0.0, 0.0], [0.0, side, 0.0]], 0.1, 1.0, &rings)
}

/// The elements of a large cell follow a strain: without that the solves creep.
#[test]
fn a_cell_that_is_written_out_has_the_limits_of_its_own_cell() {
    is_the_grid(&answer(&written_out(5), "0"), 2.5, 0.1, 1e-9);
}

/// Its link bound once asked for 5 GB and many minutes.
#[test]
fn thousands_of_rings_in_a_cell_are_read_and_bounded() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("design.toml"), written_out(32)).unwrap();
    let (code, out, said) = outcome(folder.path(), "inspect design.toml --json");
    assert_eq!(code, 0, "{said}");
    let found: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(found["rings"].as_u64(), Some(3072));
    assert!(
        found["bounds"]
            .as_array()
            .unwrap()
            .iter()
            .any(|bound| (bound["l1"].as_f64().unwrap_or(9.0) - 0.44).abs() < 1e-9)
    );
}
