//! Force against stretch of simulated sheets.

use super::attribute;
use crate::common::rows::design;
use maille::record::ForceRow;
use maille::relaxation::simulate::End;
use maille_io::plot::Layout;
use maille_io::plot::NamedSimulation;
use maille_io::plot::force_svg;
use maille_io::record::ForceTable;
use maille_io::record::SimulationRecord;
use maille_svg::svg_to_png;

/// A simulation of a sheet with a force at each stretch, and nothing in one frame.
fn simulation(name: &str, tile: &str, end: End, curve: &[(f64, f64)]) -> NamedSimulation {
    let row = |stretch, mean_force| ForceRow {
        share: 0.0,
        stretch,
        mean_force,
        deformation: None,
        energy: 0.0,
        floor_force: None,
        bend_force: None,
        forces: vec![[0.0; 3]],
    };
    let rows = curve.iter().map(|&(stretch, force)| row(Some(stretch), Some(force))).chain([row(None, None)]).collect();
    let document = serde_json::json!({
        "schema": 1, "version": "0", "design": design(), "tile": tile,
        "setup": {
            "fix": ["left", "flat@0,1"], "pull": [{ "place": "right", "way": [[8.0, 0.0, 0.0]] }], "gravity": null,
            "force": [], "floor": null, "steps": 40, "max_iterations": 9, "seed": 1,
        },
        "outcome": { "end": end, "share": 0.5, "smallest_gap": null, "links_ok": true, "iterations": 1, "kicks": 0, "note": null },
    });
    let record: SimulationRecord = serde_json::from_value(document).unwrap();
    NamedSimulation { name: name.into(), record, forces: ForceTable { places: vec!["left".into()], bent: false, rows } }
}

/// Free at first, then a hard stop: along the axis, then straight up; the legend says where, the caption what was done.
#[test]
fn a_force_rises_where_the_sheet_stops() {
    let stops = [(1.0, 0.0), (1.2, 1e-9), (1.4399, 1e-4), (1.44, 4.0)];
    let one = force_svg(&[simulation("a", "4x4", End::Locked, &stops)], Layout::Beside).unwrap();
    for words in [
        ">stops at 1.440<",
        "4 × 4 cells · ",
        "left and flat@0,1 held",
        "right pulled by (8, 0, 0)",
        "40 steps",
        "(βR/1000, the unit of --force)",
    ] {
        assert!(one.contains(words), "{words} is not in {one}");
    }
    let curve = one.lines().find(|line| line.starts_with("<path") && line.contains("fill=\"none\"")).unwrap();
    let numbers = attribute(curve, "d").split(['M', 'L', ' ']).filter_map(|x| x.parse().ok());
    let at: Vec<f64> = numbers.collect();
    assert_eq!(at.len(), 8);
    let (run, rise) = (at[4] - at[0], at[5] - at[7]);
    assert!(run > 300.0 && (at[1] - at[5]).abs() < 0.5 && rise > 300.0 && at[6] - at[4] < 1.0, "{at:?}");

    // Sheets of one design are told apart by their cells, and by their folders at last.
    let all = [
        simulation("a", "4x4", End::Locked, &stops),
        simulation("b", "4x4", End::Reached, &stops[..2]),
        simulation("c", "2x2", End::Interrupted, &stops[..1]),
        simulation("d", "1x1", End::Reached, &[]),
    ];
    let several = force_svg(&all, Layout::Beside).unwrap();
    for label in [
        ">1.1, 4 × 4 cells, a<",
        ">stops at 1.440<",
        ">1.1, 4 × 4 cells, b<",
        ">no stop up to 1.200<",
        ">1.1, 2 × 2 cells<",
        ">given up at 1.000<",
    ] {
        assert!(several.contains(label), "{label} is not in {several}");
    }
    svg_to_png(&several, 1.0).unwrap();
    svg_to_png(&force_svg(&all, Layout::Below).unwrap(), 1.0).unwrap();
    assert!(force_svg(&all[3..], Layout::Beside).is_none());
}
