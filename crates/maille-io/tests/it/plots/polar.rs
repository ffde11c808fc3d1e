//! The polar plot of one record: what stands in it.

use super::lines;
use super::turn;
use crate::common::rows::design;
use maille::record::LimitRow;
use maille::record::Status;
use maille_io::Quantity;
use maille_io::plot::Curve;
use maille_io::plot::CurveKind;
use maille_io::plot::Layout;
use maille_io::plot::PolarPlot;
use maille_io::plot::polar_svg;
use maille_svg::svg_to_png;

#[test]
fn the_plot_says_what_it_shows() {
    let rows: Vec<_> = [turn(0.125, 30.0), turn(-0.125, 1.0), turn(0.0, 1.0)].concat();
    let plot = PolarPlot::from_rows(&design(), &rows, Quantity::Stretch, &["τ = 0.01".into()]);
    assert_eq!(plot.curves.iter().map(|c| c.l2).collect::<Vec<_>>(), [-0.125, 0.0, 0.125]);
    assert_eq!(plot.caption[0], "r = 0.1 (r/R = 0.1)  ·  energy method  ·  cell 1 × 1  ·  τ = 0.01");
    assert!(plot.caption[1].starts_with("13 directions computed, 0° to 180°."));
    assert_eq!(plot.caption[2], "Gaps: 1 of 39 searches gave no limit (1 l2-not-reached).");
    let svg = polar_svg(&plot, Layout::Beside);
    for text in [
        "1.1 · Cartesian grid of rings",
        ">330°<",
        ">1.4<",
        "Radius: 1 + l₁",
        "centre 1.0: undeformed",
        ">−0.125<",
        ">0<",
        ">0.125<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

/// Limits that still grow with the cell are named, up to six of each l2; those that do not, or have no limit, are not.
#[test]
fn limits_that_grow_with_the_cell_are_named() {
    let grow = |row: LimitRow, grows: bool| LimitRow { grows_with_cell: Some(grows), ..row };
    let rows: Vec<_> = turn(-0.125, 30.0).into_iter().map(|row| grow(row.clone(), row.direction_deg <= 45.0)).collect();
    let rows = [rows, turn(0.0, 1.0).into_iter().map(|row| grow(row, true)).collect()].concat();
    let plot = PolarPlot::from_rows(&design(), &rows, Quantity::Stretch, &[]);
    let said = plot.caption.last().unwrap();
    assert_eq!(
        said,
        "Still grows with the cell, so that larger cells may go further: 0°, 15°, 45° at l₂ = −0.125; 0°, 15°, 30°, 45°, 60°, 75° \
         and 7 more at l₂ = 0."
    );
    let plot = PolarPlot::from_rows(&design(), &turn(0.0, 1.0), Quantity::Stretch, &[]);
    assert!(plot.caption.iter().all(|line| !line.contains("grows")));
}

#[test]
fn each_quantity_has_its_centre() {
    let rows = turn(0.0, 1.0);
    let values = |quantity| PolarPlot::from_rows(&design(), &rows, quantity, &[]).curves[0].values().next().unwrap();
    assert_eq!(values(Quantity::Stretch), 1.44);
    assert_eq!(values(Quantity::L1), 0.44);
    assert!((values(Quantity::Lambda1) - (1.44 * 1.44 - 1.0)).abs() < 1e-12);
}

#[test]
fn a_missing_limit_opens_the_curve() {
    let paths = |rows: Vec<LimitRow>| {
        let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside);
        svg.lines()
            .filter(|line| line.starts_with("<path") && line.contains("fill=\"none\""))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let closed = paths(turn(0.0, 1.0));
    assert_eq!(closed.len(), 1);
    assert!(closed[0].contains("Z\""));
    let open = paths(turn(0.0, 30.0));
    assert_eq!(open.len(), 2);
    assert!(open.iter().all(|path| !path.contains("Z\"")));
}

#[test]
fn below_zero_the_axis_moves_its_origin() {
    let mut rows = turn(0.0, 1.0);
    rows[3].l1 = Some(-0.15);
    let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside);
    assert!(svg.contains("dotted circle 0.0: undeformed") && svg.contains("centre −0.2"));
}

#[test]
fn plots_without_limits_and_with_odd_texts_are_drawn() {
    let mut design = design();
    design.title = "R&D <sheet>\u{1}".into();
    let none: Vec<_> =
        turn(0.0, 1.0).into_iter().map(|row| LimitRow { l1: None, status: Status::Unbounded, ..row }).collect();
    for rows in [&[][..], &none] {
        let svg = polar_svg(&PolarPlot::from_rows(&design, rows, Quantity::Stretch, &[]), Layout::Beside);
        assert!(svg.contains("R&amp;D &lt;sheet&gt;"));
        svg_to_png(&svg, 1.0).unwrap();
    }
}

#[test]
fn a_bound_is_dashed_and_has_no_markers() {
    let mut plot = PolarPlot::from_rows(&design(), &[], Quantity::L1, &[]);
    let points: Vec<_> = (0..180).map(|d| (f64::from(d), Some(0.5), Status::Local)).collect();
    plot.curves.push(Curve::new(0, 0.0, CurveKind::Bound, &points));
    let svg = polar_svg(&plot, Layout::Beside);
    assert!(svg.contains("stroke-dasharray=\"5 4\"") && !svg.contains("fill=\"#222222\" stroke=\"#222222\""));
}

/// The bounds are far out: the axis is that of the limits, and the bounds are cut at its end.
#[test]
fn bounds_do_not_set_the_axis() {
    let far = |bound: f64| {
        let row = |row: LimitRow| LimitRow { bound_l1: Some(bound), bound_gap: Some(bound - 0.44), ..row };
        let rows: Vec<_> = turn(0.0, 1.0).into_iter().map(row).collect();
        polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside)
    };
    let (near, far) = (far(0.45), far(3.0));
    for svg in [&near, &far] {
        assert!(svg.contains(">0.5<") && !svg.contains(">1.0<") && !svg.contains(">3.0<"));
    }
    let dashed = |svg: &str| lines(svg).iter().filter(|line| line.contains("dasharray=\"5 4\"")).count();
    assert_eq!((dashed(&near), dashed(&far)), (1, 0));
    assert!(near.contains(">proven bound<") && far.contains(">proven bound, cut off at 0.5<"));
}

/// A limit that is not proved has a hollow marker; a direction without a limit has a mark that tells why.
#[test]
fn markers_tell_what_is_proved() {
    let mut rows = turn(0.0, 30.0);
    rows.iter_mut().for_each(|row| row.status = Status::Global);
    let draw = |rows: &[LimitRow]| polar_svg(&PolarPlot::from_rows(&design(), rows, Quantity::L1, &[]), Layout::Beside);
    let hollow = |svg: &str| svg.matches("fill=\"#ffffff\" stroke=\"#222222\"").count();
    rows[2].status = Status::L2NotReached;
    let svg = draw(&rows);
    assert!(hollow(&svg) == 0 && !svg.contains("not proved") && svg.contains(">no limit found<"));
    rows[5].status = Status::Local;
    rows[2].status = Status::L2Unreachable;
    let svg = draw(&rows);
    assert_eq!(hollow(&svg), 2, "at 75° and 255°");
    assert!(svg.contains(">proved<") && svg.contains(">not proved (local)<") && svg.contains(">no limit (proved)<"));
}
