//! Curves at the edge of what a curve can be: spikes, hairpins, fillets of zero, thousands of pieces, knots, hooks.

use super::rows;
use crate::common::outcome;
use std::{f64::consts::TAU, fmt::Write as _, fs};

/// A chain with this repeat of elements along x, each with the form and minor radius of its curve and the direction of its normal.
fn chain(repeat: f64, elements: &[(f64, String, f64, [f64; 3])]) -> String {
    let mut out = format!(
        "schema = 1\nname = \"edge\"\nreference_radius = 1.0\nminor_radius = 0.1\n\n[lattice]\na1 = [{repeat:?}, 0.0, 0.0]\n"
    );
    for (k, (x, form, wire, normal)) in elements.iter().enumerate() {
        write!(
            out,
            "\n[[elements]]\nname = \"e{k}\"\ncenter = [{x:?}, 0.0, 0.0]\ncurves = [{{ {form}, normal = {normal:?}, minor_radius = {wire:?} }}]\n"
        )
        .unwrap();
    }
    out
}

/// Two of one form, the second turned by a right angle.
fn of_two(repeat: f64, form: &str, wire: f64) -> String {
    let element = |x: f64, normal| (x, form.to_owned(), wire, normal);
    chain(repeat, &[element(0.0, super::Z), element(0.5 * repeat, super::Y)])
}

/// The status, and the repeat where it locks; `verify` has proved it.
fn locked(design: &str, repeat: f64) -> (String, f64) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("design.toml"), design).unwrap();
    let (code, _, said) =
        outcome(folder.path(), "characterize design.toml --cell 1x1 --effort low --out record --quiet");
    assert_eq!(code, 0, "{said}");
    let row = &rows(folder.path())[0];
    let (verified, out, _) = outcome(folder.path(), "verify record");
    assert_eq!(verified, 0, "{out}");
    assert!(out.contains("1 of 1 certified ones proved"), "{out}");
    (row["status"].as_str().unwrap().to_owned(), repeat * (1.0 + row["l1"].as_f64().unwrap()))
}

fn refused(design: &str, words: &str) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("design.toml"), design).unwrap();
    let (code, _, said) = outcome(folder.path(), "inspect design.toml");
    assert!(code != 0 && said.contains(words), "{code} {said}");
}

/// How far apart two sharp corners of half angle φ are that lie in each other, turned by a right angle: all four pairs of sides touch, which are
/// d sin φ/√(1 + cos² φ) apart (`docs/theory/curves.md` has squares).
fn corner_in_corner(half_angle_rad: f64, wire: f64) -> f64 {
    let (sin, cos) = half_angle_rad.sin_cos();
    2.0 * wire * (1.0 + cos * cos).sqrt() / sin
}

fn points(all: &[[f64; 3]]) -> String {
    format!("{all:?}")
}

/// Rhombi from corners at right angles to spikes of 6°.
#[test]
fn spikes_lock_side_on_side() {
    for half_deg in [45.0_f64, 15.0, 3.0] {
        let (sin, cos) = half_deg.to_radians().sin_cos();
        let (side, wire) = (4.0, 0.02);
        let corners =
            [[side * cos, 0.0, 0.0], [0.0, side * sin, 0.0], [-side * cos, 0.0, 0.0], [0.0, -side * sin, 0.0]];
        let expected = 2.0 * (2.0 * side * cos - corner_in_corner(half_deg.to_radians(), wire));
        let repeat = expected - 0.1;
        let form = format!("polyline = {{ points = {} }}", points(&corners));
        let (status, found) = locked(&of_two(repeat, &form, wire), repeat);
        assert!(status == "local" && (found - expected).abs() < 1e-9, "{half_deg}: {status} {found} {expected}");
    }
}

/// A stadium whose straight sides all but touch, with a needle of a ring through the slit that is left.
#[test]
fn a_hairpin_holds_what_fits_between_its_legs() {
    let (straight, radius, wire, needle) = (4.0, 0.11, 0.1, 0.005);
    let expected = straight + 2.0 * radius + 2.0 - 2.0 * (wire + needle);
    let repeat = expected - 0.2;
    let hairpin = |r: f64| format!("stadium = {{ straight = {straight:?}, radius = {r:?} }}");
    let design = |r: f64| {
        let ring = "ellipse = { a = 1.0, b = 1.0 }".to_owned();
        chain(repeat, &[(0.0, hairpin(r), wire, super::Z), (0.5 * repeat, ring, needle, super::Y)])
    };
    let (status, found) = locked(&design(radius), repeat);
    assert!(status == "global" && (found - expected).abs() < 1e-9, "{status} {found} {expected}");
    // Legs that are as near as the wire is thick, or nearer.
    refused(&design(0.1), "not smaller than the curve's least radius");
    let legs = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.19, 0.0], [0.0, 0.19, 0.0]];
    let form = format!("polyline = {{ points = {}, closed = false }}", points(&legs));
    refused(&of_two(8.0, &form, 0.1), "runs into itself");
}

/// None, and one that is too small for the wire, which is refused.
#[test]
fn a_fillet_of_zero_is_a_corner() {
    let (side, wire) = (2.0, 0.1);
    let expected = 2.0 * (2.0_f64.sqrt() * side - corner_in_corner(TAU / 8.0, wire));
    let square = |fillet: &str| of_two(3.5, &format!("square = {{ side = {side:?}{fillet} }}"), wire);
    for fillet in ["", ", fillet = 0.0"] {
        let (status, found) = locked(&square(fillet), 3.5);
        assert!(status == "local" && (found - expected).abs() < 1e-9, "{status} {found} {expected}");
    }
    refused(&square(", fillet = 1e-9"), "not smaller than the curve's least radius");
    refused(&square(", fillet = -0.1"), "is not a length of 0 or more");
}

/// A circle as n sides locks corner in corner. More pieces than a curve may have are refused.
#[test]
fn a_circle_of_thousands_of_sides_is_no_ring() {
    let polygon = |n: usize| {
        let corner = |k: usize| [(TAU * k as f64 / n as f64).cos(), (TAU * k as f64 / n as f64).sin(), 0.0];
        format!("polyline = {{ points = {} }}", points(&(0..n).map(corner).collect::<Vec<_>>()))
    };
    for n in [100, 2_000] {
        let expected = 2.0 * (2.0 - corner_in_corner(TAU / 4.0 - TAU / 2.0 / n as f64, 0.1));
        let (status, found) = locked(&of_two(3.0, &polygon(n), 0.1), 3.0);
        assert!(status == "local" && (found - expected).abs() < 1e-9, "{n}: {status} {found} {expected}");
    }
    refused(&of_two(3.0, &polygon(5_001), 0.1), "5001 points");
}

/// A trefoil runs three times through its own hole. A ring round its outer strand on one side, and round both on the other.
#[test]
fn a_knot_is_held_by_rings() {
    let trefoil = "torus_knot = { p = 2, q = 3, R = 1.0, a = 0.4 }".to_owned();
    let ring = "ellipse = { a = 1.0, b = 1.0 }".to_owned();
    let repeat = 3.6;
    let design = chain(repeat, &[(0.0, trefoil.clone(), 0.1, super::Z), (2.0, ring, 0.1, super::Y)]);
    let (status, found) = locked(&design, repeat);
    assert!(status == "local" && found > repeat && found < 2.0 * (1.4 + 1.0), "{status} {found}");
    refused(&of_two(8.0, &trefoil, 0.4), "runs into itself");
}

/// A hook that runs through its own hole: what is open has no linking number, and holds.
#[test]
fn a_pigtail_holds_a_ring() {
    let on_helix = |turn: f64| [(TAU * turn).cos(), (TAU * turn).sin(), 0.5 * turn];
    let turns: Vec<[f64; 3]> = (0..=16).map(|k| on_helix(0.1 * f64::from(k) - 0.8)).collect();
    let form = format!("spline = {{ points = {}, closed = false }}", points(&turns));
    let ring = "ellipse = { a = 1.0, b = 1.0 }".to_owned();
    let repeat = 3.2;
    let design = chain(repeat, &[(0.0, form, 0.1, super::Z), (0.5 * repeat, ring, 0.1, super::Y)]);
    let (status, found) = locked(&design, repeat);
    assert!(status == "local" && found > repeat, "{status} {found}");
}
